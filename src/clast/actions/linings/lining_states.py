"""The linings of a case, their shapes, and their history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.linings.sections import InteractionCurve
from clast.actions.links.link_states import LinkStates
from clast.model.model import Bools, Floats, Ints


@dataclass(frozen=True, kw_only=True, repr=False)
class LiningShape:
    """How a lining of s segments lies along a line of p points, which rock may carry.

    A segment has the points of the line along its outer face, then the two ends of its inner face.
    """

    at: Floats
    """Points of the outer line as they were drawn, m, shape (p, 2)."""
    point: Ints
    """Point that each of a places in the rock carries, ascending, shape (a,)."""
    vertex: Ints
    """Vertices of the edge that each place is on, shape (a, 2)."""
    share: Floats
    """Where on it: 0 at the first of them, 1 at the second, shape (a,)."""
    first: Ints
    """First point of each segment, shape (s,)."""
    count: Ints
    """Number of points of each segment, shape (s,)."""
    inner: Floats
    """Inner ends of the two faces of each segment as they were drawn, m, shape (s, 2, 2)."""

    def points_of(self, segment: int) -> Ints:
        """Return the points of the outer face of a segment, shape (count,)."""
        return (self.first[segment] + np.arange(self.count[segment])) % len(self.at)


@dataclass(frozen=True, kw_only=True, repr=False)
class OneLining:
    """A lining of s segments and k joints: between segments, and at ends that are held."""

    name: str
    """Its name."""
    stage: str
    """Stage that installs it, "" where it is there from the start."""
    closed: bool
    """Whether the last segment is joined to the first."""
    thickness: float
    """Thickness, m."""
    tension: float
    """Tensile strength, Pa, inf where it has no strengths."""
    compression: float
    """Compressive strength, Pa, inf where it has none."""
    curve: InteractionCurve | None
    """Strength of its sections; None: it is elastic."""
    segments: Ints
    """Block of each segment, shape (s,)."""
    joints: Ints
    """Its joints among those of all linings, shape (k,)."""
    along: Floats
    """Where each joint is along the middle of the lining, from its start, m, shape (k,)."""
    at: Floats
    """Where each is as drawn, m, shape (k, 2)."""
    face: Ints
    """Segment, and 0 for its start or 1 for its end, where each joint is, shape (k, 2)."""
    shape: LiningShape
    """How it lies."""
    inside: Ints
    """Blocks that must have been excavated where it comes, shape (r,)."""
    loose: Ints
    """Blocks of segments that are to be bonded and have no rock beside them, shape (q,)."""


@dataclass(frozen=True, kw_only=True)
class LiningStates:
    """The history of linings with k joints."""

    joints: LinkStates
    """The springs of their joints."""
    cracked: Bools
    """True where the tension at a face has been beyond the strength, shape (k,)."""
    yielded: Bools
    """True where the strength of the section has been reached, shape (k,)."""
