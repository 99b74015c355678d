"""Shi's original process: open-close iteration (Shi 1988).

Every contact within reach is open, sliding or locked.  A locked contact has a normal and a shear
spring, a sliding one a normal spring and a friction force, an open one nothing.  The equations are
solved again, at most six times, until no contact changes its mode:

    open  -> lock   a vertex has passed its entrance edge
    lock, slide -> open   the normal force is tensile beyond the tensile strength
    lock  -> slide  the shear force exceeds N tan(phi) + c L
    slide -> lock   the slip runs against the direction of the friction force

A step whose modes do not settle is cut to a third.  The rules are those of a return mapping from
the remembered shear force, so the contact law itself, evaluated at the end of the last solve,
gives the modes of the next.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from clast.compute.stopwatch import Stages
from clast.contact import multipliers
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import StepOutcome, StepRejected
from clast.linear.system import DiagonalTerms, slip_in_step
from clast.model.model import Model
from clast.model.state import State
from clast.step.finish import finish
from clast.step.impact import advice_without
from clast.step.integration import answer, half_way
from clast.step.links import are_settled, coupled_system
from clast.step.method import Method, Solved, StepResult, Workspace
from clast.step.modified import (
    STABILITY_LIMIT,
    PassResult,
    bearable_stiffness,
    counts_of,
    factor_of,
    pass_result,
    stability_number,
)
from clast.step.start import Begun, begin, diagonal_terms
from clast.step.travel import JUMP, search_within_step

CUT = 1.0 / 3.0
"""Shi's cut of a step whose modes do not settle."""

NEGLIGIBLE = 1e-9
"""Normal forces below this share of the largest one do not keep the iteration going."""
SHI_FACTOR = 40.0
"""Automatic normal stiffness in units of Young's modulus times 1 m; Shi advises 10 to 100."""


THROWN = "The contacts throw blocks apart: lower method.contact_law.normal_stiffness or time.step"
"""What helps where stiff contacts give back too much."""


@dataclass(frozen=True)
class OpenClose:
    """Open-close iteration with lock, slide and open."""

    iterations: int = 6
    """Solves per step at most; a step that needs more is cut to a third."""

    remedies: ClassVar[Mapping[StepOutcome, str]] = {
        StepOutcome.TRAVELLED_TOO_FAR: THROWN,
        StepOutcome.ROTATED_TOO_FAR: THROWN,
        StepOutcome.ENERGY_CREATED: f'{THROWN}, or set method.integrator = "backward-euler"',
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
        base = diagonal_terms(begun, begun.drift, begun.scheme)
        stages("contacts")
        farthest = np.full(model.block_count, method.max_displacement)
        contacts = begun.contacts(search_within_step(method, farthest), begun.drift)
        found = self._iterate(begun, base, contacts, stages)
        solved = Solved(
            velocity=begun.velocity,
            drift=begun.drift,
            scheme=begun.scheme,
            unknowns=found.unknowns,
            contacts=found.contacts,
            response=found.response,
            applied=found.applied,
            bearing=found.response.normal_force,
            depth=JUMP * method.critdis,
            counts=found.counts,
            linearised_at=found.linearised_at,
        )
        return finish(begun, solved, stages)

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn where p h2/m is beyond what impacts bear, or carried multipliers swing up.

        Blocks at rest bear more: steps whose modes do not settle are cut.
        """
        usual = *multipliers.advice(method.contact_law, model, step), *advice_without(model)
        number = stability_number(model, method, state, step)
        if method.integrator.theta > 0.5 or number <= STABILITY_LIMIT:
            return usual
        soft = method.contact_law.normal_stiffness * STABILITY_LIMIT / number
        return (
            f"p h2/m = {number:.3g} is above {STABILITY_LIMIT:g} (m: mass per contact): constant "
            "acceleration throws back what hits such stiff contacts, with more energy than it had. "
            f"Use normal_stiffness <= {soft:.2g}, time.step <= "
            f'{step * np.sqrt(STABILITY_LIMIT / number):.2g} or integrator = "backward-euler".',
            *usual,
        )

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return 40 E of the stiffest rock, or less where the step would throw blocks apart.

        Shi's 10 to 100 E L are for a length L of 1 m.
        """
        stiff = SHI_FACTOR * model.stiffest
        stable, reason = bearable_stiffness(model, step)
        if stable < stiff:
            return stable, reason
        return stiff, f"{SHI_FACTOR:g} E of the stiffest rock (Shi: 10-100)"

    def _iterate(
        self, begun: Begun, base: DiagonalTerms, contacts: Contacts, stages: Stages
    ) -> PassResult:
        """Return the solve whose modes agree with those that it was assembled with."""
        law, factor = begun.method.contact_law, factor_of(begun)
        taken = half_way(begun.model, law, contacts, begun.at.forces_at, begun.step)
        contacts = multipliers.begin(law, contacts)
        seen = contacts.gap, slip_in_step(contacts, begun.drift)
        springs, at = begun.springs, begun.drift
        # sliding friction is that of the solve before: new multipliers need one to find it
        least = 2 if multipliers.has_multipliers(law) else 1
        solves, tried, passes = 0, 0, 0
        while tried < self.iterations:
            tried, passes = tried + 1, passes + 1
            stages("law")
            entered = as_springs_and_forces(answer(law, contacts, *seen, taken))
            stages("assembly")
            system, bearing = coupled_system(
                base, contacts, entered, seen, springs, at, begun.model.fixed
            )
            stages("solve")
            unknowns = factor.solve(system, bearing)
            found = pass_result(law, contacts, entered, seen, unknowns, taken)
            settled = have_settled(entered, found.acting)
            if tried >= least and settled and are_settled(springs, at, unknowns):
                # each set of multipliers has its own open-close iteration
                solves, tried = solves + 1, 0
                if multipliers.enough(law, solves, contacts, found.gap):
                    counts = counts_of(passes, factor)
                    return replace(found, linearised_at=at, counts=counts)
                contacts = found.contacts
            seen, at = (found.gap, found.slip), unknowns
        raise StepRejected(
            StepOutcome.NOT_CONVERGED,
            f"contacts still change their mode after {self.iterations} solves",
            cut=CUT,
        )


def have_settled(before: ContactResponse, after: ContactResponse) -> bool:
    """Return True where no contact that carries force has changed its mode.

    Faces that just touch have gaps of rounding size: their modes flip for ever, at forces that
    mean nothing.
    """
    force = np.maximum(np.abs(before.normal_force), np.abs(after.normal_force))
    counts = force > NEGLIGIBLE * force.max(initial=0.0)
    return bool(np.all((before.mode == after.mode) | ~counts))


def as_springs_and_forces(response: ContactResponse) -> ContactResponse:
    """Return the response with sliding friction as a known force, as Shi's equations hold it."""
    return replace(response, coupling=np.zeros(len(response.coupling)))
