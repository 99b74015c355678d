"""Rock bolts: the springs that the bolts of a model consist of.

A bolt between two points is one spring; a grouted one has a spring wherever it crosses a joint.
Forces are N per metre of thickness, tension positive.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def _no_floats() -> Floats:
    return np.zeros(0)


def _no_points() -> Floats:
    return np.zeros((0, 2))


def _no_ints() -> Ints:
    return np.zeros(0, np.int64)


def _no_pairs() -> Ints:
    return np.zeros((0, 2), np.int64)


def _no_bools() -> Bools:
    return np.zeros(0, np.bool_)


@dataclass(frozen=True, kw_only=True, repr=False)
class Bolts:
    """The bolts of a model: k bolts, the q points that they lie along, and m springs."""

    name: tuple[str, ...] = ()
    """Name of each bolt."""
    kind: tuple[str, ...] = ()
    """Name of the kind of each bolt."""
    group: tuple[str, ...] = ()
    """Name of the pattern that each bolt is of, "" for none."""
    stage: tuple[str, ...] = ()
    """Name of the stage that installs each bolt, "" where it is there from the start."""
    installed: Bools = field(default_factory=_no_bools)
    """True where a bolt is there, shape (k,)."""
    locked: Bools = field(default_factory=_no_bools)
    """True where the jack of a bolt is off; only jacked ones ask for it, shape (k,)."""
    block: Ints = field(default_factory=_no_ints)
    """Block that each point moves with, shape (q,)."""
    at: Floats = field(default_factory=_no_points)
    """Points at the start, from head to toe of one bolt after the other, m, shape (q, 2)."""
    bolt: Ints = field(default_factory=_no_ints)
    """Bolt of each point, shape (q,)."""
    ends: Ints = field(default_factory=_no_pairs)
    """Points between which each spring acts, shape (m, 2)."""
    stiffness: Floats = field(default_factory=_no_floats)
    """Stiffness of each spring s, N/m per m, shape (m,)."""
    yield_force: Floats = field(default_factory=_no_floats)
    """Force at which each spring yields, N/m, inf: never, shape (m,)."""
    rupture: Floats = field(default_factory=_no_floats)
    """Elongation at which each spring breaks, m, inf: never, shape (m,)."""
    pretension: Floats = field(default_factory=_no_floats)
    """Force that each spring is installed with, N/m, shape (m,)."""
    compression: Bools = field(default_factory=_no_bools)
    """True where a spring carries compression, shape (m,)."""
    jacked: Bools = field(default_factory=_no_bools)
    """True where a jack holds the pretension until it is locked, shape (m,)."""

    def __len__(self) -> int:
        return len(self.name)

    def __repr__(self) -> str:
        there = int(self.installed.sum())
        return f"Bolts({len(self)}, {there} installed, {len(self.stiffness)} springs)"

    @property
    def of_spring(self) -> Ints:
        """Bolt of each spring, shape (m,)."""
        return np.asarray(self.bolt[self.ends[:, 0]])

    @property
    def blocks(self) -> Ints:
        """The two blocks of each spring, shape (m, 2)."""
        return np.asarray(self.block[self.ends])

    def named(self, names: Iterable[str]) -> Bools:
        """Return True for bolts whose name, pattern or kind is among ``names``, shape (k,)."""
        wanted = set(names)
        called = zip(self.name, self.group, self.kind, strict=True)
        return np.array([bool(wanted & set(each)) for each in called], np.bool_)

    def at_stage(self, stage: str, install: Iterable[str] = ()) -> Bolts:
        """Return the bolts when a stage begins, which installs some of them.

        Those are the ones that name the ``stage``, and those with a name, pattern or kind in
        ``install``.
        """
        own = np.array([one == stage for one in self.stage], np.bool_)
        return replace(
            self,
            installed=self.installed | own | self.named(install),
        )

    def locked_by_now(self) -> Bolts:
        """Return the bolts with the jacks off all that are installed."""
        return replace(self, locked=self.locked | self.installed)

    def without(self, names: Iterable[str]) -> Bolts:
        """Return the bolts with those of these names, patterns or kinds not yet installed."""
        return replace(self, installed=self.installed & ~self.named(names))
