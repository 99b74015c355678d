"""Cases that are cut: tables of the rock mass, what becomes of them, where blocks are held."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from clast.block.inertia import block_frames
from clast.case.case_file import Case
from clast.case.drawn_case import TO_BE_GIVEN, case_text
from clast.contact.detection import detect
from clast.errors import CaseError, ModelError
from clast.model.joints import WELD_STRENGTH
from clast.model.model import Model
from clast.model.state import initial_state
from clast.rockmass import Domain, JointSet, Lognormal, cut
from clast.rockmass.readers import read_drawing
from clast.step.modified import search_of_modified
from scenes.cut_cases import TUNNEL, TWO_SETS, WALL


def edges(model: Model) -> dict[str, int]:
    """Return how many edges of blocks have each joint."""
    names = [one.name for one in model.joint_table.joints]
    joint, count = np.unique(model.edge_joint, return_counts=True)
    return {names[k]: int(c) for k, c in zip(joint, count, strict=True) if k >= 0}


def test_two_sets_are_cut_as_a_script_cuts_them():
    case = Case.from_toml(TWO_SETS)
    model = case.model()
    spacing = Lognormal(mean=2.0, sd=0.3)
    sets = [
        JointSet(name="bedding", joint="bedding", angle=10.0, spacing=spacing),
        JointSet(name="cross", joint="cross", angle=95.0, spacing=2.5),
    ]
    box = [(0, 0), (10, 0), (10, 8), (0, 8)]
    same = cut(Domain(boundary=box, rock="granite"), sets, seed=7)
    np.testing.assert_array_equal(model.vertices, same.vertices)
    assert model.block_name == tuple(str(k + 1) for k in range(same.block_count))
    assert model.area.sum() == pytest.approx(80.0, rel=1e-9)
    assert set(edges(model)) == {"bedding", "cross"}
    assert sum(edges(model).values()) == int((same.edge_joint >= 0).sum())


def test_the_seed_moves_only_what_is_random():
    one, other = (Case.from_toml(TWO_SETS, [f"domain.seed={k}"]).model() for k in (7, 8))
    again = Case.from_toml(TWO_SETS).model()
    np.testing.assert_array_equal(one.vertices, again.vertices)
    assert one.vertices.shape != other.vertices.shape or (one.vertices != other.vertices).any()


def test_a_case_is_cut_once(monkeypatch):
    case = Case.from_toml(TWO_SETS)
    found = case.cut()
    monkeypatch.setattr("clast.rockmass.cut", None)
    assert case.cut() is found
    assert case.with_method(process="modified").cut() is found
    case.model()


def test_fixed_sides_hold_the_blocks_on_them():
    case = Case.from_toml(TWO_SETS, ['domain.fixed_sides=["bottom", "left"]'])
    model = case.model()
    start = model.block_start[:-1]
    lowest = np.minimum.reduceat(model.vertices, start)
    np.testing.assert_array_equal(model.fixed, (lowest < 1e-9).any(axis=1))
    assert 0 < model.fixed.sum() < model.block_count


def test_a_wall_with_an_opening():
    model = Case.from_toml(WALL).model()
    assert model.area.sum() == pytest.approx(4.0 * 2.0 - 0.8 * 1.0, rel=1e-9)
    assert set(edges(model)) == {"bed", "head"}
    inside = (np.abs(model.vertices - [2.0, 0.9]) < [0.4 - 1e-6, 0.5 - 1e-6]).all(axis=1)
    assert not inside.any()


def test_a_tunnel_in_two_rocks_is_rock_until_it_is_excavated():
    model = Case.from_toml(TUNNEL).model()
    found = edges(model)
    assert found["construction-joint:heading"] > 10
    weld = next(j for j in model.joint_table.joints if j.name.startswith("construction"))
    assert weld.cohesion == weld.tensile_strength == WELD_STRENGTH
    assert model.area.sum() == pytest.approx(20.0 * 20.0, rel=1e-9)
    names = np.array([rock.name for rock in model.rocks])[model.block_rock]
    middle = np.add.reduceat(model.vertices, model.block_start[:-1])
    middle = middle / np.diff(model.block_start)[:, None]
    assert set(names[middle[:, 1] > 6.0]) == {"granite"}
    assert set(names[middle[:, 1] < 4.0]) == {"shale"}
    void = Case.from_toml(TUNNEL, ["opening.1.excavated=true"]).model()
    assert "construction-joint:heading" not in edges(void)
    assert void.area.sum() < 400.0 - 0.99 * np.pi * 4.0


def test_the_strength_of_welds_is_no_cause_for_a_warning():
    warnings = Case.from_toml(TUNNEL).examine().warnings
    assert not [text for text in warnings if "construction-joint" in text]


def test_blocks_by_hand_come_first():
    text = TWO_SETS + '[[block]]\nname = "load"\nvertices = [[4, 8], [5, 8], [5, 9], [4, 9]]\n'
    model = Case.from_toml(text).model()
    assert model.block_name[:2] == ("load", "2")


def test_a_joint_of_a_set_that_has_no_edges_is_no_error():
    text = (
        TWO_SETS + "[joint.fault]\nfriction_angle = 15\n[[trace]]\npoints = [[3, 3], [3.2, 3.1]]\n"
    )
    case = Case.from_toml(text + 'joint = "fault"\n')
    model = case.model()
    assert "fault" in [one.name for one in model.joint_table.joints]
    assert "fault" not in edges(model)
    assert any("border no block were taken out" in note for note in model.notes)
    with pytest.raises(ModelError, match="is assigned to no contact"):
        Case.from_toml(text).model()


def test_what_is_given_by_hand_between_blocks_goes_before_edges():
    text = TWO_SETS + '[joint.stronger]\nfriction_angle = 50\nbetween = [["1", "2"]]\n'
    table = Case.from_toml(text).model().joint_table
    assert table.block_pair.tolist() == [[0, 1]]


@pytest.mark.parametrize("text", [TWO_SETS, WALL, TUNNEL], ids=["sets", "wall", "tunnel"])
def test_a_case_written_anew_is_cut_alike(text):
    case = Case.from_toml(text)
    again = Case.from_toml(case.to_toml())
    assert again.to_toml() == case.to_toml()
    np.testing.assert_array_equal(case.model().vertices, again.model().vertices)
    np.testing.assert_array_equal(case.model().edge_joint, again.model().edge_joint)


@pytest.mark.parametrize(
    "values",
    [
        "spacing = {distribution = 'uniform', low = 1.0, high = 2.0}",
        "spacing = {distribution = 'normal', mean = 1.5, sd = 0.1}",
        "spacing = {distribution = 'exponential', mean = 1.5}",
        "spacing = {distribution = 'values', values = [1.0, 2.0]}",
        "spacing = 1\ntrace_length = 4\nbridge_length = 0.5\nstagger = 0.5\norigin = [1, 2]",
        "spacing = 1\nangle_spread = {distribution = 'von-mises', kappa = 500}",
        "spacing = 1\nwithin = [[0, 0], [5, 0], [5, 8], [0, 8]]",
        "model = 'baecher'\nintensity = 1.5\ntrace_length = 5\nseed = 3",
        "model = 'veneziano'\nintensity = 1.5\ntrace_length = 5\nbridge_length = 1",
        "model = 'poisson-lines'\nintensity = 1.0",
    ],
)
def test_models_and_distributions_by_name(values):
    text = TWO_SETS + f'[[joint_set]]\nname = "third"\nangle = 60\n{values}\n'
    case = Case.from_toml(text)
    assert case.model().area.sum() == pytest.approx(80.0, rel=1e-9)
    assert case.cut().cut.report.sets[-1].lines > 0


def test_cells_and_a_set_given_in_space():
    head, _, domain = TWO_SETS.partition("[[joint_set]]")[0].partition("[joint.bedding]")
    start = head + domain[domain.index("[domain]") :]
    cells = '[[joint_set]]\nname = "cells"\nmodel = {name = "voronoi", count = 40, rounds = 2}\n'
    assert Case.from_toml(start + cells).model().block_count >= 40
    space = """[[joint_set]]
