"""Rock bolts: springs between points of two blocks, along the line on which these lie now.

    F = T0 + s (l - l0 - p),    0 <= F <= Fy    (-Fy <= F <= Fy where it carries compression)

l is the length between the points, l0 that at which the bolt was installed, with its pretension T0;
the plastic elongation p grows where F would exceed the yield force Fy, so that a bolt unloads along
the elastic line.  Beyond an elongation F/s + p it breaks, for good.  While a jack holds it F is T0,
whatever the length.  In a step the force grows along the line of its start, and turns with the line
by a spring F/l across it: both are implicit, as the springs of contacts are.  (Shi 1988 has the
elastic bolt.)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_springs,
)
from clast.contact.clipped_spring import Clipped, Springs, table
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger
from clast.model.supports import Bolts


@dataclass(frozen=True, kw_only=True)
class BoltStates:
    """The history of the m springs of bolts."""

    rest: Floats
    """Length at which it was installed l0, m, nan before, shape (m,)."""
    plastic: Floats
    """Plastic elongation p, m, shape (m,)."""
    force: Floats
    """Force F, N/m, tension positive, shape (m,)."""
    yielded_at: Floats
    """When it first yielded, s, nan where it has not, shape (m,)."""
    broken_at: Floats
    """When it broke, s, nan where it has not, shape (m,)."""
    locked: Bools
    """False where a jack holds it, shape (m,)."""
    lost: Bools
    """True where a block that it was anchored in is excavated, shape (m,)."""
    counted: Bools
    """True where the ledger has the energy that it was installed with, shape (m,)."""

    @property
    def carries(self) -> Bools:
        """Whether it can carry a force, shape (m,)."""
        return np.asarray(~np.isnan(self.rest) & np.isnan(self.broken_at) & ~self.lost)

    @property
    def state(self) -> Ints:
        """Number of its state: not installed, intact, yielded, broken, lost, shape (m,).

        The names are ``clast.results.schema.BOLT_STATES``.
        """
        number = np.where(np.isnan(self.rest), 0, 1)
        number = np.where(np.isnan(self.yielded_at), number, 2)
        number = np.where(np.isnan(self.broken_at), number, 3)
        return np.where(self.lost, 4, number).astype(np.int64)

    def elongation(self, bolts: Bolts) -> Floats:
        """Return F/s + p: the elongation since the state without force, m, shape (m,)."""
        return np.asarray(self.force / bolts.stiffness + self.plastic)

    def energy(self, bolts: Bolts) -> Floats:
        """Return the elastic energy F^2/(2 s), J/m, shape (m,)."""
        return np.asarray(0.5 * self.force**2 / bolts.stiffness)


def untouched(count: int) -> BoltStates:
    """Return so many springs before they are installed."""
    never, no = np.full(count, np.nan), np.zeros(count, np.bool_)
    return BoltStates(
        rest=never,
        plastic=np.zeros(count),
        force=np.zeros(count),
        yielded_at=never,
        broken_at=never,
        locked=no,
        lost=no,
        counted=no,
    )


@dataclass(frozen=True)
class Bolting(Action):
    """The bolts of the model."""

    def begin(self, model: Model) -> BoltStates:
        """Return the springs as they are installed at the start; the others wait."""
        none = untouched(len(model.bolts.stiffness))
        return taken_up(model, none, lengths(model, model.bolts.at))

    def contribution(self, start: StepStart, state: BoltStates) -> Contribution:
        """Return the springs of all bolts that carry between blocks that can move."""
        points = start.state.points[start.model.point_slices.bolts]
        length = lengths(start.model, points)
        return Contribution(springs=_springs(start, taken_up(start.model, state, length), length))

    def finish(
        self, start: StepStart, state: BoltStates, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the result of the bolts: they store energy, yield and break.

        The work of jacks and the energy of installed pretension come from outside as ``loads``; the
        energy of a bolt whose block is excavated is taken out.
        """
        model, bolts = start.model, start.model.bolts
        before = lengths(model, start.state.points[model.point_slices.bolts])
        after = lengths(model, solution.points[model.point_slices.bolts])
        begun = taken_up(model, state, before)
        pulled = stretched(bolts, begun, after, start.end)
        ended = ruptured(bolts, pulled, start.end)
        work = 0.0
        if contribution.springs is not None:
            work, _ = energy_of_springs(contribution.springs, solution)
        was = np.where(state.counted, state.energy(bolts), 0.0)
        fresh, jacked = begun.carries & ~state.counted, begun.carries & ~begun.locked
        installed = np.where(fresh, begun.energy(bolts), 0.0)
        by_jacks = np.where(jacked, bolts.pretension * (before - after), 0.0)
        flow = pulled.plastic != begun.plastic
        plastic = np.where(flow, pulled.force * (pulled.plastic - begun.plastic), 0.0)
        broken = pulled.energy(bolts) - ended.energy(bolts)
        ledger = Ledger(
            bolts=float(np.sum(ended.energy(bolts) - was)),
            loads=float(np.sum(installed + by_jacks)),
            yielding=float(np.sum(plastic + broken)),
            removed=float(np.sum(was[begun.lost])),
        )
        return ActionResult(work=work, ledger=ledger, state=ended)

    def events(
        self, model: Model, before: BoltStates, after: BoltStates
    ) -> Iterator[tuple[str, str, str]]:
        """Yield kind, name and sentence of each event of bolts in a step."""
        for _, kind, name, text in happened(model, before, after):
            yield kind, name, text


