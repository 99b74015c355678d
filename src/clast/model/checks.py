"""Faults that make a system of blocks impossible to simulate, found before the first step.

Every check names the block (its number from 1 and its name) and the vertex (its number from 1 in
the loop and its coordinates) and the remedy.  All of them work on flat arrays of all blocks at
once: ten thousand blocks are checked within a second or two.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.errors import FAULTS_LISTED_MAX, ModelError, raise_all, shortened
from clast.model import ranges
from clast.model.arrays import areas, entries, following, owners, polygons_of
from clast.model.model import Bools, Floats, Ints, StartOverlaps
from clast.model.surroundings import Repair

Geometries = NDArray[Any]
"""Array of shapely geometries."""

ROUND_OFF = 1e-9
"""Distances and areas below this fraction of a block's extent, or its square, are none."""
OVERLAP_TOLERANCE = 1e-6
"""Overlaps and distances below this share of the block's size are round-off."""
BESIDE_SHARE = 1e-3
"""Places so far beside a block belong to it, as a share of its size."""
PENETRATION_MAX = 0.05
"""Overlaps above this share of the narrower block's width are not contact penetration."""
BLOCK_WIDTH_MIN = 1e-9
"""Blocks narrower than this, m, are not blocks."""


@dataclass(frozen=True)
class BlockOutlines:
    """The blocks' polygons as flat arrays, with the names by which messages call them."""

    names: tuple[str, ...]
    """Name of each block."""
    start: Ints
    """Index of each block's first vertex, the last entry is the vertex count, shape (n + 1,)."""
    vertices: Floats
    """Vertices relative to ``origin``, m, shape (nv, 2)."""
    origin: Floats
    """Point that the vertices are relative to, m, shape (2,)."""

    def turned(self, clockwise: Bools) -> BlockOutlines:
        """Return the outlines with some loops (n,) in the other order, first vertices as before."""
        vertex = np.arange(len(self.vertices))
        within = vertex - self.start[self.owner]
        count = np.diff(self.start)[self.owner]
        back = self.start[self.owner] + (count - within) % count
        order = np.where(clockwise[self.owner], back, vertex)
        return replace(self, vertices=np.ascontiguousarray(self.vertices[order]))

    def turned_edges(self, clockwise: Bools) -> Ints:
        """Return which edge each one was before some loops (n,) were turned, shape (nv,)."""
        edge = np.arange(len(self.vertices))
        back = self.start[self.owner] + self.start[self.owner + 1] - 1 - edge
        return np.where(clockwise[self.owner], back, edge)

    def label(self, block: int) -> str:
        """Return how a message calls a block: its number from 1, and its name."""
        number, name = str(block + 1), shortened(self.names[block])
        return f"block {number}" if name == number else f"block {number} '{name}'"

    def vertex_label(self, vertex: int) -> str:
        """Return how a message calls a vertex: block, number from 1 in its loop, coordinates."""
        block = int(np.searchsorted(self.start, vertex, side="right")) - 1
        number = vertex - int(self.start[block]) + 1
        return f"{self.label(block)}, vertex {number} at {point_text(self.at(vertex))}"

    def at(self, vertex: int) -> Floats:
        """Return the coordinates of a vertex as the user gave them, m, shape (2,)."""
        return np.asarray(self.vertices[vertex] + self.origin)

    @property
    def owner(self) -> Ints:
        """Block of each vertex, shape (nv,)."""
        return owners(self.start)

    @property
    def following(self) -> Ints:
        """Index of the vertex after each vertex in its loop, shape (nv,)."""
        return following(self.start)

    @property
    def extent(self) -> Floats:
        """Diagonal of each block's bounding box, m, shape (n,)."""
        low = np.minimum.reduceat(self.vertices, self.start[:-1])
        high = np.maximum.reduceat(self.vertices, self.start[:-1])
        return np.hypot(*(high - low).T)

    @property
    def area(self) -> Floats:
        """Signed area of each block, positive when counter-clockwise, m2, shape (n,)."""
        return areas(self.vertices, self.start)

    @property
    def top(self) -> float:
        """Height y of the highest vertex in the coordinates of the case, m."""
        return float(self.vertices[:, 1].max() + self.origin[1])

    @property
    def heights(self) -> Floats:
        """Height y of the centroid of each block in the coordinates of the case, m, shape (n,)."""
        points = shapely.centroid(self.polygons())
        return np.asarray(shapely.get_y(points) + self.origin[1])

    def polygons(self) -> Geometries:
        """Return the blocks as shapely polygons, shape (n,)."""
        return polygons_of(self.vertices, self.start)


