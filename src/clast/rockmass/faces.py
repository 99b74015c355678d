"""Faces with holes: split by welds through their holes, so that every block is one simple loop.

A hole is an island of blocks inside a face, or an opening inside one block.  A weld runs between
two nodes that see each other, so that it makes no node and moves nothing; two of them from every
hole, from different nodes to different nodes, leave simple loops.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.errors import ModelError
from clast.model.arrays import connected, entries
from clast.model.model import Floats, Ints
from clast.rockmass.planar import WELD, Graph, Loops, loops_of, parts_of


@dataclass(frozen=True, kw_only=True)
class NodeRing:
    """A simple loop of nodes that lies in the interior of a face, or touches its loop."""

    nodes: Ints
    """Nodes, shape (k,); where it touches the rest of the face, it does so with the first."""
    touching: bool
    """Whether it hangs on the rest of the face by one node."""


@dataclass(frozen=True, kw_only=True)
class Whole:
    """A graph whose faces have no holes, and the joins that were made for it."""

    graph: Graph
    """The graph with its welds."""
    islands: Floats
    """Middle of each small island that was taken out, cells, shape (k, 2)."""
    island_blocks: int
    """Blocks that were in them."""
    split: Floats
    """A node of each hole or touching loop, cells, shape (k, 2)."""


def without_holes(graph: Graph, smallest2: float) -> Whole:
    """Return the graph with welds; islands of less than ``smallest2`` (2 areas) are taken out."""
    graph, islands, blocks = _without_small_islands(graph, smallest2)
    split: list[int] = []
    # Every round joins each hole to another loop at least; few rounds are ever needed
    for _ in range(100):
        before = len(split)
        welds = _welds(graph, split)
        if len(split) == before:
            at = graph.xy[np.array(split, np.int64)].astype(float).reshape(-1, 2)
            return Whole(graph=graph, islands=islands, island_blocks=blocks, split=at)
        count = len(welds)
        graph = replace(
            graph,
            edge=np.concatenate([graph.edge, welds[:, :2]]),
            line=np.append(graph.line, np.full(count, WELD)),
            joint=np.append(graph.joint, np.full(count, WELD)),
            barrier=np.append(graph.barrier, np.zeros(count, np.bool_)),
            side=np.concatenate([graph.side, welds[:, [2, 2]]]),
        )
    where = graph.xy[split[-1]]
    what = f"the ring near cell ({where[0]}, {where[1]}) cannot be split into blocks"
    remedy = "this is a fault of clast: a line through the ring gets round it; please report it"
    raise ModelError(what, where="domain", remedy=remedy)


def _without_small_islands(graph: Graph, smallest2: float) -> tuple[Graph, Floats, int]:
    """Return the graph without small parts inside faces of rock, their middles, their blocks."""
    loops = loops_of(graph)
    part = parts_of(graph)
    hole = (loops.area2 <= 0) & (holders(graph, loops) >= 0) & (-loops.area2 < smallest2)
    node = loops.nodes(graph)
    small = part[node[loops.start[:-1]][hole]]
    outlined = part[graph.edge[graph.barrier, 0]]
    small = np.setdiff1d(small, outlined)
    if len(small) == 0:
        return graph, np.zeros((0, 2)), 0
    loose = np.isin(part[graph.edge[:, 0]], small)
    blocks = np.isin(part[node[loops.start[:-1]]], small) & (loops.area2 > 0)
    middles = [graph.middles[loose & (part[graph.edge[:, 0]] == one)].mean(axis=0) for one in small]
    return graph.only(~loose), np.array(middles), int(blocks.sum())


def _welds(graph: Graph, split: list[int]) -> Ints:
    """Return welds from all rings: both nodes, and the kind of their face, shape (k, 3).

    A node of each ring is added to ``split``.
    """
    loops = loops_of(graph)
    node = loops.nodes(graph)
    side = loops.sides(graph)
    owner = np.repeat(np.arange(len(side)), np.diff(loops.start))
    order = np.lexsort((node, owner))
    again = (np.diff(node[order]) == 0) & (np.diff(owner[order]) == 0)
    pinched = np.unique(owner[order[1:]][again])
    holder = holders(graph, loops)
    hole = np.flatnonzero((loops.area2 <= 0) & (holder >= 0))
    shells = np.union1d(holder[hole], pinched[loops.area2[pinched] > 0])
    welds: list[tuple[int, int, int]] = []
    for shell in shells[side[shells] != NOTHING]:
        inner = hole[holder[hole] == shell]
        entry = entries(loops.start, np.array([shell, *inner]))[0]
        edge, count = np.unique(loops.half[entry] >> 1, return_counts=True)
        # The closing edges of the face have it on one side only.
        edges, closing = graph.edge[edge], graph.edge[edge[count == 1]]
        for ring in _rings(graph, loops, node, shell, inner):
            split.append(int(ring.nodes[0]))
            for weld in _welds_of(ring, edges, closing, graph.xy):
                welds.append((*weld, int(side[shell])))
                edges = np.concatenate([edges, [weld]])
    return np.array(welds, np.int64).reshape(-1, 3)


def _rings(graph: Graph, loops: Loops, node: Ints, shell: int, inner: Ints) -> list[NodeRing]:
    """Return the rings of a face that must be joined to the rest of it."""

    def nodes(loop: int) -> Ints:
        return node[loops.start[loop] : loops.start[loop + 1]]

    def area2(loop: Ints) -> int:
        x, y = graph.xy[loop].T
        return int((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())

    loop = nodes(shell)
    # From its lowest node on, what is left at last is the outer loop, or hangs by its first node.
    lowest = int(np.lexsort(graph.xy[loop].T)[0])
    parts = [one for one in _simple(np.roll(loop, -lowest)) if len(one) > 2]
    # The outer one of the touching loops has the area; the others hang on it.
    parts.pop(int(np.argmax([area2(one) for one in parts])))
    rings = [NodeRing(nodes=one, touching=True) for one in parts]
    for hole in inner:
        rings.extend(NodeRing(nodes=one, touching=False) for one in _simple(nodes(hole)))
    return rings


def _simple(loop: Ints) -> list[Ints]:
    """Return the simple loops that a loop of nodes (k,) is made of where it touches itself."""
    loops: list[Ints] = []
    path: list[int] = []
    place: dict[int, int] = {}
    for node in loop.tolist():
        if node in place:
            first = place[node]
            loops.append(np.array(path[first:], np.int64))
            for loose in path[first:]:
                del place[loose]
            del path[first:]
        place[node] = len(path)
        path.append(node)
    return [*loops, np.array(path, np.int64)]


def _welds_of(ring: NodeRing, edges: Ints, closing: Ints, xy: Ints) -> Iterator[tuple[int, int]]:
    """Yield the shortest welds from a ring: two of them, in opposite directions if possible.

    A loop that hangs on the rest by a node needs one, from another node to another node.
    """
    inner, outer = _sides_of(ring, edges)
    one, other = (grid.reshape(-1) for grid in np.meshgrid(inner, outer, indexing="ij"))
    length = np.hypot(*(xy[other] - xy[one]).T.astype(float))
    order = np.argsort(length, kind="stable")
    one, other = one[order], other[order]
    first = _first_seen(one, other, edges, closing, xy)
    if first is None:
        return
    yield first
    if ring.touching:
        return
    apart = (one != first[0]) & (other != first[1])
    one, other = one[apart], other[apart]
    away = ((xy[other] - xy[one]) * (xy[first[1]] - xy[first[0]]).astype(float)).sum(axis=1) < 0.0
    edges = np.concatenate([edges, [first]])
    for some in (away, ~away):
        second = _first_seen(one[some], other[some], edges, closing, xy)
        if second is not None:
            yield second
            return


def _sides_of(ring: NodeRing, edges: Ints) -> tuple[Ints, Ints]:
    """Return the nodes of a face from which a ring may be welded, and those to which.

    Parts that hang on a loop that touches the rest hang with it: these are the nodes that the rest
    is reached from through the common node only.
    """
    nodes, index = np.unique(edges, return_inverse=True)
    if not ring.touching:
        of_ring = np.isin(nodes, ring.nodes)
        return nodes[of_ring], nodes[~of_ring]
    index = index.reshape(-1, 2)
    shared = np.searchsorted(nodes, ring.nodes[0])
    index = index[(index != shared).all(axis=1)]
    part = connected(index[:, 0], index[:, 1], len(nodes))
    of_ring = part == part[np.searchsorted(nodes, ring.nodes[1])]
    return nodes[of_ring], nodes[~of_ring & (np.arange(len(nodes)) != shared)]


def _first_seen(
    one: Ints, other: Ints, edges: Ints, closing: Ints, xy: Ints
) -> tuple[int, int] | None:
    """Return the first pair of nodes (k,) that see each other inside the face of ``edges``."""
    ends = 2 * xy[closing[:, 0]], 2 * xy[closing[:, 1]]
    a, b = xy[edges[:, 0]], xy[edges[:, 1]]
    nodes = np.unique(edges)
    known = {(int(p), int(q)) for p, q in np.concatenate([edges, edges[:, ::-1]])}
    for p, q in zip(one.tolist(), other.tolist(), strict=True):
        if (
            (p, q) not in known
            and _inside(xy[p] + xy[q], *ends)
            and _sees(xy[p], xy[q], a, b, xy[nodes])
        ):
            return p, q
    return None


def _sees(p: Ints, q: Ints, a: Ints, b: Ints, nodes: Ints) -> bool:
    """Return whether a straight line from p to q meets no edge a-b (k, 2) and no node between."""
    of_a, of_b = _turn(p, q, a), _turn(p, q, b)
    of_p, of_q = _turn(a, b, p), _turn(a, b, q)
    if ((of_a * of_b < 0) & (of_p * of_q < 0)).any():
        return False
    on = _turn(p, q, nodes) == 0
    along = ((nodes[on] - p).astype(float) * (q - p)).sum(axis=1)
    return not ((along > 0.0) & (along < float(((q - p).astype(float) ** 2).sum()))).any()


def _turn(a: Ints, b: Ints, at: Ints) -> Ints:
    """Return on which side of lines from a to b points lie: 1 left, 0 on it, -1; any one single."""
    along, to = b - a, at - a
    return np.sign(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0])


def _inside(at: Ints, a: Ints, b: Ints) -> bool:
    """Return whether a point lies inside edges a-b (k, 2): a ray crosses an odd number of them."""
    up = (a[:, 1] > at[1]) != (b[:, 1] > at[1])
    turn = _turn(a[up], b[up], at) * np.sign(b[up, 1] - a[up, 1])
    return bool((turn > 0).sum() % 2)


NOTHING = -2
"""Side of an edge where nothing is left: outside of the domain, or excavated."""
ROCK = -1
"""Side of an edge where rock is that belongs to no opening."""


def holders(graph: Graph, loops: Loops) -> Ints:
    """Return the loop around the face of each loop: itself, for a hole the one about it, or -1.

    Shape (nl,); -1 is the outside of everything.
    """
    holder = np.where(loops.area2 > 0, np.arange(len(loops.area2)), -1)
    part = parts_of(graph)
    node = loops.nodes(graph)
    first = node[loops.start[:-1]]
    holes = np.flatnonzero(loops.area2 <= 0)
    if len(holes) < 2:
        return holder
    shells = np.flatnonzero(loops.area2 > 0)
    tree = shapely.STRtree(polygons(graph, loops, shells))
    point = shapely.points(graph.xy[first[holes]].astype(float))
    hole, shell = tree.query(point, predicate="intersects")
    hole, shell = holes[hole], shells[shell]
    other = part[first[hole]] != part[first[shell]]
    hole, shell = hole[other], shell[other]
    # Of the loops about a hole the smallest is the one of its face.
    order = np.lexsort((-loops.area2[shell], hole))
    holder[hole[order]] = shell[order]
    return holder


def polygons(graph: Graph, loops: Loops, which: Ints) -> NDArray[Any]:
    """Return loops (k,) as shapely polygons without holes, in cells, shape (k,)."""
    entry, loop = entries(loops.start, which)
    at = graph.xy[loops.nodes(graph)[entry]].astype(float)
    rings = shapely.linearrings(at, indices=loop)
    return np.asarray(shapely.polygons(rings))


def sided(graph: Graph, kinds: Sequence[tuple[int, Any]]) -> Graph:
    """Return the graph with the kinds of the faces on both sides of each edge.

    Faces between which no outline runs are alike: the largest of them decides for all, so that no
    sliver along an outline is taken for something else.  ``kinds`` are kinds and polygons of the
    domain, which comes first, and of openings: a face inside several is of the last.
    """
    if len(graph.edge) == 0:
        return graph
    loops = loops_of(graph)
    holder = holders(graph, loops)
    face = np.where(holder < 0, len(holder), holder)
    side = face[loops.of.reshape(-1, 2)]
    free = ~graph.barrier
    alike = connected(side[free, 0], side[free, 1], len(holder) + 1)
    value = np.full(alike.max() + 1, NOTHING, np.int64)
    shells = np.flatnonzero(loops.area2 > 0)
    order = shells[np.lexsort((loops.area2[shells], alike[shells]))]
    largest = order[np.r_[alike[order][1:] != alike[order][:-1], True][: len(order)]]
    for shell in largest[alike[largest] != alike[-1]]:
        inner = np.flatnonzero((holder == shell) & (loops.area2 <= 0))
        whole = polygons(graph, loops, np.array([shell]))[0]
        for hole in polygons(graph, loops, inner):
            whole = shapely.difference(whole, hole)
        point = shapely.point_on_surface(whole)
        inside = [kind for kind, polygon in kinds if shapely.contains(polygon, point)]
        # Outside of the domain is nothing, even in an opening.
        value[alike[shell]] = inside[-1] if inside[:1] == [ROCK] else NOTHING
    return replace(graph, side=value[alike[side]])
