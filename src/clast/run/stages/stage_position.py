"""Where a run is among its stages: all that it carries of them from step to step."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clast.model.model import Bools, Floats
from clast.model.stage_records import Mechanism, Mover, StageRecord
from clast.model.state import ReferenceState


def _no_values() -> Floats:
    return np.zeros(0)


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """How far from equilibrium a step ended."""

    force_ratio: float = np.inf
    """Largest unbalanced force on a block, as a share of all forces on it."""
    unbalanced: str = ""
    """Name of that block, "" where no force is out of balance."""
    speed: float = np.inf
    """Largest speed of a block, as a share of sqrt(g x its size)."""
    mover: Mover = field(default_factory=Mover)
    hindrance: str = ""
    """Why this is not an equilibrium; "" where it is."""
    balanced: bool = False
    """True where only things that change with time hinder it."""
    left: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """Force (x, y), N/m, and moment, N, out of balance on each block that they move, (n, 3)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class EquilibriumStreak:
    """Steps in a row that ended in equilibrium; n blocks, none where there are no such steps."""

    steps: int = 0
    time: float = 0.0
    """How long they took, s."""
    sliding: Bools = field(default_factory=lambda: np.zeros(0, np.bool_))
    """True where a block has slid along another in all of them, shape (n,)."""
    net: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """Movement of each block in them, m, shape (n, 2)."""
    path: Floats = field(default_factory=_no_values)
    """Length of its path, m, shape (n,)."""
    half: Floats = field(default_factory=_no_values)
    """The same in the first half of the steps, m, shape (n,)."""


@dataclass(frozen=True, kw_only=True)
class Position:
    """Where a run is among its stages."""

    starts: tuple[float, ...] = ()
    """When each stage that has begun did so, s; the last of them is the one that goes on."""
    steps: int = 0
    """Accepted steps in this stage."""
    seconds: float = 0.0
    """Wall time of these steps, s."""
    broken: int = 0
    """Bonds that have broken in it."""
    held: EquilibriumStreak = field(default_factory=EquilibriumStreak)
    """Steps in a row in equilibrium."""
    judged: Judgement = field(default_factory=Judgement)
    over: bool = False
    """True after the last step of the stage."""
    records: tuple[StageRecord, ...] = ()
    failures: tuple[tuple[str, Mechanism], ...] = ()
    """Stages that had no equilibrium, and how they failed."""
    reference: ReferenceState | None = None
    """Where displacements count from; None: the start of the run."""

    @property
    def number(self) -> int:
        """Number of the stage that goes on, from 0; -1 before the first."""
        return len(self.starts) - 1

    @property
    def start(self) -> float:
        """When it began, s."""
        return self.starts[-1]
