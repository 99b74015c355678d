"""How fast the matrix product of a step is, beside a loop that only moves memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from time import perf_counter
from typing import Any, NoReturn

import numpy as np

from clast.compute.parallel import BLOCKS
from clast.errors import StepRejected
from clast.linear import pcg, single_precision
from clast.linear.pattern import Patterns
from clast.linear.solvers import DIRECTION, PCG, IteratedMatrix
from clast.linear.system import BlockSystem
from clast.model.model import Model
from clast.model.state import State
from clast.step.method import Method, Workspace
from clast.studies.bench import triad as stream

REPEATS = 7
"""Times that something is measured; the fastest counts."""
PATIENCE = 2.0
"""Measuring ends early after this many seconds."""
LARGE = 192 * 2**20
"""Bytes of the triad that measures main memory: more than any cache holds."""


@dataclass(frozen=True, kw_only=True)
class Product:
    """The matrix product of a step's system against the triad over as many bytes.

    Both are held by the same caches then; small systems never come near main memory.
    """

    bytes: int
    """Bytes moved: every block of the matrix read once, x read and y written."""
    rate: float
    """Bytes per second of the product."""
    triad: float
    """Bytes per second of the triad, one thread."""
    triad_by_threads: float
    """Bytes per second of the triad, all threads."""

    shared: bool
    """True where the threads share the product, as they do where there are enough blocks."""

    @property
    def share(self) -> float:
        """Rate of the product as a share of the triad's, by as many threads."""
        return self.rate / (self.triad_by_threads if self.shared else self.triad)

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        return {**asdict(self), "share": self.share}


class _Captured(Exception):
    """Carries the system of a step out of it."""

    def __init__(self, system: BlockSystem) -> None:
        super().__init__()
        self.system = system


@dataclass(frozen=True)
class _Capture:
    """A solver that does not solve."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> NoReturn:
        """Hand the system to who asked for it."""
        raise _Captured(system)


def system_of_step(model: Model, method: Method, state: State, step: float) -> BlockSystem | None:
    """Return the first system of a step from ``state``, or None where there is nothing to solve.

    The blocks are given a push, for where they rest there is nothing either.
    """
    velocity = state.velocity.copy()
    velocity[~model.fixed, :2] += step * model.gravity
    try:
        method.process.step(
            model,
            replace(method, solver=_Capture()),
            replace(state, velocity=velocity),
            step,
            Workspace(),
        )
    except _Captured as captured:
        return captured.system
    except StepRejected:
        return None
    return None


def matrix_of_directions(system: BlockSystem) -> tuple[Any, ...]:
    """Return K and its pattern as single_precision.multiply takes them.

    In the order and the precision in which conjugate gradients have it.  Raises StepRejected where
    it is singular.
    """
    matrix = PCG(tolerance=DIRECTION).factor(system, Patterns())
    if not isinstance(matrix, IteratedMatrix) or matrix.ready is None:
        raise TypeError("this system is not solved iteratively")
    factor, blocks, _ = matrix.ready
    return blocks, factor[0]


def bytes_of_product(matrix: tuple[Any, ...]) -> int:
    """Return the bytes that a product moves: K_ii, pairs and K_ij read, x read, y written."""
    (diagonal, upper), pattern = matrix
    pairs = pattern[2]
    return int(diagonal.nbytes + upper.nbytes + pairs.nbytes + 2 * pcg.vector(len(diagonal)).nbytes)


def measured_product(matrix: tuple[Any, ...]) -> Product:
    """Return the rate of K x, beside the triad's."""
    count = len(matrix[0][0])
    x, y = pcg.vector(count), pcg.vector(count)
    x[:, :6] = 1.0
    moved = bytes_of_product(matrix)
    taken = fastest(lambda: single_precision.multiply(*matrix, x, y))
    return Product(
        bytes=moved,
        rate=moved / taken,
        triad=triad_rate(moved),
        triad_by_threads=triad_rate(moved, threads=True),
        shared=count >= BLOCKS.many,
    )


def triad_rate(moved: int = LARGE, *, threads: bool = False) -> float:
    """Return the rate of the triad over ``moved`` bytes, by one thread or all, bytes per second."""
    count = max(1, moved // 24)
    a, b, c = np.empty(count), np.ones(count), np.ones(count)
    loop = stream.triad_by_threads if threads else stream.triad
    return 24 * count / fastest(lambda: loop(a, b, c, 3.0))


def fastest(work: Callable[[], object]) -> float:
    """Return the shortest time of a call, s; short ones are called often enough to be seen."""
    work()
    start = perf_counter()
    work()
    calls = max(1, int(2e-3 / max(1e-9, perf_counter() - start)))
    best, begun = np.inf, perf_counter()
    for _ in range(REPEATS):
        start = perf_counter()
        for _ in range(calls):
            work()
        best = min(best, (perf_counter() - start) / calls)
        if perf_counter() - begun > PATIENCE:
            break
    return float(best)
