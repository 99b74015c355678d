"""A planar graph on whole numbers: its loops, its dangling edges, and its straight chains."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from clast.model.arrays import connected
from clast.model.model import Bools, Floats, Ints

WELD = -1
"""Line of an edge that no line made: it welds the parts of a ring."""


@dataclass(frozen=True, kw_only=True)
class Graph:
    """Nodes and edges that meet in nodes only."""

    xy: Ints
    """Coordinates of the nodes, cells, shape (nn, 2)."""
    edge: Ints
    """First and second node of each edge, shape (ne, 2)."""
    line: Ints
    """Line whose joint each edge has, or ``WELD``, shape (ne,)."""
    joint: Ints
    """Joint of each edge, shape (ne,); edges that differ in it are not made one."""
    barrier: Bools
    """Whether an outline runs along each edge, shape (ne,)."""
    side: Ints
    """Kinds of faces left and right of each edge: -2 nothing, -1 rock, else an opening, (ne, 2)."""

    def only(self, keep: Bools | Ints) -> Graph:
        """Return the graph with some of its edges; nodes keep their numbers."""
        return replace(
            self,
            edge=self.edge[keep],
            line=self.line[keep],
            joint=self.joint[keep],
            barrier=self.barrier[keep],
            side=self.side[keep],
        )

    @property
    def lengths(self) -> Floats:
        """Length of each edge, cells, shape (ne,)."""
        return np.hypot(*(self.xy[self.edge[:, 1]] - self.xy[self.edge[:, 0]]).T.astype(float))

    @property
    def middles(self) -> Floats:
        """Middle of each edge, cells, shape (ne, 2)."""
        return np.asarray(self.xy[self.edge].mean(axis=1))


@dataclass(frozen=True, kw_only=True)
class Loops:
    """The loops of a graph, each with the face on its left, inside or around it."""

    half: Ints
    """Half-edges one after another: 2 e runs along edge e, 2 e + 1 back, shape (2 ne,)."""
    start: Ints
    """First entry of each loop in ``half``, the last is their number, shape (nl + 1,)."""
    of: Ints
    """Loop of each half-edge, shape (2 ne,)."""
    area2: Ints
    """Twice the area of each loop, cells2, below zero around the outside of parts, (nl,)."""

    def nodes(self, graph: Graph) -> Ints:
        """Return the node at which each entry of ``half`` starts, shape (2 ne,)."""
        return np.asarray(graph.edge[self.half >> 1, self.half & 1])

    def sides(self, graph: Graph) -> Ints:
        """Return the kind of the face on the left of each loop, shape (nl,)."""
        first = self.half[self.start[:-1]]
        return np.asarray(graph.side[first >> 1, first & 1])


def loops_of(graph: Graph) -> Loops:
    """Return the loops of a graph: every half-edge with the face on its left."""
    half, start = _cycles(_following(graph))
    of = np.zeros(len(half), np.int64)
    of[half] = np.repeat(np.arange(len(start) - 1), np.diff(start))
    here = graph.xy[graph.edge[half >> 1, half & 1]]
    there = graph.xy[graph.edge[half >> 1, 1 - (half & 1)]]
    cross = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
    area2 = np.add.reduceat(cross, start[:-1]) if len(half) else np.zeros(0, np.int64)
    return Loops(half=half, start=start, of=of, area2=area2)


def _following(graph: Graph) -> Ints:
    """Return the half-edge after each in its loop: at every node the next one clockwise."""
    count = 2 * len(graph.edge)
    origin = graph.edge.reshape(-1)
    along = (graph.xy[graph.edge[:, 1]] - graph.xy[graph.edge[:, 0]])[:, None]
    along = (along * np.array([[1], [-1]])).reshape(-1, 2)
    angle = np.arctan2(along[:, 1].astype(float), along[:, 0].astype(float))
    order = _by_angle(np.lexsort((angle, origin)), origin, along, angle)
    first = np.r_[True, origin[order][1:] != origin[order][:-1]] if count else np.zeros(0, bool)
    start = np.flatnonzero(first)
    last = np.r_[start[1:], count] - 1
    before = np.arange(-1, count - 1)
    before[start] = last
    clockwise = np.zeros(count, np.int64)
    clockwise[order] = order[before]
    return np.asarray(clockwise[np.arange(count) ^ 1])


def _by_angle(order: Ints, origin: Ints, along: Ints, angle: Floats) -> Ints:
    """Return the order (n,) with neighbours swapped where round-off of angles put them wrong."""
    order = order.copy()
    while True:
        one, other = order[:-1], order[1:]
        at = np.flatnonzero((origin[one] == origin[other]) & (angle[other] - angle[one] < 1e-12))
        a, b = along[order[at]], along[order[at + 1]]
        wrong = at[a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0]
        if len(wrong) == 0:
            return order
        wrong = wrong[np.r_[True, np.diff(wrong) > 1]]
        order[wrong], order[wrong + 1] = order[wrong + 1], order[wrong].copy()


def _cycles(following: Ints) -> tuple[Ints, Ints]:
    """Return the cycles of a permutation (n,) one after another (n,), and where each starts."""
    count = len(following)
    of = connected(np.arange(count), following, count)
    number = int(of.max(initial=-1)) + 1
    first = np.full(number, count)
    np.minimum.at(first, of, np.arange(count))
    # How many steps lie between each and the last of its cycle, by jumps twice as long each time.
    jump = following.copy()
    left = (jump != first[of]).astype(np.int64)
    last = np.flatnonzero(left == 0)
    jump[last] = last
    active = np.flatnonzero(left)
    while len(active):
        far = jump[active]
        left[active] += left[far]
        jump[active] = jump[far]
        active = active[jump[active] != jump[jump[active]]]
    size = np.bincount(of, minlength=number)
    start = np.concatenate([[0], np.cumsum(size)])
    half = np.empty(count, np.int64)
    half[start[of] + size[of] - 1 - left] = np.arange(count)
    return half, start


def bordering(graph: Graph) -> Bools:
    """Return True for edges with another face on each side, shape (ne,).

    The others are dangling ends, and bridges between parts; without them all, none is left.
    """
    of = loops_of(graph).of
    return np.asarray(of[0::2] != of[1::2])


def parts_of(graph: Graph) -> Ints:
    """Return the connected part that each node belongs to, shape (nn,)."""
    return connected(graph.edge[:, 0], graph.edge[:, 1], len(graph.xy))


def straightened(graph: Graph) -> Graph:
    """Return the graph without nodes that only two edges of one straight line share.

    Rounding to the grid bends lines by less than a cell; a chain is pulled straight where no other
    node lies between it and its chord, so that nothing crosses.  The faces beside the edges must be
    found anew.
    """
    chain, outer = _chains(graph)
    long = np.flatnonzero(np.bincount(chain, minlength=len(outer)) > 1)
    refused = _with_nodes_between(graph, chain, outer, long)
    single = np.isin(chain, refused)
    group = np.where(single, len(outer) + np.arange(len(chain)), chain)
    _, first, index = np.unique(group, return_index=True, return_inverse=True)
    kept = graph.only(first)
    edge = np.where(single[first][:, None], kept.edge, outer[chain[first]])
    barrier = np.zeros(len(first), np.bool_)
    np.logical_or.at(barrier, index, graph.barrier)
    return _once(replace(kept, edge=np.sort(edge, axis=1), barrier=barrier))


def _once(graph: Graph) -> Graph:
    """Return the graph with one edge for each pair of nodes, that of the latest line."""
    order = np.lexsort((-graph.line, graph.edge[:, 1], graph.edge[:, 0]))
    ordered = graph.edge[order]
    first = np.r_[True, (ordered[1:] != ordered[:-1]).any(axis=1)][: len(order)]
    barrier = np.logical_or.reduceat(graph.barrier[order], np.flatnonzero(first))
    return replace(graph.only(order[first]), barrier=barrier)


def _chains(graph: Graph) -> tuple[Ints, Ints]:
    """Return the chain of each edge (ne,), and the two end nodes of each chain (nc, 2)."""
    count = len(graph.edge)
    through = _passed(graph)
    node = graph.edge.reshape(-1)
    order = np.argsort(node, kind="stable")
    inner = order[through[node[order]]]
    one, other = inner[0::2] >> 1, inner[1::2] >> 1
    chain = connected(one, other, count)
    ends = np.flatnonzero(~through[node])
    ends = ends[np.argsort(chain[ends >> 1], kind="stable")]
    return chain, node[ends].reshape(-1, 2)


def _passed(graph: Graph) -> Bools:
    """Return True for nodes through which a line passes straight on, and nothing else, (nn,)."""
    node = graph.edge.reshape(-1)
    order = np.argsort(node, kind="stable")
    degree = np.bincount(node, minlength=len(graph.xy))
    two = np.flatnonzero(degree == 2)
    at = np.cumsum(degree)[two] - 2
    one, other = order[at], order[at + 1]
    a = graph.xy[node[one ^ 1]] - graph.xy[two]
    b = graph.xy[node[other ^ 1]] - graph.xy[two]
    opposite = (a.astype(float) * b).sum(axis=1) < 0.0
    one, other = one >> 1, other >> 1
    flat = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] == 0) | (graph.line[one] == graph.line[other])
    same = (graph.joint[one] == graph.joint[other]) & (graph.barrier[one] == graph.barrier[other])
    passed = np.zeros(len(graph.xy), np.bool_)
    passed[two] = opposite & flat & same & (graph.line[one] != WELD) & (graph.line[other] != WELD)
    return passed


def _with_nodes_between(graph: Graph, chain: Ints, outer: Ints, long: Ints) -> Ints:
    """Return the chains of ``long`` that have a foreign node between themselves and their chord."""
    of = np.flatnonzero(np.isin(chain, long))
    node = np.unique(np.stack([np.repeat(chain[of], 2), graph.edge[of].reshape(-1)], 1), axis=0)
    owner, node = node.T
    first, last = graph.xy[outer[owner]].transpose(1, 0, 2)
    to, chord = graph.xy[node] - first, last - first
    bent = np.isin(owner, owner[to[:, 0] * chord[:, 1] != to[:, 1] * chord[:, 0]])
    owner, node, to, chord = owner[bent], node[bent], to[bent], chord[bent]
    if len(owner) == 0:
        return owner
    order = np.lexsort(((to.astype(float) * chord).sum(axis=1), owner))
    chains, ring = np.unique(owner[order], return_inverse=True)
    rings = shapely.linearrings(graph.xy[node[order]].astype(float), indices=ring)
    used = np.unique(graph.edge)
    tree = shapely.STRtree(shapely.points(graph.xy[used].astype(float)))
    ring, point = tree.query(shapely.polygons(rings), predicate="intersects")
    count = np.int64(len(graph.xy))
    foreign = ~np.isin(chains[ring] * count + used[point], owner * count + node)
    return np.unique(chains[ring[foreign]])
