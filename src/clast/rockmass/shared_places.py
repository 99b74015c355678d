"""Vertices near edges: moved onto the line where that is straight, else the edge runs through them.

A vertex is moved onto an edge whose ends stay; of the edges in question long ones come first, so
that floors and bed joints stay straight.  A vertex that stays beside an edge then becomes a vertex
of it: the edge bends by no more than the tolerance for each round of this, and never by more than
twice.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from scipy.spatial import cKDTree

from clast.model.arrays import entries, following, owners
from clast.model.model import Bools, Floats, Ints


@dataclass(frozen=True, kw_only=True, eq=False)
class Cycles:
    """Loops of places; entry k stands for a vertex and for the edge from it to the next."""

    start: Ints
    """First entry of each block, and the number of entries, shape (nb + 1,)."""
    node: Ints
    """Place of each entry, shape (nv,)."""
    edge: Ints
    """Edge as drawn that the edge of each entry is, or is a part of, shape (nv,)."""

    @cached_property
    def owner(self) -> Ints:
        """Block of each entry, shape (nv,)."""
        return owners(self.start)

    @cached_property
    def following(self) -> Ints:
        """Entry after each in its block, shape (nv,); blocks may have become empty."""
        filled = np.unique(self.start)
        return following(filled) if len(filled) > 1 else np.zeros(0, np.int64)

    @property
    def after(self) -> Ints:
        """Place of the entry after each in its block, shape (nv,)."""
        return np.asarray(self.node[self.following])

    @cached_property
    def pieces(self) -> tuple[Ints, Ints]:
        """Edges between two places, each once, (ne, 2), and the piece of each entry, (nv,)."""
        low, high = np.minimum(self.node, self.after), np.maximum(self.node, self.after)
        key, of = np.unique(low << 32 | high, return_inverse=True)
        return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1), of

    def with_pieces(self, piece: Ints) -> tuple[Ints, Ints]:
        """Return the entries that have pieces (k,): number of the piece and entry, (m,) each."""
        return _members(self.pieces[1], len(self.pieces[0]), piece)

    def only(self, keep: Bools) -> Cycles:
        """Return the loops with some of their entries (nv,)."""
        count = np.bincount(self.owner[keep], minlength=len(self.start) - 1)
        return Cycles(
            start=np.concatenate([[0], np.cumsum(count)]),
            node=self.node[keep],
            edge=self.edge[keep],
        )


def _members(of: Ints, count: int, which: Ints) -> tuple[Ints, Ints]:
    """Return the number in ``which`` (k,) and the index of all things of its groups, (m,) each.

    ``of`` is the group of each thing, from 0 to ``count``.
    """
    order = np.argsort(of, kind="stable")
    entry, number = entries(np.searchsorted(of[order], np.arange(count + 1)), which)
    return number, order[entry]


@dataclass(frozen=True, kw_only=True, eq=False)
class Near:
    """Places near pieces that they could be put onto."""

    node: Ints
    """Place, shape (k,)."""
    piece: Ints
    """Piece, shape (k,)."""
    gap: Floats
    """Distance of the two, m, shape (k,)."""
    share: Floats
    """Where along the piece, from 0 at its first end to 1, shape (k,)."""
    touching: Bools
    """Whether a block with the piece has the place, too: it would touch itself there, (k,)."""

    def only(self, keep: Bools | Ints) -> Near:
        """Return some of them."""
        return Near(**{name: array[keep] for name, array in vars(self).items()})


def near_edges(loops: Cycles, at: Floats, reach: float) -> Near:
    """Return the places of ``at`` (nn, 2) beside an edge of another block, within ``reach``, m.

    Places that lie on the edge to round-off are not beside it, nor those of all blocks that have
    the edge.
    """
    used = np.unique(loops.node)
    ends = loops.pieces[0]
    tree = shapely.STRtree(shapely.linestrings(at[ends]))
    point, piece = tree.query(shapely.points(at[used]), predicate="dwithin", distance=reach)
    node = used[point]
    gap, share = aside(at[node], at[ends[piece]])
    inner = (share > 0.0) & (share < 1.0) & (gap > 1e-6 * reach)
    node, piece, gap, share = node[inner], piece[inner], gap[inner], share[inner]
    number, entry = loops.with_pieces(piece)
    count = np.int64(loops.node.max() + 1)
    has_both = np.isin(loops.owner[entry] * count + node[number], loops.owner * count + loops.node)
    having = np.bincount(number[has_both], minlength=len(node))
    near = Near(node=node, piece=piece, gap=gap, share=share, touching=having > 0)
    return near.only(having < np.bincount(number, minlength=len(node)))


def aside(point: Floats, line: Floats) -> tuple[Floats, Floats]:
    """Return how far points (k, 2) lie beside lines (k, 2, 2), m, and where along them, (k,)."""
    along, to = line[:, 1] - line[:, 0], point - line[:, 0]
    length = np.maximum(np.hypot(*along.T), 1e-300)
    gap = np.abs(along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]) / length
    return np.asarray(gap), np.asarray((along * to).sum(axis=1) / length**2)


def onto_edges(loops: Cycles, of: Ints, at: Floats, drawn: Floats, reach: float) -> Floats:
    """Return the places ``at`` (nn, 2) with those beside an edge moved onto it, m.

    ``drawn`` (nv, 2) are all vertices as drawn and ``of`` their places: none moves further than
    ``reach`` from where it was drawn, and no place comes within ``reach`` of another.
    """
    near = near_edges(loops, at, reach)
    if len(near.node) == 0:
        return at
    ends = loops.pieces[0][near.piece]
    line = at[ends]
    foot = line[:, 0] + near.share[:, None] * (line[:, 1] - line[:, 0])
    number, vertex = _members(of, len(at), near.node)
    distance = np.zeros(len(near.node))
    np.maximum.at(distance, number, np.hypot(*(drawn[vertex] - foot[number]).T))
    length = np.hypot(*(line[:, 1] - line[:, 0]).T)
    order = np.lexsort((near.share, near.piece, -length))
    order = order[((distance <= reach) & ~near.touching)[order]]
    held, moved, chosen = set[int](), set[int](), []
    nodes, pairs = near.node[order].tolist(), ends[order].tolist()
    for k, node, (a, b) in zip(order.tolist(), nodes, pairs, strict=True):
        if not (node in held or node in moved or a in moved or b in moved):
            moved.add(node)
            held.update((a, b))
            chosen.append(k)
    place = at.copy()
    place[near.node[chosen]] = foot[chosen]
    return kept_apart(place, at, reach)


def through_places(loops: Cycles, at: Floats, reach: float) -> tuple[Cycles, Ints, Ints]:
    """Return the loops whose edges run through the places beside them; ``at`` (nn, 2), m.

    Then the places that were put in, once for each block, (k,), and those that are still beside an
    edge, each once, (m,).
    """
    # Entries are numbered as drawn, but those that were removed leave gaps.
    drawn = np.zeros((int(loops.edge.max(initial=-1)) + 1, 2, 2))
    drawn[loops.edge] = at[np.stack([loops.node, loops.after], axis=1)]
    put_in = [np.zeros(0, np.int64)]
    while True:
        beside = near_edges(loops, at, reach)
        near = beside.only(_fitting(loops, beside, (at, drawn), reach))
        if len(near.node) == 0 or len(put_in) > 10:
            return loops, np.concatenate(put_in), np.unique(beside.node)
        number, entry = loops.with_pieces(near.piece)
        forward = loops.node[entry] == loops.pieces[0][near.piece[number], 0]
        share = np.where(forward, near.share[number], 1.0 - near.share[number])
        order = np.lexsort((share, entry))
        loops = with_places(loops, entry[order], near.node[number[order]])
        put_in.append(near.node[number])


def _fitting(loops: Cycles, near: Near, at: tuple[Floats, Floats], reach: float) -> Bools:
    """Return whether a place may become a vertex of all blocks with a piece, shape (k,).

    It is the nearest piece of each block, and no edge bends too far from where it was drawn:
    ``at`` are the places (nn, 2) and the edges as drawn (m, 2, 2), m.
    """
    number, entry = loops.with_pieces(near.piece)
    gap, share = aside(at[0][near.node[number]], at[1][loops.edge[entry]])
    # Edges as drawn pass no further beside vertices that were put into them
    bent = (gap > 2.0 * reach) | (share < 0.0) | (share > 1.0)
    # Of the pieces of one block the nearest has the place.
    block, node = loops.owner[entry], near.node[number]
    order = np.lexsort((near.piece[number], near.gap[number], node, block))
    again = (np.diff(block[order]) == 0) & (np.diff(node[order]) == 0)
    bent[order[1:][again]] = True
    return np.asarray(~near.touching & (np.bincount(number[bent], minlength=len(near.node)) == 0))


def without_folds(loops: Cycles) -> tuple[Cycles, Ints]:
    """Return loops without edges of no length and without spikes, and the places of those, (k,).

    A spike goes out along an edge and comes back along it: it encloses nothing.
    """
    closed = [np.zeros(0, np.int64)]
    while len(loops.node):
        # Of an edge from a place to itself the second entry stays, with the joint of its edge.
        same = loops.node == loops.after
        if same.any():
            closed.append(loops.node[same])
            loops = loops.only(~same)
            continue
        before = np.empty_like(loops.following)
        before[loops.following] = np.arange(len(before))
        # Tips of spikes, one a block at most.
        tips = np.flatnonzero(loops.node[before] == loops.after)
        spike = tips[np.unique(loops.owner[tips], return_index=True)[1]]
        if len(spike) == 0:
            break
        removed = np.zeros(len(loops.node), np.bool_)
        removed[spike] = True
        removed[before[spike]] = True
        closed.append(loops.node[spike])
        loops = loops.only(~removed)
    return loops, np.concatenate(closed)


def with_places(loops: Cycles, entry: Ints, node: Ints) -> Cycles:
    """Return loops with places (k,) put in after entries (k,), in the order given."""
    count = np.bincount(loops.owner[entry], minlength=len(loops.start) - 1)
    every = np.concatenate([np.arange(len(loops.node)), entry])
    # Stable: an entry goes before what is put in after it.
    order = np.argsort(every, kind="stable")
    return Cycles(
        start=loops.start + np.concatenate([[0], np.cumsum(count)]),
        node=np.concatenate([loops.node, node])[order],
        edge=np.concatenate([loops.edge, loops.edge[entry]])[order],
    )


def corners_of(points: Floats, reach: float) -> tuple[Ints, Floats]:
    """Return which place each of vertices (nv, 2) has, (nv,), and where places are, m, (nn, 2).

    Vertices within ``reach`` share one.  A place is where most of its vertices are, else their
    mean; where that would bring a vertex too far, or two places too near, it is the vertex that
    was picked.
    """
    key = np.ascontiguousarray(points).view(np.complex128)[:, 0]
    _, first, of, times = np.unique(key, return_index=True, return_inverse=True, return_counts=True)
    single = points[first]
    picked = single[_picked(single, times, reach)]
    # Round-off may put a vertex at the tolerance just beyond it.
    owner = cKDTree(picked).query(single, distance_upper_bound=reach * (1.0 + 1e-9))[1]
    return owner[of], _better(picked, single, owner, times, reach)


def _picked(at: Floats, times: Ints, reach: float) -> Ints:
    """Return points (k,) of ``at`` (n, 2) further apart than ``reach``, near which all others are.

    Those with most vertices around go first; ``times`` (n,) says how many lie on each point.
    """
    pairs = cKDTree(at).query_pairs(reach, output_type="ndarray").astype(np.int64)
    count = len(at)
    weight = times.astype(np.int64)
    for one, other in ((0, 1), (1, 0)):
        np.add.at(weight, pairs[:, one], times[pairs[:, other]])
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    start = np.searchsorted(both[:, 0], np.arange(count + 1)).tolist()
    near = both[:, 1].tolist()
    free = [True] * count
    picked = []
    for point in np.lexsort((np.arange(count), -weight)).tolist():
        if free[point]:
            picked.append(point)
            for other in near[start[point] : start[point + 1]]:
                free[other] = False
    return np.sort(np.array(picked, np.int64))


def _better(picked: Floats, at: Floats, owner: Ints, times: Ints, reach: float) -> Floats:
    """Return for each place (k, 2) where most of its vertices are, their mean, or itself."""
    count = len(picked)
    total = np.bincount(owner, times, minlength=count)
    shift = (at - picked[owner]) * times[:, None]
    mean = np.stack([np.bincount(owner, shift[:, k], minlength=count) for k in (0, 1)], axis=1)
    place = picked + mean / total[:, None]
    order = np.lexsort((-times, owner))
    first = order[np.searchsorted(owner[order], np.arange(count))]
    most = 2 * times[first] > total
    place[most] = at[first[most]]
    gap = np.hypot(*(at - place[owner]).T)
    far = np.zeros(count)
    np.maximum.at(far, owner, gap)
    return kept_apart(np.where((far > reach)[:, None], picked, place), picked, reach)


def kept_apart(place: Floats, before: Floats, reach: float) -> Floats:
    """Return places (n, 2), those that came within ``reach`` of others put back to ``before``."""
    place = place.copy()
    while True:
        near = np.unique(cKDTree(place).query_pairs(reach, output_type="ndarray"))
        back = near[(place[near] != before[near]).any(axis=1)]
        if len(back) == 0:
            return place
        place[back] = before[back]
