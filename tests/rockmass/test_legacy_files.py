"""Shi's text files and the XML of DDA for Windows: every number arrives, or is named."""

from __future__ import annotations

import numpy as np
import pytest

from clast.errors import CaseError
from clast.rockmass.drawings.dda_xml import read_dda_xml
from clast.rockmass.drawings.drawing import Drawing
from clast.rockmass.drawings.shi_files import read_shi_analysis, read_shi_geometry
from clast.rockmass.readers import read_blocks
from scenes import legacy_files


@pytest.fixture
def written(tmp_path):
    def write(text, name="x.dat"):
        path = tmp_path / name
        path.write_text(text, "utf-8")
        return path

    return write


@pytest.fixture(params=["text", "xml"])
def both(request, written):
    """The same rock mass from each of the two formats, in t and kN."""
    if request.param == "text":
        return read_shi_geometry(written(legacy_files.GEOMETRY), 1000.0)
    return read_dda_xml(written(legacy_files.XML, "x.xml"), 1000.0)


@pytest.fixture(params=["text", "xml"])
def analysis(request, written):
    if request.param == "text":
        return read_shi_analysis(written(legacy_files.ANALYSIS), 1000.0)
    return read_dda_xml(written(legacy_files.XML, "x.xml"), 1000.0).analysis


# Geometry ----------------------------------------------------------------------------------------


def test_the_domain_is_what_overshooting_lines_enclose(both):
    corners = {(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)}
    assert {tuple(point) for point in both.boundary} == corners and len(both.boundary) == 4
    assert both.half_height == 5.0 and both.node_distance == 0.001


def test_lines_and_points_of_the_geometry(both):
    assert [one.joint for one in both.traces] == ["type-2", "type-3"]
    np.testing.assert_array_equal(both.traces[1].points, [(10, -1), (10, 11)])
    np.testing.assert_array_equal(both.fixed_lines[0].ends, [(0, 0), (20, 0)])
    np.testing.assert_array_equal(both.fixed_points[0].at, (0, 0))
    assert len(both.fixed_lines) == len(both.fixed_points) == 1
    np.testing.assert_array_equal(both.load_points[0].at, (10, 9))
    np.testing.assert_array_equal(both.measured_points[0].at, (3, 3))
    np.testing.assert_array_equal(both.hole_points[0].at, (15, 7))
    assert both.measured_points[0].name == "M1"
    assert [(one.name, one.ends.tolist()) for one in both.material_lines] == [
        ("rock-2", [[0, 0], [1, 1]])
    ]


def test_a_bolt_is_as_stiff_as_its_length_makes_it(both):
    """E0 by strain over a length of 2 m; forces in kN."""
    kind = both.bolt_kinds[0]
    assert (kind.stiffness, kind.yield_force, kind.pretension) == (5e5, 5e4, 100.0)
    assert both.bolts[0].name == kind.name


def test_what_a_text_geometry_has_too_much_is_named(written):
    drawing = read_shi_geometry(written(legacy_files.GEOMETRY + "7 8 nine"))
    left = [str(one) for one in drawing.left_out]
    assert "line 13: joint of type-2 at (5, 5) m: it has no length" in left
    assert any("type-1 of 4 boundary lines" in text for text in left)
    assert any(text.startswith("line 22: 7 8 nine") for text in left)


OUTER = "0 0 20 0 1\n20 0 20 10 1\n20 10 0 10 1\n0 10 0 0 1\n"
BOX = "8 4 12 4 2\n12 4 12 6 2\n12 6 8 6 2\n8 6 8 4 2\n"


def test_a_box_of_boundary_lines_is_an_opening_with_a_hole_point_in_it_and_joints_without(written):
    def box(holes: str) -> Drawing:
        text = f"0.001\n8 8\n0\n0\n0\n0 0 {holes.count(chr(10))}\n{OUTER}{BOX}{holes}"
        return read_shi_geometry(written(text))

    drawing = box("10 5\n1 1\n")
    assert len(drawing.boundary) == 4
    assert {tuple(p) for p in drawing.openings[0].points} == {(8, 4), (12, 4), (12, 6), (8, 6)}
    assert [tuple(spot.at) for spot in drawing.hole_points] == [(1, 1)]
    drawing = box("")
    assert [trace.joint for trace in drawing.traces] == ["type-2"] * 4
    assert drawing.openings == () and len(drawing.boundary) == 4
    assert ["type-1 of 4 boundary lines"] == [one.what for one in drawing.left_out]


def test_all_lines_together_make_the_domain_where_the_boundary_alone_does_not(written):
    text = "0.001\n4 1\n0\n0\n0\n0 0 0\n0 0 9 0 1\n9 -1 9 9 1\n9 8 0 8 1\n0 9 0 -1 1\n"
    drawing = read_shi_geometry(written(text))
    assert {tuple(p) for p in drawing.boundary} == {(0, 0), (9, 0), (9, 8), (0, 8)}
    assert any("enclose nothing by themselves" in note for note in drawing.notes)


def test_joints_outside_of_the_domain_are_named(written):
    text = legacy_files.GEOMETRY.replace("-1  5 21  5 2", "-1 15 21 15 2")
    drawing = read_shi_geometry(written(text))
    assert [trace.joint for trace in drawing.traces] == ["type-3"]
    assert any("joint of type-2 from (-1, 15) m" in one.what for one in drawing.left_out)


