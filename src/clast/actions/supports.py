"""Fixed points: stiff springs to anchors that stand still or move with the ground.

    f = -k (x - anchor),    x = x0 + T d at the end of the step

As all forces of a step they act with their stretch at its end, when the anchors have moved; or with
the mean of those at its start and its end, where the step takes its forces half way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart, energy_of_linear
from clast.block.displacement import basis
from clast.model.ground_motion import Still
from clast.model.model import Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Supports:
    """The fixed points of the model."""

    stiffness: float
    """Stiffness of the springs, N/m per m."""

    def begin(self, model: Model) -> None:
        """Return nothing: the stretch of the springs follows from where the points are."""

    def share(self, start: StepStart, own: None) -> Contribution:
        """Return the forces of the springs and their stiffness k T^T T."""
        rows, drift = self._rows(start)
        k = self.stiffness
        stiffness = np.add.reduce(rows[:, :, :, None] * rows[:, :, None], axis=1)  # T^T T
        return Contribution(
            block=start.model.fixed_points.block,
            force=-k * np.add.reduce(rows * drift[:, :, None], axis=1),
            stiffness=start.forces_at * k * stiffness,
            forces_at=start.forces_at,
        )

    def finish(
        self, start: StepStart, own: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the springs, their stored energy, and the work of a moving ground.

        The ground moves the anchors by u under the forces of the step; that alone stretches a
        spring, by -u, if its block does not move.
        """
        work, stored = energy_of_linear(share, solution.displacement)
        ground = start.model.ground_motion
        if isinstance(ground, Still):
            return ActionResult(work=work, ledger=Ledger(fixed_points=stored))
        before, after = (ground.anchor_displacement(t) for t in (start.state.time, start.end))
        moved = after - before
        if not moved.any():
            return ActionResult(work=work, ledger=Ledger(fixed_points=stored))
        rows, drift = self._rows(start)
        # what held an excavated block does not stretch any more
        moved = np.where(start.model.gone[share.block, None], 0.0, moved)
        followed = np.einsum("kxi,ki->kx", rows, solution.displacement[share.block])
        at = start.forces_at
        brought = -self.stiffness * float(np.sum((drift + at * followed) * moved))
        mean = (1.0 - at) * followed + drift + (at - 0.5) * moved
        stored -= self.stiffness * float(np.sum(mean * moved))
        return ActionResult(work=work, ledger=Ledger(fixed_points=stored, loads=brought))

    def _rows(self, start: StepStart) -> tuple[Floats, Floats]:
        """Return T (k, 2, 6) at the points and their distance (k, 2) from the anchors, m.

        The anchors are where they are when forces are taken: between those of start and end.
        """
        points, ground = start.model.fixed_points, start.model.ground_motion
        at = start.state.points[start.model.point_slices.fixed]
        anchor = points.at
        if not isinstance(ground, Still):
            before, after = (ground.anchor_displacement(t) for t in (start.state.time, start.end))
            share = start.forces_at
            anchor = anchor + ((1.0 - share) * before + share * after)
        return basis(at - start.frames.centroid[points.block]), at - anchor
