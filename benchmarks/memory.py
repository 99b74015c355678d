"""The machine, its memory, and how near the matrix product of a step comes to its bandwidth."""

from __future__ import annotations

import os
import platform
import resource
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any, NoReturn

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, prange
from clast.errors import StepRejected
from clast.linear import pcg
from clast.linear.pattern import Patterns
from clast.linear.solvers import DIRECTION, PCG, IteratedMatrix
from clast.linear.system import BlockSystem
from clast.model.model import Model
from clast.model.state import State
from clast.step.method import Method, Workspace

PACKAGES = ("clast", "numba", "numpy", "scipy")
"""Packages whose versions are kept with every measurement."""
REPEATS = 7
"""Times that something is measured; the fastest counts."""
SECONDS_MAX = 2.0
"""Measuring ends early after this many seconds."""
TRIAD_BYTES = 192 * 2**20
"""Bytes of the triad that measures main memory: more than any cache holds."""


def this_machine(packages: tuple[str, ...] = PACKAGES) -> dict[str, Any]:
    """Return processor, cores, memory, bytes, system and versions of ``packages``, for JSON."""
    affinity = getattr(os, "sched_getaffinity", None)
    return {
        "cpu": _processor(),
        "cores": len(affinity(0)) if affinity else os.cpu_count() or 1,
        "memory": _memory(),
        "system": platform.system(),
        "versions": {
            "python": platform.python_version(),
            **{name: _version(name) for name in packages},
        },
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _memory() -> int:
    """Return the main memory, bytes; 0 where it is not known."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError):
        return 0


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def peak_memory() -> int:
    """Return the largest resident memory of this process until now, bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak if sys.platform == "darwin" else 1024 * peak)


def forget_peak() -> bool:
    """Let the peak begin anew with the memory held now; return False where the system cannot."""
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        return False
    return True


def bytes_of_arrays(*things: object) -> int:
    """Return the bytes of all arrays that things have as fields, shared ones counted once."""
    sizes: dict[int, int] = {}
    for thing in things:
        for value in vars(thing).values():
            if isinstance(value, np.ndarray):
                owner = value
                while isinstance(owner.base, np.ndarray):
                    owner = owner.base
                sizes[id(owner)] = owner.nbytes
    return sum(sizes.values())


# --- the matrix product ----------------------------------------------------------------------


class _Captured(Exception):
    """Carries the system of a step out of it."""

    def __init__(self, system: BlockSystem) -> None:
        super().__init__()
        self.system = system


class _Capture:
    """A solver that does not solve."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> NoReturn:
        """Hand the system to the caller of the step."""
        raise _Captured(system)


def system_of_step(model: Model, method: Method, state: State, step: float) -> BlockSystem | None:
    """Return the first system of a step from ``state``, or None where there is nothing to solve.

    The blocks are given a push, for where they rest there is nothing either.
    """
    velocity = state.velocity.copy()
    velocity[~model.fixed, :2] += step * model.gravity
    capture = replace(method, solver=_Capture())
    pushed = replace(state, velocity=velocity)
    try:
        method.process.step(model, capture, pushed, step, Workspace())
    except _Captured as captured:
        return captured.system
    except StepRejected:
        pass
    return None


def matrix_of_directions(system: BlockSystem) -> tuple[Any, ...]:
    """Return K and its pattern as pcg.multiply takes them.

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


def measure_product(system: BlockSystem) -> dict[str, Any] | None:
    """Return the rate of K x beside that of the triad over as many bytes, for JSON.

    Both are held by the same caches then; small systems never come near main memory.  None where
    the system is singular.
    """
    try:
        matrix = matrix_of_directions(system)
    except StepRejected:
        return None
    count = len(matrix[0][0])
    x, y = pcg.vector(count), pcg.vector(count)
    x[:, :6] = 1.0
    size = bytes_of_product(matrix)
    rate = size / fastest(lambda: pcg.multiply(*matrix, x, y))
    alone, together = triad_rate(size), triad_rate(size, threads=True)
    shared = count >= BLOCKS.many  # threads share the product
    return {
        "bytes": size,
        "rate": rate,
        "triad": alone,
        "triad_by_threads": together,
        "shared": shared,
        "share": rate / (together if shared else alone),
    }


@kernel()
def triad(a, b, c, scale):
    """Write b + scale c into a, each of shape (n,); 24 bytes are moved for each element.

    The triad of the STREAM benchmark: a loop that does nothing but move memory.
    """
    for i in range(len(a)):
        a[i] = b[i] + scale * c[i]


@kernel(parallel=True)
def triad_by_threads(a, b, c, scale):
    """Do the same with all threads."""
    for i in prange(len(a)):
        a[i] = b[i] + scale * c[i]


def triad_rate(size: int = TRIAD_BYTES, *, threads: bool = False) -> float:
    """Return the rate of the triad over ``size`` bytes, by one thread or all, bytes per second."""
    count = max(1, size // 24)
    a, b, c = np.empty(count), np.ones(count), np.ones(count)
    loop = triad_by_threads if threads else triad
    return 24 * count / fastest(lambda: loop(a, b, c, 3.0))


def fastest(work: Callable[[], object]) -> float:
    """Return the shortest time of a call, s; short ones are called often enough to be seen."""
    work()
    start = perf_counter()
    work()
    calls = max(1, int(2e-3 / max(1e-9, perf_counter() - start)))
    best, first = np.inf, perf_counter()
    for _ in range(REPEATS):
        start = perf_counter()
        for _ in range(calls):
            work()
        best = min(best, (perf_counter() - start) / calls)
        if perf_counter() - first > SECONDS_MAX:
            break
    return float(best)
