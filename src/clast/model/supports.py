"""Supports: rock bolts, joints of linings, links, and the reactions that are recorded.

A bolt between two points is one spring; a grouted one has a spring wherever it crosses a joint.
Forces are N per metre of thickness, tension positive.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from clast.model.arrays import Bools, Floats, Ints, no_bools, no_floats, no_ints


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
    installed: Bools = no_bools()
    """True where a bolt is there, shape (k,)."""
    locked: Bools = no_bools()
    """True where the jack of a bolt is off; only jacked ones ask for it, shape (k,)."""
    block: Ints = no_ints()
    """Block that each point moves with, shape (q,)."""
    at: Floats = no_floats(2)
    """Points at the start, from head to toe of one bolt after the other, m, shape (q, 2)."""
    bolt: Ints = no_ints()
    """Bolt of each point, shape (q,)."""
    ends: Ints = no_ints(2)
    """Points between which each spring acts, shape (m, 2)."""
    stiffness: Floats = no_floats()
    """Stiffness of each spring s, N/m per m, shape (m,)."""
    yield_force: Floats = no_floats()
    """Force at which each spring yields, N/m, inf: never, shape (m,)."""
    rupture: Floats = no_floats()
    """Elongation at which each spring breaks, m, inf: never, shape (m,)."""
    pretension: Floats = no_floats()
    """Force that each spring is installed with, N/m, shape (m,)."""
    compression: Bools = no_bools()
    """True where a spring carries compression, shape (m,)."""
    jacked: Bools = no_bools()
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
        return replace(self, installed=self.installed | own | self.named(install))

    def locked_by_now(self) -> Bolts:
        """Return the bolts with the jacks off all that are installed."""
        return replace(self, locked=self.locked | self.installed)

    def without(self, names: Iterable[str]) -> Bolts:
        """Return the bolts with those of these names, patterns or kinds not yet installed."""
        return replace(self, installed=self.installed & ~self.named(names))


@dataclass(frozen=True, kw_only=True, repr=False)
class LiningJoints:
    """The k joints of all linings, at which their forces are known."""

    name: tuple[str, ...] = ()
    """Name of each: that of its lining, a slash and its number."""
    along: NDArray[np.float64] = no_floats()
    """Where it is along the middle of its lining, m, shape (k,)."""
    face: NDArray[np.int64] = no_ints(2)
    """Vertices of the segment beside it, outside and inside, shape (k, 2)."""
    section: NDArray[np.float64] = no_floats(3)
    """Its thickness, m, and strengths in tension and compression, Pa, infinite for none, shape
    (k, 3); (0, 3) in files of older versions."""

    @property
    def linings(self) -> tuple[str, ...]:
        """Names of the linings."""
        return tuple(dict.fromkeys(name.rpartition("/")[0] for name in self.name))

    def of(self, lining: str) -> NDArray[np.int64]:
        """Return the joints of a lining, shape (j,)."""
        own = [k for k, name in enumerate(self.name) if name.rpartition("/")[0] == lining]
        return np.array(own, np.int64)


GROUND = -1
"""Number of the ground in place of a block: it is none, and moves with the ground motion alone."""
FREE, SOFT, RIGID = 0, 1, 2
"""Action of a link along, across and against rotation: nothing, a spring or dashpot, rigid."""


@dataclass(frozen=True, kw_only=True)
class LinkLines:
    """Places of k links at the start."""

    name: tuple[str, ...] = ()
    """Name of each."""
    block: Ints = no_ints(2)
    """Its two blocks, or one and GROUND, shape (k, 2)."""
    at: Floats = no_floats(2)
    """Its point, m, shape (k, 2)."""
    along: Floats = no_floats(2)
    """Unit vector of its direction, shape (k, 2)."""
    holds: Ints = no_ints(3)
    """FREE, SOFT or RIGID: along, across, rotation, shape (k, 3)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Reactions:
    """The reactions of a model, k of them, each the sum over some supports."""

    name: tuple[str, ...] = ()
    """Name of each."""
    about: Floats = no_floats(2)
    """Point about which its moment is taken, m, shape (k, 2), relative to the model's origin."""
    of_block: Ints = no_ints(2)
    """Reaction and the block that it holds or moves, shape (b, 2)."""
    of_fixed_point: Ints = no_ints(2)
    """Reaction and the fixed point that belongs to it, shape (p, 2)."""
    of_viscous_edge: Ints = no_ints(2)
    """Reaction and the viscous edge that belongs to it, shape (e, 2)."""
    of_outline: Ints = no_ints(2)
    """Reaction and the first vertex of an edge under in-situ stress that belongs to it, (o, 2)."""
    of_ground: Ints = no_ints(2)
    """Reaction that is the sum over all links and linings on the ground, and 0, shape (g, 2)."""

    def __len__(self) -> int:
        return len(self.name)

    def __repr__(self) -> str:
        return f"Reactions({', '.join(self.name)})"


def numbered(asked: Bools) -> tuple[Ints, Ints]:
    """Return the blocks (s,) that are ``asked`` for (n,), and the number of each among them.

    Others have the number -1, shape (n,).
    """
    block = np.flatnonzero(asked)
    number = np.full(len(asked), -1)
    number[block] = np.arange(len(block))
    return block, number
