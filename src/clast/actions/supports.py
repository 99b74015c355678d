"""Fixed points: stiff springs to anchors that stand still or move with the ground.

    f = -k (x - anchor),    x = x0 + T d at the end of the step

As all forces of a step they act with their stretch at its end; the anchors have then moved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.action import Done, Share, Solution, StepStart
from clast.block.displacement import basis
from clast.model.model import Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Supports:
    """The fixed points of the model."""

    stiffness: float
    """Stiffness of the springs, N/m per m."""

    def begin(self, model: Model) -> None:
        """Return nothing: the stretch of the springs follows from where the points are."""

    def share(self, start: StepStart, own: None) -> Share:
        """Return the forces of the springs and their stiffness k T^T T."""
        rows, drift = self._rows(start)
        k = self.stiffness
        return Share(
            block=start.model.fixed_points.block,
            force=-k * np.einsum("kxi,kx->ki", rows, drift),
            stiffness=k * np.einsum("kxi,kxj->kij", rows, rows),
        )

    def finish(self, start: StepStart, own: None, share: Share, solution: Solution) -> Done:
        """Return the work of the springs, what they store, and what a moving ground has done."""
        rows, drift = self._rows(start)
        held = drift + np.einsum("kxi,ki->kx", rows, solution.displacement[share.block])
        ground = start.model.ground_motion
        moved = ground.anchor_displacement(start.end)
        moved = moved - ground.anchor_displacement(start.state.time)
        stored = self._energy(held) - self._energy(drift + moved)
        return Done(
            work=-self.stiffness * float(np.sum(held * (held - drift))),
            ledger=Ledger(fixed_points=stored, loads=-self.stiffness * float(np.sum(held * moved))),
        )

    def _rows(self, start: StepStart) -> tuple[Floats, Floats]:
        """Return T (k, 2, 6) at the points and their distance (k, 2) from the anchors, m."""
        points = start.model.fixed_points
        at = start.state.points[start.model.point_slices.fixed]
        anchor = points.at + start.model.ground_motion.anchor_displacement(start.end)
        return basis(at - start.frames.centroid[points.block]), at - anchor

    def _energy(self, stretch: Floats) -> float:
        """Return the energy of the springs, J/m; ``stretch`` (k, 2) in m."""
        return 0.5 * self.stiffness * float(np.sum(stretch**2))
