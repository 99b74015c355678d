"""[repair] and [[block_file]]: cases whose blocks were drawn a little apart."""

from __future__ import annotations

import re

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.drawn_case import TOLERANCE_MAX, blocks_text, put_together
from clast.errors import CaseError, ModelError
from clast.inputs.builder import InputBuilder
from clast.rockmass import BlockRepair
from clast.rockmass.drawings.block_arrays import blocks_of
from clast.rockmass.drawings.blocks_out import write_blocks_npz
from clast.run.method_warnings import check_overlaps, method_warnings
from scenes.drawn_blocks import rounded, wall

HEAD = """
schema = 1
[time]
step = 1e-3
end = 1e-2
[rock.granite]
young = 50e9
poisson = 0.2
density = 2700.0
[joint.default]
friction_angle = 30.0
[joint.bed]
friction_angle = 40.0
"""
BLOCKS = """
[[block]]
vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]
fixed = true
edge_joint = ["", "", "bed", ""]
[[block]]
vertices = [[0.3, 0.9996], [1.3, 0.9996], [1.3, 2], [0.3, 2]]
[geometry]
vertices = [[1.3004, 1.0003], [2, 1.0003], [1.9997, 2.0], [1.3004, 2.0]]
[[geometry.blocks]]
loop = [1, 4, 3, 2]
"""
REPAIR = "[repair]\ntolerance = 1e-3\n"


def case(*parts: str) -> Case:
    return Case.from_toml("".join(parts))


def test_blocks_of_all_tables_are_put_together():
    model = case(HEAD, BLOCKS, REPAIR).model()
    loops = [
        model.vertices[model.block_start[k] : model.block_start[k + 1]] + model.origin
        for k in range(3)
    ]
    by_name = dict(zip(model.block_name, loops, strict=True))
    # the clockwise loop of [geometry] is turned round, and named in the notes
    assert "runs clockwise" in model.notes[0]
    floor = next(one for one in loops if len(one) >= 4 and one[:, 1].min() == 0.0)
    np.testing.assert_array_equal(floor[:2], [(0, 0), (2, 0)])
    bottoms = np.concatenate([one[one[:, 1] < 1.5] for one in loops if one is not floor])
    assert (bottoms[:, 1] == pytest.approx(1.0, abs=1e-3)) and len(by_name) == 3
    assert len(model.overlaps.pair) == 0
    assert [one.count > 0 for one in model.repairs] == [True] * len(model.repairs)
    assert any("became one" in one.what for one in model.repairs)
    first = model.repairs[0]
    assert len(first.places) <= 5 and "(" in str(first)


def test_a_refused_overlap_names_the_table():
    stiff = "[method]\ncontact_law = {name = 'penalty', normal_stiffness = 1e13}\n"
    drawn = case(HEAD, BLOCKS, stiff)
    model = drawn.model()
    said = r"(?s)overlaps block .* where coordinates are rounded, \[repair\] tolerance = "
    with pytest.raises(ModelError, match=said) as caught:
        check_overlaps(model, drawn.method(model))
    tolerance = str(caught.value).split("[repair] tolerance = ")[1].split(" ")[0]
    assert case(HEAD, BLOCKS, f"[repair]\ntolerance = {tolerance}\n").model().block_count == 3
    soft = case(HEAD, BLOCKS)
    warned = [*method_warnings(model, soft.method(model), soft.schedule())]
    # half as much again as the overlap of 0.4 mm, to a digit
    advice = re.compile(r"\[repair\] tolerance = 0\.000[67] puts them together")
    assert any(advice.search(one) for one in warned)
    deep = BLOCKS.replace("0.9996", "0.5")
    with pytest.raises(ModelError, match=r"\[repair\] with a tolerance"):
        case(HEAD, deep).model()


def test_edges_keep_their_joints():
    """Both edges that the bed of the floor has become carry its joint."""
    model = case(HEAD, BLOCKS.replace("1.0003", "1.0009"), REPAIR).model()
    names = [one.name for one in model.joint_table.joints]
    bed = model.edge_joint == names.index("bed")
    start = model.vertices[bed] + model.origin
    assert bed.sum() >= 1 and (np.abs(start[:, 1] - 1.0) < 2e-3).all()


