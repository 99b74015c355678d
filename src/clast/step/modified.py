"""The modified process of Yu & Yin (2015): one solve per step, springs only after invasion.

The numbers in brackets are the paper's steps; (1)-(3), reading and preparing, belong to the case
and the model; (15) and (17), the step size and the next step, to ``clast.run.simulate``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from clast.block.inertia import block_frames
from clast.contact import laws as multipliers
from clast.contact.candidates import SearchDistance
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.corner_rules import Bisector
from clast.contact.detection import detect
from clast.contact.joints.along_joint import softest_beside_welds
from clast.contact.laws import ContactLaw, normal_stiffness_of
from clast.errors import StepOutcome, shortened
from clast.linear.factor_cache import FactorOfStep
from clast.linear.system import contact_motions, slip_in_step
from clast.model.model import Floats, Ints, Model
from clast.model.state import State, initial_state
from clast.step.action_springs import LinearContacts, solved
from clast.step.impact import advice_without
from clast.step.integration import HalfWay, answer, half_way
from clast.step.method import Method, StepSolution
from clast.step.search_distance import ContactSearch
from clast.step.start import StepContext, diagonal_terms
from clast.step.take_step import take_step

THROWN = (
    "The contacts throw blocks apart: lower method.contact_law.normal_stiffness or time.step, or "
    "use method.process.passes >= 2"
)
"""Remedy where contacts do not settle in one pass."""


@dataclass(frozen=True, kw_only=True)
class PassResult:
    """The result of a solve."""

    unknowns: Floats
    """Displacements d, shape (n, 6)."""
    contacts: Contacts
    """Contacts with the multipliers after the solve."""
    gap: Floats
    """Gap at the end of the step, m, shape (m,)."""
    slip: Floats
    """Slip in the step, m, shape (m,)."""
    response: ContactResponse
    """The law's answer at the end of the step."""
    in_equations: ContactResponse
    """The same, or half way where forces are taken there: as in the equations."""
    applied: tuple[Floats, Floats]
    """Normal and shear forces (m,) that the equations held at the end of the step, N/m."""


@dataclass(frozen=True)
class Modified:
    """The paper's process; ``passes`` > 1 repeats steps (10)-(12) with the last result."""

    passes: int = 1
    """Assemblies and solves per step, at most."""

    remedies: ClassVar[Mapping[StepOutcome, str]] = {
        StepOutcome.TRAVELLED_TOO_FAR: THROWN,
        StepOutcome.ROTATED_TOO_FAR: THROWN,
        StepOutcome.ENERGY_CREATED: f'{THROWN}, or set method.integrator = "backward-euler"',
    }

    # (4) where the blocks are; (13) the blocks are moved and turned; (14) their velocities and
    # stresses; (16) what the contacts carry on
    step = take_step

    def search(self, context: StepContext) -> ContactSearch:
        """Return the search for contacts: critdis, and twice the travel of a step behind."""
        # (8) blocks near each other; (9) entrance edges by the angle bisector
        distance = search_of_modified(context.method)
        return ContactSearch(distance=distance, drift=None, depth=distance.depth)

    def solve(
        self, context: StepContext, contacts: Contacts, before: StepSolution | None = None
    ) -> StepSolution:
        """Return the result of the passes of the step, with their multiplier solves."""
        law, factor, stages = context.method.contact_law, factor_of(context), context.stages
        stages("base system")
        # (5) inertia and elasticity; (6) stress, weight, loads; (7) fixed points
        base = diagonal_terms(context, context.drift, context.scheme)
        taken = half_way(context.model, law, contacts, context.at.forces_at, context.step)
        contacts = multipliers.begin(law, contacts)
        # the first pass sees the gaps at the start and the slip that the velocity will bring
        seen = contacts.gap, slip_in_step(contacts, context.drift)
        at, passes = context.drift, 0
        while True:
            passes += 1
            solves = 0
            while True:
                stages("law")
                # (10) springs where a vertex has invaded, friction from spring or as a force
                entered = answer(law, contacts, *seen, taken)
                stages("assembly")
                # (11) the equations of all blocks; (12) one solve, more where supports yield
                held = LinearContacts(contacts=contacts, response=entered, seen=seen)
                unknowns, at = solved(context, base, factor, held, at)
                result = pass_result(law, contacts, entered, seen, unknowns, taken)
                solves += 1
                if multipliers.enough(law, solves, contacts, result.gap):
                    break
                contacts = result.contacts
            settled = np.array_equal(result.in_equations.mode, entered.mode)
            if passes >= self.passes or settled:
                return solution_of(context, result, at, passes, factor)
            contacts, seen, at = result.contacts, (result.gap, result.slip), unknowns

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn where p h2/m is beyond the limit of one pass, or carried multipliers swing up."""
        swing = *multipliers.advice(method.contact_law, model, step), *advice_without(model)
        number = stability_number(model, method, state, step)
        if self.passes > 1 or number <= STABILITY_LIMIT:
            return swing
        return (
            f"p h2/m = {number:.3g} is above {STABILITY_LIMIT:g} (m: mass per contact): contacts "
            "of the modified process will not settle in one pass. Use "
            f"{softer_springs(model, method, state, step)}"
            f"time.step <= {step * np.sqrt(STABILITY_LIMIT / number):.2g} or passes >= 2.",
            *swing,
        )

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return E, or less where one pass could not settle (p h2/m = 1)."""
        bearable, reason = bearable_stiffness(model, step)
        if bearable < model.stiffest:
            return bearable, reason
        return model.stiffest, "E of the stiffest rock; steps bear no less"


