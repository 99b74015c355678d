"""DXF drawings in: layers, curves, block references, units, loops, and what is left out."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

from clast.errors import CaseError
from clast.rockmass.drawings.drawn_loops import DrawnLine, loops_of, ring
from clast.rockmass.drawings.dxf import (
    DxfReading,
    lines_of_layer,
    outline_of_layer,
    read_dda_dxf,
    read_dxf,
    role_of,
)
from clast.rockmass.drawings.dxf_entities import UNITS, arc, bulged
from clast.rockmass.readers import read_drawing

SQUARE = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)]


class Sheet:
    """A DXF file in the making, with the square as its boundary unless another is drawn."""

    def __init__(self, path: Path, units: int = 6) -> None:
        self.path = path
        self.document = ezdxf.new("R2010", units=units)
        self.space: Any = self.document.modelspace()

    def boundary(self, points: Any = SQUARE, **extra: Any) -> Sheet:
        self.space.add_lwpolyline(points, close=True, dxfattribs={"layer": "BOUNDARY", **extra})
        return self

    def line(self, start: Any, end: Any, layer: str, **extra: Any) -> Any:
        return self.space.add_line(start, end, dxfattribs={"layer": layer, **extra})

    def saved(self) -> Path:
        self.document.saveas(self.path)
        return self.path

    def read(self, **how: Any) -> Any:
        return read_dxf(self.saved(), DxfReading(**how))


@pytest.fixture
def sheet(tmp_path: Path) -> Sheet:
    return Sheet(tmp_path / "site.dxf")


def area(points: Any) -> float:
    return float(shapely.Polygon(points).area)


# Layers ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("layer", "role"),
    [
        ("BOUNDARY", ("boundary", "")),
        ("boundary", ("boundary", "")),
        ("Joints_Bedding", ("joints", "Bedding")),
        ("JOINTS", ("joints", "")),
        ("OPENINGS_north heading", ("openings", "north heading")),
        ("REGIONS_shale", ("regions", "shale")),
        ("bolts_swellex", ("bolts", "swellex")),
        ("FIXED", ("fixed", "")),
        ("FIXED_x", ("", "")),
        ("BOUNDARY_old", ("", "")),
        ("JOINT", ("", "")),
        ("0", ("", "")),
    ],
)
def test_what_a_layer_is_for(layer, role):
    assert role_of(layer) == role


def test_every_layer_goes_where_it_belongs(sheet):
    sheet.boundary()
    trace = sheet.line((0, 3), (20, 4), "joints_bedding")
    sheet.line((1, 1), (2, 5), "JOINTS")
    opening = sheet.space.add_circle((10, 5), 2, dxfattribs={"layer": "OPENINGS_heading"})
    sheet.space.add_lwpolyline(
        [(0, 0), (5, 0), (5, 5)], close=True, dxfattribs={"layer": "regions_shale"}
    )
    sheet.line((10, 8), (10, 7), "BOLTS_swellex")
    sheet.line((0, 0), (20, 0), "FIXED")
    sheet.space.add_point((0, 0), dxfattribs={"layer": "fixed"})
    drawing = sheet.read()
    np.testing.assert_array_equal(drawing.boundary, SQUARE)
    assert [t.joint for t in drawing.traces] == ["bedding", "default"]
    np.testing.assert_array_equal(drawing.traces[0].points, [(0, 3), (20, 4)])
    assert drawing.traces[0].place == f"LINE {trace.dxf.handle}"
    assert [(o.name, o.place) for o in drawing.openings] == [
        ("heading", f"CIRCLE {opening.dxf.handle}")
    ]
    assert [r.name for r in drawing.regions] == ["shale"]
    np.testing.assert_array_equal(drawing.bolts[0].ends, [(10, 8), (10, 7)])
    assert drawing.bolts[0].name == "swellex"
    np.testing.assert_array_equal(drawing.fixed_lines[0].ends, [(0, 0), (20, 0)])
    np.testing.assert_array_equal(drawing.fixed_points[0].at, (0, 0))
    assert drawing.left_out == ()


def test_openings_get_names_of_their_own(sheet):
    sheet.boundary()
    for x, layer in ((2, "OPENINGS"), (6, "OPENINGS"), (10, "OPENINGS_a"), (14, "OPENINGS_a")):
        sheet.space.add_circle((x, 5), 1, dxfattribs={"layer": layer})
    names = [one.name for one in sheet.read().openings]
    assert sorted(names) == ["a-1", "a-2", "opening-1", "opening-2"]


def test_other_layers_and_entities_are_listed(sheet):
    sheet.boundary()
    texts = [sheet.space.add_text("t", dxfattribs={"layer": "NOTES"}) for _ in range(7)]
    hatch = sheet.space.add_hatch(dxfattribs={"layer": "JOINTS"})
    ray = sheet.space.add_ray((0, 0), (1, 0), dxfattribs={"layer": "JOINTS"})
    region = sheet.space.add_circle((5, 5), 1, dxfattribs={"layer": "REGIONS"})
    bolt = sheet.space.add_circle((5, 5), 1, dxfattribs={"layer": "BOLTS"})
    point = sheet.space.add_point((5, 5), dxfattribs={"layer": "JOINTS"})
    left = [str(one) for one in sheet.read().left_out]
    assert len(left) == 6
    notes = next(text for text in left if "NOTES" in text)
    assert "7 TEXT" in notes and f"TEXT {texts[4].dxf.handle} and 2 more" in notes
    for entity in (hatch, ray, region, bolt, point):
        assert any(entity.dxf.handle in text for text in left), entity
    assert any("REGIONS_rock" in text for text in left)


def test_entities_of_unknown_types_are_listed(sheet):
    sheet.boundary()
    line = sheet.line((0, 1), (20, 1), "JOINTS")
    text = sheet.saved().read_text("utf-8")
    sheet.path.write_text(text.replace("\nLINE\n", "\nLIME\n"), "utf-8")
    drawing = read_dxf(sheet.path)
    assert drawing.traces == ()
    assert [(one.what, one.place) for one in drawing.left_out] == [
        ("on layer JOINTS", f"LIME {line.dxf.handle}")
    ]


def test_paper_space_and_hidden_layers_are_said(sheet):
    sheet.boundary()
    sheet.document.layers.add("JOINTS").off()
    sheet.line((0, 1), (20, 1), "JOINTS")
    layout = sheet.document.layout("Layout1")
    for k in range(3):
        layout.add_line((0, k), (1, k))
    drawing = sheet.read()
    assert len(drawing.traces) == 1
    assert any("JOINTS is switched off" in note for note in drawing.notes)
    assert [one.what for one in drawing.left_out if "Layout1" in one.place] == ["3 entities"]


def test_a_missing_boundary_is_refused_with_the_layers_there_are(sheet):
    sheet.line((0, 0), (1, 1), "JOINTS_a")
    sheet.line((0, 0), (1, 1), "outline")
    with pytest.raises(CaseError, match=r"layer BOUNDARY(?s:.)*JOINTS_a, outline"):
        sheet.read()


def test_single_layers_can_be_read(sheet):
    sheet.boundary(SQUARE[::-1])
    sheet.line((0, 1), (20, 1), "JOINTS_bedding")
    sheet.line((0, 2), (20, 2), "cracks")
    path = sheet.saved()
    assert [one.joint for one in lines_of_layer(path, "joints_BEDDING")[0]] == ["bedding"]
    assert [one.joint for one in lines_of_layer(path, "Cracks")[0]] == ["default"]
    outline, notes = outline_of_layer(path, "boundary")
    assert shapely.LinearRing(outline).is_ccw
    assert any("clockwise" in note for note in notes)
    with pytest.raises(CaseError, match=r"layer faults(?s:.)*BOUNDARY, JOINTS_bedding, cracks"):
        lines_of_layer(path, "faults")


# Curves ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("bulge", [1.0, -1.0, 0.3, -0.3, math.tan(math.pi / 8), 5.0])
def test_a_bulge_is_an_arc(bulge):
    """Against the circle through the chord's ends: sagitta of the whole arc is |b| c / 2."""
    points = bulged(np.array([(1.0, 2.0, bulge), (4.0, 6.0, 0.0)]), False, 1e-4)
    chord, middle = 5.0, np.array([2.5, 4.0])
    right = np.array([4.0, -3.0]) / 5.0
    top = middle + right * bulge * chord / 2.0
    radius = chord * (1 + bulge**2) / (4 * abs(bulge))
    centre = top - right * np.sign(bulge) * radius
    np.testing.assert_allclose(points[[0, -1]], [(1, 2), (4, 6)], atol=1e-12)
    np.testing.assert_allclose(np.hypot(*(points - centre).T), radius, rtol=1e-12)
    assert np.hypot(*(points - top).T).min() < 0.1 * radius
    chords = np.hypot(*np.diff(points, axis=0).T)
    assert (radius - np.sqrt(radius**2 - chords**2 / 4) <= 1.0001e-4).all()


