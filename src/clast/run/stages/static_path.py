"""A static run, or a static stage, is a path of equilibria.

A static step begins at rest and solves (M/(theta tau^2) + K) d = F.  With the mass term it has a
solution where blocks have no support, too; but it holds back moving blocks, so that a block slips
on a base that carries it along, and the answer depends on tau.  So the *pseudo time step* tau has
nothing to do with the time of loads and supports:

- tau is long from the first step on, for a joint that slips while mass carries load has slipped for
  good; it grows from step to step while blocks move little against max_displacement, until the mass
  term is nothing beside the stiffness of supported blocks (pseudo-transient continuation; Kelley
  and Keyes 1998), and is cut where a step is rejected;
- the time by which tables, the ground and relaxations go on stands still until the present
  increment is in balance;
- the imbalance at the start of a stage, of its weight, stress and loads, comes on at once.  Where
  that breaks bonds it comes on by increments, each of them brought to balance, for bonds that break
  under all of the load may hold under the part that their neighbours leave them.

A process whose contacts need not settle in long steps (the modified one, with p tau^2/m below 6,
and open-close iteration, whose sliding friction is that of the solve before) has steps of the
length of the schedule, and time that does not wait: with it the mass term stays.

Where step after step moves blocks and their unbalanced force does not become less
(convergence.py), there is no equilibrium: the system *fails*, and the blocks that have moved
are its mechanism.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from clast.actions.loads import HoldingForces
from clast.contact.laws import carried_over
from clast.model.model import Bools, Floats, Model
from clast.model.stage_records import Mechanism, Mover
from clast.model.stages import EQUILIBRIUM, HOLD, Stage, with_bonds_held
from clast.model.state import State
from clast.run.schedule import Schedule
from clast.run.stages import convergence
from clast.run.stages.balance import angle_of, mean_movement, out_of_balance
from clast.run.stages.convergence import Convergence
from clast.run.stages.equilibrium import EquilibriumCheck
from clast.run.stages.stability import critical_mode
from clast.run.stages.stage_position import Judgement, Position
from clast.run.stages.transition import WELL_BELOW
from clast.step.finish import LARGEST_TURN
from clast.step.integration import ConstantAcceleration, forces_at
from clast.step.method import Method, StepResult, is_stable_for_any_step

FIRST_FALL = 5.0
"""Fall of a free block in the first step of a stage, in units of max_displacement: with a mass term
that carries little, and two cuts from where nothing carries."""
STEP_MAX = 300.0
"""Longest pseudo time step, in units of that in which a free block falls by max_displacement."""
GROWTH_MAX = 10.0
"""Growth of the pseudo time step from step to step at most."""
GROWTH_AFTER_CUT = 1.5
"""The same after a step that was rejected."""
FAR_TRAVEL = 0.2
"""Movement in a step, in units of max_displacement, that is as far as it lets blocks go."""
INCREMENTS = (1.0, 0.125, 0.03125)
"""Share of the imbalance that comes on at once: where bonds break the next is tried."""
SLOW = "If an equilibrium is farther away than that, raise time.max_displacement"
"""Message where so many steps went not far enough."""


def _no_motion() -> Floats:
    return np.zeros((0, 2))


def _no_forces() -> Floats:
    return np.zeros((0, 6))


@dataclass(frozen=True, kw_only=True)
class OnPath:
    """Where a static run, or a static stage, is on its path; n blocks."""

    growth: float = GROWTH_MAX
    """By how much the pseudo time step may grow."""
    clock: float
    """Length of the next increment of time, s."""
    steps: int = 0
    """Steps since the last balance."""
    far: int = 0
    """Those of them that went as far as max_displacement lets blocks go."""
    driven: Floats = field(default_factory=_no_motion)
    """Movement, m, and acceleration, m/s2, of each of these, shape (k, 2)."""
    moved: Floats = field(default_factory=_no_motion)
    """Movement of each block since then, m, shape (n, 2)."""
    balanced: bool = False
    """True where the last step ended in balance."""
    judged: Judgement = field(default_factory=Judgement)
    failure: Mechanism | None = None
    missing: Floats = field(default_factory=_no_forces)
    """Imbalance when the stage began, N/m and N, (n, 6); (0, 6) where it has come."""
    reached: float = 0.0
    """Share of it that has come on and is in balance."""
    increment: float = INCREMENTS[0]
    """Share of it that comes on in the present increment."""
    broken: int = 0
    """Bonds that broke in it."""
    held: bool = False
    """True while bonds cannot break."""
    convergence: Convergence = field(default_factory=Convergence)
    """How the movements of its steps come to an end."""
    ahead: Floats = field(default_factory=_no_forces)
    """Forces against which the next step anticipates others, N/m and N, (n, 6), or (0, 6)."""
    increments: int = 0
    """Increments of load or time that have come to balance."""
    branch: str = ""
    """That more than one path goes on, in words; "" where none has been seen."""

    @property
    def load(self) -> float:
        """Share of the imbalance that acts in the present increment."""
        return min(1.0, self.reached + self.increment)

    @property
    def begins(self) -> bool:
        """Whether the next step is the first of an increment."""
        return self.balanced or self.steps == 0


@dataclass(frozen=True, kw_only=True)
class StaticPath:
    """Leads a static run, or a static stage, along its path."""

    model: Model
    method: Method
    schedule: Schedule
    stage: Stage | None
    judge: EquilibriumCheck

    @classmethod
    def of(
        cls, model: Model, method: Method, schedule: Schedule, stage: Stage | None
    ) -> StaticPath | None:
        """Return the path of a run or a stage; None where it is not static."""
        if method.dynamic_ratio > 0.0:
            return None
        judge = EquilibriumCheck(model=model, method=method, stage=stage or Stage(name=""))
        return cls(model=model, method=method, schedule=schedule, stage=stage, judge=judge)

    def begin(self, state: State) -> OnPath:
        """Return the beginning of the path."""
        held = self.stage is not None and self.stage.bonds == HOLD
        missing = _no_forces()
        if self._grows and any(
            one.cohesion > 0.0 or one.tensile_strength > 0.0
            for one in self.model.joint_table.joints
        ):
            missing = out_of_balance(self.model, self.method, state, self.first_step)
        return OnPath(clock=self.schedule.step, held=held, missing=missing)

    def at(self, now: OnPath, clock: float) -> tuple[Model, Method]:
        """Return the model and the method of a step in which time goes on by ``clock``, s."""
        model = self._with_bonds_held if now.held else self.model
        method = replace(self.method, clock=clock)
        if forces_at(method.integrator) < 1.0:
            # an equilibrium has the forces at the end of the step
            method = replace(method, integrator=ConstantAcceleration())
        if self._grows:
            method = replace(method, contact_law=carried_over(method.contact_law))
        if self._grows and now.failure is None and method.balance is None:
            method = replace(method, balance=WELL_BELOW * self.judge.stage.force_ratio)
        if self._grows:
            force = now.ahead
            if len(now.missing) and now.load < 1.0:
                force = (force if len(force) else 0.0) - (1.0 - now.load) * now.missing
            method = replace(method, damping=HoldingForces(force=force))
        return model, method

    def judge_of(self, now: OnPath) -> EquilibriumCheck:
        """Return the equilibrium check of a step."""
        model, method = self.at(replace(now, ahead=_no_forces()), 0.0)
        return replace(self.judge, model=model, method=method)

    def finer(self, now: OnPath, result: StepResult) -> OnPath | None:
        """Return the path with a smaller increment of load, None where a step can be kept."""
        if not len(result.broken) or not now.begins or now.reached >= 1.0 or not len(now.missing):
            return None
        smaller = [one for one in INCREMENTS if one < min(now.increment, 1.0 - now.reached)]
        return replace(now, increment=smaller[0]) if smaller else None

    @property
    def first_step(self) -> float:
        """The first pseudo time step, s."""
        if not self._grows:
            return self.schedule.step
        return float(np.sqrt(FIRST_FALL) * self._falls)

    def clock(self, now: OnPath, state: State) -> float:
        """Return by how much time goes on in the next step, s."""
        left = max(0.0, self.schedule.end - state.time)
        if now.failure is not None or not self.waits(now, state):
            return min(now.clock, left)
        return 0.0

    def waits(self, now: OnPath, state: State) -> bool:
        """Return whether time stands still until the present increment is in balance."""
        if not self._grows or now.steps == 0 or not self.is_under_way(state):
            return False
        return not now.balanced or now.reached < 1.0 or now.held

    def is_under_way(self, state: State) -> bool:
        """Return whether something changes with time after a state."""
        return bool(self.judge.under_way(state))

    def is_over(self, now: OnPath, position: Position | None, state: State) -> bool:
        """Return whether the path is at its end: in balance there, or without one."""
        late = self.schedule.end - state.time <= 1e-9 * self.schedule.step
        to_balance = self.stage is not None and self.stage.until == EQUILIBRIUM
        if now.failure is not None:
            return to_balance or late
        if not self._grows and late:
            return True
        if now.reached < 1.0 or now.held:
            return False
        if to_balance and position is not None and self.judge.is_over(position):
            return True
        if to_balance:
            # what still changes at the end of the stage will not be waited for
            return late and now.balanced and self.is_under_way(state)
        return late and now.balanced

    def after(
        self,
        now: OnPath,
        before: State,
        result: StepResult,
        taken: tuple[float, float],
        judged: Judgement | None,
    ) -> OnPath:
        """Return where the path is after a step; ``taken`` are its pseudo time and its clock, s.

        ``judged`` is how it ended where a stage has judged it already.
        """
        if judged is None:
            judged = self.judge_of(now).after(Position(), before, result, taken[0]).judged
        pushed = np.asarray(judged.left.any(axis=1))
        movements = self._converging(now, before, result, taken[0], pushed)
        judged = self._with_more_to_come(judged, movements)
        movement, restarts = self._movement(before, result.state)[:, :2], now.begins
        moved = movement if restarts else now.moved + movement
        driven, far = (_no_motion(), 0) if restarts else (now.driven, now.far)
        if result.travel > FAR_TRAVEL * self.method.max_displacement:
            inertia = 1.0 / (self.method.integrator.theta * taken[0] ** 2)
            last = convergence.driven(self.model, before, result.state, inertia)
            driven, far = np.concatenate([driven, last]), far + 1
        steps = 1 + (0 if restarts else now.steps)
        after = replace(
            now,
            convergence=movements,
            ahead=_no_forces(),
            clock=min(self.schedule.step, max(now.clock, GROWTH_AFTER_CUT * taken[1])),
            growth=min(GROWTH_MAX, GROWTH_AFTER_CUT * now.growth),
            steps=steps,
            far=far,
            driven=driven,
            moved=moved,
            balanced=judged.balanced,
            judged=judged,
            broken=len(result.broken) + (0 if restarts else now.broken),
        )
        if judged.balanced:
            after = replace(after, increments=now.increments + 1)
            # the 1st, 2nd, 4th, ...: before what rounding begins has grown
            if after.increments.bit_count() == 1 and self.is_under_way(result.state):
                after = self.examined(after, result.state)
            return self._loaded(after)
        after = replace(after, ahead=self._ahead(after, judged.left))
        if now.failure is not None or not self._is_lost(after):
            return after
        failure, nothing = self._mechanism(after), _no_forces()
        # where the run goes on all the same, all of its loads act
        return replace(
            after, failure=failure, missing=nothing, ahead=nothing, reached=1.0, held=False
        )

    def examined(self, now: OnPath, state: State) -> OnPath:
        """Return the path in balance with the word on others that go on from there, if any do."""
        if now.branch or now.failure is not None or not now.balanced or not self._grows:
            return now
        judge = self.judge_of(now)
        mode = critical_mode(judge.model, judge.method, state, STEP_MAX * self._falls)
        if mode is None or mode.ratio < 1.0:
            return now
        return replace(now, branch=mode.stayed(state.time))

    def _converging(
        self, now: OnPath, before: State, result: StepResult, step: float, pushed: Bools
    ) -> Convergence:
        """Return how movements come to an end, with a step that ``pushed`` (n,) blocks."""
        movement, past = self._movement(before, result.state), now.convergence
        if len(now.ahead):
            return past.gone_ahead(movement, step)
        grows = now.steps == 0 or now.reached < 1.0 or self.is_under_way(before)
        if not len(past.total) or len(result.broken) or (now.begins and grows):
            return past.restarted(movement, step)
        return past.followed(movement, step, np.sqrt(self.model.area), pushed)

    def _with_more_to_come(self, judged: Judgement, now: Convergence) -> Judgement:
        """Return the judgement of a step, which is no balance where movements are to come."""
        if not judged.balanced or not now.coming:
            return judged
        more = f"with {now.coming:.3g} m still to come"
        if np.isinf(now.coming):
            more = "and by no less from step to step"
        why = f"block '{judged.mover.block}' moves by {now.moved:.3g} m a step, {more}"
        return replace(judged, balanced=False, hindrance=why)

    def _ahead(self, now: OnPath, left: Floats) -> Floats:
        """Return the forces against which the next step goes on, (n, 6), (0, 6) for none.

        ``left`` (n, 3) are those out of balance after this one.
        """
        turn = 0.5 * LARGEST_TURN * float(np.sqrt(self.model.smallest))
        steps = now.convergence.series(min(FAR_TRAVEL * self.method.max_displacement, turn))
        if now.failure is not None or not self._grows or steps == 1.0:
            return _no_forces()
        return np.hstack([(steps - 1.0) * left, np.zeros_like(left)])

    def _is_lost(self, now: OnPath) -> bool:
        """Return whether there is no balance to come."""
        if self._grows and now.steps - now.far >= convergence.IDLE_STEPS_MAX:
            return True
        if now.steps >= convergence.STEPS_MAX and now.far:
            return True
        if now.far < convergence.FAR_STEPS_MIN:
            return False
        moved = float(self._distances(now).max(initial=0.0))
        within = convergence.DISTANCE_MAX * float(np.ptp(self.model.vertices, axis=0).max())
        goes = moved > convergence.goes_from(self.model)
        return goes and not convergence.nears(now.driven, within - moved)

    def _loaded(self, now: OnPath) -> OnPath:
        """Return the path where an increment of load is in balance."""
        if now.reached >= 1.0:
            # bonds that were held are judged where all else is in balance
            return replace(now, held=False, steps=0, balanced=False) if now.held else now
        increment = now.increment if now.broken else 2.0 * now.increment
        after = replace(now, reached=now.load, increment=increment)
        return self._loaded(replace(after, missing=_no_forces())) if now.load == 1.0 else after

    def cut(self, now: OnPath, clock: float, cuts: int) -> OnPath:
        """Return the path where a step had to be cut, with the clock that it has come to, s."""
        if cuts == 0:
            return now
        return replace(now, growth=GROWTH_AFTER_CUT, clock=clock if clock > 0.0 else now.clock)

    def next_step(self, now: OnPath, taken: float, result: StepResult) -> float:
        """Return the pseudo time step of the next step, s."""
        if now.failure is not None:
            return min(taken, self.schedule.step)
        if not self._grows:
            return min(self.schedule.step, GROWTH_AFTER_CUT * taken)
        if now.balanced and now.reached == 1.0:
            if now.steps > 1 or self.is_under_way(result.state):
                # confirmed by a step of the same length: in a shorter one the same creep is more of
                # an acceleration, and steps would go back and forth between long and short
                return taken
            # longer ones would only let what nothing supports drift, a free body under loads that
            # balance each other, for one
            return min(taken, float(np.sqrt(0.1)) * self._falls)
        growth = now.growth
        if result.approach > 0.0:
            wanted = 0.8 * self.method.max_displacement
            growth = min(growth, float(np.sqrt(wanted / result.approach)))
        return min(STEP_MAX * self._falls, growth * taken)

    @property
    def _grows(self) -> bool:
        """Whether the process carries steps of any length."""
        return is_stable_for_any_step(self.method.process)

    @property
    def _falls(self) -> float:
        """Time in which a free block falls by max_displacement, s."""
        return float(np.sqrt(2.0 * self.method.max_displacement / self.model.usual_gravity))

    def _movement(self, before: State, after: State) -> Floats:
        """Return the movement of each block as ``Convergence`` has it, m, shape (n, 3)."""
        mean = mean_movement(after.vertices - before.vertices, self.model.block_start)
        turn = np.sqrt(self.model.area) * (after.rotation - before.rotation)
        moved = np.column_stack([mean, turn])
        return np.where(self.model.fixed[:, None], 0.0, moved)

    def _mechanism(self, now: OnPath) -> Mechanism:
        """Return the blocks that move where there is no balance."""
        far = self._distances(now)
        order = np.argsort(-far, kind="stable")
        chosen = order[far[order] >= 0.5 * far[order[0]]] if far[order[0]] > 0.0 else order[:0]
        names = self.model.block_name
        mover = now.judged.mover
        if len(chosen):
            direction = angle_of(now.moved[chosen[0]])
            mover = Mover(block=names[chosen[0]], speed=mover.speed, direction=direction)
        return Mechanism(
            blocks=tuple(names[block] for block in chosen),
            mover=mover,
            moved=float(far[order[0]]),
            steps=now.steps,
            load=now.load,
            hindrance=now.judged.hindrance,
            advice=SLOW if now.steps >= convergence.STEPS_MAX else "",
        )

    def _distances(self, now: OnPath) -> Floats:
        """Return how far each block has moved since the last balance, m, shape (n,)."""
        return np.where(self.model.fixed, 0.0, np.hypot(*now.moved.T))

    @cached_property
    def _with_bonds_held(self) -> Model:
        """The model with bonds that nothing breaks."""
        return with_bonds_held(self.model)
