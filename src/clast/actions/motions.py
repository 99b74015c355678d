"""Prescribed motions of blocks: settling supports, driven walls, presses, jacks.

The displacement of a block's centroid, or of a point that moves with it, is prescribed; the
block rotates about it.  With x_c the centroid and P the point at the beginning of the motion,

    x(t) = P + X(t) + R(phi(t)) (x_c - P),

and the displacement of a step leads from the current position of the block to x at its end.  A
servo applies a force that decreases with velocity, F (1 - v/v_limit): at rest the reaction is F,
and v_limit is the velocity without resistance.

The velocity is piecewise linear.  An ``ease`` e spreads each of its jumps over a time,

    x~(t) = 1/e int_{t-e}^{t} x,    v~(t) = (x(t) - x(t-e))/e,

the mean of the displacement over the preceding time e: a constant velocity is reached with the
acceleration v/e, and the displacement lags by the time e/2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Prescribed,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.model.factors import Factor
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Course:
    """Displacement x(t) of one component, 0 before t = 0; k pieces of constant acceleration."""

    time: Floats
    """Start of each piece, s, increasing from 0, shape (k,); the last one has no end."""
    displacement: Floats
    """x at the start of each, m or rad, shape (k,)."""
    velocity: Floats
    """Velocity at the start of each, per s, shape (k,)."""
    acceleration: Floats
    """Acceleration in each, per s2, shape (k,)."""
    ease: float = 0.0
    """Time over which jumps of velocity are spread, s."""
    table: str = ""
    """Name of its amplitude, "" for none."""

    def at(self, time: float, last: float = np.inf) -> tuple[float, float]:
        """Return displacement and velocity at a time, s, after its beginning.

        From ``last``, s, on it rests; an ease spreads that jump of the velocity, too.
        """
        if self.ease == 0.0:
            return self._until(last, time)[:2]
        now, _, area = self._until(last, time)
        before, _, area_before = self._until(last, time - self.ease)
        return (area - area_before) / self.ease, (now - before) / self.ease

    @property
    def end(self) -> float:
        """Time from which it is at rest, s; infinity if never."""
        if self.velocity[-1] or self.acceleration[-1]:
            return np.inf
        return float(self.time[-1]) + self.ease

    def _until(self, last: float, time: float) -> tuple[float, float, float]:
        """Return x, its velocity and its integral at a time, s, where it rests from ``last`` on."""
        if time < last:
            return self._at(time)
        x, _, area = self._at(last)
        return x, 0.0, area + (time - last) * x

    def _at(self, time: float) -> tuple[float, float, float]:
        """Return x, its velocity and its integral from 0 at a time, s; 0 before 0."""
        if time <= 0.0:
            return 0.0, 0.0, 0.0
        k = int(np.searchsorted(self.time, time, side="right")) - 1
        x, v, a, since = (
            self.displacement[k],
            self.velocity[k],
            self.acceleration[k],
            time - self.time[k],
        )
        area = self._areas[k] + since * (x + since * (v / 2.0 + since * a / 6.0))
        return float(x + since * (v + since * a / 2.0)), float(v + since * a), float(area)

    @property
    def _areas(self) -> Floats:
        """Integral of x from 0 to where each piece begins."""
        since, x = np.diff(self.time), self.displacement[:-1]
        v, a = self.velocity[:-1], self.acceleration[:-1]
        pieces = since * (x + since * (v / 2.0 + since * a / 6.0))
        return np.concatenate([[0.0], np.cumsum(pieces)])


def at_constant_speed(velocity: float, ease: float) -> Course:
    """Return a course with a constant velocity."""
    none = np.zeros(1)
    return Course(none, none, np.array([velocity]), none, ease)


def along_displacements(table: Factor, scale: float, ease: float) -> Course:
    """Return a course whose displacement is ``scale`` times a table."""
    time, value = _from_zero(table)
    displacement = scale * value
    velocity = np.append(np.diff(displacement) / np.diff(time), 0.0)
    none = np.zeros(len(time))
    return Course(time, displacement, velocity, none, ease, table.name)


def along_velocities(table: Factor, scale: float, ease: float) -> Course:
    """Return a course whose velocity is ``scale`` times a table."""
    time, value = _from_zero(table)
    velocity, since = scale * value, np.diff(time)
    acceleration = np.append(np.diff(velocity) / since, 0.0)
    pieces = since * (velocity[:-1] + velocity[1:]) / 2.0
    displacement = np.concatenate([[0.0], np.cumsum(pieces)])
    return Course(time, displacement, velocity, acceleration, ease, table.name)


def _from_zero(table: Factor) -> tuple[Floats, Floats]:
    """Return instants from 0 on, s, and the values of a table there."""
    time = np.concatenate([[0.0], table.time[table.time > 0.0]])
    return time, np.interp(time, table.time, table.value)


FREE = -1.0
"""Start time of a motion that has not begun."""
DURATION_TOLERANCE = 1e-9
"""Share of the duration of a motion by which a step may miss its end."""


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A force on a body that decreases with its velocity."""

    force: tuple[float, float]
    """Force (x, y) on each block, N/m."""
    limit_speed: float
    """Speed at which the force vanishes, m/s."""
    factor: Factor | None = None
    """Factor of it over time."""

    def at(self, time: float) -> Floats:
        """Return the force (2,), N/m, at a time, s, from its beginning."""
        return np.array(self.force) * (1.0 if self.factor is None else self.factor.at(time))

    @property
    def largest(self) -> Floats:
        """Size of the largest force in x and in y, N/m, shape (2,)."""
        most = 1.0 if self.factor is None else float(np.abs(self.factor.value).max())
        return np.abs(self.force) * most

    @property
    def resistance(self) -> Floats:
        """Decrease of the force per velocity, N s/m2, shape (2,)."""
        return self.largest / self.limit_speed


