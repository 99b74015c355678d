"""Water in joints that blocks open and close, as one term of the potential of a step.

Blocks open the joints at a node by v = V d.  The water that a node holds, the flow to it over the
time h and the void w that remains balance where

    w = A p + v - b,   A = S + h C,   low <= p <= high,

with S = V/K the compressibility of the water at each node, C the conductances between them, and b
the inflow that does not depend on p and the water held before.  Nodes between their bounds have no
void, w = 0; at the lower bound, 0, water cannot follow and w >= 0 is void; at the upper one, that
of a face in air, the excess runs out, w <= 0.  Where a pressure is given both bounds are that.  The
energy

    psi(v) = max over p of  -p.(v - b) - 1/2 p.A p

is convex, and its slope is -p: the term in d is convex and once continuously differentiable, as the
springs of contacts are.  A is an M-matrix, so that the nodes between their bounds are found in a
few solutions (primal-dual active sets; Hintermueller, Ito & Kunisch 2003).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from clast.errors import StepOutcome, StepRejected
from clast.model.arrays import Bools, Floats

SETS_MAX = 60
"""Sets of nodes between their bounds that are tried."""


class Factors:
    """The last factors and pressures of a step: starts for its next solution, nothing else."""

    def __init__(self) -> None:
        self._free, self._factor = b"", None
        self.pressure: Floats = np.zeros(0)
        self.blocks: Any = None
        """That of blocks and water together (minimise/joint_water.py)."""

    def of(self, matrix: Any, free: Bools) -> Any:
        """Return the factor of the rows and columns of A (m, m) that are ``free`` (m,)."""
        from scipy.sparse.linalg import splu

        if self._factor is None or self._free != free.tobytes():
            some = np.flatnonzero(free)
            part = matrix if len(some) == len(free) else matrix[some][:, some]
            self._free, self._factor = free.tobytes(), splu(part.tocsc(), **SYMMETRIC)
        return self._factor


SYMMETRIC = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "options": {"SymmetricMode": True},
}
"""How symmetric matrices are factored that need no pivots."""


@dataclass(frozen=True, kw_only=True)
class Pressures:
    """The pressures at nodes when joints have opened."""

    pressure: Floats
    """p, Pa, shape (m,)."""
    free: Bools
    """Which are between their bounds, shape (m,)."""
    rest: Floats
    """w = A p + v - b, m2: void at the lower bound, less the excess at the upper, shape (m,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class OpeningJoints:
    """Water in the joints of n blocks in a step, at m nodes."""

    volumes: Any
    """V: how nodes open by d, m2/m, sparse, shape (m, 6 n)."""
    matrix: Any
    """A, m2/Pa, sparse, shape (m, m)."""
    known: Floats
    """b, m2, shape (m,)."""
    low: Floats
    """Least pressure, Pa, shape (m,)."""
    high: Floats
    """Largest pressure, Pa, shape (m,)."""
    acting: Floats
    """Pressure whose forces are in those on blocks already, Pa, shape (m,)."""
    factors: Factors = field(default_factory=Factors)

    def opened(self, displacement: Floats) -> Floats:
        """Return by how much nodes open, v (m,), m2, by d of blocks (n, 6), and the ground."""
        flat = displacement.ravel()[: self.volumes.shape[1]]
        return np.asarray(self.volumes @ flat)

    def forces(self, pressure: Floats, blocks: int) -> Floats:
        """Return the forces of p (m,) on ``blocks`` blocks, (blocks, 6), N/m and N."""
        result = np.zeros((blocks, 6))
        force = self.volumes.T @ pressure
        result.reshape(-1)[: len(force)] = force
        return result

    def pressures(self, opened: Floats) -> Pressures:
        """Return the pressures where joints have opened by v (m,), m2."""
        matrix, low, high = self.matrix, self.low, self.high
        known, own = self.known - opened, matrix.diagonal()
        last = self.factors.pressure
        pressure = np.clip(last if len(last) == len(low) else self.acting, low, high)
        before: tuple[bytes, bytes] | None = None
        for _ in range(SETS_MAX):
            rest = matrix @ pressure - known
            aim = pressure - rest / own
            # the bounds count where they are reached, so that given pressures are never free
            at_low, at_high = aim <= low, aim >= high
            free = ~(at_low | at_high)
            now = at_low.tobytes(), at_high.tobytes()
            if now == before:
                break
            before = now
            pressure = np.where(at_low, low, np.where(at_high, high, 0.0))
            if free.any():
                left = known - matrix @ pressure
                pressure[free] = self.factors.of(matrix, free).solve(left[free])
        else:
            raise StepRejected(StepOutcome.NOT_CONVERGED, "nodes of water in joints")
        self.factors.pressure = pressure
        return Pressures(pressure=pressure, free=free, rest=np.where(free, 0.0, rest))

    def energy(self, opened: Floats) -> float:
        """Return psi(v) and the energy of the forces that are in those on blocks, J/m."""
        found = self.pressures(opened)
        p = found.pressure
        held = -p @ (opened - self.known) - 0.5 * p @ (self.matrix @ p)
        return float(held + self.acting @ opened)

    def rates(self, found: Pressures, opened: Floats) -> Floats:
        """Return how p of nodes changes with a change of v (m,), m2: -A^-1 v of those free."""
        rate = np.zeros(len(opened))
        if found.free.any():
            factor = self.factors.of(self.matrix, found.free)
            rate[found.free] = -factor.solve(opened[found.free])
        return rate

    def beside(self, displacement: Floats) -> OpeningJoints:
        """Return the same for displacements on top of ``displacement`` (n, 6), m."""
        return replace(self, known=self.known - self.opened(displacement), factors=Factors())

    def __repr__(self) -> str:
        return f"OpeningJoints({len(self.known)} nodes)"
