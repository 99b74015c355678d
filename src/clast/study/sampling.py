"""How runs are drawn: the numbers of run i follow from the study and i alone.

So there is no list of runs to keep: a million runs cost nothing until they are made, each worker
draws its own, and a study that goes on draws the same runs as one without interruption.

Every sampling gives a probability in (0, 1) for each parameter; a normal copula correlates them:
with u the probabilities of independent parameters and L L^T the matrix of correlations between
normal scores,

    p = Phi(L Phi^-1(u)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy import special

from clast.errors import CaseError
from clast.model.model import Floats

RUNS_MAX = 100_000_000
"""Runs of a study, at most."""


class Sampling:
    """Things that all samplings have in common."""

    WORD: ClassVar[str] = ""
    INDICES: ClassVar[bool] = False
    """Whether it is a design for indices of sensitivity: parameters are independent and drawn."""
    OF_CHANCE: ClassVar[bool] = True
    """Whether the share of its runs in which something happens is a probability."""

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of run ``run`` of ``count``, from 0, shape (parameters,)."""
        raise NotImplementedError

    def checked(self, count: int, parameters: int) -> int:
        """Return how many runs there are where ``count`` are asked for; raises CaseError."""
        return count


@dataclass(frozen=True)
class Random(Sampling):
    """Independent runs."""

    WORD: ClassVar[str] = "random"
    seed: int = 1

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of a run."""
        return np.array([uniform(self.seed, run, k) for k in range(parameters)])


@dataclass(frozen=True)
class LatinHypercube(Sampling):
    """Runs of which one lies in each of equal slices of every parameter (McKay et al. 1979).

    They come in replicates of their own, each of which is a hypercube.
    """

    WORD: ClassVar[str] = "latin-hypercube"
    seed: int = 1
    replicates: int = 10
    """Hypercubes that the runs are divided among: their scatter gives the interval."""

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of a run."""
        size = count // self.replicates
        replicate, within = divmod(run, size)
        slices = [
            _permute(within, size, mixed(self.seed, replicate, k)) + uniform(self.seed, run, k)
            for k in range(parameters)
        ]
        return np.array(slices) / size

    def replicate(self, run: int, count: int) -> int:
        """Return the replicate that a run belongs to, from 0."""
        return run // (count // self.replicates)

    def checked(self, count: int, parameters: int) -> int:
        """Return the number of runs; raises CaseError where replicates do not divide it."""
        if self.replicates < 1:
            raise CaseError(
                f"{self.replicates} is not a valid number of replicates",
                where="replicates",
                remedy="give a whole number from 1 on; intervals need 2",
            )
        if self.replicates > count or count % self.replicates:
            what = f"{count} runs cannot be divided among {self.replicates} Latin hypercubes"
            remedy = f"make n a multiple of {self.replicates}, or give other replicates"
            raise CaseError(what, where="replicates", remedy=remedy)
        return count


@dataclass(frozen=True)
class Sobol(Sampling):
    """Sobol' points with a digital shift: a power of two of them."""

    WORD: ClassVar[str] = "sobol"
    seed: int = 1
    BITS: ClassVar[int] = 30

    def probabilities(self, run: int, count: int, parameters: int) -> Floats:
        """Return the probabilities of a run."""
        from scipy.stats import qmc

        points = qmc.Sobol(parameters, scramble=False, bits=self.BITS)
        if run:
            points.fast_forward(run)
        whole = (points.random(1)[0] * 2.0**self.BITS).astype(np.int64)
        shift = [mixed(self.seed, 0, k) >> (64 - self.BITS) for k in range(parameters)]
        return ((whole ^ np.array(shift, np.int64)) + 0.5) / 2.0**self.BITS

    def checked(self, count: int, parameters: int) -> int:
        """Return the number of runs; raises CaseError where it is not a power of two."""
        if count & (count - 1) or count < 2:
            near = 1 << max(1, round(math.log2(max(2, count))))
            raise CaseError(f"{count} is not a power of two", where="n", remedy=f"e.g. {near}")
        if parameters > 1000:
            raise CaseError("there are more than 1000 parameters", remedy="vary fewer")
        return count


