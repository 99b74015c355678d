"""A rock: a convex polygon about its centroid, and random ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.block import polygon
from clast.model.model import Floats


class Rock(NamedTuple):
    """A rigid rock, n corners counter-clockwise; edge i runs from corner i to the next."""

    corners: Floats
    """Corners about the centroid, m, (n, 2)."""
    way: Floats
    """Unit direction of each edge, (n, 2)."""
    length: Floats
    """Length of each edge, m, (n,)."""
    support: Floats
    """Distance of each edge from the centroid, m, (n,)."""
    offset: Floats
    """Place of the first corner of each edge along its direction, from the centroid, m, (n,)."""
    numbers: Floats
    """Mass, kg, moment of inertia, kg m2, and radius of the circle about all corners, m, (3,)."""


def moments(vertices: Floats) -> tuple[float, Floats, float]:
    """Return area, m2, centroid (2,), m, and polar moment of area about it, m4, of a polygon."""
    area, centroid, second = polygon.moments(vertices, np.array([0, len(vertices)]))
    return float(area[0]), centroid[0], float(second[0, 0] + second[0, 1])


def rock_of(vertices: Floats, density: float, thickness: float) -> Rock:
    """Return the rock of a convex polygon (n, 2), m, counter-clockwise, kg/m3, m."""
    area, centroid, polar = moments(vertices)
    corners = np.ascontiguousarray(vertices - centroid)
    steps = np.roll(corners, -1, axis=0) - corners
    length = np.hypot(*steps.T)
    way = steps / length[:, None]
    mass = density * thickness * area
    radius = float(np.hypot(*corners.T).max())
    return Rock(
        corners=corners,
        way=way,
        length=length,
        support=way[:, 1] * corners[:, 0] - way[:, 0] * corners[:, 1],
        offset=np.sum(way * corners, axis=1),
        numbers=np.array([mass, density * thickness * polar, radius]),
    )


def is_convex(vertices: Floats) -> bool:
    """Return whether a polygon is convex and runs counter-clockwise round itself once."""
    steps = np.roll(vertices, -1, axis=0) - vertices
    after = np.roll(steps, -1, axis=0)
    turn = np.arctan2(
        steps[:, 0] * after[:, 1] - steps[:, 1] * after[:, 0], np.sum(steps * after, axis=1)
    )
    return bool((turn > 0.0).all() and turn.sum() < 2.0 * np.pi + 1e-6)


SCATTER = 0.8
"""Share of the angle between two corners in which a random corner lies: no edge is too short."""


def random_polygon(uniforms: Floats, elongation: float) -> Floats:
    """Return a convex polygon of area 1, (n, 2), by one number in [0, 1) for each corner and one.

    Its corners lie on an ellipse whose axes are as ``elongation`` to 1; the last number turns it.
    """
    count = len(uniforms) - 1
    angle = 2.0 * np.pi * (np.arange(count) + SCATTER * (uniforms[:-1] - 0.5)) / count
    points = np.stack([elongation * np.cos(angle), np.sin(angle)], axis=1)
    points = points / np.sqrt(moments(points)[0])
    turn = 2.0 * np.pi * uniforms[-1]
    c, s = np.cos(turn), np.sin(turn)
    return points @ np.array([[c, s], [-s, c]])
