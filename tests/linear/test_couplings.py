"""Couplings from the springs of contacts against the same couplings block by block."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.contacts import ContactResponse
from clast.linear import block_matrix as block_rows
from clast.linear import pcg as conjugate
from clast.linear.couplings import Blocks
from clast.linear.solvers import PCG, inertia_shares, with_incomplete
from clast.linear.system import DiagonalTerms, graph_of, symmetric_system
from scenes.systems import at_start, centroids, contacts_of, wall


def springs(courses=6, columns=5, *, weight=1e4, seed=0):
    """Return a system of random springs between bricks, two of them fixed besides the base.

    A third of the contacts have no stiffness, and some pairs none at all.
    """
    model = wall(courses, columns)
    fixed = model.fixed.copy()
    fixed[[model.block_count // 2, -1]] = True
    contacts = contacts_of(model)
    rng = np.random.default_rng(seed)
    count, number = model.block_count, len(contacts)
    own = rng.normal(size=(count, 6, 6))
    diagonal = weight * (np.eye(6) + 0.1 * own @ own.transpose(0, 2, 1))
    force = np.where(fixed[:, None], 0.0, rng.normal(size=(count, 6)))
    stiff = rng.random((2, number)) < 0.6
    stiff[:, contacts.pair % 7 == 3] = False
    normal, shear = 1e6 * rng.random((2, number)) * stiff
    none = np.zeros(number)
    response = ContactResponse(
        normal_force=none,
        shear_force=none,
        normal_stiffness=normal,
        shear_stiffness=shear,
        coupling=none,
        mode=np.zeros(number, np.int64),
        bonded=np.zeros(number, np.bool_),
        energy=none,
        dissipation=none,
    )
    base = DiagonalTerms(
        diagonal=diagonal,
        force=force,
        momentum=np.zeros((count, 6)),
        centroid=centroids(model, at_start(model)),
    )
    return symmetric_system(base, contacts, response, force, fixed, graph_of(contacts, count))


def by_blocks(one):
    """Return the same system with its couplings written down."""
    return replace(one, couplings=Blocks(upper=one.upper.copy(), lower=one.lower.copy()))


LARGE = {"courses": 30, "columns": 35}
"""Of so many blocks and pairs that threads share them."""


@pytest.mark.parametrize("given", [{}, LARGE])
def test_springs_couple_what_their_blocks_couple(given):
    one = springs(**given)
    two = by_blocks(one)
    assert np.array_equal(one.couplings.coupled, two.couplings.coupled)
    assert 0.3 < one.couplings.coupled.mean() < 0.9
    for precision in (np.float32, np.float64):
        found = one.couplings.in_precision(precision)
        assert found.dtype == precision
        assert np.array_equal(found, two.couplings.in_precision(precision))


@pytest.mark.parametrize("given", [{}, {"weight": 1e-1}, LARGE])
def test_springs_leave_to_translations_what_the_sums_of_rows_leave(given):
    one = springs(**given)
    assert inertia_shares(one) == pytest.approx(inertia_shares(by_blocks(one)), rel=1e-7)
    assert 0.0 < inertia_shares(one)[1] < inertia_shares(one)[0] < 1.0


def test_springs_without_stiffness_leave_everything():
    one = springs()
    nothing = np.zeros_like(one.couplings.normal_stiffness)
    loose = replace(one.couplings, coupled=np.zeros_like(one.couplings.coupled))
    loose = replace(loose, normal_stiffness=nothing, shear_stiffness=nothing)
    assert not loose.upper.any()
    assert inertia_shares(by_blocks(replace(one, couplings=loose))) == (1.0, 1.0)


@pytest.mark.parametrize("precision", [np.float32, np.float64])
@pytest.mark.parametrize("given", [{}, LARGE])
def test_both_are_factorised_alike(given, precision):
    """The factor, K in its order and the solution, to the last bit."""
    one = springs(**given)
    ways = [with_incomplete(system, 50, precision) for system in (one, by_blocks(one))]
    for here, there in zip(
        (*ways[0].incomplete, *ways[0].matrix), (*ways[1].incomplete, *ways[1].matrix), strict=True
    ):
        assert np.array_equal(here, there)
    assert {part.dtype for part in ways[0].matrix} == {np.dtype(precision)}
    guess = np.zeros_like(one.force)
    found = [way(one.force, guess, 1e-5) for way in ways]
    assert found[0][0] == pytest.approx(found[1][0], abs=1e-4 * np.abs(found[0][0]).max())
    assert np.array_equal(found[0][0], found[1][0])
    assert found[0][2] <= 1e-5
    product = np.empty_like(one.force)
    matrix = one.diagonal, one.upper, one.pairs, *one.rows
    block_rows.multiply(*matrix, found[0][0], product)
    free = one.force.any(axis=1)
    assert np.abs(product - one.force)[free].max() <= 1e-3 * np.abs(one.force).max()


def test_levels_are_found_from_springs_too():
    one = springs(**LARGE)
    solutions = [
        PCG(plain=0, tolerance=tolerance).factor(system).solve(one.force)
        for system in (one, by_blocks(one))
        for tolerance in (1e-3, 1e-10)
    ]
    assert np.array_equal(solutions[0], solutions[2])
    assert np.array_equal(solutions[1], solutions[3])
    size = np.abs(solutions[1]).max()
    assert np.abs(solutions[0] - solutions[1]).max() <= 1e-2 * size


def test_what_memory_held_before_does_not_matter():
    """Rows of eight numbers have two that must be zero whatever stood in their place."""
    one = springs(**LARGE)
    ready = with_incomplete(one, 50, np.float32)
    guess = 1e-6 * one.force
    wanted, iterations, _ = ready(one.force, guess, 1e-5)
    for _ in range(3):
        held = [conjugate.vector(len(guess), ready.matrix[0]) for _ in range(8)]
        for rows in held:
            rows[:] = np.nan
        del held, rows
        found, needed, left = ready(one.force, guess, 1e-5)
        assert left <= 1e-5
        assert needed == iterations > 0
        assert np.array_equal(found, wanted)
