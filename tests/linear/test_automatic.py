"""What solver = "auto" does with a system: factorise it, or iterate as long as that is quicker."""

import numpy as np
import pytest

from clast.linear.cholesky import CholeskyFactor
from clast.linear.solvers import (
    LIGHT,
    PCG,
    SOFT,
    Automatic,
    Direct,
    IteratedMatrix,
    inertia_shares,
    inexact,
    suffices_alone,
)
from clast.studies.bench.bandwidth import system_of_step
from clast.studies.bench.scenes import SCENES, stack
from clast.studies.bench.scenes import wall as wall_of
from scenes.systems import at_start, by_convex, open_ledger


def wall(bricks):
    return SCENES["wall"].build(bricks)


def system_of(model, share, step):
    """Return a system of blocks that have borne their weight for two steps."""
    how = by_convex(share * 5e9, max_displacement=1.0)
    state = open_ledger(model, how, at_start(model))
    for _ in range(2):
        state = how.process.step(model, how, state, step).state
    return system_of_step(model, how, state, step)


def way_of(factor):
    """Return in one word how a system is solved."""
    if isinstance(factor, CholeskyFactor):
        return "factorised"
    assert isinstance(factor, IteratedMatrix)
    return "incomplete" if len(factor._iteration.coarse[1]) == 1 else "aggregates"


@pytest.mark.parametrize(
    ("model", "step", "exact", "rough"),
    [
        (wall(60), 1e-3, "factorised", "factorised"),  # few
        (wall(150), 1e-3, "incomplete", "incomplete"),  # inertia suffices
        (wall_of(60, 2), 0.1, "aggregates", "aggregates"),  # not
        (wall(2000), 0.1, "aggregates", "aggregates"),
    ],
)
def test_the_way_suits_size_and_stiffness(model, step, exact, rough):
    system = system_of(model, 1.0, step)
    solver = Automatic()
    print(f"{model.title}: share of inertia {inertia_shares(system)[0]:.4f}")
    heavy = suffices_alone(system, *inertia_shares(system))
    assert heavy or "incomplete" not in (exact, rough)
    assert not heavy or "aggregates" not in (exact, rough)
    assert way_of(solver.factor(system)) == exact
    assert way_of(inexact(solver, 1e-3).factor(system)) == rough


def test_next_to_no_inertia_is_left_to_a_factorisation():
    """There a hundred iterations are needed, and what they find is worth less."""
    system = system_of(wall(150), 1e3, 1e-2)
    assert inertia_shares(system)[1] < LIGHT
    for tolerance in (1e-8, 1e-3):
        assert way_of(inexact(Automatic(), tolerance).factor(system)) == "factorised"


@pytest.mark.parametrize(
    ("share", "least", "enough"),
    [
        (0.02, 0.01, True),
        (0.02, 1e-5, False),  # held by what is fixed, not by inertia
        (0.5, 1e-9, True),  # a light block among heavy ones
        (0.005, 0.005, False),
    ],
)
def test_inertia_suffices_where_most_blocks_have_some(share, least, enough):
    system = system_of(wall(100), 1.0, 1e-3)
    assert suffices_alone(system, share, least) == enough


def test_chains_need_no_coarse_system_whatever_their_inertia():
    system = system_of(stack(60, 3), 1.0, 0.05)
    assert inertia_shares(system)[0] < SOFT
    matrix = Automatic().factor(system)
    assert way_of(matrix) == "incomplete"
    wanted = Direct().factor(system).solve(system.force)
    assert np.abs(matrix.solve(system.force) - wanted).max() < 1e-6 * np.abs(wanted).max()
    assert matrix.iterated <= 3


@pytest.mark.parametrize(("share", "step"), [(1.0, 1e-3), (50.0, 1e-3), (50.0, 0.05)])
def test_answers_are_those_of_a_factorisation(share, step):
    """Whatever way is taken, and whether or not it is left for another."""
    system = system_of(wall(150), share, step)
    wanted = Direct().factor(system).solve(system.force)
    found = Automatic().factor(system).solve(system.force)
    assert np.abs(found - wanted).max() < 1e-6 * np.abs(wanted).max()


def test_patience_bounds_the_iterations():
    """An iteration that may take next to no time is not begun."""
    system = system_of(wall(150), 1.0, 1e-3)
    assert way_of(Automatic(patience=1e-3).factor(system)) == "factorised"
    assert way_of(PCG().factor(system)) == "incomplete"
