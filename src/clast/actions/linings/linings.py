"""Linings: stiff segments, and at the middle of the thickness between them the springs of a beam.

    N = E A/l u,    Q = k G A/l v,    M = E I/l phi

u and v are how far two neighbours have moved apart along and across the lining, whose direction
there is the mean of theirs, phi is the angle between them, l the distance of their middles, A = t
and I = t^3/12 per metre of thickness and k = 5/6.  At an end that is clamped l is half of the
segment.  In plane strain E/(1 - nu^2) stands for E.  Segments keep their shape: all of the
compliance is in the springs, the sum of which over a beam of n segments differs from the integral
by 1/(2 n^2) (the trapezoidal rule).

A section yields where N and M reach its strength (sections.py).  N is clipped to the strength
of the section without a moment, M to its strength under the N of the same step: where a solution
does not agree with the bounds that it had, the step is solved again with those of its own N.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.actions.linings.lining_states import LiningStates, OneLining
from clast.actions.linings.sections import edge_stress
from clast.actions.links.link_states import LinkRows, LinkStates
from clast.actions.links.links import Links
from clast.errors import StepOutcome, StepRejected
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.supports import LiningJoints

ALONG, ACROSS, TURNING = range(3)
"""Components of a joint."""
BEYOND = 0.02
"""Moment beyond its strength, in units of the largest, with which no step is kept."""
AGREES = 1e-6
"""Difference of a moment from its strength that is none, in units of the largest strength."""


@dataclass(frozen=True, kw_only=True)
class SectionLimits:
    """Bounds of the forces in the joints of linings: N by itself, M by the normal force."""

    normal: Floats
    """Least and largest normal force of each joint, N/m, shape (k, 2)."""
    moment: Floats
    """Largest moment of each joint, N, inf for none, shape (k,)."""

    def bounds(self, rows: LinkRows, state: LinkStates) -> tuple[Floats, Floats]:
        """Return the least and the largest force of each row, N/m, or moment, N, (m,) each."""
        turns, axial = rows.component == TURNING, rows.component == ALONG
        moment, normal = self.moment[rows.link], self.normal[rows.link]
        low = np.where(turns, -moment, np.where(axial, normal[:, 0], -np.inf))
        high = np.where(turns, moment, np.where(axial, normal[:, 1], np.inf))
        return low, high


@dataclass(frozen=True, kw_only=True)
class LiningShare(Contribution):
    """The contribution of linings, with the largest moments that it allows."""

    bending: Floats = field(default_factory=lambda: np.zeros(0))
    """Of each joint, N, shape (k,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Linings:
    """The linings of a case."""

    each: tuple[OneLining, ...]
    """The linings."""
    springs: Links
    """The springs of their k joints, without limits."""
    apart: Ints
    """Pairs of neighbours, the lower first, whose faces do not press on each other, (p, 2)."""
    support: ClassVar[str] = ""

    @property
    def on_ground(self) -> Floats:
        """Points of ends that the ground holds, at the start, m, shape (g, 2)."""
        return self.springs.on_ground

    @property
    def segments(self) -> Ints:
        """Blocks of all segments, shape (s,)."""
        return np.concatenate([one.segments for one in self.each])

    @property
    def waits(self) -> tuple[tuple[str, str], ...]:
        """Linings that wait for stages, and names of these."""
        return tuple((f"lining '{one.name}'", one.stage) for one in self.each if one.stage)

    def begin(self, model: Model) -> LiningStates:
        """Return the linings at the start; those that wait for a stage are not installed."""
        none = np.zeros(len(self.springs.rows.name), np.bool_)
        return LiningStates(joints=self.springs.begin(model), cracked=none, yielded=none)

    def share(self, start: StepStart, state: LiningStates) -> LiningShare:
        """Return the springs of the joints, and that segments keep their shape."""
        forces = self.forces(state)
        bending = np.full(len(forces), np.inf)
        for one in self.each:
            if one.curve is not None:
                normal, _, moment = forces[one.joints].T
                allowed = one.curve.moment_at(normal)
                # what yields goes on to yield; from others the solution is awaited
                yields = (np.abs(moment) >= allowed - AGREES * one.curve.largest) & (moment != 0.0)
                bending[one.joints] = np.where(yields, allowed, np.inf)
        return self._share(start, state, bending)

    def again(
        self, start: StepStart, share: LiningShare, displacement: Floats
    ) -> LiningShare | None:
        """Return the share with other bounds where a solution d (n, 6) does not agree with its own.

        None: all moments are within what their normal forces allow.
        """
        if all(one.curve is None for one in self.each):
            return None
        state = start.state.actions
        mine = next((one for one in state if isinstance(one, LiningStates)), None)
        mine = self.begin(start.model) if mine is None else mine
        forces = self._within(share.bending).forces_at(start, mine.joints, displacement)
        forces = self._by_joint(forces)
        bending = share.bending.copy()
        for one in self.each:
            if one.curve is None:
                continue
            normal, _, moment = forces[one.joints].T
            allowed, close = one.curve.moment_at(normal), AGREES * one.curve.largest
            had, size = bending[one.joints], np.abs(moment)
            off = (size > allowed + close) | (
                (size >= had - close) & (np.abs(had - allowed) > close)
            )
            bending[one.joints] = np.where(off, allowed, had)
        if np.array_equal(bending, share.bending):
            return None
        return self._share(start, mine, bending)

    def finish(
        self, start: StepStart, state: LiningStates, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the joints, and their forces."""
        bending = share.bending if isinstance(share, LiningShare) else np.zeros(0)
        found = self._within(bending).finish(start, state.joints, share, solution)
        ended = self._judged(state, found.state)
        self._reject_beyond(start.model, ended)
        return replace(found, state=ended)

    def settled(
        self, start: StepStart, state: LiningStates, share: Contribution, displacement: Floats
    ) -> LiningStates:
        """Return the linings with the forces after d (n, 6) of a solution that moves nothing."""
        bending = share.bending if isinstance(share, LiningShare) else np.zeros(0)
        joints = self._within(bending).settled(start, state.joints, share, displacement)
        return self._judged(state, joints)

    def _reject_beyond(self, model: Model, state: LiningStates) -> None:
        """Raise StepRejected where a moment is beyond that of its normal force."""
        forces = self.forces(state)
        for one in self.each:
            if one.curve is None:
                continue
            normal, _, moment = forces[one.joints].T
            beyond = (np.abs(moment) - one.curve.moment_at(normal)) / one.curve.largest
            worst = int(beyond.argmax())
            if beyond[worst] > BEYOND:
                x, y = one.at[worst] + model.origin
                raise StepRejected(
                    StepOutcome.NOT_CONVERGED,
                    f"lining '{one.name}' at ({x:.4g}, {y:.4g}): the moment {moment[worst]:.3g} N "
                    f"exceeds the strength of its section under N = {normal[worst]:.3g} N/m",
                    remedy="Lower time.step; a section that is pulled apart needs tension",
                )

    def _judged(self, state: LiningStates, joints: LinkStates) -> LiningStates:
        """Return the linings with joints at the end of a step: which have cracked or yielded."""
        ended = LiningStates(joints=joints, cracked=state.cracked, yielded=state.yielded)
        forces = self.forces(ended)
        cracked, yielded = state.cracked.copy(), state.yielded.copy()
        for one in self.each:
            if one.curve is not None:
                normal, _, moment = forces[one.joints].T
                # the strength is reached where it is, or was taken as, the bound
                close, size = AGREES * one.curve.largest, np.abs(moment)
                yielded[one.joints] |= (size > close) & (
                    size >= one.curve.moment_at(normal) - close
                )
                yielded[one.joints] |= one.curve.utilisation(normal, moment) >= 1.0 - AGREES
                stress = edge_stress(normal, moment, one.thickness)
                pulled = stress > one.tension * (1.0 + AGREES) + AGREES * -one.curve.normal[0]
                cracked[one.joints] |= pulled
        return replace(ended, cracked=cracked, yielded=yielded)

    def events(
        self, model: Model, before: LiningStates, after: LiningStates
    ) -> Iterator[tuple[str, str, str]]:
        """Give kind, name and sentence of each event of linings in a step."""
        kinds = (
            ("cracked", "cracks", after.cracked & ~before.cracked),
            ("yielded", "yields", after.yielded & ~before.yielded),
        )
        for kind, verb, fresh in kinds:
            for one in self.each:
                for k in np.flatnonzero(fresh[one.joints]).tolist():
                    x, y = one.at[k] + model.origin
                    place = f"at ({x:.4g}, {y:.4g}), {one.along[k]:.4g} m along it"
                    yield kind, one.name, f"lining '{one.name}' {verb} {place}"

    # --- results

    def joints_in(self, model: Model) -> LiningJoints:
        """Return names and places of the joints."""
        face = []
        for one in self.each:
            first = model.block_start[one.segments[one.face[:, 0]]]
            count = one.shape.count[one.face[:, 0]]
            ends = one.face[:, 1] == 1
            outside = np.where(ends, count - 1, 0)
            inside = np.where(ends, count, count + 1)
            face.append(first[:, None] + np.stack([outside, inside], axis=1))
        return LiningJoints(
            name=self.springs.rows.name,
            along=np.concatenate([one.along for one in self.each]),
            face=np.concatenate(face).astype(np.int64),
            section=np.concatenate(
                [
                    np.tile([one.thickness, one.tension, one.compression], (len(one.joints), 1))
                    for one in self.each
                ]
            ),
        )

    def forces(self, state: LiningStates) -> Floats:
        """Return N, tension positive, Q, N/m, and M, N, of each joint, shape (k, 3).

        Q is the force to the left on what lies before the joint; M is positive where it stretches
        the left face, that of the opening.
        """
        return self._by_joint(state.joints.force)

    def utilisation(self, state: LiningStates) -> Floats:
        """Return the share of the strength that each joint uses, NaN without strengths, (k,)."""
        forces, found = self.forces(state), np.full(len(state.cracked), np.nan)
        for one in self.each:
            if one.curve is not None:
                normal, _, moment = forces[one.joints].T
                found[one.joints] = one.curve.utilisation(normal, moment)
        return found

    def condition(self, state: LiningStates) -> Ints:
        """Return 0 not installed, 1 intact, 2 cracked, 3 yielded, 4 lost of each joint, (k,)."""
        there, lost = np.zeros((2, len(state.cracked)), np.bool_)
        rows = self.springs.rows
        there[rows.link[~np.isnan(state.joints.rest)]] = True
        lost[rows.link[state.joints.broken]] = True
        found = np.where(there, 1, 0)
        found = np.where(state.cracked, 2, found)
        found = np.where(state.yielded, 3, found)
        return np.where(lost, 4, found)

    # --- springs

    def _share(self, start: StepStart, state: LiningStates, bending: Floats) -> LiningShare:
        """Return the contribution with these bounds of moments (k,)."""
        springs = self._within(bending).share(start, state.joints).springs
        return LiningShare(springs=springs, bending=bending)

    def _within(self, bending: Floats) -> Links:
        """Return the springs with bounds, those of the moments being given (k,)."""
        normal = np.tile([-np.inf, np.inf], (len(self.springs.rows.name), 1))
        for one in self.each:
            if one.curve is not None:
                normal[one.joints] = one.curve.normal[[0, -1]]
        return replace(self.springs, limits=SectionLimits(normal=normal, moment=bending))

    def _by_joint(self, force: Floats) -> Floats:
        """Return N, Q and M of each joint, (k, 3), from the forces of the rows, (m,)."""
        rows = self.springs.rows
        found = np.zeros((len(rows.name), 3))
        found[rows.link, rows.component] = force
        found[:, TURNING] *= -1.0
        return found


def linings_of(model: Model) -> tuple[Linings | None, int]:
    """Return the linings of a model, and how many of its actions come before them."""
    for number, action in enumerate(model.actions):
        if isinstance(action, Linings):
            return action, number
    return None, 0


def waiting_in(actions: tuple[Any, ...], count: int) -> Bools:
    """Return which of ``count`` blocks are segments that wait for a stage, shape (n,)."""
    found = np.zeros(count, np.bool_)
    for action in actions:
        for one in action.each if isinstance(action, Linings) else ():
            if one.stage:
                found[one.segments] = True
    return found
