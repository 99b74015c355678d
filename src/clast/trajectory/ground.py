"""The profile and its barriers as kernels take them: segments, corners, surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.model.model import Floats, Ints

RESTITUTION, STICKING, FRICTION, SLIDING, ARM, ROUGHNESS, SPEED, SPACING = range(8)
"""Rows of the decks of a surface: R_n; the share 1 - R_t of the sticking impulse; tan(phi) of
blows; tan(phi) of sliding; moment arm of rolling resistance, m; standard deviation of the angle of
the face, rad; normal speed at which R_n halves, m/s; length of facets with one angle, m, or 0."""
DECK = 1000
"""Values of a distribution: its quantiles at (k + 1/2)/DECK, drawn with equal chances."""
ROUGHEST, ROUGH = 1e9, 10.0
"""tan(phi) of a surface on which nothing slides, and of blows on one without a friction angle."""
STRAIGHT = 1e-9
"""Sine of the angle up to which a corner of the profile is none."""
CLOSE = 1e-9
"""Gap within which a rock touches the profile, in units of its radius."""
ROUND_OFF = 1e-14
"""Error of a gap, in units of the size of the profile."""


class Ground(NamedTuple):
    """The profile, its barriers and surfaces; k segments with free air on their left, c corners."""

    start: Floats
    """First point of each segment, m, (k, 2)."""
    way: Floats
    """Unit direction of each segment, (k, 2)."""
    normal: Floats
    """Unit normal of each segment, into the air, (k, 2)."""
    length: Floats
    """Length of each segment, m, (k,)."""
    along: Floats
    """Place of the first point of each segment along all of them, one after the other, m, (k,)."""
    surface: Ints
    """Surface of each segment, (k,)."""
    barrier: Ints
    """Barrier of each segment, -1 for the profile itself, (k,)."""
    corner: Floats
    """Corners that stand out, m, (c, 2)."""
    beside: Ints
    """Segments before and after each corner, (c, 2)."""
    decks: Floats
    """Values of each property of each surface, (surfaces, 8, DECK)."""
    capacity: Floats
    """Energy that each barrier takes, J; infinite: a wall that stands, (barriers,)."""
    stations: Floats
    """Places at which passing rocks are measured, rising, m, (s,)."""
    box: Floats
    """Left and right end and lowest point of the profile, and its size, m, (4,)."""


@dataclass(frozen=True, kw_only=True)
class Face:
    """A line of segments with air on its left; a polygon where it ends at its first point."""

    points: Floats
    """Points, m, (k + 1, 2)."""
    surface: Sequence[int]
    """Surface of each segment, k numbers."""
    barrier: int = -1
    """Barrier that the line is a side of."""


def ground_of(
    profile: Face, others: Sequence[Face], decks: Floats, capacity: Floats, stations: Floats
) -> Ground:
    """Return the ground of a profile and other faces: blocks apart from it, barriers."""
    start, way, length = list[Floats](), list[Floats](), list[Floats]()
    surface, barrier = list[int](), list[int]()
    corner, beside = list[Floats](), list[tuple[int, int]]()
    for face in (profile, *others):
        steps = np.diff(face.points, axis=0)
        size = np.hypot(*steps.T)
        unit, first = steps / size[:, None], sum(len(part) for part in start)
        after = np.roll(unit, -1, axis=0)
        stands_out = unit[:, 0] * after[:, 1] - unit[:, 1] * after[:, 0] < -STRAIGHT
        stands_out |= np.sum(unit * after, axis=1) < STRAIGHT - 1.0
        stands_out[-1] &= len(size) > 2 and bool((face.points[0] == face.points[-1]).all())
        for k in np.flatnonzero(stands_out).tolist():
            corner.append(face.points[k + 1])
            beside.append((first + k, first + (k + 1) % len(size)))
        start.append(face.points[:-1])
        way.append(unit)
        length.append(size)
        surface += list(face.surface)
        barrier += [face.barrier] * len(size)
    ways, points = np.concatenate(way), profile.points
    size = float(np.ptp(points, axis=0).max())
    box = [points[:, 0].min(), points[:, 0].max(), points[:, 1].min(), size]
    return Ground(
        start=np.concatenate(start),
        way=ways,
        normal=np.stack([-ways[:, 1], ways[:, 0]], axis=1),
        length=np.concatenate(length),
        along=np.cumsum(np.concatenate([[0.0], *length]))[:-1],
        surface=np.array(surface, np.int64),
        barrier=np.array(barrier, np.int64),
        corner=np.array(corner, np.float64).reshape(-1, 2),
        beside=np.array(beside, np.int64).reshape(-1, 2),
        decks=np.ascontiguousarray(decks),
        capacity=np.ascontiguousarray(capacity),
        stations=np.ascontiguousarray(stations),
        box=np.array(box, np.float64),
    )


@kernel()
def distance_to(ground, k, x, y):
    """Return the distance of a place from segment k, m."""
    dx, dy = x - ground.start[k, 0], y - ground.start[k, 1]
    along = dx * ground.way[k, 0] + dy * ground.way[k, 1]
    along = min(max(along, 0.0), ground.length[k])
    return np.hypot(dx - along * ground.way[k, 0], dy - along * ground.way[k, 1])


@kernel()
def height_below(ground, x, y):
    """Return the height of the profile below a place, m; nan beside the profile."""
    best = np.nan
    for k in range(len(ground.length)):
        run = ground.way[k, 0] * ground.length[k]
        if ground.barrier[k] >= 0 or run <= 0.0:
            continue
        share = (x - ground.start[k, 0]) / run
        if share < 0.0 or share > 1.0:
            continue
        height = ground.start[k, 1] + share * ground.way[k, 1] * ground.length[k]
        if height <= y and not best > height:
            best = height
    return best
