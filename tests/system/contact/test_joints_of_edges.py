"""Joints that edges name: which one a contact takes, and what it bears by it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import clast
from scenes.systems import contacts_of

STEP = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
"""A block with a step: a tread at y = 1, from x = 1 to 2, and a riser at x = 1."""
ON_STEP = [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)]
"""A square that stands on the tread and against the riser."""


def builder_with(**between: list[tuple[str, str]]) -> clast.ModelBuilder:
    """Return a builder with a rock and the joints default (10), tread (20) and riser (30)."""
    builder = clast.ModelBuilder()
    builder.add_rock("granite", young=1e9, poisson=0.2, density=2500.0)
    builder.add_rock("clay", young=1e9, poisson=0.2, density=2000.0)
    for name, angle in (("default", 10.0), ("tread", 20.0), ("riser", 30.0)):
        builder.add_joint(name, friction_angle=angle, between=between.get(name, ()))
    return builder


def by_direction(builder: clast.ModelBuilder) -> dict[str, set[str]]:
    """Return the joints of the contacts whose entrance edge is level and upright."""
    model = builder.build()
    contacts = contacts_of(model)
    names = np.array([joint.name for joint in model.joint_table.joints])[contacts.joint]
    assert np.allclose(contacts.friction, model.joint_table.strengths[0][contacts.joint])
    level = np.abs(contacts.normal[:, 1]) > 0.5
    return {"level": set(names[level]), "upright": set(names[~level])}


def test_two_blocks_touch_along_two_joints():
    builder = builder_with()
    ridge = ["", "", "tread", "riser", "", ""]
    builder.block(name="below", rock="granite", vertices=STEP, edge_joint=ridge)
    builder.block(
        name="above",
        rock="granite",
        vertices=ON_STEP,
        edge_joint=["tread", "", "", "riser"],
    )
    assert by_direction(builder) == {"level": {"tread"}, "upright": {"riser"}}


@pytest.mark.parametrize("whose", ["below", "above"])
def test_one_of_two_blocks_may_name_the_joint(whose):
    """The entrance edge says nothing then; the vertex's own edge along it does."""
    builder = builder_with()
    ridge = ["", "", "tread", "riser", "", ""] if whose == "below" else None
    feet = ["tread", "", "", "riser"] if whose == "above" else None
    builder.block(name="below", rock="granite", vertices=STEP, edge_joint=ridge)
    builder.block(name="above", rock="granite", vertices=ON_STEP, edge_joint=feet)
    assert by_direction(builder) == {"level": {"tread"}, "upright": {"riser"}}


def test_a_pair_of_blocks_goes_before_edges_and_edges_before_rocks():
    ridge, feet = ["", "", "tread", "riser", "", ""], ["tread", "", "", "riser"]
    named = builder_with(riser=[("below", "above")])
    named.block(name="below", rock="granite", vertices=STEP, edge_joint=ridge)
    named.block(name="above", rock="granite", vertices=ON_STEP, edge_joint=feet)
    assert by_direction(named) == {"level": {"riser"}, "upright": {"riser"}}

    rocks = builder_with()
    rocks.add_joint("seam", friction_angle=5.0, between_rocks=[("granite", "clay")])
    rocks.block(
        name="below", rock="granite", vertices=STEP, edge_joint=["", "", "tread", "", "", "riser"]
    )
    rocks.block(name="above", rock="clay", vertices=ON_STEP)
    assert by_direction(rocks) == {"level": {"tread"}, "upright": {"seam"}}


def test_edges_of_a_loop_that_is_turned_round_keep_their_joints():
    builder = builder_with()
    builder.block(
        name="below",
        rock="granite",
        vertices=STEP[::-1],
        edge_joint=["", "riser", "tread", "", "", ""],
    )
    builder.block(name="above", rock="granite", vertices=ON_STEP)
    assert by_direction(builder) == {"level": {"tread"}, "upright": {"riser"}}


@pytest.mark.parametrize("process", ["convex", "modified", "open-close"])
@pytest.mark.parametrize(("name", "slides"), [("tread", True), ("riser", False)])
def test_a_block_slides_by_the_joint_of_the_edge_that_it_stands_on(process, name, slides):
    angle = math.radians(25.0)  # tread 20 degrees, riser 30

    def turned(points):
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        return np.array(points) @ turn

    builder = builder_with()
    base = [(-10.0, -1.0), (10.0, -1.0), (10.0, 0.0), (-10.0, 0.0)]
    other = "riser" if name == "tread" else "tread"
    builder.block(
        name="base",
        rock="granite",
        fixed=True,
        vertices=turned(base),
        edge_joint=["", "", name, other],
    )
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    builder.block(name="slider", rock="granite", vertices=turned(square))
    builder.measured_point("A", turned([(0.5, 0.5)])[0], block="slider")
    run = clast.simulate(builder, end=0.5, step=1e-3, process=process)
    moved = np.hypot(*run.history("A").displacement[-1])
    share = math.sin(angle) - math.cos(angle) * math.tan(math.radians(20.0))
    expected = 0.5 * 9.8 * share * 0.5**2  # until it presses, nothing holds it: 0.3 to 1.1 % more
    assert moved == pytest.approx(expected, rel=0.02) if slides else moved < 0.02 * expected
