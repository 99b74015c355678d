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
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from clast.contact import laws as multipliers
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import StepOutcome, StepRejected
from clast.linear.system import slip_in_step
from clast.model.model import Model
from clast.model.state import State
from clast.step.action_springs import LinearContacts, solved
from clast.step.impact import advice_without
from clast.step.integration import answer, half_way
from clast.step.method import Method, StepSolution
from clast.step.modified import (
    STABILITY_LIMIT,
    bearable_stiffness,
    factor_of,
    pass_result,
    softer_springs,
    solution_of,
    stability_number,
)
from clast.step.search_distance import ContactSearch, search_as_far_as
from clast.step.start import StepContext, diagonal_terms
from clast.step.take_step import take_step

STEP_CUT = 1.0 / 3.0
"""Shi's cut of a step whose modes do not settle."""

SHI_FACTOR = 40.0
"""Automatic normal stiffness in units of Young's modulus times 1 m; Shi advises 10 to 100."""


THROWN = "The contacts throw blocks apart: lower method.contact_law.normal_stiffness or time.step"
"""Remedy where stiff contacts return too much energy."""


def _have_settled(before: ContactResponse, after: ContactResponse) -> bool:
    """Return True where no contact that carries force has changed its mode.

    Faces that just touch have gaps of rounding size: their modes flip for ever, at forces that
    mean nothing.
    """
    force = np.maximum(np.abs(before.normal_force), np.abs(after.normal_force))
    # Normal forces below this share of the largest one do not keep the iteration going
    counts = force > 1e-9 * force.max(initial=0.0)
    return bool(np.all((before.mode == after.mode) | ~counts))


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

    step = take_step

    def search(self, context: StepContext) -> ContactSearch:
        """Return the search for contacts: as far as max_displacement lets blocks move."""
        farthest = np.full(context.model.block_count, context.method.max_displacement)
        return search_as_far_as(context, farthest)

    def solve(
        self, context: StepContext, contacts: Contacts, before: StepSolution | None = None
    ) -> StepSolution:
        """Return the solve whose modes agree with those that it was assembled with."""
        law, factor, stages = context.method.contact_law, factor_of(context), context.stages
        stages("base system")
        base = diagonal_terms(context, context.drift, context.scheme)
        taken = half_way(context.model, law, contacts, context.at.forces_at, context.step)
        contacts = multipliers.begin(law, contacts)
        seen = contacts.gap, slip_in_step(contacts, context.drift)
        at = context.drift
        # sliding friction is that of the solve before: new multipliers need one to find it
        least = 2 if multipliers.has_multipliers(law) else 1
        solves, tried, passes = 0, 0, 0
        while tried < self.iterations:
            tried, passes = tried + 1, passes + 1
            stages("law")
            entered = answer(law, contacts, *seen, taken)
            stages("assembly")
            held = LinearContacts(contacts=contacts, response=entered, seen=seen)
            unknowns, at = solved(context, base, factor, held, at)
            result = pass_result(law, contacts, entered, seen, unknowns, taken)
            if tried >= least and _have_settled(entered, result.in_equations):
                # each set of multipliers has its own open-close iteration
                solves, tried = solves + 1, 0
                if multipliers.enough(law, solves, contacts, result.gap):
                    return solution_of(context, result, at, passes, factor)
                contacts = result.contacts
            seen, at = (result.gap, result.slip), unknowns
        raise StepRejected(
            StepOutcome.NOT_CONVERGED,
            f"contacts still change their mode after {self.iterations} solves",
            cut=STEP_CUT,
        )

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn where p h2/m is beyond the limit of impacts, or carried multipliers swing up.

        Blocks at rest carry more: steps whose modes do not settle are cut.
        """
        usual = *multipliers.advice(method.contact_law, model, step), *advice_without(model)
        number = stability_number(model, method, state, step)
        if method.integrator.theta > 0.5 or number <= STABILITY_LIMIT:
            return usual
        return (
            f"p h2/m = {number:.3g} is above {STABILITY_LIMIT:g} (m: mass per contact): constant "
            "acceleration throws back blocks that hit such stiff contacts, with more energy than "
            "they had. "
            f"Use {softer_springs(model, method, state, step)}time.step <= "
            f'{step * np.sqrt(STABILITY_LIMIT / number):.2g} or integrator = "backward-euler".',
            *usual,
        )

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return 40 E of the stiffest rock, or less where the step would throw blocks apart.

        Shi's 10 to 100 E L are for a length L of 1 m.
        """
        stiff = SHI_FACTOR * model.stiffest
        bearable, reason = bearable_stiffness(model, step)
        if bearable < stiff:
            return bearable, reason
        return stiff, f"{SHI_FACTOR:g} E of the stiffest rock (Shi: 10-100)"
