"""Reactions: forces that hold blocks of a step, or move those whose motion is prescribed.

The equations say it: on a block that cannot move, or moves as is prescribed, they leave the force

    R = M (v+ - v)/h + A sigma - weight - loads - contacts - springs

which its support carries.  The weight and the inertia of fixed blocks are nobody's: the reaction of
such a block balances the forces of others on it.  So the sum of all reactions, loads and weights
of free blocks is the sum of their masses times accelerations, to the last digits of the equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.actions.action import Contribution, Solution
from clast.compute.jit import kernel
from clast.contact.clipped_spring import Springs
from clast.linear.system import PairedLinks
from clast.model.model import Floats, Ints
from clast.model.supports import Reactions, numbered
from clast.read_only import read_only
from clast.step.energy_balance import StepEnd
from clast.step.method import StepSolution
from clast.step.start import StepContext

NOBODY = read_only(np.zeros((0, 3)))
"""Forces on no block."""
NOTHING = read_only(np.zeros((0, 6)))
"""Generalised forces on no block, or positions of no point."""
NO_ROWS = read_only(np.zeros((0, 2), np.int64))
"""No supports of any reaction."""


@dataclass(frozen=True, kw_only=True)
class Holding:
    """Forces that hold s blocks in a step."""

    block: Ints
    """The blocks, shape (s,)."""
    number: Ints
    """Number of each block among them, -1 for others, shape (n,)."""
    carried: Floats
    """Force (x, y), N/m, and moment about the centroid, N, that hold it against others, (s, 3)."""
    whole: Floats
    """The same of all blocks with their weight and inertia, where motions are prescribed, (n, 3);
    (0, 6) where none is."""


def holding(context: StepContext, solution: StepSolution, end: StepEnd) -> Holding:
    """Return the forces on blocks whose reactions are recorded, or whose motion is prescribed."""
    model, held = context.model, context.held
    block, number = model.reacting
    if held is not None:
        asked = held.blocks
        asked[block] = True
        block, number = numbered(asked)
    elif not block.size:
        return Holding(block=block, number=number, carried=NOBODY, whole=NOTHING)
    carried = -_of_links(number, len(block), solution.contacts, solution.applied)
    if context.springs is not None:
        carried -= _of_springs(context.springs, solution, np.append(number, -1), len(block))
    for contribution in context.contributions:
        rows = contribution.block
        if rows.size:
            rows = (number[rows] >= 0).nonzero()[0]
        if rows.size:
            force = forces_in(contribution, solution.unknowns, rows)
            np.subtract.at(carried, number[contribution.block[rows]], force[:, :3])
    if held is None:
        carried[~model.fixed[block]] = 0.0
        return Holding(block=block, number=number, carried=carried, whole=NOTHING)
    gained = end.velocity[block] - solution.velocity[block]
    inertia = np.einsum("kij,kj->ki", context.frames.mass_matrix[block], gained) / context.step
    own = inertia[:, :3]  # against inertia and weight
    own[:, :2] -= model.mass[block, None] * context.acceleration
    whole = np.zeros((model.block_count, 3))
    whole[block] = np.where(held.components[block, :3], carried + own, 0.0)
    free = ~model.fixed[block]
    carried[free] = whole[block[free]]
    return Holding(block=block, number=number, carried=carried, whole=whole)


def reactions_of(context: StepContext, solution: StepSolution, held: Holding) -> Floats:
    """Return the reactions of a step (k, 3): forces (x, y), N/m, and moments, N."""
    wanted = context.model.reactions
    reactions = np.zeros((len(wanted.name), 3))
    if not reactions.size:
        return reactions
    centroid = context.frames.centroid
    if wanted.of_block.size:
        row = held.number[wanted.of_block[:, 1]]
        _add(reactions, wanted.about, wanted.of_block, held.carried[row], centroid)
        if solution.driven is not None:
            rows = wanted.of_block[:, 1]
            struck = solution.driven[rows, :3] / context.step
            _add(reactions, wanted.about, wanted.of_block, struck, centroid)
    if wanted.of_ground.size and context.springs is not None:
        number = np.append(np.full(context.model.block_count, -1), 0)
        force = -_of_springs(context.springs, solution, number, 1)
        # the ground counts from the origin, as from a centroid (actions/links.py)
        _add(reactions, wanted.about, wanted.of_ground, force, np.zeros((1, 2)))
    shares = zip(context.actions, context.action_states, context.contributions, strict=True)
    for action, own, contribution in shares:
        support = getattr(action, "support", "")
        if support == "motions" and contribution.block.size:
            every = np.arange(len(contribution.block))
            sums = np.zeros((context.model.block_count, 3))
            force = forces_in(contribution, solution.unknowns, every)[:, :3]
            np.add.at(sums, contribution.block, force)
            force = sums[wanted.of_block[:, 1]]
            _add(reactions, wanted.about, wanted.of_block, force, centroid)
        pairs = _supporting(wanted, support, own)
        if not pairs.size:
            continue
        # what held an excavated block holds nothing any more
        pairs = pairs[~context.model.absent[contribution.block[pairs[:, 1]]]]
        if pairs.size:
            force = forces_in(contribution, solution.unknowns, pairs[:, 1])[:, :3]
            pairs[:, 1] = contribution.block[pairs[:, 1]]
            _add(reactions, wanted.about, pairs, force, centroid)
    return reactions


def _supporting(wanted: Reactions, support: str, own: Any) -> Ints:
    """Return reactions and the rows of an action's contribution that belong to them, (r, 2)."""
    if support == "fixed points":
        return wanted.of_fixed_point
    if support == "viscous edges":
        return wanted.of_viscous_edge
    if support == "outline" and wanted.of_outline.size:
        return np.asarray(own.of_edges(wanted.of_outline))
    return NO_ROWS


