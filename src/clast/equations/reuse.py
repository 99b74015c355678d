"""One factorisation for all solves that share a matrix."""

from __future__ import annotations

import numpy as np

from clast.contact.arrays import ContactResponse
from clast.equations.system import BlockSystem
from clast.interfaces import Factor, LinearSolver
from clast.model import Floats


class FactorOfStep:
    """Solves the systems of one step, factorising again only where a stiffness has changed.

    Within a step the matrix depends on the contacts' stiffnesses alone: multiplier updates and
    friction updates of one active set change the right-hand side only.
    """

    def __init__(self, solver: LinearSolver) -> None:
        self._solver = solver
        self._factor: Factor | None = None
        self._stiffness: tuple[Floats, ...] = ()
        self.factorised = 0
        self.solved = 0

    def solve(self, system: BlockSystem, response: ContactResponse) -> Floats:
        """Return d (n, 6) of a system that was assembled with ``response``."""
        stiffness = (response.normal_stiffness, response.shear_stiffness, response.coupling)
        same = len(self._stiffness) == len(stiffness) and all(
            np.array_equal(one, other)
            for one, other in zip(stiffness, self._stiffness, strict=True)
        )
        if self._factor is None or not same:
            # an iteration that stalled on the last matrix would stall on this one
            self._solver = getattr(self._factor, "next_solver", None) or self._solver
            self._factor = self._solver.factor(system)
            self._stiffness = stiffness
            self.factorised += 1
        self.solved += 1
        return self._factor.solve(system.force)