@dataclass(frozen=True, kw_only=True)
class OneMotion:
    """A motion of some blocks."""

    name: str
    """Name."""
    block: Ints
    """Blocks that move, shape (k,)."""
    courses: tuple[Course | None, Course | None, Course | None]
    """Of x, y, m, and rotation, rad; None: free."""
    point: int | None = None
    """Fixed point that it moves, in place of blocks."""
    about: tuple[float, float] | None = None
    """Initial position of the point to which x and y refer and about which the blocks rotate,
    relative to the model's origin, m; None: the centroid of each."""
    servo: Servo | None = None
    """Force that presses on the blocks."""
    stage: str = ""
    """Stage with which it begins, "": with the run."""
    until: float = np.inf
    """Duration, s; free blocks are then released, fixed ones and fixed points come to rest."""
    last_stage: str = ""
    """Stage with which it ends, "" for none."""

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.name if self.name.startswith("motion ") else f"motion '{self.name}'"

    def begins(self, model: Model) -> float:
        """Return when it began, s; FREE: not yet."""
        return dict(model.begun).get(self.stage, FREE) if self.stage else 0.0

    def lasts(self, model: Model) -> float:
        """Return how long it goes on for, s, as far as is known; one that has begun."""
        ended = dict(model.begun).get(self.last_stage, np.inf)
        return min(self.until, ended - self.begins(model))

    @property
    def ease(self) -> float:
        """Time over which jumps of its velocity are spread, s."""
        return max((course.ease for course in self.courses if course is not None), default=0.0)

    def goes_on_as(self, other: OneMotion) -> bool:
        """Return whether another motion takes over from it."""
        follows = self.last_stage != "" and self.last_stage == other.stage
        same = bool(np.isin(self.block, other.block).any()) and set(self.held) & set(other.held)
        return follows and bool(same)

    @property
    def held(self) -> tuple[int, ...]:
        """Numbers of the components that have a course."""
        return tuple(axis for axis in range(3) if self.courses[axis] is not None)


@dataclass(frozen=True, kw_only=True)
class MotionState:
    """Where the motions began."""

    begun: Floats
    """When the motion of each block began, s, FREE: it has not, shape (k,)."""
    origin: Floats
    """Centroid, m, and rotation, rad, of the block then, shape (k, 3)."""