@dataclass(frozen=True, kw_only=True)
class RepairedBlocks:
    """The same blocks with other vertices."""

    outlines: BlockOutlines
    """The blocks, counter-clockwise."""
    edge: Ints
    """Edge as given that the edge from each vertex to the next is, or is part of, shape (nv,)."""
    repairs: tuple[Repair, ...] = ()
    """The repairs."""
    moved: float = 0.0
    """How far a vertex moved at most, m."""
    tolerance: float = 0.0
    """Distance within which things are meant to touch, m."""


def point_text(at: Sequence[float] | Floats) -> str:
    """Return coordinates as a message shows them."""
    return f"({float(at[0]):.9g}, {float(at[1]):.9g})"


def _refuse_all(bad: Ints, fault: Callable[[int], tuple[str, str]], remedy: str) -> None:
    """Raise one ModelError for all that is ``bad`` (k,), if anything is.

    ``fault`` gives the place of one of them and the fault there.
    """
    if len(bad) == 0:
        return
    where, what = fault(int(bad[0]))
    if len(bad) > 1:
        lines = [
            f"  {place}: {said}" for place, said in map(fault, bad[:FAULTS_LISTED_MAX].tolist())
        ]
        if len(bad) > FAULTS_LISTED_MAX:
            lines.append(f"  and {len(bad) - FAULTS_LISTED_MAX} more")
        where, what = "geometry", "\n".join([f"{len(bad)} things to put right", *lines])
    raise ModelError(what, where=where, remedy=remedy)


def check_corner_count(outlines: BlockOutlines) -> None:
    """Refuse blocks with fewer than three vertices, and a system without any block."""
    if not outlines.names:
        raise ModelError(
            "there are no blocks",
            where="geometry",
            remedy="give [geometry] vertices and blocks, or one [[block]] table for each block",
        )
    counts = np.diff(outlines.start)
    _refuse_all(
        np.flatnonzero(counts < 3),
        lambda block: (outlines.label(block), f"has {counts[block]} vertices"),
        "a block needs at least 3 vertices, counter-clockwise",
    )


def check_coordinates(outlines: BlockOutlines) -> None:
    """Refuse coordinates that are not numbers, or too large to be intended."""
    _refuse_all(
        np.flatnonzero(~np.isfinite(outlines.vertices).all(axis=1)),
        lambda vertex: (outlines.vertex_label(vertex), "is not a finite number"),
        "give finite coordinates, in m",
    )
    limit = ranges.COORDINATE.high
    _refuse_all(
        np.flatnonzero(np.abs(outlines.vertices).max(axis=1) > limit),
        lambda vertex: (outlines.vertex_label(vertex), "is too far away to be intended"),
        f"give coordinates in m, at most {limit:g}",
    )


def check_polygons(outlines: BlockOutlines, polygons: Geometries) -> None:
    """Refuse loops that are not polygons, whichever way they run.

    These are loops with duplicate vertices, without area, or that cross or touch themselves.
    """
    extent, area = outlines.extent, outlines.area

    def said(what: Callable[[int], str]) -> Callable[[int], tuple[str, str]]:
        return lambda block: (outlines.label(block), what(block))

    _refuse_all(
        np.flatnonzero(extent < BLOCK_WIDTH_MIN),
        said(lambda block: f"is only {extent[block]:.3g} m wide"),
        f"give coordinates in m; a block is at least {BLOCK_WIDTH_MIN:g} m wide",
    )
    # Refuse consecutive vertices that are the same point.
    following = outlines.following
    side = np.hypot(*(outlines.vertices[following] - outlines.vertices).T)
    number = following - outlines.start[outlines.owner] + 1
    _refuse_all(
        np.flatnonzero(side <= ROUND_OFF * outlines.extent[outlines.owner]),
        lambda vertex: (
            outlines.vertex_label(vertex),
            f"is the same point as vertex {number[vertex]}",
        ),
        "remove one of the two (a loop closes by itself, without its first vertex)",
    )
    _refuse_all(
        np.flatnonzero(shapely.area(shapely.convex_hull(polygons)) <= ROUND_OFF * extent**2),
        said(lambda _: "has no area: its vertices lie on one line"),
        "give it at least 3 vertices that span an area",
    )
    _refuse_all(
        np.flatnonzero(~shapely.is_valid(polygons)),
        said(lambda block: _crossing(outlines, block)),
        "order the vertices along the outline, counter-clockwise, each once",
    )
    _refuse_all(
        np.flatnonzero(np.abs(area) <= ROUND_OFF * extent**2),
        said(lambda block: f"has no area ({abs(area[block]):.3g} m2)"),
        "give it vertices that span an area, or leave the block out",
    )


