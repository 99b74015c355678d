"""The friction bound follows the normal force of a minimum as near as new bounds can tell."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from clast.minimise.potential import Point, Potential
from clast.minimise.strategy import MinimisationStrategy
from clast.step.convex import Convex, FrictionLoop
from scenes.potentials import ALONE, work
from scenes.sliding import FRICTION_ANGLE, STEEP, sliding
from scenes.systems import (
    box,
    by_convex,
    courses_of_bricks,
    heap,
    loose_polygons,
    march,
    wall,
)


@dataclass(frozen=True)
class Asked:
    """What was asked for, and what was found."""

    potential: Potential
    tolerance: float
    found: Point


@dataclass(frozen=True, kw_only=True)
class Listening(MinimisationStrategy):
    """A schedule that writes down what is asked for."""

    asked: list[Asked]

    def minimise(self, potential, point, tolerance, work):
        found = super().minimise(potential, point, tolerance, work)
        self.asked.append(Asked(potential, tolerance, found))
        return found


@dataclass(frozen=True)
class Listened(Convex):
    """The convex process with such schedules, one for each step."""

    steps: list[list[Asked]] = field(default_factory=list)

    def schedule(self, factor):
        self.steps.append([])
        return Listening(asked=self.steps[-1], **vars(super().schedule(factor)))


def asked_in(model, stiffness, step, end, **changes):
    """Return what was asked for in the steps of a run."""
    process = Listened(**changes)
    march(model, by_convex(stiffness, process=process, max_displacement=0.1), step, end)
    return process.steps


def wall_and_slide():
    """Return a wall that settles, and a small block far from it that slides down a plane."""
    ground = box(-1.0, -1.0, 10.0, 1.0)
    return sliding([ground, *courses_of_bricks(8, 8)])


@pytest.fixture(params=["wall", "heap", "wall and slide"])
def steps(request):
    """Return steps of short runs: of one island, of many, of two unlike ones."""
    if request.param == "heap":
        return asked_in(heap(120, 20), 5e8, 2.5e-3, 0.4)
    model = wall(8, 8) if request.param == "wall" else wall_and_slide()
    return asked_in(model, 5e9, 1e-3, 5e-3)


def test_each_island_is_nearer_than_its_new_bounds_can_tell(steps):
    share, coarser = FrictionLoop().share, 0
    for step in steps:
        *first, last = step
        enough = last.tolerance
        tolerances = [one.tolerance for one in first]
        assert tolerances == sorted(tolerances, reverse=True)
        assert all(one.potential is first[0].potential for one in first)
        one, renewed, found = first[-1].potential, last.potential, first[-1].found
        coarser += tolerances[-1] > enough
        # of links without cohesion the bound is tan(phi) times the normal force
        tangent = np.tan(np.radians(FRICTION_ANGLE))
        bears = found.forces.normal_force
        assert renewed.springs.shear.high == pytest.approx(tangent * bears, rel=1e-12)
        # Newton's method sums up gaps on its way: what its point bears differs by rounding
        there = one.at(found.unknowns)
        rounding = 1e-11 * bears.max(initial=1.0)
        assert bears == pytest.approx(there.forces.normal_force, rel=0.0, abs=rounding)
        own = one.island_distances(there)
        new = renewed.island_distances(renewed.at(found.unknowns))
        assert tolerances[-1] == enough or own[own > 1.01 * share * new].sum() <= 1.01 * enough
    assert coarser > len(steps) / 4


def test_normal_forces_are_nearly_those_of_the_minimum(steps):
    for step in steps:
        one, found = step[-2].potential, step[-2].found
        wanted = ALONE.minimise(one, found, step[-1].tolerance, work()).forces.normal_force
        assert np.abs(found.forces.normal_force - wanted).sum() <= 0.01 * wanted.sum()


@pytest.mark.parametrize("updates", [0, 1, 2])
def test_the_bound_is_renewed_as_often_as_asked_for(updates):
    for step in asked_in(wall(3, 3), 5e9, 1e-3, 5e-3, friction_updates=updates):
        assert len({id(one.potential) for one in step}) == updates + 1
        assert len(step) == 1 or updates > 0


def way_down(others):
    """Return how far the small block slides in 50 ms beside the ``others``, m."""
    model = sliding(others)
    last = march(model, by_convex(5e9, max_displacement=0.05), 1e-3, 0.05)[-1].state
    moved = (last.vertices - model.vertices)[4:8].mean(axis=0)
    dip = np.radians(STEEP)
    return float(moved @ [np.cos(dip), -np.sin(dip)])


def test_a_small_block_slides_beside_many_others_as_it_does_alone():
    """What others leave open is far more than all that the small block has."""
    ground = box(-1.0, -1.0, 34.0, 1.0)
    alone = way_down([ground])
    falling = [outline + np.array([0.0, 0.2]) for outline in loose_polygons(100, 28)]
    assert way_down([ground, *falling]) == pytest.approx(alone, rel=1e-6)
    angle, friction = np.radians(STEEP), np.tan(np.radians(FRICTION_ANGLE))
    exact = 0.5 * 9.8 * (np.sin(angle) - friction * np.cos(angle)) * 0.05**2
    assert alone == pytest.approx(exact, rel=2e-3)
