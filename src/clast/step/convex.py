"""The convex process: a step is the minimum of the incremental potential energy.

    1/2 d.K d - F.d + sum phi_n(gap + n.d) + sum phi_t(t.d),    phi_n' = -N,  phi_t' = -T

with K and F of inertia, elasticity, weight and loads (block diagonal), and the friction bound of
each contact taken from a given normal force.  N falls with the gap and T with the slip, so the
potential is convex and once continuously differentiable: Newton's method with an exact line search
converges from anywhere.  Each iteration solves one assembled, symmetric positive definite system.
Where it takes long the interior point method takes over (minimise/interior_point.py).

Parts that are not convex are taken out of the minimisation and repeated around it: the friction
bound follows the normal force (``friction_updates``; in static steps to the end, by Newton's method
on the equations of both, minimise/coupled.py), and bonds that reach their strength are
broken before the minimum is sought again; bonds only break, so this ends.  Multipliers, where the
law has them, are renewed after convergence.

The residual of a minimisation is no more than a start for the next one, with bounds that push the
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
from clast.contact import laws as multipliers
from clast.contact.clipped_spring import Rows, Springs, merged, springs_of
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.joints.asperities import Asperities, as_pressed, over_asperities
from clast.contact.joints.bonds import without_bonds
from clast.contact.laws import ContactLaw, clipped, has_limits
from clast.errors import StepOutcome, StepRejected
from clast.linear.factor_cache import FactorOfStep
from clast.linear.guesses import Guesses
from clast.linear.system import (
    DiagonalTerms,
    Graph,
    LinearisedForces,
    contact_motions,
    graph_of,
    with_ground,
)
from clast.minimise.coupled import CoupledNewton
from clast.minimise.newton import SHARPENINGS_MAX, EachBlock, Newton, SolverContext, best_of
from clast.minimise.potential import Point, Potential
from clast.minimise.strategy import MinimisationStrategy, SmallIslands
from clast.minimise.subproblem import touched
from clast.model.model import Floats, Ints, Model
from clast.model.state import State
from clast.read_only import changed
from clast.step.energy_balance import noise_of, round_off
from clast.step.impact import ImpactResult, after_impacts, bearing, first_bases, scheme_of
from clast.step.integration import HalfWay, answer, half_way
from clast.step.method import Method, StepSolution
from clast.step.search_distance import ContactSearch, search_as_far_as, travel_expected
from clast.step.spring_offset import relieved
from clast.step.start import StepContext, diagonal_terms
from clast.step.take_step import take_step

STICKING_SPEED_GH = 1.0
"""Slip rate below which a new contact is taken to hold at first, in units of g h."""
LANDING_SPEED_GH = 1e-3
"""Closing velocity from which a new contact is one that lands, in units of g h."""
FRICTION_UPDATES_MAX = 32
"""Times at most that the friction bounds of a static step are renewed before it is cut."""
FRICTION_IMBALANCE = 1e-9
"""Share of the forces on each block which may be out of balance where bounds agree with them."""
FRICTION_IMBALANCE_OF_JUMPS = 0.002
"""The same where they may not come to agree, by cohesion that goes with the last normal force."""
UNCUT_FALL_DISPLACEMENTS = 0.2
"""Twice the fall of a free block in a step that is not cut for its friction, in units of
max_displacement."""

TOLERANCE_OF_DRIVEN = 1e-3
"""Tolerance where motions are prescribed, in units of the usual one: a force out of balance on a
body that is driven does work along its whole path."""

NO_COUNTS = {"passes": 0, "line_search": 0, "factorisations": 0, "pcg": 0}
"""Counts of a step, before it has counted anything."""


@dataclass(frozen=True)
class Convex:
    """Newton's method on the incremental potential, with exact line search."""

    tolerance: float = 1e-7
    """Tolerance, -: the potential ends within tolerance^2 x energy of the forces of a step."""
    iterations: int = 200
    """Newton iterations at most; a step that needs more is cut."""
    friction_updates: int = 1
    """Times that the friction bound is renewed from the normal forces just found."""
    restitution: float = 0.0
    """Share of the closing velocity with which impacts rebound, 0 to 1."""

    any_step: ClassVar[bool] = True
    couples_water: ClassVar[bool] = True
    """Whether water in joints and blocks may be in one potential."""
    remedies: ClassVar[Mapping[StepOutcome, str]] = {
        StepOutcome.NOT_CONVERGED: (
            "Raise method.process.iterations, or lower method.contact_law.normal_stiffness or "
            "time.step"
        )
    }

    step = take_step

    def search(self, context: StepContext) -> ContactSearch:
        """Return the search for contacts: as far as velocities and weight take the blocks."""
        return search_as_far_as(context, travel_expected(context))

    def solve(
        self, context: StepContext, contacts: Contacts, before: StepSolution | None = None
    ) -> StepSolution:
        """Return the minimum of the potential with these contacts, after their impacts."""
        model, method, stages = context.model, context.method, context.stages
        joints, law = model.joint_table, method.contact_law
        is_dynamic = method.dynamic_ratio > 0.0
        opens = joints.opens and is_dynamic and has_limits(law)
        if opens:
            contacts = as_pressed(joints, contacts)
        if is_dynamic:  # static steps have no energy to keep: what is found inside is pressed out
            contacts = relieved(model, method, context.state, contacts)
        graph = graph_of(contacts, model.block_count)
        stages("impacts")
        impacts = after_impacts(context, contacts, graph, self.restitution)
        asperities, slope = None, None
        if opens and has_limits(law):
            motions = contact_motions(contacts, impacts.drift)
            contacts, asperities = over_asperities(joints, law, contacts, motions)
            slope = asperities.slope
        share = context.at.forces_at
        taken = half_way(model, law, contacts, share, context.step)
        scheme = scheme_of(context, contacts, graph, impacts, taken, slope)
        stages("base system")
        base = diagonal_terms(context, impacts.drift, scheme)
        potential, rows, asperities = potential_of(context, base, contacts, graph, asperities)
        factor = FactorOfStep(context.workspace.inexact(method.solver), context.workspace.patterns)
        counts = {**NO_COUNTS, **(before.counts if before else {})}
        search = Search(
            law=law,
            asperities=asperities,
            taken=taken,
            rows=rows,
            schedule=self.schedule(factor),
            friction=self.friction(context, contacts),
            tolerance=self.tolerated(context, potential),
            each=self.each_block(context, len(potential.springs)),
            work=SolverContext(factor=factor, counts=counts, stages=stages),
        )
        largest = potential.sum_of_forces()
        base_of_friction = first_friction_base(context, contacts, impacts, largest)
        # where the step is solved again for its water, friction goes on from what was found
        if before is not None and potential.joined and len(before.contacts) == len(contacts):
            base_of_friction = before.contacts.friction_base
        contacts = changed(contacts, friction_base=base_of_friction)
        starts = *self.warm_starts(context, impacts, before), potential.untouched()
        bonded = contacts.bonded
        unknowns, contacts, response = search.minimum(potential, contacts, starts)
        unknowns = context.total(unknowns)
        counts["factorisations"] += factor.factorised
        counts["pcg"] += factor.iterations
        return StepSolution(
            velocity=impacts.velocity,
            drift=impacts.drift,
            scheme=scheme,
            unknowns=unknowns,
            contacts=contacts,
            response=response,
            applied=search.applied(contacts, response, unknowns),
            bearing=bearing(contacts, impacts, response.normal_force),
            lost=impacts.lost,
            driven=impacts.driven,
            bonded=bonded,
            asperities=asperities,
            counts=counts,
        )

    def warm_starts(
        self, context: StepContext, impacts: ImpactResult, before: StepSolution | None
    ) -> tuple[Floats, Floats]:
        """Return displacements to start from, (n, 6) each: blocks move on, or rest.

        The latter where contacts were looked for again: the solution with fewer of them.
        """
        at = before.unknowns if before else np.zeros(context.velocity.shape)
        if context.held is None:
            return impacts.drift, at
        return context.held.beside(impacts.drift), context.held.beside(at)

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn of carried multipliers; the process itself holds for any stiffness and step."""
        return multipliers.advice(method.contact_law, model, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return E of the stiffest rock: stiff enough not to be seen, soft enough to be quick."""
        return model.stiffest, "E of the stiffest rock; the process holds for any"

    def tolerated(self, context: StepContext, potential: Potential) -> float:
        """Return the distance from the minimum, J/m, at which the step is solved."""
        links = len(potential.springs)
        tolerance = self.tolerance * (TOLERANCE_OF_DRIVEN if context.model.is_driven else 1.0)
        return max(
            tolerance**2 * potential.reference_energy(),
            round_off(context.model, context.method, context.state, links),
        )

    def schedule(self, factor: FactorOfStep) -> MinimisationStrategy:
        """Return how a potential is minimised whose systems ``factor`` solves."""
        # who asks for a solver has everything solved by it
        return self._schedule if factor.chooses_solver else self._all_together

    @cached_property
    def _schedule(self) -> MinimisationStrategy:
        return MinimisationStrategy(newton=Newton(iterations=self.iterations))

    @cached_property
    def _all_together(self) -> MinimisationStrategy:
        return changed(self._schedule, small=SmallIslands(few=0))

    def each_block(self, context: StepContext, links: int) -> EachBlock | None:
        """Return the required balance of each block, None where that of all is enough."""
        model, method = context.model, context.method
        if method.balance is None:
            return None
        mass = context.frames.mass_matrix
        return EachBlock(
            share=method.balance,
            gyration=np.append(np.sqrt(mass[:, 2, 2] / mass[:, 0, 0]), 1.0),
            noise=noise_of(model, method, context.state),
            floor=round_off(model, method, context.state, links),
        )

    def friction(self, context: StepContext, contacts: Contacts) -> FrictionLoop:
        """Return how friction bounds are brought into accord with the normal forces.

        A static step may be as long as it likes, and a joint that slips in it has slipped for good:
        by bounds that are not those of its forces blocks slide as far as the step lets them.  Where
        no accord is found it is cut, until blocks go no further than a step may; not where there
        may be none, for cohesion without tensile strength goes with the last normal force.
        """
        model, method = context.model, context.method
        once = FrictionLoop(updates=self.friction_updates)
        if method.dynamic_ratio > 0.0 or method.balance is None or self.friction_updates == 0:
            return once
        falls = model.usual_gravity * context.step**2
        jumps = is_any((contacts.cohesion > 0.0) & (contacts.tensile_strength == 0.0))
        refuses = falls > UNCUT_FALL_DISPLACEMENTS * method.max_displacement and not jumps
        return changed(
            once,
            updates=max(FRICTION_UPDATES_MAX, self.friction_updates),
            agrees=FRICTION_IMBALANCE,
            nearly=FRICTION_IMBALANCE_OF_JUMPS if jumps else 0.0,
            refuses=StepOutcome.NOT_CONVERGED if refuses else None,
        )