def pass_result(
    law: ContactLaw,
    contacts: Contacts,
    entered: ContactResponse,
    seen: tuple[Floats, Floats],
    unknowns: Floats,
    taken: HalfWay | None,
) -> PassResult:
    """Return the result of a solve; ``seen`` are gap and slip (m,) where the law was linearised."""
    opening, slip = contact_motions(contacts, unknowns)
    gap = contacts.gap + opening
    response = law.respond(contacts, gap, slip)
    # N may be tensile there: the price of one pass without checking
    normal = entered.normal_force - entered.normal_stiffness * (gap - seen[0])
    shear = entered.shear_force - entered.shear_stiffness * (slip - seen[1])
    return PassResult(
        unknowns=unknowns,
        contacts=multipliers.renew(law, contacts, response),
        gap=gap,
        slip=slip,
        response=response,
        in_equations=response if taken is None else taken.respond(law, contacts, gap, slip),
        applied=(normal, shear),
    )


def solution_of(
    context: StepContext,
    result: PassResult,
    linearised_at: Floats,
    passes: int,
    factor: FactorOfStep,
) -> StepSolution:
    """Return the last solve of a step as its solution.

    ``linearised_at`` (n, 6) are displacements about which springs of actions were linearised.
    """
    return StepSolution(
        velocity=context.velocity,
        drift=context.drift,
        scheme=context.scheme,
        unknowns=result.unknowns,
        contacts=result.contacts,
        response=result.response,
        applied=result.applied,
        bearing=result.response.normal_force,
        counts={"passes": passes, "solves": factor.solved, "factorisations": factor.factorised},
        linearised_at=linearised_at,
    )


def factor_of(context: StepContext) -> FactorOfStep:
    """Return the factor for the systems of a step."""
    return FactorOfStep(context.method.solver, context.workspace.patterns)


def search_of_modified(method: Method) -> SearchDistance:
    """Return how far contacts are looked for: critdis, and twice the travel of a step behind."""
    return SearchDistance(
        front=method.critdis,
        depth=method.critdis + 2.0 * method.max_displacement,
        critdis=method.critdis,
    )


STABILITY_LIMIT = 6.0
"""Largest p h2/m with which a contact settles without passes (m: mass per contact)."""
TOUCHING_GAP_SIZES = 0.005
"""Distance within which blocks touch at the start, as a share of the smallest block's size."""