@dataclass(frozen=True)
class PointEstimate(Sampling):
    """All 2^m combinations of mean plus and minus standard deviation (Rosenblueth 1975)."""

    WORD: ClassVar[str] = "point-estimate"
    MOST: ClassVar[int] = 20

    def signs(self, run: int, parameters: int) -> Floats:
        """Return -1 or 1 for each parameter, shape (parameters,)."""
        return np.array([1.0 if run >> k & 1 else -1.0 for k in range(parameters)])

    def checked(self, count: int, parameters: int) -> int:
        """Return the number of runs, 2^parameters."""
        if parameters > self.MOST:
            raise CaseError(
                f"{parameters} parameters have 2^{parameters} combinations",
                remedy=f"vary {self.MOST} at most, or choose another sampling",
            )
        return 1 << parameters

    def weight(self, run: int, correlations: Floats) -> float:
        """Return the weight of a run: all alike but for correlations (m, m)."""
        signs = self.signs(run, len(correlations))
        pairs = 0.5 * (signs @ correlations @ signs - np.trace(correlations))
        return float(1.0 + pairs) / float(1 << len(signs))


def copula(pairs: Sequence[tuple[int, int, float]], parameters: int) -> tuple[Floats, Floats]:
    """Return the matrix of correlations of normal scores and its Cholesky factor, (m, m) each.

    ``pairs`` are two parameters and their correlation.  Raises CaseError where no variables have
    such correlations.
    """
    matrix = np.eye(parameters)
    for first, second, value in pairs:
        matrix[first, second] = matrix[second, first] = value
    try:
        return matrix, np.asarray(np.linalg.cholesky(matrix), np.float64)
    except np.linalg.LinAlgError:
        raise CaseError(
            "these correlations are impossible: the correlation matrix is not positive definite",
            where="correlate",
            remedy="move the correlations towards 0",
        ) from None


def correlated(probabilities: Floats, factor: Floats) -> Floats:
    """Return correlated probabilities of independent ones, (m,), by a Cholesky factor (m, m)."""
    scores = special.ndtri(np.clip(probabilities, 1e-15, 1.0 - 1e-15))
    return np.asarray(special.ndtr(factor @ scores))


def uniform(seed: int, run: int, parameter: int) -> float:
    """Return a number in (0, 1) of its own for each run and parameter."""
    return ((mixed(seed + 1, run, parameter) >> 11) + 0.5) / float(1 << 53)


def mixed(*numbers: int) -> int:
    """Return 64 bits that look random of whole numbers (splitmix64, Steele et al. 2014)."""
    state = 0x9E3779B97F4A7C15
    for number in numbers:
        state = (state ^ number) * 0xBF58476D1CE4E5B9 % (1 << 64)
        state = (state + 0x9E3779B97F4A7C15) % (1 << 64)
        state = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9 % (1 << 64)
        state = (state ^ (state >> 27)) * 0x94D049BB133111EB % (1 << 64)
        state ^= state >> 31
    return state


def _permute(number: int, size: int, key: int) -> int:
    """Return where a permutation of ``size`` numbers, chosen by a key, sends one of them.

    A Feistel network on the least even number of bits that holds them, walked until it falls
    within: nothing needs to be kept of the permutation.
    """
    if size == 1:
        return 0
    half = (max(2, (size - 1).bit_length()) + 1) // 2
    mask = (1 << half) - 1
    while True:
        left, right = number >> half, number & mask
        for turn in range(8):
            left, right = right, left ^ (mixed(key, turn, right) & mask)
        number = left << half | right
        if number < size:
            return number


@dataclass(frozen=True)
class Saltelli(Sampling):
    """Groups of m + 2 runs that give Sobol' indices (Saltelli et al. 2010).

    Run 1 of a group is a point A of a Sobol' sequence, run m + 2 another, B; in run k + 1 parameter
    k of A is that of B.
    """

    WORD: ClassVar[str] = "saltelli"
    INDICES: ClassVar[bool] = True
    seed: int = 1

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
