"""What makes a system of blocks impossible to simulate, found before the first step.

Every check names the block (its number from 1 and its name) and the vertex (its number from 1 in
the loop and its coordinates) and says what to do.  All of them work on flat arrays of all blocks
at once: ten thousand blocks are checked within a second or two.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.errors import ModelError
from clast.ground_motion import GroundMotion, InertialForce, MovingBase
from clast.model import Floats, Ints, Joint, Plane, PlaneStrain, Rock

Geometries = NDArray[Any]
"""Array of shapely geometries."""

SAME_POINT = 1e-9
"""Vertices closer than this share of the block's extent are duplicates."""
FLAT = 1e-9
"""A block whose hull has less than this share of its extent squared as area is a line."""
TOUCHING = 1e-6
"""Overlaps and distances below this share of the block's size are round-off."""
SMALL_ANGLE = 1.6
"""Friction angles up to this many degrees look like radians (pi/2 is 1.57)."""


@dataclass(frozen=True)
class Outlines:
    """The blocks' polygons as flat arrays, with the names by which messages call them."""

    names: tuple[str, ...]
    """Name of each block."""
    start: Ints
    """Index of each block's first vertex, the last entry is the vertex count, shape (n + 1,)."""
    vertices: Floats
    """Vertices relative to ``origin``, m, shape (nv, 2)."""
    origin: Floats
    """Point that the vertices are relative to, m, shape (2,)."""

    def label(self, block: int) -> str:
        """Return how a message calls a block: its number from 1, and its name."""
        number, name = str(block + 1), self.names[block]
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
        return np.repeat(np.arange(len(self.names)), np.diff(self.start))

    @property
    def following(self) -> Ints:
        """Index of the vertex after each vertex in its loop, shape (nv,)."""
        after = np.arange(1, len(self.vertices) + 1)
        after[self.start[1:] - 1] = self.start[:-1]
        return after

    @property
    def extent(self) -> Floats:
        """Diagonal of each block's bounding box, m, shape (n,)."""
        low = np.minimum.reduceat(self.vertices, self.start[:-1])
        high = np.maximum.reduceat(self.vertices, self.start[:-1])
        return np.hypot(*(high - low).T)

    @property
    def area(self) -> Floats:
        """Signed area of each block, positive when counter-clockwise, m2, shape (n,)."""
        # Taken about each block's first vertex: no digits are lost to its distance from the origin.
        here = self.vertices - self.vertices[self.start[:-1]][self.owner]
        there = here[self.following]
        cross = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
        return np.asarray(0.5 * np.add.reduceat(cross, self.start[:-1]))

    def polygons(self) -> Geometries:
        """Return the blocks as shapely polygons, shape (n,)."""
        rings = shapely.linearrings(self.vertices, indices=self.owner)
        return np.asarray(shapely.polygons(rings))


def point_text(at: Sequence[float] | Floats) -> str:
    """Return coordinates as a message shows them."""
    return f"({float(at[0]):.9g}, {float(at[1]):.9g})"


def check_corner_count(outlines: Outlines) -> None:
    """Refuse blocks with fewer than three vertices, and a system without any block."""
    if not outlines.names:
        raise ModelError(
            "there are no blocks",
            where="geometry",
            remedy="give [geometry] vertices and blocks, or one [[block]] table for each block",
        )
    counts = np.diff(outlines.start)
    for block in np.flatnonzero(counts < 3)[:1]:
        raise ModelError(
            f"has {counts[block]} vertices",
            where=outlines.label(block),
            remedy="a block needs at least 3 vertices, counter-clockwise",
        )


def check_finite(outlines: Outlines) -> None:
    """Refuse coordinates that are not numbers."""
    bad = ~np.isfinite(outlines.vertices).all(axis=1)
    for vertex in np.flatnonzero(bad)[:1]:
        raise ModelError(
            "is not a finite number",
            where=outlines.vertex_label(vertex),
            remedy="nan and inf are no coordinates: give both in m",
        )


def check_polygons(outlines: Outlines, polygons: Geometries) -> None:
    """Refuse duplicate vertices, loops without area, self-crossing loops and clockwise ones."""
    _check_duplicates(outlines)
    extent = outlines.extent
    hull_area = shapely.area(shapely.convex_hull(polygons))
    for block in np.flatnonzero(hull_area <= FLAT * extent**2)[:1]:
        raise ModelError(
            "has no area: its vertices lie on one line",
            where=outlines.label(block),
            remedy="give it at least 3 vertices that span an area",
        )
    for block in np.flatnonzero(~shapely.is_valid(polygons))[:1]:
        raise ModelError(
            _crossing(outlines, block),
            where=outlines.label(block),
            remedy="order the vertices along the outline, counter-clockwise, each once",
        )
    area = outlines.area
    for block in np.flatnonzero(np.abs(area) <= FLAT * extent**2)[:1]:
        raise ModelError(
            f"has no area ({abs(area[block]):.3g} m2)",
            where=outlines.label(block),
            remedy="give it vertices that span an area, or leave the block out",
        )
    for block in np.flatnonzero(area < 0.0)[:1]:
        raise ModelError(
            "its loop runs clockwise",
            where=outlines.label(block),
            remedy="reverse the order of its vertices: loops run counter-clockwise",
        )


