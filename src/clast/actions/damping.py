"""Damping of all blocks: by mass and elasticity, adapted to the motion, or by stops at its peaks.

    f = -C d/h,    C = c M + s K

is Rayleigh's, with d/h the mean velocity of a step and K the elasticity of the blocks.  It takes
the energy d.C d/h from every step, which cannot be negative.  Contacts are not part of K: a dashpot
in them would pull where they open.  The other kinds let a share of the velocities enter a step and
take the kinetic energy of the rest; they are for static stages.  A stage may damp otherwise than
the one before: all kinds carry the same state.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clast.actions.action import (
    NO_CONTRIBUTION,
    NOTHING,
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.model.model import Floats
from clast.model.state import Ledger


@dataclass(frozen=True, kw_only=True)
class DampingState:
    """The memory of damping: the motion of the steps before."""

    frequency: float = 0.0
    """Circular frequency of the last step's motion, 1/s."""
    force: Floats = field(default_factory=lambda: np.zeros((0, 6)))
    """All forces on each block at its end but damping, (n, 6); none before the first step."""
    kinetic: float = 0.0
    """Kinetic energy at the start of the last step, J/m; 0 after a stop."""


Memory = DampingState | None
"""None before the first step, and of damping that needs none."""


@dataclass(frozen=True)
class Undamped(Action):
    """No damping."""

    def contribution(self, start: StepStart, state: Memory) -> Contribution:
        """Return nothing."""
        return NO_CONTRIBUTION

    def finish(
        self, start: StepStart, state: Memory, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return that nothing was done."""
        return NOTHING


@dataclass(frozen=True)
class Rayleigh(Action):
    """C = mass M + stiffness K: a motion of frequency w has the ratio (mass/w + stiffness w)/2.

    ``mass`` damps slow motion, that of whole blocks too; ``stiffness`` damps quick straining and
    no motion of a rigid block.
    """

    mass: float = 0.0
    """Damping by mass, 1/s."""
    stiffness: float = 0.0
    """Damping by the elasticity of the blocks, s."""

    def contribution(self, start: StepStart, state: Memory) -> Contribution:
        """Return C/h as a stiffness."""
        model = start.model
        matrix = self.mass / start.step * start.frames.mass_matrix
        elastic = self.stiffness / start.step * model.area[:, None, None] * model.elasticity
        matrix[:, 3:, 3:] += elastic
        block = np.arange(len(matrix))
        return Contribution(block=block, force=np.zeros((len(block), 6)), stiffness=matrix)

    def finish(
        self, start: StepStart, state: Memory, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the energy that damping has taken."""
        work, _ = energy_of_linear(contribution, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(damping=-work))


@dataclass(frozen=True)
class Adaptive(Action):
    """Mass damping with the ratio ``ratio`` at the current frequency of the blocks.

    c = 2 ratio w, w^2 = d.K d / d.M d with K d the change of all forces in the last step (Underwood
    1983): a block that falls or slides freely changes no forces and is not damped.  Velocities
    enter a step times exp(-c h), the exact solution of mass damping for any c h.
    """

    ratio: float = 0.8
    """Damping ratio; 1 is critical."""

    def contribution(self, start: StepStart, state: Memory) -> Contribution:
        """Return the share of the velocities that damping leaves."""
        frequency = 0.0 if state is None else state.frequency
        return Contribution(carried=float(np.exp(-2.0 * self.ratio * frequency * start.step)))

    def finish(
        self, start: StepStart, state: Memory, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the energy that damping has taken, and the frequency of the step."""
        moved, mass = solution.displacement, start.frames.mass_matrix
        force = np.einsum("nij,nj->ni", mass, solution.gained) / start.step
        momentum = np.einsum("nij,nj->ni", mass, moved)
        square, inertia = 0.0, float(np.sum(moved * momentum))
        if state is not None and len(state.force) and inertia > 0.0:
            square = max(0.0, float(np.sum(moved * (state.force - force))) / inertia)
        frequency = float(np.sqrt(square))
        entered = solution.velocity
        before = np.einsum("nij,nj->ni", mass, entered)
        if float(np.sum(before * (entered + solution.gained))) < 0.0:
            frequency = max(frequency, np.pi / start.step)  # the motion turned round in the step
        return _slowed(start, contribution, DampingState(frequency=frequency, force=force))


@dataclass(frozen=True)
class Kinetic(Action):
    """Sets all velocities to zero after each peak of the kinetic energy (Cundall 1982).

    Between two stops nothing is damped.
    """

    def contribution(self, start: StepStart, state: Memory) -> Contribution:
        """Return that no velocity enters the step if the kinetic energy has fallen in the last."""
        passed = state is not None and start.state.ledger.kinetic < state.kinetic
        return Contribution(carried=0.0) if passed else Contribution()

    def finish(
        self, start: StepStart, state: Memory, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the kinetic energy that a stop has taken."""
        kept = contribution.carried * start.state.ledger.kinetic
        return _slowed(start, contribution, DampingState(kinetic=kept))


def _slowed(start: StepStart, contribution: Contribution, state: DampingState) -> ActionResult:
    """Return the kinetic energy that did not enter the step."""
    taken = (1.0 - contribution.carried**2) * start.state.ledger.kinetic
    return ActionResult(work=0.0, ledger=Ledger(damping=taken), state=state)
