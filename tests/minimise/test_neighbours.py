"""Neighbours of blocks and the contacts they share, against sets."""

import numpy as np
import pytest

from clast.minimise import neighbours


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
def test_blocks_pairs_and_contacts_of_some_blocks(share):
    rng = np.random.default_rng(int(10 * share))
    blocks, count = 40, 70
    pairs = np.sort([rng.choice(blocks, 2, replace=False) for _ in range(count)], axis=1)
    start = np.concatenate([[0], np.cumsum(rng.integers(1, 5, count))])
    chosen = rng.random(blocks) < share
    own = [q for q, (low, high) in enumerate(pairs) if chosen[low] or chosen[high]]
    near = set(np.flatnonzero(chosen)) | {int(block) for q in own for block in pairs[q]}
    contacts = [(c, k) for k, q in enumerate(own) for c in range(start[q], start[q + 1])]

    assert set(np.flatnonzero(neighbours.with_neighbours(chosen, pairs))) == near
    of_pairs, of_contacts, of_which = neighbours.touching(chosen, pairs, start)
    assert of_pairs.tolist() == own
    assert list(zip(of_contacts.tolist(), of_which.tolist(), strict=True)) == contacts
