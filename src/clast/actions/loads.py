"""Loads: weight, motion of the ground, forces at points, along lines and on edges, and moments.

But for weight their work comes from outside; forces at points, lines and edges move with their
blocks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import (
    NO_CONTRIBUTION,
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
    forces_at_points,
)
from clast.model.factors import NO_FACTOR, factors_at
from clast.model.model import Floats, Ints, Model
from clast.model.state import Ledger


def gravity_at(model: Model, time: float) -> Floats:
    """Return the acceleration of gravity at a time, s, in m/s2, shape (2,)."""
    if model.gravity_factor == NO_FACTOR:
        return model.gravity
    return model.factors[model.gravity_factor].at(time) * model.gravity


@dataclass(frozen=True)
class Gravity(Action):
    """Weight: m g at the centroid of each block."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return the acceleration of gravity at the end of the step."""
        return Contribution(acceleration=gravity_at(start.model, start.time_of_forces))

    def finish(
        self, start: StepStart, state: None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of weight, which the potential energy of gravity has lost.

        Weight that changes with time has no potential: its work is that of a load.
        """
        result = super().finish(start, state, contribution, solution)
        if start.model.gravity_factor != NO_FACTOR:
            return result
        return ActionResult(work=result.work, ledger=Ledger(gravity=-result.work))


@dataclass(frozen=True)
class GroundAcceleration(Action):
    """The body force -rho a of the model's ground motion, where that acts by one."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return minus the mean acceleration of the ground in the step."""
        return Contribution(acceleration=start.model.ground_motion.body_acceleration(*start.span))


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


@dataclass(frozen=True, eq=False)
class HoldingForces(Action):
    """Forces that lead a static run along its path of equilibria; other steps have their damping.

    Where a static stage begins, the forces on each block have a sum that is not zero: weight,
    stress and loads that have just begun to act, supports that have been taken away.  The negative
    of that sum keeps every block where it is; a fraction of it lets the rest come on.  Where it is
    known how movements add to the moments of forces, a step is made against the forces that are
    still to come.  Both are dead: they stay with the centroids.

    Forces in a block that turns by r add to the moment on it, with y the places where they act,

        sum (R y) x f - sum y x f = -r sum y.f = -r A (s_xx + s_yy)

    since the stress in balance with them is A s = sum of the symmetric part of y f.  In tension,
    that is the stiffness of a rope: without it links that carry are swung about as if they were
    slack.  In compression it is negative, and the equations of a step would have no minimum: its
    effect comes with the next step.
    """

    force: Floats
    """Generalised force on each block, N/m and N, shape (n, 6), or (0, 6) for none."""
    entries: ClassVar[Mapping[str, float]] = {}
    """None: their work is numerical, they are not forces of the system."""

    def contribution(self, start: StepStart, state: Any) -> Contribution:
        """Return the forces, and the stiffness against rotation of blocks in tension."""
        tension = start.model.area * (start.state.stress[:, 0] + start.state.stress[:, 1])
        on_all = len(self.force) == len(tension)
        block = np.flatnonzero(on_all | (tension > 0.0))
        if not len(block):
            return NO_CONTRIBUTION
        stiffness = np.zeros((len(block), 6, 6))
        stiffness[:, 2, 2] = np.maximum(0.0, tension[block])
        force = self.force if on_all else np.zeros((len(block), 6))
        return Contribution(block=block, force=force, stiffness=stiffness)