def _add(reactions: Floats, about: Floats, pairs: Ints, force: Floats, centroid: Floats) -> None:
    """Add forces and moments (b, 3) of blocks to those of reactions (k, 3), in place.

    ``pairs`` (b, 2) are reactions and blocks; moments are taken about points of the reactions.
    """
    arm = centroid[pairs[:, 1]] - about[pairs[:, 0]]
    moved = force.copy()
    moved[:, 2] += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    np.add.at(reactions, pairs[:, 0], moved)


def forces_in(contribution: Contribution, unknowns: Floats, rows: Ints) -> Floats:
    """Return the generalised forces f - K d of some rows of a contribution, shape (r, 6)."""
    force = contribution.force[rows]
    if contribution.stiffness is None:
        return force
    bent = np.einsum("kij,kj->ki", contribution.stiffness[rows], unknowns[contribution.block[rows]])
    return np.asarray(force - bent)


def _of_springs(springs: Springs, solution: StepSolution, number: Ints, count: int) -> Floats:
    """Return force and moment (count, 3) of springs on the blocks that have a ``number`` (n,)."""
    of = Solution(
        displacement=solution.unknowns,
        points=NOTHING,
        linearised_at=solution.linearised_at,
    )
    return _of_links(number, count, springs, of.spring_forces(springs))


def _of_links(
    number: Ints, count: int, links: PairedLinks, forces: tuple[Floats, Floats]
) -> Floats:
    """Return force and moment (count, 3) of links on the blocks that have a ``number`` (n,)."""
    sums: Floats = _sums(number, count, links.vertex_block, links.edge_block, links.arms, forces)
    return sums


@kernel()
def _sums(number, count, vertex_block, edge_block, arms, forces):
    """Return force (x, y), N/m, and moment, N, of links on blocks with a number >= 0, (count, 3).

    Moments are about the centroids; ``forces`` are N and T (m,), N/m, on the first block.
    """
    sums = np.zeros((count, 3))
    normal, shear = forces
    for c in range(len(vertex_block)):
        i, j = number[vertex_block[c]], number[edge_block[c]]
        if i < 0 and j < 0:
            continue
        nx, ny = arms[c, 0], arms[c, 1]
        fx, fy = normal[c] * nx - shear[c] * ny, normal[c] * ny + shear[c] * nx
        if i >= 0:
            sums[i, 0] += fx
            sums[i, 1] += fy
            sums[i, 2] += arms[c, 2] * fy - arms[c, 3] * fx
        if j >= 0:
            sums[j, 0] -= fx
            sums[j, 1] -= fy
            sums[j, 2] -= arms[c, 4] * fy - arms[c, 5] * fx
    return sums