name = "space"
dip = 60
dip_direction = 120
spacing = 1.0
spacing_is = "true"
fisher_kappa = 400
"""
    case = Case.from_toml(start.replace("seed = 7", "seed = 7\nsection_azimuth = 90") + space)
    # the trace dips to +x by atan(tan 60 cos 30) and lines are 1/|n in the section| apart
    report = case.cut().cut.report.sets[0]
    assert report.p21_asked == pytest.approx(
        np.hypot(np.sin(np.pi / 3) * np.sin(2 * np.pi / 3), 0.5)
    )


def drawing(path: Path, units: int) -> None:
    document = ezdxf.new("R2010", units=units)
    space = document.modelspace()
    layers = {
        "BOUNDARY": [(0, 0), (10, 0), (10, 8), (0, 8)],
        "HEADING": [(4, 3), (6, 3), (6, 5), (4, 5)],
        "SHALE": [(0, 0), (10, 0), (10, 2), (0, 2)],
    }
    for layer, corners in layers.items():
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    for y in (2, 4, 6):
        space.add_line((0, y), (10, y), dxfattribs={"layer": "JOINTS"})
    document.saveas(path)


FILES = """schema = 1
time = {step = 1e-3, end = 1e-3}
[rock]
granite = {young = 1e9, poisson = 0.2, density = 2700.0}
shale = {young = 1e9, poisson = 0.2, density = 2400.0}
[joint.bedding]
friction_angle = 20.0
[joint.fault]
friction_angle = 15.0
[domain]
boundary = {file = "site.dxf", layer = "boundary"}
rock = "granite"
[[opening]]
name = "heading"
file = "site.dxf"
layer = "HEADING"
excavated = true
[[region]]
name = "shale"
polygon = {file = "site.dxf", layer = "SHALE"}
rock = "shale"
[[trace]]
file = "site.dxf"
layer = "JOINTS"
joint = "bedding"
[[trace]]
file = "traces.csv"
"""


def test_files_are_looked_for_beside_the_case(tmp_path: Path):
    drawing(tmp_path / "site.dxf", 0)
    (tmp_path / "traces.csv").write_text("x1,y1,x2,y2,joint\n2,0,2,8,fault\n8,0,8,8,\n")
    (tmp_path / "case.toml").write_text(FILES)
    model = Case.from_toml(tmp_path / "case.toml").model()
    assert model.area.sum() == pytest.approx(76.0, rel=1e-9)
    found = edges(model)
    assert set(found) == {"bedding", "fault"}
    assert found["fault"] == 2 * 4  # four courses, two sides
    assert {rock.name: (model.block_rock == k).sum() for k, rock in enumerate(model.rocks)} == {
        "granite": model.block_count - 3,
        "shale": 3,
    }
    assert any("unitless" in note and "domain, boundary" in note for note in model.notes)


def test_clockwise_outlines_of_files_are_turned_round_and_said(tmp_path: Path):
    """Outlines in a drawing and in a table, all of them clockwise."""
    document = ezdxf.new("R2010", units=6)
    corners = [(0, 0), (0, 8), (10, 8), (10, 0)]
    layer = {"layer": "BOUNDARY"}
    document.modelspace().add_lwpolyline(corners, close=True, dxfattribs=layer)
    document.saveas(tmp_path / "site.dxf")
    (tmp_path / "heading.csv").write_text("x,y\n4,3\n4,5\n6,5\n6,3\n")
    text = FILES.partition("[[region]]")[0].replace("[joint.fault]\nfriction_angle = 15.0\n", "")
    text = text.replace('file = "site.dxf"\nlayer = "HEADING"', 'file = "heading.csv"')
    text += '[[joint_set]]\nname = "a"\nangle = 0\nspacing = 2\njoint = "bedding"\n'
    (tmp_path / "case.toml").write_text(text)
    found = Case.from_toml(tmp_path / "case.toml").cut()
    assert found.cut.report.area == pytest.approx(76.0, rel=1e-9)
    turned = [note for note in found.notes if "ran clockwise and was turned round" in note]
    assert [note.partition(",")[0] for note in turned] == ["domain", "opening 'heading'"]


def test_a_unit_goes_before_that_of_the_drawing(tmp_path: Path):
    drawing(tmp_path / "site.dxf", 6)
    text = FILES.partition("[[opening]]")[0].replace('layer = "b', 'unit = "cm", layer = "b')
    text += '[[joint_set]]\nname = "a"\nangle = 0\nspacing = 0.02\njoint = "bedding"\n'
    text = text.replace("[joint.fault]\nfriction_angle = 15.0\n", "")
    (tmp_path / "case.toml").write_text(text)
    assert Case.from_toml(tmp_path / "case.toml").model().area.sum() == pytest.approx(80e-4)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('layer = "boundary"', 'layer = "RIM"', ["domain, boundary", "nothing is drawn", "SHALE"]),
        (', layer = "boundary"', "", ["domain, boundary", "the layer is missing"]),
        ('"site.dxf", layer = "b', '"none.dxf", layer = "b', ["no such file", "none.dxf"]),
        ('layer = "HEADING"', 'layer = "JOINTS"', ["opening 'heading', file", "site.dxf"]),
        ('file = "traces.csv"', 'file = "traces.csv"\nlayer = "A"', ["trace 2, file", "no layer"]),
        ('file = "traces.csv"', 'file = "traces.svg"', ["trace 2, file", "neither .dxf nor .csv"]),
        ('file = "traces.csv"', 'file = "site.csv"', ["trace 2, file", "no such file"]),
        (
            "[joint.fault]",
            "[joint.fold]",
            ["trace 2 (traces.csv, line 2)", "'fault'", "bedding, fold"],
        ),
    ],
)
def test_files_that_cannot_be_used(tmp_path: Path, old: str, new: str, words: list[str]):
    drawing(tmp_path / "site.dxf", 6)
    (tmp_path / "traces.csv").write_text("x1,y1,x2,y2,joint\n2,0,2,8,fault\n8,0,8,8,\n")
    assert old in FILES
    (tmp_path / "case.toml").write_text(FILES.replace(old, new, 1))
    with pytest.raises(CaseError) as refused:
        Case.from_toml(tmp_path / "case.toml").model()
    for word in ["case.toml", *words]:
        assert word in str(refused.value), str(refused.value)


def test_a_trace_of_a_file_is_named_by_its_place(tmp_path: Path):
    drawing(tmp_path / "site.dxf", 6)
    (tmp_path / "traces.csv").write_text("x1,y1,x2,y2\n2,0,2,8\n20,0,20,8\n")
    (tmp_path / "case.toml").write_text(FILES.replace("[joint.fault]\nfriction_angle = 15.0\n", ""))
    notes = Case.from_toml(tmp_path / "case.toml").model().notes
    assert any("trace 2 (traces.csv, line 3) (10 m)" in note for note in notes), notes


def with_numbers(content: str, numbers: dict[str, Any]) -> str:
    """Return the text of a drawing's case with its numbers in it."""
    for key, value in numbers.items():
        content = content.replace(f'{key} = "{TO_BE_GIVEN}"', f"{key} = {value}")
    assert f'= "{TO_BE_GIVEN}"' not in content
    return content