EXACT = 200.0 + math.pi * 12.5
"""Area of a rectangle of 20 x 10 with a half circle at an end, m2."""


def test_the_area_of_bulges_is_that_of_the_arcs(sheet):
    sheet.boundary([(0, 0), (20, 0, 0, 0, 1.0), (20, 10), (0, 10)])
    coarse, fine = (area(sheet.read(sagitta=one).boundary) for one in (0.1, 1e-5))
    assert fine == pytest.approx(EXACT, rel=1e-6) and coarse + 0.1 < fine < EXACT


def test_a_closing_bulge_counts_and_old_polylines_have_them_too(sheet):
    sheet.boundary([(0, 0), (20, 0), (20, 10), (0, 10, 0, 0, 1.0)])
    assert area(sheet.read(sagitta=1e-5).boundary) == pytest.approx(EXACT, rel=1e-6)
    points = [(0, 0, 0), (20, 0, 1.0), (20, 10, 0), (0, 10, 0)]
    old = {"format": "xyb", "close": True, "dxfattribs": {"layer": "OPENINGS"}}
    sheet.space.add_polyline2d(points, **old)
    opening = sheet.read(sagitta=1e-5).openings[0]
    assert area(opening.points) == pytest.approx(EXACT, rel=1e-6)


def test_three_dimensional_polylines_and_meshes(sheet):
    sheet.space.add_polyline3d(
        [(*p, 3.0) for p in SQUARE], close=True, dxfattribs={"layer": "BOUNDARY"}
    )
    drawing = sheet.read()
    np.testing.assert_array_equal(drawing.boundary, SQUARE)
    assert any("z = 3 m" in note for note in drawing.notes)
    mesh = sheet.space.add_polymesh((3, 3), dxfattribs={"layer": "JOINTS"})
    with pytest.raises(CaseError, match=mesh.dxf.handle):
        sheet.read()


