"""How far each block is from its balance, as a share of the forces on it.

The tolerance of a minimisation is an energy of all blocks together: where a few of them carry the
most, it leaves others with forces that are small beside those and large beside their own.  Who
asks for the balance of each block has the minimum sought more sharply until every block has it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.minimise.potential import Point, Potential
from clast.model.model import Floats, Ints

SHARPER = 1e-2
"""Tolerance of the next try, in units of the last, at most."""
TRIES = 4
"""Times that the tolerance is made sharper at most."""


@dataclass(frozen=True, kw_only=True)
class EachBlock:
    """Required balance of each block."""

    share: float
    """Force that may stay out of balance, as a share of the sizes of all forces on the block."""
    gyration: Floats
    """Radius of gyration of each block, by which moments are divided, and 1 of the ground, m,
    shape (n + 1,)."""
    noise: float
    """Force that rounding makes, N/m."""
    floor: float
    """Distance from the minimum that rounding allows, J/m; no smaller one is required."""

    def of(self, blocks: Ints) -> EachBlock:
        """Return the same for some of the blocks (k,), and one more that stands still."""
        return EachBlock(
            share=self.share,
            gyration=np.append(self.gyration[blocks], 1.0),
            noise=self.noise,
            floor=self.floor,
        )

    def sharper(self, potential: Potential, point: Point, tolerance: float) -> float | None:
        """Return the tolerance, J/m, with which to go on; None where each block is in balance."""
        over = self.excess(potential, point)
        if tolerance <= self.floor or not (worst := float(over.max(initial=0.0))) > 1.0:
            return None
        return max(self.floor, min(SHARPER, 1.0 / worst**2) * tolerance)

    def excess(self, potential: Potential, point: Point) -> Floats:
        """Return the imbalance of each block, in units of the tolerance, shape (n,)."""
        return self.shares(potential, point) / self.share

    def shares(self, potential: Potential, point: Point) -> Floats:
        """Return the imbalance of each block, as a share of the forces on it, (n,).

        Forces of which rounding alone makes more than may be out of balance count as larger.
        """
        base, springs = potential.base, potential.springs
        count = len(potential.fixed)
        own = base.force - base.momentum
        size = np.hypot(own[:, 0], own[:, 1])
        between = np.hypot(point.forces.normal_force, point.forces.shear_force)
        for block in (springs.vertex_block, springs.edge_block):
            size += np.bincount(block, between, count)
        left = point.residual
        out = np.hypot(np.hypot(left[:, 0], left[:, 1]), left[:, 2] / self.gyration[:count])
        return np.asarray(out / (size + self.noise / self.share))
