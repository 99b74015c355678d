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

The sections:
A rectangular section of thickness t that has yielded throughout, over a part c of it in compression
f_c and over the rest in tension f_t, carries

    N = f_t (t - c) - f_c c,    M = (f_c + f_t) c (t - c)/2,    0 <= c <= t

(N positive in tension): a parabola over N, and its mirror image below.  Without tension it is that
of plain concrete, N = -f_c (t - 2 e) with the eccentricity e = M/|N| (EN 1992-1-1, 12.6.1).  A
polygon with its corners on the curve stands for it, on the safe side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
from clast.actions.links import LinkRows, Links, LinkStates
from clast.errors import StepOutcome, StepRejected
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.supports import LiningJoints


@dataclass(frozen=True, kw_only=True)
class InteractionCurve:
    """The upper half of the polygon of normal force and moment; the lower is its mirror image."""

    normal: Floats
    """Normal force of its corners, ascending, tension positive, N/m, shape (c,)."""
    moment: Floats
    """Moment of each, N, shape (c,)."""

    @property
    def largest(self) -> float:
        """Largest moment of the section, N."""
        return float(self.moment.max())

    def moment_at(self, normal: Floats) -> Floats:
        """Return the largest moments (k,), N, of the section under normal forces (k,), N/m."""
        return np.asarray(np.interp(normal, self.normal, self.moment))

    def utilisation(self, normal: Floats, moment: Floats) -> Floats:
        """Return the share of the strength that is used, 1 on the curve, shape (k,).

        The moment over that which the section carries with this normal force, or the normal force
        over that which it carries without a moment, whichever is more.
        """
        least, most = self.normal[0], self.normal[-1]
        pressed = np.where(normal < 0.0, normal / least, 0.0)
        pulled = np.where(normal > 0.0, normal / max(most, np.finfo(float).tiny), 0.0)
        # at its ends the curve is steep, and the normal force says how near it is
        # Moment, in units of the largest, below which the curve is near one of its ends
        carries = np.maximum(self.moment_at(normal), 0.02 * self.largest)
        return np.maximum(np.abs(moment) / carries, np.maximum(pressed, pulled))


def interaction_curve(thickness: float, tension: float, compression: float) -> InteractionCurve:
    """Return the curve of a rectangular section, m, with strengths in Pa, all above 0."""
    # Corners of the polygon on each side, denser towards its ends: 64 sides in all
    pressed = 0.5 * thickness * (1.0 + np.cos(np.linspace(0.0, np.pi, 33)))
    pulled = thickness - pressed
    return InteractionCurve(
        normal=tension * pulled - compression * pressed,
        moment=0.5 * (tension + compression) * pressed * pulled,
    )


@dataclass(frozen=True, kw_only=True, repr=False)
class LiningShape:
    """How a lining of s segments lies along a line of p points, which rock may carry.

    A segment has the points of the line along its outer face, then the two ends of its inner face.
    """

    at: Floats
    """Points of the outer line as they were drawn, m, shape (p, 2)."""
    point: Ints
    """Point that each of a places in the rock carries, ascending, shape (a,)."""
    vertex: Ints
    """Vertices of the edge that each place is on, shape (a, 2)."""
    share: Floats
    """Where on it: 0 at the first of them, 1 at the second, shape (a,)."""
    first: Ints
    """First point of each segment, shape (s,)."""
    count: Ints
    """Number of points of each segment, shape (s,)."""
    inner: Floats
    """Inner ends of the two faces of each segment as they were drawn, m, shape (s, 2, 2)."""

    def points_of(self, segment: int) -> Ints:
        """Return the points of the outer face of a segment, shape (count,)."""
        return (self.first[segment] + np.arange(self.count[segment])) % len(self.at)


@dataclass(frozen=True, kw_only=True, repr=False)
class OneLining:
    """A lining of s segments and k joints: between segments, and at ends that are held."""

    name: str
    """Its name."""
    stage: str
    """Stage that installs it, "" where it is there from the start."""
    closed: bool
    """Whether the last segment is joined to the first."""
    thickness: float
    """Thickness, m."""
    tension: float
    """Tensile strength, Pa, inf where it has no strengths."""
    compression: float
    """Compressive strength, Pa, inf where it has none."""
    curve: InteractionCurve | None
    """Strength of its sections; None: it is elastic."""
    segments: Ints
    """Block of each segment, shape (s,)."""
    joints: Ints
    """Its joints among those of all linings, shape (k,)."""
    along: Floats
    """Where each joint is along the middle of the lining, from its start, m, shape (k,)."""
    at: Floats
    """Where each is as drawn, m, shape (k, 2)."""
    face: Ints
    """Segment, and 0 for its start or 1 for its end, where each joint is, shape (k, 2)."""
    meets: Ints
    """Joints at ends that are joined to another lining: number among all, 0 or 1 for its segment
    being the first or the second block, segment, and 0 for its start or 1 for its end, (q, 4)."""
    shape: LiningShape
    """How it lies."""
    inside: Ints
    """Blocks that must have been excavated where it comes, shape (r,)."""
    loose: Ints
    """Blocks of segments that are to be bonded and have no rock beside them, shape (q,)."""


