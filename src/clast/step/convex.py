"""The convex process: a step is the minimum of the incremental potential energy.

    1/2 d.K d - F.d + sum phi_n(gap + n.d) + sum phi_t(t.d),    phi_n' = -N,  phi_t' = -T

with K and F of inertia, elasticity, weight and loads (block diagonal), and the friction bound of
each contact taken from a given normal force.  N falls with the gap and T with the slip, so the
potential is convex and once continuously differentiable: Newton's method with an exact line search
converges from anywhere.  Each iteration solves one assembled, symmetric positive definite system.
Where it takes long the interior point method takes over (minimise/interior_point.py).

What is not convex is taken out of the minimisation and repeated around it: the friction bound
follows the normal force (``friction_updates``), and bonds that reach their strength are broken
before the minimum is sought again; bonds only break, so this ends.  Multipliers, where the law has
them, are renewed after convergence.

What a minimisation leaves open is no more than a start for the next one, with bounds that push the
minimum away in any case.  So where the friction bound is going to be renewed, the minimum need not
be nearer than a small share of how far the new bounds push it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from clast.compute.reductions import is_any
from clast.compute.stopwatch import Stages
from clast.contact import multipliers
from clast.contact.clipped_spring import Clipped, Rows, Springs, merged, springs_of
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.joints.bonds import without_bonds
from clast.contact.laws import ContactLaw, SpringLaw, has_limits
from clast.errors import StepOutcome
from clast.linear.reuse import FactorOfStep
from clast.linear.system import Bearing, contact_motions, graph_of, inverse_of_blocks
from clast.minimise.each_block import TRIES, EachBlock
from clast.minimise.islands import islands_of
from clast.minimise.newton import Newton, Work, best_of
from clast.minimise.potential import Point, Potential
from clast.minimise.schedule import Schedule, SmallIslands
from clast.minimise.subproblem import touched
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.read_only import changed
from clast.step.energy_balance import noise_of, round_off
from clast.step.finish import finish
from clast.step.impact import Entering, after_impacts, bearing, first_bases, scheme_of
from clast.step.integration import HalfWay, answer, half_way
from clast.step.method import Method, Solved, StepResult, Workspace
from clast.step.relief import relieved
from clast.step.start import Begun, begin, diagonal_terms
from clast.step.travel import (
    JUMP,
    closes_unseen,
    farther,
    search_within_step,
    travel_expected,
    travel_of,
)

AT_REST = 1.0
"""Slip rate below which a new contact is taken to hold at first, in units of g h."""
LANDING = 1e-3
"""Closing velocity from which a new contact is one that lands, in units of g h."""


@dataclass(frozen=True)
class Convex:
    """Newton's method on the incremental potential, with exact line search."""

    tolerance: float = 1e-7
    """The step is solved where the potential is within tolerance^2 x energy of its forces."""
    iterations: int = 200
    """Newton iterations at most; a step that needs more is cut."""
    friction_updates: int = 1
    """Times that the friction bound is renewed from the normal forces just found."""
    restitution: float = 0.0
    """Share of the closing velocity with which impacts rebound, 0 to 1."""

    any_step: ClassVar[bool] = True
    remedies: ClassVar[Mapping[StepOutcome, str]] = {
        StepOutcome.NOT_CONVERGED: (
            "Raise method.process.iterations, or lower method.contact_law.normal_stiffness or "
            "time.step"
        ),
    }

    def step(
        self,
        model: Model,
        method: Method,
        state: State,
        step: float,
        workspace: Workspace | None = None,
    ) -> StepResult:
        """Return the state ``step`` seconds later, or raise StepRejected."""
        stages = Stages(workspace.clock) if workspace else Stages()
        stages("base system")
        begun = begin(model, method, state, step, workspace)
        stages("contacts")
        travel = travel_expected(begun)
        contacts = begun.contacts(search_within_step(method, travel), begun.drift)
        starts: tuple[Floats, ...] = (np.zeros_like(begun.velocity),)
        counts = {"passes": 0, "line_search": 0, "factorisations": 0, "pcg": 0}
        while True:
            solved = self._solved(begun, contacts, starts, counts, stages)
            stages("contacts")
            wider = farther(method, travel, travel_of(begun, solved.unknowns))
            if wider is None:
                break
            seen, travel = contacts, wider
            contacts = begun.contacts(search_within_step(method, travel), begun.drift)
            if not closes_unseen(seen, contacts, solved.unknowns):
                break
            starts = (solved.unknowns,)
        return finish(begun, solved, stages)

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn of carried multipliers; the process itself holds for any stiffness and step."""
        return multipliers.advice(method.contact_law, model, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return E of the stiffest rock: stiff enough not to be seen, soft enough to be quick."""
        return model.stiffest, "E of the stiffest rock; the process holds for any"

    def _solved(
        self,
        begun: Begun,
        contacts: Contacts,
        starts: tuple[Floats, ...],
        counts: dict[str, int],
        stages: Stages,
    ) -> Solved:
        """Return what the step comes to with these contacts; ``counts`` is added to."""
        model, method = begun.model, begun.method
        stages("contacts")
        contacts = relieved(model, method, begun.state, contacts)
        graph = graph_of(contacts, model.block_count)
        stages("impacts")
        entering = after_impacts(begun, contacts, graph, self.restitution)
        stages("contacts")
        share = begun.at.forces_at
        taken = half_way(model, method.contact_law, contacts, share, begun.step)
        scheme = scheme_of(begun, contacts, graph, entering, taken)
        stages("base system")
        base = diagonal_terms(begun, entering.drift, scheme)
        others = () if begun.springs is None else (begun.springs,)
        springs, (rows, *_) = merged(springs_of(contacts), others)
        potential = Potential(
            base=base,
            inverse=inverse_of_blocks(base.diagonal),
            fixed=model.fixed,
            springs=springs,
            graph=graph_of(springs, model.block_count) if others else graph,
            islands=islands_of(springs, model.fixed),
        )
        tolerance = max(
            self.tolerance**2 * potential.reference_energy(),
            round_off(model, method, begun.state, len(springs)),
        )
        each = self.each_block(begun, len(springs))
        largest = potential.sum_of_forces()
        base_of_friction = first_friction_base(begun, contacts, entering, largest)
        contacts = changed(contacts, friction_base=base_of_friction)
        # warm starts: it goes on as it moves, or rests as it rested, or nothing touches it
        starts = (entering.drift, *starts, potential.untouched())
        factor = FactorOfStep(begun.workspace.inexact(method.solver), begun.workspace.patterns)
        search = Search(
            law=method.contact_law,
            taken=taken,
            rows=rows,
            schedule=self.schedule(factor),
            friction=self.friction(),
            tolerance=tolerance,
            each=each,
            work=Work(factor=factor, counts=counts, stages=stages),
        )
        bonded = contacts.bonded
        unknowns, contacts, response = search.minimum(potential, contacts, starts)
        counts["factorisations"] += factor.factorised
        counts["pcg"] += factor.iterations
        return Solved(
            velocity=entering.velocity,
            drift=entering.drift,
            scheme=scheme,
            unknowns=unknowns,
            contacts=contacts,
            response=response,
            applied=search.applied(contacts, response, unknowns),
            bearing=bearing(contacts, entering, response.normal_force),
            depth=JUMP * method.critdis,
            lost=entering.lost,
            bonded=bonded,
            counts=counts,
        )

    def schedule(self, factor: FactorOfStep) -> Schedule:
        """Return how a potential is minimised whose systems ``factor`` solves."""
        # who asks for a solver has everything solved by it
        return self._schedule if factor.is_free else self._all_together

    @cached_property
    def _schedule(self) -> Schedule:
        return Schedule(newton=Newton(iterations=self.iterations))

    @cached_property
    def _all_together(self) -> Schedule:
        return changed(self._schedule, small=SmallIslands(few=0))

    def each_block(self, begun: Begun, links: int) -> EachBlock | None:
        """Return the balance that is asked of each block, None where that of all is enough."""
        model, method = begun.model, begun.method
        if method.balance is None:
            return None
        mass = begun.frames.mass_matrix
        return EachBlock(
            share=method.balance,
            gyration=np.sqrt(mass[:, 2, 2] / mass[:, 0, 0]),
            noise=noise_of(model, method, begun.state),
            floor=round_off(model, method, begun.state, links),
        )

    def friction(self) -> FrictionLoop:
        """Return how friction bounds are brought into accord with the normal forces."""
        return FrictionLoop(updates=self.friction_updates)