def turned_note(outlines: BlockOutlines, clockwise: Bools) -> tuple[str, ...]:
    """Return which loops were turned round, as a note, or nothing."""
    turned = np.flatnonzero(clockwise)
    if len(turned) == 0:
        return ()
    named = ", ".join(outlines.label(int(block)) for block in turned[:FAULTS_LISTED_MAX])
    more = ", ..." if len(turned) > FAULTS_LISTED_MAX else ""
    if len(turned) == 1:
        return (f"1 loop runs clockwise and was reversed: {named}",)
    return (f"{len(turned)} loops run clockwise and were reversed: {named}{more}",)


def _crossing(outlines: BlockOutlines, block: int) -> str:
    """Return which two edges of a loop cross or touch, in words."""
    rows = np.arange(outlines.start[block], outlines.start[block + 1])
    here = outlines.vertices[rows]
    count = len(rows)
    edges = shapely.linestrings(np.stack([here, np.roll(here, -1, axis=0)], axis=1))
    first, second = _ordered(*shapely.STRtree(edges).query(edges, predicate="intersects"))
    apart = (second > first + 1) & ~((first == 0) & (second == count - 1))
    first, second = first[apart], second[apart]
    meet = np.lexsort((second, first))
    if len(meet) == 0:
        return "its loop folds back on itself"
    one, other = int(first[meet[0]]), int(second[meet[0]])
    where = shapely.centroid(shapely.intersection(edges[one], edges[other]))
    at = np.array([where.x, where.y]) + outlines.origin
    return (
        f"its loop crosses or touches itself: edge {one + 1}-{one + 2} meets "
        f"edge {other + 1}-{(other + 1) % count + 1} at {point_text(at)}"
    )


def check_overlaps(
    outlines: BlockOutlines, polygons: Geometries, apart: Collection[tuple[int, int]]
) -> StartOverlaps:
    """Return the pairs that overlap by more than round-off; refuse deep ones.

    Pairs that are kept ``apart``, the lower block first, may overlap as they like.
    Shared edges and corners are normal, and so is the penetration that contacts need to carry:
    blocks at the end of a run lie a little in each other.
    """
    first, second = shapely.STRtree(polygons).query(polygons)
    first, second = _ordered(first, second)
    if apart:
        pairs = zip(first.tolist(), second.tolist(), strict=True)
        meets = np.array([pair not in apart for pair in pairs], np.bool_)
        first, second = first[meets], second[meets]
    size = np.sqrt(outlines.area)
    finest = ROUND_OFF * 4.0 * np.maximum(outlines.extent[first], outlines.extent[second])
    limit = np.maximum(OVERLAP_TOLERANCE * np.minimum(size[first], size[second]), finest)
    vertices, start = outlines.vertices, outlines.start
    # Which pairs have bounding boxes that share more than ``limit`` in both directions.
    low = np.minimum.reduceat(outlines.vertices, outlines.start[:-1])
    high = np.maximum.reduceat(outlines.vertices, outlines.start[:-1])
    shared = np.minimum(high[first], high[second]) - np.maximum(low[first], low[second])
    deep = np.flatnonzero(shared.min(axis=1) > limit)
    deep = deep[~touching_at_most(vertices, start, first[deep], second[deep], limit[deep])]
    first, second, limit = first[deep], second[deep], limit[deep]
    pair, width, middle = common_parts(vertices, start, first, second)
    over = width > limit[pair]
    pair, width, middle = pair[over], width[over], middle[over]
    slender = widths(polygons)
    allowed = PENETRATION_MAX * np.minimum(slender[first], slender[second])
    bad = np.flatnonzero(width > allowed[pair])
    if len(bad):
        worst = bad[np.argmax(width[bad])]
        _refuse_overlap(
            outlines,
            (int(first[pair[worst]]), int(second[pair[worst]])),
            float(width[worst]),
            middle[worst] + outlines.origin,
            others=len(np.unique(pair[bad])) - 1,
        )
    deepest = np.zeros(len(first))
    np.maximum.at(deepest, pair, width)
    some = np.unique(pair)
    return StartOverlaps(
        pair=np.stack([first[some], second[some]], axis=1).astype(np.int64), depth=deepest[some]
    )


