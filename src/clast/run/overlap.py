"""Overlaps of blocks that their contacts do not account for.

Every frame is searched, independently of candidates and corner rules, for outlines that cross
deeper than the contacts of the two blocks account for, and for blocks inside others.  A polygon
clipper then finds the overlap of the few pairs that are left.

Where corners of four blocks meet, those across from each other overlap as far as the joints beside
them have closed and slipped, both at once: no vertex has gone through an edge to bring that about,
and rock would lose the tip of a corner.  Distinct element programs round corners by about 1 % of an
edge for this reason; the overlap of two such tips is left out (decision 76).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.block import polygon
from clast.contact import edge_intersections
from clast.contact.broad_phase import VerletList, near_pairs
from clast.model.model import Floats, Ints, Model
from clast.model.state import ContactMemory, Overlap, State

DEPTH_RATIO_MIN = 1.5
"""Depth of an overlap that is reported, in units of the deepest contact of the pair."""
DEPTH_MIN = 0.02
"""The same, in units of critdis."""
AREA_MIN = 1e-6
"""Area of an overlap that is reported, in units of the smaller block's."""
TIP_RADIUS = 0.01
"""Radius by which corners count as rounded where more blocks meet, by the smaller block's size."""


def unseen_overlaps(model: Model, state: State, critdis: float) -> list[Overlap]:
    """Return the overlaps that contacts do not account for, in the order of the pairs of blocks.

    A contact accounts for its penetration as far as its spring is compressed by it; overlaps less
    deep than a fiftieth of ``critdis``, m, or of less than 1e-6 of the smaller block are not
    reported.
    """
    vertices, block_start = state.vertices, model.block_start
    near = near_pairs(VerletList(), vertices, block_start, model.fixed, 0.0, absent=model.absent)
    pairs = model.meeting(near)  # others may overlap: their links say so
    contacts = _closed(model, state.memory.corners, pairs)
    box = polygon.boxes(vertices, block_start)
    polygons = polygon.polygon_arrays(vertices, block_start, model.vertex_block)
    limits, carried = (DEPTH_RATIO_MIN, DEPTH_MIN * critdis), np.zeros(len(pairs), np.bool_)
    crossed = edge_intersections.unseen(polygons, box, pairs, contacts, limits, carried)
    inside = edge_intersections.swallowed(vertices, block_start, box, pairs)
    deepest = np.zeros(len(pairs))
    np.maximum.at(deepest, contacts[2], -contacts[3])
    block_area, _, _ = polygon.moments(vertices, block_start)
    give = np.zeros(model.block_count)
    np.maximum.at(give, pairs, deepest[:, None])
    result = []
    for q in np.unique(np.concatenate((crossed[3], np.flatnonzero(inside)))):
        explained = max(DEPTH_RATIO_MIN * deepest[q], give[pairs[q]].sum(), DEPTH_MIN * critdis)
        if width_max(*_loops(model, vertices, pairs[q])) <= explained:
            continue  # what rests on springs overlaps in every frame
        parts = _overlap(model, vertices, pairs[q])
        circles = shapely.maximum_inscribed_circle(parts)
        depth, area = (
            2.0 * float(shapely.length(circles).max(initial=0.0)),
            float(shapely.area(parts).sum()),
        )
        if depth > explained and area > AREA_MIN * block_area[pairs[q]].min():
            blocks = model.block_name[pairs[q, 0]], model.block_name[pairs[q, 1]]
            known = float(deepest[q])
            result.append(
                Overlap(blocks=blocks, time=state.time, depth=depth, area=area, known=known)
            )
    return result