@pytest.mark.parametrize("sagitta", [0.5, 0.01, 1e-4])
def test_chords_stay_within_the_sagitta(sheet, sagitta):
    sheet.boundary()
    sheet.space.add_circle((10, 5), 2, dxfattribs={"layer": "OPENINGS"})
    sheet.space.add_arc((10, 5), 4, 350, 80, dxfattribs={"layer": "JOINTS"})
    drawing = sheet.read(sagitta=sagitta)
    for points, radius in ((drawing.openings[0].points, 2.0), (drawing.traces[0].points, 4.0)):
        away = np.hypot(*(points - (10, 5)).T)
        np.testing.assert_allclose(away, radius, rtol=1e-12)
        middle = np.hypot(*(0.5 * (points[1:] + points[:-1]) - (10, 5)).T)
        assert (radius - middle <= sagitta * (1 + 1e-9)).all()
        if sagitta < 0.1:
            assert (radius - middle).max() > 0.4 * sagitta
    ends = drawing.traces[0].points[[0, -1]]
    turned = np.degrees(np.arctan2(*(ends - (10, 5)).T[::-1]))
    np.testing.assert_allclose(turned, (-10, 80), atol=1e-9)
    assert any(f"within {sagitta:g} m" in note for note in drawing.notes)


def test_ellipses_and_splines_are_followed(sheet):
    sheet.boundary([(-30, -30), (30, -30), (30, 30), (-30, 30)])
    sheet.space.add_ellipse((0, 0), (6, 0), 0.5, dxfattribs={"layer": "OPENINGS_e"})
    # A reference of uneven scales makes the same ellipse of a circle.
    sheet.document.blocks.new("RING").add_circle((0, 0), 1)
    scales = {"layer": "OPENINGS_ring", "xscale": 6, "yscale": 3}
    sheet.space.add_blockref("RING", (0, 0), dxfattribs=scales)
    spline = sheet.space.add_spline(dxfattribs={"layer": "JOINTS"})
    spline.control_points = [(0, 0, 0), (1, 2, 0), (3, -2, 0), (4, 0, 0)]
    spline.dxf.degree = 3
    spline.knots = [0, 0, 0, 0, 1, 1, 1, 1]
    drawing = sheet.read(sagitta=1e-5)
    assert len(drawing.openings) == 2
    for one in drawing.openings:
        assert area(one.points) == pytest.approx(math.pi * 18, rel=1e-4)
        x, y = one.points.T
        np.testing.assert_allclose((x / 6) ** 2 + (y / 3) ** 2, 1.0, rtol=1e-9)
    # A Bezier curve of these control points, in Bernstein polynomials.
    points = drawing.traces[0].points
    np.testing.assert_allclose(points[[0, -1]], [(0, 0), (4, 0)], atol=1e-12)
    t = np.linspace(0, 1, 2001)[:, None]
    control = np.array([(0, 0), (1, 2), (3, -2), (4, 0)], float)
    exact = sum(math.comb(3, k) * t**k * (1 - t) ** (3 - k) * control[k] for k in range(4))
    curve = shapely.LineString(points)
    assert shapely.hausdorff_distance(curve, shapely.LineString(exact)) < 2e-4