def test_boundary_lines_that_just_miss_are_lengthened_and_said(written):
    """Corners 1 mm apart, within 1.25 e00 w0 = 5 mm of each other."""
    lines = "0.001 0 9 0 1\n9 0.001 9 8 1\n9 8 0 8 1\n0 8 0 0 1\n"
    text = f"0.001\n4 4\n0\n0\n0\n0 0 0\n{lines}"
    drawing = read_shi_geometry(written(text))
    np.testing.assert_allclose(np.ptp(drawing.boundary, axis=0), (9, 8), atol=1e-12)
    assert len(drawing.boundary) == 4
    assert any("extended by 0.005 m" in note for note in drawing.notes)


# Analysis ----------------------------------------------------------------------------------------


def test_materials_and_times_of_the_analysis(analysis):
    first, second = analysis.rocks
    assert (first.density, first.weight, first.young, first.poisson) == pytest.approx(
        (2700.0, 26460.0, 5e9, 0.25)
    )
    assert first.initial_stress == (-1e4, -1e5, 1e3)
    assert second.velocity == (1.0, 0.0, 0.5) and second.name == "rock-2"
    strengths = [(j.friction_angle, j.cohesion, j.tensile_strength) for j in analysis.joints]
    assert strengths == [(20, 0, 0), (30, 5000, 1000), (35, 2500, 0)]
    assert [j.name for j in analysis.joints] == ["type-1", "type-2", "type-3"]
    assert (analysis.dynamic_ratio, analysis.steps, analysis.step) == (1.0, 100, 0.001)
    assert analysis.displacement_ratio == 0.01


def test_columns_8_to_10_and_a_density_in_tonnes_are_noticed(written):
    given = read_shi_analysis(written(legacy_files.ANALYSIS))
    assert [(one.what, one.place) for one in given.left_out] == [
        ("columns 8 to 10 of block material 2: 0 1 0", "line 5")
    ]
    assert any("2.7 kg/m3" in note and "mass_unit=1000" in note for note in given.notes)
    notes = read_shi_analysis(written(legacy_files.ANALYSIS), 1000.0).notes
    assert not any("kg/m3" in note for note in notes)


def test_the_rest_of_the_xml(written):
    drawing = read_dda_xml(written(legacy_files.XML, "x.xml"), 1000.0)
    analysis = drawing.analysis
    assert (analysis.plane, analysis.gravity, analysis.frame_steps) == ("strain", 9.8, 10)
    assert analysis.rotation == "linear"
    assert [(f.point, f.time, f.force) for f in analysis.forces] == [
        (1, 0, (0, -5000)),
        (1, 1, (0, -5000)),
        (2, 0, (0, 0)),
        (2, 1, (0, -7000)),
    ]
    left = [str(one) for one in (*drawing.left_out, *analysis.left_out)]
    for words in ("damping 0.02 of", "istrain 0 1e-4 0 of", "pfactor=50", "stiffness 1e3"):
        assert sum(words in text for text in left) == 1, words
    assert len(left) == 4


def test_geometry_and_analysis_may_be_two_xml_files(written):
    geometry, analysis = legacy_files.XML.split("  </dda:Geometry>\n")
    head = geometry.partition("  <dda:Geometry>")[0]
    first = read_dda_xml(written(f"{geometry}</dda:Geometry></dda:DDA>", "g.xml"))
    second = read_dda_xml(written(head + analysis, "a.xml"))
    assert first.boundary is not None and first.analysis.rocks == ()
    assert second.boundary is None and len(second.analysis.rocks) == 2


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE DDA SYSTEM "other.dtd"><DDA/>',
        '<!DOCTYPE DDA [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><DDA>&b;</DDA>',
        '<!DOCTYPE DDA [<!ENTITY x SYSTEM "file:///etc/passwd">]><DDA>&x;</DDA>',
    ],
)
def test_document_types_and_entities_are_refused(written, text):
    with pytest.raises(CaseError, match="document type or an entity"):
        read_dda_xml(written(text, "x.xml"))


# Blocks ------------------------------------------------------------------------------------------


def test_a_block_file(written):
    """The four slots behind each block are passed over; the clockwise triangle is turned round."""
    blocks = read_blocks(written(legacy_files.BLOCKS))
    np.testing.assert_array_equal(blocks.polygon(0), [(0, 0), (1, 0), (1, 1), (0, 1)])
    np.testing.assert_array_equal(blocks.polygon(1), [(1, 0), (2, 0.5), (1, 1)])
    assert blocks.rock == ("rock-1", "rock-2")
    assert blocks.edge_joint[:4] == ("type-1", "type-2", "type-3", "")
    # Edge (1,0)-(1,1) has joint 1, (1,1)-(2,.5) joint 2, (2,.5)-(1,0) joint 3.
    assert blocks.edge_joint[4:] == ("type-3", "type-2", "type-1")
    assert any("reversed: 2" in note for note in blocks.notes)
    assert "1 fixed, 0 load, 1 measured points: 0.5 0.5 1" in blocks.left_out[0].what