def bearable_stiffness(model: Model, step: float) -> tuple[float, str]:
    """Return the normal stiffness, N/m per m, that a step of ``step``, s, carries, and the reason.

    p h2/m = 1 for the lightest block with four contacts; no more than the limit for any block with
    the contacts that it has at the start, the points of a face counted by their shares of p.
    Where only welds have the springs of the law, no less than the softest one of a joint: the step
    has to bear that anyway.  Infinity where all blocks are fixed.
    """
    stable, reason = _stable_stiffness(model, step)
    beside = softest_beside_welds(model)
    if stable < beside:
        return beside, "that of the softest joint; nothing but welds has it"
    return stable, reason


def _stable_stiffness(model: Model, step: float) -> tuple[float, str]:
    """Return the stiffness with which blocks settle, N/m per m, whatever their joints say."""
    free = ~model.fixed
    if not free.any():
        return np.inf, "all blocks are fixed"
    state = initial_state(model)
    near = TOUCHING_GAP_SIZES * float(np.sqrt(model.smallest))
    reach = SearchDistance(front=near, depth=near, critdis=near)
    contacts = detect(model, Bisector(), state, block_frames(model, state).centroid, reach)
    sides = _sides(contacts)
    count = np.bincount(sides, minlength=model.block_count)
    springs = np.bincount(sides, np.tile(contacts.spring_share, 2), model.block_count)
    of_four = model.mass / multipliers.CONTACTS_OF_A_BLOCK
    share = np.minimum(of_four, STABILITY_LIMIT * model.mass / np.where(count > 0, springs, 1.0))
    least = int(np.argmin(np.where(free, share, np.inf)))
    stable = float(share[least]) / step**2
    if share[least] == of_four[least]:
        carried = f"p h2/m = 1 for a contact that carries {share[least]:.3g} kg/m"
        return stable, f"{carried} (limit {STABILITY_LIMIT:g})"
    name = shortened(model.block_name[least])
    reason = f"p h2/m = {STABILITY_LIMIT:g}, the limit, for the {count[least]} contacts of '{name}'"
    return stable, reason


def _sides(contacts: Contacts) -> Ints:
    """Return the blocks of all contacts (m,), those of vertices first, shape (2 m,)."""
    return np.concatenate([contacts.vertex_block, contacts.edge_block])


def stability_number(model: Model, method: Method, state: State, step: float) -> float:
    """Return the largest p h2/m over the blocks, p being all springs of a block together.

    Springs are those of contacts within critdis at ``state``; a block that touches nothing yet is
    counted with the single vertex that it will land on.
    """
    of_law, of_joints = _stability_of_springs(model, method, state, step)
    return float((of_law + of_joints).max(initial=0.0))


def softer_springs(model: Model, method: Method, state: State, step: float) -> str:
    """Return the springs of the law with which p h2/m is below its limit, as a remedy.

    "" where joints with a stiffness of their own are beyond it without them.
    """
    of_law, of_joints = _stability_of_springs(model, method, state, step)
    left = STABILITY_LIMIT - of_joints
    if left.min(initial=np.inf) <= 0.0:
        return ""
    share = float((left[of_law > 0.0] / of_law[of_law > 0.0]).min(initial=1.0))
    return f"normal_stiffness <= {method.contact_law.normal_stiffness * share:.2g}, "


def _stability_of_springs(
    model: Model, method: Method, state: State, step: float
) -> tuple[Floats, Floats]:
    """Return p h2/m of the springs of the law and of those of joints, of each free block, (f,)."""
    frames = block_frames(model, state)
    contacts = detect(model, method.corner_rule, state, frames.centroid, search_of_modified(method))
    sides, count, law = _sides(contacts), model.block_count, method.contact_law
    own = np.tile(normal_stiffness_of(contacts, law), 2)
    is_of_law = np.tile(np.isnan(contacts.normal_stiffness), 2)
    touches = np.bincount(sides, minlength=count) > 0
    of_law = np.bincount(sides, np.where(is_of_law, own, 0.0), count)
    of_law = np.where(touches, of_law, law.normal_stiffness)
    of_joints = np.bincount(sides, np.where(is_of_law, 0.0, own), count)
    free = ~model.fixed
    number = step**2 / model.mass[free]
    return number * of_law[free], number * of_joints[free]
