"""Short edges collapsed and small blocks merged, on shared nodes: neighbours always agree.

Nothing is done that would make a block cross or touch itself: nodes that cannot be tidied stay, and
are counted.  A node moves only onto a neighbour; nodes of outlines move along their outline only
and its corners stay, so that the domain keeps its shape.
"""

from __future__ import annotations

import heapq
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

Point = tuple[int, int]
Edge = tuple[int, int]

FREE, ON_OUTLINE, CORNER = 0, 1, 2
"""Constraints of a node: none, the outline that it moves along, a corner."""


@dataclass(frozen=True, kw_only=True)
class Tiling:
    """Blocks as loops of shared nodes; the lists change while it is tidied."""

    xy: list[Point]
    """Coordinates of the nodes, cells."""
    held: list[int]
    """Constraint of each node:  ``FREE``, ``ON_OUTLINE`` or ``CORNER``."""
    loops: list[list[int]]
    """Nodes of each block, counter-clockwise; empty where the block has been removed."""
    group: list[int]
    """Group of each block: -1 rock, else an opening; only blocks of one group are merged."""
    line: dict[Edge, int]
    """Line of each edge, by its nodes in order; later lines have higher numbers."""
    outline: set[Edge]
    """Edges along outlines."""
    around: dict[int, set[int]] = field(default_factory=dict)
    """Blocks that have each node."""
    collapsed: list[Point] = field(default_factory=list)
    """Where edges were collapsed."""
    merged: list[Point] = field(default_factory=list)
    """Where blocks were merged, or shrank to nothing with an edge."""
    changed: set[int] = field(default_factory=set)
    """Blocks that have changed so far."""

    def __post_init__(self) -> None:
        around: dict[int, set[int]] = defaultdict(set)
        for block, loop in enumerate(self.loops):
            for node in loop:
                around[node].add(block)
        self.around.update(around)

    def length(self, edge: Edge) -> float:
        """Return the length of an edge, cells."""
        (ax, ay), (bx, by) = self.xy[edge[0]], self.xy[edge[1]]
        return math.hypot(bx - ax, by - ay)


def ordered(a: int, b: int) -> Edge:
    """Return an edge by its two nodes, the lower first."""
    return (a, b) if a < b else (b, a)


def pairs_of(loop: list[int]) -> Iterator[Edge]:
    """Return each node of a loop with the one after it."""
    return zip(loop, loop[1:] + loop[:1], strict=True)


def edges_of(loop: list[int]) -> list[Edge]:
    """Return the edges of a loop, each with the lower node first."""
    return [ordered(a, b) for a, b in pairs_of(loop)]


def beside(loop: list[int], node: int) -> tuple[int, int]:
    """Return the nodes before and after one of a loop."""
    at = loop.index(node)
    return loop[at - 1], loop[(at + 1) % len(loop)]


def area2(loop: list[int], xy: list[Point]) -> int:
    """Return twice the area of a loop, cells2: above zero counter-clockwise."""
    total = 0
    ax, ay = xy[loop[-1]]
    for node in loop:
        bx, by = xy[node]
        total += ax * by - ay * bx
        ax, ay = bx, by
    return total


def collapse(tiling: Tiling, edges: Iterable[Edge], shortest: float) -> set[Edge]:
    """Collapse those of ``edges`` that are shorter, the shortest first; return those that stay.

    ``shortest`` in cells; edges that become short by it are collapsed, too.
    """
    short = [(tiling.length(edge), edge) for edge in edges if edge in tiling.line]
    short = [one for one in short if one[0] < shortest]
    heapq.heapify(short)
    left: set[Edge] = set()
    while short:
        length, edge = heapq.heappop(short)
        if edge not in tiling.line or tiling.length(edge) != length:
            continue
        node = _collapse_edge(tiling, edge)
        if node is None:
            left.add(edge)
            continue
        for block in tiling.around[node]:
            for other in edges_of(tiling.loops[block]):
                size = tiling.length(other)
                if node in other and size < shortest:
                    heapq.heappush(short, (size, other))
    return {edge for edge in left if edge in tiling.line and tiling.length(edge) < shortest}


def _collapse_edge(tiling: Tiling, edge: Edge) -> int | None:
    """Collapse an edge where that leaves sound blocks; return the node that it becomes, or None."""
    held = tiling.held
    a, b = sorted(edge, key=lambda node: (held[node], len(tiling.around[node]), -node))
    for moved, kept in ((a, b), (b, a)):
        movable = held[moved] == FREE or (held[moved] == ON_OUTLINE and edge in tiling.outline)
        if movable and _move_onto(tiling, moved, kept):
            tiling.collapsed.append(tiling.xy[kept])
            return kept
    return None