def test_the_case_of_a_drawing_is_one_once_its_numbers_are_given(tmp_path: Path):
    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    corners = [(0, 0), (20000, 0), (20000, 10000), (0, 10000)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "BOUNDARY"})
    space.add_circle((10000, 6000), 1000, dxfattribs={"layer": "OPENINGS_heading"})
    for y in (3000, 5800, 8000):
        space.add_line((0, y), (20000, y), dxfattribs={"layer": "JOINTS_bedding"})
    space.add_point((0, 0), dxfattribs={"layer": "FIXED"})
    document.saveas(tmp_path / "site.dxf")
    text = case_text(read_drawing(tmp_path / "site.dxf"))
    values = {"step": 1e-3, "end": 0.1, "young": 1e9, "poisson": 0.2, "density": 2700.0}
    (tmp_path / "site.toml").write_text(with_numbers(text, {**values, "friction_angle": 30.0}))
    case = Case.from_toml(tmp_path / "site.toml")
    model = case.model()
    assert set(edges(model)) >= {"bedding"}
    assert model.area.sum() == pytest.approx(200.0 - np.pi, rel=1e-3)
    assert len(model.fixed_points.at) == 1


def test_contacts_have_the_friction_of_their_sets():
    case = Case.from_toml(TWO_SETS)
    model = case.model()
    method = case.method(model)
    state = initial_state(model)
    centroid = block_frames(model, state).centroid
    found = detect(model, method.corner_rule, state, centroid, search_of_modified(method))
    after = np.arange(1, len(model.vertices) + 1)
    after[model.block_start[1:] - 1] = model.block_start[:-1]
    way = model.vertices[after] - model.vertices
    angle = np.degrees(np.arctan2(way[:, 1], way[:, 0])) % 180.0
    inner = model.edge_joint[found.edge] > 0
    flat = np.abs(angle[found.edge] - 10.0) < 1.0
    assert inner.sum() > 50 and 0 < (flat & inner).sum() < inner.sum()
    due = np.where(flat, np.tan(np.radians(20.0)), np.tan(np.radians(35.0)))
    np.testing.assert_allclose(found.friction[inner], due[inner], rtol=1e-12)


