"""From a planar graph to blocks: tidied loops, coordinates on the exact outlines, their joints."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import shapely

from clast.model.arrays import areas, following, owners, polygons_of
from clast.model.checks import ROUND_OFF
from clast.model.model import Bools, Floats, Ints
from clast.rockmass.faces import NOTHING
from clast.rockmass.noding import Noded
from clast.rockmass.planar import WELD, Graph, loops_of
from clast.rockmass.tidying import (
    CORNER,
    FREE,
    ON_OUTLINE,
    Tiling,
    collapse,
    edges_of,
    merge,
    straighten,
)

CELLS_OF_ROUNDING = 4.0
"""Shorter edges are collapsed, and thinner blocks merged, whatever is asked for."""


def anchors(
    net: Noded, used: Ints, rank: Ints, ends: Floats, on_grid: tuple[Floats, float]
) -> tuple[Ints, tuple[Floats, ...]]:
    """Return the constraint of each node (nn,), and where each may be, m, (nn, 2), the best first.

    Places are corners and crossings of the exact outlines, anywhere on them, and on the grid.
    ``used`` are the nodes that edges have left: where an outline is sharp, its corner and the first
    node beside it may have fallen together.  ``rank`` (n,) is 0 for lines that are not outlines, 1
    for those between rock and rock, 2 for those of the rock itself: where more outlines than two
    fall together, nodes are on these.  ``ends`` (n, 2, 2) are all lines, ``on_grid`` the nodes on
    the grid (nn, 2) and the size of a cell, in m.
    """
    grid, cell = on_grid
    piece, line = net.of[rank[net.of[:, 1]] > 0].T
    node = np.unique(np.stack([net.edge[piece].reshape(-1), np.repeat(line, 2)], axis=1), axis=0)
    node = node[np.isin(node[:, 0], used)]
    # Of the outlines of a node the one of the highest rank is the last.
    node, line = node[np.lexsort((node[:, 1], rank[node[:, 1]], node[:, 0]))].T
    start, along = ends[line, 0], ends[line, 1] - ends[line, 0]
    share = ((grid[node] - start) * along).sum(axis=1) / (along**2).sum(axis=1)
    beside = grid.copy()
    beside[node] = start + np.clip(share, 0.0, 1.0)[:, None] * along
    exact = beside.copy()
    held = np.where(np.bincount(node, minlength=len(net.xy)) > 0, ON_OUTLINE, FREE)
    # Of the nodes that two outlines share one is their crossing; the others may move onto it.
    held[_cross(exact, node, line, (ends, rank))] = CORNER
    # A node next to an end of an outline's line is its corner.
    for end in (0, 1):
        corner = ends[line, end]
        near = np.abs(corner - grid[node]).max(axis=1) <= 0.5001 * cell
        exact[node[near]] = corner[near]
        held[node[near]] = CORNER
    return held, (exact, beside, grid)


def _cross(exact: Floats, node: Ints, line: Ints, lines: tuple[Floats, Ints]) -> Ints:
    """Put the nodes next to where two outlines cross onto the crossing; return them, (k,).

    ``line`` (k,) are outlines of the nodes (k,), by node; ``lines`` all ends and ranks.
    """
    ends, rank = lines
    nearest: dict[tuple[int, int], tuple[float, int, Floats]] = {}
    start = np.flatnonzero(np.r_[True, node[1:] != node[:-1]][: len(node)])
    for first, last in pairwise([*start, len(node)]):
        for k, other_k in combinations(range(first, last), 2):
            pair = int(line[k]), int(line[other_k])
            (a, b), (c, d) = ends[pair[0]], ends[pair[1]]
            one, other = b - a, d - c
            cross = one[0] * other[1] - one[1] * other[0]
            if abs(cross) > 1e-6 * np.hypot(*one) * np.hypot(*other):
                share = ((c[0] - a[0]) * other[1] - (c[1] - a[1]) * other[0]) / cross
                crossing = a + share * one
                gap = float(np.hypot(*(crossing - exact[node[k]])))
                before = nearest.get(pair, (np.inf, 0, crossing))
                nearest[pair] = min(before, (gap, node[k], crossing))
    for pair in sorted(nearest, key=lambda both: (rank[both[0]] + rank[both[1]], both)):
        _, where, crossing = nearest[pair]
        exact[where] = crossing
    return np.array([where for _, where, _ in nearest.values()], np.int64)


@dataclass(frozen=True, kw_only=True)
class Tidied:
    """Blocks as loops of nodes, after short edges and small blocks have been removed."""

    start: Ints
    """Index of each block's first vertex, shape (nb + 1,)."""
    node: Ints
    """Node of each vertex, counter-clockwise by block, shape (nv,)."""
    line: Ints
    """Line of the edge from each vertex to the next; ``WELD``; shape (nv,)."""
    group: Ints
    """Opening that each block is part of, -1 for rock, shape (nb,)."""
    collapsed: Ints
    """Where edges were collapsed, cells, shape (k, 2)."""
    merged: Ints
    """Where blocks were merged, cells, shape (k, 2)."""
    short_edges: int
    """Edges that stayed shorter."""
    small_blocks: int
    """Blocks that stayed smaller."""