def _check_duplicates(outlines: Outlines) -> None:
    """Refuse consecutive vertices that are the same point."""
    following = outlines.following
    side = np.hypot(*(outlines.vertices[following] - outlines.vertices).T)
    twice = side <= SAME_POINT * outlines.extent[outlines.owner]
    for vertex in np.flatnonzero(twice)[:1]:
        again = int(following[vertex])
        first = int(outlines.start[outlines.owner[vertex]])
        raise ModelError(
            f"is the same point as vertex {again - first + 1}",
            where=outlines.vertex_label(vertex),
            remedy="remove one of the two (a loop closes by itself, without its first vertex)",
        )


def _crossing(outlines: Outlines, block: int) -> str:
    """Return which two edges of a loop cross or touch, in words."""
    rows = np.arange(outlines.start[block], outlines.start[block + 1])
    here = outlines.vertices[rows]
    count = len(rows)
    edges = shapely.linestrings(np.stack([here, np.roll(here, -1, axis=0)], axis=1))
    first, second = np.triu_indices(count, k=2)
    apart = ~((first == 0) & (second == count - 1))
    first, second = first[apart], second[apart]
    meet = np.flatnonzero(shapely.intersects(edges[first], edges[second]))
    if len(meet) == 0:
        return "its loop folds back on itself"
    one, other = int(first[meet[0]]), int(second[meet[0]])
    where = shapely.centroid(shapely.intersection(edges[one], edges[other]))
    at = np.array([where.x, where.y]) + outlines.origin
    return (
        f"its loop crosses or touches itself: edge {one + 1}-{one + 2} meets "
        f"edge {other + 1}-{(other + 1) % count + 1} at {point_text(at)}"
    )


def check_overlaps(outlines: Outlines, polygons: Geometries) -> None:
    """Refuse blocks that overlap by more than round-off; shared edges and corners are normal."""
    first, second = shapely.STRtree(polygons).query(polygons)
    size = np.sqrt(np.abs(outlines.area))
    first, second = _deep_boxes(outlines, *_ordered(first, second), size)
    shared = shapely.intersection(polygons[first], polygons[second])
    # A pair that only touches shares lines and points; only shared areas overlap.
    parts, pair = shapely.get_parts(shared, return_index=True)
    areal = shapely.area(parts) > 0.0
    parts, pair = parts[areal], pair[areal]
    # Twice area over perimeter is the thickness of a sliver and half the width of a square.
    depth = 2.0 * shapely.area(parts) / shapely.length(parts)
    limit = TOUCHING * np.maximum(size[first[pair]], size[second[pair]])
    bad = np.flatnonzero(depth > limit)
    if len(bad) == 0:
        return
    worst = bad[np.argmax(depth[bad])]
    one, other = int(first[pair[worst]]), int(second[pair[worst]])
    middle = shapely.centroid(parts[worst])
    others = len(np.unique(pair[bad])) - 1
    more = f"; so do {others} more pairs" if others else ""
    raise ModelError(
        f"overlaps {outlines.label(other)} to a depth of {depth[worst]:.3g} m near "
        f"{point_text(np.array([middle.x, middle.y]) + outlines.origin)}{more}",
        where=outlines.label(one),
        remedy="move or cut the blocks so that they touch at most (coordinates rounded too "
        "coarsely overlap as well: give more digits)",
    )


def _ordered(first: Ints, second: Ints) -> tuple[Ints, Ints]:
    """Return each pair once, the lower block first."""
    once = first < second
    return first[once], second[once]


def _deep_boxes(outlines: Outlines, first: Ints, second: Ints, size: Floats) -> tuple[Ints, Ints]:
    """Return the pairs whose bounding boxes share more than round-off in both directions.

    The others share at most a strip of the thickness allowed; in a wall these are all pairs.
    """
    low = np.minimum.reduceat(outlines.vertices, outlines.start[:-1])
    high = np.maximum.reduceat(outlines.vertices, outlines.start[:-1])
    shared = np.minimum(high[first], high[second]) - np.maximum(low[first], low[second])
    deep = shared.min(axis=1) > TOUCHING * np.maximum(size[first], size[second])
    return first[deep], second[deep]


def locate(
    shapes: Geometries,
    named: Ints,
    where: Callable[[int], str],
    outlines: Outlines,
    polygons: Geometries,
) -> Ints:
    """Return the block that carries each point or line, shape (k,).

    ``named`` (k,) holds the block that the user named, -1 where none was; ``where`` gives the
    label of a shape for messages.
    """
    reach = TOUCHING * np.sqrt(np.abs(outlines.area))
    tree = shapely.STRtree(polygons)
    near, block = tree.query(shapes, predicate="dwithin", distance=float(reach.max()))
    inside = shapely.covers(shapely.buffer(polygons[block], reach[block]), shapes[near])
    near, block = near[inside], block[inside]
    order = np.lexsort((block, near))
    near, block = near[order], block[order]
    carrying = np.split(block, np.searchsorted(near, np.arange(1, len(shapes))))
    return np.array(
        [
            _carrier(shapes[k], int(named[k]), blocks, where(k), outlines, tree)
            for k, blocks in enumerate(carrying[: len(shapes)])
        ],
        dtype=np.int64,
    )


