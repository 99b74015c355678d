"""The protocol of a solver of the block system."""

from __future__ import annotations

from typing import Protocol

from clast.linear.pattern import Patterns
from clast.linear.system import BlockSystem
from clast.model.model import Floats


class Factorisation(Protocol):
    """A block system made ready to be solved for several right-hand sides."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        ...


class LinearSolver(Protocol):
    """Solves the 6 x 6 block system of a step."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the matrix made ready; raises StepRejected where it is singular.

        ``patterns`` keeps data that depend on the pairs alone, not to be found again for every
        matrix; a solver that keeps nothing leaves it alone.
        """
        ...
