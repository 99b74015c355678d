"""Overlap that no vertex shows: edges that cross, and what is made of them."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from clast.block import polygon
from clast.contact import detection, edge_intersections
from clast.contact.edge_intersections import SHALLOW_CROSSING, with_crossings
from clast.run.overlap import unseen_overlaps
from scenes.corners import memory_of
from scenes.systems import (
    at_start,
    box,
    by_convex,
    contacts_of,
    finish,
    march,
    regular,
    star,
    system,
    turned,
    wall,
)

NO_CONTACTS = (*np.zeros((3, 0), np.int64), np.zeros(0))


def crossings_of(outlines, floor=0.0):
    """Return the crossings of two outlines, as if there were no contacts."""
    vertices = np.concatenate(outlines)
    start = np.cumsum([0, *map(len, outlines)])
    polygons = polygon.polygon_arrays(vertices, start, polygon.owners(start))
    box_of, pairs = polygon.boxes(vertices, start), np.array([[0, 1]])
    limits, carried = (1.01, floor), np.zeros(1, np.bool_)
    return edge_intersections.unseen(polygons, box_of, pairs, NO_CONTACTS, limits, carried)


def toothed(teeth, depth, y):
    """Return a block whose upper side is a row of teeth."""
    x = np.linspace(0.0, 10.0, 2 * teeth + 1)
    top = y + depth * (np.arange(len(x)) % 2)
    return np.array([[0.0, y - 1.0], [10.0, y - 1.0], *zip(x[::-1], top[::-1], strict=True)])


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("corners", [5, 14, 60])
def test_all_crossings_are_found(seed, corners):
    """Few edges are tried each with each, many in a sweep: both find what a clipper finds."""
    rng = np.random.default_rng(seed)
    outlines = [star(rng, corners), star(rng, corners) + rng.uniform(-0.6, 0.6, 2)]
    meet = shapely.intersection(*(shapely.LinearRing(one) for one in outlines))
    assert len(crossings_of(outlines)[0]) == len(shapely.get_parts(meet))


def test_crossings_among_many_teeth():
    lower, upper = toothed(400, 0.02, 0.0), toothed(371, 0.03, 0.0) * [1.0, -1.0] + [0.0017, 0.0291]
    outlines = [lower, upper[::-1]]
    meet = shapely.intersection(*(shapely.LinearRing(one) for one in outlines))
    assert len(crossings_of(outlines)[0]) == len(shapely.get_parts(meet)) > 700


def test_the_way_out_is_the_shorter_one():
    """A corner 2 cm below a floor, 30 cm from its end."""
    floor = box(0, 0, 3.0)
    corner = np.array([[0.3, 0.98], [1.3, 1.5], [0.5, 2.0]])
    _, exits, depth, _ = crossings_of([floor, corner])
    assert set(map(tuple, exits)) == {(4, 2)}
    assert depth == pytest.approx(0.02)
    assert not len(crossings_of([floor, corner], floor=0.03)[0])


@pytest.mark.parametrize("bend", [1e-5, -1e-5, 1e-3, 0.0])
@pytest.mark.parametrize("turn", [0.0, 0.7, 2.5])
def test_edges_that_share_an_end_do_not_cross(bend, turn):
    """Two blocks side by side under a joint that bends where they meet, as rounding leaves it."""
    joint = [[2.0, 1.0], [1.0, 1.0], [0.0, 1.0 - bend]]
    foot = [1.0, 0.0]
    blocks = [np.array([[0.0, 0.0], foot, *joint[1:]]), np.array([foot, [2.0, 0.0], *joint[:2]])]
    cosine, sine = np.cos(turn), np.sin(turn)
    rotation = np.array([[cosine, sine], [-sine, cosine]])
    blocks = [one @ rotation for one in blocks]
    assert not len(crossings_of(blocks, floor=1e-12)[0])
    # a little out of place, by less than is looked at, they overlap by no more than that
    aside = [blocks[0] + 1e-9 * rotation[0] - 1e-9 * rotation[1], blocks[1]]
    assert not len(crossings_of(aside, floor=1e-7)[0])
    # pushed into each other they do
    assert len(crossings_of([blocks[0] + 1e-4 * rotation[0], blocks[1]], floor=1e-12)[0])


SLAB = np.array([[-1.0, -1.5], [4.0, -1.5], [4.0, 0.0], [1.0, 0.0], [-1.0, -0.8]])
WEDGE = np.array([[0.7, -0.1], [2.7, 0.2], [2.7, 0.4]])
"""Has cut through the obtuse corner of the slab and is out again on the other side."""


def test_wedge_through_a_corner_has_no_vertex_inside():
    one, other = shapely.Polygon(SLAB), shapely.Polygon(WEDGE)
    assert one.intersection(other).area > 1e-3
    assert not any(one.contains(shapely.Point(p)) for p in WEDGE)
    assert not any(other.contains(shapely.Point(p)) for p in SLAB)
    model = system([SLAB, WEDGE + 5.0], fixed=[0])
    state = at_start(model, np.concatenate([SLAB, WEDGE]) - model.origin)
    assert len(unseen_overlaps(model, state, 0.005)) == 1


def unseen_while_it_comes():
    """Return the overlaps that contacts do not know of while the wedge comes to that corner."""
    velocity = {1: (-2.0, -0.7, 0.0)}
    above = WEDGE + np.array([0.6, 0.25])
    model = system([SLAB, above], fixed=[0], velocity=velocity, friction_angle=20.0)
    how = by_convex(1e5, max_displacement=0.02)
    found = []
    for result in march(model, how, 5e-3, 0.6):
        found += unseen_overlaps(model, result.state, how.critdis)
    return found


def test_wedge_through_a_corner_is_a_contact(monkeypatch):
    assert not unseen_while_it_comes()
    monkeypatch.setattr(detection, "with_crossings", lambda chosen, *rest: chosen)
    assert unseen_while_it_comes()


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("bonded", [True, False])
def test_joints_of_a_wall_ask_for_nothing(monkeypatch, angle, bonded):
    """Where corners meet across joints no contact is added, however the wall stands."""
    added = []

    def spied(chosen, *rest):
        found = with_crossings(chosen, *rest)
        added.append(len(found[0]) - len(chosen[0]))
        return found

    monkeypatch.setattr(detection, "with_crossings", spied)
    base = wall(4, 4, bonded=bonded)
    outlines = [turned(one, angle) for one in np.split(base.vertices, base.block_start[1:-1])]
    pull = turned(np.array([[0.0, -9.8]]), angle)[0]
    model = system(outlines, fixed=[0], friction_angle=30.0, gravity=pull)
    last = march(model, by_convex(5e9), 1e-3, 0.02)[-1]
    assert len(added) >= 20
    assert not any(added)
    assert not unseen_overlaps(model, last.state, 0.005)


def sunk(depth):
    model = system([box(-1, -1, 3.0), box(0, 0)], fixed=[0])
    down = np.where(model.vertex_block == 1, depth, 0.0)
    return model, at_start(model, model.vertices - np.stack([0.0 * down, down], axis=1))


def test_overlap_that_no_contact_knows_is_found():
    model, state = sunk(0.1)
    (found,) = unseen_overlaps(model, state, 0.005)
    assert found.blocks == ("1", "2")
    assert found.depth == pytest.approx(0.1, rel=0.01)
    assert found.area == pytest.approx(0.1)
    assert found.known == 0.0


@pytest.mark.parametrize(("known", "seen"), [(0.1, True), (0.04, False)])
def test_overlap_that_contacts_know_is_not_told(known, seen):
    model, state = sunk(0.1)
    ends, gap = ([4, 5], [0, 0], [2, 2]), [-known, -known]
    memory = memory_of(*ends, gap, normal_force=np.ones(2), mode=[1, 1])
    found = unseen_overlaps(model, replace(state, memory=memory), 0.005)
    assert (not found) == seen
    # a spring that rests where it is knows nothing
    resting = replace(memory, multiplier=np.full(2, -1e8 * known))
    assert unseen_overlaps(model, replace(state, memory=resting), 0.005)


def test_block_inside_another_is_found():
    """Nothing crosses there."""
    model = system([box(0, 0, 3.0, 3.0), box(3.0, 0.0)], gravity=(0.0, 0.0))
    vertices = model.vertices.copy()
    vertices[4:] -= [2.0, -1.0]
    (found,) = unseen_overlaps(model, at_start(model, vertices), 0.005)
    assert found.area == pytest.approx(1.0)


@pytest.mark.slow
def test_soft_wheel_gains_nothing_from_vertex_to_vertex():
    """Contacts come up and go deep inside; what is new there must not begin stretched."""
    floor = box(-2, -1, 8.0)
    wheel = regular(7, 0.5, 0.2) + np.array([0.0, 0.6])
    model = system([floor, wheel], fixed=[0], velocity={1: (2.0, -1.0, -6.0)}, friction_angle=40.0)
    done = finish(model, by_convex(2e5, max_displacement=0.05), 2e-3, 0.8)
    assert done.created < 1e-6


def pressed_to_a_corner(give):
    """Return four boxes that are pressed towards the corner that they share, and their state."""
    model = system([box(x, y) for y in (0, 1) for x in (0, 1)])
    corner = np.array([1.0, 1.0]) - model.origin
    centre = np.array([one.mean(axis=0) for one in np.split(model.vertices, 4)])
    inwards = 0.5 * give * np.sign(corner - centre)
    return model, at_start(model, model.vertices + np.repeat(inwards, 4, axis=0))


def across_the_corner(model, state):
    """Return the gaps of the contacts of the first box with the one across the corner, m."""
    found = contacts_of(model, state)
    return found.gap[
        (found.vertex_block * found.edge_block == 0) & (found.vertex_block + found.edge_block == 3)
    ]


@pytest.mark.parametrize("share", [1.5, 0.5, 0.01])
def test_a_contact_across_a_corner_goes_on_until_it_has_opened(share):
    """A spring that bears does not end at the depth below which new crossings are left alone.

    It did, and came back full as soon as the blocks had closed again: they swung for ever.
    """
    give = share * SHALLOW_CROSSING * 0.005
    model, state = pressed_to_a_corner(give)
    assert not len(across_the_corner(model, state))
    # the upper right corner of the first box and the lower side of the fourth
    known = memory_of([2], [3], [12], [-give])
    gap = across_the_corner(model, replace(state, memory=known))
    assert gap == pytest.approx([-give], rel=1e-6)
    _, apart = pressed_to_a_corner(-1e-9)
    assert not len(across_the_corner(model, replace(apart, memory=known)))


@pytest.mark.parametrize(
    ("give", "share", "told"),
    [(0.012, 1.0, False), (0.012, 0.6, False), (0.012, 0.4, True), (1e-3, 0.4, False)],
)
def test_blocks_across_a_corner_may_give_way_to_their_neighbours(give, share, told):
    """Four boxes are pressed towards the corner that they share; contacts know a share of it.

    What a rounding of 1 % would cut off the corners is left out whatever they know.
    """
    model, state = pressed_to_a_corner(give)
    found = contacts_of(model, state)
    beside = found.vertex_block + found.edge_block != 3  # 0 and 3, 1 and 2 are across
    rows = np.flatnonzero(beside & (found.gap < 0.0))
    rows = rows[np.lexsort((found.edge[rows], found.edge_block[rows], found.vertex[rows]))]
    keys = found.vertex[rows], found.edge_block[rows], found.edge[rows]
    memory = memory_of(*keys, share * found.gap[rows])
    overlaps = unseen_overlaps(model, replace(state, memory=memory), 0.005)
    across = {("1", "4"), ("2", "3")}
    assert across & {one.blocks for one in overlaps} == (across if told else set())


@pytest.mark.parametrize("size", [1.0, 100.0])
@pytest.mark.parametrize(("corner", "seen"), [(3e-4, False), (3e-3, True)])
def test_a_corner_of_less_than_a_millionth_of_a_block_is_no_reason_for_doubt(size, corner, seen):
    """1e-7 m2 of blocks of 1 m2: deeper than a fiftieth of critdis, and nothing to worry about."""
    model = system([box(-size, 0, size, size), box(0, size, size, size)], fixed=[0])
    vertices = model.vertices.copy()
    vertices[4:] += size * np.array([-corner, -corner])
    found = unseen_overlaps(model, at_start(model, vertices), 0.005 * size)
    assert len(found) == seen
