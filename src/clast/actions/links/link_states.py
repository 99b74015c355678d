"""Rows of links, and their history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from clast.model.model import Bools, Floats, Ints

COMPONENTS = ("along", "across", "rotation")
"""Components of a link."""


@dataclass(frozen=True, kw_only=True, repr=False)
class LinkRows:
    """The m rows of springs of k links: one for each component that a link has."""

    name: tuple[str, ...]
    """Name of each link."""
    block: Ints
    """Its two blocks, or one and GROUND, shape (k, 2)."""
    at: Floats
    """Its point at the start, m, shape (k, 2)."""
    along: Floats
    """Unit vector of its direction at the start, shape (k, 2)."""
    turning: Floats
    """Shares of the turns of its two blocks, of sum 1, by which its direction turns, (k, 2)."""
    stage: tuple[str, ...]
    """Stage that installs it, "" where it is there from the start."""
    link: Ints
    """Link of each row, ascending, shape (m,)."""
    component: Ints
    """Its component, shape (m,)."""
    stiffness: Floats
    """N/m per m, or N per rad, inf: rigid, shape (m,)."""
    strength: Floats
    """Force, N/m, or moment, N, at which it yields, inf: never, shape (m,)."""
    rupture: Floats
    """Stretch, m or rad, at which it breaks for good, inf: never, shape (m,)."""
    gap: Floats
    """Play to either side before it acts, m or rad, shape (m,)."""
    damping: Floats
    """Force by rate, N s/m2 or N s per rad, shape (m,)."""

    @property
    def blocks(self) -> Ints:
        """Blocks of each row, shape (m, 2)."""
        return np.asarray(self.block[self.link])


@dataclass(frozen=True, kw_only=True)
class LinkStates:
    """Where k links are, and the history of their m rows."""

    at: Floats
    """Their points on the first and the second block, m, shape (k, 2, 2)."""
    angle: Floats
    """By how much the first block has turned against the second, rad, shape (k,)."""
    rest: Floats
    """Stretch at which each row was installed, m or rad, NaN before, shape (m,)."""
    plastic: Floats
    """Plastic stretch, m or rad, shape (m,)."""
    force: Floats
    """Force on the first block, N/m, or moment, N, without damping, shape (m,)."""
    drag: Floats
    """Force or moment of its dashpot, shape (m,)."""
    yielded: Bools
    """True where it has yielded, shape (m,)."""
    broken: Bools
    """True where it has broken, or lost its block, shape (m,)."""

    @property
    def carries(self) -> Bools:
        """Whether it can carry a force, shape (m,)."""
        return np.asarray(~np.isnan(self.rest) & ~self.broken)


class ForceLimits(Protocol):
    """Limits of the forces of links."""

    def bounds(self, rows: LinkRows, state: LinkStates) -> tuple[Floats, Floats]:
        """Return the least and the largest force of each row, N/m, or moment, N, (m,) each."""
        ...


@dataclass(frozen=True)
class YieldForces:
    """Each row yields by itself, to either side alike."""

    def bounds(self, rows: LinkRows, state: LinkStates) -> tuple[Floats, Floats]:
        """Return the strengths, of both signs."""
        return -rows.strength, rows.strength
