"""Prescribed motions of blocks, eliminated from the equations of a step.

With d = D + d', where D is the prescribed motion and 0 for other unknowns, K d = F becomes

    K d' = F - K D,    gaps + n.D,    slips + t.D,    d' = 0 where D is prescribed,

so that springs, contacts and friction take the motion into account without a penalty stiffness.
Fixed blocks have d' = 0 anyway.  In the equations of a free block the prescribed unknowns get a
diagonal so large that d' is below the last digit of d.

The integrator would derive a velocity from D; instead the velocity at the end of the step is
prescribed as well.  The inertia force of the block is M (v+ - v)/h if its drift is taken as
D - theta h (v+ - v).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from clast.actions.action import Contribution
from clast.contact.clipped_spring import Springs
from clast.linear.system import DiagonalTerms, PairedLinks, contact_motions
from clast.model.model import Bools, Floats, Model
from clast.step.inertia_projection import Stopped

STIFFNESS_RATIO = 1e16
"""Diagonal of prescribed unknowns, in units of their own and of the stiffness of the block."""
ROTATION = 2
"""Number of the rotation among the unknowns."""
DRIVEN_MASS_RATIO = 1e8
"""Mass of a body with a prescribed motion in an impact, in units of its own."""


@dataclass(frozen=True, kw_only=True)
class DrivenBlocks:
    """Motions prescribed in a step."""

    components: Bools
    """Unknowns with a prescribed value, all six of fixed blocks that move, shape (n, 6)."""
    displacement: Floats
    """Their values D, 0 elsewhere, shape (n, 6)."""
    velocity: Floats
    """Their velocities at the end of the step, 0 elsewhere, shape (n, 6)."""
    free: Bools
    """Unknowns with a prescribed value of blocks that are not fixed, shape (n, 6)."""

    @property
    def blocks(self) -> Bools:
        """Blocks with a prescribed motion, shape (n,)."""
        return np.asarray(self.components.any(axis=1))

    def at_rest(self) -> DrivenBlocks:
        """Return the same motions without velocities."""
        return replace(self, velocity=np.zeros_like(self.velocity))

    def put(self, values: Floats, others: Floats) -> Floats:
        """Return ``values`` (n, 6) with ``others`` where motions are prescribed."""
        return np.where(self.components, others, values)

    def drift(self, drift: Floats, velocity: Floats, share: float) -> Floats:
        """Return the drift (n, 6), m, with which prescribed motions end at their velocities.

        ``velocity`` (n, 6) enters the step, ``share`` is theta h, s.
        """
        return self.put(drift, self.displacement - share * (self.velocity - velocity))

    def total(self, unknowns: Floats) -> Floats:
        """Return d (n, 6) of d' (n, 6)."""
        return self.put(unknowns, self.displacement)

    def beside(self, unknowns: Floats) -> Floats:
        """Return d' (n, 6) of d (n, 6)."""
        return self.put(unknowns, np.zeros_like(unknowns))

    def terms(self, base: DiagonalTerms, inertia: Floats, area: Floats) -> DiagonalTerms:
        """Return the equations of d' without springs; ``inertia`` (n, 6, 6) is M/(theta h2).

        In a long step inertia is nothing beside springs: prescribed components are stiff beside the
        stiffness of their block, too, of the ``area`` (n,), m2.
        """
        rows = np.flatnonzero(self.blocks)
        moved = self.displacement[rows]
        force, momentum = base.force.copy(), base.momentum.copy()
        force[rows] -= np.einsum("kij,kj->ki", base.diagonal[rows], moved)
        momentum[rows] -= np.einsum("kij,kj->ki", inertia[rows], moved)
        matrix = base.diagonal.copy()
        block, axis = np.nonzero(self.free)
        strains = np.arange(3, 6)
        elastic = matrix[block][:, strains, strains].max(axis=1)
        elastic = np.where(axis < ROTATION, elastic / area[block], elastic)
        matrix[block, axis, axis] = STIFFNESS_RATIO * (matrix[block, axis, axis] + elastic)
        return replace(base, diagonal=matrix, force=force, momentum=momentum)

    def springs(self, springs: Springs) -> Springs:
        """Return springs with gaps and slips that count from the prescribed motions."""
        opening, slip = self.motions(springs)
        return replace(springs, gap=springs.gap + opening, slip=springs.slip + slip)

    def motions(self, links: PairedLinks) -> tuple[Floats, Floats]:
        """Return by how much links open and slip by the prescribed motions, m, (m,) each."""
        return contact_motions(links, self.displacement)

    def unstopped(self, stopped: Stopped) -> Stopped:
        """Return motions that contacts stop without those prescribed."""
        free, motions, momenta, mass = stopped
        mass = np.where(self.free[:, :, None] | self.free[:, None, :], 0.0, mass)
        for block in np.flatnonzero(self.free.any(axis=1)):
            momenta[block][:, self.free[block]] = 0.0
        return free, motions, momenta, mass

    def heavy(self, mobility: Floats, mass_matrix: Floats) -> tuple[Floats, Floats]:
        """Return mobilities (n, 3, 3) and masses (n, 6, 6) with which impacts move no such body.

        It is heavy, and not of no mobility, so that its impulse in an impact is known.
        """
        mobility, mass = mobility.copy(), mass_matrix.copy()
        for block in np.flatnonzero(self.blocks):
            for axis in np.flatnonzero(self.components[block, :3]):
                mobility[block, axis] = mobility[block, :, axis] = 0.0
                mass[block, axis, axis] *= DRIVEN_MASS_RATIO
                mobility[block, axis, axis] = 1.0 / mass[block, axis, axis]
        return mobility, mass

    def driven(self, mass_matrix: Floats, before: Floats, after: Floats) -> Floats:
        """Return the impulses of heavy bodies on others they strike, N s/m, shape (n, 6)."""
        impulses = np.zeros_like(before)
        block, axis = np.nonzero(self.components[:, :3])
        change = after[block, axis] - before[block, axis]
        impulses[block, axis] = -DRIVEN_MASS_RATIO * mass_matrix[block, axis, axis] * change
        return impulses


def held_by(shares: Sequence[Contribution], model: Model) -> DrivenBlocks | None:
    """Return the motions that actions prescribe in a step, None where there are none."""
    given = [one.prescribed for one in shares if one.prescribed is not None]
    if not given:
        return None
    count = model.block_count
    components = np.zeros((count, 6), np.bool_)
    displacement, velocity = np.zeros((count, 6)), np.zeros((count, 6))
    for one in given:
        rows, axes = np.nonzero(one.components)
        at = one.block[rows], axes
        components[at] = True
        displacement[at], velocity[at] = one.displacement[rows, axes], one.velocity[rows, axes]
    free = components & ~model.fixed[:, None]
    whole = np.asarray(components.any(axis=1)) & model.fixed
    components[whole] = True
    return DrivenBlocks(
        components=components, displacement=displacement, velocity=velocity, free=free
    )
