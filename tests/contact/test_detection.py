"""Contact detection against the definition in plain Python, against overlap, and by hand."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from scenes import oracle
from scenes.encounters import FAMILIES, encounters, normal_of
from scenes.systems import REACH, Touch, box, candidates_of, flat, star, touches_of, turned

CASES = 300


@cache
def drawn(family):
    """Return the pairs of outlines of a family."""
    return list(encounters(family, CASES))


def keyed(outlines, found):
    """Return {(block, vertex, other block, edge): gap} of candidates."""
    flats = flat(outlines)
    first = flats.start[flats.owner]
    return {
        (int(flats.owner[p]), int(p - first[p]), int(flats.owner[e]), int(e - first[e])): gap
        for p, e, gap in zip(found.vertex, found.edge, found.gap, strict=True)
    }


def beyond_end(outlines, touch: Touch):
    """Return how far the foot of a contact lies beyond the ends of its edge, m (on it: < 0)."""
    (i, k), (j, e) = touch.vertex, touch.edge
    start, end = outlines[j][e], outlines[j][(e + 1) % len(outlines[j])]
    size = np.hypot(*(end - start))
    along = np.dot(outlines[i][k] - start, end - start) / size
    return max(-along, along - size)


def penetration(outlines):
    """Return the greatest depth of a vertex of one outline in the other, m."""
    deepest = 0.0
    for one, other in (outlines, outlines[::-1]):
        solid = shapely.Polygon(other)
        for at in shapely.points(one):
            if solid.contains(at):
                deepest = max(deepest, solid.exterior.distance(at))
    return deepest


def parts_within(outlines, distance):
    """Return whether moving one outline along some edge's normal by a distance parts them."""
    one, other = outlines
    resting = shapely.Polygon(one)
    ways = [normal_of(one, k) for k in range(len(one))]
    ways += [-normal_of(other, k) for k in range(len(other))]
    return any(
        resting.intersection(shapely.Polygon(other + distance * way)).area < 1e-12 for way in ways
    )


# --- candidates ----------------------------------------------------------------------------


@pytest.mark.parametrize("tip", [0.0, 0.003])
@pytest.mark.parametrize("family", FAMILIES)
def test_candidates_are_those_of_the_definition(family, tip):
    total, reach = 0, replace(REACH, tip=tip)
    for outlines in drawn(family):
        found = keyed(outlines, candidates_of(outlines, reach))
        wanted = oracle.every_candidate(outlines, reach)
        assert set(found) == set(wanted)
        for key, gap in found.items():
            assert gap == pytest.approx(wanted[key].gap, abs=1e-12)
        total += len(wanted)
    assert total > CASES  # the cases are not empty


@pytest.mark.parametrize("seed", range(4))
def test_candidates_of_blocks_with_many_edges(seed):
    """Only edges near a vertex are tried there, which must not make a difference."""
    rng = np.random.default_rng(seed)
    one, other = star(rng, 150), star(rng, 120, 0.7)
    outlines = [one, other + np.array([1.0, rng.uniform(-0.5, 0.5)]), box(-0.1, 0.55, 0.2, 1.0)]
    found = keyed(outlines, candidates_of(outlines))
    wanted = oracle.every_candidate(outlines, REACH)
    assert len(wanted) > 2
    assert set(found) == set(wanted)


@pytest.mark.parametrize("family", FAMILIES)
def test_exactly_one_edge_is_kept_among_those_of_a_convex_corner(family):
    """The paper's bisector keeps the edge of the shortest exit: the largest signed gap."""
    choices = 0
    for outlines in drawn(family):
        candidates = oracle.every_candidate(outlines, REACH)
        kept = {(*touch.vertex, *touch.edge) for touch in touches_of(outlines)}
        for i, k, j, e in candidates:
            after = (e + 1) % len(outlines[j])
            angle = oracle.interior_angle(outlines[j], after)
            neighbour = (i, k, j, after)
            if angle > 176.0 or neighbour not in candidates:
                continue
            pair = sorted([(i, k, j, e), neighbour], key=lambda key: candidates[key].gap)
            assert not kept.issuperset(pair)
            assert pair[0] not in kept
            choices += 1
    assert choices >= 10


