"""The block system: assembled, held and solved as a dense matrix would be."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from clast.contact.contacts import Contacts
from clast.contact.laws import Penalty
from clast.errors import StepOutcome, StepRejected
from clast.linear.solvers import PCG, Direct, solve
from clast.linear.system import (
    BlockSystem,
    assemble,
    gap_at_end,
    graph_of,
    slip_in_step,
    symmetric_system,
)
from clast.model.model import Model
from clast.step.start import begin, diagonal_terms
from scenes.block_matrices import dense
from scenes.systems import at_start, bricks, contacts_of, method, system

STEP = 1e-3


@dataclass(frozen=True)
class Case:
    """A pressed wall, and a law evaluated somewhere near."""

    model: Model
    base: object
    contacts: Contacts
    response: object
    gap: np.ndarray
    slip: np.ndarray

    def assembled(self) -> BlockSystem:
        return assemble(
            self.base, self.contacts, self.response, self.gap, self.slip, self.model.fixed
        )


def wall(fixed=(0, 1, 2), seed=0):
    """Return a wall whose contacts partly stick, partly slide and are partly open."""
    rng = np.random.default_rng(seed)
    model = system(bricks(3, 3), fixed=fixed, friction_angle=30.0)
    noise = 2e-4 * rng.normal(size=model.vertices.shape)
    state = at_start(model, model.vertices * 0.9995 + noise)
    contacts = contacts_of(model, state)
    contacts = replace(contacts, shear_force=1e4 * rng.normal(size=len(contacts)))
    how = method(contact_law=Penalty(normal_stiffness=1e8, shear_stiffness=3e7))
    velocity = 0.01 * rng.normal(size=(model.block_count, 6)) * ~model.fixed[:, None]
    context = begin(model, how, state, STEP, None)
    base = diagonal_terms(context, STEP * velocity, context.scheme)
    unknowns = 1e-5 * rng.normal(size=(model.block_count, 6))
    gap, slip = gap_at_end(contacts, unknowns), slip_in_step(contacts, unknowns)
    response = how.contact_law.respond(contacts, gap, slip)
    assert set(response.mode) == {0, 1, 2}
    return Case(model, base, contacts, response, gap, slip)


def dense_by_definition(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Return K and F of the linearised law in plain numpy, fixed blocks left in."""
    count = case.model.block_count
    matrix = np.zeros((6 * count, 6 * count))
    for b in range(count):
        matrix[6 * b : 6 * b + 6, 6 * b : 6 * b + 6] = case.base.diagonal[b]
    force = case.base.force.ravel().copy()
    contacts, response = case.contacts, case.response
    for c in range(len(contacts)):
        n, t = np.zeros((2, 6 * count))
        i, j = contacts.vertex_block[c], contacts.edge_block[c]
        n_i, n_j, t_i, t_j = contacts.rows[c]
        n[6 * i : 6 * i + 6], n[6 * j : 6 * j + 6] = n_i, n_j
        t[6 * i : 6 * i + 6], t[6 * j : 6 * j + 6] = t_i, t_j
        kn, ks = response.normal_stiffness[c], response.shear_stiffness[c]
        # N(d) = N* - kn (gap0 + n.d - gap*),  T(d) = T* - ks (t.d - slip*)
        at_zero = response.normal_force[c] - kn * (contacts.gap[c] - case.gap[c])
        shear = response.shear_force[c] + ks * case.slip[c]
        matrix += kn * np.outer(n, n) + ks * np.outer(t, t)
        force += at_zero * n + shear * t
    return matrix, force


@pytest.mark.parametrize("seed", range(4))
def test_assembly_equals_the_dense_definition(seed):
    case = wall(fixed=(), seed=seed)
    matrix, force = dense_by_definition(case)
    one = case.assembled()
    scale = np.abs(matrix).max()
    assert dense(one) == pytest.approx(matrix, abs=1e-12 * scale)
    assert one.force.ravel() == pytest.approx(force, abs=1e-12 * np.abs(force).max())


def test_the_matrix_is_positive_definite():
    one = wall().assembled()
    matrix = dense(one)
    assert np.linalg.eigvalsh(matrix).min() > 0.0


def test_pairs_are_sorted_and_couple_touching_blocks():
    case = wall()
    pairs = [tuple(pair) for pair in case.assembled().pairs.tolist()]
    assert pairs == sorted(set(pairs))
    assert all(i < j for i, j in pairs)
    touching = np.sort(np.stack([case.contacts.vertex_block, case.contacts.edge_block]), axis=0)
    assert set(pairs) == {tuple(pair) for pair in touching.T.tolist()}


def test_solver_equals_a_dense_solve():
    one = wall().assembled()
    matrix, force = dense(one), one.force.ravel()
    wanted = np.linalg.solve(matrix, force)
    for solver, rel in ((Direct(), 1e-9), (PCG(tolerance=1e-13), 1e-7)):
        assert solve(solver, one).ravel() == pytest.approx(wanted, rel=rel, abs=1e-16)


def test_fixed_blocks_move_by_nothing_at_all():
    case = wall(fixed=(0, 4, 5))
    unknowns = solve(Direct(), case.assembled())
    assert np.array_equal(unknowns[[0, 4, 5]], np.zeros((3, 6)))
    free = [1, 2, 3, 6, 7, 8]
    assert np.all(np.abs(unknowns[free]).max(axis=1) > 0.0)


def test_free_blocks_beside_fixed_ones_solve_the_reduced_system():
    """Holding a block means striking its rows and columns."""
    case = wall(fixed=(0, 4))
    matrix, force = dense_by_definition(case)
    free = np.repeat(~case.model.fixed, 6)
    wanted = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    found = solve(Direct(), case.assembled()).ravel()[free]
    assert found == pytest.approx(wanted, rel=1e-8, abs=1e-16)


def test_newton_system_has_the_same_matrix_and_the_residual():
    case = wall(fixed=(0,))
    residual = np.random.default_rng(1).normal(size=(case.model.block_count, 6))
    residual[0] = 0.0
    graph = graph_of(case.contacts, case.model.block_count)
    one = symmetric_system(
        case.base, case.contacts, case.response, residual, case.model.fixed, graph
    )
    assert np.array_equal(dense(one), dense(case.assembled()))
    assert np.array_equal(one.force, residual)


def test_assembling_changes_nothing_that_it_was_given():
    case = wall()
    before = (case.base.diagonal.copy(), case.base.force.copy())
    first, second = case.assembled(), case.assembled()
    assert np.array_equal(case.base.diagonal, before[0])
    assert np.array_equal(case.base.force, before[1])
    assert np.array_equal(first.diagonal, second.diagonal)
    assert np.array_equal(first.force, second.force)


def test_singular_matrix_rejects_the_step():
    one = wall().assembled()
    with pytest.raises(StepRejected) as caught:
        solve(Direct(), replace(one, diagonal=0.0 * one.diagonal, upper=0.0 * one.upper))
    assert caught.value.outcome is StepOutcome.SINGULAR


def test_forces_that_are_no_numbers_reject_the_step():
    one = wall().assembled()
    force = one.force.copy()
    force[4, 1] = np.nan
    with pytest.raises(StepRejected) as caught:
        solve(Direct(), replace(one, force=force))
    assert caught.value.outcome is StepOutcome.NOT_FINITE
