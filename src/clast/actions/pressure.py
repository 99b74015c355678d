"""Pressures on edges: normal to the edge as it turns with its block, linear along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart, energy_of_linear
from clast.model.factors import factors_at
from clast.model.model import Floats, Model
from clast.model.state import Ledger


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
    return np.stack(
        [
            whole * across,
            whole * up,
            x * up - y * across,
            x * across,
            y * up,
            0.5 * (y * across + x * up),
        ],
        axis=1,
    )


@dataclass(frozen=True)
class Pressures:
    """The pressures of the model, on the edges as they lie halfway through a step."""

    def begin(self, model: Model) -> None:
        """Return nothing: where the edges are follows from the blocks."""

    def share(self, start: StepStart, state: None) -> Contribution:
        """Return the generalised force of the pressure on each part of an edge."""
        model, loads, midway = start.model, start.model.pressures, start.midway
        after = loads.edge + 1
        past = model.block_start[loads.block + 1]
        after = np.where(after < past, after, model.block_start[loads.block])
        first, last = midway.vertices[loads.edge], midway.vertices[after]
        ends = first[:, None] + loads.share[:, :, None] * (last - first)[:, None]
        factor = factors_at(model.factors, loads.factor, start.time_of_forces)
        force = pressure_forces(
            ends - midway.centroid[loads.block][:, None], factor[:, None] * loads.pressure
        )
        return Contribution(block=loads.block, force=force)

    def finish(
        self, start: StepStart, state: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the pressures, which comes from outside."""
        work, _ = energy_of_linear(share, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(loads=work))
