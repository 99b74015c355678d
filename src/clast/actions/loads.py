"""Loads: at points, along lines and on edges, which move with their blocks, and moments.

Their work comes from outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
    forces_at_points,
)
from clast.model.factors import factors_at
from clast.model.model import Floats, Ints, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Loads(Action):
    """Point and line loads: T^T f at a point, L T(midpoint)^T q along a line of length L.

    The midpoint is exact for a uniform traction q because T is linear.
    """

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return the generalised force of each load, times its factor when forces are taken."""
        points, lines, midway = start.model.point_loads, start.model.line_loads, start.midway
        at, length = _places(start.model, midway.points)
        block = np.concatenate([points.block, lines.block])
        force = np.concatenate([points.force, length[:, None] * lines.traction])
        number = np.concatenate([points.factor, lines.factor])
        factor = factors_at(start.model.factors, number, start.time_of_forces)
        return forces_at_points(block, at - midway.centroid[block], factor[:, None] * force)

    def finish(
        self, start: StepStart, state: None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the loads.

        In a static step, which may turn blocks far, that from outside is along the real path.
        """
        work, _ = energy_of_linear(contribution, solution.displacement)
        brought = work
        if start.clock is not None:
            before, after = (
                _places(start.model, one)[0] for one in (start.midway.points, solution.points)
            )
            brought = float(np.sum(contribution.force[:, :2] * (after - before)))
        return ActionResult(work=work, ledger=Ledger(loads=brought))


def _places(model: Model, points: Floats) -> tuple[Floats, Floats]:
    """Return where the loads act, m, (k, 2), and lengths of line loads, m, from ``points``."""
    slices = model.point_slices
    first, last = points[slices.line_start], points[slices.line_end]
    at = np.concatenate([points[slices.loaded], 0.5 * (first + last)])
    return at, np.hypot(*(last - first).T)


@dataclass(frozen=True, kw_only=True, eq=False)
class Moments(Action):
    """Moments on blocks, the third component of their generalised forces."""

    block: Ints
    """Block of each, shape (k,)."""
    moment: Floats
    """Size of each, N, counter-clockwise, shape (k,)."""
    factor: Ints
    """Which of ``Model.factors`` each is multiplied by, shape (k,)."""
    tables: tuple[str, ...]
    """Names of these tables."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return each moment, times its factor when forces are taken."""
        factors = factors_at(start.model.factors, self.factor, start.time_of_forces)
        force = np.zeros((len(self.block), 6))
        force[:, 2] = factors * self.moment
        return Contribution(block=self.block, force=force)


def pressure_forces(ends: Floats, pressure: Floats) -> Floats:
    """Return int T^T p n ds (k, 6), N/m and N, of pressures that are linear along k lines.

    ``ends`` (k, 2, 2) are the first and the last end of each line, m, from the centroid of the
    block, counter-clockwise round it; ``pressure`` (k, 2), Pa, compression positive, is that at
    both.  n points into the block.  T is linear (Shi 1988), so that with l the vector of the line,
    J a quarter turn to the left and the weights of a linear pressure

        w1 = (2 p1 + p2)/6,    w2 = (p1 + 2 p2)/6

    the integral is w1 T(x1)^T J l + w2 T(x2)^T J l, without any error.
    """
    line = ends[:, 1] - ends[:, 0]
    weight = (pressure + (pressure[:, :1] + pressure[:, 1:])) / 6.0
    x, y = np.einsum("ke,kex->xk", weight, ends)  # first moments of the pressure over the length
    across, up = -line[:, 1], line[:, 0]
    whole = weight[:, 0] + weight[:, 1]
    rotation, shear = x * up - y * across, 0.5 * (y * across + x * up)
    return np.stack([whole * across, whole * up, rotation, x * across, y * up, shear], axis=1)


@dataclass(frozen=True)
class Pressures(Action):
    """The pressures of the model, normal to edges as they lie halfway through a step."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return the generalised force of the pressure on each part of an edge."""
        model, loads, midway = start.model, start.model.pressures, start.midway
        first = midway.vertices[loads.edge]
        last = midway.vertices[model.vertex_after[loads.edge]]
        ends = first[:, None] + loads.share[:, :, None] * (last - first)[:, None]
        factor = factors_at(model.factors, loads.factor, start.time_of_forces)
        force = pressure_forces(
            ends - midway.centroid[loads.block][:, None], factor[:, None] * loads.pressure
        )
        return Contribution(block=loads.block, force=force)
