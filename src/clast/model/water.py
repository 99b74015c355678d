"""Water in a model: the edges it can wet, and its pressure there.

    p = rho g s(t) max(0, y_w(x) - l - y)

at (x, y); y_w is the water level, or the phreatic line above x, l by how much drains lower the head
there, and s the share of the full head.  Between the corners of the phreatic line p is linear along
a straight line that lies under water:  ``wetted`` gives such parts of edges and joints.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clast.model.arrays import Bools, Floats, Ints, no_bools, no_floats, no_ints
from clast.model.factors import Factor


@dataclass(frozen=True, kw_only=True, repr=False)
class WetFaces:
    """Parts of edges that no other block covers at the start."""

    edge: Ints = no_ints()
    """Edge of each part: the index of the edge's first vertex, shape (k,)."""
    share: Floats = no_floats(2)
    """Where it begins and ends, 0 at the first vertex of the edge and 1 at the next, (k, 2)."""

    def __repr__(self) -> str:
        return f"WetFaces({len(self.edge)} parts of edges)"


@dataclass(frozen=True, kw_only=True, repr=False)
class WetJoints:
    """Parts of two edges that lie along each other at the start: two faces of a joint."""

    edge: Ints = no_ints(2)
    """Edges of either face, shape (k, 2)."""
    share: Floats = no_floats(2, 2)
    """Where either face, (k, face), begins and ends as the first one runs, shape (k, 2, 2)."""
    lowered: Floats = no_floats(2)
    """By how much drains lower the head where it begins and ends, m, shape (k, 2)."""
    widest: Floats = no_floats()
    """Distance of its faces beyond which the water has run out, m, shape (k,)."""
    ends: Floats = no_floats(2, 2)
    """Its ends at the start, halfway between the faces, m, shape (k, 2, 2)."""
    near: Floats = no_floats()
    """How near to each other ends of joints are one, m, shape (k,)."""
    conducts: Bools = no_bools()
    """Whether water flows along it: not behind a lining that waits for its stage, shape (k,)."""
    drain: Ints = no_ints(2)
    """Blocks whose excavation makes it part of a drained void; -1: none, shape (k, 2)."""

    def __repr__(self) -> str:
        return f"WetJoints({len(self.edge)} parts of joints)"


@dataclass(frozen=True, kw_only=True, repr=False)
class Water:
    """Water under one level or phreatic line."""

    name: str
    """Name by which stages refer to it."""
    surface: Floats
    """Points of the phreatic line about the model's origin, m, x rising; one: a level, (m, 2).

    Beyond its ends it goes on level.
    """
    weight: float
    """Weight of water rho g, N/m3."""
    share: float = 1.0
    """Share of the full head, 0 to 1."""
    factor: Factor | None = None
    """The same as it changes with time; None: it is constant."""
    faces: WetFaces = field(default_factory=WetFaces)
    """Outer edges on which it presses."""
    joints: WetJoints = field(default_factory=WetJoints)
    """Joints in which it presses on both faces."""
    drain_at: Floats = no_floats(2)
    """Points of joints where there is no pressure, m, shape (d, 2)."""

    def pressure_of_head(self, time: float) -> float:
        """Return the pressure of one metre of water, Pa/m, at a time, s."""
        share = self.share if self.factor is None else self.share * self.factor.at(time)
        return self.weight * share

    def __repr__(self) -> str:
        level = len(self.surface) == 1
        line = "under a level" if level else f"under a line of {len(self.surface)} points"
        head = "" if self.share == 1.0 else f", {self.share:g} of the full head"
        by = "" if self.factor is None else f", by amplitude '{self.factor.name}'"
        return (
            f"Water('{self.name}', {line}{head}{by}; {len(self.faces.edge)} parts of edges, "
            f"{len(self.joints.edge)} of joints)"
        )


def surface_at(surface: Floats, x: Floats) -> Floats:
    """Return the height of a phreatic line (m, 2) at x, m; it is horizontal beyond its ends."""
    return np.asarray(np.interp(x, surface[:, 0], surface[:, 1]))


@dataclass(frozen=True, repr=False)
class Wetted:
    """Parts of lines that are under water, r of them."""

    line: Ints
    """Line of each part, shape (r,)."""
    ends: Floats
    """Its ends, m, shape (r, 2, 2)."""
    head: Floats
    """Head of water at either, m, 0 or more, shape (r, 2)."""

    def __repr__(self) -> str:
        return f"Wetted({len(self.line)} parts of lines)"


