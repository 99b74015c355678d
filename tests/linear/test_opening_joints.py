"""Pressures of water in joints that open by given volumes, against all sets of nodes."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from clast.linear.opening_joints import Channels, OpeningJoints
from clast.model.arrays import Floats

COUNT = 9


def joints(seed: int, low: float = 0.0) -> tuple[OpeningJoints, Floats]:
    """Return nodes at random, one with a given pressure and one that gives water off."""
    rng = np.random.default_rng(seed)
    ends = np.stack(np.triu_indices(COUNT, 1), axis=1)
    between = rng.uniform(0.0, 3.0, len(ends)) * (rng.random(len(ends)) < 0.5)
    own = rng.uniform(0.1, 2.0, COUNT)
    node, block = np.divmod(np.arange(2 * COUNT), 2)
    lows, highs = np.full(COUNT, low), np.full(COUNT, np.inf)
    lows[0] = highs[0] = 0.7
    highs[1] = 0.4
    water = OpeningJoints(
        channels=Channels.of(COUNT, ends, node, block),
        rows=rng.normal(size=(2 * COUNT, 6)),
        between=between,
        own=own + np.bincount(ends.ravel(), np.repeat(between, 2), COUNT),
        known=rng.normal(size=COUNT),
        low=lows,
        high=highs,
        acting=np.zeros(COUNT),
    )
    return water, rng.normal(size=COUNT)


def matrix_of(water: OpeningJoints) -> Floats:
    """Return A, column by column."""
    return np.array([water.held(one) for one in np.eye(len(water.own))]).T


def tried(water: OpeningJoints, opened: Floats) -> Floats:
    """Return the pressures that keep all bounds, found by trying every set of nodes at them."""
    matrix, right = matrix_of(water), water.known - opened
    for sides in product((-1, 0, 1), repeat=COUNT):
        at = np.array(sides)
        if ((at < 0) & np.isinf(water.low)).any() or ((at > 0) & np.isinf(water.high)).any():
            continue
        p = np.where(at < 0, water.low, np.where(at > 0, water.high, 0.0))
        free = at == 0
        if free.any():
            rest = right - matrix @ p
            p[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest[free])
        w = matrix @ p - right
        inside = (p >= water.low - 1e-12) & (p <= water.high + 1e-12)
        held = (water.low == water.high) | ((at >= 0) | (w >= -1e-12)) & ((at <= 0) | (w <= 1e-12))
        if inside.all() and held.all():
            return p
    raise AssertionError("no set of nodes keeps all bounds")


@pytest.mark.parametrize("seed", range(12))
def test_pressures_are_those_of_the_one_set_of_nodes_that_keeps_all_bounds(seed):
    water, opened = joints(seed)
    found = water.pressures(opened)
    assert found.pressure == pytest.approx(tried(water, opened), abs=1e-12)
    rest = water.held(found.pressure) + opened - water.known
    assert found.rest == pytest.approx(np.where(found.free, 0.0, rest), abs=1e-12)


def test_where_suction_is_borne_pressures_may_be_negative():
    water, opened = joints(3, -np.inf)
    assert water.pressures(opened).pressure == pytest.approx(tried(water, opened), abs=1e-12)
    assert water.pressures(opened + 10.0).pressure.min() < 0.0


@pytest.mark.parametrize("seed", range(4))
def test_pressure_is_minus_the_slope_of_the_energy(seed):
    water, opened = joints(seed)
    way = 1e-6 * np.random.default_rng(seed).normal(size=COUNT)
    gained = water.energy(opened + way) - water.energy(opened - way)
    found = water.pressures(opened)
    assert gained == pytest.approx(-2.0 * found.pressure @ way, rel=1e-6)
    risen = water.pressures(opened + way).pressure - water.pressures(opened - way).pressure
    assert risen == pytest.approx(2.0 * water.rates(found, way), abs=1e-15)
