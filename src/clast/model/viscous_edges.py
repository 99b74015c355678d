"""Edges of a model that absorb waves in place of the rock beyond."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[Any]


DOWNWARDS = -float(np.sqrt(0.5))
"""n_y of the outward normals of edges that face down, at most: within 45 degrees."""


def _no_floats() -> Floats:
    return np.zeros(0)


def _no_ints() -> Ints:
    return np.zeros(0, np.int64)


@dataclass(frozen=True, kw_only=True, repr=False)
class ViscousEdges:
    """Edges with dashpots, k of them: a rho c_p v_n along the normal, b rho c_s v_t along the edge.

    Before they begin, springs hold these edges in the directions that have dashpots.
    """

    edge: Ints = field(default_factory=_no_ints)
    """Index of the first vertex of each edge, shape (k,)."""
    block: Ints = field(default_factory=_no_ints)
    """Its block, shape (k,)."""
    normal: Floats = field(default_factory=_no_floats)
    """Multiple a of rho c_p, shape (k,)."""
    tangential: Floats = field(default_factory=_no_floats)
    """Multiple b of rho c_s, shape (k,)."""
    kept: Floats = field(default_factory=_no_floats)
    """Share of the spring forces that stays as a traction when dashpots begin, shape (k,)."""
    begins: Floats = field(default_factory=_no_floats)
    """Time from which dashpots are in the place of springs, s, inf until a stage, shape (k,)."""
    stage: tuple[str, ...] = ()
    """Name of the stage with which they begin, "" where it is a time."""

    def __len__(self) -> int:
        return len(self.edge)

    def at_stage(self, name: str, time: float) -> ViscousEdges:
        """Return the edges when a stage begins at a time, s, and with it dashpots."""
        if name not in self.stage:
            return self
        begins = np.where([one == name for one in self.stage], time, self.begins)
        return replace(self, begins=begins)

    def __repr__(self) -> str:
        return f"ViscousEdges({len(self)} edges)"
