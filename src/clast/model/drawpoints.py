"""Lines past which blocks leave a model while the run goes on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.arrays import Floats, Ints


@dataclass(frozen=True, kw_only=True)
class Drawpoint:
    """A line past which blocks leave."""

    name: str
    """Name."""
    line: Floats
    """Its ends about the model's origin, m, shape (2, 2); blocks come from its left."""
    rate: float
    """Mass that leaves per second at most, kg/(s m); infinite: whatever comes."""
    stage: str
    """Stage from which on it draws; "": the start of the run."""

    def depth(self, points: Floats) -> Floats:
        """Return how far points (k, 2) lie past the line, m; negative before it, shape (k,)."""
        along = self.line[1] - self.line[0]
        away = points - self.line[0]
        return np.asarray((away[:, 0] * along[1] - away[:, 1] * along[0]) / np.hypot(*along))

    def past(self, before: Floats, now: Floats) -> Ints:
        """Return the points that have come past between the ends, the farthest first, (k,).

        ``before`` and ``now`` (n, 2) are where they were at the start and are, m.
        """
        along = self.line[1] - self.line[0]
        share = (now - self.line[0]) @ along / (along @ along)
        depth = self.depth(now)
        come = (self.depth(before) <= 0.0) & (depth > 0.0) & (share >= 0.0) & (share <= 1.0)
        return np.flatnonzero(come)[np.argsort(-depth[come], kind="stable")]