@dataclass(frozen=True, kw_only=True)
class FrictionLoop:
    """How near a minimum is asked for whose normal forces are to bound friction."""

    updates: int = 1
    """Times that the friction bound is renewed."""
    coarse: float = 1e8
    """Energy left open to begin with, in units of the tolerance."""
    share: float = 1e-2
    """Energy left open in the end, in units of the energy that new friction bounds bring in."""
    sharper: float = 0.1
    """Energy left open at the next try, in units of that at the last, at most."""
    agrees: float = 0.0
    """Share of the forces on each block that may be out of balance where bounds agree with them; 0:
    they are renewed all ``updates`` times."""
    nearly: float = 0.0
    """The same share with which bounds are kept that do not come to agree, 0 for none."""
    refuses: StepOutcome | None = None
    """How a step is rejected whose bounds do not come to agree; None: it is kept all the same."""


@dataclass(frozen=True, kw_only=True)
class Search:
    """The minimum with friction bounds, bonds and multipliers in accord with it."""

    law: ContactLaw
    asperities: Asperities | None = None
    """The same law where contacts slip over asperities."""
    taken: HalfWay | None = None
    """Where in the step the contacts' forces are taken; None: at its end."""
    rows: Rows
    """Where the contacts are in the table of springs."""
    schedule: MinimisationStrategy
    friction: FrictionLoop
    tolerance: float
    """Distance from the minimum at which the step is solved, J/m."""
    work: SolverContext
    each: EachBlock | None = None
    """Required balance of each block."""

    def minimum(
        self, potential: Potential, contacts: Contacts, starts: tuple[Floats, ...]
    ) -> tuple[Floats, Contacts, ContactResponse]:
        """Return d (n, 6), the contacts and the answer of the law at the minimum.

        It is searched for from the best of the ``starts``, (n, 6) each, with the friction bounds
        that the contacts have, and where many blocks have no links without these.
        """
        law, stages, count = self.law, self.work.stages, len(starts[0])
        stages("law")
        contacts = multipliers.begin(law, contacts)
        if count == potential.springs.ground:
            starts = tuple(with_ground(one[:count]) for one in starts)
        potential = self.bound(potential, contacts)
        start = best_of(potential, starts)
        within, potential, point, blocks = self.of_touched(potential, start)
        # new multipliers shift the normal forces: their solve has its own friction to find
        updates = self.friction.updates + int(multipliers.has_multipliers(law))
        solves = 0
        while True:
            potential, contacts, point = within.with_bounds_renewed(
                potential, contacts, point, updates
            )
            point = within.solved(potential, point)
            stages("law")
            gap, slip = point.gap[within.rows], point.slip[within.rows]
            response = (within.asperities or law).respond(contacts, gap, slip)
            solves += 1
            if not multipliers.enough(law, solves, contacts, gap):
                contacts = multipliers.renew(law, contacts, response)
            else:
                # only the last solve has the forces by which bonds and chords are judged
                after = within.without_spent(contacts, response)
                if after is contacts:
                    break
                contacts, solves = after, solves - 1
            stages("law")
            contacts = changed(contacts, friction_base=response.normal_force)
            potential = within.bound(potential, contacts)
            # the links of asperities go with the stiffness of their contacts
            point = potential.at(point.unknowns)
        unknowns = point.unknowns
        if blocks is not None:
            unknowns = start.unknowns.copy()
            unknowns[blocks] = point.unknowns[:-1]
        if multipliers.has_multipliers(law):
            response = multipliers.with_energies(law, contacts, response)
        return unknowns[:count], multipliers.renew(law, contacts, response), response

    def of_touched(
        self, potential: Potential, point: Point
    ) -> tuple[Search, Potential, Point, Ints | None]:
        """Return search, potential and point of the blocks that have links, and which these are.

        None of these, and all as it is, where they are most blocks.
        """
        part = touched(potential, point, self.schedule.most)
        if part is None:
            return self, potential, point, None
        each = None if self.each is None else self.each.of(part.blocks)
        asperities = self.asperities
        if asperities is not None:
            places = [part.rows(one) for one in (asperities.flanks, asperities.sliders)]
            asperities = changed(asperities, flanks=places[0], sliders=places[1])
        within = replace(self, rows=part.rows(self.rows), each=each, asperities=asperities)
        return within, part.potential, part.point, part.blocks

    def without_spent(self, contacts: Contacts, response: ContactResponse) -> Contacts:
        """Return the contacts without bonds that break and chords of strength that are unloaded."""
        if is_any(contacts.bonded & ~response.bonded):
            return without_bonds(contacts, response)
        if self.asperities is not None:
            back = self.asperities.given_back(contacts, response)
            if is_any(back):
                return self.asperities.without_chords(contacts, back)
        return contacts

    def solved(self, potential: Potential, point: Point) -> Point:
        """Return the minimum from a point on, near enough for the step and for each block."""
        tolerance: float | None = self.tolerance
        for _ in range(1 + (SHARPENINGS_MAX if self.each else 0)):
            if tolerance is None:
                break
            point = self.schedule.minimise(potential, point, tolerance, self.work)
            if self.each is not None:
                tolerance = self.each.sharper(potential, point, tolerance)
        return point

    def with_bounds_renewed(
        self, potential: Potential, contacts: Contacts, point: Point, updates: int
    ) -> tuple[Potential, Contacts, Point]:
        """Return potential and contacts with friction bounds renewed, and the minimum before.

        They are renewed ``updates`` times, or until the equations are solved in which they follow
        the forces.  Raises StepRejected where that is required and not reached.
        """
        guesses, begins = Guesses(), True
        for renewed in range(1, updates + 1):
            given = contacts.friction_base
            potential, contacts, point = self.with_new_bounds(potential, contacts, point)
            if self.friction.agrees == 0.0:
                continue
            # where it is not found from near by, it is not from a little further on, either
            tried = renewed.bit_count() == 1 and (renewed <= 2 or self.friction.nearly == 0.0)
            solution = self.followed(potential, contacts, point) if tried else None
            if solution is not None:
                contacts = changed(contacts, friction_base=solution.forces.normal_force[self.rows])
                potential = self.bound(potential, contacts)
                return potential, contacts, potential.again(solution)
            if self.friction.nearly > 0.0 and self.each is not None:
                if self.each.shares(potential, point).max(initial=0.0) <= self.friction.nearly:
                    break
            if renewed == updates:
                if self.friction.refuses is not None:
                    raise StepRejected(self.friction.refuses, "friction and normal forces")
                break
            if not begins:  # the first bounds hold whatever comes
                guesses = guesses.with_one(given, contacts.friction_base)
                guess = np.maximum(0.0, guesses.next_guess())
                contacts = changed(contacts, friction_base=guess)
                potential = self.bound(potential, contacts)
                point = potential.again(point)
            begins = False
        return potential, contacts, point

    def followed(self, potential: Potential, contacts: Contacts, point: Point) -> Point | None:
        """Return the solution near a point whose friction follows the normal forces, if found."""
        if self.each is None:
            return None
        free = changed(contacts, friction_base=np.full(len(contacts), np.nan))
        law = OfContacts(self.law, self.taken, free, self.rows, potential.springs)
        newton = CoupledNewton(agrees=self.friction.agrees)
        return newton.solve(changed(potential, law=law), point, self.each, self.work)

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
            forces, over = point.forces, self.asperities
            normal = forces.normal_force[self.rows]
            if over is not None:
                both = forces.normal_force, forces.shear_force
                normal = over.normal_forces(self.rows, both, contacts)
            bounds = changed(contacts, friction_base=normal)
            renewed = self.bound(potential, bounds)
            # the links of asperities turn with their bounds
            moved = renewed.at(point.unknowns) if self.asperities else renewed.again(point)
            left = potential.island_distances(point)
            tolerated = self.friction.share * renewed.island_distances(moved)
            if asked <= enough or np.add.reduce(left[~(left <= tolerated)]) <= enough:
                return renewed, bounds, moved
            asked = max(enough, min(self.friction.sharper * asked, float(tolerated.sum())))

    def bound(self, potential: Potential, contacts: Contacts) -> Potential:
        """Return the potential with the springs that the contacts are now."""
        if has_limits(self.law):
            springs = clipped(self.law, contacts)
            if self.taken is not None:
                springs = self.taken.springs(springs, contacts)
            if self.asperities is not None:
                table = self.asperities.put(potential.springs, self.rows, springs, contacts)
                return changed(potential, springs=table)
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
        law: ContactLaw = self.asperities or self.law
        on_the_way = self.taken.respond(law, contacts, contacts.gap + opening, slip)
        halved = self.taken.bearing(contacts)
        normal = np.where(halved, on_the_way.normal_force, at_end[0])
        return normal, np.where(halved, on_the_way.shear_force, at_end[1])


