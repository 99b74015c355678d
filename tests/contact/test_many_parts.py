"""Contact detection by parts: copies of a system have copies of its contacts."""

from dataclasses import replace

import numpy as np
import pytest

from clast.block import polygon
from clast.compute.parallel import CONTACTS
from clast.contact.contacts import ContactResponse
from clast.contact.detection import find_tunnelled
from clast.contact.joints.wear import at_rest
from clast.contact.memory import renew
from clast.contact.verlet_list import VerletList
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


def response_of(contacts, copies, gap):
    """Return an answer that differs from contact to contact, and not from copy to copy."""
    rng, count = np.random.default_rng(7), len(contacts) // copies
    pulls, modes = rng.normal(size=count), rng.integers(0, 3, count)
    zero = np.zeros(len(contacts))
    return ContactResponse(
        normal_force=np.maximum(0.0, -1e8 * gap),
        shear_force=np.tile(pulls, copies),
        normal_stiffness=zero,
        shear_stiffness=zero,
        coupling=zero,
        mode=np.tile(modes, copies),
        bonded=np.ones(len(contacts), np.bool_),
        energy=zero,
        dissipation=zero,
    )


@pytest.mark.parametrize("later", [1, 3])
def test_copies_of_a_system_remember_the_same(later):
    """In the same place (1), and moved on (3): some contacts are lost then and some found."""
    found, gaps = [], []
    for copies in (1, COPIES):
        contacts = shaken(copies, 1)
        answer = response_of(contacts, copies, contacts.gap)
        memory = renew(contacts, answer, contacts.gap, 0.0 * contacts.gap, 1e-3, at_rest(contacts))
        gaps.append(len(memory.gap))
        found.append(shaken(copies, later, memory))
    one, all_of_them = found
    count = len(one)
    assert COPIES * count >= CONTACTS.many
    assert gaps[1] == COPIES * gaps[0]
    assert one.known.all() == (later == 1)
    assert len(set(one.shear_force)) > 10
    names = ("known", "bonded", "mode", "shear_force", "normal_force", "friction", "cohesion")
    for k in range(COPIES):
        mine = slice(k * count, (k + 1) * count)
        for name in names:
            assert np.array_equal(getattr(all_of_them, name)[mine], getattr(one, name)), name


def test_copies_of_a_system_have_the_same_areas_and_moments():
    count = len(OUTLINES)
    copies = 1 + CONTACTS.many // count
    vertices = np.concatenate(OUTLINES)
    shift = np.repeat(APART * np.arange(copies), len(vertices))
    all_of_them = np.tile(vertices, (copies, 1))
    all_of_them[:, 0] += shift
    area, centroid, second = polygon.moments(vertices, np.arange(0, 4 * count + 1, 4))
    found = polygon.moments(all_of_them, np.arange(0, 4 * copies * count + 1, 4))
    assert found[0] == pytest.approx(np.tile(area, copies), rel=1e-12)
    moved = np.tile(centroid, (copies, 1)) + np.outer(shift[::4], [1.0, 0.0])
    assert found[1] == pytest.approx(moved, rel=1e-12)
    assert found[2] == pytest.approx(np.tile(second, (copies, 1)), rel=1e-11)


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
