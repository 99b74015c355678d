"""The end of a step, the same for every process: move, remember, check, balance the energy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clast.block import equations, polygon
from clast.block.displacement import moved_to
from clast.compute.reductions import largest_size, least
from clast.contact.broad_phase import VerletList, near_pairs
from clast.contact.contacts import ContactResponse
from clast.contact.detection import find_tunnelled
from clast.contact.joints.wear import (
    Wear,
    after_slip,
    reaches_residual,
    wear_of,
    with_work_of_joints,
)
from clast.contact.laws import has_multipliers, normal_stiffness_of
from clast.contact.memory import renew
from clast.errors import StepOutcome, StepRejected
from clast.linear.system import contact_motions
from clast.model.model import Floats, Model
from clast.model.state import ContactMemory, State
from clast.read_only import changed
from clast.step.energy_balance import StepEnd, balance
from clast.step.integration import end_velocity
from clast.step.method import StepResult, StepSolution
from clast.step.start import StepContext
from clast.step.support_reactions import holding, reactions_of


def finish(context: StepContext, solution: StepSolution, depth: float) -> StepResult:
    """Return the result of a solved step, or raise StepRejected where it must not be kept.

    ``depth``, m, is how deep a vertex may have moved into a block (see ContactSearch).
    """
    model, state, stages = context.model, context.state, context.stages
    stages("advance")
    end = end_of(context, solution)
    motion = moved(context, solution.unknowns, end)
    solution, kept, wear = _after_sliding(context, solution, end)
    memory = renew(solution.contacts, kept, end.gap, end.slip, context.method.critdis, wear)
    # no vertex has got deeper into a block than it has moved
    if motion.travel > depth:
        stages("tunnelling")
        near = context.workspace.near
        reject_tunnelled(model, state.vertices, motion.vertices, memory, depth, near)
    stages("ledger")
    held = holding(context, solution, end)
    ledger, actions = balance(context, solution, end, motion.points, held.whole)
    rotation, reactions = state.rotation + motion.turn, reactions_of(context, solution, held)
    bonded = solution.contacts.bonded if solution.bonded is None else solution.bonded
    # arrays that nobody else has: to seal them the state need not take views
    made = motion.vertices, motion.velocity, motion.stress, motion.points, rotation, reactions
    for one in made:
        one.flags.writeable = False
    return StepResult(
        state=State(
            time=context.at.end,
            vertices=motion.vertices,
            velocity=motion.velocity,
            stress=motion.stress,
            rotation=rotation,
            points=motion.points,
            memory=memory,
            ledger=ledger,
            actions=actions,
            reactions=reactions,
        ),
        contacts=solution.contacts,
        response=solution.response,
        counts=solution.counts,
        travel=motion.travel,
        approach=motion.approach,
        broken=(bonded & ~solution.response.bonded).nonzero()[0],
        worn=reaches_residual(model.joint_table, solution.contacts, wear.path),
        penetration=abs(least(end.gap, 0.0)),
        seconds=stages.ended(),
    )


def _after_sliding(
    context: StepContext, solution: StepSolution, end: StepEnd
) -> tuple[StepSolution, ContactResponse, Wear]:
    """Return the solution with the energies of joints that open, the response to keep, and wear."""
    table, law = context.model.joint_table, context.method.contact_law
    contacts, response = solution.contacts, solution.response
    rate = context.method.dynamic_ratio / context.step
    bearing, kept = solution.bearing, response
    if solution.asperities is not None:
        ends = end.gap, end.slip
        slid = after_slip(solution.asperities, contacts, response, ends, solution.applied[0], rate)
        wear, kept = slid.wear, changed(slid.response, shear_force=slid.shear_force)
        # contacts that wait for their impact go on without a force
        waits = (bearing == 0.0) & (response.normal_force != 0.0)
        bearing = np.where(waits, 0.0, slid.normal_force)
        solution = changed(solution, response=slid.response)
    else:
        wear = wear_of(table, contacts, response, end.slip, rate)
    if solution.asperities is None and table.opens:
        stiffness = normal_stiffness_of(contacts, law)
        if has_multipliers(law):
            stiffness = np.nan_to_num(contacts.normal_stiffness)
        sheared = solution.applied[1], end.slip
        opened = wear.dilation - contacts.dilation
        kept = with_work_of_joints(table, contacts, response, stiffness, sheared, opened)
        solution = changed(solution, response=kept)
    if bearing is not kept.normal_force:
        kept = changed(kept, normal_force=bearing)
    return solution, kept, wear


def end_of(context: StepContext, solution: StepSolution) -> StepEnd:
    """Return velocities, stresses, gaps and slips at the end of a step."""
    velocity = end_velocity(solution.scheme, solution.unknowns, solution.drift, solution.velocity)
    velocity[context.model.fixed] = 0.0
    if context.held is not None:
        velocity = context.held.put(velocity, context.held.velocity)
    opening, slip = contact_motions(solution.contacts, solution.unknowns)
    return StepEnd(
        velocity=velocity,
        stress=equations.strained(
            context.state.stress, context.model.elasticity, solution.unknowns
        ),
        forces_at=context.at.forces_at,
        gap=solution.contacts.gap + opening,
        slip=slip,
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
    depth, vertex, block = find_tunnelled(model, before, vertices, memory, near, depth_reach)
    if depth > depth_reach:
        own = int(model.vertex_block[vertex])
        raise StepRejected(
            StepOutcome.TUNNELLED,
            f"vertex {vertex - int(model.block_start[own]) + 1} of block "
            f"'{model.block_name[own]}' is {depth:.3g} m inside '{model.block_name[block]}'",
        )


@dataclass(frozen=True, kw_only=True)
class StepMotion:
    """Where a displacement takes the system."""

    vertices: Floats
    """Vertices at the end of the step, m, shape (nv, 2)."""
    points: Floats
    """Material points at the end of the step, m, shape (np, 2)."""
    stress: Floats
    """Stress at the end of the step, Pa, shape (n, 3)."""
    velocity: Floats
    """Velocity at the end of the step, shape (n, 6)."""
    turn: Floats
    """Rotation in the step, rad, shape (n,)."""
    travel: float
    """Largest movement of a vertex, m."""
    approach: float
    """The same against blocks that it might touch in the step, m; 0 far from any."""


LARGEST_TURN = 0.1
"""Largest rotation in one step, rad, that the linearised equations are trusted with."""


STRESS, STRAIN_RATES = 0, 3
"""First column of xx, yy and xy among the stresses (n, 3), and among the velocities (n, 6)."""


def move(
    positions: Floats, block: np.ndarray, centroid: Floats, unknowns: Floats, gradient: Floats
) -> Floats:
    """Return positions (k, 2) of material points of the blocks ``block`` (k,) after a step.

    ``gradient`` (n, 2, 2) is the one of the rotation rule for d (n, 6).

    Written as position + movement, so that a block that does not move keeps every bit.
    """
    if not len(positions):
        return positions
    reached: Floats = moved_to(positions, block, centroid, unknowns, gradient)
    return reached


def moved(context: StepContext, unknowns: Floats, end: StepEnd) -> StepMotion:
    """Return where the unknowns d (n, 6) of a step take the system.

    Raises StepRejected where a vertex moves further than max_displacement against a block that it
    might touch, or a block turns further than the equations carry.
    """
    model, method, state = context.model, context.method, context.state
    centroid, near = context.frames.centroid, context.workspace.near
    turn = method.rotation.angle(np.ascontiguousarray(unknowns[:, 2]))
    if not largest_size(turn) <= LARGEST_TURN:
        raise StepRejected(StepOutcome.ROTATED_TOO_FAR)
    block = model.vertex_block
    gradient = method.rotation.gradient(unknowns)
    vertices = move(state.vertices, block, centroid, unknowns, gradient)
    travel = float(polygon.travel(state.vertices, vertices))
    if not math.isfinite(travel):
        raise StepRejected(StepOutcome.NOT_FINITE)
    approach = travel
    if travel > method.max_displacement:
        approach = approach_of(model, state.vertices, vertices, near)
    if approach > method.max_displacement:
        raise StepRejected(
            StepOutcome.TRAVELLED_TOO_FAR,
            f"{approach:.3g} m against max_displacement = {method.max_displacement:.3g} m",
        )
    points = move(state.points, model.material_points.block, centroid, unknowns, gradient)
    return StepMotion(
        vertices=vertices,
        points=points,
        stress=equations.turned(end.stress, STRESS, turn, 1.0),
        # the strain rate turns with the block, so that its kinetic energy stays what it was
        velocity=equations.turned(end.velocity, STRAIN_RATES, turn, 2.0),
        turn=turn,
        travel=travel,
        approach=approach,
    )


def approach_of(model: Model, before: Floats, after: Floats, near: VerletList) -> float:
    """Return how far a vertex moves at most against a block that it might touch, m.

    From vertices ``before`` to ``after`` a step, (nv, 2).  Free flight is exact at any length, and
    so is the motion of two blocks together: only pairs whose paths meet count.
    """
    moved = after - before
    thrown = float(np.hypot(*moved.T).max())
    if thrown > float(np.ptp(before, axis=0).max()):
        return thrown
    start, count = model.block_start, np.diff(model.block_start)
    distance = polygon.farthest(moved, start)
    pairs = near_pairs(near, before, start, model.fixed, 0.0, distance, model.absent)
    mean = np.add.reduceat(moved, start[:-1], axis=0) / count[:, None]
    own = polygon.farthest(moved - np.repeat(mean, count, axis=0), start)
    lower, higher = pairs.T
    against = np.hypot(*(mean[lower] - mean[higher]).T) + own[lower] + own[higher]
    # where two turn together the sum says too much
    return float(np.minimum(against, distance[lower] + distance[higher]).max(initial=0.0))