def _refuse_overlap(
    outlines: BlockOutlines, pair: tuple[int, int], depth: float, at: Floats, others: int
) -> NoReturn:
    """Raise ModelError for two blocks that lie deep in each other."""
    more = f"; so do {others} more pairs" if others else ""
    raise ModelError(
        f"overlaps {outlines.label(pair[1])} to a depth of {depth:.3g} m near "
        f"{point_text(at)}{more}",
        where=outlines.label(pair[0]),
        remedy="move or cut the blocks so that they do not overlap; where coordinates are rounded, "
        "[repair] with a tolerance joins neighbours",
    )


def _ordered(first: Ints, second: Ints) -> tuple[Ints, Ints]:
    """Return each pair once, the lower block first."""
    once = first < second
    return first[once], second[once]


def locate(
    shapes: Geometries,
    named: Ints,
    where: Callable[[int], str],
    outlines: BlockOutlines,
    tree: shapely.STRtree,
    tolerance: float = 0.0,
) -> Ints:
    """Return the block that carries each point or line, shape (k,).

    ``named`` (k,) holds the block that the user named, -1 where none was; ``where`` gives the label
    of a shape for messages; ``tree`` is that of the blocks' polygons.  A point that no block
    carries belongs to the one that lies within the ``tolerance`` of it, m, or BESIDE_SHARE of the
    block if that is more.
    """
    reach = OVERLAP_TOLERANCE * np.sqrt(np.abs(outlines.area))
    carrying = _carrying(shapes, reach, tree)
    lacking = [
        k
        for k, blocks in enumerate(carrying)
        if len(blocks) == 0 or (named[k] >= 0 and named[k] not in blocks)
    ]
    if lacking:
        wide = beside_reach(outlines, tolerance)
        for k, blocks in zip(lacking, _carrying(shapes[lacking], wide, tree), strict=True):
            if named[k] < 0 or named[k] in blocks:
                carrying[k] = blocks
    found, errors = [], []
    for k, blocks in enumerate(carrying):
        try:
            found.append(_carrier(shapes[k], int(named[k]), blocks, where(k), outlines, tree))
        except ModelError as error:
            errors.append(error)
    raise_all(errors)
    return np.array(found, dtype=np.int64)


def beside_reach(outlines: BlockOutlines, tolerance: float) -> Floats:
    """Return how far beside each block places belong to it, m, shape (n,)."""
    return np.maximum(tolerance, BESIDE_SHARE * np.sqrt(np.abs(outlines.area)))


def _carrying(shapes: Geometries, reach: Floats, tree: shapely.STRtree) -> list[Ints]:
    """Return the blocks that hold each shape, each block widened by ``reach`` (n,), m."""
    near, block = tree.query(shapes, predicate="dwithin", distance=float(reach.max()))
    inside = shapely.covers(shapely.buffer(tree.geometries[block], reach[block]), shapes[near])
    near, block = near[inside], block[inside]
    order = np.lexsort((block, near))
    near, block = near[order], block[order]
    return list(np.split(block, np.searchsorted(near, np.arange(1, len(shapes)))))[: len(shapes)]


def _carrier(
    shape: Any,
    named: int,
    carrying: Ints,
    where: str,
    outlines: BlockOutlines,
    tree: shapely.STRtree,
) -> int:
    """Return the block of one point or line from those that hold it, or say why there is none."""
    labels = ", ".join(outlines.label(int(block)) for block in carrying)
    if named >= 0:
        if named in carrying:
            return named
        distance = float(shapely.distance(shape, tree.geometries[named]))
        holder = f"; it lies on {labels}" if labels else ""
        gap = f" ({distance:.3g} m from it)" if distance > 0.0 else ""
        raise ModelError(
            f"does not lie on {outlines.label(named)}{gap}{holder}",
            where=where,
            remedy="move it, or name the block that it lies on",
        )
    if len(carrying) == 1:
        return int(carrying[0])
    if len(carrying) > 1:
        example = outlines.names[int(carrying[0])]
        raise ModelError(
            f"lies on the common boundary of {labels}",
            where=where,
            remedy=f'name the one that it moves with, e.g. block = "{example}"',
        )
    closest = int(tree.nearest(shape))
    distance = float(shapely.distance(shape, tree.geometries[closest]))
    whole = "outside every block" if distance > 0.0 else "not wholly inside any block"
    raise ModelError(
        f"lies {whole}; the nearest is {outlines.label(closest)}, {distance:.3g} m away",
        where=where,
        remedy="move it into a block or onto its boundary",
    )


