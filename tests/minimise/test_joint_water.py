"""The potential with water in joints: its derivatives, and where it is least along a line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.compilation import Stages
from clast.linear.opening_joints import Channels, OpeningJoints
from clast.minimise.joint_water import WetPotential, with_water
from clast.minimise.newton import Newton
from scenes.block_matrices import dense
from scenes.potentials import at_rest, caught, strengthened, work
from scenes.systems import wall

NODES = 9


def wet(seed: int) -> WetPotential:
    """Return the potential of a wall with springs of all kinds, and nodes that its blocks open."""
    potential = strengthened(caught(wall(3, 4), 5e9, 1e-3, 1e-3)[0], seed)
    rng, blocks = np.random.default_rng(seed), len(potential.fixed)
    node, block = np.nonzero(rng.random((NODES, blocks)) < 0.5)
    ends = np.stack([np.arange(NODES - 1), np.arange(1, NODES)], axis=1)
    low, high = np.zeros(NODES), np.full(NODES, np.inf)
    low[0] = high[0] = 1e4
    water = OpeningJoints(
        channels=Channels.of(NODES, ends, node, block),
        rows=rng.normal(size=(len(node), 6)) * (rng.random((len(node), 6)) < 0.5),
        between=np.full(NODES - 1, 1e-10),
        own=np.full(NODES, 2.1e-10),
        known=1e-6 * rng.normal(size=NODES),
        low=low,
        high=high,
        acting=np.clip(1e4 * rng.normal(size=NODES), low, high),
    )
    return with_water(potential, water)


def somewhere(potential: WetPotential, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return 1e-6 * rng.normal(size=(len(potential.fixed), 6)) * ~potential.fixed[:, None]


@pytest.mark.parametrize("seed", range(4))
def test_the_gradient_is_the_difference_of_energies(seed):
    potential = wet(seed)
    unknowns, way = somewhere(potential, seed), 1e-4 * somewhere(potential, seed + 10)
    gained = potential.energy(unknowns + way) - potential.energy(unknowns - way)
    slope = 2.0 * np.vdot(potential.gradient(unknowns), way)
    scale = np.abs(potential.gradient(unknowns) * way).sum()
    assert gained == pytest.approx(slope, abs=1e-4 * scale)


@pytest.mark.parametrize("seed", range(4))
def test_newtons_direction_solves_the_hessian_with_the_water_in_it(seed):
    potential = wet(seed)
    point = potential.at(somewhere(potential, seed))
    matrix = dense(potential.hessian(point))
    found = potential.water.pressures(potential.water.opened(point.unknowns))
    nodes = np.eye(NODES)
    opens = np.array([potential.water.forces(one, len(potential.fixed)).ravel() for one in nodes])
    opens = opens[found.free] * np.repeat(~potential.fixed, 6)
    held = np.array([potential.water.held(one) for one in nodes])
    stored = held[np.ix_(found.free, found.free)]
    matrix = matrix + opens.T @ np.linalg.solve(stored, opens)
    known = np.linalg.solve(matrix, point.residual.ravel()).reshape(-1, 6)
    known[potential.fixed] = 0.0
    direction = potential.direction(point, work().factor, Stages())
    assert direction == pytest.approx(known, abs=1e-9 * np.abs(known).max())
    times, solved = potential.tangent(point, work().factor)
    assert solved(times(direction)) == pytest.approx(direction, abs=1e-9 * np.abs(known).max())


@pytest.mark.parametrize("seed", range(4))
def test_a_search_ends_where_the_energy_is_least(seed):
    potential = wet(seed)
    point = potential.at(somewhere(potential, seed))
    direction = potential.direction(point, work().factor, Stages())
    line, _ = potential.line_search(point, direction)
    (length,) = set(line.lengths.tolist())
    least = potential.energy(point.unknowns + length * direction)
    for other in (0.0, 0.9 * length, 1.1 * length):
        assert potential.energy(point.unknowns + other * direction) > least


def test_newtons_method_comes_to_the_one_minimum_from_anywhere():
    potential = wet(1)
    tolerance = 1e-20 * potential.reference_energy()
    newton = Newton(iterations=200)
    ends = []
    for start in (at_rest(potential), potential.at(100.0 * somewhere(potential, 3))):
        point, _ = newton.descend(potential, start, tolerance, work(), lambda at: at)
        ends.append(point.unknowns)
    assert ends[0] == pytest.approx(ends[1], abs=1e-6 * np.abs(ends[0]).max())
    dry = replace(potential, water=replace(potential.water, rows=0.0 * potential.water.rows))
    still, _ = newton.descend(dry, at_rest(dry), tolerance, work(), lambda at: at)
    assert np.abs(still.unknowns - ends[0]).max() > 1e-3 * np.abs(ends[0]).max()
