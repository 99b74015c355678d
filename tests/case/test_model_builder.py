"""Models from scripts: what they hold, and what is refused with which words."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from clast.case.api import ModelBuilder
from clast.errors import ModelError
from clast.inputs.builder import InputBuilder
from clast.model.model import PlaneStrain, PlaneStress

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def builder_with(*loops, **options) -> InputBuilder:
    """Return a builder with one rock, one joint and a block for each loop."""
    builder = InputBuilder(**options)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=30.0)
    for loop in loops:
        builder.block(vertices=loop)
    return builder


def moved(loop, x, y):
    return [(a + x, b + y) for a, b in loop]


def refusal(builder: InputBuilder) -> str:
    with pytest.raises(ModelError) as caught:
        builder.build()
    assert caught.value.where
    assert caught.value.remedy
    return str(caught.value)


def test_arrays_of_a_model():
    builder = builder_with(SQUARE, title="two", gravity=(0.5, -9.0))
    builder.block(
        name="lid",
        vertices=[(0, 1), (1, 1), (0.5, 3)],
        velocity=(1, 2, 3),
        initial_stress=(1e3, 2e3, 3e3),
    )
    builder.fixed_point((0, 0))
    builder.point_load((0.5, 3), (10.0, 20.0))
    builder.line_load((0, 0), (0, 1), (5.0, 0.0))
    builder.measured_point("A", (0, 1), block="lid")
    model = builder.build()
    assert model.block_name == ("1", "lid")
    assert model.block_start.tolist() == [0, 4, 7]
    assert model.block_start.dtype == np.int64
    assert model.vertices.flags.c_contiguous
    assert model.area.tolist() == [1.0, 1.0]
    assert model.mass.tolist() == [2700.0, 2700.0]
    assert model.velocity.tolist() == [[0] * 6, [1, 2, 3, 0, 0, 0]]
    assert model.initial_stress.tolist() == [[0, 0, 0], [1e3, 2e3, 3e3]]
    assert model.gravity.tolist() == [0.5, -9.0]
    assert model.origin.tolist() == [0.0, 0.0]
    assert model.fixed_points.block.tolist() == [0]
    assert model.point_loads.block.tolist() == [1]
    assert model.point_loads.force.tolist() == [[10.0, 20.0]]
    assert model.line_loads.block.tolist() == [0]
    assert model.line_loads.end.tolist() == [[0.0, 1.0]]
    assert model.measured_points.block.tolist() == [1]
    assert model.measured_points.name == ("A",)


def test_stress_of_the_rock_is_that_of_its_blocks():
    builder = InputBuilder()
    builder.add_rock("a", young=1e9, poisson=0.2, density=1e3, initial_stress=(-1e6, -2e6, 0))
    builder.block(vertices=SQUARE, rock="a")
    assert builder.build().initial_stress.tolist() == [[-1e6, -2e6, 0.0]]


def test_joints_of_pairs():
    builder = builder_with()
    builder.add_rock("clay", young=1e8, poisson=0.3, density=2000.0)
    for k in range(3):
        builder.block(name="abc"[k], rock="granite", vertices=moved(SQUARE, 2 * k, 0))
    builder.block(name="d", rock="clay", vertices=moved(SQUARE, 6, 0))
    builder.add_joint("mortar", cohesion=1e5, between=[("c", "a"), ("a", "b")])
    builder.add_joint("seam", friction_angle=10.0, between_rocks=[("clay", "granite")])
    table = builder.build().joint_table
    assert [joint.name for joint in table.joints] == ["default", "mortar", "seam"]
    assert table.block_pair.tolist() == [[0, 1], [0, 2]]
    assert table.block_pair_joint.tolist() == [1, 1]
    assert table.rock_pair.tolist() == [[0, 2], [2, 0]]


def test_the_default_joint_comes_first_and_is_frictionless_unless_given():
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.block(vertices=SQUARE)
    (only,) = builder.build().joint_table.joints
    assert (only.name, only.friction_angle) == ("default", 0.0)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (1e6, -3e6), (0.1, 0.7)])
def test_a_case_far_from_the_origin_keeps_its_digits(shift):
    model = builder_with(moved(SQUARE, *shift), moved(SQUARE, shift[0] + 1.0, shift[1])).build()
    assert np.abs(model.vertices).max() < 10.0
    assert model.polygon(0) == pytest.approx(np.array(moved(SQUARE, *shift)), abs=1e-9)
    assert model.area == pytest.approx([1.0, 1.0], rel=1e-9)


def test_round_off_between_neighbours_is_no_overlap():
    third = 1.0 / 3.0
    loops = [
        [
            (0.1 * k * third, 0),
            (0.1 * (k + 1) * third, 0),
            (0.1 * (k + 1) * third, 1),
            (0.1 * k * third, 1),
        ]
        for k in range(20)
    ]
    angle = math.radians(17.0)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    model = builder_with(*[np.array(loop) @ turn for loop in loops]).build()
    assert model.block_count == 20


def test_ten_thousand_blocks_build_quickly():
    builder = builder_with()
    for row in range(100):
        for column in range(100):
            builder.block(vertices=moved(SQUARE, column + 0.5 * (row % 2), row))
    start = time.perf_counter()
    assert builder.build().block_count == 10_000
    assert time.perf_counter() - start < 5.0


def test_the_block_and_vertex_are_named_in_user_coordinates():
    far = moved(SQUARE, 1e6, 2e6)
    builder = builder_with(far)
    builder.block(name="wedge", vertices=moved([(0, 0), (1, 0), (1, 0), (0, 1)], 1e6 + 2, 2e6))
    assert "block 2 'wedge', vertex 2 at (1000003, 2000000)" in refusal(builder)


def test_doubled_vertices_are_listed_all_at_once():
    doubled = [(0, 0), (0, 0), (1, 0), (1, 1), (1, 1), (0, 1), (0, 0)]
    message = refusal(builder_with(doubled, SQUARE, moved(doubled, 3, 0)))
    assert "6 things to put right" in message
    assert "block 1, vertex 1 at (0, 0): is the same point as vertex 2" in message
    assert "block 1, vertex 7 at (0, 0): is the same point as vertex 1" in message
    assert "block 3, vertex 4 at (4, 1): is the same point as vertex 5" in message
    many = refusal(builder_with(*(moved(doubled, 3 * k, 0) for k in range(20))))
    assert "60 things to put right" in many
    assert "and 50 more" in many
    assert len(many.splitlines()) == 13


def test_overlapping_blocks():
    builder = builder_with(SQUARE, moved(SQUARE, 5, 5))
    builder.block(name="intruder", vertices=moved(SQUARE, 0.9, 0))
    message = refusal(builder)
    assert "block 1: overlaps block 3 'intruder'" in message
    assert "near (0.95, 0.5)" in message


def test_a_block_inside_another_overlaps():
    assert "overlaps" in refusal(
        builder_with(moved(SQUARE, 1, 1), [(0, 0), (4, 0), (4, 4), (0, 4)])
    )


def test_no_blocks_at_all():
    assert "no blocks" in refusal(builder_with())


def test_the_plane_is_given_by_its_name_or_as_an_object():
    for given, plane in (
        ("strain", PlaneStrain()),
        (PlaneStrain(), PlaneStrain()),
        ("stress", PlaneStress()),
        (PlaneStress(), PlaneStress()),
    ):
        assert ModelBuilder(plane=given).plane == plane
        builder = ModelBuilder()
        assert builder.plane == PlaneStress()
        builder.plane = given
        builder.add_rock("rock", young=1e9, poisson=0.2, density=2e3)
        builder.block(vertices=SQUARE)
        assert builder.build().plane == plane
        assert f'plane = "{plane.name}"' in builder.to_toml() or plane.name == "stress"


@pytest.mark.parametrize("given", ["plane strain", "", None, 1, PlaneStrain])
def test_another_plane_is_refused_with_the_names(given):
    with pytest.raises(ModelError, match="give 'stress' or 'strain'"):
        ModelBuilder(plane=given)


def test_poisson_of_one_half_is_possible_in_plane_stress_only():
    def half(**options):
        builder = InputBuilder(**options)
        builder.add_rock("rubber", young=1e6, poisson=0.5, density=1e3)
        builder.block(vertices=SQUARE)
        return builder

    assert half().build().block_count == 1
    assert "plane strain" in refusal(half(plane=PlaneStrain()))


def test_a_small_friction_angle_can_be_meant():
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint(friction_angle=1.0, allow_small_friction_angle=True)
    builder.block(vertices=SQUARE)
    assert builder.build().joint_table.joints[0].friction_angle == 1.0


ODD = (None, 5, -1, 0, "x", "", [], {}, (1, 2), [1, 2, 3], math.nan, math.inf, 1e308, True, b"a")
ODD += (object(), [["a", "b"]], [("1", "2")], "a\0", "\ud800", np.zeros((2, 2)), 10**400, 1j)
ENTRIES = {
    "add_rock": {
        "name": "r",
        "young": 5e9,
        "poisson": 0.2,
        "density": 2e3,
        "initial_stress": (0,) * 3,
    },
    "add_joint": {
        "name": "default",
        "friction_angle": 30.0,
        "cohesion": 0.0,
        "tensile_strength": 0.0,
    }
    | {"between": (), "between_rocks": ()},
    "block": {"name": "1", "vertices": SQUARE, "rock": "r", "fixed": False, "velocity": (0, 0, 0)}
    | {"initial_stress": (0, 0, 0)},
    "blocks": {"vertices": np.array([SQUARE]) + 3.0, "start": None, "names": ["b"], "rock": "r"}
    | {"fixed": False, "velocity": (0, 0, 0), "initial_stress": None},
    "fixed_point": {"at": (0, 0), "block": None},
    "add_amplitude": {"name": "t", "time": [0, 1], "value": [0, 1]},
    "point_load": {"at": (0, 0), "force": (1, 1), "block": None, "amplitude": "t"},
    "line_load": {"start": (0, 0), "end": (1, 0), "traction": (1, 1), "block": None}
    | {"amplitude": None},
    "pressure": {"start": (0, 0), "end": (1, 0), "value": (1, 1), "block": None, "amplitude": "t"},
    "measured_point": {"name": "A", "at": (0, 0), "block": "1"},
}


@pytest.mark.parametrize(
    ("method", "key"), [(method, key) for method, entries in ENTRIES.items() for key in entries]
)
def test_whatever_a_script_hands_over_is_taken_or_refused_in_words(method, key):
    refused = 0
    for value in ODD:
        builder = InputBuilder()
        try:
            for name, entries in ENTRIES.items():
                changes = {key: value} if name == method else {}
                getattr(builder, name)(**{**entries, **changes})
            builder.build()
        except ModelError as error:
            assert error.where
            assert error.remedy
            assert len(str(error)) < 2000
            refused += 1
    assert refused >= 8


def test_a_pair_belongs_to_one_joint():
    builder = builder_with(SQUARE, moved(SQUARE, 1, 0))
    builder.add_joint("a", between=[("1", "2")])
    builder.add_joint("b", between=[("2", "1")])
    assert "already belong to joint 'a'" in refusal(builder)


def test_a_block_says_its_rock_where_there_are_several():
    builder = builder_with(SQUARE)
    builder.add_rock("clay", young=1e8, poisson=0.3, density=2000.0)
    assert "names no rock" in refusal(builder)
