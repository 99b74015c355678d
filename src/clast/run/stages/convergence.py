"""How much movement of a static run is still to come.

A step solves equations that hold for blocks as they stand at its start.  The moments that its
movement adds to those of the forces on them drive the next step, which adds less again.  Near an
equilibrium each movement is q times the one before, with q = P/P_cr for a wall under a load P, and

    w q/(1 - q)

is still to come after one of w.  With q >= 1 there is no equilibrium near by, however small w.  It
is that of the blocks that move most, along their movement: blocks that have come to rest play no
part.

Where q is steady, the forces that the movements to come will bring about are known as well: those
out of balance now, times q + q^2 + ...  The next step anticipates them (Aitken 1926).

A static run that is out of balance fails, or moves on to an equilibrium.  Each step begins at rest
and moves blocks by w, as a force m w/(theta tau^2) would.  Weighted by the motion, all blocks
together have in a step the movement and the acceleration

    u = sum m w^2 / sum m w,    a = u/(theta tau^2).

A system that fails is driven on: a stays as it is, or grows.  A system that moves to an
equilibrium, however far, is driven less and less: where a falls from a1 to a2 on a movement u12, it
vanishes about a2 u12/(a1 - a2) further on.  So the verdict does not depend on how far a step may
go.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from clast.model.model import Bools, Floats, Model
from clast.model.state import State
from clast.run.stages.balance import mean_movement

COMING_MIN = 2e-3
"""Movement still to come that is none, as a share of that of the stage in the same direction."""
MOVEMENT_MIN = 1e-5
"""Movement in a step that is none, as a share of the largest of the stage."""
MOVEMENT_OF_SIZE_MIN = 1e-7
"""The same, in units of the size of the block."""
COSINE_MIN = 0.9
"""Cosine between the movements of two steps from which blocks move on and do not tremble."""
STEPS_AHEAD_MAX = 50
"""Steps that one may stand for: of ratios of 1 and more the series has no end."""

FAR_STEPS_MIN = 10
"""Steps that go far without balance from which a system can have none."""
MOVEMENT_OF_FAILURE = 0.02
"""Movement from which blocks are going somewhere, in units of their median size."""
DISTANCE_MAX = 0.03
"""Distance of an equilibrium from where blocks were, in units of the size of the model, at most:
blocks that slide until their water or their slope has become another have failed."""
IDLE_STEPS_MAX = 200
"""Steps that go nowhere without balance from which a system has none."""
STEPS_MAX = 2000
"""Steps without balance from which a system has none, however they go."""


def _no_motion() -> Floats:
    return np.zeros((0, 3))


@dataclass(frozen=True, kw_only=True)
class Convergence:
    """The movements of the steps of a static run, or of a static stage; n blocks.

    A movement has the mean of the vertices in x and y, and the turn times the size of the block, m.
    """

    total: Floats = field(default_factory=_no_motion)
    """Movement since the run or the stage began, (n, 3); (0, 3) at its start."""
    last: Floats = field(default_factory=_no_motion)
    """Movement of the last step, (n, 3); (0, 3) where the next cannot be compared with it."""
    step: float = 0.0
    """Length of the last step, s."""
    ratios: Floats = field(default_factory=lambda: np.zeros(0))
    """The last ratios q, two at most, since something else changed the forces, shape (k,)."""
    known: float = 0.0
    """Ratio by which a step anticipated others, 0 once two have been seen since."""
    steady: bool = False
    """True where the last two steps moved blocks in the same direction."""
    moved: float = 0.0
    """Movement of the block that moved most in the last step, m."""
    coming: float = 0.0
    """Movement of this block still to come, m: 0 where it is little, inf where there is no end."""

    def restarted(self, movement: Floats, step: float) -> Convergence:
        """Return the movements with another (n, 3), m, in a step of ``step``, s, by new loads."""
        total = self.total + movement if len(self.total) else movement
        return Convergence(
            total=total, last=movement, step=step, moved=float(_sizes(movement).max())
        )

    def gone_ahead(self, movement: Floats, step: float) -> Convergence:
        """Return the movements with another (n, 3), m, against forces still to come."""
        now = self.restarted(movement, step)
        return replace(now, last=_no_motion(), known=float(self.ratios[-1]), coming=now.moved)

    def followed(self, movement: Floats, step: float, size: Floats, pushed: Bools) -> Convergence:
        """Return the movements with another (n, 3), m, that only earlier ones have caused.

        ``size`` (n,), m, is that of the blocks, ``pushed`` (n,) True where forces are out of
        balance.
        """
        far = _sizes(movement)
        most = int(far.argmax())
        chosen = far >= 0.5 * far[most]
        now = replace(self.restarted(movement, step), known=self.known, ratios=self.ratios)
        ratio, shorter, trembles = self.known, 1.0, False
        if len(self.last):
            cosine, ratio = _compared(self.last[chosen], movement[chosen])
            ratios = np.append(self.ratios[-1:], ratio)
            trembles = len(self.ratios) > 0 and cosine < COSINE_MIN
            now = replace(
                now,
                ratios=ratios,
                known=self.known if len(ratios) < 2 else 0.0,
                steady=_compared(self.last, movement)[0] >= COSINE_MIN,
            )
            # in a shorter step the mass held blocks back
            ratio, shorter = max(ratio, now.known), max(1.0, (self.step / step) ** 2)
        least = max(
            MOVEMENT_MIN * float(_sizes(now.total).max()), MOVEMENT_OF_SIZE_MIN * float(size[most])
        )
        if trembles or far[most] <= least or not pushed[chosen].any():
            return now
        held = ratio * shorter
        coming = now.moved * (shorter / (1.0 - held) - 1.0) if held < 1.0 else np.inf
        covered = float(np.sum(now.total[chosen] * movement[chosen])) / float(
            np.sum(movement[chosen] ** 2)
        )
        return replace(now, coming=coming if coming > COMING_MIN * covered * now.moved else 0.0)

    def series(self, reach: float) -> float:
        """Return for how many steps the next may stand that moves no block beyond ``reach``, m.

        1 + q + q^2 + ..., 1 where q is not known well enough.
        """
        seen = np.append(self.known, self.ratios) if self.known else self.ratios
        if len(seen) < 2 or not self.steady or not self.moved:
            return 1.0
        before, ratio = (float(one) for one in seen[-2:])
        left = abs(1.0 - ratio)
        if abs(ratio - before) > 0.1 * max(left, 1.0 / STEPS_AHEAD_MAX):
            return 1.0
        most = (
            float(np.sum(ratio ** np.arange(STEPS_AHEAD_MAX))) if ratio > 1.0 - 1e-3 else 1.0 / left
        )
        most = min(most, reach / (ratio * self.moved))
        # Steps that one must stand for at least
        return most if most > 1.5 else 1.0


def _sizes(movement: Floats) -> Floats:
    """Return how far each block moves, m, (n,), by movements (n, 3)."""
    return np.sqrt(np.add.reduce(movement**2, axis=1))


def _compared(before: Floats, after: Floats) -> tuple[float, float]:
    """Return the cosine between two movements (k, 3), and the ratio of the second to the first.

    Only the part of the first along the second counts; 0 where they go against each other.
    """
    along, square = float(np.sum(before * after)), float(np.sum(after**2))
    if along <= 0.0:
        return (-1.0, 0.0)
    return along / float(np.sqrt(np.sum(before**2) * square)), square / along


def goes_from(model: Model) -> float:
    """Return the movement from which blocks are going somewhere, m."""
    return MOVEMENT_OF_FAILURE * float(np.sqrt(np.median(model.area)))


def driven(model: Model, before: State, after: State, inertia: float) -> Floats:
    """Return movement, m, and acceleration, m/s2, of a step with M ``inertia``, 1/s2, (1, 2)."""
    mean = mean_movement(after.vertices - before.vertices, model.block_start)
    far = np.where(model.fixed, 0.0, np.hypot(*mean.T))
    momentum = float(np.sum(model.mass * far))
    movement = float(np.sum(model.mass * far**2)) / momentum if momentum > 0.0 else 0.0
    return np.array([[movement, inertia * movement]])


def nears(steps: Floats, within: float) -> bool:
    """Return whether movement and acceleration of steps (k, 2) lead to a balance ``within`` m more.

    The second half of the movement counts, in FAR_STEPS_MIN at least: friction and supports are
    mobilised in the first, in which the acceleration goes up and down.
    """
    gone = np.cumsum(steps[:, 0])
    first = min(int(np.searchsorted(gone, 0.5 * gone[-1])), len(steps) - FAR_STEPS_MIN)
    recent = steps[max(0, first) :]
    movement, acceleration = recent.T
    middle = np.searchsorted(np.cumsum(movement), 0.5 * movement.sum(), side="right")
    middle = int(np.clip(middle, 1, len(recent) - 1))
    before, now = (
        float(np.average(acceleration[part], weights=movement[part]))
        for part in (slice(middle), slice(middle, None))
    )
    return now < before and 0.5 * now * float(movement.sum()) <= within * (before - now)