def test_a_tolerance_that_is_none():
    with pytest.raises(CaseError, match=r"repair\.tolerance|tolerance"):
        case(HEAD, BLOCKS, "[repair]\ntolerance = 0\n")
    with pytest.raises(ModelError, match="median edge"):
        case(HEAD, BLOCKS, "[repair]\ntolerance = 0.5\n").model()


def test_vertices_that_fell_together_are_no_fault_then():
    """A short edge that was rounded away is a duplicate; the repair closes it."""
    twice = BLOCKS.replace("[2, 0], [2, 1]", "[2, 0], [2, 0], [2, 1]")
    twice = twice.replace('["", "", "bed", ""]', '["", "", "", "bed", ""]')
    with pytest.raises(ModelError, match="is the same point"):
        case(HEAD, twice).model()
    assert case(HEAD, twice, REPAIR).model().block_count == 3


def test_a_builder_mends():
    vertices, start = wall(4, 3)
    builder = InputBuilder(repair=BlockRepair(tolerance=3e-3))
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    shift = np.array([1e6, 2e6])
    builder.blocks(vertices=rounded(vertices, np.random.default_rng(0), 4e-4) + shift, start=start)
    model = builder.build()
    assert len(model.overlaps.pair) == 0
    x, y = model.repairs[0].places[0]
    assert 1e6 - 1 < x < 1e6 + 5 and 2e6 - 1 < y < 2e6 + 3


def test_points_at_corners_that_moved():
    """A point at the drawn corner of a block that is narrower now belongs to it all the same."""
    point = "[[measured_point]]\nname = 'A'\nat = [0.3, 0.9996]\nblock = '3'\n"
    point += "[[fixed_point]]\nat = [1.9999, 2.0001]\n"
    drawn = BLOCKS.replace("[1.9997, 2.0]", "[1.9999, 2.0001]").replace("[0.3, 2]", "[0.3003, 2]")
    upper = "[[block]]\nvertices = [[1.3, 2.0], [1.9991, 2.0], [1.9991, 3], [1.3, 3]]\n"
    with pytest.raises(ModelError, match="lies on the common boundary"):
        case(HEAD, drawn, upper, point, "[repair]\ntolerance = 1.5e-3\n").model()
    named = point + "block = '1'\n"  # [geometry] comes before [[block]]
    model = case(HEAD, drawn, upper, named, "[repair]\ntolerance = 1.5e-3\n").model()
    numbers = [int(model.measured_points.block[0]), int(model.fixed_points.block[0])]
    assert [model.block_name[k] for k in numbers] == ["3", "1"]
    far = named.replace("[1.9999, 2.0001]", "[2.01, 2.01]")
    with pytest.raises(ModelError, match="m from it"):
        case(HEAD, drawn, upper, far, "[repair]\ntolerance = 1.5e-3\n").model()


def written(folder, noise=4e-4):
    vertices, start = wall(4, 3)
    vertices = rounded(vertices, np.random.default_rng(0), noise)
    blocks = len(start) - 1
    joints = ["", "", "bed", ""] * blocks
    write_blocks_npz(folder / "wall.npz", vertices, start, ["granite"] * blocks, joints)
    return blocks_of(vertices, start, ["granite"] * blocks, joints)


def test_blocks_of_a_file(tmp_path):
    written(tmp_path)
    path = tmp_path / "wall.toml"
    table = '[[block_file]]\nfile = "wall.npz"\nfixed = [1, 2]\n'
    path.write_text(HEAD + table + "[repair]\ntolerance = 3e-3\n")
    model = Case.from_toml(path).model()
    assert model.block_count == 13 and model.fixed.tolist() == [True] * 2 + [False] * 11
    assert len(model.overlaps.pair) == 0
    names = [one.name for one in model.joint_table.joints]
    assert (model.edge_joint == names.index("bed")).sum() >= 13
    path.write_text(HEAD + table.replace("2]", "99]"))
    with pytest.raises(ModelError, match=r"block_file 'wall.npz', fixed: there is no block 99"):
        Case.from_toml(path).model()
    path.write_text(HEAD + table.replace("wall.npz", "none.npz"))
    with pytest.raises(ModelError, match=r"(?s)block_file: .*none.npz: there is no such file"):
        Case.from_toml(path).model()


