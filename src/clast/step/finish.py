"""The end of a step, the same for every process: move, remember, check, balance."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from clast.block.inertia import BlockFrames
from clast.compute.stopwatch import Stages
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.detection import find_tunnelled
from clast.contact.memory import renew
from clast.contact.verlet_list import VerletList
from clast.errors import StepOutcome, StepRejected
from clast.linear.system import contact_motions
from clast.model.model import Floats, Model
from clast.model.state import ContactMemory, State
from clast.step.energy_balance import balance
from clast.step.integration import Scheme, end_velocity
from clast.step.method import Method, StepResult
from clast.step.motion import advance, end_stress
from clast.step.workspace import Workspace


@dataclass(frozen=True, kw_only=True)
class Solved:
    """What a process has found for a step."""

    frames: BlockFrames
    """Block frames at the start."""
    velocity: Floats
    """Velocity that entered the equations, shape (n, 6)."""
    drift: Floats
    """Displacements that it would bring, m, shape (n, 6)."""
    scheme: Scheme
    """How the blocks took the step."""
    unknowns: Floats
    """Displacements d, shape (n, 6)."""
    contacts: Contacts
    """Contacts of the step."""
    response: ContactResponse
    """The law's answer at the end of the step."""
    applied: tuple[Floats, Floats]
    """Normal and shear forces (m,) that the equations held at the end of the step, N/m."""
    bearing: Floats
    """Normal forces that contacts go on with, N/m, shape (m,)."""
    depth: float
    """How deep a vertex may have moved into a block, m (see Reach.depth)."""
    lost: float = 0.0
    """Kinetic energy that impacts took before it entered, J/m."""
    counts: dict[str, int] = field(default_factory=dict)
    """Counts of the process: "passes" and whatever else it counts."""


def conclude(
    model: Model,
    method: Method,
    state: State,
    solved: Solved,
    step: float,
    stages: Stages,
    workspace: Workspace,
) -> StepResult:
    """Return the result of a solved step, or raise StepRejected where it must not be kept."""
    unknowns, contacts, response = solved.unknowns, solved.contacts, solved.response
    with stages("advance"):
        velocity = end_velocity(solved.scheme, unknowns, solved.drift, solved.velocity)
        velocity[model.fixed] = 0.0
        stress = end_stress(model, state, unknowns)
        motion = advance(
            model, method, state, solved.frames, unknowns, velocity, stress, workspace.near
        )
        opening, slip = contact_motions(contacts, unknowns)
        gap = contacts.gap + opening
        kept = replace(response, normal_force=solved.bearing)
        memory = renew(contacts, kept, gap, method.critdis)
    with stages("tunnelling"):
        reject_tunnelled(
            model, state.vertices, motion.vertices, memory, solved.depth, workspace.near
        )
    with stages("ledger"):
        ledger = balance(
            model,
            method,
            state,
            solved.frames,
            solved.velocity,
            solved.lost,
            unknowns,
            velocity,
            stress,
            step,
            contacts,
            solved.applied,
            response,
            gap,
            slip,
        )
    return StepResult(
        state=State(
            time=state.time + step,
            vertices=motion.vertices,
            velocity=motion.velocity,
            stress=motion.stress,
            rotation=state.rotation + motion.turn,
            points=motion.points,
            memory=memory,
            ledger=ledger,
        ),
        contacts=contacts,
        response=response,
        counts=solved.counts,
        travel=motion.travel,
        approach=motion.approach,
        penetration=float(max(0.0, -gap.min(initial=0.0))),
        seconds=stages.seconds,
    )


def reject_tunnelled(
    model: Model,
    before: Floats,
    vertices: Floats,
    memory: ContactMemory,
    depth_reach: float,
    near: VerletList,
) -> None:
    """Raise StepRejected where a vertex has jumped deeper into a block than ``depth_reach``, m."""
    depth, vertex, block = find_tunnelled(model, before, vertices, memory, near)
    if depth > depth_reach:
        own = int(model.vertex_block[vertex])
        raise StepRejected(
            StepOutcome.TUNNELLED,
            f"vertex {vertex - int(model.block_start[own]) + 1} of block "
            f"'{model.block_name[own]}' is {depth:.3g} m inside '{model.block_name[block]}'",
        )
