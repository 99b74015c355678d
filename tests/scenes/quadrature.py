"""Integrals over polygons, by cutting them into triangles."""

import numpy as np
import shapely


def triangles(outline):
    """Return the triangles (k, 3, 2) that a polygon is cut into."""
    corners = np.concatenate([outline, outline[:1]])
    solid = shapely.Polygon(outline)
    parts = shapely.get_parts(shapely.delaunay_triangles(shapely.MultiPoint(corners)))
    inside = [part.intersection(solid) for part in parts]
    pieces = [piece for part in inside for piece in shapely.get_parts(part)]
    cut = [
        part
        for piece in pieces
        if piece.area > 0.0
        for part in shapely.get_parts(shapely.constrained_delaunay_triangles(piece))
    ]
    return np.array([np.array(part.exterior.coords)[:3] for part in cut])


def integral(outline, function):
    """Return the integral over a polygon of a function of (k, 2) points, quadratic or simpler.

    The midpoints of a triangle's edges integrate quadratic functions exactly.
    """
    corner = triangles(outline)
    one, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    middle = 0.5 * (corner + np.roll(corner, -1, axis=1))
    values = function(middle.reshape(-1, 2)).reshape(len(corner), 3, -1)
    return np.einsum("t,tkm->m", area / 3.0, values)