def _move_onto(tiling: Tiling, moved: int, kept: int) -> bool:
    """Replace a node by another where every block stays simple; return whether it was done."""
    changed: dict[int, list[int]] = {}
    for block in tiling.around[moved]:
        loop = tiling.loops[block]
        if kept in loop and kept in beside(loop, moved):
            loop = [node for node in loop if node != moved]
            loop = loop if len(loop) > 2 else []
        else:
            loop = [kept if node == moved else node for node in loop]
        if loop and not _sound(loop, tiling.xy, kept):
            return False
        changed[block] = loop
    # Two blocks with one edge in the same direction would lie on each other.
    seen: set[Edge] = set()
    for block in set(changed) | tiling.around[kept]:
        for pair in pairs_of(changed.get(block, tiling.loops[block])):
            if kept in pair:
                if pair in seen:
                    return False
                seen.add(pair)
    for block in changed:
        _forget(tiling, block)
    for block, loop in changed.items():
        if not loop:
            tiling.merged.append(tiling.xy[kept])
        _set(tiling, block, loop)
    _rename_edges(tiling, moved, kept)
    return True


def _rename_edges(tiling: Tiling, moved: int, kept: int) -> None:
    """Give the edges of a node that was moved to the node that it became."""
    near = {kept}
    for block in tiling.around[kept]:
        near.update(beside(tiling.loops[block], kept))
    for other in near:
        old, new = ordered(moved, other), ordered(kept, other)
        if old not in tiling.line:
            continue
        line, outlined = tiling.line.pop(old), old in tiling.outline
        tiling.outline.discard(old)
        if other == kept:
            continue
        # Where two edges fall together the later line has the joint.
        tiling.line[new] = max(line, tiling.line.get(new, line))
        if outlined:
            tiling.outline.add(new)


def _forget(tiling: Tiling, block: int) -> None:
    for node in tiling.loops[block]:
        tiling.around[node].discard(block)


def _set(tiling: Tiling, block: int, loop: list[int]) -> None:
    tiling.changed.add(block)
    tiling.loops[block] = loop
    for node in loop:
        tiling.around[node].add(block)


def _sound(loop: list[int], xy: list[Point], node: int) -> bool:
    """Return whether a loop is counter-clockwise, and simple at a node that has come into it."""
    if len(set(loop)) < len(loop) or area2(loop, xy) <= 0:
        return False
    before, after = beside(loop, node)
    return _crossing_free(loop, xy, before, node) and _crossing_free(loop, xy, node, after)


def _crossing_free(loop: list[int], xy: list[Point], a: int, b: int) -> bool:
    """Return whether an edge a-b of a loop touches no other but its neighbours, at its ends."""
    for c, d in pairs_of(loop):
        if a in (c, d) and b in (c, d):
            continue
        if a in (c, d) or b in (c, d):
            # Neighbours share a corner: they must not fold back.
            far, near = (c, d) if d in (a, b) else (d, c)
            if _on(xy[far], xy[a], xy[b]) or _on(xy[a if near == b else b], xy[c], xy[d]):
                return False
        elif _touch(xy[a], xy[b], xy[c], xy[d]):
            return False
    return True