def test_arcs_of_a_full_turn_have_eight_chords_at_least():
    assert len(arc(np.zeros(2), 1.0, (0.0, 2 * math.pi), 10.0)) == 9


def test_mirrored_entities_are_where_they_show(sheet):
    """Extrusion (0, 0, -1) mirrors x: the half circle of the rectangle then bulges at x = -20."""
    sheet.boundary([(0, 0), (20, 0, 0, 0, 1.0), (20, 10), (0, 10)], extrusion=(0, 0, -1))
    sheet.space.add_arc((5, 5), 1, 0, 90, dxfattribs={"layer": "JOINTS", "extrusion": (0, 0, -1)})
    drawing = sheet.read(sagitta=1e-5)
    assert drawing.boundary[:, 0].min() == pytest.approx(-25.0, abs=1e-4)
    assert area(drawing.boundary) == pytest.approx(EXACT, rel=1e-6)
    np.testing.assert_allclose(drawing.traces[0].points[0], (-6, 5), atol=1e-12)
    np.testing.assert_allclose(drawing.traces[0].points[-1], (-5, 6), atol=1e-12)


# Block references --------------------------------------------------------------------------------


def test_block_references_are_exploded(sheet):
    sheet.boundary()
    inner = sheet.document.blocks.new("INNER")
    inner.add_line((0, 0), (1, 0))
    outer = sheet.document.blocks.new("OUTER")
    outer.add_blockref("INNER", (1, 1), dxfattribs={"rotation": 90})
    outer.add_line((0, 0), (0, 1), dxfattribs={"layer": "JOINTS_own"})
    placed = sheet.space.add_blockref(
        "OUTER", (5, 5), dxfattribs={"layer": "JOINTS_placed", "xscale": 2, "yscale": 2}
    )
    traces = {one.joint: one for one in sheet.read().traces}
    # Layer 0 inside a block is the layer of the reference, as CAD programs draw it.
    np.testing.assert_allclose(traces["own"].points, [(5, 5), (5, 7)], atol=1e-12)
    assert f"INSERT {placed.dxf.handle}" in traces["own"].place
    nested = next(one for name, one in traces.items() if name != "own")
    np.testing.assert_allclose(nested.points, [(7, 7), (7, 9)], atol=1e-12)
    assert nested.joint == "placed"


def test_arrays_of_block_references(sheet):
    sheet.boundary()
    sheet.document.blocks.new("CRACK").add_line((0, 0), (1, 1))
    attributes = {"layer": "JOINTS", "row_count": 2, "column_count": 3}
    attributes |= {"row_spacing": 4, "column_spacing": 5}
    sheet.space.add_blockref("CRACK", (1, 1), dxfattribs=attributes)
    starts = {tuple(one.points[0]) for one in sheet.read().traces}
    assert starts == {(1 + 5 * c, 1 + 4 * r) for c in range(3) for r in range(2)}


