"""The unbalanced forces on blocks: load, base and contacts by their definition."""

from __future__ import annotations

import numpy as np

from clast.linear.assembly import unbalanced

PAIRS = np.array([[0, 1], [0, 3], [1, 2]])
CONTACTS_OF_PAIRS = [2, 1, 3]


def test_forces_that_are_not_in_balance_are_load_less_base_plus_contacts():
    rng = np.random.default_rng(4)
    blocks, count = 5, sum(CONTACTS_OF_PAIRS)
    half = rng.normal(size=(blocks, 6, 6))
    base = half @ half.transpose(0, 2, 1) + np.eye(6)
    load, d = rng.normal(size=(2, blocks, 6))
    fixed = np.array([False, False, True, False, False])
    pair = np.repeat(np.arange(len(PAIRS)), CONTACTS_OF_PAIRS)
    start = np.concatenate([[0], np.cumsum(CONTACTS_OF_PAIRS)])
    right = np.searchsorted(PAIRS[:, 0], np.arange(blocks + 1))
    listed = np.argsort(PAIRS[:, 1], kind="stable")
    left = np.searchsorted(PAIRS[listed, 1], np.arange(blocks + 1))
    # nx, ny, and the arms of both blocks
    angle = rng.uniform(0.0, 6.0, count)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    arms = np.concatenate([way, rng.normal(size=(count, 4))], axis=1)
    normal, shear = rng.normal(size=(2, count))
    vertex_block, edge_block = PAIRS[pair, 0], PAIRS[pair, 1]

    wanted = load - np.einsum("bij,bj->bi", base, d)
    for c in range(count):
        (nx, ny), own = way[c], arms[c]
        force = np.array([normal[c] * nx - shear[c] * ny, normal[c] * ny + shear[c] * nx])
        for block, sense, (x, y) in (
            (vertex_block[c], 1.0, own[2:4]),
            (edge_block[c], -1.0, own[4:6]),
        ):
            basis = np.array([[1, 0, -y, x, 0, 0.5 * y], [0, 1, x, 0, y, 0.5 * x]])
            wanted[block] += sense * basis.T @ force
    wanted[fixed] = 0.0
    system = base, np.linalg.inv(base), load, fixed
    graph = start, right, left, listed
    found, distance = unbalanced(system, graph, (vertex_block, arms), d, normal, shear)
    assert np.abs(found - wanted).max() <= 1e-12 * np.abs(wanted).max()
    squares = np.einsum("bi,bij,bj->b", wanted, system[1], wanted)
    assert np.abs(distance - squares).max() <= 1e-10 * squares.max()