# Lintels -----------------------------------------------------------------------------------------

LINTEL = """[[block]]
name = "lintel"
vertices = [[1.2, 1.4], [2.8, 1.4], [2.8, 1.6], [1.2, 1.6]]
rock = "brick"
"""


def test_a_region_may_be_one_block():
    region = """[[region]]
name = "lintel"
polygon = [[1.2, 1.4], [2.8, 1.4], [2.8, 1.6], [1.2, 1.6]]
joint = "bed"
one_block = true
"""
    case = Case.from_toml(WALL + region)
    model = case.model()
    assert model.area.max() == pytest.approx(1.6 * 0.2, rel=1e-9)
    assert model.area.sum() == pytest.approx(7.2, rel=1e-9)
    pieces = Case.from_toml(WALL + region, ["region.1.one_block=false"]).model()
    assert pieces.block_count == model.block_count + 4


def test_a_block_by_hand_in_rock_that_is_cut_is_told_to_make_room():
    with pytest.raises(ModelError) as caught:
        Case.from_toml(WALL + LINTEL).model()
    message = str(caught.value)
    assert "block 1 'lintel'" in message and "0.32 m2" in message
    assert "[[opening]] with excavated = true" in message and "one_block = true" in message


def test_a_block_by_hand_fits_into_an_opening():
    room = """[[opening]]
name = "room"
shape = "box"
corner = [1.2, 1.4]
size = [1.6, 0.2]
excavated = true
"""
    model = Case.from_toml(WALL + room + LINTEL).model()
    assert model.block_name[0] == "lintel"
    assert model.area.sum() == pytest.approx(7.2, rel=1e-9)
    assert len(model.overlaps.pair) == 0


