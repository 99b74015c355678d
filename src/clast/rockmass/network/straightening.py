"""Vertices on straight edges that are not junctions, taken out of the blocks on both sides."""

from __future__ import annotations

from collections.abc import Sequence

from clast.rockmass.network.tidying import CORNER, Tiling, crossing_free, ordered, turn


def straighten(tiling: Tiling, joint: Sequence[int]) -> int:
    """Take out vertices of changed blocks that only one straight edge needs; return how many.

    ``joint`` (n,) is the joint of each line, that of welds last: an edge has one joint.
    Rounding bends lines by less than a cell: a bend goes where the straight edge meets no other.
    """
    count = 0
    for node in sorted({node for block in tiling.changed for node in tiling.loops[block]}):
        if tiling.around[node] and tiling.held[node] != CORNER and _taken_out(tiling, node, joint):
            count += 1
    return count


def _taken_out(tiling: Tiling, node: int, joint: Sequence[int]) -> bool:
    blocks = sorted(tiling.around[node])
    if len(blocks) > 2:
        return False
    ends = set()
    for block in blocks:
        loop = tiling.loops[block]
        at = loop.index(node)
        ends |= {loop[at - 1], loop[(at + 1) % len(loop)]}
        if len(loop) < 4:
            return False
    if len(ends) != 2:
        return False
    a, b = sorted(ends)
    one, other, new = ordered(a, node), ordered(node, b), ordered(a, b)
    if new in tiling.line or joint[tiling.line[one]] != joint[tiling.line[other]]:
        return False
    if (one in tiling.outline) != (other in tiling.outline):
        return False
    (ax, ay), (x, y), (bx, by) = tiling.xy[a], tiling.xy[node], tiling.xy[b]
    if (ax - x) * (bx - x) + (ay - y) * (by - y) >= 0:
        return False
    bent = turn(tiling.xy[a], tiling.xy[b], tiling.xy[node]) != 0
    if bent and tiling.line[one] != tiling.line[other]:
        return False
    loops = [[n for n in tiling.loops[block] if n != node] for block in blocks]
    if bent and not all(crossing_free(loop, tiling.xy, a, b) for loop in loops):
        return False
    for block, loop in zip(blocks, loops, strict=True):
        tiling.loops[block] = loop
    tiling.around[node].clear()
    tiling.line[new] = max(tiling.line.pop(one), tiling.line.pop(other))
    if one in tiling.outline:
        tiling.outline.difference_update((one, other))
        tiling.outline.add(new)
    return True