@dataclass(frozen=True, kw_only=True)
class LiningStates:
    """The history of linings with k joints."""

    joints: LinkStates
    """The springs of their joints."""
    cracked: Bools
    """True where the tension at a face has been beyond the strength, shape (k,)."""
    yielded: Bools
    """True where the strength of the section has been reached, shape (k,)."""


ALONG, ACROSS, TURNING = range(3)
"""Components of a joint."""
STRENGTH_TOLERANCE = 1e-6
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
class LiningContribution(Contribution):
    """The contribution of linings, with the largest moments that it allows."""

    bending: Floats = field(default_factory=lambda: np.zeros(0))
    """Of each joint, N, shape (k,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Linings(Action):
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

    def contribution(self, start: StepStart, state: LiningStates) -> LiningContribution:
        """Return the springs of the joints, and that segments keep their shape."""
        forces = self.forces(state)
        bending = np.full(len(forces), np.inf)
        for one, curve, normal, moment in self._sections(forces):
            allowed = curve.moment_at(normal)
            # what yields goes on to yield; from others the solution is awaited
            yields = np.abs(moment) >= allowed - STRENGTH_TOLERANCE * curve.largest
            bending[one.joints] = np.where(yields & (moment != 0.0), allowed, np.inf)
        return self._share(start, state, bending)

    def again(
        self, start: StepStart, contribution: LiningContribution, displacement: Floats
    ) -> LiningContribution | None:
        """Return the contribution with other bounds where d (n, 6) does not agree with its own.

        None: all moments are within the limits that their normal forces allow.
        """
        if all(one.curve is None for one in self.each):
            return None
        state = start.state.actions
        mine = next((one for one in state if isinstance(one, LiningStates)), None)
        mine = self.begin(start.model) if mine is None else mine
        forces = self._within(contribution.bending).forces_at(start, mine.joints, displacement)
        forces = self._by_joint(forces)
        bending = contribution.bending.copy()
        for one, curve, normal, moment in self._sections(forces):
            allowed, close = curve.moment_at(normal), STRENGTH_TOLERANCE * curve.largest
            had, size = bending[one.joints], np.abs(moment)
            off = (size > allowed + close) | (
                (size >= had - close) & (np.abs(had - allowed) > close)
            )
            bending[one.joints] = np.where(off, allowed, had)
        if np.array_equal(bending, contribution.bending):
            return None
        return self._share(start, mine, bending)

    def finish(
        self, start: StepStart, state: LiningStates, contribution: Any, solution: Solution
    ) -> ActionResult:
        """Return the work of the joints, and their forces."""
        result = self._within(contribution.bending).finish(
            start, state.joints, contribution, solution
        )
        ended = self._judged(state, result.state)
        self._reject_beyond(start.model, ended)
        return replace(result, state=ended)

    def settled(
        self, start: StepStart, state: LiningStates, contribution: Any, displacement: Floats
    ) -> LiningStates:
        """Return the linings with the forces after d (n, 6) of a solution that moves nothing."""
        links = self._within(contribution.bending)
        return self._judged(state, links.settled(start, state.joints, contribution, displacement))

    def _reject_beyond(self, model: Model, state: LiningStates) -> None:
        """Raise StepRejected where a moment is beyond that of its normal force."""
        for one, curve, normal, moment in self._sections(self.forces(state)):
            beyond = (np.abs(moment) - curve.moment_at(normal)) / curve.largest
            worst = int(beyond.argmax())
            # Moment beyond its strength, in units of the largest, with which no step is kept
            if beyond[worst] > 0.02:
                x, y = one.at[worst] + model.origin
                raise StepRejected(
                    StepOutcome.NOT_CONVERGED,
                    f"lining '{one.name}' at ({x:.4g}, {y:.4g}): the moment "
                    f"{1e-3 * moment[worst]:.3g} kN m/m exceeds the strength of its section under "
                    f"N = {1e-3 * normal[worst]:.3g} kN/m",
                    remedy="Lower time.step; a section that is pulled apart needs tension",
                )

    def _judged(self, state: LiningStates, joints: LinkStates) -> LiningStates:
        """Return the linings with joints at the end of a step: which have cracked or yielded."""
        ended = LiningStates(joints=joints, cracked=state.cracked, yielded=state.yielded)
        forces = self.forces(ended)
        cracked, yielded = state.cracked.copy(), state.yielded.copy()
        for one, curve, normal, moment in self._sections(forces):
            # the strength is reached where it is, or was taken as, the bound
            close, size = STRENGTH_TOLERANCE * curve.largest, np.abs(moment)
            yielded[one.joints] |= (size > close) & (size >= curve.moment_at(normal) - close)
            used = curve.utilisation(normal, moment)
            yielded[one.joints] |= used >= 1.0 - STRENGTH_TOLERANCE
            # the largest elastic stress at the two faces
            stress = normal / one.thickness + 6.0 * size / one.thickness**2
            limit = one.tension * (1.0 + STRENGTH_TOLERANCE)
            cracked[one.joints] |= stress > limit + STRENGTH_TOLERANCE * -curve.normal[0]
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

        Q is the force to the left on the part before the joint; M is positive where it stretches
        the left face, that of the opening.
        """
        return self._by_joint(state.joints.force)

    def utilisation(self, state: LiningStates) -> Floats:
        """Return the share of the strength that each joint uses, NaN without strengths, (k,)."""
        forces, used = self.forces(state), np.full(len(state.cracked), np.nan)
        for one, curve, normal, moment in self._sections(forces):
            used[one.joints] = curve.utilisation(normal, moment)
        return used

    def condition(self, state: LiningStates) -> Ints:
        """Return 0 not installed, 1 intact, 2 cracked, 3 yielded, 4 lost of each joint, (k,)."""
        there, lost = np.zeros((2, len(state.cracked)), np.bool_)
        rows = self.springs.rows
        there[rows.link[~np.isnan(state.joints.rest)]] = True
        lost[rows.link[state.joints.broken]] = True
        number = np.where(there, 1, 0)
        number = np.where(state.cracked, 2, number)
        number = np.where(state.yielded, 3, number)
        return np.where(lost, 4, number)

    # --- springs

    def _share(self, start: StepStart, state: LiningStates, bending: Floats) -> LiningContribution:
        """Return the contribution with these bounds of moments (k,)."""
        springs = self._within(bending).contribution(start, state.joints).springs
        return LiningContribution(springs=springs, bending=bending)

    def _within(self, bending: Floats) -> Links:
        """Return the springs with bounds, those of the moments being given (k,)."""
        normal = np.tile([-np.inf, np.inf], (len(self.springs.rows.name), 1))
        for one in self.each:
            if one.curve is not None:
                normal[one.joints] = one.curve.normal[[0, -1]]
        return replace(self.springs, limits=SectionLimits(normal=normal, moment=bending))

    def _sections(
        self, forces: Floats
    ) -> Iterator[tuple[OneLining, InteractionCurve, Floats, Floats]]:
        """Yield each lining with strengths, its curve, and N and M (k,) of its joints."""
        for one in self.each:
            if one.curve is not None:
                normal, _, moment = forces[one.joints].T
                yield one, one.curve, normal, moment

    def _by_joint(self, force: Floats) -> Floats:
        """Return N, Q and M of each joint, (k, 3), from the forces of the rows, (m,)."""
        rows = self.springs.rows
        of_joints = np.zeros((len(rows.name), 3))
        of_joints[rows.link, rows.component] = force
        of_joints[:, TURNING] *= -1.0
        return of_joints


def linings_of(model: Model) -> tuple[Linings | None, int]:
    """Return the linings of a model, and how many of its actions come before them."""
    for number, action in enumerate(model.actions):
        if isinstance(action, Linings):
            return action, number
    return None, 0


def waiting_in(actions: tuple[Any, ...], count: int) -> Bools:
    """Return which of ``count`` blocks are segments that wait for a stage, shape (n,)."""
    waits = np.zeros(count, np.bool_)
    for action in actions:
        for one in action.each if isinstance(action, Linings) else ():
            if one.stage:
                waits[one.segments] = True
    return waits