@pytest.mark.parametrize(("dip", "towards"), [(60.0, 130.0), (25.0, 290.0), (80.0, 100.0)])
@pytest.mark.parametrize("azimuth", [90.0, 270.0, 35.0])
def test_apparent_dips_are_told(dip, towards, azimuth):
    """tan(seen) = tan(dip) |cos(dip direction - azimuth)|, down along +x where that is positive."""
    one = {"name": "J", "dip": dip, "dip_direction": towards, "spacing": 1.5, "spacing_is": "true"}
    content = tomllib.loads(TWO_SETS)
    content["joint_set"] = [one, {"name": "K", "angle": 10.0, "spacing": 2.0}]
    content["domain"]["section_azimuth"] = azimuth
    content["joint"] = {"default": content["joint"]["bedding"]}
    case = Case.validated(content, "x.toml")
    along = np.cos(np.radians(towards - azimuth))
    seen = np.degrees(np.arctan(np.tan(np.radians(dip)) * abs(along)))
    side = "right" if along > 0.0 else "left"
    first, second = case.cut().cut.report.sets
    assert abs(first.angle) == pytest.approx(seen, rel=1e-9)
    assert first.seen == f"{seen:.3g}° to the {side}"
    assert second.seen == "10° to the left"
    (note,) = (one for one in case.model().notes if "is seen in the section" in one)
    assert first.seen in note and f"{first.spacing_factor:.3g} times" in note
    assert "'K'" not in " ".join(case.model().notes)