@dataclass(frozen=True, kw_only=True)
class FrictionLoop:
    """How near a minimum is asked for whose normal forces are to bound friction."""

    updates: int = 1
    """Times that the friction bound is renewed."""
    coarse: float = 1e8
    """Energy left open to begin with, in units of the tolerance."""
    share: float = 1e-2
    """Energy left open in the end, in units of what new friction bounds bring in."""
    sharper: float = 0.1
    """Energy left open at the next try, in units of that at the last, at most."""


@dataclass(frozen=True, kw_only=True)
class Search:
    """The minimum with friction bounds, bonds and multipliers in accord with it."""

    law: ContactLaw
    taken: HalfWay | None = None
    """Where in the step the contacts' forces are taken; None: at its end."""
    rows: Rows
    """Where the contacts are in the table of springs."""
    schedule: Schedule
    friction: FrictionLoop
    tolerance: float
    """Distance from the minimum at which the step is solved, J/m."""
    work: Work
    each: EachBlock | None = None
    """The balance that is asked of each block, too."""

    def minimum(
        self, potential: Potential, contacts: Contacts, starts: tuple[Floats, ...]
    ) -> tuple[Floats, Contacts, ContactResponse]:
        """Return d (n, 6), the contacts and what the law answers at the minimum.

        It is searched for from the best of the ``starts``, (n, 6) each, with the friction bounds
        that the contacts have, and where many blocks have no links without these.
        """
        self.work.stages("law")
        contacts = multipliers.begin(self.law, contacts)
        potential = self.bound(potential, contacts)
        point = best_of(potential, starts)
        part = touched(potential, point, self.schedule.most)
        if part is None:
            point, contacts, response = self.settled(potential, contacts, point)
            return point.unknowns, contacts, response
        each = None if self.each is None else self.each.of(part.blocks)
        within = replace(self, rows=part.rows(self.rows), each=each)
        moved, contacts, response = within.settled(part.potential, contacts, part.point)
        unknowns = point.unknowns.copy()
        unknowns[part.blocks] = moved.unknowns[:-1]
        return unknowns, contacts, response

    def settled(
        self, potential: Potential, contacts: Contacts, point: Point
    ) -> tuple[Point, Contacts, ContactResponse]:
        """Return the minimum that is found from a point on, the contacts and the law's answer."""
        law, stages = self.law, self.work.stages
        # new multipliers shift the normal forces: their solve has its own friction to find
        updates = self.friction.updates + int(multipliers.has_multipliers(law))
        solves = 0
        while True:
            for _ in range(updates):
                potential, contacts, point = self.with_new_bounds(potential, contacts, point)
            point = self.solved(potential, point)
            stages("law")
            gap, slip = point.gap[self.rows], point.slip[self.rows]
            response = law.respond(contacts, gap, slip)
            solves += 1
            if not multipliers.enough(law, solves, contacts, gap):
                contacts = multipliers.renew(law, contacts, response)
            else:
                # only the last solve has the forces by which bonds are judged
                broken = contacts.bonded & ~response.bonded
                if not is_any(broken):
                    return point, multipliers.renew(law, contacts, response), response
                contacts, solves = without_bonds(contacts, response), solves - 1
            stages("law")
            contacts = changed(contacts, friction_base=response.normal_force)
            potential = self.bound(potential, contacts)
            point = potential.again(point)

    def solved(self, potential: Potential, point: Point) -> Point:
        """Return the minimum from a point on, near enough for the step and for each block."""
        tolerance: float | None = self.tolerance
        for _ in range(1 + (TRIES if self.each else 0)):
            if tolerance is None:
                break
            point = self.schedule.minimise(potential, point, tolerance, self.work)
            if self.each is not None:
                tolerance = self.each.sharper(potential, point, tolerance)
        return point

    def with_new_bounds(
        self, potential: Potential, contacts: Contacts, point: Point
    ) -> tuple[Potential, Contacts, Point]:
        """Return potential and contacts with friction bound by a minimum's forces, and that.

        Each island is as near to it as its own new bounds ask for; others may be far larger.  No
        more is asked for than the tolerance of the step.
        """
        enough = self.tolerance
        asked = self.friction.coarse * enough
        while True:
            point = self.schedule.minimise(potential, point, asked, self.work)
            self.work.stages("law")
            bounds = changed(contacts, friction_base=point.forces.normal_force[self.rows])
            renewed = self.bound(potential, bounds)
            moved = renewed.again(point)
            left = potential.island_distances(point)
            tolerated = self.friction.share * renewed.island_distances(moved)
            if asked <= enough or float(left[~(left <= tolerated)].sum()) <= enough:
                return renewed, bounds, moved
            asked = max(enough, min(self.friction.sharper * asked, float(tolerated.sum())))

    def bound(self, potential: Potential, contacts: Contacts) -> Potential:
        """Return the potential with the springs that the contacts are now."""
        if has_limits(self.law):
            springs = clipped(self.law, contacts)
            if self.taken is not None:
                springs = self.taken.springs(springs, contacts)
            return changed(potential, springs=potential.springs.put(self.rows, *springs))
        of_contacts = OfContacts(self.law, self.taken, contacts, self.rows, potential.springs)
        return changed(potential, law=of_contacts)

    def applied(
        self, contacts: Contacts, response: ContactResponse, unknowns: Floats
    ) -> tuple[Floats, Floats]:
        """Return the forces N and T (m,), N/m, of the equations solved by ``unknowns`` (n, 6).

        They are those of the ``response`` at the end but where they are taken half way.
        """
        at_end = response.normal_force, response.shear_force
        if self.taken is None:
            return at_end
        opening, slip = contact_motions(contacts, unknowns)
        on_the_way = self.taken.respond(self.law, contacts, contacts.gap + opening, slip)
        halved = self.taken.bearing(contacts)
        normal = np.where(halved, on_the_way.normal_force, at_end[0])
        return normal, np.where(halved, on_the_way.shear_force, at_end[1])