@dataclass(frozen=True, kw_only=True)
class Motions(Action):
    """The prescribed motions of a case; k blocks in all."""

    each: tuple[OneMotion, ...]
    """The motions."""
    support: ClassVar[str] = "motions"
    """Kind of support in its shares, row by row, for their reactions."""

    @property
    def moves(self) -> Ints:
        """Block of each row, motion after motion, shape (k,)."""
        return np.concatenate([one.block for one in self.each])

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the amplitudes of motions."""
        factors = [one.servo.factor for one in self.each if one.servo is not None]
        named = [factor.name for factor in factors if factor is not None]
        return (*named, *(c.table for one in self.each for c in one.courses if c is not None))

    def anchors(self, model: Model, time: float) -> tuple[Ints, Floats]:
        """Return which fixed points are moved at a time, s, and how far, m, (k,) and (k, 2)."""
        moving = [one for one in self.each if one.point is not None and one.begins(model) != FREE]
        displacement = []
        for one in moving:
            courses = [c for c in one.courses[:2] if c is not None]
            since, last = time - one.begins(model), one.lasts(model)
            displacement.append([course.at(since, last)[0] for course in courses])
        points = np.array([one.point for one in moving], np.int64)
        return points, np.array(displacement, float).reshape(-1, 2)

    @property
    def waits(self) -> tuple[tuple[str, str], ...]:
        """Motions that wait for stages, and names of these."""
        pairs = [(one.label, name) for one in self.each for name in (one.stage, one.last_stage)]
        return tuple((what, name) for what, name in pairs if name)

    def begin(self, model: Model) -> MotionState:
        """Return that no motion has begun."""
        count = len(self.moves)
        return MotionState(begun=np.full(count, FREE), origin=np.zeros((count, 3)))

    def rest_from(self, model: Model) -> float:
        """Return the time from which all motions that have begun rest, s."""
        ends = [0.0]
        for one in self.each:
            begun = one.begins(model)
            if begun == FREE:
                continue
            moving = [course.end for course in one.courses if course is not None]
            if one.servo is not None and one.servo.factor is not None:
                moving.append(float(one.servo.factor.time[-1]))
            ends.append(begun + min(one.lasts(model) + one.ease, max(moving, default=0.0)))
        return max(ends)

    def contribution(self, start: StepStart, state: MotionState) -> Contribution:
        """Return the motions of the blocks in a step, and the forces of servos."""
        state, model = self._begun(start, state), start.model
        rows, pushed = [], []
        for one, (first, past) in zip(self.each, self._rows, strict=True):
            begun = one.begins(model)
            if begun == FREE:
                continue
            left = one.lasts(model) * (1.0 - DURATION_TOLERANCE) - (start.state.time - begun)
            fixed = model.fixed[one.block]
            # a fixed one that has come to the end with a velocity is brought to rest there
            rests = (left + one.ease <= 0.0) & (start.state.velocity[one.block] == 0.0).all(axis=1)
            taken_over = any(
                one.goes_on_as(other) and other.begins(model) != FREE for other in self.each
            )
            # free ones are let go with their velocity; static steps know of none
            goes_on = left > 0.0 or (start.clock is not None and left + one.ease > 0.0)
            for some in (fixed & ~rests & (not taken_over), ~fixed & goes_on):
                if one.held and some.any():
                    rows.append(_prescribed(one, start, state.origin[first:past], some))
            if one.servo is not None and left > 0.0:
                pushed.append(_pushed(one, start, begun))
        prescribed = _joined(rows)
        if not pushed:
            return Contribution(prescribed=prescribed)
        block, force, stiffness = (np.concatenate(column) for column in zip(*pushed, strict=True))
        return Contribution(block=block, force=force, stiffness=stiffness, prescribed=prescribed)

    def finish(
        self, start: StepStart, state: MotionState, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the motions and servos on the system."""
        work = energy_of_linear(contribution, solution.displacement)[0]
        if contribution.prescribed is not None:
            given = contribution.prescribed
            moved = np.where(given.components, given.displacement, 0.0)[:, :3]
            work += float(np.sum(moved * solution.holding[given.block]))
        return ActionResult(work=work, ledger=Ledger(motions=work), state=self._begun(start, state))

    @property
    def _rows(self) -> list[tuple[int, int]]:
        """First and past row of each motion."""
        ends = np.cumsum([0, *(len(one.block) for one in self.each)]).tolist()
        return list(pairwise(ends))

    def _begun(self, start: StepStart, state: MotionState) -> MotionState:
        """Return where those motions began, too, that begin with this step."""
        begins = [one.begins(start.model) for one in self.each]
        now = np.repeat(begins, [len(one.block) for one in self.each])
        fresh = (state.begun == FREE) & (now != FREE)
        if not fresh.any():
            return state
        blocks = self.moves
        at = np.column_stack([start.frames.centroid[blocks], start.state.rotation[blocks]])
        return replace(
            state,
            begun=np.where(fresh, now, state.begun),
            origin=np.where(fresh[:, None], at, state.origin),
        )