def _closed(model: Model, memory: ContactMemory, pairs: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """Return vertex, edge, pair and stretch of closed contacts (m,), sorted by pair."""
    own, other = model.vertex_block[memory.vertex], memory.block
    width = model.block_count
    key = np.minimum(own, other) * width + np.maximum(own, other)
    keys = pairs[:, 0] * width + pairs[:, 1]
    at = np.searchsorted(keys, key)
    # of a spring that rests behind its edge, N = lambda - p gap with lambda < 0, this is gap - rest
    force, multiplier = np.maximum(memory.normal_force, 0.0), np.minimum(memory.multiplier, 0.0)
    rests = multiplier < 0.0
    share = force / np.where(rests, force - multiplier, 1.0)
    stretch = np.where(rests, share, 1.0) * memory.gap
    near = at < len(keys)
    near[near] = keys[at[near]] == key[near]
    rows = np.flatnonzero(near & (stretch < 0.0))
    rows = rows[np.argsort(at[rows], kind="stable")]
    return memory.vertex[rows], memory.edge[rows], at[rows], stretch[rows]


def _overlap(model: Model, vertices: Floats, pair: Ints) -> NDArray[Any]:
    """Return the overlap of two blocks, as polygons, without tips where more blocks meet."""
    loops = _loops(model, vertices, pair)
    one, other = (shapely.make_valid(shapely.Polygon(loop)) for loop in loops)
    # without a grid GEOS takes outlines that touch to the last bit for overlapping
    shared = shapely.intersection(one, other, grid_size=1e-9 * np.sqrt(one.area))
    parts = shapely.get_parts(shared)
    parts = parts[shapely.area(parts) > 0.0]
    radius = TIP_RADIUS * float(np.sqrt(min(one.area, other.area)))
    tips = [_tips(loop, radius) for loop in loops]
    away = model.absent[model.vertex_block] | np.isin(model.vertex_block, pair)
    others = vertices[~away]
    left = [not _is_at_tips(shapely.get_coordinates(part), loops, tips, others) for part in parts]
    return np.asarray(parts[np.array(left, np.bool_)])


def _loops(model: Model, vertices: Floats, pair: Ints) -> list[Floats]:
    """Return the outlines of two blocks, m, (k, 2) each."""
    return [vertices[model.block_start[b] : model.block_start[b + 1]] for b in pair]


def width_max(one: Floats, other: Floats) -> float:
    """Return a bound on the diameter of circles in the overlap of two outlines (k, 2), m.

    It is the least depth of one behind an edge of the other; infinite if neither is convex.
    """
    widest = np.inf
    for loop, corners in ((one, other), (other, one)):
        sides = np.roll(loop, -1, axis=0) - loop
        on = np.roll(sides, -1, axis=0)
        if np.all(sides[:, 0] * on[:, 1] >= sides[:, 1] * on[:, 0]):
            inward = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / np.hypot(*sides.T)[:, None]
            depth = inward @ corners.T - np.sum(inward * loop, axis=1)[:, None]
            widest = min(widest, float(depth.max(axis=1).min()))
    return widest


def _tips(loop: Floats, radius: float) -> Floats:
    """Return how far the arc's centre is from each corner (k,), m; 0 where one does not stand out.

    A corner of angle a that an arc rounds off ends at radius / sin(a/2) from the arc's centre.
    """
    before, after = np.roll(loop, 1, axis=0) - loop, np.roll(loop, -1, axis=0) - loop
    sine = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]
    cosine = np.sum(before * after, axis=1)
    half = 0.5 * np.arctan2(sine, cosine)
    return np.where(half > 0.0, radius / np.maximum(np.sin(half), TIP_RADIUS), 0.0)


def _is_at_tips(part: Floats, loops: list[Floats], tips: list[Floats], others: Floats) -> bool:
    """Return whether an area (m, 2) is but tips of both its blocks, with another's corner there."""
    reach = 0.0
    for loop, tip in zip(loops, tips, strict=True):
        apart = np.hypot(*(loop[:, None] - part).transpose(2, 0, 1)).max(axis=1)
        if not np.any(apart <= tip):
            return False
        reach = max(reach, float(tip[apart <= tip].max()))
    return bool(np.any(np.hypot(*(others - part.mean(axis=0)).T) <= reach))
