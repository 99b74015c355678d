"""Vertices against edges: which edges a vertex could be in contact with.

The signed gap of a vertex to an edge's line is (P - A) . n with n the outward normal; with
counter-clockwise polygons and edge direction t = (tx, ty), n = (ty, -tx).

In all kernels ``outlines`` are ``Polygons``, and ``own`` the two edges of a vertex, pointing away
from it, (ax, ay, bx, by).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.block.edge_lists import EDGES_TRIED_MAX, edges_around, edges_near
from clast.block.polygon import (
    ROUND_OFF,
    SMALL_ANGLE,
    Polygons,
    gap_to,
    next_edge,
    runs_along,
    turn_at,
)
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, EACH, shared
from clast.contact.flush_faces import (
    BearingContacts,
    is_covered,
    is_in_joint,
    is_no_corner,
    stands_beyond,
)
from clast.model.model import Floats, Ints

PART = CONTACTS.part
"""Pairs of blocks that a thread takes at a time."""


class SearchLengths(NamedTuple):
    """Lengths of ``candidates.SearchDistance`` with what the blocks of a pair move, m."""

    front: float
    depth: float
    critdis: float
    tip: float


class EntranceSearch(NamedTuple):
    """Arguments of the entrance test of a vertex and an edge, beside their geometry."""

    shift: Floats
    """How far the velocities would carry each vertex in the step, m, shape (nv, 2)."""
    distances: SearchLengths
    """How far to look."""
    bearing: BearingContacts
    """Contacts on which blocks stand, and where outlines go on over joints."""


class NearPairs(NamedTuple):
    """Pairs of blocks that are near each other."""

    pairs: Ints
    """The pairs, shape (q, 2)."""
    box: Floats
    """Bounding box of each block, m, shape (n, 4)."""
    depth: Floats
    """Penetration of each pair at the end of the last step, m, shape (q,)."""
    travel: Floats
    """How far a vertex of each block may move, m, shape (n,)."""


class CandidateArrays(NamedTuple):
    """Room for fields of ``candidates.Candidates``."""

    group_start: Ints
    vertex: Ints
    edge: Ints
    pair: Ints
    gap: Floats
    along: Floats


@kernel()
def _has_face_on(e, at_end, own, direction):
    """Return True if an edge of a vertex at one end of edge e runs along e from there.

    Two blocks have a face in common then, whatever third block meets them at its end.
    """
    ax, ay, bx, by = own
    back = -1.0 if at_end else 1.0
    return runs_along(ax, ay, e, back, direction) or runs_along(bx, by, e, back, direction)


@kernel()
def _points_behind(own, nx, ny):
    """Return True if one of a vertex's own edges points behind a line by more than 3 degrees."""
    ax, ay, bx, by = own
    return ax * nx + ay * ny < -SMALL_ANGLE or bx * nx + by * ny < -SMALL_ANGLE


@kernel()
def _is_behind_next(p, gap, e, at_end, outlines):
    """Return True if vertex p lies behind the next edge at one end of e too.

    It is inside the corner then, so that e counts although the foot lies beyond its end: at an
    obtuse corner, and at a re-entrant one, where both feet can lie beyond their ends.
    """
    if gap >= 0.0 and turn_at(e, at_end, outlines) >= 0.0:
        return False
    return gap_to(p, next_edge(e, at_end, outlines), outlines) < 0.0


