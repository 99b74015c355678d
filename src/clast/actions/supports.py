"""Fixed points: stiff springs to anchors at rest, moving with the ground, or with a [[motion]].

    f = -k (x - anchor),    x = x0 + T d at the end of the step

Like all forces of a step they are those of the stretch at its end, when the anchors have moved; or
of the mean stretch of start and end, if the step evaluates its forces halfway.

A point with a prescribed motion, a [[motion]], stays at its anchor to the last digits: its force is

    f = lambda - k (x - anchor)

with the multiplier lambda from the last step, and the step is solved again with lambda = f until
the point has reached its anchor.  Such a force stores no energy; its work is that of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.block.displacement import basis
from clast.model.ground_motion import Still
from clast.model.model import Bools, Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Supports(Action):
    """The fixed points of the model."""

    stiffness: float
    """Stiffness of the springs, N/m per m."""
    support: ClassVar[str] = "fixed points"
    """Kind of support in its shares, row by row, for their reactions."""

    def begin(self, model: Model) -> Floats | None:
        """Return the forces on the points, (k, 2), if some may have a prescribed motion.

        Otherwise None: the stretch of the springs follows from where the points are.
        """
        prescribed = any(hasattr(action, "anchors") for action in model.actions)
        return np.zeros((len(model.fixed_points.block), 2)) if prescribed else None

    def contribution(self, start: StepStart, state: Floats | None) -> Contribution:
        """Return the forces of the springs and their stiffness k T^T T."""
        rows, drift, prescribed = self._rows(start)
        k, place = self.stiffness, np.where(prescribed, 1.0, start.forces_at)
        stiffness = np.add.reduce(rows[:, :, :, None] * rows[:, :, None], axis=1)  # T^T T
        pull = -k * drift
        if state is not None:
            pull[prescribed] += state[prescribed]
        return Contribution(
            block=start.model.fixed_points.block,
            force=np.add.reduce(rows * pull[:, :, None], axis=1),
            stiffness=place[:, None, None] * (k * stiffness),
            forces_at=start.forces_at,
        )

    def again(
        self, start: StepStart, contribution: Contribution, displacement: Floats
    ) -> Contribution | None:
        """Return the contribution with new multipliers if prescribed points miss their anchors.

        ``displacement`` (n, 6) is that of blocks in the last solution.  None if no point misses.
        """
        if not start.model.actions:
            return None
        rows, drift, prescribed = self._rows(start)
        missed = drift + self._followed(rows, contribution, displacement)
        size = float(np.hypot(*np.ptp(start.model.vertices, axis=0)))
        # Tolerance of the position of a point with a prescribed motion, as a share of the system
        if not prescribed.any() or float(np.abs(missed[prescribed]).max()) <= 1e-13 * size:
            return None
        more = np.where(prescribed[:, None], -self.stiffness * missed, 0.0)
        return replace(
            contribution, force=contribution.force + np.add.reduce(rows * more[:, :, None], axis=1)
        )

    def finish(
        self, start: StepStart, state: Floats | None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return work and energy of the springs, and the work of a moving ground.

        The ground moves the anchors by u under the forces of the step; that alone stretches a
        spring, by -u, if its block does not move.
        """
        work, stored = energy_of_linear(contribution, solution.displacement)
        ground = start.model.ground_motion
        if state is None and isinstance(ground, Still):
            return ActionResult(work=work, ledger=Ledger(fixed_points=stored), state=state)
        rows, drift, prescribed = self._rows(start)
        motions, forces = 0.0, state
        if state is not None:
            followed = self._followed(rows, contribution, solution.displacement)
            place = np.where(prescribed, 1.0, start.forces_at)[:, None]
            # T begins with the identity
            forces = contribution.force[:, :2] - place * self.stiffness * followed
            by_springs = _rows_of(contribution, ~prescribed)
            stored = energy_of_linear(by_springs, solution.displacement)[1]
            motions = float(np.sum((forces * followed)[prescribed]))
        change = Ledger(fixed_points=stored, motions=motions)
        if isinstance(ground, Still):
            return ActionResult(work=work, ledger=change, state=forces)
        before, after = (ground.anchor_displacement(t) for t in (start.state.time, start.end))
        moved = after - before
        if not moved.any():
            return ActionResult(work=work, ledger=change, state=forces)
        # what held an excavated block does not stretch any more
        still = start.model.absent[contribution.block] | prescribed
        moved = np.where(still[:, None], 0.0, moved)
        followed = self._followed(rows, contribution, solution.displacement)
        at = start.forces_at
        brought = -self.stiffness * float(np.sum((drift + at * followed) * moved))
        mean = (1.0 - at) * followed + drift + (at - 0.5) * moved
        stored -= self.stiffness * float(np.sum(mean * moved))
        change = replace(change, fixed_points=stored, loads=brought)
        return ActionResult(work=work, ledger=change, state=forces)

    def _followed(self, rows: Floats, contribution: Contribution, displacement: Floats) -> Floats:
        """Return the movement of the points, m, (k, 2)."""
        return np.asarray(np.einsum("kxi,ki->kx", rows, displacement[contribution.block]))

    def _rows(self, start: StepStart) -> tuple[Floats, Floats, Bools]:
        """Return T (k, 2, 6) at points, offsets (k, 2) from anchors, m, and which are prescribed.

        Anchors are where they are at the time at which forces are evaluated; those with a
        prescribed motion where they are at the end of the step.
        """
        points, ground = start.model.fixed_points, start.model.ground_motion
        at = start.state.points[start.model.point_slices.fixed]
        anchor, prescribed = points.at, np.zeros(len(points.at), np.bool_)
        if not isinstance(ground, Still):
            before, after = (ground.anchor_displacement(t) for t in (start.state.time, start.end))
            share = start.forces_at
            anchor = anchor + ((1.0 - share) * before + share * after)
        for action in start.model.actions:
            if hasattr(action, "anchors"):
                number, displacement = action.anchors(start.model, start.end)
                anchor = anchor.copy()
                anchor[number] = points.at[number] + displacement
                prescribed[number] = True
        return basis(at - start.frames.centroid[points.block]), at - anchor, prescribed


def _rows_of(contribution: Contribution, wanted: Bools) -> Contribution:
    """Return some rows of a contribution."""
    stiffness = None if contribution.stiffness is None else contribution.stiffness[wanted]
    return replace(
        contribution,
        block=contribution.block[wanted],
        force=contribution.force[wanted],
        stiffness=stiffness,
    )