@dataclass(frozen=True)
class OfContacts:
    """Forces of springs of which some are contacts whose law is no clipped straight line."""

    law: ContactLaw
    taken: HalfWay | None
    """Where in the step the contacts' forces are taken; None: at its end."""
    contacts: Contacts
    rows: Rows
    """Where the contacts are in the table of springs."""
    springs: Springs
    """That table; its rows for the contacts do not count."""

    def at(self, gap: Floats, slip: Floats) -> LinearisedForces:
        """Return the forces of all springs at gaps and slips (m,), m."""
        answer = self._answer(gap, slip)
        if len(self.contacts) == len(self.springs):
            return answer
        forces = self.springs.at(gap, slip)
        for name in ("normal_force", "shear_force", "normal_stiffness", "shear_stiffness"):
            getattr(forces, name)[self.rows] = getattr(answer, name)
        coupling = np.zeros(len(gap))
        coupling[self.rows] = answer.coupling
        return changed(forces, coupling=coupling)

    def energy(self, gap: Floats, slip: Floats) -> float:
        """Return the energy of all springs at gaps and slips (m,), m, in J/m."""
        answer = self._answer(gap, slip)
        of_contacts = float(answer.energy.sum() + answer.dissipation.sum())
        return of_contacts + self.springs.energy(gap, slip)

    def _answer(self, gap: Floats, slip: Floats) -> ContactResponse:
        """Return the answer of the contacts."""
        return answer(self.law, self.contacts, gap[self.rows], slip[self.rows], self.taken)