def tidied(graph: Graph, held: Ints, joint: Ints, shortest: float, smallest2: float) -> Tidied:
    """Return the blocks of a graph without edges and blocks that are too small, in cells.

    ``held`` (nn,) is the constraint of each node, ``joint`` (n,) the joint of each line.
    """
    faces = loops_of(graph)
    node = faces.nodes(graph).tolist()
    side = faces.sides(graph)
    blocks = np.flatnonzero((side != NOTHING) & (faces.area2 > 0))
    edges = [tuple(pair) for pair in np.sort(graph.edge, axis=1).tolist()]
    tiling = Tiling(
        xy=[tuple(at) for at in graph.xy.tolist()],
        held=held.tolist(),
        loops=[node[faces.start[b] : faces.start[b + 1]] for b in blocks],
        group=side[blocks].tolist(),
        line=dict(zip(edges, graph.line.tolist(), strict=True)),
        outline={e for e, barrier in zip(edges, graph.barrier.tolist(), strict=True) if barrier},
    )
    shortest = max(shortest, CELLS_OF_ROUNDING)
    thin = max(0.5 * shortest, CELLS_OF_ROUNDING)
    smallest2 = max(smallest2, 1.0)
    short = np.sort(graph.edge[graph.lengths < shortest], axis=1)
    left = collapse(tiling, [(a, b) for a, b in short.tolist()], shortest)
    # A block is no narrower than half its area over half its perimeter.
    half = 0.5 * np.add.reduceat(graph.lengths[faces.half >> 1], faces.start[:-1])[blocks]
    size2 = faces.area2[blocks]
    small = np.flatnonzero((size2 < smallest2) | (0.25 * size2 < thin * half))
    kept = merge(tiling, {*small.tolist(), *tiling.changed}, smallest2, thin)
    near = {edge for b in tiling.changed for edge in edges_of(tiling.loops[b])}
    left = collapse(tiling, near | left, shortest)
    kept = merge(tiling, tiling.changed | kept, smallest2, thin)
    straighten(tiling, [*joint.tolist(), WELD])
    loops = [loop for loop in tiling.loops if loop]
    return Tidied(
        start=np.cumsum([0, *(len(loop) for loop in loops)]),
        node=np.array([n for loop in loops for n in loop], np.int64),
        line=np.array([tiling.line[edge] for loop in loops for edge in edges_of(loop)], np.int64),
        group=np.array([g for g, loop in zip(tiling.group, tiling.loops, strict=True) if loop]),
        collapsed=np.array(tiling.collapsed, np.int64).reshape(-1, 2),
        merged=np.array(tiling.merged, np.int64).reshape(-1, 2),
        short_edges=len(left),
        small_blocks=len(kept),
    )


def sound(vertices: Floats, start: Ints) -> Bools:
    """Return which blocks are simple, counter-clockwise polygons, each corner once, (nb,)."""
    polygons = polygons_of(vertices - vertices[start[:-1]][owners(start)], start)
    apart = np.hypot(*(vertices[following(start)] - vertices).T)
    longest = np.maximum.reduceat(apart, start[:-1])
    apart = np.minimum.reduceat(apart, start[:-1])
    valid = shapely.is_valid(polygons) & (areas(vertices, start) > 0.0)
    return np.asarray(valid & (apart > 2.0 * ROUND_OFF * longest))
