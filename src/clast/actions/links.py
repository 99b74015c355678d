"""Links: rows of clipped springs between two blocks at a point.

    F = clip(-k (x - x_0 - p), -F_y, F_y)

is the force on the first block of a component with the stretch x: a.(P_1 - P_2) along the link,
t.(P_1 - P_2) across it, or the angle between the blocks.  P_1 and P_2 are the point of the link as
each of its blocks carries it; a and t turn by s_1 r_1 + s_2 r_2, with the first block, with shares
of both, or not at all where the second is the ground.  With offsets y from the centroids

    dx/dr_1 = (y_1 - s_1 (P_1 - P_2)) x a,    dx/dr_2 = -(y_2 + s_2 (P_1 - P_2)) x a,

so, as s_1 + s_2 = 1, F is on both blocks at one place, s_1 P_2 + s_2 P_1: that of a pin in its
groove now.  The plastic stretch p grows where F would exceed F_y, and beyond a stretch it breaks
for good.  With a play g there is a spring for either side, each of which begins g away.  A dashpot
has F = -c dx/dt.

A spring against rotation is a row as well, at the end of arms that reach far out along t: there
the blocks move apart by -L r along a, r being their angle, and by a part 1/L of their motion at P.
The face across the link turns, which shears with its block.  Rigid components are as stiff
as fixed points are.

A step turns a block by an angle r about its centroid, and moves a point with the offset y by the
chord 2 sin(r/2) J R(r/2) y: by T d with the offset that it has halfway, up to r^3.  So rows are
taken there, with the velocities that the blocks have; else each step of a pendulum would begin with
its hinge drawn apart by r^2 y/2.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_springs,
)
from clast.block import polygon
from clast.block.displacement import movements
from clast.block.rotation import turned_by
from clast.contact.clipped_spring import Clipped, Springs, no_springs, table
from clast.linear.system import stretches, with_ground
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger
from clast.model.supports import FREE, GROUND, RIGID, SOFT, LinkLines

COMPONENTS = ("along", "across", "rotation")
"""Components of a link."""


@dataclass(frozen=True, kw_only=True, repr=False)
class LinkRows:
    """The m rows of springs of k links: one for each component that a link has."""

    name: tuple[str, ...]
    """Name of each link."""
    block: Ints
    """Its two blocks, or one and GROUND, shape (k, 2)."""
    at: Floats
    """Its point at the start, m, shape (k, 2)."""
    along: Floats
    """Unit vector of its direction at the start, shape (k, 2)."""
    turning: Floats
    """Shares of the turns of its two blocks, of sum 1, by which its direction turns, (k, 2)."""
    stage: tuple[str, ...]
    """Stage that installs it, "" where it is there from the start."""
    also: tuple[str, ...] = ()
    """Further stage that it waits for, "" for none; empty where none waits for two."""
    link: Ints
    """Link of each row, ascending, shape (m,)."""
    component: Ints
    """Its component, shape (m,)."""
    stiffness: Floats
    """N/m per m, or N per rad, inf: rigid, shape (m,)."""
    strength: Floats
    """Force, N/m, or moment, N, at which it yields, inf: never, shape (m,)."""
    rupture: Floats
    """Stretch, m or rad, at which it breaks for good, inf: never, shape (m,)."""
    gap: Floats
    """Play to either side before it acts, m or rad, shape (m,)."""
    damping: Floats
    """Force by rate, N s/m2 or N s per rad, shape (m,)."""

    @property
    def blocks(self) -> Ints:
        """Blocks of each row, shape (m, 2)."""
        return np.asarray(self.block[self.link])


@dataclass(frozen=True, kw_only=True)
class LinkStates:
    """Where k links are, and the history of their m rows."""

    at: Floats
    """Their points on the first and the second block, m, shape (k, 2, 2)."""
    angle: Floats
    """By how much the first block has turned against the second, rad, shape (k,)."""
    rest: Floats
    """Stretch at which each row was installed, m or rad, NaN before, shape (m,)."""
    plastic: Floats
    """Plastic stretch, m or rad, shape (m,)."""
    force: Floats
    """Force on the first block, N/m, or moment, N, without damping, shape (m,)."""
    drag: Floats
    """Force or moment of its dashpot, shape (m,)."""
    yielded: Bools
    """True where it has yielded, shape (m,)."""
    broken: Bools
    """True where it has broken, or lost its block, shape (m,)."""

    @property
    def carries(self) -> Bools:
        """Whether it can carry a force, shape (m,)."""
        return np.asarray(~np.isnan(self.rest) & ~self.broken)


class ForceLimits(Protocol):
    """Limits of the forces of links."""

    def bounds(self, rows: LinkRows, state: LinkStates) -> tuple[Floats, Floats]:
        """Return the least and the largest force of each row, N/m, or moment, N, (m,) each."""
        ...


@dataclass(frozen=True)
class YieldForces:
    """Each row yields by itself, to either side alike."""

    def bounds(self, rows: LinkRows, state: LinkStates) -> tuple[Floats, Floats]:
        """Return the strengths, of both signs."""
        return -rows.strength, rows.strength


ROTATION = COMPONENTS.index("rotation")


@dataclass(frozen=True, kw_only=True)
class Links(Action):
    """The links of a case."""

    rows: LinkRows
    """Their components."""
    apart: Ints
    """Pairs of blocks, the lower first, that have no contacts with each other, shape (p, 2)."""
    limits: ForceLimits = field(default_factory=YieldForces)
    """Bounds of the forces."""
    support: ClassVar[str] = ""
    """They hold blocks by each other."""

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links."""
        return self.rows.name

    @property
    def on_ground(self) -> Floats:
        """Points of links to the ground at the start, m, shape (g, 2)."""
        return np.asarray(self.rows.at[(self.rows.block == GROUND).any(axis=1)])

    @property
    def lines(self) -> LinkLines:
        """Places of the links at the start, and their blocks, for pictures."""
        rows = self.rows
        holds = np.full((len(rows.name), len(COMPONENTS)), FREE)
        holds[rows.link, rows.component] = np.where(np.isinf(rows.stiffness), RIGID, SOFT)
        return LinkLines(
            name=rows.name, block=rows.block, at=rows.at, along=rows.along, holds=holds
        )

    @property
    def waits(self) -> tuple[tuple[str, str], ...]:
        """Links that wait for stages, and names of these."""
        pairs = zip(self.rows.name, self.rows.stage, strict=True)
        return tuple((f"link '{name}'", stage) for name, stage in pairs if stage)

    def begin(self, model: Model) -> LinkStates:
        """Return the links at the start; those that wait for a stage are not installed."""
        rows, count = self.rows, len(self.rows.link)
        state = LinkStates(
            at=np.repeat(rows.at[:, None], 2, axis=1),
            angle=np.zeros(len(rows.at)),
            rest=np.full(count, np.nan),
            plastic=np.zeros(count),
            force=np.zeros(count),
            drag=np.zeros(count),
            yielded=np.zeros(count, np.bool_),
            broken=np.zeros(count, np.bool_),
        )
        return self._installed(model, state, np.zeros(count))

    def contribution(self, start: StepStart, state: LinkStates) -> Contribution:
        """Return the springs of all links that carry between blocks that can move."""
        active = self._active(start, state)
        if not len(active.row):
            return Contribution()
        return LinkContribution(springs=self._springs(start, active)[0], active=active)

    def again(
        self, start: StepStart, contribution: Contribution, displacement: Floats
    ) -> Contribution | None:
        """Return the contribution with rows that d (n, 6) stretches in a static step as blocks do.

        None where they did, near enough.  No velocity says how far blocks turn in a static step,
        and along the chord they would draw rigid links apart.
        """
        if start.clock is None or not isinstance(contribution, LinkContribution):
            return None
        active = contribution.active
        moved = self._all_moved(start, active, displacement)
        at = self._carried(start, active.state, displacement)
        turn = start.state.rotation + start.rotation.angle(displacement[:, 2])
        stretch = self._stretch(at, turn, active.state.angle + self._turned(moved))
        missed = np.abs(active.stiffness * (stretch - active.stretch - moved))[active.row]
        force = self._stretched(active, active.state, active.stretch + moved).force
        # Force that rows may miss in a static step, as a share of the largest of them
        if float(missed.max()) <= 1e-5 * float(np.abs(force).max()):
            return None
        active = replace(active, stretch=stretch - moved)
        return LinkContribution(springs=self._springs(start, active)[0], active=active)

    def finish(
        self, start: StepStart, state: LinkStates, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the links: they store energy, yield, break and damp."""
        active, rows = self._active(start, state), self.rows
        work, brought, (drag, moved) = 0.0, 0.0, np.zeros((2, len(rows.link)))
        if contribution.springs is not None:
            active = contribution.active if isinstance(contribution, LinkContribution) else active
            work, _ = energy_of_springs(contribution.springs, solution)
            _, _, before = self._springs(start, active)
            brought = float(
                solution.spring_forces(contribution.springs)[0]
                @ (before - contribution.springs.gap)
            )
            moved = self._all_moved(start, active, solution.displacement)
            drag = -rows.damping * moved / start.step
        begun = active.state
        pulled = self._stretched(active, begun, active.stretch + moved)
        breaks = pulled.carries & (np.abs(active.stretch + moved - begun.rest) > rows.rupture)
        ended = replace(
            pulled,
            force=np.where(breaks, 0.0, pulled.force),
            broken=pulled.broken | breaks,
            at=self._carried(start, begun, solution.displacement),
            angle=begun.angle + self._turned(moved),
            drag=drag,
        )
        k = active.stiffness
        before, whole, after = (0.5 * one.force**2 / k for one in (begun, pulled, ended))
        flow = np.abs(pulled.force * (pulled.plastic - begun.plastic))
        return ActionResult(
            work=work,
            ledger=Ledger(
                loads=brought,
                links=float(np.sum(after - before)),
                yielding=float(np.sum(flow + whole - after)),
                damping=float(-np.sum(drag * moved)),
            ),
            state=ended,
        )

    def forces_at(self, start: StepStart, state: LinkStates, displacement: Floats) -> Floats:
        """Return the forces (m,) of all rows after d (n, 6), N/m, or moments, N."""
        return self._pulled(start, state, displacement)[0].force

    def settled(
        self, start: StepStart, state: LinkStates, contribution: Contribution, displacement: Floats
    ) -> LinkStates:
        """Return the links with the forces after d (n, 6) of a solution that moves nothing."""
        pulled, moved = self._pulled(start, state, displacement)
        return replace(pulled, rest=pulled.rest - moved)

    def _pulled(
        self, start: StepStart, state: LinkStates, displacement: Floats
    ) -> tuple[LinkStates, Floats]:
        """Return the links with the forces after d (n, 6), and by how much it stretches rows."""
        active = self._active(start, state)
        moved = self._all_moved(start, active, displacement)
        return self._stretched(active, active.state, active.stretch + moved), moved

    def events(
        self, model: Model, before: LinkStates, after: LinkStates
    ) -> Iterator[tuple[str, str, str]]:
        """Give kind, name and sentence of each event of links in a step."""
        for kind, said in (("yielded", "yields"), ("broken", "breaks")):
            fresh = getattr(after, kind) & ~getattr(before, kind)
            for row in np.flatnonzero(fresh):
                name = self.rows.name[self.rows.link[row]]
                what = COMPONENTS[self.rows.component[row]]
                happened = "broke" if kind == "broken" else kind
                yield happened, name, f"link '{name}' {said} ({what})"

    def borne(self, state: LinkStates) -> Floats:
        """Return force along and across, N/m, and moment, N, on the first blocks, (k, 3)."""
        forces = np.zeros((len(self.rows.name), 3))
        forces[self.rows.link, self.rows.component] = state.force + state.drag
        return forces

    def condition(self, state: LinkStates) -> Ints:
        """Return 0 not installed, 1 intact, 2 yielded, 3 broken: the worst of each link, (k,)."""
        rows = np.where(np.isnan(state.rest), 0, 1)
        rows = np.where(state.yielded, 2, rows)
        rows = np.where(state.broken, 3, rows)
        worst = np.zeros(len(self.rows.name), np.int64)
        np.maximum.at(worst, self.rows.link, rows)
        return worst

    # --- rows

    def _active(self, start: StepStart, state: LinkStates) -> ActiveRows:
        """Return the rows that act in a step."""
        rows, model = self.rows, start.model
        ahead = with_ground(_halfway(start), 0.5 * _of_ground(start))
        rotation = with_ground(start.state.rotation) + ahead[:, 2]
        turn = (rotation[rows.block] * rows.turning).sum(axis=1)
        centroid = with_ground(start.frames.centroid)[rows.block]
        offset = turned_by(
            (state.at - centroid).reshape(-1, 2), ahead[rows.block.ravel(), 2]
        ).reshape(-1, 2, 2)
        centroid = centroid + ahead[rows.block, :2]
        place = (offset + centroid)[:, ::-1] * rows.turning[:, :, None]
        offset = place.sum(axis=1)[:, None] - centroid
        stretch = self._stretch(state.at, start.state.rotation, state.angle)
        state = self._installed(model, state, stretch)
        acts = state.carries & ~np.append(model.fixed, True)[rows.blocks].all(axis=1)
        size = float(np.hypot(*np.ptp(model.vertices, axis=0)))
        small = float(np.sqrt(model.smallest))
        rigid = np.where(rows.component == ROTATION, small**2, 1.0) * start.support_stiffness
        # Length of the arms of rows against rotation, in units of the system
        return ActiveRows(
            state=state,
            row=np.flatnonzero(acts),
            along=turned_by(rows.along, turn),
            offset=offset,
            stretch=stretch,
            stiffness=np.where(np.isinf(rows.stiffness), rigid, rows.stiffness),
            arm=1e7 * size,
        )

    def _stretch(self, at: Floats, rotation: Floats, angle: Floats) -> Floats:
        """Return the stretch of each row, m or rad, (m,), with the points of links (k, 2, 2), m.

        ``rotation`` (n,) is that of the blocks, ``angle`` (k,) that between those of a link, rad.
        """
        rows = self.rows
        turn = (with_ground(rotation)[rows.block] * rows.turning).sum(axis=1)
        x, y = (at[:, 0] - at[:, 1]).T
        ax, ay = turned_by(rows.along, turn).T
        parts = np.stack([ax * x + ay * y, ax * y - ay * x, angle], axis=1)
        return np.asarray(parts[rows.link, rows.component])

    def _installed(self, model: Model, state: LinkStates, stretch: Floats) -> LinkStates:
        """Return the links with those installed that are there by now, and without lost ones."""
        rows, begun = self.rows, dict(model.begun)
        waits = zip(rows.stage, rows.also or rows.stage, strict=True)
        there = np.array([begun.keys() >= {*pair} - {""} for pair in waits], np.bool_)[rows.link]
        lost = there & with_ground(model.absent)[rows.blocks].any(axis=1)
        fresh = there & np.isnan(state.rest) & ~lost
        if not fresh.any() and not (lost & ~state.broken).any():
            return state
        return replace(
            state,
            rest=np.where(fresh, stretch, state.rest),
            broken=state.broken | lost,
            force=np.where(lost, 0.0, state.force),
        )

    def _springs(self, start: StepStart, active: ActiveRows) -> tuple[Springs, Ints, Floats]:
        """Return the table of s springs, and which of its rows come first, second, third: (3 r,).

        Each row that acts has a spring to one side, one to the other, and a dashpot.  The last are
        the stretches when the step begins, m, (s,): the gaps of the table count the motion of the
        ground in the step already.
        """
        rows, row = self.rows, active.row
        arms, scale = self._arms(active)
        block, ground = rows.block[rows.link[row]], len(start.model.fixed)
        away = np.subtract(*(block == GROUND).T.astype(float)) * (
            arms[:, :2] @ _of_ground(start)[:2]
        )
        free = active.stretch[row] - active.state.rest[row] - active.state.plastic[row]
        stretch, count = scale * free, len(row)
        each, kept = self._each_spring(start, active, scale, stretch)
        chosen = np.concatenate([np.flatnonzero(one) + k * count for k, one in enumerate(kept)])
        columns = zip(*(one.arrays for one in each), strict=True)
        normal = Clipped(*(np.concatenate(column)[chosen] for column in columns))
        at, nothing = chosen % count, no_springs(len(chosen))
        springs, order = table(
            vertex_block=np.where(block == GROUND, ground, block)[at, 0],
            edge_block=np.where(block == GROUND, ground, block)[at, 1],
            arms=arms[at],
            gap=(stretch + away)[at],
            slip=nothing.at_zero,
            normal=normal,
            shear=nothing,
        )
        places, before = np.full(3 * count, -1), np.empty(len(at))
        places[chosen], before[order] = order, stretch[at]
        return replace(springs, ground=ground if (block == GROUND).any() else -1), places, before

    def _arms(self, active: ActiveRows) -> tuple[Floats, Floats]:
        """Return direction and arms of the rows that act, (r, 6), and their scale, (r,).

        The stretch at the end of the arms, m, is the scale times the row's own: -L for angles.
        """
        rows, row = self.rows, active.row
        link, turns = rows.link[row], rows.component[row] == ROTATION
        along = active.along[link]
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        normal = np.where((rows.component[row] == 1)[:, None], across, along)
        reach = np.where(turns, active.arm, 0.0)[:, None] * across
        offset = active.offset[link] + reach[:, None]
        arms = np.concatenate([normal, offset[:, 0], offset[:, 1]], axis=1)
        return arms, np.where(turns, -active.arm, 1.0)

    def _each_spring(
        self, start: StepStart, active: ActiveRows, scale: Floats, stretch: Floats
    ) -> tuple[tuple[Clipped, ...], tuple[Bools, ...]]:
        """Return the springs to one side and to the other and the dashpots, and which there are.

        ``stretch`` is that at the end of the arms, m; all have the shape (r,).
        """
        rows, row, state = self.rows, active.row, active.state
        stiffness = active.stiffness[row] / scale**2
        play = rows.gap[row] * np.abs(scale)
        # a force f of the component is f/scale in the row: the two have opposite bounds at the arms
        weakest, strongest = (one[row] / scale for one in self.limits.bounds(rows, state))
        weakest, strongest = np.minimum(weakest, strongest), np.maximum(weakest, strongest)
        none, two_sided = np.zeros(len(row)), play == 0.0
        # what is rigid is not a spring that swings: half of its stretch would be a force that grows
        place = np.where(np.isinf(rows.stiffness[row]), 1.0, start.forces_at)

        def springs(low: Floats, high: Floats, shift: Floats) -> Clipped:
            return Clipped(stiffness * shift, stiffness, low, high).taken_at(place, stretch)

        drag = rows.damping[row] / scale**2 / start.step
        endless = np.full(len(row), np.inf)
        each = (
            springs(weakest, np.where(two_sided, strongest, 0.0), play),
            springs(none, np.where(two_sided, 0.0, strongest), -play),
            Clipped(drag * stretch, drag, -endless, endless),
        )
        return each, (np.ones(len(row), np.bool_), ~two_sided, rows.damping[row] > 0.0)

    def _all_moved(self, start: StepStart, active: ActiveRows, displacement: Floats) -> Floats:
        """Return by how much d (n, 6) stretches the rows, m or rad, shape (m,)."""
        moved = np.zeros(len(self.rows.link))
        if len(active.row):
            springs, places, before = self._springs(start, active)
            opening = stretches(springs, displacement)[0] - before
            turns = self.rows.component[active.row] == ROTATION
            first = places[: len(active.row)]
            moved[active.row] = opening[first] / np.where(turns, -active.arm, 1.0)
        return moved

    def _turned(self, moved: Floats) -> Floats:
        """Return the angles (k,) of rows that were stretched (m,)."""
        angles = np.zeros(len(self.rows.name))
        turns = self.rows.component == ROTATION
        angles[self.rows.link[turns]] = moved[turns]
        return angles

    def _stretched(self, active: ActiveRows, state: LinkStates, stretch: Floats) -> LinkStates:
        """Return the rows at their stretches (m,): their forces, and which yield."""
        rows, k = self.rows, active.stiffness
        elastic = stretch - state.rest - state.plastic
        beyond = np.sign(elastic) * np.maximum(np.abs(elastic) - rows.gap, 0.0)
        straight = np.where(state.carries, -k * beyond, 0.0)
        straight = np.nan_to_num(straight)
        force = np.clip(straight, *self.limits.bounds(rows, state))
        flow = np.where(force != straight, (force - straight) / k, 0.0)
        return replace(
            state,
            force=force,
            plastic=state.plastic + flow,
            yielded=state.yielded | (force != straight),
        )

    def _carried(self, start: StepStart, state: LinkStates, displacement: Floats) -> Floats:
        """Return where the blocks carry the points, m, (k, 2, 2)."""
        block, at = self.rows.block.ravel(), state.at.reshape(-1, 2)
        block = np.where(block == GROUND, len(start.model.fixed), block)
        offset = polygon.offsets(at, block, with_ground(start.frames.centroid))
        displacement = with_ground(displacement, _of_ground(start))
        moved = movements(start.rotation, offset, displacement, block)
        return np.asarray((at + moved).reshape(-1, 2, 2))


def _of_ground(start: StepStart) -> Floats:
    """Return the displacement of the ground in the step, (6,), m."""
    ground = start.model.ground_motion
    before, after = (ground.anchor_displacement(t) for t in (start.state.time, start.end))
    return np.append(after - before, np.zeros(4))


def _halfway(start: StepStart) -> Floats:
    """Return half of the motion by velocities in the step, (n, 6); nothing in a static one."""
    if start.clock is not None:
        return np.zeros_like(start.state.velocity)
    return np.asarray(0.5 * start.step * start.state.velocity)


@dataclass(frozen=True, kw_only=True)
class ActiveRows:
    """Rows that act in a step."""

    state: LinkStates
    """The links as it begins."""
    row: Ints
    """Rows that act, shape (r,)."""
    along: Floats
    """Direction of each link halfway through the step, shape (k, 2)."""
    offset: Floats
    """Offsets of the place at which it acts from the centroids there, m, shape (k, 2, 2)."""
    stretch: Floats
    """Stretch of each row, m or rad, shape (m,)."""
    stiffness: Floats
    """Stiffness of each row, rigid ones with a number, shape (m,)."""
    arm: float
    """Length of the arms of rows against rotation, m."""


@dataclass(frozen=True, kw_only=True)
class LinkContribution(Contribution):
    """The contribution of links, with the rows that it is made of."""

    active: ActiveRows