@kernel()
def _is_hidden(p, e, along, critdis, outlines):
    """Return True if another edge of the block lies between vertex p and its foot on edge e.

    Such a point is in front of that edge, or nearer to it: between the prongs of a fork, beside
    the tip of a wedge.  Near a corner of e the choice is left to the corner rule.
    """
    vertices, direction, length = outlines.vertices, outlines.direction, outlines.length
    block_start, j = outlines.block_start, outlines.vertex_block[e]
    px, py = vertices[p, 0], vertices[p, 1]
    share = min(max(along, 0.0), length[e])
    fx = vertices[e, 0] + share * direction[e, 0] - px
    fy = vertices[e, 1] + share * direction[e, 1] - py
    for k in range(block_start[j], block_start[j + 1]):
        if k == e:
            continue
        after = outlines.after[k]
        ax, ay = vertices[k, 0] - px, vertices[k, 1] - py
        bx, by = vertices[after, 0] - px, vertices[after, 1] - py
        if (fx * ay - fy * ax > 0.0) == (fx * by - fy * bx > 0.0):
            continue
        here = ax * by - ay * bx
        there = (ax - fx) * (by - fy) - (ay - fy) * (bx - fx)
        if (here > 0.0) == (there > 0.0):
            continue
        if k != outlines.after[e] and after != e:
            return True
        in_front = ay * direction[k, 0] - ax * direction[k, 1]
        if in_front > critdis and 0.0 < along < length[e]:
            return True
    return False


@kernel()
def _motion_past(p, e, e_end, share, shift):
    """Return the motion in the step of vertex p past the point at ``share`` of edge e, m, x and y.

    ``share`` is 0 at the first vertex of the edge and 1 at ``e_end``.
    """
    mx = shift[p, 0] - (1.0 - share) * shift[e, 0] - share * shift[e_end, 0]
    my = shift[p, 1] - (1.0 - share) * shift[e, 1] - share * shift[e_end, 1]
    return mx, my


@kernel()
def _passes_by(p, e, gap, at_end, own, shift, outlines):
    """Return True if vertex p stands at the very end of edge e, flush with the next edge there.

    Its block lies beyond that end then, as two blocks do that meet corner to corner across a joint:
    moving towards e it would slide along the next edge and not come to rest on this one, unless the
    step's motion takes it in.
    """
    direction, length = outlines.direction, outlines.length
    if gap < -ROUND_OFF * length[e] or turn_at(e, at_end, outlines) <= SMALL_ANGLE:
        return False
    f = next_edge(e, at_end, outlines)
    nx, ny = direction[f, 1], -direction[f, 0]
    flush = ROUND_OFF * length[f]
    if abs(gap_to(p, f, outlines)) > flush or _points_behind(own, nx, ny):
        return False
    mx, my = _motion_past(p, f, outlines.after[f], 0.0 if at_end else 1.0, shift)
    return -(mx * nx + my * ny) <= flush


@kernel()
def _comes_in(p, e, gap, along, own, outlines, looks):
    """Return True if vertex p, whose foot lies beyond an end of e, comes upon e in the step."""
    length, tx, ty = outlines.length[e], outlines.direction[e, 0], outlines.direction[e, 1]
    mx, my = _motion_past(p, e, outlines.after[e], along / length, looks.shift)
    closing = -(mx * ty - my * tx)
    if closing <= gap:
        return False
    # where the step's motion takes p across the line of e
    meets, at_end = along + (gap / closing) * (mx * tx + my * ty), along > 0.5 * length
    if 0.0 <= meets <= length:
        return True
    # one that is pressed in a little meets the line before the seam where it bends
    behind, over = next_edge(e, at_end, outlines), length if at_end else 0.0
    return abs(meets - over) <= looks.distances.depth and is_covered(
        p, behind, not at_end, own, outlines, looks.bearing
    )


