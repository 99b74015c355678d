"""Length of joint that contacts stand for: over two faces it adds up to what they share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clast.contact.candidates import SearchDistance
from clast.rockmass import Domain, Exponential, JointSet, cut
from scenes.systems import box, bricks, contacts_of, system, turned, voussoirs

NEAR = SearchDistance(front=1e-6, depth=1e-6, critdis=1e-6)
"""So near that no two corners of a cut rock mass coincide which are not one."""


def shared_length(contacts, one, other):
    """Return the sum of the lengths of all contacts between two blocks, m."""
    blocks = np.sort(np.stack([contacts.vertex_block, contacts.edge_block], axis=1), axis=1)
    return float(contacts.length[(blocks == sorted((one, other))).all(axis=1)].sum())


def with_vertices(outline, shares, edge=2):
    """Return an outline with flat vertices at shares of the length of one edge."""
    start, end = outline[edge], outline[(edge + 1) % len(outline)]
    between = np.array([start + share * (end - start) for share in shares]).reshape(-1, 2)
    return np.concatenate([outline[: edge + 1], between, outline[edge + 1 :]])


FACES = {
    "corners coincide": (box(0, 0), box(0, 1), 1.0),
    "offset": (box(0, 0), box(0.3, 1), 0.7),
    "offset by less than critdis": (box(0, 0), box(0.003, 1), 0.997),
    "short on long": (box(0, 0, 3.0), box(1, 1), 1.0),
    "T joint": (box(0, 0, 3.0), box(1, 1, 0.2, 4.0), 0.2),
    "one end in common": (box(0, 0, 3.0), box(2, 1), 1.0),
    "side by side": (box(0, 0, 1.0, 2.0), box(1, 0.5), 1.0),
    "flat vertex inside": (with_vertices(box(0, 0), [0.4]), box(0, 1), 1.0),
    "flat vertex at a corner": (with_vertices(box(0, 0, 3.0), [0.5]), box(1.5, 1), 1.0),
    "flat vertex near a corner": (with_vertices(box(0, 0, 3.0), [0.499]), box(1.5, 1), 1.0),
    "flat vertices opposite each other": (
        with_vertices(box(0, 0), [0.25]),
        with_vertices(box(0, 1), [0.75], edge=0),
        1.0,
    ),
    "many flat vertices": (
        with_vertices(box(0, 0, 3.0), [0.1, 0.4, 0.5, 0.8]),
        with_vertices(box(0.5, 1, 2.0), [0.3, 0.6, 0.61], edge=0),
        2.0,
    ),
    "on a stair": (
        np.array([[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [0, 1]], float),
        box(1, 1, 1.0, 3.0),
        2.0,
    ),
    "thinner than the angle of a face": (
        np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.04]]),
        np.array([[0.0, 0.0], [1.0, 0.04], [1.0, 1.0], [0.0, 1.0]]),
        float(np.hypot(1.0, 0.04)),
    ),
    "a corner in common": (box(0, 0), box(1, 1), 0.0),
    "a tip": (box(0, 0), np.array([[0.5, 1.0], [0.6, 2.0], [0.4, 2.0]]), 0.0),
}


@pytest.mark.parametrize("angle", [0.0, 0.7, 3.0])
@pytest.mark.parametrize("faces", FACES)
def test_contacts_of_two_blocks_share_their_common_length(faces, angle):
    one, other, length = FACES[faces]
    contacts = contacts_of(system([turned(one, angle), turned(other, angle)]))
    exact = 2e-3 if faces == "flat vertex near a corner" else 1e-9
    assert shared_length(contacts, 0, 1) == pytest.approx(length, abs=exact)


@given(
    offset=st.floats(-0.9, 0.9),
    width=st.floats(0.2, 3.0),
    flats=st.lists(st.floats(0.02, 0.98), max_size=3, unique=True),
    others=st.lists(st.floats(0.02, 0.98), max_size=3, unique=True),
)
def test_any_two_faces_share_their_common_length(offset, width, flats, others):
    """Up to critdis at each vertex that nearly meets another one."""
    if any(np.diff(sorted(shares)).min(initial=1.0) < 0.02 for shares in (flats, others)):
        return
    low = with_vertices(box(0, 0), sorted(flats))
    high = with_vertices(box(offset, 1, width), sorted(others), edge=0)
    common = min(1.0, offset + width) - max(0.0, offset)
    contacts = contacts_of(system([low, high]))
    near = 0.005 * (2 + len(flats) + len(others))
    assert shared_length(contacts, 0, 1) == pytest.approx(max(0.0, common), abs=near)


@pytest.mark.parametrize("width", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("offset", [0.005, -0.005])
def test_corners_just_critdis_apart_share_the_length_of_their_faces(offset, width):
    contacts = contacts_of(system([box(0, 0), box(offset, 1, width)]))
    common = min(1.0, offset + width) - max(0.0, offset)
    assert shared_length(contacts, 0, 1) == pytest.approx(common, abs=0.0051)


def test_bed_joints_of_a_wall():
    """Half a brick rests on each of the two below; every head joint is as high as a brick."""
    contacts = contacts_of(system(bricks(3, 4)))
    for course in (0, 1):
        for column in range(3):
            below, above = 4 * course + column, 4 * (course + 1) + column
            assert shared_length(contacts, below, above) == pytest.approx(0.5)
            assert shared_length(contacts, below, below + 1) == pytest.approx(0.5)


def test_joints_of_an_arch():
    contacts = contacts_of(system(voussoirs(11)))
    assert [shared_length(contacts, k, k + 1) for k in range(10)] == pytest.approx([0.6] * 10)


@pytest.mark.parametrize("seed", range(4))
def test_contacts_of_a_cut_rock_mass_stand_for_its_joints(seed):
    """Four blocks meet at each crossing: of each pair the contacts have just what they share."""
    rng = np.random.default_rng(seed)
    boundary = np.array([[0, 0], [30, 0], [30, 20], [0, 20]])
    angle = rng.uniform(0.0, 180.0)
    sets = [
        JointSet(name="a", angle=angle, spacing=rng.uniform(1.5, 3.0)),
        JointSet(name="b", angle=angle + rng.uniform(30.0, 150.0), spacing=Exponential(mean=2.5)),
    ]
    found = cut(Domain(boundary=boundary), sets=sets, seed=seed)
    parts = np.split(found.vertices, found.block_start[1:-1])
    contacts = contacts_of(system(parts), reach=NEAR)
    blocks = np.sort(np.stack([contacts.vertex_block, contacts.edge_block], axis=1), axis=1)
    count = len(parts)
    has = np.bincount(blocks @ [count, 1], contacts.length, minlength=count**2)
    shared = np.zeros(count**2)
    sides = {}
    for b, part in enumerate(parts):
        for p, q in zip(part.tolist(), np.roll(part, -1, axis=0).tolist(), strict=True):
            other = sides.pop((*q, *p), None)
            if other is None:
                sides[*p, *q] = b
            else:
                shared[other * count + b] += np.hypot(q[0] - p[0], q[1] - p[1])
    assert np.count_nonzero(shared) > 50
    assert np.abs(has - shared).max() < 1e-9
