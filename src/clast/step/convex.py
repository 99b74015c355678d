"""The convex process: a step is the minimum of the incremental potential energy.

    1/2 d.K d - F.d + sum phi_n(gap + n.d) + sum phi_t(t.d),    phi_n' = -N,  phi_t' = -T

with K and F of inertia, elasticity, weight and loads (block diagonal), and the friction bound of
each contact taken from a given normal force.  N falls with the gap and T with the slip, so the
potential is convex and once continuously differentiable: Newton's method with an exact line search
converges from anywhere.  Each iteration solves one assembled, symmetric positive definite system.
Where it takes long the interior point method takes over (minimise/interior_point.py).

What is not convex is taken out of the minimisation and repeated around it: the friction bound
follows the normal force (``friction_updates``) of a minimum that need only be as near as that asks
for (minimise/rough.py), and bonds that reach their strength are broken before the minimum is sought
again; bonds only break, so this ends.  Multipliers, where the law has
them, are renewed after convergence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from clast.compute.stopwatch import Stages
from clast.contact import multipliers
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import StepOutcome
from clast.linear.reuse import FactorOfStep
from clast.linear.solvers import DIRECTION, inexact
from clast.linear.system import contact_motions, graph_of, inverse_of_blocks
from clast.minimise.newton import best_of, minimise
from clast.minimise.potential import Point, Potential, regions_of
from clast.minimise.rough import bound_by, with_new_bounds
from clast.minimise.touched import as_numbered, touched_part, with_flight
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.step.energy_balance import round_off
from clast.step.finish import finish
from clast.step.impact import after_impacts, bearing, first_bases, scheme_of
from clast.step.method import Method, Solved, StepResult, Workspace
from clast.step.reach import (
    JUMP,
    closes_unseen,
    farther,
    reach_within_step,
    travel_expected,
    travel_of,
)
from clast.step.relief import relieved
from clast.step.start import Begun, begin, diagonal_terms

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
        stages = Stages()
        with stages("base system"):
            begun = begin(model, method, state, step, workspace)
        with stages("contacts"):
            travel = travel_expected(begun)
            contacts = begun.contacts(reach_within_step(method, travel), begun.drift)
        starts: tuple[Floats, ...] = (np.zeros_like(begun.velocity),)
        counts = {"passes": 0, "line_search": 0, "factorisations": 0, "pcg": 0}
        while True:
            solved = self._solved(begun, contacts, starts, counts, stages)
            with stages("contacts"):
                wider = farther(method, travel, travel_of(begun, solved.unknowns))
                if wider is None:
                    break
                seen, travel = contacts, wider
                contacts = begun.contacts(reach_within_step(method, travel), begun.drift)
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
        with stages("contacts"):
            contacts = relieved(model, method, begun.state, contacts)
            graph = graph_of(contacts, model.block_count)
            entering = after_impacts(begun, contacts, graph, self.restitution)
            scheme = scheme_of(begun, contacts, graph, entering)
        with stages("base system"):
            base = diagonal_terms(begun, entering.drift, scheme)
            whole = Potential(
                base=base,
                inverse=inverse_of_blocks(base.diagonal),
                law=method.contact_law,
                contacts=contacts,
                fixed=model.fixed,
                graph=graph,
                regions=regions_of(contacts, model.fixed),
            )
        # warm starts: it goes on as it moves, or rests as it rested, or nothing touches it
        starts = (entering.drift, *starts, whole.untouched())
        base_force = first_friction_base(begun, whole)
        enough = max(
            self.tolerance**2 * whole.yardstick(), round_off(method, begun.state, len(contacts))
        )
        unknowns, contacts, response = self._found(
            whole, starts, base_force, enough, method, counts, stages
        )
        return Solved(
            velocity=entering.velocity,
            drift=entering.drift,
            scheme=scheme,
            unknowns=unknowns,
            contacts=contacts,
            response=response,
            applied=(response.normal_force, response.shear_force),
            bearing=bearing(contacts, entering, response.normal_force),
            depth=JUMP * method.critdis,
            lost=entering.lost,
            counts=counts,
        )

    def _found(
        self,
        whole: Potential,
        starts: tuple[Floats, ...],
        base: Floats,
        enough: float,
        method: Method,
        counts: dict[str, int],
        stages: Stages,
    ) -> tuple[Floats, Contacts, ContactResponse]:
        """Return d (n, 6), the contacts and what the law answers, within ``enough`` of the minimum.

        The last of the ``starts`` is that of blocks that nothing touches; where these are many
        only the others are minimised.  ``base`` (m,) bounds friction to begin with, N/m.
        """
        with stages("law"):
            part = touched_part(whole)
        if part is None:
            potential, point = self._minimum(whole, starts, base, enough, method, counts, stages)
            return point.unknowns, potential.contacts, point.response
        inside = tuple(start.take(part.blocks, axis=0) for start in starts)
        potential, point = self._minimum(
            part.potential, inside, base, enough, method, counts, stages
        )
        unknowns = with_flight(part, starts[-1], point.unknowns)
        return unknowns, as_numbered(potential.contacts, whole.contacts), point.response

    def _minimum(
        self,
        potential: Potential,
        starts: tuple[Floats, ...],
        base: Floats,
        enough: float,
        method: Method,
        counts: dict[str, int],
        stages: Stages,
    ) -> tuple[Potential, Point]:
        """Return the minimum with friction bounds, bonds and multipliers in accord with it.

        ``base`` (m,) are the normal forces that bound friction to begin with, N/m; the minimum is
        found to within ``enough``, J/m.
        """
        law = method.contact_law
        factor = FactorOfStep(inexact(method.solver, DIRECTION))

        def minimum(potential: Potential, point: Point, enough: float) -> Point:
            return minimise(potential, point, factor, enough, self.iterations, counts, stages)

        with stages("law"):
            contacts = multipliers.begin(law, potential.contacts)
            potential = bound_by(replace(potential, contacts=contacts), base)
            point = best_of(potential, starts)
        # new multipliers shift the normal forces: their solve has its own friction to find
        updates = self.friction_updates + int(multipliers.has_multipliers(law))
        solves = 0
        while True:
            for _ in range(updates):
                potential, point = with_new_bounds(minimum, potential, point, enough, stages)
            point = minimum(potential, point, enough)
            with stages("law"):
                point = potential.answered(point)
            solves += 1
            contacts, response = potential.contacts, point.response
            if not multipliers.enough(law, solves, point.gap):
                contacts = multipliers.renew(law, contacts, response)
            else:
                # only the last solve has the forces by which bonds are judged
                broken = contacts.bonded & ~response.bonded
                if not broken.any():
                    break
                contacts, solves = without_bonds(contacts, broken), solves - 1
            potential = bound_by(replace(potential, contacts=contacts), response.normal_force)
            with stages("law"):
                point = potential.again(point)
        counts["factorisations"] += factor.factorised
        counts["pcg"] += factor.iterations
        contacts = multipliers.renew(law, potential.contacts, point.response)
        return replace(potential, contacts=contacts), point


def first_friction_base(begun: Begun, potential: Potential) -> Floats:
    """Return the normal forces, N/m, that bound friction at first, shape (m,).

    Those of the last step.  A contact that bore nothing then holds whatever comes if it lands
    without slipping, or was there at the start of the run, so that blocks just put upon each other
    are not minimised without any friction first.  It has none if it slips, or stays open, or only
    slides in beside another block's face.  Since when it has been known plays no part.
    """
    contacts, step = potential.contacts, begun.step
    speed = float(np.hypot(*begun.model.gravity)) * step
    return np.asarray(
        first_bases(
            contacts.normal_force,
            contacts.gap,
            contact_motions(contacts, begun.velocity),
            AT_REST * speed,
            LANDING * speed,
            step,
            begun.state.time == 0.0,
            potential.largest_force(),
        )
    )


def without_bonds(contacts: Contacts, broken: np.ndarray) -> Contacts:
    """Return the contacts with the bonds of those ``broken`` (m,) gone."""
    return replace(
        contacts,
        bonded=contacts.bonded & ~broken,
        cohesion=np.where(broken, 0.0, contacts.cohesion),
        tensile_strength=np.where(broken, 0.0, contacts.tensile_strength),
    )
