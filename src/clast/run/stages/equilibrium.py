"""Whether blocks are in equilibrium: no force is out of balance, and none of them moves.

A step ends in equilibrium where

1. on every block the unbalanced force is below ``force_ratio`` of the sum of all forces on it,
2. no point of a block is faster than ``speed`` times sqrt(g x its size),
3. no contact that carries has changed its mode (a corner that goes on to the next edge of the same
   block with the same force has changed nothing), and
4. no load, no ground motion and no relaxation is under way;

a stage is in equilibrium where ``hold`` steps in a row do, in which

5. no block has slid along another without slowing down.

The ratio is that of the worst block: among ten thousand blocks at rest one that falls is a ten
thousandth of all forces.  The forces are those that act, without damping, and so are out of balance
where damping alone holds a speed.  Steps of a static run are short falls from rest: their speed is
g h times the unbalanced share, and says little where the step is short; 5 finds blocks that slide
on (decision 56).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clast.actions.relaxation import released_at
from clast.block import polygon
from clast.contact.contacts import LOCK, OPEN, SLIDE
from clast.contact.joints.along_joint import range_of_springs
from clast.model.ground_motion import is_over
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stage_records import Mover, towards
from clast.model.stages import EQUILIBRIUM, Stage, are_constant, factors_in
from clast.model.state import ContactMemory, State, contact_keys
from clast.run.stages.balance import ForceSums, angle_of, forces_of, mean_movement
from clast.run.stages.stage_position import EquilibriumStreak, Judgement, Position
from clast.step.method import Method, StepResult

CREEPING = 1e-3
"""Speed of a sliding block, as a share of the limit of equilibrium, that counts as rest."""
CREEPING_FORCE = 1e-5
"""Force that moves a block in a static step, in units of its weight, that is none."""
QUIET = 1e-3
"""Movement in a static step, in units of max_displacement, in which nothing slides to speak of."""
MODES = {OPEN: "open", SLIDE: "slide", LOCK: "lock"}
"""Modes of contacts in words."""


@dataclass(frozen=True, kw_only=True)
class EquilibriumCheck:
    """Judges the steps of one stage."""

    model: Model
    method: Method
    stage: Stage

    def after(self, position: Position, before: State, result: StepResult, step: float) -> Position:
        """Return the position after an accepted step of length ``step``, s, from ``before``."""
        still = replace(self.method, clock=0.0) if self.is_static else self.method
        sums = forces_of(self.model, still, (before, result), step)
        movement = result.state.vertices - before.vertices
        judged = self._judged((before, result), sums, movement, step)
        held = EquilibriumStreak()
        if not judged.hindrance:
            held = self._held(position.held, result, sums, movement, step)
            if not self.is_static and held.steps >= self.hold and (name := self._creeping(held)):
                judged = replace(judged, hindrance=f"block '{name}' slides and does not slow down")
                held = EquilibriumStreak()
        return replace(
            position,
            steps=position.steps + 1,
            seconds=position.seconds + sum(result.seconds.values()),
            broken=position.broken + len(result.broken),
            judged=judged,
            held=held,
        )

    def is_over(self, position: Position) -> bool:
        """Return whether the stage has come to its equilibrium."""
        return self.stage.until == EQUILIBRIUM and position.held.steps >= self.hold

    @cached_property
    def _limit(self) -> Floats:
        """Speed of each block that is none, m/s, shape (n,)."""
        return self.stage.speed * np.sqrt(self.model.usual_gravity * np.sqrt(self.model.area))

    @cached_property
    def _free(self) -> Bools:
        """True where a block can move, shape (n,)."""
        return ~self.model.fixed

    @cached_property
    def _noise(self) -> float:
        """Force of the stiffest spring by the rounding of coordinates, N/m."""
        finest = 4.0 * float(np.finfo(float).eps) * float(np.abs(self.model.vertices).max())
        return finest * range_of_springs(self.model, self.method.contact_law.normal_stiffness)[1]

    def _judged(
        self, states: tuple[State, StepResult], sums: ForceSums, movement: Floats, step: float
    ) -> Judgement:
        """Return how far from equilibrium a step ended."""
        stage, result = self.stage, states[1]
        least = self._noise / stage.force_ratio
        ratio = np.where(self._free, sums.unbalanced / np.maximum(sums.size, least), 0.0)
        speed = np.where(self._free, self._speeds(result.state, movement, step), 0.0)
        share = speed / self._limit
        fastest = int(share.argmax())
        mover = self._mover(fastest, float(speed[fastest]), movement)
        worst = int(ratio.argmax())
        judged = Judgement(
            force_ratio=float(ratio[worst]),
            unbalanced=self.model.block_name[worst] if ratio[worst] > 0.0 else "",
            speed=float(share[fastest]) * stage.speed,
            mover=mover,
        )
        why = self._unrest(judged, states, sums, (movement, step))
        idle = sums.unbalanced <= np.maximum(
            CREEPING_FORCE * np.minimum(self.model.mass * self.model.usual_gravity, sums.size),
            self._noise,
        )
        return replace(
            judged,
            hindrance=why or self.under_way(result.state),
            balanced=not why,
            left=np.where((self._free & ~idle)[:, None], sums.total, 0.0),
        )

    def _unrest(
        self,
        judged: Judgement,
        states: tuple[State, StepResult],
        sums: ForceSums,
        motion: tuple[Floats, float],
    ) -> str:
        """Return why a step did not end in balance, "" where it did.

        ``motion`` is the movement of each vertex, m, and the length of the step, s.
        """
        stage, (before, result) = self.stage, states
        if not judged.force_ratio < stage.force_ratio:
            return (
                f"the unbalanced force on block '{judged.unbalanced}' is {judged.force_ratio:.3g} "
                f"of the forces on it (force_ratio {stage.force_ratio:g})"
            )
        if self.is_static:
            return self._moves_on(*motion) or self._slides_on(result.state.memory, sums, motion[0])
        if not judged.speed < stage.speed:
            return (
                f"{judged.mover} moves, {judged.speed:.3g} of sqrt(g x its size) (speed "
                f"{stage.speed:g})"
            )
        return self._changes(before.memory, result.state.memory, sums)

    def _moves_on(self, movement: Floats, step: float) -> str:
        """Return which block a step without inertia to speak of would take along, "" for none."""
        model, gravity = self.model, self.model.usual_gravity
        far = np.where(self._free, polygon.farthest(movement, model.block_start), 0.0)
        force = model.mass * far / (self.method.integrator.theta * step**2)
        share = force / np.maximum(CREEPING_FORCE * model.mass * gravity, self._noise)
        worst = int(share.argmax())
        if share[worst] < 1.0:
            return ""
        accelerated = force[worst] / (model.mass[worst] * gravity)
        return (
            f"block '{model.block_name[worst]}' moves by {far[worst]:.3g} m a step, "
            f"{towards(self._mover(worst, 1.0, movement).direction)}, with {accelerated:.2g} g"
        )

    def _slides_on(self, memory: ContactMemory, sums: ForceSums, movement: Floats) -> str:
        """Return that contacts slide in a step as long as blocks move much, "" where not.

        A contact at its limit may go between slide and lock for ever, and nothing moves.
        """
        farthest = float(np.hypot(*movement.T).max(initial=0.0))
        slides = self._carries(memory, sums) & (memory.mode == SLIDE)
        if farthest <= QUIET * self.method.max_displacement or not slides.any():
            return ""
        return f"contacts slide while blocks move by {farthest:.3g} m a step"

    @property
    def is_static(self) -> bool:
        """Whether no velocity is carried from step to step."""
        return self.method.dynamic_ratio == 0.0

    @property
    def hold(self) -> int:
        """Steps in a row that must end in equilibrium.

        Static steps that end in balance with next to no mass term have nothing left to wait for.
        """
        return 2 if self.is_static else self.stage.hold

    def under_way(self, state: State) -> str:
        """Return the thing that is still going to change by itself, "" where there is none."""
        motion, time = self.model.ground_motion, state.time
        if not are_constant(factors_in(self.model), time):
            return "loads still change"
        if not is_over(motion, time):
            return "the ground still moves"
        if time < released_at(state):
            return "support forces are still released"
        moving = [one for one in self.model.actions if hasattr(one, "rest_from")]
        if any(time < one.rest_from(self.model) for one in moving):
            return "blocks are still moved"
        if any(hasattr(one, "flows_on") and one.flows_on(self.model) for one in state.actions):
            return "water still flows into joints or out of them"
        return ""

    def _speeds(self, state: State, movement: Floats, step: float) -> Floats:
        """Return the largest speed of a point of each block, m/s, shape (n,).

        That of the step, and where velocity is carried on that at its end, too.
        """
        speed = polygon.farthest(movement, self.model.block_start) / step
        if self.method.dynamic_ratio == 0.0:
            return speed
        u, v, spin = state.velocity[:, :3].T
        at_end = np.hypot(u, v) + np.abs(spin) * np.sqrt(self.model.area)
        return np.maximum(speed, at_end)

    def _mover(self, block: int, speed: float, movement: Floats) -> Mover:
        """Return the block as the one that moves most."""
        if not self._free.any():
            return Mover()
        first, past = self.model.block_start[block : block + 2]
        corners = movement[first:past]
        direction = angle_of(corners[int(np.hypot(*corners.T).argmax())])
        return Mover(block=self.model.block_name[block], speed=speed, direction=direction)

    def _carries(self, memory: ContactMemory, sums: ForceSums) -> Bools:
        """Return which contacts carry more than a negligible force, shape (k,)."""
        size = np.where(self._free, sums.size, np.inf)
        own, other = self.model.vertex_block[memory.vertex], memory.block
        least = self.stage.force_ratio * np.minimum(size[own], size[other])
        return np.asarray(memory.normal_force > np.maximum(least, self._noise))

    def _changes(self, before: ContactMemory, after: ContactMemory, sums: ForceSums) -> str:
        """Return which contact that carries has changed its mode, "" where none has."""
        count = len(self.model.vertices)
        old, new = (one.keys(count) for one in (before, after))
        old_carries, new_carries = (self._carries(one, sums) for one in (before, after))
        row, there = _rows(old, new)
        was = np.where(there, _taken(before.mode, row), OPEN)
        carried = there & _taken(old_carries, row)
        changed = (was != after.mode) & (carried | new_carries)
        ended = ~np.isin(old, new, assume_unique=True) & old_carries & (before.mode != OPEN)
        if not (changed.any() or ended.any()):
            return ""
        old, new = (
            contact_keys(one.vertex, one.block, one.point, count) for one in (before, after)
        )
        went_on, come_from = self._moved_on(
            (before, after), (old, new), (ended, changed & ~carried)
        )
        ended, changed = ended & ~went_on, changed & ~come_from
        for which, memory in ((changed, after), (ended, before)):
            if which.any():
                one = int(which.argmax())
                return self._named(memory, one, "changed" if memory is after else "opened")
        return ""

    def _moved_on(
        self,
        memories: tuple[ContactMemory, ContactMemory],
        keys: tuple[Ints, Ints],
        which: tuple[Bools, Bools],
    ) -> tuple[Bools, Bools]:
        """Return which contacts before and after a step are of a corner that went on to an edge.

        ``keys`` are those of vertex and block, ``which`` those that have ended and have begun.
        """
        (before, after), (old, new), (ended, come) = memories, keys, which
        went, came = np.zeros_like(ended), np.zeros_like(come)
        left = {int(old[row]): int(row) for row in np.flatnonzero(ended)}
        for row in np.flatnonzero(come):
            at = left.get(int(new[row]))
            if at is None or before.mode[at] != after.mode[row]:
                continue
            forces = before.normal_force[at], after.normal_force[row]
            least = self.stage.force_ratio * max(forces) + self._noise
            if abs(forces[0] - forces[1]) <= least:
                went[at] = came[row] = True
        return went, came

    def _named(self, memory: ContactMemory, row: int, did: str) -> str:
        """Return a contact that has changed its mode, in words."""
        names, mode = self.model.block_name, MODES[int(memory.mode[row])]
        own, other = names[self.model.vertex_block[memory.vertex[row]]], names[memory.block[row]]
        now = f" to {mode}" if did == "changed" else ""
        return (
            f"a contact of block '{own}' with '{other}' that carries "
            f"{memory.normal_force[row]:.3g} N/m {did}{now} in the last step"
        )

    def _held(
        self,
        held: EquilibriumStreak,
        result: StepResult,
        sums: ForceSums,
        movement: Floats,
        step: float,
    ) -> EquilibriumStreak:
        """Return the steps in equilibrium with one more."""
        model, memory = self.model, result.state.memory
        moved = mean_movement(movement, model.block_start)
        slides = self._carries(memory, sums) & (memory.mode == SLIDE)
        sliding = np.zeros(model.block_count, np.bool_)
        sliding[model.vertex_block[memory.vertex[slides]]] = True
        sliding[memory.block[slides]] = True
        first = held.steps == 0
        path = np.hypot(*moved.T) if first else held.path + np.hypot(*moved.T)
        steps = held.steps + 1
        return EquilibriumStreak(
            steps=steps,
            time=held.time + step,
            sliding=sliding if first else held.sliding & sliding,
            net=moved if first else held.net + moved,
            path=path,
            half=path if steps <= self.stage.hold // 2 else held.half,
        )

    def _creeping(self, held: EquilibriumStreak) -> str:
        """Return the name of a block that slides on, "" where none does."""
        if self.stage.hold < 2:
            return ""
        second = held.path - held.half
        on = held.sliding & self._free & (second > 0.5 * held.half)
        on &= np.hypot(*held.net.T) > 0.9 * held.path
        on &= held.path > CREEPING * self._limit * held.time
        return self.model.block_name[int(on.argmax())] if on.any() else ""


def _rows(known: Ints, wanted: Ints) -> tuple[Ints, Bools]:
    """Return where keys stand among sorted ones that are known, and whether they do, (k,) each."""
    row = np.minimum(np.searchsorted(known, wanted), max(0, len(known) - 1))
    there = known[row] == wanted if len(known) else np.zeros(len(wanted), np.bool_)
    return row, np.asarray(there)


def _taken(values: Ints | Bools, row: Ints) -> Ints:
    """Return values in some rows, zeros where there are no values at all."""
    return np.asarray(values[row] if len(values) else np.zeros(len(row), values.dtype))
