"""Which reactions are recorded: those of supports one by one, and their totals."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def _none() -> Ints:
    return np.zeros((0, 2), np.int64)


@dataclass(frozen=True, kw_only=True, repr=False)
class Reactions:
    """The reactions of a model, k of them, each the sum over some supports."""

    name: tuple[str, ...] = ()
    """Name of each."""
    about: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """Point about which its moment is taken, m, shape (k, 2), relative to the model's origin."""
    of_block: Ints = field(default_factory=_none)
    """Reaction and the block that it holds or moves, shape (b, 2)."""
    of_fixed_point: Ints = field(default_factory=_none)
    """Reaction and the fixed point that belongs to it, shape (p, 2)."""
    of_viscous_edge: Ints = field(default_factory=_none)
    """Reaction and the viscous edge that belongs to it, shape (e, 2)."""
    of_ground: Ints = field(default_factory=_none)
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
