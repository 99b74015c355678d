"""Loads at points and along lines, which move with their blocks, and moments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart, energy_of_linear
from clast.block.displacement import basis
from clast.model.factors import factors_at
from clast.model.model import Floats, Ints, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Loads:
    """Point and line loads: T^T f at a point, L T(midpoint)^T q along a line of length L.

    The midpoint is exact for a uniform traction q because T is linear.
    """

    def begin(self, model: Model) -> None:
        """Return nothing: the loads are known beforehand."""

    def share(self, start: StepStart, state: None) -> Contribution:
        """Return the generalised force of each load, times its factor when forces are taken."""
        model, midway = start.model, start.midway
        at, length = _places(model, midway.points)
        block = np.concatenate([model.point_loads.block, model.line_loads.block])
        force = np.concatenate(
            [model.point_loads.force, length[:, None] * model.line_loads.traction]
        )
        number = np.concatenate([model.point_loads.factor, model.line_loads.factor])
        force = factors_at(model.factors, number, start.time_of_forces)[:, None] * force
        rows = basis(at - midway.centroid[block])
        return Contribution(block=block, force=np.einsum("kxi,kx->ki", rows, force))

    def finish(
        self, start: StepStart, state: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the loads, which comes from outside.

        In a static step, which may turn blocks far, it is that along the real way.
        """
        work, _ = energy_of_linear(share, solution.displacement)
        brought = work
        if start.clock is not None:
            before, after = (
                _places(start.model, one)[0] for one in (start.midway.points, solution.points)
            )
            brought = float(np.sum(share.force[:, :2] * (after - before)))
        return ActionResult(work=work, ledger=Ledger(loads=brought))


def _places(model: Model, points: Floats) -> tuple[Floats, Floats]:
    """Return where the loads act, m, (k, 2), and lengths of line loads, m, from ``points``."""
    slices = model.point_slices
    first, last = points[slices.line_start], points[slices.line_end]
    at = np.concatenate([points[slices.loaded], 0.5 * (first + last)])
    return at, np.hypot(*(last - first).T)


@dataclass(frozen=True, kw_only=True, eq=False)
class Moments:
    """Moments on blocks, the third component of their generalised forces."""

    block: Ints
    """Block of each, shape (k,)."""
    moment: Floats
    """Size of each, N, counter-clockwise, shape (k,)."""
    factor: Ints
    """Which of ``Model.factors`` each is multiplied by, shape (k,)."""
    tables: tuple[str, ...]
    """Names of these tables."""

    def begin(self, model: Model) -> None:
        """Return nothing: the moments are known beforehand."""

    def share(self, start: StepStart, state: None) -> Contribution:
        """Return each moment, times its factor when forces are taken."""
        factors = factors_at(start.model.factors, self.factor, start.time_of_forces)
        force = np.zeros((len(self.block), 6))
        force[:, 2] = factors * self.moment
        return Contribution(block=self.block, force=force)

    def finish(
        self, start: StepStart, state: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the moments, which comes from outside."""
        work, _ = energy_of_linear(share, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(loads=work))
