"""Contact detection once more, in plain Python and shapely: the definition, slowly.

A vertex P of one block is a candidate for an edge AB of another where

- P is not a re-entrant vertex (its interior angle is at most 183 degrees);
- the signed distance of P to the line AB lies between -depth and front;
- the block of P, as seen from P, lies in front of AB: no direction into it points more than
  3 degrees behind the edge, and its middle points to the front;
- the foot of P lies on AB; or beyond an end by at most critdis where one of P's own edges runs
  back along AB within 3 degrees; or by at most depth where P is inside the corner there, behind
  the next edge as well;
- behind AB, no other edge lies between P and the foot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from clast.contact.candidates import SearchDistance

PARALLEL = 3.0
"""Degrees within which edges count as parallel."""


@dataclass(frozen=True)
class Candidate:
    """A vertex that may touch an edge, and how far the foot lies beyond the edge's ends."""

    vertex: int
    edge: int
    gap: float
    beyond: float


def direction(start, end):
    """Return the direction of a line, degrees."""
    return np.degrees(np.arctan2(end[1] - start[1], end[0] - start[0]))


def interior_angle(outline, k):
    """Return the angle inside the outline at vertex k, degrees."""
    here = outline[k]
    onward = direction(here, outline[(k + 1) % len(outline)])
    back = direction(here, outline[k - 1])
    return (back - onward) % 360.0


def signed_distances(point, outline):
    """Return the distance of a point to the line of each edge, positive outside."""
    line = np.roll(outline, -1, axis=0) - outline
    offset = point - outline
    cross = offset[:, 0] * line[:, 1] - offset[:, 1] * line[:, 0]
    return cross / np.hypot(line[:, 0], line[:, 1])


def elevation(towards, edge_direction):
    """Return how far a direction points in front of an edge (to its right), degrees in (-180, 180].

    0 to 180 is in front: 0 along the edge backwards, 180 along it forwards.
    """
    angle = (towards - (edge_direction - 180.0)) % 360.0
    return angle - 360.0 if angle > 270.0 else angle


def lies_in_front(outline, k, edge_direction):
    """Return whether the block, as seen from its vertex k, lies in front of an edge."""
    onward = direction(outline[k], outline[(k + 1) % len(outline)])
    inside = interior_angle(outline, k)
    limits = [elevation(onward + share * inside, edge_direction) for share in (0.0, 0.5, 1.0)]
    middle = 0.0 < limits[1] < 180.0
    return middle and all(-PARALLEL <= limit <= 180.0 + PARALLEL for limit in limits)


def runs_back(outline, k, edge_direction, at_end):
    """Return whether an own edge of vertex k runs back along an edge from beyond its end."""
    towards = edge_direction + (180.0 if at_end else 0.0)
    for other in (outline[k - 1], outline[(k + 1) % len(outline)]):
        off = (direction(outline[k], other) - towards + 180.0) % 360.0 - 180.0
        if abs(off) <= PARALLEL:
            return True
    return False


def is_hidden(point, foot, outline, e, gap_to, critdis, foot_inside):
    """Return whether another edge lies between a point and its foot on edge e."""
    count = len(outline)
    sight = shapely.LineString([point, foot])
    for k in range(count):
        if k == e:
            continue
        wall = shapely.LineString([outline[k], outline[(k + 1) % count]])
        if not sight.crosses(wall):
            continue
        if k not in ((e - 1) % count, (e + 1) % count):
            return True
        if foot_inside and gap_to[k] > critdis:
            return True
    return False


def candidates(outline, k, other, reach: SearchDistance):
    """Return the candidate edges of outline ``other`` for vertex k of ``outline``."""
    count, point = len(other), outline[k]
    gaps = signed_distances(point, other)
    near = (gaps >= -reach.depth) & (gaps <= reach.front)
    if not near.any() or interior_angle(outline, k) > 180.0 + PARALLEL:
        return []
    found = []
    for e in np.flatnonzero(near):
        start, end = other[e], other[(e + 1) % count]
        size = np.hypot(*(end - start))
        along = float(np.dot(point - start, (end - start) / size))
        beyond = max(-along, along - size)
        # the foot may not lie further beyond the ends than any of the rules below allows
        if beyond > max(reach.critdis, reach.depth):
            continue
        towards = direction(start, end)
        if not lies_in_front(outline, k, towards):
            continue
        if beyond > 1e-9 * size:
            at_end = along > 0.0
            corner = (e + 1) % count if at_end else e
            allowed = reach.critdis if runs_back(outline, k, towards, at_end) else reach.tip
            next_gap = gaps[(e + 1) % count if at_end else e - 1]
            if next_gap < 0.0 and (gaps[e] < 0.0 or interior_angle(other, corner) > 180.0):
                allowed = reach.depth
            if beyond > allowed:
                continue
        foot = start + np.clip(along / size, 0.0, 1.0) * (end - start)
        inside = 0.0 < along < size
        if gaps[e] < 0.0 and is_hidden(point, foot, other, e, gaps, reach.critdis, inside):
            continue
        found.append(Candidate(k, int(e), float(gaps[e]), beyond))
    return found


def every_candidate(outlines, reach: SearchDistance):
    """Return {(block, vertex, other block, edge): Candidate} of all pairs of outlines."""
    return {
        (i, k, j, one.edge): one
        for i, outline in enumerate(outlines)
        for j, other in enumerate(outlines)
        if i != j
        for k in range(len(outline))
        for one in candidates(outline, k, other, reach)
    }