# --- soundness and completeness ------------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES)
def test_no_vertex_is_held_by_air(family):
    """A vertex that counts as penetrating lies in the block, or at most critdis beside a corner."""
    for outlines in drawn(family):
        apart = shapely.Polygon(outlines[0]).distance(shapely.Polygon(outlines[1])) > 1e-9
        for touch in touches_of(outlines):
            if touch.gap > -1e-9:
                continue
            at = shapely.Point(outlines[touch.vertex[0]][touch.vertex[1]])
            outside = shapely.Polygon(outlines[touch.edge[0]]).distance(at)
            beyond = beyond_end(outlines, touch)
            assert outside <= REACH.critdis or 0.0 < beyond <= REACH.critdis
            if apart:
                assert 0.0 < beyond <= REACH.critdis
                # the faces are within 3 degrees of each other, so that it cannot be deep
                assert touch.gap > -REACH.critdis * np.sin(np.radians(2.0 * oracle.PARALLEL))


@pytest.mark.parametrize("family", FAMILIES)
def test_every_penetration_has_a_contact_that_pushes_the_blocks_apart(family):
    checked = 0
    for outlines in drawn(family):
        if penetration(outlines) <= 1e-6 or not parts_within(outlines, REACH.depth):
            continue
        solids = [shapely.Polygon(outline) for outline in outlines]
        overlap = solids[0].intersection(solids[1]).area
        closed = [touch for touch in touches_of(outlines) if touch.gap < 0.0]
        assert closed
        smaller = []
        for touch in closed:
            (i, _), (j, e) = touch.vertex, touch.edge
            moved = outlines[i] - touch.gap * normal_of(outlines[j], e)
            smaller.append(shapely.Polygon(moved).intersection(solids[j]).area < overlap)
        assert any(smaller)
        checked += 1
    assert checked > CASES / 4


# --- what the motion of the step brings ----------------------------------------------------


def crossed_edges(outlines, way):
    """Yield (vertex, edge) where a vertex of the second outline, moved, enters the first one."""
    resting, moving = outlines
    for k, point in enumerate(moving):
        for e, start in enumerate(resting):
            end = resting[(e + 1) % len(resting)]
            matrix = np.array([way, start - end]).T
            if abs(np.linalg.det(matrix)) < 1e-9:
                continue
            share, along = np.linalg.solve(matrix, start - point)
            entering = normal_of(resting, e) @ way < 0.0
            if 0.0 < share < 1.0 and 0.0 < along < 1.0 and entering:
                yield k, e


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.one_in(3)
def test_vertex_that_would_cross_an_edge_within_the_step_is_a_candidate(family):
    """Wherever its foot lies now: corners may fly at each other."""
    reach = replace(REACH, front=0.025)
    rng, beyond, crossings = np.random.default_rng(5), 0, 0
    for outlines in drawn(family):
        if shapely.Polygon(outlines[0]).intersects(shapely.Polygon(outlines[1])):
            continue
        towards = outlines[0].mean(axis=0) - outlines[1].mean(axis=0)
        way = turned(0.025 * towards / np.hypot(*towards), rng.uniform(-0.8, 0.8))
        # half of the motion is that of the first block
        parts = [np.broadcast_to(-0.5 * way, outlines[0].shape)]
        parts.append(np.broadcast_to(0.5 * way, outlines[1].shape))
        found = keyed(outlines, candidates_of(outlines, reach, shift=np.concatenate(parts)))
        at_rest = keyed(outlines, candidates_of(outlines, reach))
        assert set(at_rest) <= set(found)
        wanted = set()
        for k, e in crossed_edges(outlines, way):
            along = oracle.direction(outlines[0][e], outlines[0][(e + 1) % len(outlines[0])])
            if oracle.lies_in_front(outlines[1], k, along):
                wanted.add((1, k, 0, e))
        assert wanted <= set(found)
        assert {key for key in set(found) - set(at_rest) if key[0] == 1} <= wanted
        beyond += len(wanted - set(at_rest))
        crossings += len(wanted)
    print(f"{family}: {crossings} crossings, {beyond} of them from beyond the end of the edge")
    assert beyond > 0


# --- by hand -------------------------------------------------------------------------------


def closed_between(outlines, block, other):
    """Return {(vertex, edge): gap} of the penetrating contacts of a block's vertices."""
    return {
        (touch.vertex[1], touch.edge[1]): touch.gap
        for touch in touches_of(outlines)
        if touch.vertex[0] == block and touch.edge[0] == other and touch.gap < -1e-12
    }


