"""The forces on each block that nothing balances.

The unbalanced force sets a block in motion: it is its mass times its acceleration, and the residual
of the equations of the step.  Both together are the sum of the forces as they are at the end of the
step: of contacts, weight, loads, supports and bolts.  Forces of damping are none of them; they are
those of the blocks as if they stood still.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.block.inertia import BlockFrames
from clast.block.rotation import turned_by
from clast.linear.system import PairedLinks, graph_of, with_contact_forces
from clast.model.model import Floats, Ints, Model
from clast.model.state import State
from clast.step.method import Method, StepResult
from clast.step.search_distance import search_within_step, travel_expected
from clast.step.start import begin, diagonal_terms


@dataclass(frozen=True, kw_only=True)
class ForceSums:
    """Forces on each block, added up."""

    total: Floats
    """Their sum: force (x, y), N/m, and moment about the centroid, N, shape (n, 3)."""
    unbalanced: Floats
    """Its size, the moment divided by the radius of gyration, N/m, shape (n,)."""
    size: Floats
    """Sum of their sizes, N/m, shape (n,)."""


def mean_movement(movement: Floats, block_start: Ints) -> Floats:
    """Return the mean movement (n, 2) of the corners of each block from that of all (nv, 2)."""
    mean = np.add.reduceat(movement, block_start[:-1], axis=0) / np.diff(block_start)[:, None]
    return np.asarray(mean)


def angle_of(vector: Floats) -> float:
    """Return the direction of a vector (2,), degrees from +x."""
    return float(np.degrees(np.arctan2(vector[1], vector[0])))


class _Sums:
    """Forces and moments of blocks as they are added up."""

    def __init__(self, frames: BlockFrames) -> None:
        mass = frames.mass_matrix[:, 0, 0]
        self.mass = mass
        self.gyration = np.sqrt(frames.mass_matrix[:, 2, 2] / mass)
        self.force = np.zeros((len(mass), 3))
        self.size = np.zeros(len(mass))

    def add(self, block: Ints, force: Floats, moment: Floats) -> None:
        """Add forces (k, 2), N/m, and moments (k,), N, on blocks (k,); none on the ground."""
        count = len(self.mass)
        for part, values in enumerate((force[:, 0], force[:, 1], moment)):
            self.force[:, part] += np.bincount(block, values, count)[:count]
        self.size += np.bincount(block, np.hypot(*force.T), count)[:count]

    def add_pairs(
        self, blocks: tuple[Ints, Ints], arms: Floats, forces: tuple[Floats, Floats]
    ) -> None:
        """Add N and T (m,), N/m, of links between two blocks with arms (m, 6)."""
        nx, ny = arms[:, 0], arms[:, 1]
        normal, shear = forces
        force = np.stack([normal * nx - shear * ny, normal * ny + shear * nx], axis=1)
        for block, sign, x, y in (
            (blocks[0], 1.0, arms[:, 2], arms[:, 3]),
            (blocks[1], -1.0, arms[:, 4], arms[:, 5]),
        ):
            self.add(block, sign * force, sign * (x * force[:, 1] - y * force[:, 0]))

    def result(self) -> ForceSums:
        """Return the sums."""
        turning = self.force[:, 2] / self.gyration
        out = np.sqrt(self.force[:, 0] ** 2 + self.force[:, 1] ** 2 + turning**2)
        return ForceSums(total=self.force, unbalanced=out, size=self.size)


def out_of_balance(model: Model, method: Method, state: State, step: float) -> Floats:
    """Return the sum of all generalised forces on each block at a state, N/m and N, (n, 6)."""
    method = replace(method, clock=0.0)
    context = begin(
        model, method, replace(state, velocity=np.zeros_like(state.velocity)), step, None
    )
    base = diagonal_terms(context, np.zeros_like(context.velocity), context.scheme)
    contacts = context.contacts(search_within_step(method, travel_expected(context)))
    forces, fixed, springs = base.force, model.fixed, context.springs
    links: list[tuple[PairedLinks, Floats, Floats]]
    links = [(contacts, contacts.normal_force, contacts.shear_force)]
    if springs is not None:
        carried = springs.at(springs.gap, springs.slip)
        links.append((springs, carried.normal_force, carried.shear_force))
    for ends, normal, shear in links:
        graph = graph_of(ends, model.block_count)
        forces = with_contact_forces(forces, ends, graph, fixed, normal, shear)
    forces[fixed] = 0.0
    if context.held is not None:
        forces[context.held.components] = 0.0
    return forces


def forces_of(
    model: Model, method: Method, states: tuple[State, StepResult], step: float
) -> ForceSums:
    """Return the forces on each block at the end of a step, on the blocks as they stand there.

    Loads are those of a step of ``step`` s more, so that loads that change are out of balance.
    """
    before, result = states
    still = replace(result.state, velocity=np.zeros_like(result.state.velocity))
    context = begin(model, method, still, step, None)
    sums = _Sums(context.frames)
    contacts, response = result.contacts, result.response
    # The arms (m, 6) of contacts at the end of a step in which blocks turned, rad, (n,).
    turn = result.state.rotation - before.rotation
    own, other = contacts.vertex_block, contacts.edge_block
    normal = turned_by(contacts.arms[:, :2], turn[other])
    offset = turned_by(contacts.arms[:, 2:4], turn[own])
    sums.add_pairs(
        (contacts.vertex_block, contacts.edge_block),
        np.hstack(
            [normal, offset, offset + context.frames.centroid[own] - context.frames.centroid[other]]
        ),
        (response.normal_force, response.shear_force),
    )
    everybody = np.arange(model.block_count)
    for share in context.contributions:
        if share.acceleration is not None:
            sums.add(everybody, sums.mass[:, None] * share.acceleration, np.zeros(len(everybody)))
        if len(share.block):
            sums.add(share.block, share.force[:, :2], share.force[:, 2])
    if context.springs is not None:
        springs = context.springs
        of_springs = springs.at(springs.gap, springs.slip)
        sums.add_pairs(
            (springs.vertex_block, springs.edge_block),
            springs.arms,
            (of_springs.normal_force, of_springs.shear_force),
        )
    if context.held is not None:
        # what is out of balance there is the reaction
        sums.force[context.held.components[:, :3]] = 0.0
    return sums.result()