def potential_of(
    context: StepContext,
    base: DiagonalTerms,
    contacts: Contacts,
    graph: Graph,
    asperities: Asperities | None,
) -> tuple[Potential, Rows, Asperities | None]:
    """Return the potential of a step, and where contacts and asperities are in its table.

    ``graph`` is that of the contacts alone.
    """
    model = context.model
    others = () if context.springs is None else (context.springs,)
    if asperities is not None:
        others = *others, asperities.links(contacts), asperities.links(contacts)
    springs, (rows, *more) = merged(springs_of(contacts), others)
    if asperities is not None:
        asperities = changed(asperities, flanks=more[-2], sliders=more[-1])
    if context.held is not None:
        springs = context.held.springs(springs)
    potential = Potential.of(base, model.fixed, springs, None if others else graph)
    for one in context.contributions:
        if one.opening is not None:
            from clast.minimise.joint_water import with_water  # few cases need it

            held, water = context.held, one.opening
            water = water if held is None else water.beside(held.displacement)
            potential = with_water(potential, water)
    return potential, rows, asperities


def first_friction_base(
    context: StepContext, contacts: Contacts, impacts: ImpactResult, largest: float
) -> Floats:
    """Return the normal forces, N/m, that bound friction at first, shape (m,).

    Those of the last step.  A contact that carried nothing then holds whatever comes, ``largest``,
    if it lands without slipping, or was there at the start of the run, so that blocks just put upon
    each other are not minimised without any friction first.  It has none if it slips, or stays
    open, or only slides in beside another block's face.  Since when it has been known plays no
    part.
    """
    step = context.step
    speed = context.model.size_of_gravity * step
    base: Floats = first_bases(
        contacts.normal_force,
        contacts.gap,
        impacts.before,
        STICKING_SPEED_GH * speed,
        LANDING_SPEED_GH * speed,
        step,
        context.state.time == 0.0,
        largest,
    )
    return base