# Units and heights -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "unit", "metres", "source"),
    [
        *((code, None, metres, str(code)) for code, (_, metres) in UNITS.items()),
        (0, None, 1.0, "unitless"),
        (5, "mm", 1e-3, "as given"),
        (5, "ft", 0.3048, "as given"),
        (5, 0.5, 0.5, "as given"),
    ],
)
def test_units(tmp_path, code, unit, metres, source):
    drawing = Sheet(tmp_path / "u.dxf", units=code).boundary().read(unit=unit)
    np.testing.assert_allclose(drawing.boundary, np.array(SQUARE) * metres, rtol=1e-15)
    assert source in drawing.unit_source
    assert any("taken as metres" in note for note in drawing.notes) == (code == 0)


def test_a_constant_height_is_dropped_and_another_refused(sheet):
    sheet.boundary(elevation=12.5)
    sheet.line((0, 1, 12.5), (20, 1, 12.5), "JOINTS")
    drawing = sheet.read()
    assert any("z = 12.5 m" in note for note in drawing.notes)
    line = sheet.line((0, 2, 13.0), (20, 2, 12.5), "JOINTS")
    with pytest.raises(CaseError, match=rf"not planar.*LINE {line.dxf.handle}"):
        sheet.read()


# Loops -------------------------------------------------------------------------------------------


def lines_round(sheet: Sheet, corners: Any, layer: str = "BOUNDARY") -> list[Any]:
    """Draw a loop as lines in a scattered order, every second one backwards."""
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    order = [*range(0, len(edges), 2), *range(1, len(edges), 2)]
    return [sheet.line(*(edges[k] if k % 2 else edges[k][::-1]), layer) for k in order]


def test_lines_are_joined_into_a_loop(sheet):
    corners = [(0, 0), (20, 0), (25, 5), (20, 10), (0, 10)]
    lines_round(sheet, corners)
    boundary = sheet.read().boundary
    assert {tuple(p) for p in boundary} == {tuple(map(float, p)) for p in corners}
    assert area(boundary) == 225.0 and shapely.LinearRing(boundary).is_ccw


