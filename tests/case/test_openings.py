"""[[opening]]: rock that a stage excavates, of a cut or of blocks that are there."""

import numpy as np
import pytest

import clast

HEAD = """
schema = 1
[time]
step = 1e-3
end = 0.1
[rock.granite]
young = 1e10
poisson = 0.2
density = 2700.0
"""
TUNNEL = (
    HEAD
    + """
[domain]
boundary = [[0, 0], [10, 0], [10, 8], [0, 8]]
fixed_sides = ["bottom"]
[[joint_set]]
name = "a"
angle = 20.0
spacing = 2.0
[[opening]]
name = "heading"
shape = "box"
corner = [4, 3]
size = [3, 2]
[[opening]]
name = "drift"
shape = "box"
corner = [8, 5]
size = [1, 2]
construction_joint = false
[[opening]]
name = "shaft"
shape = "box"
corner = [1, 5]
size = [1, 1]
excavated = true
"""
)
BLOCKS = (
    HEAD
    + """
[joint."seam"]
cohesion = 1e18
tensile_strength = 1e18
[[block]]
name = "left"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
edge_joint = ["", "seam", "", ""]
[[block]]
name = "right"
vertices = [[1, 0], [2, 0], [2, 1], [1, 1]]
edge_joint = ["", "", "", "seam"]
[[opening]]
name = "half"
blocks = ["right"]
weld = "seam"
"""
)


def test_openings_of_a_cut_know_their_blocks_and_welds():
    case = clast.Case.from_toml(TUNNEL)
    model, cut = case.model(), case.cut().cut
    heading, *others = model.openings
    assert heading.name == "heading"
    assert np.array_equal(heading.block, np.flatnonzero(cut.opening == 0))
    areas = model.area[heading.block].sum()
    assert areas == pytest.approx(6.0, rel=1e-9)
    weld = [joint.name for joint in model.joint_table.joints].index("construction-joint:heading")
    assert np.array_equal(heading.welded, np.flatnonzero(model.edge_joint == weld))
    # the outline is welded from both sides
    inside = np.isin(model.vertex_block[heading.welded], heading.block)
    assert inside.any() and (~inside).any()
    # a void has no blocks; one without a construction joint has no welds
    assert all(one.name == "drift" and not len(one.welded) for one in others)
    assert not model.absent.any()


def test_an_opening_of_blocks_needs_no_domain():
    model = clast.Case.from_toml(BLOCKS).model()
    (half,) = model.openings
    assert (half.name, half.block.tolist(), half.welded.tolist()) == ("half", [1], [1, 7])


def test_a_script_and_its_case_have_the_same_openings():
    builder = clast.ModelBuilder()
    builder.add_rock("granite", young=1e10, poisson=0.2, density=2700.0)
    builder.add_weld("seam")
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], edge_joint=["", "seam", "", ""])
    builder.block(vertices=[(1, 0), (2, 0), (2, 1), (1, 1)], edge_joint=["", "", "", "seam"])
    builder.opening("half", ["2"], weld="seam")
    builder.opening("rest", ["1"])
    one, other = builder.build(), clast.Case.from_toml(builder.to_toml(end=0.1)).model()
    assert [o.name for o in one.openings] == [o.name for o in other.openings] == ["half", "rest"]
    for mine, theirs in zip(one.openings, other.openings, strict=True):
        assert np.array_equal(mine.block, theirs.block)
        assert np.array_equal(mine.welded, theirs.welded)