def wetted(surface: Floats, ends: Floats, lowered: Floats | None = None) -> Wetted:
    """Return the parts of straight lines that are under water, and the head at their ends, m.

    ``ends`` (k, 2, 2) are those of the lines, m, ``lowered`` (k, 2) by how much drains lower the
    head there.  Lines are divided under the corners of the phreatic line, and at the level.
    """
    line = np.arange(len(ends))
    if lowered is None:
        lowered = np.zeros(ends.shape[:2])
    if len(surface) > 1:
        line, ends, lowered = _divided(surface, ends, lowered)
    # a part lies under one straight piece of the surface: its corners belong to either piece
    head = surface_at(surface, ends[..., 0]) - ends[..., 1] - lowered
    # of two columns: numpy is slow along short axes
    under = (head[:, 0] > 0.0) | (head[:, 1] > 0.0)
    line, ends, head = line[under], ends[under], head[under]
    partly = np.flatnonzero((head[:, 0] < 0.0) | (head[:, 1] < 0.0))
    if len(partly):
        first, last = head[partly].T
        at = (first / (first - last))[:, None]
        cut = ends[partly, 0] + at * (ends[partly, 1] - ends[partly, 0])
        dry = (head[partly, 1] < 0.0).astype(np.int64)
        ends[partly, dry], head[partly, dry] = cut, 0.0
    return Wetted(line, ends, head)


def _divided(surface: Floats, ends: Floats, lowered: Floats) -> tuple[Ints, Floats, Floats]:
    """Return the parts of lines between the corners of a phreatic line: line, ends, lowered."""
    corner, x = surface[:, 0], ends[..., 0]
    before = np.searchsorted(corner, x.min(axis=1), side="right")
    past = np.searchsorted(corner, x.max(axis=1), side="left")
    inner = np.maximum(past - before, 0)  # corners strictly between the ends
    line = np.repeat(np.arange(len(ends)), inner + 1)
    if not inner.any():
        return line, ends.copy(), lowered
    number = np.arange(len(line)) - np.repeat(np.cumsum(inner + 1) - inner - 1, inner + 1)
    # corners are met in the direction of the line
    width = x[:, 1] - x[:, 0]
    across = np.where(width == 0.0, 1.0, width)[line]
    back, many = (width < 0.0)[line], inner[line]

    def share_at(count: Ints) -> Floats:
        """Return where on its line a part has its ``count``-th dividing point."""
        rank = np.where(back, many - count, count - 1)
        share = (corner[np.clip(before[line] + rank, 0, len(corner) - 1)] - x[line, 0]) / across
        return np.where(count == 0, 0.0, np.where(count > many, 1.0, share))

    share = np.stack([share_at(number), share_at(number + 1)], axis=1)
    start, end = ends[line, 0], ends[line, 1]
    parts = start[:, None] + share[..., None] * (end - start)[:, None]
    fall = lowered[line, 1] - lowered[line, 0]
    return line, parts, lowered[line, :1] + share * fall[:, None]


def ends_of_faces(faces: WetFaces, vertices: Floats, after: Ints) -> Floats:
    """Return the ends of parts of edges, m, shape (k, 2, 2), as their blocks lie now.

    ``after`` (nv,) is the vertex after each one in its block.
    """
    return _along(vertices, faces.edge, after, faces.share)


def faces_of_joints(joints: WetJoints, vertices: Floats, after: Ints) -> tuple[Floats, Floats]:
    """Return the ends of either face of joints, m, shape (k, 2, 2) each, in the same direction."""
    one = _along(vertices, joints.edge[:, 0], after, joints.share[:, 0])
    return one, _along(vertices, joints.edge[:, 1], after, joints.share[:, 1])


def filled(joints: WetJoints, one: Floats, other: Floats) -> tuple[Ints, Floats, Floats]:
    """Return the parts of joints that can hold water: joint (r,), ends (r, 2, 2), lowered (r, 2).

    ``one`` and ``other`` (k, 2, 2) are the ends of their faces, m.  Halfway between these lies the
    water; where they are farther apart than it can bridge, it has run out.
    """
    ends = 0.5 * (one + other)
    line = np.arange(len(ends))
    away = other - one
    along = ends[:, 1] - ends[:, 0]
    # Smallest length by which numbers are divided, m
    length = np.maximum(np.hypot(*along.T), 1e-300)
    # the second face lies to the right of the first, whose block is to its left
    across = away[..., 0] * along[:, None, 1] - away[..., 1] * along[:, None, 0]
    over = across / length[:, None] - joints.widest[:, None]
    both = away[:, 0] + away[:, 1]
    slip = 0.5 * np.abs(both[:, 0] * along[:, 0] + both[:, 1] * along[:, 1]) / length
    over[slip > length] = 1.0  # past each other
    if not (over > 0.0).any():
        return line, ends, joints.lowered
    held = (over <= 0.0).any(axis=1)
    line, ends, over, lowered = line[held], ends[held], over[held], joints.lowered[held].copy()
    partly = np.flatnonzero((over > 0.0).any(axis=1))
    first, last = over[partly].T
    at = first / (first - last)
    wide = (last > 0.0).astype(np.int64)
    cut = ends[partly, 0] + at[:, None] * (ends[partly, 1] - ends[partly, 0])
    there = lowered[partly, 0] + at * (lowered[partly, 1] - lowered[partly, 0])
    ends[partly, wide], lowered[partly, wide] = cut, there
    return line, ends, lowered


def _along(vertices: Floats, edge: Ints, after: Ints, share: Floats) -> Floats:
    first, last = vertices[edge], vertices[after[edge]]
    return np.asarray(first[:, None] + share[:, :, None] * (last - first)[:, None])
