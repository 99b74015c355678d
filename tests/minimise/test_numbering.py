"""Numbers by which touching blocks are near each other in memory."""

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.stopwatch import Stages
from clast.linear.reuse import FactorOfStep
from clast.minimise import connected as kernel
from clast.minimise import numbering
from clast.minimise.subproblem import renumbered
from clast.studies.bench.scenes import GRAVITY, box, outlines_of_wall
from scenes.potentials import caught
from scenes.systems import at_start, by_convex, heap, open_ledger, system


def bricks(courses, columns, seed=None):
    """Return a wall on a fixed ground, its bricks numbered by courses or at random."""
    outlines = list(outlines_of_wall(courses, columns))
    place = np.arange(len(outlines))
    if seed is not None:
        np.random.default_rng(seed).shuffle(place)
    ground = box(-1.0, -1.0, columns + 1.0, 0.0)[0]
    blocks = [ground, *(outlines[k] for k in place)]
    model = system(blocks, fixed=[0], friction_angle=30.0, gravity=(0.0, -GRAVITY))
    return model, np.concatenate([[0], place + 1])


def test_the_mean_difference_of_numbers_leaves_out_fixed_blocks():
    pairs = np.array([[0, 5], [1, 2], [2, 6]])
    fixed = np.array([True, False, False, False, False, False, False])
    assert kernel.spread(pairs, fixed) == 2.5
    assert kernel.spread(pairs, np.ones(7, np.bool_)) == 0.0
    assert kernel.spread(pairs[:0], fixed) == 0.0


@pytest.mark.parametrize("shape", [(30, 20), (200, 3), (3, 300), (1, 700)])
def test_only_scattered_numbers_are_changed(shape):
    columns, rows = shape
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    centroid = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(columns * rows).reshape(rows, columns)
    beside = np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()])
    above = np.column_stack([number[:-1].ravel(), number[1:].ravel()])
    pairs = np.concatenate([beside, above]) if rows >= 20 else beside
    free = np.zeros(len(centroid), np.bool_)
    assert numbering.order_of(centroid, pairs, free) is None
    shuffled = np.random.default_rng(1).permutation(len(centroid))
    mixed = np.sort(np.argsort(shuffled)[pairs], axis=1)
    order = numbering.order_of(centroid[shuffled], mixed, free)
    assert np.array_equal(np.sort(order), np.arange(len(centroid)))
    better = np.sort(np.argsort(order)[mixed], axis=1)
    before, after = (kernel.spread(one, free) for one in (mixed, better))
    assert after < 0.2 * before
    assert numbering.order_of(centroid[shuffled][order], better, free) is None


def test_few_blocks_keep_their_numbers():
    rng = np.random.default_rng(2)
    pairs = np.sort(rng.integers(0, numbering.FEW, (900, 2)), axis=1)
    free = np.zeros(numbering.FEW, np.bool_)
    assert numbering.order_of(rng.random((numbering.FEW, 2)), pairs, free) is None


def test_the_potential_is_the_same_with_other_numbers(monkeypatch):
    rng = np.random.default_rng(3)
    for one in caught(monkeypatch, heap(40, 10), 5e8, 5e-3, 0.3)[10::7]:
        order = rng.permutation(len(one.fixed))
        part = renumbered(one, order)
        assert np.array_equal(part.blocks, order)
        pairs = part.potential.contacts.pairs
        assert np.array_equal(pairs, pairs[np.lexsort(pairs.T[::-1])])
        assert (pairs[:, 0] < pairs[:, 1]).all()
        unknowns = 1e-4 * rng.normal(size=(len(order), 6)) * ~one.fixed[:, None]
        whole, point = one.at(unknowns), part.potential.at(unknowns[order])
        scale = np.abs(whole.residual).max()
        assert point.residual == pytest.approx(whole.residual[order], abs=1e-12 * scale)
        assert one.distance(whole) == pytest.approx(part.potential.distance(point), rel=1e-9)
        key = {(v, e): g for v, e, g in zip(*own(one.contacts), whole.gap, strict=True)}
        assert key == {
            (v, e): g for v, e, g in zip(*own(part.potential.contacts), point.gap, strict=True)
        }


def own(contacts):
    """Return vertex and edge of each contact."""
    return contacts.vertex.tolist(), contacts.edge.tolist()


def test_a_wall_numbered_at_random_settles_like_one_numbered_by_courses(monkeypatch):
    """In as many iterations of the solver too, within a quarter."""
    asked = []
    found = numbering.by_rows
    monkeypatch.setattr(numbering, "by_rows", lambda at: asked.append(1) or found(at))

    def run(seed):
        model, place = bricks(20, 30, seed)
        how = replace(by_convex(5e9), max_displacement=0.05)
        state, counts = open_ledger(model, how, at_start(model)), {"pcg": 0, "passes": 0}
        for _ in range(5):
            result = how.process.step(model, how, state, 5e-3)
            state = result.state
            counts = {key: counts[key] + result.counts[key] for key in counts}
        velocity = np.empty_like(state.velocity)
        velocity[place] = state.velocity
        return velocity, counts

    there, wanted = run(None)
    assert not asked
    here, counts = run(1)
    assert asked
    assert np.abs(here - there).max() < 1e-4 * np.abs(there).max()
    assert counts["pcg"] < 1.25 * wanted["pcg"]


def test_the_factor_of_a_step_is_not_that_of_other_numbers(monkeypatch):
    """Stiffnesses alone do not say which blocks they are between."""
    one = caught(monkeypatch, heap(40, 10), 5e8, 5e-3, 0.3)[-1]
    how = by_convex(5e8)
    rng = np.random.default_rng(4)
    point = one.at(1e-4 * rng.normal(size=(len(one.fixed), 6)) * ~one.fixed[:, None])
    order = rng.permutation(len(one.fixed))
    other = renumbered(one, order).potential
    there = other.at(point.unknowns[order])
    all_alike = np.full_like(point.response.normal_stiffness, 5e8)
    alike = [
        replace(
            at,
            response=replace(at.response, normal_stiffness=all_alike, shear_stiffness=all_alike),
        )
        for at in (point, there)
    ]
    factor = FactorOfStep(how.solver)
    first = one.direction(alike[0], factor, Stages())
    second = other.direction(alike[1], factor, Stages())
    assert factor.factorised == 2
    assert second == pytest.approx(first[order], abs=1e-6 * np.abs(first).max())
