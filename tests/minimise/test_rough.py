"""The first minimisation ends where new friction bounds cannot tell how near it was."""

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.stopwatch import Stages
from clast.linear.reuse import FactorOfStep
from clast.linear.solvers import Direct
from clast.minimise import rough
from clast.minimise.newton import minimise
from scenes.potentials import TOLERANCE, caught
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


def wall_and_slide():
    """Return a wall that settles, and a small block far from it that slides down a plane."""
    ground = box(-1.0, -1.0, 10.0, 1.0)
    return sliding([ground, *courses_of_bricks(8, 8)])


@pytest.fixture(params=["wall", "heap", "wall and slide"])
def potentials(request, monkeypatch):
    """Return potentials that short runs minimise: of one region, of many, of two unlike ones."""
    if request.param == "heap":
        return caught(monkeypatch, heap(120, 20), 5e8, 2.5e-3, 0.4)
    model = wall(8, 8) if request.param == "wall" else wall_and_slide()
    return caught(monkeypatch, model, 5e9, 1e-3, 5e-3)


def found_by(potential, enough, asked):
    """Return what ``with_new_bounds`` comes to from rest; what it asks for is appended."""
    counts = {"passes": 0, "line_search": 0}
    factor, stages = FactorOfStep(Direct()), Stages()

    def to_minimum(potential, point, left):
        asked.append(left)
        return minimise(potential, point, factor, left, 500, counts, stages)

    start = potential.at(np.zeros((len(potential.fixed), 6)))
    return rough.with_new_bounds(to_minimum, potential, start, enough, stages)


def test_each_region_is_nearer_than_its_new_bounds_can_tell(potentials):
    coarser = 0
    for one in potentials:
        enough = TOLERANCE**2 * one.yardstick()
        asked = []
        renewed, point = found_by(one, enough, asked)
        coarser += asked[-1] > enough
        assert asked == sorted(asked, reverse=True)
        here = one.at(point.unknowns)
        # Newton's method sums up gaps on its way: what its point bears differs by
        # rounding, 4e-14 of the largest at most
        bound, bears = renewed.contacts.friction_base, here.response.normal_force
        rounding = 1e-12 * bears.max(initial=1.0)
        assert bound == pytest.approx(bears, rel=0.0, abs=rounding)
        there = renewed.at(point.unknowns)
        assert point.residual == pytest.approx(there.residual, rel=0.0, abs=rounding)
        own, new = one.distances(here), renewed.distances(point)
        assert asked[-1] == enough or own[own > rough.SHARE * new].sum() <= enough
    assert coarser > len(potentials) / 4


def test_normal_forces_are_nearly_those_of_the_minimum(potentials, monkeypatch):
    for one in potentials:
        enough = TOLERANCE**2 * one.yardstick()
        found = found_by(one, enough, [])[0].contacts.friction_base
        with monkeypatch.context() as exact:
            exact.setattr(rough, "COARSE", 1.0)
            asked = []
            wanted = found_by(one, enough, asked)[0].contacts.friction_base
        assert asked == [enough]
        assert np.abs(found - wanted).sum() <= 0.01 * wanted.sum()


@pytest.mark.parametrize("updates", [0, 1])
def test_without_updates_nothing_is_minimised_roughly(monkeypatch, updates):
    asked = []
    usual = rough.with_new_bounds

    def watched(*others):
        asked.append(1)
        return usual(*others)

    monkeypatch.setattr("clast.step.convex.with_new_bounds", watched)
    how = by_convex(5e9)
    how = replace(how, process=replace(how.process, friction_updates=updates))
    steps = march(wall(3, 3), how, 1e-3, 5e-3)
    assert len(asked) >= updates * len(steps)
    assert bool(asked) == bool(updates)


def way_down(others):
    """Return how far the small block slides in 50 ms beside the ``others``, m."""
    model = sliding(others)
    last = march(model, replace(by_convex(5e9), max_displacement=0.05), 1e-3, 0.05)[-1].state
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