def _prescribed(one: OneMotion, start: StepStart, origin: Floats, some: Bools) -> Prescribed:
    """Return the course, in a step, of ``some`` (k,) of the blocks of a motion, all fixed or none.

    ``origin`` (k, 3) is where they were when it began.  Where it ends within the step fixed blocks
    rest from then on, and free ones go on as they are by then: they are let go with the step.
    """
    block, origin = one.block[some], origin[some]
    count, since, last = len(block), start.end - one.begins(start.model), one.lasts(start.model)
    at = [(0.0, 0.0) if c is None else c.at(since, last) for c in one.courses]
    free = not start.model.fixed[block[0]] and start.clock is None
    if since >= last * (1.0 - DURATION_TOLERANCE) and free:
        ends = [(0.0, 0.0) if c is None else c.at(last) for c in one.courses]
        at = [(there + (since - last) * speed, speed) for there, speed in ends]
    (x, u), (y, v), (angle, spin) = at
    centre = origin[:, :2] if one.about is None else np.array([one.about])
    arm = origin[:, :2] - centre
    sine, less = np.sin(angle), -2.0 * np.sin(0.5 * angle) ** 2
    turned = arm @ np.array([[less, sine], [-sine, less]])  # (R - I) (x_c - P)
    shift = np.array([x, y]) + turned + origin[:, :2] - start.frames.centroid[block]
    swung = arm + turned
    displacement, velocity = np.zeros((count, 6)), np.zeros((count, 6))
    displacement[:, :2] = shift
    left = origin[:, 2] + angle - start.state.rotation[block]
    displacement[:, 2] = [start.rotation.unknown(float(turn)) for turn in left]
    velocity[:, 0] = u - spin * swung[:, 1]
    velocity[:, 1] = v + spin * swung[:, 0]
    velocity[:, 2] = spin
    components = np.zeros((count, 6), np.bool_)
    components[:, one.held] = True
    # what a course does not move stays, where a block is fixed
    idle = [axis for axis in range(3) if axis not in one.held]
    displacement[:, idle] = velocity[:, idle] = 0.0
    return Prescribed(
        block=block, components=components, displacement=displacement, velocity=velocity
    )


def _pushed(one: OneMotion, start: StepStart, begun: float) -> tuple[Ints, Floats, Floats]:
    """Return blocks, forces (k, 6) and how these fall with the displacements (k, 6, 6).

    In a step in which it ends its forces are less by the share of the time after that.
    """
    servo, count, since = one.servo, len(one.block), start.state.time - begun
    force, stiffness = np.zeros((count, 6)), np.zeros((count, 6, 6))
    if servo is not None:
        length = start.end - start.state.time
        share = min(1.0, (one.lasts(start.model) - since) / length) if length > 0.0 else 1.0
        force[:, :2] = share * servo.at(start.time_of_forces - begun)
        stiffness[:, (0, 1), (0, 1)] = share * servo.resistance / start.step
    return one.block, force, stiffness


def _joined(rows: list[Prescribed]) -> Prescribed | None:
    """Return several motions as one record, None for none."""
    if not rows:
        return None
    return Prescribed(
        block=np.concatenate([one.block for one in rows]),
        components=np.concatenate([one.components for one in rows]),
        displacement=np.concatenate([one.displacement for one in rows]),
        velocity=np.concatenate([one.velocity for one in rows]),
    )
