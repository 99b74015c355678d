"""Small systems are solved exactly, whatever couples their blocks."""

import numpy as np
import pytest

from clast.linear import elimination


def random_system(rng, count, density):
    """Return diagonal blocks, coupled pairs and their blocks of a random definite matrix."""
    low, high = np.triu_indices(count, 1)
    chosen = rng.random(len(low)) < density
    pairs = np.stack([low[chosen], high[chosen]], axis=1)
    upper = rng.normal(size=(len(pairs), 6, 6))
    own = rng.normal(size=(count, 6, 6))
    own = own + own.transpose(0, 2, 1)
    size = np.zeros(count)
    np.add.at(size, pairs.ravel(), np.repeat(np.abs(upper).sum(axis=(1, 2)), 2))
    own += (size + np.abs(own).sum(axis=(1, 2)))[:, None, None] * np.eye(6)
    return own, pairs, upper


def dense(own, pairs, upper):
    """Return the matrix (6n, 6n)."""
    count = len(own)
    whole = np.zeros((count, 6, count, 6))
    for i in range(count):
        whole[i, :, i] = own[i]
    for (i, j), block in zip(pairs, upper, strict=True):
        whole[i, :, j], whole[j, :, i] = block, block.T
    return whole.reshape(6 * count, 6 * count)


def eliminated(own, pairs, upper, force):
    """Return the solution, and whether there was room and a pivot for it."""
    links = elimination.room_for(len(own))
    links[0][:], links[4][:] = 0, 0
    for (i, j), block in zip(pairs, upper, strict=True):
        at = elimination.joined(i, j, links)
        if at < 0:
            return force, False
        links[3][at] += block
    found = force.copy()
    return found, elimination.solve(own.copy(), links, found)


@pytest.mark.parametrize("seed", range(30))
def test_the_solution_is_that_of_the_dense_matrix(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 22))
    own, pairs, upper = random_system(rng, count, rng.choice([0.0, 0.1, 0.3, 0.5]))
    force = rng.normal(size=(count, 6))
    found, definite = eliminated(own, pairs, upper, force)
    wanted = np.linalg.solve(dense(own, pairs, upper), force.ravel()).reshape(-1, 6)
    assert definite
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12 * np.abs(wanted).max())


def test_a_tree_has_no_fill():
    """However its blocks are numbered: there is no other block than those of its pairs."""
    rng = np.random.default_rng(1)
    count = 300
    number = rng.permutation(count)
    parents = np.array([rng.integers(0, k) for k in range(1, count)])
    pairs = np.sort(np.stack([number[parents], number[1:]], axis=1), axis=1)
    degree = np.bincount(pairs.ravel())
    assert degree.max() < elimination.MOST
    upper, own = rng.normal(size=(len(pairs), 6, 6)), np.tile(200.0 * np.eye(6), (count, 1, 1))
    links = elimination.room_for(count)
    links[0][:], links[4][:] = 0, 0
    for (i, j), block in zip(pairs, upper, strict=True):
        links[3][elimination.joined(i, j, links)] += block
    force = rng.normal(size=(count, 6))
    found = force.copy()
    assert elimination.solve(own.copy(), links, found)
    assert links[4][0] == len(pairs)
    wanted = np.linalg.solve(dense(own, pairs, upper), force.ravel()).reshape(-1, 6)
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_what_is_too_large_or_not_definite_is_not_solved():
    rng = np.random.default_rng(2)
    # a block of more neighbours than there is room for, and fill beyond all room
    star = np.stack([np.zeros(elimination.MOST + 1, int), np.arange(1, elimination.MOST + 2)], 1)
    for pairs, count in ((star, elimination.MOST + 2), (None, 60)):
        own, full, upper = random_system(rng, count, 0.3)
        if pairs is not None:
            full, upper = pairs, rng.normal(size=(len(pairs), 6, 6))
        assert not eliminated(own, full, upper, np.ones((count, 6)))[1]
    own, pairs, upper = random_system(rng, 5, 0.5)
    own[3] -= 2.0 * np.abs(own[3]).max() * np.eye(6)
    assert np.linalg.eigvalsh(dense(own, pairs, upper)).min() < 0.0
    assert not eliminated(own, pairs, upper, np.ones((5, 6)))[1]