def test_the_case_of_finished_blocks(tmp_path):
    found = put_together(written(tmp_path), "wall.csv")
    assert found.tolerance == TOLERANCE_MAX and found.largest_movement <= TOLERANCE_MAX
    content = found.as_dict()
    assert content["blocks"] == 13 and content["joints"] == ["bed"]
    assert all(one["count"] > 0 and one["places"] for one in content["repairs"])
    text = blocks_text(found, "wall-blocks.npz")
    assert "# Put together within 0.0015 m:" in text and 'file = "wall-blocks.npz"' in text
    small = blocks_of(0.01 * found.blocks.vertices, found.blocks.block_start, ["a"] * 13)
    assert put_together(small, "small.npz").tolerance < 1e-4


def test_blocks_that_no_repair_makes_sound():
    bow = blocks_of([(0, 0), (1, 1), (1, 0), (0, 1)], [0, 4], ["a"])
    with pytest.raises(ModelError, match=r"x.csv: block 1: its loop crosses"):
        put_together(bow, "x.csv")
    with pytest.raises(ModelError, match=r"x.csv: --tolerance: "):
        put_together(bow, "x.csv", tolerance=5.0)


def test_drawn_blocks_ask_for_the_default_joint(tmp_path):
    """Only where blocks touch along a face that names no joint, and no pair does."""
    path = tmp_path / "a.toml"
    rows = [(0, 0, ""), (1, 0, ""), (1, 1, "bed"), (0, 1, "")]
    upper = [(0, 1, "bed"), (1, 1, ""), (1, 2, ""), (0, 2, "")]
    beside = [(1, 0, ""), (2, 0, ""), (2, 1, ""), (1, 1, "")]

    def of(**loops) -> Case:
        text = "block,x,y,joint\n"
        text += "".join(f"{k},{x},{y},{j}\n" for k, loop in loops.items() for x, y, j in loop)
        (tmp_path / "a.csv").write_text(text)
        return Case.from_toml(path)

    table = "[[block_file]]\nfile = 'a.csv'\nrock = 'granite'\n"
    bare = HEAD.replace("[joint.default]\nfriction_angle = 30.0\n", "")
    path.write_text(bare + table)
    assert of(low=rows, up=upper).model().block_name == ("low", "up")
    said = r"\[joint.default\]: there is none, but blocks 'low' and 'side' touch at \(1, 0.5\)"
    with pytest.raises(ModelError, match=said):
        of(low=rows, side=beside, up=upper).model()
    # a joint that the edge of one of both names is that of their contacts
    half = [(x, y, "bed" if (x, y) == (1, 1) else "") for x, y, _ in beside]
    assert of(low=rows, side=half, up=upper).model().block_count == 3
    path.write_text(bare.replace("[joint.bed]", "[joint.bed]\nbetween = [['low', '2']]") + table)
    assert of(low=rows, side=beside).model().block_count == 2
    path.write_text(HEAD + table)
    assert of(low=rows, side=beside).model().block_count == 2
    path.write_text(HEAD + table + table)
    with pytest.raises(ModelError, match="overlaps"):  # the names of the second file are its own
        of(low=rows, side=beside).model()
    path.write_text(HEAD + table + "fixed_layers = ['a']\n")
    with pytest.raises(ModelError, match="fixed_layers: the file has no layers"):
        of(low=rows, side=beside).model()


TURN, SHIFT = np.radians(28.0), np.array([300.0, -70.0])
PLACES = {
    "measured point 'A'": (0.8, 2.0),
    "point load 1": (1.6, 2.0),
    "line load 1": [(0.4, 2.0), (0.9, 2.0)],
    "fixed point 1": (0.0, 0.0),
}