@kernel(inline="always")
def _is_candidate(p, e, gap, along, own, outlines, looks):
    """Return True if vertex p could be in contact with edge e: the entrance test.

    ``gap`` and ``along`` are its distance from the line of e and that of its foot from the start of
    e, m.  critdis beyond an end counts where the two have a face in common (the corners coincide,
    as in walls and arches), else ``tip``: a tip that passes beside a corner is not held by air.
    """
    shift, distances, bearing = looks.shift, looks.distances, looks.bearing
    front, depth = distances.front, distances.depth
    critdis, tip = distances.critdis, distances.tip
    direction, length = outlines.direction, outlines.length
    beyond = max(-along, along - length[e])
    if beyond > max(critdis, depth, front):
        return False
    nx, ny = direction[e, 1], -direction[e, 0]
    if _points_behind(own, nx, ny):
        return False
    ax, ay, bx, by = own
    # into its own block: the sum of the two edges' inward normals
    if (ay - by) * nx + (bx - ax) * ny <= 0.0:  # a flat vertex on the wrong side
        return False
    at_end = along > 0.5 * length[e]
    along_face = _has_face_on(e, at_end, own, direction)
    allowance = critdis if along_face else tip
    at_very_end = abs(beyond) <= ROUND_OFF * length[e] and allowance == tip
    if at_very_end and _passes_by(p, e, gap, at_end, own, shift, outlines):
        return False
    if beyond > ROUND_OFF * length[e]:
        if _is_behind_next(p, gap, e, at_end, outlines):
            allowance = depth
        if beyond > allowance and (
            gap < 0.0 or not _comes_in(p, e, gap, along, own, outlines, looks)
        ):
            return False
    # at a corner, within rounding, it is neither behind the edge nor beyond its end
    tie = ROUND_OFF * length[e]
    if gap < -tie and _is_hidden(p, e, along, critdis, outlines):
        return False
    at_corner = -beyond <= max(critdis, depth, front)
    has_face = at_corner and along_face
    # a force at the end of a face must not come and go with the surfaces around; a face shorter
    # than critdis may be a step that is pressed in as deep as it is high, which what slides passes
    if has_face and length[e] > critdis:
        return True
    if at_corner and is_covered(p, e, at_end, own, outlines, bearing):
        return False
    if has_face:
        return True
    i, j = outlines.vertex_block[p], outlines.vertex_block[e]
    if is_no_corner(p, j, nx, ny, own, outlines, bearing):
        return False
    if not at_corner:
        return True
    return not (
        is_in_joint(e, at_end, i, outlines, bearing)
        or (
            -critdis <= beyond <= tie
            and stands_beyond(p, e, at_end, max(0.0, -beyond), own, outlines, bearing)
        )
    )


@kernel(inline="always")
def _of_vertex(p, edges, outlines, looks, room, count):
    """Append the candidate edges among ``edges`` (first, last + 1) for vertex p; return the count.

    Those that exceed the ``room`` (edge, gap, along) are counted only.
    """
    vertices, direction = outlines.vertices, outlines.direction
    out_edge, out_gap, out_along = room
    front, depth = looks.distances.front, looks.distances.depth
    before = outlines.before[p]
    own = -direction[before, 0], -direction[before, 1], direction[p, 0], direction[p, 1]
    if own[2] * own[1] - own[3] * own[0] < -SMALL_ANGLE:  # re-entrant: it cannot enter an edge
        return count
    for e in range(edges[0], edges[1]):
        tx, ty = direction[e, 0], direction[e, 1]
        rx, ry = vertices[p, 0] - vertices[e, 0], vertices[p, 1] - vertices[e, 1]
        gap = rx * ty - ry * tx
        if gap > front or gap < -depth:
            continue
        along = rx * tx + ry * ty
        if _is_candidate(p, e, gap, along, own, outlines, looks):
            if count < len(out_edge):
                out_edge[count], out_gap[count], out_along[count] = e, gap, along
            count += 1
    return count


@kernel()
def _is_around(p, vertices, box, j, distance):
    """Return True if vertex p is within ``distance``, m, of the box of block j."""
    return (
        box[j, 0] - distance <= vertices[p, 0] <= box[j, 2] + distance
        and box[j, 1] - distance <= vertices[p, 1] <= box[j, 3] + distance
    )