@pytest.mark.parametrize("seed", range(4))
def test_any_outline_comes_back_from_its_shuffled_lines(seed):
    """Stars of random rays, in pieces of one to four edges, scattered, turned, and moved a bit."""
    random = np.random.default_rng(seed)
    count = int(random.integers(5, 60))
    turned = np.sort(random.uniform(0, 2 * math.pi, count))
    rays = random.uniform(5, 10, count)[:, None]
    star = rays * np.column_stack([np.cos(turned), np.sin(turned)]) + random.uniform(-1e5, 1e5, 2)
    cuts = np.unique([0, *random.integers(0, count, count // 2)])
    pieces = [
        star[np.arange(a, b + 1) % count] for a, b in zip(cuts, [*cuts[1:], count], strict=True)
    ]
    lines = [
        DrawnLine(
            points=(piece[::-1] if random.random() < 0.5 else piece)
            + random.uniform(-1e-7, 1e-7, (len(piece), 2)),
            closed=False,
            place=f"piece {k}",
        )
        for k, piece in enumerate(pieces)
    ]
    random.shuffle(lines)
    found = loops_of(lines, 1e-6, "x")
    assert len(found) == 1
    corners, _ = ring(found[0], "the outline", "x")
    first = int(np.argmin(np.hypot(*(corners - star[0]).T)))
    np.testing.assert_allclose(np.roll(corners, -first, axis=0), star, atol=2e-7)


def test_small_gaps_are_closed_and_said(sheet):
    sheet.line((0, 0), (20, 0), "BOUNDARY")
    sheet.line((20, 1e-4), (20, 10), "BOUNDARY")
    sheet.line((20, 10), (0, 0), "BOUNDARY")
    drawing = sheet.read()
    assert len(drawing.boundary) == 3
    assert any("gap of 0.0001 m was closed" in note for note in drawing.notes)


def test_a_gap_is_refused_with_its_size_and_place(sheet):
    sheet.line((0, 0), (20, 0), "BOUNDARY")
    first = sheet.line((20.03, 0.04), (20, 10), "BOUNDARY")
    sheet.line((20, 10), (0, 0), "BOUNDARY")
    with pytest.raises(CaseError, match=r"gap of 0\.05 m from \(20") as refused:
        sheet.read()
    assert first.dxf.handle in str(refused.value)
    assert len(sheet.read(tolerance=0.1).boundary) == 3


@pytest.mark.parametrize("tolerance", [1e-300, 1e-9])
def test_the_smallest_tolerance_joins_ends_that_are_equal(sheet, tolerance):
    lines_round(sheet, SQUARE)
    assert area(sheet.read(tolerance=tolerance).boundary) == 200.0


def test_points_and_lines_drawn_twice_are_taken_once_and_said(sheet):
    lines_round(sheet, SQUARE)
    sheet.line((20, 0), (0, 0), "BOUNDARY")
    twice = [(1, 1), (1 + 1e-5, 1), (3, 1), (3, 3)]
    sheet.space.add_lwpolyline(twice, close=True, dxfattribs={"layer": "OPENINGS"})
    drawing = sheet.read()
    assert area(drawing.boundary) == 200.0
    np.testing.assert_array_equal(drawing.openings[0].points, [(1, 1), (3, 1), (3, 3)])
    assert any("1 lines drawn twice" in note for note in drawing.notes)
    assert any("1 points within" in note and "merged" in note for note in drawing.notes)


def test_a_branch_is_refused(sheet):
    lines_round(sheet, SQUARE)
    branch = sheet.line((20, 0), (30, 0), "BOUNDARY")
    sheet.line((30, 0), (30, 5), "BOUNDARY")
    sheet.line((30, 5), (20, 0), "BOUNDARY")
    with pytest.raises(CaseError, match=r"4 ends of lines meet at \(20, 0\)") as refused:
        sheet.read()
    assert branch.dxf.handle in str(refused.value)


def test_coordinates_far_from_the_origin_keep_their_digits(sheet):
    far = [(x + 4.5e6, y + 5.7e6) for x, y in SQUARE]
    lines_round(sheet, far)
    boundary = sheet.read().boundary
    assert {tuple(p) for p in boundary} == set(far)


# The convention of DDA for Windows ---------------------------------------------------------------


def test_the_convention_of_dda_for_windows(sheet):
    document = sheet.document
    document.layers.add("blue", color=5)
    for start, end in (((-1, 0), (21, 0)), ((20, -1), (20, 11)), ((21, 10), (-1, 10))):
        sheet.line(start, end, "0", color=1)
    sheet.line((0, 11), (0, -1), "blue")
    sheet.space.add_circle((10, 5), 2, dxfattribs={"color": 2})
    for letter, at in (("F", (1, 1)), ("L", (2, 1)), ("m", (3, 1)), ("H", (10, 5)), ("x", (4, 4))):
        sheet.space.add_mtext(letter, dxfattribs={"insert": at})
    drawing = read_dda_dxf(sheet.saved())
    assert {tuple(p) for p in drawing.boundary} == {tuple(p) for p in SQUARE}
    assert [t.joint for t in drawing.traces] == ["type-3"]
    np.testing.assert_array_equal(drawing.traces[-1].points[0], drawing.traces[-1].points[-1])
    spots = ("fixed_points", "load_points", "measured_points", "hole_points")
    found = {name: getattr(drawing, name)[0].at.tolist() for name in spots}
    assert found == dict(zip(spots, ([1, 1], [2, 1], [3, 1], [10, 5]), strict=True))
    assert [one.what for one in drawing.left_out][:2] == [
        "MTEXT 'x'",
        "type-2 from (-1, 0) m to (21, 0) m",
    ]
    # The four sides cut nothing.
    assert [one.what[:6] for one in drawing.left_out[1:]] == ["type-2"] * 3 + ["type-6"]
    # read_drawing tells it by its texts
    assert len(read_drawing(sheet.path).hole_points) == 1


def test_lines_of_dda_for_windows_that_just_miss_are_lengthened_and_said(sheet):
    for start, end in (
        ((0, 1e-5), (0, 10)),
        ((0, 0), (20, 0)),
        ((20, 1e-5), (20, 10)),
        ((20 - 1e-5, 10), (1e-5, 10)),
    ):
        sheet.line(start, end, "0")
    sheet.line((-1, 5), (21, 5), "0", color=1)
    drawing = read_dda_dxf(sheet.saved())
    assert area(drawing.boundary) == pytest.approx(200.0, rel=1e-9)
    assert any("extended" in note for note in drawing.notes)
    assert [trace.joint for trace in drawing.traces] == ["type-2"]


def test_a_drawing_of_neither_convention_is_refused_with_its_layers(sheet):
    lines_round(sheet, SQUARE, "outline")
    with pytest.raises(CaseError, match=r"layer BOUNDARY(?s:.)*the layers are: outline"):
        read_drawing(sheet.saved())