def lengths(model: Model, points: Floats) -> Floats:
    """Return the length of each spring, m, shape (m,), from the points of bolts (q, 2), m."""
    ends = points[model.bolts.ends]
    return np.asarray(np.hypot(*(ends[:, 0] - ends[:, 1]).T))


def taken_up(model: Model, state: BoltStates, length: Floats) -> BoltStates:
    """Return the springs when a step begins, at lengths (m,), m.

    Those installed since take their length as the one at rest, those whose jack is off go on from
    the length they have, and those whose block is excavated carry nothing more.
    """
    bolts = model.bolts
    there = bolts.installed[bolts.of_spring]
    lost = state.lost | (there & model.absent[bolts.blocks].any(axis=1))
    fresh = there & np.isnan(state.rest) & ~lost
    return replace(
        state,
        rest=np.where(fresh, length, state.rest),
        force=np.where(fresh, bolts.pretension, np.where(lost, 0.0, state.force)),
        lost=lost,
        locked=there & (~bolts.jacked | bolts.locked[bolts.of_spring]),
    )


def stretched(bolts: Bolts, state: BoltStates, length: Floats, time: float) -> BoltStates:
    """Return the springs at other lengths (m,), m: their forces, and their yielding.

    Where a jack holds it the length at rest follows, so that it goes on from there when locked.
    """
    held = state.carries & ~state.locked
    rest = np.where(held, length, state.rest)
    straight = bolts.pretension + bolts.stiffness * (length - rest - state.plastic)
    straight = np.where(state.carries, straight, 0.0)
    low = np.where(bolts.compression, -bolts.yield_force, 0.0)
    force = np.clip(straight, low, bolts.yield_force)
    yields = (straight > bolts.yield_force) | (straight < -bolts.yield_force)
    yields &= bolts.compression | (straight > 0.0)
    flow = np.where(yields, (straight - force) / bolts.stiffness, 0.0)
    return replace(
        state,
        rest=rest,
        force=force,
        plastic=state.plastic + flow,
        yielded_at=np.where(yields & np.isnan(state.yielded_at), time, state.yielded_at),
        counted=state.counted | state.carries,
    )


def ruptured(bolts: Bolts, state: BoltStates, time: float) -> BoltStates:
    """Return the springs with those broken that are too long for it."""
    breaks = state.carries & (state.elongation(bolts) > bolts.rupture)
    return replace(
        state,
        force=np.where(breaks, 0.0, state.force),
        broken_at=np.where(breaks, time, state.broken_at),
    )


