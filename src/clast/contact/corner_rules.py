"""Corner rules: which of the candidate edges of a vertex become contacts.

Where two convex corners P and Q meet vertex to vertex there are two *entrance lines* (Shi 1988;
the boundary of the entrance block at its corner, Shi 2015): on either side of the corners the edge
of one of the blocks, to be passed by the vertex of the other.  The corners are inside each other
where both lines are passed, and the line with the shorter exit makes the contact.  At a
re-entrant corner the vertex is inside where either edge is passed, and each is a contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from clast.block.polygon import (
    ROUND_OFF,
    SMALL_ANGLE,
    Polygons,
    cosine,
    end_of,
    gap_to,
    next_edge,
    sine,
    turn_at,
)
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.contact.candidates import Candidates
from clast.model.model import Bools, Floats, Ints


class CornerRule(Protocol):
    """Chooses entrance edges among the candidate edges of a vertex at a corner of a block."""

    def choose(self, candidates: Candidates) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        ...


@dataclass(frozen=True)
class Bisector:
    """The angle bisector of a convex corner parts its two edges (Yu & Yin 2015).

    At a re-entrant corner, and between the walls of a slot, both edges are kept.  Where two convex
    corners are inside each other one of the two vertices makes the contact, by the same principle:
    the shortest exit.  Where corners coincide at the end of a joint both vertices make a contact.
    """

    def choose(self, candidates: Candidates) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        return _shortest_exit(candidates)


@dataclass(frozen=True)
class EntranceLines:
    """Shi's two entrance lines, and one contact for each pair of corners (Shi 1988).

    Two corners are inside each other where both entrance lines are passed; the shorter distance
    holds.  An edge is an entrance line exactly where the entrance test makes it a candidate, and
    the bisector picks the line with the larger signed gap, so that the two rules agree on corners
    that meet at an angle.  They differ where faces lie on each other within 3 degrees and two
    corners coincide, as everywhere in a wall of aligned joints: the bisector keeps the vertices of
    both blocks, Shi's rule reduces the pair to one vertex and the other's edge, which then carries
    twice as much.  The vertex in contact before stays; else the one whose foot is on the edge.

    Shi's program judges the lines again after each solve; here they are judged at the start of the
    step.
    """

    def choose(self, candidates: Candidates) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        keep = _shortest_exit(candidates)
        arrays = candidates.arrays, candidates.polygons, candidates.critdis
        _one_vertex_per_joint_end(*arrays, keep)
        return keep


class GroupedCandidates(NamedTuple):
    """Fields of ``Candidates`` as kernels take them."""

    group_start: Ints
    vertex: Ints
    edge: Ints
    pair: Ints
    gap: Floats
    along: Floats
    remembered: Ints


def _shortest_exit(candidates: Candidates) -> Bools:
    """Return True for the edges of the shortest exit from the corners that are entered, (m,)."""
    keep: Bools = _kept(candidates.arrays, candidates.polygons, candidates.critdis)
    return keep


@kernel()
def _kept(arrays, outlines, critdis):
    """Return which candidates (m,) are kept, see ``_shortest_exits``."""
    keep, known = np.zeros(len(arrays[1]), np.bool_), np.zeros(len(arrays[1]), np.bool_)
    _shortest_exits(len(arrays[6]), arrays, outlines, critdis, known, keep)
    return keep


@shared(CONTACTS)
def _shortest_exits(first, last, arrays, outlines, critdis, known, keep):
    """Judge the candidates of the pairs of blocks that begin with groups ``first`` to ``last`` - 1.

    ``arrays`` are ``GroupedCandidates``, ``outlines`` ``Polygons``; ``critdis`` is the length, m,
    by which edges are extended.
    """
    candidates, polygons = GroupedCandidates(*arrays), Polygons(*outlines)
    group_start, pair = candidates.group_start, candidates.pair
    first, last = _next_pair(first, group_start, pair), _next_pair(last, group_start, pair)
    low, high = group_start[first], group_start[last]
    _bisect(first, last, candidates, polygons, critdis, keep)
    _drop_not_entered(low, high, candidates, polygons, keep)
    _are_known(first, last, group_start, candidates.remembered, known)
    _drop_deeper_corners(low, high, candidates, polygons, known, keep)


@kernel(forceinline=True)
def _relation(a, b, candidates, outlines):
    """Say how the edges of two candidates, of one block, share a vertex in front of them.

    0: both are kept (re-entrant corner, walls of a slot); 1: one of them, by the bisector
    (convex corner, faces of a plate); 2: one of them, the edge that the foot lies on (flat corner).
    """
    e, f, gap_e, gap_f = (
        candidates.edge[a],
        candidates.edge[b],
        candidates.gap[a],
        candidates.gap[b],
    )
    cosine_of = cosine(e, f, outlines.direction)
    adjacent = outlines.after[e] == f
    if adjacent or outlines.after[f] == e:
        turn = sine(e, f, outlines.direction)
        turn = turn if adjacent else -turn
        if abs(turn) <= SMALL_ANGLE and cosine_of > 0.0:
            return 2
        return 1 if turn > 0.0 else 0
    # not neighbours: back to back where each foot lies behind the other edge's line
    return 1 if gap_e - gap_f * cosine_of < 0.0 and gap_f - gap_e * cosine_of < 0.0 else 0


@kernel(forceinline=True)
def _loses_flat_corner(a, b, candidates, outlines):
    """Return True if the foot has passed from the edge of a to that of b at their flat corner."""
    e, f, length = candidates.edge[a], candidates.edge[b], outlines.length
    if outlines.after[e] == f:
        # beyond the end of e and beyond the start of f; on the corner itself e is kept
        return (candidates.along[a] - length[e]) + candidates.along[b] > 0.0
    return candidates.along[a] + (candidates.along[b] - length[f]) <= 0.0


@kernel()
def _bisect(low, high, candidates, outlines, critdis, keep):
    """Keep the candidates of groups ``low`` to ``high`` - 1 that the angle bisector keeps.

    At a convex corner of edges E1, E2 the vertex lies on E1's side of the bisector exactly where
    its signed gap to E1 exceeds the gap to E2 (Yu & Yin 2015), inside and outside the block
    alike.  On the bisector the remembered edge stays, else the lower index is taken.  ``critdis``
    is the length by which edges are extended.
    """
    edge, gap, length = candidates.edge, candidates.gap, outlines.length
    for g in range(low, high):
        start, stop = candidates.group_start[g], candidates.group_start[g + 1]
        if stop - start == 1:
            keep[start] = True
            continue
        alive = np.ones(stop - start, np.bool_)
        for a in range(start, stop):
            for b in range(start, stop):
                if a != b and _relation(a, b, candidates, outlines) == 2:
                    if _loses_flat_corner(a, b, candidates, outlines):
                        alive[a - start] = False
        while True:
            best = stop  # none yet; -1 would be a type of its own to numba
            for a in range(start, stop):
                if not alive[a - start]:
                    continue
                if best == stop or _is_nearer(a, best, gap, edge, candidates.remembered[g], length):
                    best = a
            if best == stop:
                break
            keep[best] = True
            alive[best - start] = False
            for a in range(start, stop):
                if alive[a - start] and _relation(best, a, candidates, outlines) == 1:
                    alive[a - start] = False
        for a in range(start, stop):
            if keep[a] and _is_beyond_notch(a, start, stop, candidates, outlines, critdis, keep):
                keep[a] = False


@kernel(forceinline=True)
def _is_beyond_notch(a, start, stop, candidates, outlines, critdis, keep):
    """Return True if a foot lies beyond an edge's re-entrant end but the vertex is not in it.

    Behind a re-entrant corner a vertex touches both edges.  Where the other edge has lost against
    the next one (the vertex has come through the tread of a stair, not along its riser), or is
    none of the candidates, the first edge is not touched either.
    """
    e, along, length = candidates.edge[a], candidates.along[a], outlines.length[candidates.edge[a]]
    at_end, beyond = along > 0.0, max(-along, along - length)
    if beyond <= ROUND_OFF * length or turn_at(e, at_end, outlines) >= -SMALL_ANGLE:
        return False
    other = next_edge(e, at_end, outlines)
    for b in range(start, stop):
        if candidates.edge[b] == other:
            return not keep[b]
    return beyond > critdis


@kernel()
def _is_nearer(a, b, gap, edge, remembered, length):
    """Return True if candidate a is to be preferred to b: larger gap, remembered, lower index."""
    tie = ROUND_OFF * min(length[edge[a]], length[edge[b]])
    if gap[a] > gap[b] + tie:
        return True
    if gap[a] < gap[b] - tie:
        return False
    if edge[b] == remembered:
        return False
    return edge[a] == remembered or edge[a] < edge[b]


@kernel(forceinline=True)
def _is_entrance_passed(p, e, along, outlines):
    """Return False where vertex p, behind edge e, has not entered the corner at the end of e.

    Shi (1988): two convex corners P and Q are inside each other where both entrance lines are
    passed, one on either side; seen from Q they bound the sum of the wedge at Q and the reversed
    wedge at P.  Next to e the other line is that of the next edge f of Q if the whole wedge at P
    lies in front of it, else that of P's own edge on that side, which Q has to pass.  A vertex that
    lies along e with an edge of its own (face to face) is not judged.
    """
    direction, at_end = outlines.direction, along > 0.5 * outlines.length[e]
    f = next_edge(e, at_end, outlines)
    if turn_at(e, at_end, outlines) <= SMALL_ANGLE or gap_to(p, f, outlines) < 0.0:
        return True
    # P's own edge above e, and the direction in which it leaves P
    a = p if at_end else outlines.before[p]
    sign = 1.0 if at_end else -1.0
    ux, uy = sign * direction[a, 0], sign * direction[a, 1]
    if abs(ux * direction[e, 1] - uy * direction[e, 0]) <= SMALL_ANGLE:
        return True
    if ux * direction[f, 1] - uy * direction[f, 0] >= 0.0:
        return False
    return gap_to(end_of(e, at_end, outlines), a, outlines) < 0.0


@kernel()
def _drop_not_entered(low, high, candidates, outlines, keep):
    """Drop vertices that have passed one line of a corner but are not inside it, in place.

    Beside a sharp corner a vertex can lie behind an edge, its foot on it, and yet outside the
    block, on the other side of the wedge.  Of candidates ``low`` to ``high`` - 1.
    """
    vertex, edge = candidates.vertex, candidates.edge
    gap, along = candidates.gap, candidates.along
    for c in range(low, high):
        if keep[c] and gap[c] < -ROUND_OFF * outlines.length[edge[c]]:
            keep[c] = _is_entrance_passed(vertex[c], edge[c], along[c], outlines)


@kernel(forceinline=True)
def _meets(p, e, q, a, outlines):
    """Say how contacts (P, edge e) and (Q, edge a) of two blocks meet.

    0: they have nothing to do with each other; 1: e ends at Q and a at P, they are the two entrance
    lines of corners P and Q; 2: e and a run along each other from P and Q, which coincide at one
    end of a joint; 3: the same, P and Q are its two ends.
    """
    if (
        outlines.vertex_block[a] == outlines.vertex_block[e]
        or (e != q and outlines.after[e] != q)
        or (a != p and outlines.after[a] != p)
    ):
        return 0
    if abs(sine(e, a, outlines.direction)) > SMALL_ANGLE:
        return 1
    # the directions in which e leaves Q and a leaves P are the same where Q and P coincide
    return 2 if (cosine(e, a, outlines.direction) > 0.0) == ((e == q) == (a == p)) else 3


@kernel()
def _are_known(low, high, group_start, remembered, known):
    """Say of the candidates of groups ``low`` to ``high`` - 1 whether they were in contact before.

    That is whether their vertex was with any edge of the same block.
    """
    for g in range(low, high):
        known[group_start[g] : group_start[g + 1]] = remembered[g] >= 0


@kernel()
def _drop_deeper_corners(low, high, candidates, outlines, known, keep):
    """Keep one contact where two corners are inside each other (vertex to vertex), in place.

    Vertex P of block i is behind edge e of block j that ends at Q, and Q behind an edge a of i
    that ends at P.  Moving out along either normal parts the corners, so that the shortest exit
    counts, as at one corner: the larger gap; on a tie the contact that is remembered, else that
    of the longer edge, else the lower vertex.  Corners that only coincide are not inside each
    other, however their gaps are rounded.  Of candidates ``low`` to ``high`` - 1, all of some
    pairs of blocks.
    """
    vertex, edge, pair = candidates.vertex, candidates.edge, candidates.pair
    gap, length = candidates.gap, outlines.length
    start = low
    while start < high:
        stop = start + 1
        while stop < high and pair[stop] == pair[start]:
            stop += 1
        for c in range(start, stop):
            for d in range(c + 1, stop):
                if not (keep[c] and keep[d]):
                    continue
                p, e, q, a = vertex[c], edge[c], vertex[d], edge[d]
                tie = ROUND_OFF * min(length[e], length[a])
                if max(gap[c], gap[d]) >= -tie or _meets(p, e, q, a, outlines) != 1:
                    continue
                if abs(gap[c] - gap[d]) > tie:
                    first_stays = gap[c] > gap[d]
                elif known[c] != known[d]:
                    first_stays = known[c]
                elif abs(length[e] - length[a]) > tie:
                    first_stays = length[e] > length[a]
                else:
                    first_stays = p < q
                keep[d if first_stays else c] = False
        start = stop


@kernel()
def _next_pair(g, group_start, pair):
    """Return the first group from ``g`` on with which a pair of blocks begins."""
    groups = len(group_start) - 1
    while 0 < g < groups and pair[group_start[g]] == pair[group_start[g] - 1]:
        g += 1
    return min(g, groups)


@kernel()
def _one_vertex_per_joint_end(arrays, outlines, critdis, keep):
    """Keep one of the two vertices that coincide at an end of a joint, in place.

    Corners P and Q coincide where they are within critdis.  The vertex that was in contact
    before stays; else the one whose foot lies on the other block's edge, else the lower one.
    """
    candidates, polygons = GroupedCandidates(*arrays), Polygons(*outlines)
    vertex, edge, pair = candidates.vertex, candidates.edge, candidates.pair
    along, remembered = candidates.along, candidates.remembered
    vertices, length = polygons.vertices, polygons.length
    known = np.zeros(len(edge), np.bool_)
    _are_known(0, len(remembered), candidates.group_start, remembered, known)
    start = 0
    while start < len(edge):
        stop = start + 1
        while stop < len(edge) and pair[stop] == pair[start]:
            stop += 1
        for c in range(start, stop):
            for d in range(c + 1, stop):
                p, e, q, a = vertex[c], edge[c], vertex[d], edge[d]
                if (
                    not (keep[c] and keep[d])
                    or np.hypot(vertices[p, 0] - vertices[q, 0], vertices[p, 1] - vertices[q, 1])
                    > critdis
                    or _meets(p, e, q, a, polygons) != 2
                ):
                    continue
                beyond_c = max(-along[c], along[c] - length[e]) > ROUND_OFF * length[e]
                beyond_d = max(-along[d], along[d] - length[a]) > ROUND_OFF * length[a]
                if known[c] != known[d]:
                    first_stays = known[c]
                elif beyond_c != beyond_d:
                    first_stays = beyond_d
                else:
                    first_stays = p < q
                keep[d if first_stays else c] = False
        start = stop
