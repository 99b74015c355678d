"""The block-sparse system K d = F of one pass, assembled from its contributions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.contact.clipped_spring import Forces, Springs
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import StepOutcome, StepRejected
from clast.linear import assembly, block_matrix
from clast.model.model import Bools, Floats, Ints

Rows = tuple[Ints, Ints, Ints]
"""Right (n + 1,), left (n + 1,) and listed (q,) of pairs (linear/block_matrix.py)."""
Graph = tuple[Ints, Ints, Ints, Ints]
"""First contact of each pair (q + 1,), then the Rows of the pairs."""
PairedLinks = Contacts | Springs
"""Links between points of two blocks, in the order of the pairs of blocks."""
LinearisedForces = ContactResponse | Forces
"""Forces of links, linearised (see ContactResponse)."""


@dataclass(frozen=True, kw_only=True)
class DiagonalTerms:
    """Block diagonal and right-hand side: everything of a step but the contacts."""

    diagonal: Floats
    """Diagonal 6 x 6 blocks of K, shape (n, 6, 6)."""
    force: Floats
    """Right-hand side, shape (n, 6)."""
    momentum: Floats
    """The part of it that is momentum, M/(theta h2) drift, shape (n, 6)."""
    centroid: Floats
    """Centroids of the blocks, m, shape (n, 2)."""


def with_ground(values: Any, ground: Any = 0) -> Any:
    """Return ``values`` of blocks, shape (n, ...), and those of the ground, (n + 1, ...)."""
    return np.concatenate([values, np.full_like(values[:1], ground)])


@dataclass(frozen=True, kw_only=True)
class BlockSystem:
    """6 x 6 blocks of symmetric K and the right-hand side; pairs (i, j) with i < j, sorted."""

    diagonal: Floats
    """K_ii, shape (n, 6, 6)."""
    pairs: Ints
    """Coupled blocks (i, j), i < j, shape (q, 2)."""
    rows: Rows
    """Which pairs each block belongs to."""
    upper: Floats
    """K_ij, shape (q, 6, 6)."""
    fixed: Bools
    """Blocks whose equations read d = 0 and which are coupled to none, shape (n,)."""
    force: Floats
    """F, shape (n, 6)."""
    centroid: Floats
    """Where the blocks are, m, shape (n, 2)."""


def graph_of(contacts: PairedLinks, count: int) -> Graph:
    """Return which pairs ``count`` blocks belong to and which contacts those have."""
    graph: Graph = assembly.graph(max(count, contacts.ground + 1), contacts.pairs, contacts.pair)
    return graph


def inverse_of_blocks(diagonal: Floats) -> Floats:
    """Return the inverses of positive definite blocks (n, 6, 6); raises StepRejected for others."""
    inverse: Floats
    inverse, bad = block_matrix.inverse_blocks(diagonal)
    if bad >= 0:
        raise StepRejected(StepOutcome.SINGULAR, f"equations of block {bad + 1}")
    return inverse


def contact_motions(contacts: PairedLinks, displacement: Floats) -> tuple[Floats, Floats]:
    """Return how far each contact opens and slips by d (n, 6), m, shape (m,): n.d and t.d."""
    if len(displacement) == contacts.ground:
        displacement = with_ground(displacement)
    return assembly.contact_motions(
        contacts.vertex_block, contacts.edge_block, contacts.arms, displacement
    )


def stretches(springs: Springs, displacement: Floats) -> tuple[Floats, Floats]:
    """Return gap and slip of the links of springs (m,), m, after d (n, 6)."""
    opening, slip = contact_motions(springs, displacement)
    return springs.gap + opening, springs.slip + slip


def gap_at_end(contacts: Contacts, displacement: Floats) -> Floats:
    """Return the gap of each contact at the end of the step, m, shape (m,): gap + n.d."""
    return contacts.gap + contact_motions(contacts, displacement)[0]


def slip_in_step(contacts: Contacts, displacement: Floats) -> Floats:
    """Return the slip of each contact in the step, m, shape (m,): t.d."""
    return contact_motions(contacts, displacement)[1]


def gap_rate(contacts: Contacts, velocity: Floats) -> Floats:
    """Return the rate of each gap, m/s, shape (m,): n.v; negative where a contact closes."""
    return contact_motions(contacts, velocity)[0]


def with_contact_forces(
    force: Floats, contacts: PairedLinks, graph: Graph, fixed: Bools, normal: Floats, shear: Floats
) -> Floats:
    """Return ``force`` (n, 6) plus N n + T t of forces (m,), N/m; 0 for fixed blocks."""
    count = len(force)
    if count == contacts.ground:
        force, fixed = with_ground(force), with_ground(fixed, True)
    links = graph, contacts.vertex_block, contacts.arms, normal, shear
    return np.asarray(assembly.loaded(force, fixed, *links)[:count])


def with_ground_for(
    links: PairedLinks, base: DiagonalTerms, fixed: Bools
) -> tuple[DiagonalTerms, Bools]:
    """Return the terms of ``fixed`` (n,) and other blocks, and of the ground where links hold on.

    It comes last, and is fixed.
    """
    if links.ground != len(fixed):
        return base, fixed
    terms = DiagonalTerms(
        diagonal=with_ground(base.diagonal, np.eye(6)),
        force=with_ground(base.force),
        momentum=with_ground(base.momentum),
        centroid=with_ground(base.centroid, base.centroid[:1]),
    )
    return terms, with_ground(fixed, True)


def symmetric_system(
    base: DiagonalTerms,
    contacts: PairedLinks,
    response: LinearisedForces,
    force: Floats,
    fixed: Bools,
    graph: Graph,
) -> BlockSystem:
    """Return the system of contact springs alone with right-hand side ``force`` (n, 6).

    ``force`` is 0 for fixed blocks already; ``graph`` that of the contacts.
    """
    stiffnesses = response.normal_stiffness, response.shear_stiffness
    diagonal, upper = assembly.assemble(
        base.diagonal,
        fixed,
        contacts.pairs,
        graph,
        (contacts.vertex_block, contacts.arms, *stiffnesses),
    )
    return BlockSystem(
        diagonal=diagonal,
        pairs=contacts.pairs,
        rows=graph[1:],
        upper=upper,
        fixed=fixed,
        force=force,
        centroid=base.centroid,
    )


def assemble(
    base: DiagonalTerms,
    contacts: PairedLinks,
    response: LinearisedForces,
    gap: Floats,
    slip: Floats,
    fixed: Bools,
) -> BlockSystem:
    """Return the system with the contact law linearised about (gap, slip) at the end of the step.

    ``gap`` and ``slip`` (m,) are where ``response`` was evaluated, in m; F then holds the forces
    that the linearised law gives at d = 0.  Where links hold on to the ground that is the last of
    its blocks.
    """
    base, fixed = with_ground_for(contacts, base, fixed)
    # N(d) = N - k_n (gap0 + n.d - gap), so at d = 0:
    offset = contacts.gap - gap
    normal_load = response.normal_force - response.normal_stiffness * offset
    shear_load = response.shear_force + response.shear_stiffness * slip
    graph = graph_of(contacts, len(fixed))
    force = with_contact_forces(base.force, contacts, graph, fixed, normal_load, shear_load)
    return symmetric_system(base, contacts, response, force, fixed, graph)
