"""The machine that something was measured on, and its memory."""

from __future__ import annotations

import os
import platform
import resource
import sys
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

PACKAGES = ("clast", "numba", "numpy", "scipy")
"""Packages whose versions are kept with every measurement."""


@dataclass(frozen=True, kw_only=True)
class Machine:
    """The machine on which a measurement depends."""

    cpu: str
    """Name of the processor."""
    cores: int
    """Cores that this process may use."""
    memory: int
    """Main memory, bytes; 0 where it is not known."""
    system: str
    """Operating system."""
    versions: dict[str, str]
    """Versions of Python and of packages."""

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        return asdict(self)

    def __str__(self) -> str:
        return (
            f"{self.cpu}, {self.cores} cores, {self.memory / 2**30:.3g} GiB, {self.system}; "
            + ", ".join(f"{name} {number}" for name, number in self.versions.items())
        )


def this_machine(packages: tuple[str, ...] = PACKAGES) -> Machine:
    """Return the machine that this runs on, with the versions of ``packages``."""
    return Machine(
        cpu=_cpu(),
        cores=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else _cores(),
        memory=_memory(),
        system=platform.system(),
        versions={
            "python": platform.python_version(),
            **{name: _version(name) for name in packages},
        },
    )


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


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _cores() -> int:
    return os.cpu_count() or 1


def _memory() -> int:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError):
        return 0


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
