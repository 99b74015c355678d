"""What solver = "auto" does with a system: an exact factor, or an iteration."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.scenes import SCENES, stack
from clast.linear.block_matrix import coupled_pairs, inertia_shares
from clast.linear.pattern import Patterns
from clast.linear.solvers import (
    INERTIA_SHARE_MIN,
    Automatic,
    Direct,
    ExactFactor,
    IteratedMatrix,
    inexact,
    solve,
    suffices_alone,
)
from scenes.systems import at_start, by_convex, open_ledger


class Captured(Exception):
    """Carries the first system of a step out of it."""


class Capture:
    """A solver that does not solve."""

    def factor(self, system, patterns):
        raise Captured(system)


def wall(bricks):
    return SCENES["wall"].build(bricks)


def system_of(model, share, step):
    """Return a system of blocks that have borne their weight for two steps."""
    how = by_convex(share * 5e9, max_displacement=1.0)
    state = open_ledger(model, how, at_start(model))
    for _ in range(2):
        state = how.process.step(model, how, state, step).state
    pushed = state.velocity.copy()
    pushed[~model.fixed, :2] += step * model.gravity
    with pytest.raises(Captured) as captured:
        capture = replace(how, solver=Capture())
        how.process.step(model, capture, replace(state, velocity=pushed), step)
    return captured.value.args[0]


def way_of(factor):
    """Return in one word how a system is solved."""
    if isinstance(factor, ExactFactor):
        return "exact"
    assert isinstance(factor, IteratedMatrix)
    assert factor.ready is not None
    return "without fill" if len(factor.ready[2][1]) == 1 else "coarse space"


@pytest.mark.parametrize(
    ("model", "step", "way"),
    [
        (wall(150), 1e-3, "exact"),  # few
        (stack(60, 5), 0.05, "exact"),  # a tree
        (wall(300), 1e-3, "without fill"),  # inertia suffices
        (wall(300), 0.1, "coarse space"),  # not
        (wall(2000), 0.1, "coarse space"),
    ],
)
def test_the_way_suits_size_and_stiffness(model, step, way):
    system = system_of(model, 1.0, step)
    heavy = suffices_alone(system, coupled_pairs(system.upper))
    assert heavy or way != "without fill"
    assert not heavy or way != "coarse space"
    for solver in (Automatic(), inexact(Automatic(), 1e-3)):
        assert way_of(solver.factor(system, Patterns())) == way


def test_trees_are_solved_exactly_whatever_their_inertia():
    system = system_of(stack(60, 5), 1.0, 0.05)
    coupled = coupled_pairs(system.upper)
    assert (
        inertia_shares(system.diagonal, system.upper, system.rows, coupled)[0] < INERTIA_SHARE_MIN
    )
    found = solve(Automatic(), system)
    assert np.array_equal(found, solve(Direct(), system))


@pytest.mark.parametrize(
    ("share", "step"), [(1.0, 1e-3), (50.0, 1e-3), (50.0, 0.05), (1000.0, 0.01)]
)
def test_answers_are_those_of_an_exact_factor(share, step):
    """Whatever way is taken, and whether or not it is left for another."""
    system = system_of(wall(300), share, step)
    wanted = solve(Direct(), system)
    found = solve(Automatic(), system)
    assert np.abs(found - wanted).max() < 1e-6 * np.abs(wanted).max()
