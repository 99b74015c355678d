"""How far contacts are looked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats


@dataclass(frozen=True, kw_only=True)
class SearchDistance:
    """How far contact detection looks, m."""

    front: float
    """In front of an edge, beside what the blocks may move."""
    depth: float
    """Behind an edge, beyond the remembered penetration: how deep a vertex may have moved."""
    critdis: float
    """Length by which edges are extended where corners coincide."""
    tip: float = 0.0
    """Length by which edges are extended for a vertex that touches with its tip alone."""
    travel: Floats | None = None
    """How far a vertex of each block may move in a step, m, shape (n,); added to both."""

    def travel_of(self, count: int) -> Floats:
        """Return the travel of ``count`` blocks, m, shape (count,); 0 where none is given."""
        return np.zeros(count) if self.travel is None else self.travel
