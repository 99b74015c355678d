"""The start of a step for every process: places of blocks, actions, equations.

The equations K d = F of a step without contacts are block diagonal: inertia, elasticity, stress and
weight (block/equations.py), and the shares of all actions (actions/).  Contacts, which couple
blocks, are added in ``clast.linear.system``.  Blocks keep their start area in the elastic terms,
as they keep their mass: the strain energy 1/2 A sigma.C.sigma is then the same before and after a
rotation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.actions.action import Action, Contribution, StepStart
from clast.actions.active import acceleration_of, add_contributions, contributions_of, states_of
from clast.block import equations
from clast.block.inertia import BlockFrames, block_frames
from clast.compute.compilation import Stages
from clast.contact.candidates import SearchDistance
from clast.contact.clipped_spring import Springs, merged
from clast.contact.contacts import Contacts
from clast.contact.detection import detect
from clast.linear.system import DiagonalTerms
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.read_only import changed
from clast.step import inertia_projection
from clast.step.integration import Scheme, forces_at
from clast.step.method import Method, Workspace
from clast.step.prescribed import DrivenBlocks, held_by


@dataclass(frozen=True, kw_only=True)
class StepContext:
    """A step that has begun: all that its equations are made from."""

    at: StepStart
    """The start of the step for actions."""
    model: Model
    state: State
    """State at the start of the step."""
    frames: BlockFrames
    """Areas, centroids and mass matrices at the start of the step."""
    step: float
    """Length of the step h, s."""
    method: Method
    workspace: Workspace
    velocity: Floats
    """Velocity that enters the equations, shape (n, 6)."""
    actions: tuple[Action, ...]
    """The actions on the blocks beside contacts."""
    action_states: tuple[Any, ...]
    """Own state of each action."""
    contributions: tuple[Contribution, ...]
    """The contribution of each action to the equations."""
    drift: Floats
    """Displacement that the velocities would bring, h v, m, shape (n, 6)."""
    springs: Springs | None
    """Springs of all actions between blocks, None where there are none."""
    acceleration: Floats
    """Acceleration of every mass by gravity and the ground, m/s2, shape (2,)."""
    stages: Stages
    """Adds up the time of the stages of the step."""
    held: DrivenBlocks | None = None
    """Motions that are prescribed, None where none is."""

    @property
    def scheme(self) -> Scheme:
        """How blocks take the step that nothing stops."""
        return Scheme(theta=self.method.integrator.theta, step=self.step)

    def total(self, unknowns: Floats) -> Floats:
        """Return d (n, 6) of the unknowns of the equations, which count from prescribed motions."""
        return unknowns if self.held is None else self.held.total(unknowns)

    def contacts(self, reach: SearchDistance, drift: Floats | None = None) -> Contacts:
        """Return the contacts within ``reach``; ``drift`` (n, 6) as ``detect`` has it.

        Those of a static step act on both blocks at the vertex.  With the forces on the edge's
        block at its foot, a gap g away, a shear force T would turn the two by T g: beside the
        moments that buckle a wall on joints that close by g as much as g beside its courses.
        """
        rule, centroid = self.method.corner_rule, self.frames.centroid
        near = self.workspace.near
        contacts = detect(self.model, rule, self.state, centroid, reach, drift, near)
        if self.at.clock is None:
            return contacts
        arms = contacts.arms.copy()
        arms[:, 4:] += (contacts.gap + contacts.rest_gap)[:, None] * contacts.normal
        return changed(contacts, arms=arms)


def begin(
    model: Model, method: Method, state: State, step: float, workspace: Workspace | None
) -> StepContext:
    """Return the step of length ``step``, s, that begins at ``state``."""
    workspace = workspace or Workspace()
    stages = Stages(workspace.clock)
    stages("base system")
    ahead = (1.0 - method.integrator.theta) * step * method.dynamic_ratio
    at = StepStart(
        model=model,
        state=state,
        frames=block_frames(model, state),
        step=step,
        ahead=ahead * state.velocity if ahead > 0.0 else None,
        rotation=method.rotation,
        forces_at=forces_at(method.integrator),
        support_stiffness=method.fixed_point_stiffness,
        clock=method.clock,
    )
    actions = workspace.active.actions(model, method.fixed_point_stiffness, method.damping)
    action_states = states_of(actions, model, state)
    contributions = contributions_of(actions, at, action_states)
    carried = method.dynamic_ratio * math.prod(
        [contribution.carried for contribution in contributions]
    )
    if carried < 1.0 and at.forces_at < 1.0:
        # what does not swing on would step from one side of its equilibrium to the other
        at = replace(at, forces_at=1.0)
        contributions = contributions_of(actions, at, action_states)
    velocity, drift, held = _prescribed(
        held_by(contributions, model), method, state.velocity, carried * state.velocity, step
    )
    return StepContext(
        at=at,
        model=model,
        state=state,
        frames=at.frames,
        step=step,
        method=method,
        workspace=workspace,
        velocity=velocity,
        actions=actions,
        action_states=action_states,
        contributions=contributions,
        drift=drift,
        springs=springs_between(contributions),
        acceleration=acceleration_of(contributions),
        stages=stages,
        held=held,
    )


def _prescribed(
    held: DrivenBlocks | None, method: Method, entering: Floats, velocity: Floats, step: float
) -> tuple[Floats, Floats, DrivenBlocks | None]:
    """Return velocity and drift h v of a step with prescribed unknowns, (n, 6) each, and these.

    ``entering`` (n, 6) are the velocities at the end of the last step, ``velocity`` those damped.
    """
    if held is None:
        return velocity, step * velocity, None
    # no damping slows down what is driven; a static run knows of no momentum
    dynamic = method.dynamic_ratio > 0.0
    held = held if dynamic else held.at_rest()
    velocity = held.put(velocity, entering if dynamic else np.zeros_like(velocity))
    return velocity, held.drift(step * velocity, velocity, method.integrator.theta * step), held


def again(context: StepContext, unknowns: Floats) -> StepContext | None:
    """Return a step with other contributions where an action asks for them after d (n, 6).

    Its method ``again(start, contribution, d)`` returns one, or None where it is content.
    """
    contributions = context.contributions
    for k, action in enumerate(context.actions):
        if hasattr(action, "again"):
            contribution = action.again(context.at, contributions[k], unknowns)
            if contribution is not None and contribution is not contributions[k]:
                contributions = *contributions[:k], contribution, *contributions[k + 1 :]
    if contributions is context.contributions:
        return None
    return replace(context, contributions=contributions, springs=springs_between(contributions))


def repeats(context: StepContext) -> int:
    """Return how often a step is solved again at most, for actions that ask for it.

    Those without ``repeats`` of their own may do so 4 times.
    """
    return max([int(getattr(one, "repeats", 4)) for one in context.actions], default=0)


def diagonal_terms(context: StepContext, drift: Floats, scheme: Scheme) -> DiagonalTerms:
    """Return everything of a step but the coupling of blocks; ``drift`` (n, 6) is h v, m.

    The equations are those of the unknowns that ``StepContext.total`` takes.
    """
    model, frames, share = context.model, context.frames, context.at.forces_at
    matrix, force, momentum = equations.terms(
        (frames.mass_matrix, scheme.inertia, drift),
        (model.area, model.elasticity if share == 1.0 else share * model.elasticity),
        context.state.stress,
        model.mass,
        context.acceleration,
    )
    if scheme.stopped is not None:
        terms = matrix, force, momentum
        inertia_projection.add_inertia(scheme.stopped, scheme.of_stopped, drift, terms)
    add_contributions(context.contributions, matrix, force)
    base = DiagonalTerms(diagonal=matrix, force=force, momentum=momentum, centroid=frames.centroid)
    if context.held is None:
        return base
    return context.held.terms(base, scheme.inertia * frames.mass_matrix, model.area)


def springs_between(shares: Sequence[Contribution]) -> Springs | None:
    """Return the springs of all actions as one table, None where there are none."""
    tables = [one.springs for one in shares if one.springs is not None and len(one.springs)]
    return merged(tables[0], tables[1:])[0] if tables else None