def snapped(gap: float, turned: bool, tolerance: float | None = None, named: bool = False):
    """Return a model whose places lie ``gap`` beside their blocks, and its blocks by place."""

    def at(points) -> list:
        given = np.asarray(points, float)
        if not turned:
            return given.tolist()
        c, s = np.cos(TURN), np.sin(TURN)
        return (given @ np.array([[c, s], [-s, c]]) + SHIFT).tolist()

    up = np.array([0.0, gap])
    ups = np.array([[0.0, gap], [0.0, 0.0]])
    repair = None if tolerance is None else BlockRepair(tolerance=tolerance)
    builder = InputBuilder(repair=repair)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    for name, low, high in (("floor", (0, 0), (2, 1)), ("1", (0.3, 1), (1.3, 2))):
        corners = [low, (high[0], low[1]), high, (low[0], high[1])]
        builder.block(name=name, vertices=at(corners), fixed=False)
    builder.block(name="2", vertices=at([(1.3, 1), (2, 1), (2, 2), (1.3, 2)]))
    block = {"block": "1"} if named else {}
    builder.measured_point("A", at(PLACES["measured point 'A'"] + up), **block)
    builder.point_load(at(PLACES["point load 1"] + up), (0.0, -1e3))
    builder.line_load(*at(np.array(PLACES["line load 1"]) + up), (0.0, -1e3))
    builder.fixed_point(at(PLACES["fixed point 1"] - up))
    builder.pressure(*at(np.array([(0.3, 2.0), (1.3, 2.0)]) + up), 1e3)
    builder.add_bolt_kind("bar", stiffness=1e8)
    builder.bolt(*at(np.array([(0.5, 2.0), (0.5, 0.2)]) + ups), kind="bar", anchorage="ends")
    builder.bolt(*at(np.array([(0.7, 2.0), (0.7, 0.2)]) + ups), kind="bar")
    return builder.build()


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("gap", "tolerance"), [(0.7e-3, None), (4e-3, 5e-3)])
@pytest.mark.parametrize("named", [False, True])
def test_places_beside_a_block_belong_to_it(gap, tolerance, turned, named):
    model = snapped(gap, turned, tolerance, named)
    exact = snapped(0.0, turned, tolerance, named)
    assert not any("beside" in one for one in exact.notes)
    for one, other in (
        (model.measured_points.block, exact.measured_points.block),
        (model.point_loads.block, exact.point_loads.block),
        (model.line_loads.block, exact.line_loads.block),
        (model.fixed_points.block, exact.fixed_points.block),
        (model.pressures.edge, exact.pressures.edge),
        (model.bolts.block, exact.bolts.block),
    ):
        np.testing.assert_array_equal(one, other)
    # the place stays where it was given: only the block that carries it is chosen
    moved = model.measured_points.at - exact.measured_points.at
    assert np.hypot(*moved[0]) == pytest.approx(gap, rel=1e-6)
    places, pressure = (one for one in model.notes if "beside" in one)
    if "pressure" in places:
        places, pressure = pressure, places
    assert places.startswith("6 places lie beside a block")
    assert "measured point 'A', " in places and "block 2 '1'" in places
    assert f"{gap:.2g} m beside edges" in pressure


def test_places_beside_two_blocks():
    """Where two blocks are as near as that, one must be named, and is taken."""
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(vertices=[(1.001, 0), (2.001, 0), (2.001, 1), (1.001, 1)])
    for name, x, block in (("A", 1.0003, "2"), ("B", 1.0003, "1"), ("C", 1.0, None)):
        builder.measured_point(name, (x, 0.5), block=block)
    assert builder.build().measured_points.block.tolist() == [1, 0, 0]
    builder.measured_point("D", (1.0003, 0.5))
    with pytest.raises(ModelError, match="common boundary of block 1, block 2"):
        builder.build()


def test_places_too_far_from_a_block_are_refused():
    with pytest.raises(ModelError, match=r"outside every block; the nearest is .* m away"):
        snapped(1.1e-3 * np.sqrt(2.0), turned=False, tolerance=None)
    with pytest.raises(ModelError, match="nearest is"):
        snapped(6e-3, turned=False, tolerance=5e-3)
