"""The convex process: a step is the minimum of the incremental potential energy.

    1/2 d.K d - F.d + sum phi_n(gap + n.d) + sum phi_t(t.d),    phi_n' = -N,  phi_t' = -T

with K and F of inertia, elasticity, weight and loads (block diagonal), and the friction bound of
each contact taken from a given normal force.  N falls with the gap and T with the slip, so the
potential is convex and once continuously differentiable: Newton's method with an exact line search
converges from anywhere.  Each iteration solves one assembled, symmetric positive definite system.
Where it takes long the interior point method takes over (stepping/interior.py).

What is not convex is taken out of the minimisation and repeated around it: the friction bound
follows the normal force (``friction_updates``), and bonds that reach their strength are broken
before the minimum is sought again; bonds only break, so this ends.  Multipliers, where the law has
them, are renewed after convergence.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.contact import multipliers
from clast.contact.arrays import Contacts
from clast.contact.detection import Reach, detect
from clast.equations.frames import BlockFrames, block_frames
from clast.equations.reuse import FactorOfStep
from clast.equations.solvers import inexact
from clast.equations.system import contact_motions, graph_of
from clast.equations.terms import diagonal_terms, momentum_rows
from clast.interfaces import Method, StepResult
from clast.model import Floats, Model
from clast.state import State
from clast.stepping.conclude import Solved, conclude
from clast.stepping.impact import theta_by_block
from clast.stepping.newton import minimise
from clast.stepping.potential import Point, Potential
from clast.stepping.stages import Stages

DIRECTION = 1e-3
"""Accuracy of Newton's directions where they are found by iteration; the step's is unaffected."""


AT_REST = 1.0
"""Slip rate below which a new contact is taken to hold at first, in units of g h."""


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

    def step(self, model: Model, method: Method, state: State, step: float) -> StepResult:
        """Return the state ``step`` seconds later, or raise StepRejected."""
        stages = Stages()
        velocity = method.dynamic_ratio * state.velocity
        with stages("contacts"):
            frames = block_frames(model, method.displacement, state)
            reach = reach_within_step(model, method, frames, velocity, step)
            contacts = detect(
                model,
                method.corner_rule,
                method.displacement,
                state,
                frames.centroid,
                reach,
                step * velocity,
            )
            theta = theta_by_block(model, method, contacts, velocity, self.restitution, step)
        with stages("base system"):
            base = diagonal_terms(model, method, frames, state, velocity, theta, step)
            potential = Potential(
                base=base,
                inverse=np.linalg.inv(base.diagonal).astype(np.float64, copy=False),
                law=method.contact_law,
                contacts=contacts,
                fixed=model.fixed,
                momentum=momentum_rows(frames, velocity, theta, step),
                graph=graph_of(contacts, model.block_count),
            )
        # warm starts: everything goes on as it moves, or rests as it rested
        starts = (step * velocity, np.zeros_like(velocity))
        counts = {"passes": 0, "line_search": 0}
        base_force = first_friction_base(model, potential, velocity, step)
        potential, point = self._minimum(potential, starts, base_force, method, counts, stages)
        response = point.response
        solved = Solved(
            frames=frames,
            velocity=velocity,
            theta=theta,
            unknowns=point.unknowns,
            contacts=potential.contacts,
            response=response,
            applied=(response.normal_force, response.shear_force),
            depth=reach.depth,
            counts=counts,
        )
        return conclude(model, method, state, solved, step, stages)

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Warn of carried multipliers; the process itself holds for any stiffness and step."""
        return multipliers.advice(method.contact_law, model, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return E of the stiffest rock: stiff enough not to be seen, soft enough to be quick."""
        return model.stiffest, "E of the stiffest rock; the process holds for any"

    def _minimum(
        self,
        potential: Potential,
        starts: tuple[Floats, ...],
        base: Floats,
        method: Method,
        counts: dict[str, int],
        stages: Stages,
    ) -> tuple[Potential, Point]:
        """Return the minimum with friction bounds, bonds and multipliers in accord with it.

        ``base`` (m,) are the normal forces that bound friction to begin with, N/m.
        """
        law = method.contact_law
        factor = FactorOfStep(inexact(method.solver, DIRECTION))
        contacts = multipliers.begin(law, potential.contacts)
        updates, solves = 0, 0
        # new multipliers shift the normal forces: their solve has its own friction to find
        wanted = self.friction_updates + int(multipliers.has_multipliers(law))
        while True:
            potential = replace(potential, contacts=replace(contacts, friction_base=base))
            point = minimise(
                potential, starts, factor, self.tolerance, self.iterations, counts, stages
            )
            starts, base = (point.unknowns,), point.response.normal_force
            updates += 1
            if updates <= wanted:
                continue
            updates, solves = 0, solves + 1
            if not multipliers.enough(law, solves, point.gap):
                contacts = multipliers.renew(law, contacts, point.response)
                continue
            # only the last solve has the forces by which bonds are judged
            broken = contacts.bonded & ~point.response.bonded
            if not broken.any():
                counts["factorisations"] = factor.factorised
                counts["pcg"] = factor.iterations
                contacts = multipliers.renew(law, contacts, point.response)
                return replace(potential, contacts=contacts), point
            contacts, solves = without_bonds(contacts, broken), solves - 1


def first_friction_base(
    model: Model, potential: Potential, velocity: Floats, step: float
) -> Floats:
    """Return the normal forces, N/m, that bound friction at first, shape (m,).

    Those of the last step; a new contact holds whatever comes if it is at rest, so that blocks
    just put upon each other are not minimised without any friction first, and has none if it slips
    already.
    """
    contacts = potential.contacts
    _, slip_rate = contact_motions(contacts, velocity)
    slow = np.abs(slip_rate) <= AT_REST * float(np.hypot(*model.gravity)) * step
    new = np.where(slow, potential.largest_force(), 0.0)
    return np.where(contacts.known, contacts.normal_force, new)


def without_bonds(contacts: Contacts, broken: np.ndarray) -> Contacts:
    """Return the contacts with the bonds of those ``broken`` (m,) gone."""
    return replace(
        contacts,
        bonded=contacts.bonded & ~broken,
        cohesion=np.where(broken, 0.0, contacts.cohesion),
        tensile_strength=np.where(broken, 0.0, contacts.tensile_strength),
    )


def reach_within_step(
    model: Model, method: Method, frames: BlockFrames, velocity: Floats, step: float
) -> Reach:
    """Return how far contacts are looked for: whatever may close within the step, and critdis."""
    limit = method.max_displacement
    return Reach(
        front=method.critdis + 2.0 * limit,
        depth=method.critdis + 2.0 * limit,
        critdis=method.critdis,
    )
