"""Contact detection by parts: copies of a system have copies of its contacts."""

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.parallel import CONTACTS
from clast.contact.broad_phase import VerletList
from clast.contact.detection import find_tunnelled
from clast.model.state import ContactMemory
from scenes.systems import at_start, contacts_of, courses_of_bricks, system

COPIES = 60
APART = 64.0
"""Distance of the copies, m: a power of 2, so that differences of coordinates are exact."""


OUTLINES = courses_of_bricks(6, 5)


def shaken(copies, seed, memory=None):
    """Return the contacts of copies of a wall of bricks that have all moved by the same 4 mm."""
    rng = np.random.default_rng(seed)
    moved = 2.0**-20 * rng.integers(-4000, 4000, (4 * len(OUTLINES), 2))
    shift = np.repeat(APART * np.arange(copies), 4 * len(OUTLINES))
    model = system(copied(copies), friction_angle=20.0, cohesion=1e4)
    vertices = np.tile(np.concatenate(OUTLINES) + moved, (copies, 1))
    vertices[:, 0] += shift
    state = at_start(model, vertices - model.origin)
    if memory is not None:
        state = replace(state, memory=memory, time=1.0)
    return contacts_of(model, state)


def copied(copies):
    """Return the outlines of copies of the wall, side by side.

    Bricks differ in size by a millionth: of equal ones that come first which are nearer to the
    middle of all rock, which is not that of each copy.
    """
    sizes = 1.0 + 1e-6 * np.arange(len(OUTLINES))
    bricks = [one[0] + size * (one - one[0]) for one, size in zip(OUTLINES, sizes, strict=True)]
    return [brick + np.array([APART * k, 0.0]) for k in range(copies) for brick in bricks]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.one_in(2)
def test_copies_of_a_system_have_copies_of_its_contacts(seed):
    one, all_of_them = shaken(1, seed), shaken(COPIES, seed)
    blocks, vertices, count = len(OUTLINES), 4 * len(OUTLINES), len(one)
    assert COPIES * blocks > CONTACTS.part
    assert len(all_of_them.pairs) > 3 * CONTACTS.part
    assert len(all_of_them) == COPIES * count
    for k in range(COPIES):
        mine = slice(k * count, (k + 1) * count)
        assert np.array_equal(all_of_them.vertex[mine] - k * vertices, one.vertex)
        assert np.array_equal(all_of_them.edge[mine] - k * vertices, one.edge)
        assert np.array_equal(all_of_them.vertex_block[mine] - k * blocks, one.vertex_block)
        assert np.array_equal(all_of_them.gap[mine], one.gap)
        assert np.array_equal(all_of_them.length[mine], one.length)
        assert all_of_them.arms[mine] == pytest.approx(one.arms, abs=1e-11)


def test_the_deepest_jump_is_found_wherever_it_is():
    model = system(copied(COPIES))
    vertices = at_start(model).vertices
    for copy, depth in ((3, 0.05), (31, 0.08), (58, 0.11)):
        vertex = 4 * (copy * len(OUTLINES) + 20) + 1
        vertices = vertices.copy()
        vertices[vertex, 1] -= depth
        found, which, _ = find_tunnelled(
            model, at_start(model).vertices, vertices, ContactMemory(), VerletList()
        )
        assert which == vertex
        assert found == pytest.approx(depth, rel=0.3)