@dataclass(frozen=True)
class OfContacts:
    """What springs bear of which some are contacts whose law is no clipped straight line."""

    law: ContactLaw
    taken: HalfWay | None
    """Where in the step the contacts' forces are taken; None: at its end."""
    contacts: Contacts
    rows: Rows
    """Where the contacts are in the table of springs."""
    springs: Springs
    """That table; what it has for the contacts does not count."""

    def at(self, gap: Floats, slip: Floats) -> Bearing:
        """Return what all springs bear at gaps and slips (m,), m."""
        answer = self._answer(gap, slip)
        if len(self.contacts) == len(self.springs):
            return answer
        forces = self.springs.at(gap, slip)
        for name in ("normal_force", "shear_force", "normal_stiffness", "shear_stiffness"):
            getattr(forces, name)[self.rows] = getattr(answer, name)
        return forces

    def energy(self, gap: Floats, slip: Floats) -> float:
        """Return the energy of all springs at gaps and slips (m,), m, in J/m."""
        answer = self._answer(gap, slip)
        of_contacts = float(answer.energy.sum() + answer.dissipation.sum())
        return of_contacts + self.springs.energy(gap, slip)

    def _answer(self, gap: Floats, slip: Floats) -> ContactResponse:
        """Return what the contacts answer."""
        return answer(self.law, self.contacts, gap[self.rows], slip[self.rows], self.taken)


