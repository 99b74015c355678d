"""Blocks handed over as arrays are the same as blocks handed over one at a time."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from clast.case.api import ModelBuilder as ScriptBuilder
from clast.case.case_file import Case
from clast.errors import ModelError
from clast.inputs.builder import InputBuilder
from clast.model.model import Model
from scenes.systems import box

SQUARES = np.array([box(2.0 * k, 0.0) for k in range(3)])
TRIANGLE = np.array([(0.0, 3.0), (1.0, 3.0), (0.0, 4.0)])


def begun() -> InputBuilder:
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_rock("marl", young=5e9, poisson=0.3, density=2300.0, initial_stress=(1, 2, 3))
    return builder


def same(one: Model, other: Model) -> bool:
    """Return whether two models hold the same."""
    return all(
        np.array_equal(getattr(one, field.name), getattr(other, field.name))
        for field in dataclasses.fields(Model)
        if isinstance(getattr(one, field.name), np.ndarray | tuple)
    )


def test_arrays_give_the_same_model_as_single_blocks():
    stress = np.arange(9.0).reshape(3, 3)
    velocity = np.array([(0.0, 0.0, 0.0), (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)])
    fixed = np.array([True, False, False])
    single, many = begun(), begun()
    single.block(vertices=TRIANGLE, rock="marl", name="top")
    many.block(vertices=TRIANGLE, rock="marl", name="top")
    for k in range(3):
        single.block(
            vertices=SQUARES[k],
            rock="granite",
            fixed=bool(fixed[k]),
            velocity=velocity[k],
            initial_stress=stress[k],
        )
    names = many.blocks(
        vertices=SQUARES, rock="granite", fixed=fixed, velocity=velocity, initial_stress=stress
    )
    assert names == ("2", "3", "4")
    assert same(single.build(), many.build())


def test_blocks_with_different_numbers_of_corners_are_cut_by_start():
    single, many = begun(), begun()
    for name, outline in (("a", TRIANGLE), ("b", SQUARES[0])):
        single.block(vertices=outline, rock="marl", name=name)
    many.blocks(
        vertices=np.concatenate([TRIANGLE, SQUARES[0]]), start=[0, 3, 7], names="ab", rock="marl"
    )
    assert same(single.build(), many.build())


def test_names_go_on_and_may_not_be_given_twice():
    builder = begun()
    builder.blocks(vertices=SQUARES, rock="marl")
    assert builder.block(vertices=TRIANGLE, rock="marl") == "4"
    builder.measured_point("A", (0.5, 0.5), block="1")
    assert builder.build().measured_points.block.tolist() == [0]
    builder.blocks(vertices=TRIANGLE[None] + 5.0, rock="marl", names=["2"])
    with pytest.raises(ModelError, match="two blocks with that name"):
        builder.build()


FAULTS = {
    "shape": ({"vertices": SQUARES[0]}, r"vertices: have shape \(4, 2\)"),
    "words": ({"vertices": [[["a", "b"]]]}, "are not arrays of numbers"),
    "start": ({"vertices": TRIANGLE, "start": [0, 4]}, "does not run from 0"),
    "names": ({"names": ["a"]}, "1 names are given for 3 blocks"),
    "fixed": ({"fixed": np.array([True])}, "one truth value"),
    "velocity": ({"velocity": (1.0, 2.0)}, "velocity: give 3 finite numbers"),
    "stress": ({"initial_stress": np.full((3, 3), np.nan)}, "initial_stress: give 3 finite"),
    "rock": ({"rock": "granit"}, "did you mean 'granite'?"),
    "no rock": ({"rock": None}, "names no rock"),
    "moving": ({"fixed": True, "velocity": (1, 0, 0)}, "block 1, velocity: a fixed block"),
    "overlap": ({"vertices": SQUARES[[0, 0, 1]]}, "block 1: overlaps block 2 to a depth"),
    "nan": ({"vertices": np.where(SQUARES == 5.0, np.nan, SQUARES)}, "block 3, vertex 2"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_name_the_block_and_the_key(fault):
    changes, message = FAULTS[fault]
    builder = begun()
    with pytest.raises(ModelError, match=message):
        builder.blocks(**{"vertices": SQUARES, "rock": "granite", **changes})
        builder.build()


def test_a_sliver_across_two_boxes_is_found():
    """Boxes that share an area are looked at closely, boxes that share a strip are not."""
    builder = begun()
    builder.blocks(vertices=np.array([box(0.0, 0.0), box(1.0 - 6e-2, 0.0)]), rock="marl")
    with pytest.raises(ModelError, match=r"depth of 0\.06 m"):
        builder.build()
    for depth, known in ((1e-4, 1), (1e-8, 0)):
        builder = begun()
        builder.blocks(vertices=np.array([box(0.0, 0.0), box(1.0 - depth, 0.0)]), rock="marl")
        overlaps = builder.build().overlaps
        assert overlaps.pair.tolist() == [[0, 1]] * known
        assert overlaps.depth == pytest.approx([depth] * known, rel=1e-4)


def test_clockwise_loops_are_turned_round_and_said():
    builder = begun()
    clockwise = SQUARES[:, ::-1]
    builder.blocks(vertices=clockwise, rock="granite")
    model = builder.build()
    assert (model.area > 0.0).all()
    for block, loop in enumerate(clockwise):
        assert model.polygon(block).tolist() == [loop[0].tolist(), *loop[:0:-1].tolist()]
    (note,) = model.notes
    assert note == "3 loops run clockwise and were reversed: block 1, block 2, block 3"


def test_every_block_may_have_a_rock_of_its_own():
    builder = ScriptBuilder()
    for rock in ("granite", "marl"):
        builder.add_rock(rock, young=1e9, poisson=0.2, density=2500.0)
    weld = builder.add_weld("weld")
    builder.line_joints.append(builder.add_joint("line", friction_angle=20.0))
    rocks = ["marl", "granite"]
    squares = np.array([box(0.0, 0.0), box(1.0, 0.0)])
    edges = ["", weld, "", "", "", "", "", weld]
    builder.blocks(vertices=squares, rock=rocks, edge_joint=edges)
    model = builder.build()
    assert [model.rocks[k].name for k in model.block_rock] == rocks
    again = Case.from_toml(builder.to_toml(end=1.0, step=1e-3)).model()
    assert [again.rocks[k].name for k in again.block_rock] == rocks
    assert [one.name for one in again.joint_table.joints] == ["default", "weld"]


@pytest.mark.parametrize(
    ("rocks", "words"),
    [
        (["granite"], "1 rocks are given for 2 blocks"),
        (["granite", "marble"], "no rock 'marble'"),
        (["granite", 3], "3 is not a valid rock name"),
    ],
)
def test_rocks_of_blocks_that_are_none(rocks, words):
    builder = InputBuilder()
    builder.add_rock("granite", young=1e9, poisson=0.2, density=2500.0)
    builder.blocks(vertices=np.array([box(0.0, 0.0), box(1.0, 0.0)]), rock=rocks)
    with pytest.raises(ModelError, match=words):
        builder.build()
