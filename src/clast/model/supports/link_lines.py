"""Links as they are drawn: their places and components."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GROUND = -1
"""Number of the ground in place of a block: it is none, and moves with the ground motion alone."""
FREE, SOFT, RIGID = 0, 1, 2
"""Action of a link along, across and against rotation: nothing, a spring or dashpot, rigid."""


@dataclass(frozen=True, kw_only=True)
class LinkLines:
    """Places of k links at the start."""

    name: tuple[str, ...] = ()
    """Name of each."""
    block: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """Its two blocks, or one and GROUND, shape (k, 2)."""
    at: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """Its point, m, shape (k, 2)."""
    along: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """Unit vector of its direction, shape (k, 2)."""
    holds: Ints = field(default_factory=lambda: np.zeros((0, 3), np.int64))
    """FREE, SOFT or RIGID: along, across, rotation, shape (k, 3)."""
