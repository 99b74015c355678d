"""Damping of all blocks: by mass and elasticity, adapted to the motion, or by stops at its peaks.

    f = -C d/h,    C = c M + s K

with d/h the mean velocity of a step and K the elasticity of the blocks.  The force takes the energy
d.C d/h from every step, which cannot be negative.  Contacts are not part of K: a dashpot in them
would pull where they open.  A stage may damp otherwise than the one before: all kinds carry the
same state.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clast.actions.action import Done, Share, Solution, StepStart, energy_of_linear
from clast.model.model import Floats, Model
from clast.model.state import Ledger


def _none_yet() -> Floats:
    return np.zeros((0, 6))


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What damping knows of the steps before."""

    frequency: float = 0.0
    """Circular frequency of the last step's motion, 1/s."""
    force: Floats = field(default_factory=_none_yet)
    """All forces on each block at its end but damping, (n, 6); none before the first step."""
    kinetic: float = 0.0
    """Kinetic energy at the start of the last step, J/m; 0 after a stop."""


@dataclass(frozen=True)
class Undamped:
    """No damping."""

    def begin(self, model: Model) -> None:
        """Return what is known before the first step: nothing."""

    def share(self, start: StepStart, own: Motion | None) -> Share:
        """Return nothing."""
        return Share()

    def finish(
        self, start: StepStart, own: Motion | None, share: Share, solution: Solution
    ) -> Done:
        """Return that nothing was done."""
        return Done(work=0.0, ledger=Ledger())


@dataclass(frozen=True)
class Rayleigh:
    """C = mass M + stiffness K: a motion of frequency w has the ratio (mass/w + stiffness w)/2.

    ``mass`` damps slow motion, that of whole blocks too; ``stiffness`` damps quick straining and
    no motion of a rigid block.
    """

    mass: float = 0.0
    """Damping by mass, 1/s."""
    stiffness: float = 0.0
    """Damping by the elasticity of the blocks, s."""

    def begin(self, model: Model) -> None:
        """Return what is known before the first step: nothing."""

    def share(self, start: StepStart, own: Motion | None) -> Share:
        """Return C/h as a stiffness."""
        model = start.model
        matrix = self.mass / start.step * start.frames.mass_matrix
        elastic = self.stiffness / start.step * model.area[:, None, None] * model.elasticity
        matrix[:, 3:, 3:] += elastic
        return _resistance(matrix)

    def finish(
        self, start: StepStart, own: Motion | None, share: Share, solution: Solution
    ) -> Done:
        """Return the energy that damping has taken."""
        return _taken(share, solution, None)


@dataclass(frozen=True)
class Adaptive:
    """Mass damping with the ratio ``ratio`` of the frequency in which the blocks move just now.

    c = 2 ratio w,  w^2 = d.K d / d.M d  with K d the change of all forces in the last step
    (Underwood 1983): what falls or slides freely changes no forces and is not damped.
    """

    ratio: float = 0.8
    """Damping ratio; 1 is critical."""

    def begin(self, model: Model) -> None:
        """Return what is known before the first step: nothing."""

    def share(self, start: StepStart, own: Motion | None) -> Share:
        """Return c M/h as a stiffness; c h = 2 leaves no velocity, more would turn it round."""
        if own is None or own.frequency == 0.0:
            return Share()
        rate = min(2.0 * self.ratio * own.frequency, 2.0 / start.step)
        return _resistance(rate / start.step * start.frames.mass_matrix)

    def finish(
        self, start: StepStart, own: Motion | None, share: Share, solution: Solution
    ) -> Done:
        """Return the energy that damping has taken, and the frequency of the step."""
        moved, mass = solution.displacement, start.frames.mass_matrix
        force = np.einsum("nij,nj->ni", mass, solution.gained) / start.step
        if share.stiffness is not None:
            force += np.einsum("nij,nj->ni", share.stiffness, moved)
        square = 0.0
        inertia = float(np.vdot(moved, np.einsum("nij,nj->ni", mass, moved)))
        if own is not None and len(own.force) and inertia > 0.0:
            square = float(np.vdot(moved, own.force - force)) / inertia
        frequency = float(np.sqrt(max(square, 0.0)))
        return _taken(share, solution, Motion(frequency=frequency, force=force))


@dataclass(frozen=True)
class Kinetic:
    """All velocities to zero where the kinetic energy has passed a peak (Cundall 1982).

    Between two stops nothing is damped.
    """

    def begin(self, model: Model) -> None:
        """Return what is known before the first step: nothing."""

    def share(self, start: StepStart, own: Motion | None) -> Share:
        """Return that no velocity enters the step if the kinetic energy has fallen in the last."""
        passed = own is not None and start.state.ledger.kinetic < own.kinetic
        return Share(carried=0.0) if passed else Share()

    def finish(
        self, start: StepStart, own: Motion | None, share: Share, solution: Solution
    ) -> Done:
        """Return the kinetic energy that a stop has taken."""
        kinetic = start.state.ledger.kinetic
        if share.carried > 0.0:
            return Done(work=0.0, ledger=Ledger(), own=Motion(kinetic=kinetic))
        return Done(work=0.0, ledger=Ledger(damping=kinetic))


def _resistance(matrix: Floats) -> Share:
    """Return the share of a force that grows with the displacements by ``matrix`` (n, 6, 6)."""
    block = np.arange(len(matrix))
    return Share(block=block, force=np.zeros((len(block), 6)), stiffness=matrix)


def _taken(share: Share, solution: Solution, own: Motion | None) -> Done:
    """Return the energy that a resistance has taken in a step."""
    work, _ = energy_of_linear(share, solution.displacement)
    return Done(work=work, ledger=Ledger(damping=-work), own=own)
