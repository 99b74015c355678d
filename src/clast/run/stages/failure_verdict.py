"""Whether a static run that is out of balance fails, or is on its way to an equilibrium.

Each step begins at rest and moves blocks by w, as a force m w/(theta tau^2) would.  Weighted by the
motion, all blocks together have in a step the movement and the acceleration

    u = sum m w^2 / sum m w,    a = u/(theta tau^2).

A system that fails is driven on: a stays as it is, or grows.  A system on its way to an
equilibrium, however far, is driven less and less: where a falls from a1 to a2 on a movement u12, it
vanishes about a2 u12/(a1 - a2) further on.  So the verdict does not depend on how far a step may
go.
"""

from __future__ import annotations

import numpy as np

from clast.model.model import Floats, Model
from clast.model.state import State
from clast.run.stages.balance import mean_movement

FAR_STEPS = 10
"""Steps that go far without balance from which a system can have none."""
GOES = 0.02
"""Movement from which blocks are going somewhere, in units of their median size."""
WITHIN = 0.03
"""Distance of an equilibrium from where blocks were, in units of the size of the model, at most:
blocks that slide until their water or their slope has become another have failed."""
MOST_STEPS = 200
"""Steps that go nowhere without balance from which a system has none."""
PATIENCE = 2000
"""Steps without balance from which a system has none, however they go."""


def goes_from(model: Model) -> float:
    """Return the movement from which blocks are going somewhere, m."""
    return GOES * float(np.sqrt(np.median(model.area)))


def driven(model: Model, before: State, after: State, inertia: float) -> Floats:
    """Return movement, m, and acceleration, m/s2, of a step with M ``inertia``, 1/s2, (1, 2)."""
    mean = mean_movement(after.vertices - before.vertices, model.block_start)
    far = np.where(model.fixed, 0.0, np.hypot(*mean.T))
    momentum = float(np.sum(model.mass * far))
    movement = float(np.sum(model.mass * far**2)) / momentum if momentum > 0.0 else 0.0
    return np.array([[movement, inertia * movement]])


def nears(steps: Floats, within: float) -> bool:
    """Return whether movement and acceleration of steps (k, 2) lead to a balance ``within`` m more.

    The second half of the movement counts, in FAR_STEPS at least: friction and supports are
    mobilised in the first, in which the acceleration goes up and down.
    """
    gone = np.cumsum(steps[:, 0])
    first = min(int(np.searchsorted(gone, 0.5 * gone[-1])), len(steps) - FAR_STEPS)
    recent = steps[max(0, first) :]
    movement, acceleration = recent.T
    middle = np.searchsorted(np.cumsum(movement), 0.5 * movement.sum(), side="right")
    middle = int(np.clip(middle, 1, len(recent) - 1))
    before, now = (
        float(np.average(acceleration[part], weights=movement[part]))
        for part in (slice(middle), slice(middle, None))
    )
    return now < before and 0.5 * now * float(movement.sum()) <= within * (before - now)
