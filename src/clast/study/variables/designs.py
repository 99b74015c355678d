"""Designs of runs for indices of sensitivity, and the list of all samplings.

Both change parameters one at a time, from points that are spread over all of their ranges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.study.variables.random_draws import (
    LatinHypercube,
    PointEstimate,
    Random,
    Sampling,
    Sobol,
    mixed,
)


@dataclass(frozen=True)
class Saltelli(Sampling):
    """Groups of m + 2 runs that give Sobol' indices (Saltelli et al. 2010).

    Run 1 of a group is a point A of a Sobol' sequence, run m + 2 another, B; in run k + 1 parameter
    k of A is that of B.
    """

    WORD: ClassVar[str] = "saltelli"
    INDICES: ClassVar[bool] = True
    seed: int = 1
    """Seed of the shift of the sequence."""

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of a run."""
        group, place = divmod(run, parameters + 2)
        points = Sobol(self.seed).probabilities(group, count, 2 * parameters)
        first, second = points[:parameters], points[parameters:]
        if place == 0:
            return first
        if place == parameters + 1:
            return second
        return np.where(np.arange(parameters) == place - 1, second, first)

    def checked(self, count: int, parameters: int) -> int:
        """Return the number of runs; raises CaseError where it is not a power of two of groups."""
        size = parameters + 2
        groups = count // size
        if count % size or groups < 2 or groups & (groups - 1):
            near = size << max(1, round(math.log2(max(2.0, count / size))))
            raise CaseError(
                f"{count} runs are not a power of two times {size}, the runs of a group",
                where="n",
                remedy=f"e.g. {near}",
            )
        Sobol().checked(groups, 2 * parameters)
        return count


@dataclass(frozen=True)
class Morris(Sampling):
    """Paths of m + 1 runs, each of which changes one parameter more (Morris 1991).

    They lie on a grid of LEVELS probabilities, and change by LEVELS/(2 (LEVELS - 1)) of the range.
    """

    WORD: ClassVar[str] = "morris"
    INDICES: ClassVar[bool] = True
    OF_CHANCE: ClassVar[bool] = False
    LEVELS: ClassVar[int] = 4
    END: ClassVar[float] = 0.01
    """Probability at the ends of the grid: many distributions have no value at 0 and 1."""
    seed: int = 1
    """Seed."""

    def shares(self, run: int, parameters: int) -> Floats:
        """Return the place of a run on the grid, 0 to 1 for each parameter, shape (parameters,)."""
        path, place = divmod(run, parameters + 1)
        half = self.LEVELS // 2
        begin = np.array([mixed(self.seed, path, k, 1) % half for k in range(parameters)])
        falls = np.array([mixed(self.seed, path, k, 2) % 2 == 1 for k in range(parameters)])
        order = sorted(range(parameters), key=lambda k: mixed(self.seed, path, k, 3))
        changed = np.isin(np.arange(parameters), order[:place])
        return (begin + half * (changed != falls)) / (self.LEVELS - 1)

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of a run."""
        return self.END + (1.0 - 2.0 * self.END) * self.shares(run, parameters)

    def checked(self, count: int, parameters: int) -> int:
        """Return the number of runs; raises CaseError where paths do not divide it."""
        size = parameters + 1
        if count % size or count < 2 * size:
            near = size * max(2, round(count / size))
            raise CaseError(
                f"{count} runs are not several paths of {size} runs",
                where="n",
                remedy=f"give a multiple of {size}, e.g. {near}",
            )
        return count


SAMPLINGS: dict[str, type[Sampling]] = {
    one.WORD: one for one in (Random, LatinHypercube, Sobol, PointEstimate, Saltelli, Morris)
}
"""Word -> class."""
