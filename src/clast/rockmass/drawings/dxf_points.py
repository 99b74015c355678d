"""Points of the entities of a DXF file: bulges, arcs and curves as chords.

A curve becomes chords that stay within the *sagitta* of it, the largest distance between an arc and
its chord, s = r (1 - cos(a/2)) for a chord of the angle a.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import islice
from typing import Any

import numpy as np

from clast.rockmass.drawings.drawing import Floats

MOST_CHORDS = 100_000
"""Most chords of one curve."""

Drawn = tuple[Floats, bool, bool]
"""Points (n, 3), whether they are closed, whether they follow a curve."""


def _line(entity: Any, sagitta: float) -> Drawn:
    return np.array([tuple(entity.dxf.start), tuple(entity.dxf.end)]), False, False


def _point(entity: Any, sagitta: float) -> Drawn:
    return np.array([tuple(entity.dxf.location)]), False, False


def _text(entity: Any, sagitta: float) -> Drawn:
    return np.array([tuple(entity.dxf.insert)]), False, False


def _circle(entity: Any, sagitta: float) -> Drawn:
    centre, radius = entity.dxf.center, float(entity.dxf.radius)
    points = arc(np.array([centre.x, centre.y]), radius, (0.0, 2.0 * math.pi), sagitta)[:-1]
    return _in_world(entity, points, centre.z), True, True


def _arc(entity: Any, sagitta: float) -> Drawn:
    centre, radius = entity.dxf.center, float(entity.dxf.radius)
    start = math.radians(entity.dxf.start_angle)
    span = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
    angles = (start, start + (span or 2.0 * math.pi))
    points = arc(np.array([centre.x, centre.y]), radius, angles, sagitta)
    return _in_world(entity, points, centre.z), False, True


def _curve(entity: Any, sagitta: float) -> Drawn:
    """Return an ellipse or a spline by ezdxf's own subdivision."""
    distance = min(sagitta, 1e12)
    points = [tuple(p) for p in islice(entity.flattening(distance), MOST_CHORDS + 1)]
    if len(points) > MOST_CHORDS:
        raise ValueError(f"more than {MOST_CHORDS} chords: give a larger sagitta")
    return np.array(points), bool(getattr(entity, "closed", False)), True


def _lwpolyline(entity: Any, sagitta: float) -> Drawn:
    corners = np.array(list(entity.get_points("xyb")), float).reshape(-1, 3)
    elevation = float(entity.dxf.get("elevation", 0.0))
    points = bulged(corners, bool(entity.closed), sagitta)
    curved = bool(np.any(corners[:, 2]))
    return _in_world(entity, points, elevation), bool(entity.closed), curved


def _polyline(entity: Any, sagitta: float) -> Drawn:
    if not (entity.is_2d_polyline or entity.is_3d_polyline):
        raise ValueError("it is a mesh, not a line")
    # Control points of a fitted spline are not points of the line (flag 16).
    vertices = [vertex for vertex in entity.vertices if not vertex.dxf.flags & 16]
    at = np.array([tuple(vertex.dxf.location) for vertex in vertices]).reshape(-1, 3)
    if entity.is_3d_polyline:
        return at, bool(entity.is_closed), False
    bulges = np.array([vertex.dxf.get("bulge", 0.0) for vertex in vertices])
    corners = np.column_stack([at[:, :2], bulges])
    points = bulged(corners, bool(entity.is_closed), sagitta)
    elevation = float(entity.dxf.get("elevation", (0.0, 0.0, 0.0))[2])
    return _in_world(entity, points, elevation), bool(entity.is_closed), bool(bulges.any())


DRAWN: dict[str, Callable[[Any, float], Drawn]] = {
    "LINE": _line,
    "POINT": _point,
    "MTEXT": _text,
    "CIRCLE": _circle,
    "ARC": _arc,
    "ELLIPSE": _curve,
    "SPLINE": _curve,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
}
"""How the points of each type of entity are found."""


def _in_world(entity: Any, points: Floats, elevation: float) -> Floats:
    """Return points (n, 2) of an entity's own plane in world coordinates, shape (n, 3)."""
    flat = np.column_stack([points, np.full(len(points), elevation)])
    system = entity.ocs()
    if not system.transform:
        return flat
    return np.array([tuple(p) for p in system.points_to_wcs(flat.tolist())]).reshape(-1, 3)


def arc(centre: Floats, radius: float, angles: tuple[float, float], sagitta: float) -> Floats:
    """Return points of an arc from its first angle to its second, rad, ends included, (n, 2).

    The chords turn by at most an eighth of a circle, and stay within the sagitta of the arc.
    """
    span = angles[1] - angles[0]
    if not (radius > 0.0 and math.isfinite(radius) and math.isfinite(span)):
        raise ValueError(f"an arc of radius {radius:g}")
    share = min(max(1.0 - sagitta / radius, -1.0), 1.0)
    widest = min(2.0 * math.acos(share), math.pi / 4.0)
    if abs(span) > widest * MOST_CHORDS:
        raise ValueError(f"more than {MOST_CHORDS} chords: give a larger sagitta")
    count = max(math.ceil(abs(span) / widest - 1e-9), 1)
    turned = np.linspace(angles[0], angles[1], count + 1)
    return centre + radius * np.column_stack([np.cos(turned), np.sin(turned)])


def bulged(corners: Floats, closed: bool, sagitta: float) -> Floats:
    """Return the points of a polyline of corners (x, y, bulge), shape (n, 3), as (m, 2).

    A bulge b makes the edge after its corner an arc of the angle 4 arctan b, counter-clockwise if
    positive; its radius is c (1 + b2) / (4 |b|) for the chord c.
    """
    at, bulge = corners[:, :2], corners[:, 2]
    parts = []
    for k in range(len(at)):
        last = k + 1 == len(at)
        parts.append(at[k : k + 1])
        if bulge[k] == 0.0 or (last and not closed):
            continue
        first, second = at[k], at[0] if last else at[k + 1]
        chord = second - first
        if not chord.any():
            continue
        b = float(bulge[k])
        centre = 0.5 * (first + second) + (1.0 - b * b) / (4.0 * b) * np.array(
            [-chord[1], chord[0]]
        )
        start = math.atan2(first[1] - centre[1], first[0] - centre[0])
        angles = (start, start + 4.0 * math.atan(b))
        radius = float(np.hypot(*chord)) * (1.0 + b * b) / (4.0 * abs(b))
        parts.append(arc(centre, radius, angles, sagitta)[1:-1])
    return np.vstack(parts) if parts else np.zeros((0, 2))