def _springs(start: StepStart, state: BoltStates, length: Floats) -> Springs | None:
    """Return the links of the springs that carry, None where there are none.

    The force of a link is that on its first block along the line from the second one, compression
    positive.
    """
    model, bolts = start.model, start.model.bolts
    acts = np.flatnonzero(state.carries & ~model.fixed[bolts.blocks].all(axis=1))
    if not len(acts):
        return None
    points = start.state.points[model.point_slices.bolts][bolts.ends[acts]]
    block = bolts.blocks[acts]
    offset = points - start.frames.centroid[block]
    apart_by, size = points[:, 0] - points[:, 1], length[acts]
    apart = size > 0.0
    line = np.where(apart[:, None], apart_by / np.where(apart, size, 1.0)[:, None], [1.0, 0.0])
    tension, strength = bolts.pretension[acts], bolts.yield_force[acts]
    held, none = ~state.locked[acts], np.zeros(len(acts))
    stretch = np.where(held, 0.0, size - state.rest[acts] - state.plastic[acts])
    slack = np.where(bolts.compression[acts], strength, 0.0)
    across = np.where(apart, np.maximum(state.force[acts], 0.0) / np.where(apart, size, 1.0), 0.0)
    # one that is slack, and may become taut, carries what it does at the end of the step
    place = np.where(state.force[acts] == 0.0, 1.0, start.forces_at)
    springs, _ = table(
        vertex_block=block[:, 0],
        edge_block=block[:, 1],
        arms=np.concatenate([line, offset[:, 0], offset[:, 1]], axis=1),
        gap=stretch,
        slip=none,
        normal=Clipped(
            at_zero=-tension,
            stiffness=bolts.stiffness[acts],
            low=np.where(held, -tension, -strength),
            high=np.where(held, -tension, slack),
        ).taken_at(place, stretch),
        shear=Clipped(
            at_zero=none, stiffness=across, low=none - np.inf, high=none + np.inf
        ).taken_at(place, none),
    )
    return springs


EVENTS_SHOWN_MAX = 20
"""Events that are said one by one, at most."""


def happened(
    model: Model, before: BoltStates, after: BoltStates
) -> list[tuple[float, str, str, str]]:
    """Return the events of bolts between two states of a run, in the order of time.

    Time, s, kind, name of the bolt, and a sentence.  ``before`` and ``after`` are the own states of
    the action on bolts (``State.actions``); a block is lost between steps, and has no time.
    """
    names = model.bolts.name
    events = []
    for kind, was, now in (
        ("yielded", before.yielded_at, after.yielded_at),
        ("broke", before.broken_at, after.broken_at),
    ):
        first = _first(model, np.where(np.isnan(was), now, np.nan))
        known = ~np.isnan(_first(model, was))
        events += [
            (float(first[k]), kind, names[k], f"bolt '{names[k]}' {kind} at t = {first[k]:.6g} s")
            for k in np.flatnonzero(~np.isnan(first) & ~known)
        ]
    lost = np.unique(model.bolts.of_spring[after.lost & ~before.lost])
    said = "lost its anchor with its block"
    events += [(np.inf, "lost", names[k], f"bolt '{names[k]}' {said}") for k in lost]
    return sorted(events)


def story_of(state: BoltStates, model: Model) -> tuple[str, ...]:
    """Return all that has happened to bolts since the start of a run; of many, how many more."""
    events = [text for *_, text in happened(model, untouched(len(state.rest)), state)]
    if len(events) <= EVENTS_SHOWN_MAX:
        return tuple(events)
    return *events[
        :EVENTS_SHOWN_MAX
    ], f"bolts: {len(events) - EVENTS_SHOWN_MAX} more events after these"


def _first(model: Model, times: Floats) -> Floats:
    """Return the earliest of the times (m,) of the springs of each bolt, nan for none, (k,)."""
    earliest = np.full(len(model.bolts), np.inf)
    np.fmin.at(earliest, model.bolts.of_spring, times)
    return np.where(np.isfinite(earliest), earliest, np.nan)