@kernel(inline="always")
def _of_pairs(low, high, outlines, near, looks, room):
    """Write the candidates of pairs ``low`` to ``high`` - 1 into ``room``; return their number.

    And the number of their groups; valid where as many fit.
    """
    vertices, block_start, after = outlines.vertices, outlines.block_start, outlines.after
    pairs, box = near.pairs, near.box
    pair_depth, travel = near.depth, near.travel
    shift, distances, bearing = looks.shift, looks.distances, looks.bearing
    front, behind = distances.front, distances.depth
    critdis, tip = distances.critdis, distances.tip
    group_start, vertex, edge = room.group_start, room.vertex, room.edge
    pair, gap, along = room.pair, room.gap, room.along
    group_start[0] = 0
    groups, count = 0, 0
    around_it = np.empty(0), np.empty(0, np.int64), 0.0
    close = np.empty(0, np.int64)
    for q in range(low, high):
        moves = travel[pairs[q, 0]] + travel[pairs[q, 1]]
        depth, before = behind + pair_depth[q] + moves, front + moves
        around = before + max(critdis, tip)  # in front of an edge and beyond its end
        # an edge behind or beyond whose end a vertex lies further counts for nothing
        far = 1.5 * max(before, depth, critdis, tip)
        of_pair = EntranceSearch(shift, SearchLengths(before, depth, critdis, tip), bearing)
        for side in range(2):
            i, j = pairs[q, side], pairs[q, 1 - side]
            first, last = block_start[j], block_start[j + 1]
            few = last - first <= EDGES_TRIED_MAX
            if not few:
                window = box[i, 0], box[i, 1], box[i, 2], box[i, 3]
                around_it = edges_around(window, far, vertices, after, first, last)
                close = np.empty(len(around_it[1]), np.int64)
            for p in range(block_start[i], block_start[i + 1]):
                if not _is_around(p, vertices, box, j, around):
                    continue
                start, ranges = count, 1
                if not few:
                    point = vertices[p, 0], vertices[p, 1]
                    ranges = edges_near(point, far, around_it, vertices, after, close)
                for k in range(ranges):
                    edges = (first, last) if few else (close[k], close[k] + 1)
                    count = _of_vertex(p, edges, outlines, of_pair, (edge, gap, along), count)
                if count > start and count <= len(edge):
                    vertex[start:count] = p
                    pair[start:count] = q
                    groups += 1
                    group_start[groups] = count
    return count, groups


@shared(EACH)
def candidates_of_parts(first, last, most, outlines, near, looks, room, counts):
    """Write the candidates of parts ``first`` to ``last`` - 1 of the pairs into their own rooms.

    ``near`` are ``NearPairs``; ``room`` is that of ``CandidateArrays``, for ``most`` candidates a
    part.  ``counts`` (parts, 2) are the numbers of candidates and of their groups, which are valid
    where as many fit.  ``looks`` are those of ``EntranceSearch`` one by one, the distances as an
    array (4,): threads take no tuples within tuples.
    """
    polygons, near_pairs, whole = Polygons(*outlines), NearPairs(*near), CandidateArrays(*room)
    front, depth, critdis, tip = looks[1]
    bearing = looks[2:]
    search = EntranceSearch(
        looks[0], SearchLengths(front, depth, critdis, tip), BearingContacts(*bearing)
    )
    for part in range(first, last):
        low, high = part * PART, min((part + 1) * PART, len(near[0]))
        begin = part * (most + 1)
        end = begin + most
        own = CandidateArrays(
            whole.group_start[begin : end + 1],
            whole.vertex[begin:end],
            whole.edge[begin:end],
            whole.pair[begin:end],
            whole.gap[begin:end],
            whole.along[begin:end],
        )
        counts[part, 0], counts[part, 1] = _of_pairs(low, high, polygons, near_pairs, search, own)


@shared(EACH)
def join_parts(first, last, most, counts, room, joined):
    """Copy the results of parts ``first`` to ``last`` - 1 behind those of the parts before."""
    for part in range(first, last):
        at, group = counts[:part, 0].sum(), counts[:part, 1].sum()
        begin = part * (most + 1)
        number, groups = counts[part]
        for k in range(groups):
            joined[0][group + k + 1] = at + room[0][begin + k + 1]
        for k in range(number):
            joined[1][at + k] = room[1][begin + k]
            joined[2][at + k] = room[2][begin + k]
            joined[3][at + k] = room[3][begin + k]
            joined[4][at + k] = room[4][begin + k]
            joined[5][at + k] = room[5][begin + k]
