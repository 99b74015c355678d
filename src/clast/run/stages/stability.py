"""Whether the path of a static run branches: more than one equilibrium goes on from where it is.

With the forces that contacts and supports carry, a small displacement w changes the sums of forces
on blocks by (G - K) w: K is the stiffness of rock, contacts and supports, G that of the forces,
which turn with the blocks that they act on.  The equilibrium is stable where the largest q with

    G w = q K w

is below 1: near it a movement is q times the one before (convergence.py).  Where a path comes to
q = 1 and no force acts along w, by symmetry, it goes on along w, against w, or without it.
All contacts that carry count as stuck, which is more stiffness than they have: blocks that slide or
fall apart do not branch.

The largest q is found by Lanczos iterations (1950) in the inner product of K, factorised once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.actions.active import add_contributions
from clast.block.displacement import moved_to
from clast.contact.clipped_spring import Forces, Springs
from clast.contact.laws import SpringLaw, clipped, has_limits
from clast.errors import StepRejected
from clast.linear.factor_cache import FactorOfStep
from clast.linear.system import graph_of, symmetric_system, with_ground
from clast.model.model import Floats, Ints, Model
from clast.model.stage_records import towards
from clast.model.state import State
from clast.read_only import changed
from clast.run.stages.balance import angle_of
from clast.step.convex import potential_of
from clast.step.method import Method, Workspace
from clast.step.search_distance import search_within_step, travel_expected
from clast.step.start import StepContext, begin, diagonal_terms

ITERATIONS_MAX = 20
"""Lanczos iterations at most."""


@dataclass(frozen=True, kw_only=True)
class CriticalMode:
    """The movement against which a system in equilibrium is least stable."""

    ratio: float
    """Forces that it brings about, in units of those that resist it, q."""
    block: str
    direction: float
    """Direction in which it moves, or the opposite one, degrees from +x."""

    def stayed(self, time: float) -> str:
        """Return, in words, that a path goes on without this movement at a time, s."""
        return (
            f"at t = {time:.6g} s its equilibrium is unstable, and more than one path goes on: "
            f"forces drive block '{self.block}' {towards(self.direction)}, or the opposite way, "
            f"{self.ratio:.3g} times as much as joints and supports resist. The path without this "
            f"movement was followed. To have another followed, put a small imperfection into the "
            f"model"
        )


def critical_mode(model: Model, method: Method, state: State, step: float) -> CriticalMode | None:
    """Return the movement against which a state is least stable; None where none is known.

    ``step`` is the pseudo time step, s, whose mass term holds blocks without support.
    """
    law = method.contact_law
    if not has_limits(law):
        return None
    still = replace(state, velocity=np.zeros_like(state.velocity))
    context = begin(model, replace(method, clock=0.0), still, step, Workspace())
    tangent = _Tangent(context, law)
    if not len(tangent.contacts) and context.springs is None:
        return None
    try:
        ratio, mode = _largest_ratio(tangent)
    except StepRejected:
        return None
    far = np.hypot(*mode[:, :2].T) + np.abs(mode[:, 2]) * np.sqrt(model.area)
    most = int(far.argmax())
    if not (ratio > 0.0 and 0.0 < far[most] < np.inf):
        return None
    first, past = model.block_start[most : most + 2]
    # a mode has no size: w.K w = 1 turns blocks on soft springs by more than a radian
    small = 1e-4 * float(np.sqrt(model.area[most]) / far[most]) * mode
    motion = _moved(context, small).vertices[first:past] - state.vertices[first:past]
    direction = angle_of(motion[int(np.hypot(*motion.T).argmax())])
    return CriticalMode(ratio=ratio, block=model.block_name[most], direction=direction)


class _Tangent:
    """Stiffness and forces of a system about a state."""

    def __init__(self, context: StepContext, law: SpringLaw) -> None:
        model, method = context.model, context.method
        self._context = context
        self.contacts = context.contacts(search_within_step(method, travel_expected(context)))
        base = diagonal_terms(context, np.zeros_like(context.velocity), context.scheme)
        graph = graph_of(self.contacts, model.block_count)
        potential, rows, _ = potential_of(context, base, self.contacts, graph, None)
        count, contacts = len(potential.springs), self.contacts
        carries = contacts.normal_force != 0.0
        carries |= contacts.gap <= 1e-3 * method.max_displacement
        values = [np.zeros(count) for _ in range(4)]
        if context.springs is not None:
            others = potential.springs.at(potential.springs.gap, potential.springs.slip)
            values = [others.normal_force, others.shear_force]
            values += [others.normal_stiffness, others.shear_stiffness]
        springs = [one.stiffness * carries for one in clipped(law, contacts)]
        borne = contacts.normal_force, contacts.shear_force
        for into, given in zip(values, (*borne, *springs), strict=True):
            into[rows] = given
        self._forces = Forces(*values)
        # contacts turn with their edge, links with their first block
        turn_with = potential.springs.vertex_block.copy()
        turn_with[rows] = contacts.edge_block
        self._turning = _Turning(potential.springs, turn_with, self._forces, model)
        nobody = np.zeros((len(potential.fixed), 6))
        self._system = symmetric_system(
            potential.base,
            potential.springs,
            self._forces,
            nobody,
            potential.fixed,
            potential.graph,
        )
        solver = context.workspace.inexact(method.solver)
        self._factor = FactorOfStep(solver, context.workspace.patterns)
        self._held = np.repeat(model.fixed[:, None], 6, axis=1)
        if context.held is not None:
            self._held |= context.held.components

    def start(self) -> Floats:
        """Return forces that no symmetry keeps from any movement, (n, 6)."""
        count = self._context.model.block_count
        scattered = np.modf(np.arange(1.0, 3 * count + 1.0) * 0.6180339887498949)[0] - 0.5
        forces = np.zeros((count, 6))
        forces[:, :3] = scattered.reshape(count, 3)
        return np.where(self._held, 0.0, forces)

    def solved(self, force: Floats) -> Floats:
        """Return K^-1 f (n, 6)."""
        count = len(force)
        if len(self._system.force) > count:
            force = with_ground(force)
        return self._factor.solve(changed(self._system, force=force), self._forces)[:count]

    def turned(self, motion: Floats) -> Floats:
        """Return G w (n, 6): forces by which those that act change as they turn with blocks."""
        model, state = self._context.model, self._context.state
        forces = np.zeros_like(motion)
        forces[:, :3] = self._turning.forces(motion)
        if any(len(one.block) and one.stiffness is None for one in self._context.contributions):
            far = np.abs(motion[:, :2]).max() + (np.abs(motion[:, 2]) * np.sqrt(model.area)).max()
            small = 1e-6 * float(np.sqrt(np.median(model.area))) / far
            forces += (self._loads(small * motion) - self._loads(-small * motion)) / (2.0 * small)
        tension = model.area * (state.stress[:, 0] + state.stress[:, 1])
        forces[:, 2] += np.maximum(0.0, tension) * motion[:, 2]  # K has it (holding_forces.py)
        return np.where(self._held, 0.0, forces)

    def _loads(self, motion: Floats) -> Floats:
        """Return the forces of loads (n, 6) where blocks move by w (n, 6)."""
        context, forces = self._context, np.zeros_like(motion)
        moved = _moved(context, motion)
        at = begin(context.model, context.method, moved, context.step, context.workspace)
        loads = [one for one in at.contributions if one.stiffness is None]
        add_contributions(loads, np.zeros((0, 6, 6)), forces)
        return forces


class _Turning:
    """Forces of links between blocks that turn with these."""

    def __init__(self, links: Springs, turn_with: Ints, forces: Forces, model: Model) -> None:
        self._count = model.block_count
        self._ends = links.vertex_block, links.edge_block
        self._arms = links.arms[:, 2:4], links.arms[:, 4:6]
        nx, ny = links.arms[:, :2].T
        normal, shear = forces.normal_force, forces.shear_force
        self._force = np.stack([normal * nx - shear * ny, normal * ny + shear * nx], axis=1)
        self._turn_with = turn_with

    def forces(self, motion: Floats) -> Floats:
        """Return the change of the sums of forces (n, 3) by a displacement w (n, 6)."""
        moved, count = with_ground(motion), self._count
        own, other = self._ends
        # the place where a force acts moves with the block that it does not turn with
        carrier = np.where(self._turn_with == own, other, own)
        arm = np.where((carrier == own)[:, None], *self._arms)
        place = moved[carrier, :2] + moved[carrier, 2:3] * _across(arm)
        turned = moved[self._turn_with, 2:3] * _across(self._force)
        result = np.zeros((count + 1, 3))
        for block, arm, sign in ((own, self._arms[0], 1.0), (other, self._arms[1], -1.0)):
            moment = _cross(place - moved[block, :2], self._force) + _cross(arm, turned)
            np.add.at(result, block, sign * np.column_stack([turned, moment]))
        return result[:count]


def _across(vectors: Floats) -> Floats:
    """Return vectors (k, 2) turned by 90 degrees to the left."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def _cross(first: Floats, second: Floats) -> Floats:
    """Return the cross products of vectors (k, 2), (k,)."""
    return np.asarray(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def _moved(context: StepContext, motion: Floats) -> State:
    """Return the state with blocks moved by w (n, 6)."""
    model, state, rule = context.model, context.state, context.method.rotation
    place = context.frames.centroid, motion, rule.gradient(motion)
    points = state.points
    if len(points):
        points = moved_to(points, model.material_points.block, *place)
    return replace(
        state,
        vertices=moved_to(state.vertices, model.vertex_block, *place),
        points=points,
        rotation=state.rotation + motion[:, 2],
    )


def _largest_ratio(tangent: _Tangent) -> tuple[float, Floats]:
    """Return the largest q of G w = q K w, and w (n, 6) with w.K w = 1."""
    force = tangent.start()
    motion = tangent.solved(force)
    modes, forces, ratios = [], [], []
    products = np.zeros((ITERATIONS_MAX, ITERATIONS_MAX))
    mode = np.ones(1)
    for k in range(ITERATIONS_MAX):
        size = float(np.vdot(motion, force))
        if size <= 0.0:
            break
        modes.append(motion / np.sqrt(size))
        forces.append(force / np.sqrt(size))
        force = tangent.turned(modes[k])
        motion = tangent.solved(force)
        for j in range(k + 1):
            products[j, k] = products[k, j] = np.vdot(modes[j], force)
            force = force - products[j, k] * forces[j]
            motion = motion - products[j, k] * modes[j]
        values, vectors = np.linalg.eigh(products[: k + 1, : k + 1])
        ratios.append(float(values[-1]))
        mode = vectors[:, -1]
        # Change of q in two iterations, as a share of it, at which it is known
        if k > 2 and abs(ratios[-1] - ratios[-3]) <= 1e-3 * abs(ratios[-1]):
            break
    if not ratios:
        return 0.0, motion
    return ratios[-1], np.asarray(np.einsum("k,knd->nd", mode, np.array(modes[: len(mode)])))
