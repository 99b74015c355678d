"""Support forces of excavated blocks on their neighbours, taken away little by little.

    f(t) = r (1 - relax) f_0 (1 - (t - t_0)/T) + (1 - r) f_0,    t_0 <= t <= t_0 + T

r is the share that a stage releases; the rest is held until a later stage.  f_0 are the contact
forces between a block and the blocks beside it when it was excavated at t_0, at
their places: on the edges of the neighbours, and at their corners.  These points move with their
blocks; the forces keep their directions.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

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
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger, State


@dataclass(frozen=True, kw_only=True)
class SupportForces:
    """Forces on the edges of blocks that fall to nothing or are held, k of them."""

    absent: Bools
    """Blocks that are not there, shape (n,)."""
    of: Ints
    """Excavated block whose support each is, shape (k,)."""
    block: Ints
    """Block that each acts on, shape (k,)."""
    vertex: Ints
    """The vertices of the block between which it acts, shape (k, 2)."""
    share: Floats
    """Where: 0 at the first of them, 1 at the second, shape (k,)."""
    force: Floats
    """Force (x, y) at its beginning, N/m, shape (k, 2)."""
    since: Floats
    """When it began, s, shape (k,)."""
    duration: Floats
    """Time in which it falls to zero, s; infinite: it is held, shape (k,)."""

    def rows(self, kept: Bools) -> SupportForces:
        """Return those forces that are ``kept`` (k,)."""
        return replace(self, **{name: getattr(self, name)[kept] for name in OF_FORCES})

    def plus(self, others: SupportForces) -> SupportForces:
        """Return these forces and others, with the excavated blocks for these."""
        joined = {
            name: np.concatenate([getattr(self, name), getattr(others, name)]) for name in OF_FORCES
        }
        return replace(self, **joined)


OF_FORCES = tuple(one.name for one in fields(SupportForces))[1:]
"""Names of the arrays that have one row for each force."""


def no_forces(absent: Bools) -> SupportForces:
    """Return no forces, with the blocks that are ``absent`` (n,)."""
    return SupportForces(
        absent=absent,
        of=np.zeros(0, np.int64),
        block=np.zeros(0, np.int64),
        vertex=np.zeros((0, 2), np.int64),
        share=np.zeros(0),
        force=np.zeros((0, 2)),
        since=np.zeros(0),
        duration=np.zeros(0),
    )


def absent_in(state: State) -> Bools | None:
    """Return which blocks are not there in a state, shape (n,); None where all always are."""
    for own in state.actions:
        if isinstance(own, SupportForces):
            return own.absent
    return None


def released_at(state: State) -> float:
    """Return when the last force ends that is being released, s; -inf for none."""
    for own in state.actions:
        if isinstance(own, SupportForces):
            ends = own.since + own.duration
            return float(ends[np.isfinite(ends)].max(initial=-np.inf))
    return -np.inf


def released(
    forces: SupportForces, fraction: Floats, relax: float, relax_time: float, time: float
) -> SupportForces:
    """Return the forces after excavated blocks have released a ``fraction`` (n,) of those held.

    The share ``relax`` of it ends at the time, s, the rest within ``relax_time``, s.
    """
    part = np.where(np.isinf(forces.duration), fraction[forces.of], 0.0)
    kept = replace(forces, force=(1.0 - part)[:, None] * forces.force)
    falling = replace(
        forces,
        force=((1.0 - relax) * part)[:, None] * forces.force,
        since=np.full(len(part), time),
        duration=np.full(len(part), relax_time),
    )
    lasts = relax < 1.0 and relax_time > 0.0
    return kept.rows(part < 1.0).plus(falling.rows((part > 0.0) & lasts))


@dataclass(frozen=True)
class Relaxation(Action):
    """The forces of excavated blocks on those that are left."""

    def begin(self, model: Model) -> SupportForces:
        """Return no forces."""
        return no_forces(model.absent)

    def contribution(self, start: StepStart, state: SupportForces) -> Contribution:
        """Return the remaining forces at the time at which forces are taken."""
        if not len(state.block):
            return Contribution()
        first, second = start.midway.vertices[state.vertex.T]
        at = first + state.share[:, None] * (second - first)
        left = np.clip(1.0 - (start.time_of_forces - state.since) / state.duration, 0.0, 1.0)
        offset = at - start.midway.centroid[state.block]
        return forces_at_points(state.block, offset, left[:, None] * state.force)

    def finish(
        self, start: StepStart, state: SupportForces, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the forces: it is that of blocks that were taken out."""
        if not len(state.block):
            return ActionResult(work=0.0, ledger=Ledger(), state=state)
        work, _ = energy_of_linear(contribution, solution.displacement)
        acting = state.since + state.duration > start.end
        return ActionResult(work=work, ledger=Ledger(removed=-work), state=state.rows(acting))
