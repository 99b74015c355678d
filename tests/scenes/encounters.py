"""Pairs of polygons that touch, nearly touch or overlap slightly, drawn at random."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from scenes.systems import convex, regular, star, turned

FAMILIES = {
    "convex": lambda rng: convex(rng, rng.integers(3, 9)),
    "star": lambda rng: star(rng, rng.integers(3, 9)),
    "rounded": lambda rng: regular(rng.integers(12, 28), 1.0, rng.uniform(0.0, 6.0)),
}
SIZES = (1.0, 0.3, 0.08)
"""Radii of the polygons, m: from much larger than the reach of 0.025 m to about the same."""
NEARLY = (1e-9, -1e-9, 1e-6, -1e-6, 1e-4, -1e-4, 1e-3, -1e-3, 4e-3, -4e-3)
"""Offsets, m, by which corners miss each other."""


def encounters(family: str, count: int) -> Iterator[list[np.ndarray]]:
    """Yield pairs of polygons of a family: every second pair face to face, corners coinciding."""
    for seed in range(count):
        rng = np.random.default_rng(seed)
        size = SIZES[seed % len(SIZES)]
        one, other = (size * FAMILIES[family](rng) for _ in range(2))
        other = turned(other, rng.uniform(0.0, 2.0 * np.pi))
        if seed % 2:
            pair = [one, face_to_face(rng, one, other)]
        else:
            pair = [one, meeting(rng, one, other)]
        if all(shapely.Polygon(outline).is_valid for outline in pair):
            yield pair


def normal_of(outline, k):
    """Return the outward unit normal of edge k."""
    along = outline[(k + 1) % len(outline)] - outline[k]
    return np.array([along[1], -along[0]]) / np.hypot(*along)


def face_to_face(rng, one, other):
    """Return ``other`` with an edge along an edge of ``one``, up to 4 degrees, ends near an end."""
    k, m = rng.integers(len(one)), rng.integers(len(other))
    away, towards = normal_of(one, k), -normal_of(other, m)
    angle = np.arctan2(away[1], away[0]) - np.arctan2(towards[1], towards[0])
    other = turned(other, angle + rng.choice([0.0, np.radians(rng.uniform(-4.0, 4.0))]))
    if rng.uniform() < 0.5:
        shift = one[k] - other[(m + 1) % len(other)]
    else:
        shift = one[(k + 1) % len(one)] - other[m]
    along = np.array([-away[1], away[0]])
    return other + shift + rng.choice(NEARLY) * along + rng.choice(NEARLY) * away


def meeting(rng, one, other):
    """Return ``other`` brought to ``one`` from a random direction, up to 2 cm into or before it."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    way = np.array([np.cos(angle), np.sin(angle)])
    resting = shapely.Polygon(one)

    def hits(distance):
        return resting.intersects(shapely.Polygon(other + distance * way))

    far = 3.0 * max(np.ptp(one), np.ptp(other))
    inside = next(distance for distance in np.linspace(far, 0.0, 121) if hits(distance))
    outside = inside + far / 120.0
    for _ in range(40):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if hits(middle) else (inside, middle)
    return other + (outside + rng.choice([-1, -1, 1]) * 10.0 ** rng.uniform(-6.0, -1.7)) * way