def touching_at_most(
    vertices: Floats, start: Ints, first: Ints, second: Ints, thickness: Floats
) -> NDArray[np.bool_]:
    """Return True for pairs whose common area lies in a strip thinner than ``thickness`` (m,).

    The strips tried run along the edges of both blocks: of convex blocks that touch, one fits.
    ``vertices`` (nv, 2) by block in m; ``first`` and ``second`` (m,) are blocks.
    """
    count = np.diff(start)
    normal = _normals(vertices, start)
    apart = np.zeros(len(first), np.bool_)
    # Blocks of more corners are overlaid at once: no line along an edge is likely to part them
    few = np.maximum(count[first], count[second]) <= 200
    for one, other in ((first, second), (second, first)):
        left = np.flatnonzero(few & ~apart)
        if len(left) == 0:
            break
        edge, pair = entries(start, one[left])
        row_start = np.flatnonzero(np.diff(pair, prepend=-1))
        _, far = _span(normal[edge], one[left][pair], vertices, start)
        near, _ = _span(normal[edge], other[left][pair], vertices, start)
        apart[left] = np.maximum.reduceat(near - far, row_start) >= -thickness[left]
    return apart


def _normals(vertices: Floats, start: Ints) -> Floats:
    """Return the unit outward normal of each edge of counter-clockwise loops, shape (nv, 2)."""
    edge = vertices[following(start)] - vertices
    return np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.hypot(*edge.T)[:, None]


def _span(direction: Floats, block: Ints, vertices: Floats, start: Ints) -> tuple[Floats, Floats]:
    """Return how far blocks (m,) reach along directions (m, 2): smallest and largest, m, (m,)."""
    count = np.diff(start)[block]
    low, high = np.zeros(len(block)), np.zeros(len(block))
    ends = np.cumsum(count)
    begin = 0
    while begin < len(block):
        done = ends[begin] - count[begin]
        # Vertices that are projected at once
        end = max(begin + 1, int(np.searchsorted(ends, done + 1_000_000)))
        vertex, row = entries(start, block[begin:end])
        row_start = np.flatnonzero(np.diff(row, prepend=-1))
        along = direction[begin:end][row]
        place = along[:, 0] * vertices[vertex, 0] + along[:, 1] * vertices[vertex, 1]
        low[begin:end] = np.minimum.reduceat(place, row_start)
        high[begin:end] = np.maximum.reduceat(place, row_start)
        begin = end
    return low, high


def common_parts(
    vertices: Floats, start: Ints, first: Ints, second: Ints
) -> tuple[Ints, Floats, Floats]:
    """Return the areas that pairs (m,) of blocks have in common: pair, width, middle.

    One entry for each connected area: the number of its pair (k,), its width in m (k,), which is
    about how far the two must be moved apart, and a point in it (k, 2).
    """
    # About a point between the two and in units of their size, so that one grid fits all pairs.
    low = np.minimum.reduceat(vertices, start[:-1])
    high = np.maximum.reduceat(vertices, start[:-1])
    extent = np.hypot(*(high - low).T)
    unit = np.maximum(extent[first], extent[second])
    lower, upper = np.maximum(low[first], low[second]), np.minimum(high[first], high[second])
    middle = 0.5 * (lower + upper)
    one = _polygons(vertices, start, first, middle, unit)
    other = _polygons(vertices, start, second, middle, unit)
    shared = shapely.intersection(one, other, grid_size=ROUND_OFF)
    # A pair that only touches shares lines and points; only shared areas overlap.
    parts, pair = shapely.get_parts(shared, return_index=True)
    areal = shapely.area(parts) > 0.0
    parts, pair = parts[areal], pair[areal]
    width = widths(parts) * unit[pair]
    inside = shapely.get_coordinates(shapely.point_on_surface(parts)).reshape(-1, 2)
    return pair, width, inside * unit[pair][:, None] + middle[pair]


def _polygons(
    vertices: Floats, start: Ints, block: Ints, middle: Floats, unit: Floats
) -> NDArray[Any]:
    """Return blocks (m,) as shapely polygons about points (m, 2), in units (m,) of length."""
    vertex, pair = entries(start, block)
    rings = shapely.linearrings(
        (vertices[vertex] - middle[pair]) / unit[pair][:, None], indices=pair
    )
    return np.asarray(shapely.polygons(rings))


def widths(areas: NDArray[Any]) -> Floats:
    """Return the width of the rectangle that has area and perimeter of each polygon, shape (k,).

    That is the thickness of a sliver, straight or bent, and the side of a square.
    """
    half = 0.5 * shapely.length(areas)
    return np.asarray(0.5 * (half - np.sqrt(np.maximum(0.0, half**2 - 4.0 * shapely.area(areas)))))
