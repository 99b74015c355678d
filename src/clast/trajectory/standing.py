"""Blocks that rocks fall on: with the profile, they make one outline of segments.

Edges that blocks share are inside it, so a rock that slides over a joint strikes nothing there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.errors import ModelError
from clast.model.model import Bools, Floats, Ints

SEAM = 1e-3
"""Gaps and overlaps of blocks that a run has moved, at most, in units of their median size."""
ON = 1e-9
"""Distance within which a segment is on a block, in units of the size of all."""


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """Blocks at an instant, n of them."""

    name: tuple[str, ...]
    rock: tuple[str, ...]
    """Name of the rock of each."""
    outline: tuple[Floats, ...]
    """Polygon of each, counter-clockwise, m, (c, 2)."""
    density: Floats
    """Density of each, kg/m3, (n,); nan where it is not known."""
    velocity: Floats
    """Velocity, m/s, and spin, counter-clockwise, rad/s, (n, 3)."""
    fixed: Bools
    """True where a block cannot move at all, (n,)."""
    seam: float = 0.0
    """Width of gaps and overlaps that are none, m: 0 for blocks that nothing has moved."""

    def where(self, chosen: Bools) -> Blocks:
        """Return the chosen ones."""
        numbers = np.flatnonzero(chosen).tolist()
        return replace(
            self,
            name=tuple(self.name[k] for k in numbers),
            rock=tuple(self.rock[k] for k in numbers),
            outline=tuple(self.outline[k] for k in numbers),
            density=self.density[numbers],
            velocity=self.velocity[numbers],
            fixed=self.fixed[numbers],
        )

    def about(self, origin: Floats) -> Blocks:
        """Return them with coordinates about an origin (2,), m."""
        return replace(self, outline=tuple(one - origin for one in self.outline))


@dataclass(frozen=True, kw_only=True)
class Line:
    """A line of segments with air on its left; a ring ends where it begins."""

    points: Floats
    """Points, m, (k + 1, 2)."""
    owner: Ints
    """Block of each segment, or -1 - s: it is on segment s of the profile, (k,)."""


def air_lines(profile: Floats | None, blocks: Blocks) -> list[Line]:
    """Return the outline of blocks and of the profile (p, 2), m, that they stand on.

    The first line leads from side to side; the others are rings of blocks apart from it.
    Cavities are left out.
    """
    import shapely
    from shapely.geometry.polygon import orient

    solids = [shapely.Polygon(one) for one in blocks.outline]
    if profile is not None:
        solids.append(_solid_below(profile, blocks))
    whole, seam = shapely.union_all(solids), blocks.seam
    if seam > 0.0:
        sharp = {"join_style": "mitre", "mitre_limit": 20.0}
        whole = whole.buffer(seam, **sharp).buffer(-2.0 * seam, **sharp).simplify(0.5 * seam)
    parts = [orient(one, -1.0) for one in shapely.get_parts(whole) if not one.is_empty]
    rings = [shapely.get_coordinates(one.exterior) for one in parts]
    widest = max(range(len(rings)), key=lambda k: float(np.ptp(rings[k][:, 0])))
    lines = [_from_side_to_side(rings.pop(widest)), *rings]
    owners = _Owners(profile, blocks)
    return [Line(points=np.ascontiguousarray(one), owner=owners.of(one)) for one in lines]


def _solid_below(profile: Floats, blocks: Blocks) -> object:
    """Return the ground below a profile as a polygon; raises ModelError where it is none."""
    import shapely

    points = np.concatenate([profile, *blocks.outline])
    bottom = points[:, 1].min() - np.ptp(points, axis=0).max()
    closing = [[profile[-1, 0], bottom], [profile[0, 0], bottom]]
    solid = shapely.Polygon(np.concatenate([profile, closing]))
    if not solid.is_valid:
        raise ModelError(
            "turns back beyond one of its ends, so blocks cannot stand on it",
            where="[rockfall], profile",
            remedy="lengthen it to both sides",
        )
    return solid


def _from_side_to_side(ring: Floats) -> Floats:
    """Return the upper part of a clockwise ring (r + 1, 2): from its left end to its right one."""
    open_ring = ring[:-1]
    x, y = open_ring.T
    left = np.lexsort((-y, x))[0]
    turned = np.roll(open_ring, -left, axis=0)
    right = np.lexsort((-turned[:, 1], -turned[:, 0]))[0]
    return turned[: right + 1]


class _Owners:
    """Finds the block that a segment of an outline is on, or else the segment of the profile."""

    def __init__(self, profile: Floats | None, blocks: Blocks) -> None:
        import shapely

        self._blocks = shapely.STRtree([shapely.Polygon(one) for one in blocks.outline])
        ends = np.empty((0, 2)) if profile is None else profile
        pieces = np.stack([ends[:-1], ends[1:]], axis=1)
        self._profile = shapely.STRtree(shapely.linestrings(pieces))
        size = max(float(np.ptp(np.concatenate(blocks.outline), axis=0).max()), 1e-300)
        self._on = max(ON * size, 4.0 * blocks.seam)

    def of(self, points: Floats) -> Ints:
        """Return the owners of the segments between points (k + 1, 2), as ``Line`` has them."""
        import shapely

        middles = shapely.points(0.5 * (points[:-1] + points[1:]))
        near = self._blocks.nearest(middles)
        if not len(self._profile):
            return np.asarray(near, np.int64)
        _, apart = self._blocks.query_nearest(middles, return_distance=True, all_matches=False)
        return np.where(apart <= self._on, near, -1 - self._profile.nearest(middles))