NOTCH = [[0, 0], [4, 0], [4, 2], [3, 2], [2, 1], [1, 2], [0, 2]]
STEP = [[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [0, 1]]
STAIR = [[0, 0], [3, 0], [3, 1.002], [1.5, 1.002], [1.5, 1.0], [0, 1.0]]
FORK = [[0, 0], [1, 0], [1, 0.008], [0.2, 0.008], [0.2, 0.016], [1, 0.016], [1, 0.024], [0, 0.024]]
HEXAGON = [[-1, -1], [1, -1], [1, 0], [0.5, 0.866], [-0.5, 0.866], [-1, 0]]
DIAGONAL = -1e-4 * np.sqrt(0.5)
HAND = {
    "a tip at the bottom of a notch rests on both walls: both feet lie beyond the edges' ends": (
        (NOTCH, [[2, 1 - 1e-4], [2.5, 2.5], [1.5, 2.5]]),
        {(0, 3): DIAGONAL, (0, 4): DIAGONAL},
    ),
    "so does a corner in a right-angled notch": (
        (STEP, box(1.0 + 1e-6, 1.0 - 2e-6)),
        {(0, 4): -2e-6, (1, 4): -2e-6, (1, 3): -1e-6, (2, 3): -1e-6},
    ),
    "a vertex on a tread is not held by the tread below: that needs the riser too": (
        (STAIR, [[1.51, 1.002 - 3e-3], [1.6, 1.5], [1.4, 1.5]]),
        {(0, 2): -3e-3},
    ),
    "a flat vertex in the top of a brick does not rest on the top of the next one": (
        (box(1.0, 0.0), [[0, -1e-4], [1, -1e-4], [1, 0.9999], [0.997, 0.9999], [0, 0.9999]]),
        {},
    ),
    "a flat vertex rests on a face": (
        (box(0.2, 0.0, 0.6), [[0, 0.9999], [0.5, 0.9999], [1, 0.9999], [1, 2], [0, 2]]),
        {(1, 2): -1e-4},
    ),
    "a prong of a fork does not reach through its slot": (
        (FORK, [[0.5, 0.0085], [0.9, 0.0095], [0.9, 0.012]]),
        {},
    ),
    "but is touched from within the slot": (
        (FORK, [[0.5, 0.0078], [0.9, 0.0088], [0.9, 0.0113]]),
        {(0, 2): -2e-4},
    ),
    "a vertex below a wedge is not lifted by its top": (
        ([[0.0, 0.0], [1.0, -0.577], [1.0, 0.0]], [[0.02, -0.019], [-0.5, 0.01], [-0.52, -0.01]]),
        {},
    ),
    "inside an obtuse corner the face counts that the vertex came through": (
        (HEXAGON, [[0.503, 0.851], [0.103, 1.187], [0.003, 0.985]]),
        {(0, 3): -0.015},
    ),
    "a plate thinner than the reach holds a vertex on the side that it came from": (
        (box(0.0, 0.0, 2.0, 0.02), [[1.0, 0.016], [1.3, 1.0], [0.7, 1.0]]),
        {(0, 2): -0.004},
    ),
}


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("name", HAND)
def test_contacts_by_hand(name, angle):
    outlines, wanted = HAND[name]
    closed = closed_between([turned(np.array(one, float), angle) for one in outlines], 1, 0)
    assert closed == pytest.approx(wanted, rel=1e-7)


def test_truncated_wedge_holds_a_needle_on_one_side():
    """Three faces are behind the vertex, two of them no neighbours: one is the shortest exit."""
    half = 0.002 + np.tan(np.radians(10.0))
    wedge = np.array([[-half, -1.0], [half, -1.0], [0.002, 0.0], [-0.002, 0.0]])
    needle = np.array([[0.0, -0.01], [0.02, 1.0], [-0.02, 1.0]])
    for x, side in ((5e-4, 1), (-5e-4, 3)):
        closed = closed_between([wedge, needle + np.array([x, 0.0])], 1, 0)
        assert list(closed) == [(0, side)]


@pytest.mark.parametrize("angle", np.linspace(0.0, 2.0 * np.pi, 7))
def test_contacts_near_a_corner_do_not_depend_on_the_direction_of_the_axes(angle):
    """A vertex in front of an edge and beyond its end is outside the edge's box, turned or not."""
    step = 0.9 * REACH.critdis
    outlines = [box(0.0, 0.0), box(-1.0 - step, 1.0 + step)]
    facing = [box(0.0, 0.0), box(-step, 1.0 + step)]
    assert touches_of([turned(one, angle) for one in outlines]) == []
    found = touches_of([turned(one, angle) for one in facing])
    facing_corners = {((1, 0), (0, 2)), ((0, 2), (1, 0))}
    assert {(one.vertex, one.edge) for one in found} >= facing_corners
    assert len(found) == 4