def turn(a: Point, b: Point, c: Point) -> int:
    """Return twice the area of a triangle, cells2: above zero where c lies left of a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _between(at: Point, a: Point, b: Point) -> bool:
    return min(a[0], b[0]) <= at[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= at[1] <= max(
        a[1], b[1]
    )


def _on(at: Point, a: Point, b: Point) -> bool:
    return at not in (a, b) and turn(a, b, at) == 0 and _between(at, a, b)


def _touch(a: Point, b: Point, c: Point, d: Point) -> bool:
    one, other = turn(a, b, c), turn(a, b, d)
    three, four = turn(c, d, a), turn(c, d, b)
    if ((one > 0) != (other > 0) and one and other) and (
        (three > 0) != (four > 0) and three and four
    ):
        return True
    return (
        (one == 0 and _between(c, a, b))
        or (other == 0 and _between(d, a, b))
        or (three == 0 and _between(a, c, d))
        or (four == 0 and _between(b, c, d))
    )


def merge(tiling: Tiling, blocks: Iterable[int], smallest2: float, narrowest: float) -> set[int]:
    """Merge those of ``blocks`` that are small, the smallest first; return those that stay.

    Small are blocks of less than ``smallest2`` (twice the area), or narrower than ``narrowest``,
    the shorter side of the rectangle of the same area and perimeter, in cells.  A small block joins
    the neighbour with which it shares the longest edge, across welds first.
    """
    waiting = [
        (area2(tiling.loops[block], tiling.xy), block)
        for block in blocks
        if tiling.loops[block] and _small(tiling, block, smallest2, narrowest)
    ]
    heapq.heapify(waiting)
    left: set[int] = set()
    while waiting:
        size, block = heapq.heappop(waiting)
        loop = tiling.loops[block]
        if not loop or area2(loop, tiling.xy) != size:
            continue
        joined = _merge_block(tiling, block)
        if joined is None:
            left.add(block)
            continue
        left.discard(joined)
        if _small(tiling, joined, smallest2, narrowest):
            heapq.heappush(waiting, (area2(tiling.loops[joined], tiling.xy), joined))
    return {block for block in left if tiling.loops[block]}


def _small(tiling: Tiling, block: int, smallest2: float, narrowest: float) -> bool:
    loop = tiling.loops[block]
    size = area2(loop, tiling.xy)
    if size < smallest2:
        return True
    half = 0.5 * sum(tiling.length(edge) for edge in edges_of(loop))
    return 0.5 * (half - math.sqrt(max(0.0, half * half - 2.0 * size))) < narrowest


def _merge_block(tiling: Tiling, block: int) -> int | None:
    """Join a block to a neighbour, the best that leaves a simple loop; return it, or None."""
    shared: dict[int, float] = defaultdict(float)
    welded: set[int] = set()
    loop = tiling.loops[block]
    for a, b in pairs_of(loop):
        for other in tiling.around[a] & tiling.around[b]:
            if other != block and tiling.group[other] == tiling.group[block]:
                edge = ordered(a, b)
                if beside(tiling.loops[other], b)[1] == a:
                    shared[other] += tiling.length(edge)
                    if tiling.line[edge] < 0:
                        welded.add(other)
    for other in sorted(shared, key=lambda one: (one not in welded, -shared[one], one)):
        joined = _join_loops(loop, tiling.loops[other])
        if joined is None:
            continue
        tiling.merged.append(tiling.xy[loop[0]])
        inner = set(edges_of(loop)) & set(edges_of(tiling.loops[other]))
        _forget(tiling, block)
        _forget(tiling, other)
        _set(tiling, block, [])
        _set(tiling, other, joined)
        for edge in inner:
            del tiling.line[edge]
            tiling.outline.discard(edge)
        return other
    return None


def _join_loops(one: list[int], other: list[int]) -> list[int] | None:
    """Return the loop of two blocks without their common edges; None if it is not simple."""
    back = {(b, a) for a, b in pairs_of(other)}
    shared = [pair in back for pair in pairs_of(one)]
    starts = [k for k in range(len(one)) if shared[k] and not shared[k - 1]]
    if len(starts) != 1:
        return None
    # One chain: one's loop from its end on to its start, then the other's in the same sense.
    begin, count = starts[0], sum(shared)
    first = [one[(begin + count + k) % len(one)] for k in range(len(one) - count)]
    at = other.index(one[begin])
    second = [other[(at + k) % len(other)] for k in range(len(other) - count)]
    joined = first + second
    return joined if len(set(joined)) == len(joined) else None


def straighten(tiling: Tiling, joint: Sequence[int]) -> None:
    """Take out vertices of changed blocks that only one straight edge needs.

    ``joint`` (n,) is the joint of each line, that of welds last: an edge has one joint.
    Rounding bends lines by less than a cell: a bend goes where the straight edge meets no other.
    """
    for node in sorted({node for block in tiling.changed for node in tiling.loops[block]}):
        if tiling.around[node] and tiling.held[node] != CORNER:
            _take_out(tiling, node, joint)


def _take_out(tiling: Tiling, node: int, joint: Sequence[int]) -> None:
    blocks = sorted(tiling.around[node])
    ends = {other for block in blocks for other in beside(tiling.loops[block], node)}
    if len(blocks) > 2 or len(ends) != 2 or min(len(tiling.loops[block]) for block in blocks) < 4:
        return
    a, b = sorted(ends)
    one, other, new = ordered(a, node), ordered(node, b), ordered(a, b)
    if new in tiling.line or joint[tiling.line[one]] != joint[tiling.line[other]]:
        return
    if (one in tiling.outline) != (other in tiling.outline):
        return
    (ax, ay), (x, y), (bx, by) = tiling.xy[a], tiling.xy[node], tiling.xy[b]
    if (ax - x) * (bx - x) + (ay - y) * (by - y) >= 0:
        return
    loops = [[n for n in tiling.loops[block] if n != node] for block in blocks]
    if turn(tiling.xy[a], tiling.xy[b], tiling.xy[node]) != 0 and not (
        tiling.line[one] == tiling.line[other]
        and all(area2(loop, tiling.xy) > 0 for loop in loops)
        and all(_crossing_free(loop, tiling.xy, a, b) for loop in loops)
    ):
        return
    for block, loop in zip(blocks, loops, strict=True):
        tiling.loops[block] = loop
    tiling.around[node].clear()
    tiling.line[new] = max(tiling.line.pop(one), tiling.line.pop(other))
    if one in tiling.outline:
        tiling.outline.difference_update((one, other))
        tiling.outline.add(new)