def clipped(law: SpringLaw, contacts: Contacts) -> tuple[Clipped, Clipped]:
    """Return the contacts' normal springs, N in [-tension, inf), and shear springs, T in +-b."""
    limits, count = law.limits(contacts), len(contacts.gap)
    endless = np.empty(count)
    endless.fill(np.inf)
    normal = Clipped(
        at_zero=contacts.rest_force + contacts.multiplier,
        stiffness=limits.normal_stiffness,
        low=-limits.tension,
        high=endless,
    )
    shear = Clipped(
        at_zero=contacts.shear_force,
        stiffness=limits.shear_stiffness,
        low=-limits.strength,
        high=limits.strength,
    )
    return normal, shear


def first_friction_base(
    begun: Begun, contacts: Contacts, entering: Entering, largest: float
) -> Floats:
    """Return the normal forces, N/m, that bound friction at first, shape (m,).

    Those of the last step.  A contact that bore nothing then holds whatever comes, ``largest``, if
    it lands without slipping, or was there at the start of the run, so that blocks just put upon
    each other are not minimised without any friction first.  It has none if it slips, or stays
    open, or only slides in beside another block's face.  Since when it has been known plays no
    part.
    """
    step = begun.step
    speed = float(np.hypot(*begun.model.gravity)) * step
    return np.asarray(
        first_bases(
            contacts.normal_force,
            contacts.gap,
            entering.before,
            AT_REST * speed,
            LANDING * speed,
            step,
            begun.state.time == 0.0,
            largest,
        )
    )