def _carrier(
    shape: Any, named: int, carrying: Ints, where: str, outlines: Outlines, tree: shapely.STRtree
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
            remedy=f'say which one it moves with, e.g. block = "{example}"',
        )
    closest = int(tree.nearest(shape))
    distance = float(shapely.distance(shape, tree.geometries[closest]))
    whole = "outside every block" if distance > 0.0 else "not wholly inside any block"
    raise ModelError(
        f"lies {whole}; the nearest is {outlines.label(closest)}, {distance:.3g} m away",
        where=where,
        remedy="move it into a block or onto its boundary",
    )


def check_rock(rock: Rock, plane: Plane) -> None:
    """Refuse moduli, densities and Poisson's ratios that no rock has."""
    where = f"rock '{rock.name}'"
    _positive(rock.young, f"{where}, young", "give Young's modulus in Pa, e.g. 50e9")
    _positive(rock.density, f"{where}, density", "give the density in kg/m3, e.g. 2700")
    check_numbers(rock.initial_stress, 3, f"{where}, initial_stress")
    limit = "below 0.5" if isinstance(plane, PlaneStrain) else "at most 0.5"
    inside = -1.0 < rock.poisson <= 0.5
    if not inside or (isinstance(plane, PlaneStrain) and rock.poisson == 0.5):
        raise ModelError(
            f"{rock.poisson:g} is impossible in plane {plane.name}",
            where=f"{where}, poisson",
            remedy=f"Poisson's ratio is above -1 and {limit}; rocks have 0.1 to 0.4",
        )


def check_joint(joint: Joint, *, allow_small_friction_angle: bool) -> None:
    """Refuse strengths that no joint has, and friction angles that look like radians."""
    where = f"joint '{joint.name}'"
    angle = joint.friction_angle
    if not 0.0 <= angle < 90.0:
        raise ModelError(
            f"{angle:g} is no friction angle",
            where=f"{where}, friction_angle",
            remedy="give it in degrees, from 0 to below 90",
        )
    if 0.0 < angle < SMALL_ANGLE and not allow_small_friction_angle:
        raise ModelError(
            f"{angle:g} looks like radians, but friction angles are in degrees",
            where=f"{where}, friction_angle",
            remedy=f"write {math.degrees(angle):.6g}, or 0 for no friction; if {angle:g} degrees "
            "is meant, add allow_small_friction_angle = true to the joint",
        )
    for key, value in (("cohesion", joint.cohesion), ("tensile_strength", joint.tensile_strength)):
        if not 0.0 <= value < math.inf:
            raise ModelError(
                f"{value:g} is no strength",
                where=f"{where}, {key}",
                remedy="give it in Pa, 0 or more",
            )
    if joint.restitution is not None and not 0.0 <= joint.restitution <= 1.0:
        raise ModelError(
            f"{joint.restitution:g} is no restitution",
            where=f"{where}, restitution",
            remedy="give the share of the closing velocity that rebounds, from 0 to 1",
        )


def _positive(value: float, where: str, remedy: str) -> None:
    if not 0.0 < value < math.inf:
        raise ModelError(f"{value:g} must be above 0 and finite", where=where, remedy=remedy)


def check_ground_motion(motion: GroundMotion, fixed_points: int) -> None:
    """Refuse accelerograms that are none, and a moving base without fixed points."""
    where = "ground_motion"
    if isinstance(motion, InertialForce | MovingBase):
        time, acceleration = motion.accelerogram.time, motion.accelerogram.acceleration
        if time.ndim != 1 or len(time) < 2 or acceleration.shape != (len(time), 2):
            raise ModelError(
                f"time has the shape {time.shape} and acceleration {acceleration.shape}",
                where=where,
                remedy="give at least 2 instants, and an acceleration (x, y) for each",
            )
        if not (np.isfinite(time).all() and np.isfinite(acceleration).all()):
            raise ModelError(
                "is not finite", where=where, remedy="give times in s and accelerations in m/s2"
            )
        for k in np.flatnonzero(np.diff(time) <= 0.0)[:1]:
            raise ModelError(
                f"instant {k + 2}, {time[k + 1]:g} s, is not after instant {k + 1}, {time[k]:g} s",
                where=where,
                remedy="order the instants by time, each once",
            )
    if isinstance(motion, MovingBase) and fixed_points == 0:
        raise ModelError(
            "the base moves, but nothing is held by it",
            where=where,
            remedy="hold the base by fixed points (a fixed block does not move), or let the motion "
            "act as a body force",
        )


def check_numbers(values: Any, count: int, where: str) -> Floats:
    """Return ``count`` finite numbers as an array, shape (count,), or say which is none."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.shape != (count,) or not np.isfinite(array).all():
        raise ModelError(
            f"{values!r} is no list of {count} finite numbers",
            where=where,
            remedy=f"give {count} numbers in SI units",
        )
    return array
