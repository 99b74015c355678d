"""Contact detection by parts: copies of a system have copies of its contacts."""

import numpy as np
import pytest

from clast.contact.detection import find_tunnelled
from clast.kernels.shares import PART
from clast.state import ContactMemory
from systems import at_start, contacts_of, courses_of_bricks, system

COPIES = 60
APART = 64.0
"""Distance of the copies, m: a power of 2, so that differences of coordinates are exact."""


OUTLINES = courses_of_bricks(6, 5)


def shaken(copies, seed):
    """Return the contacts of copies of a wall of bricks that have all moved by the same 4 mm."""
    rng = np.random.default_rng(seed)
    moved = 2.0**-20 * rng.integers(-4000, 4000, (4 * len(OUTLINES), 2))
    shift = np.repeat(APART * np.arange(copies), 4 * len(OUTLINES))
    model = system(copied(copies))
    vertices = np.tile(np.concatenate(OUTLINES) + moved, (copies, 1))
    vertices[:, 0] += shift
    return contacts_of(model, at_start(model, vertices - model.origin))


def copied(copies):
    """Return the outlines of copies of the wall, side by side."""
    return [outline + np.array([APART * k, 0.0]) for k in range(copies) for outline in OUTLINES]


@pytest.mark.parametrize("seed", [1, 2])
def test_copies_of_a_system_have_copies_of_its_contacts(seed):
    one, all_of_them = shaken(1, seed), shaken(COPIES, seed)
    blocks, vertices, count = len(OUTLINES), 4 * len(OUTLINES), len(one)
    assert COPIES * blocks > PART
    assert len(all_of_them.pairs) > 3 * PART
    assert len(all_of_them) == COPIES * count
    for k in range(COPIES):
        mine = slice(k * count, (k + 1) * count)
        assert np.array_equal(all_of_them.vertex[mine] - k * vertices, one.vertex)
        assert np.array_equal(all_of_them.edge[mine] - k * vertices, one.edge)
        assert np.array_equal(all_of_them.vertex_block[mine] - k * blocks, one.vertex_block)
        assert np.array_equal(all_of_them.gap[mine], one.gap)
        assert np.array_equal(all_of_them.length[mine], one.length)


def test_the_deepest_jump_is_found_wherever_it_is():
    model = system(copied(COPIES))
    vertices = at_start(model).vertices
    for copy, depth in ((3, 0.05), (31, 0.08), (58, 0.11)):
        vertex = 4 * (copy * len(OUTLINES) + 20) + 1
        vertices = vertices.copy()
        vertices[vertex, 1] -= depth
        found, which, _ = find_tunnelled(model, vertices, ContactMemory())
        assert which == vertex
        assert found == pytest.approx(depth, rel=0.3)
