"""The block-sparse system K d = F of one pass, assembled from its contributions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from clast.contact.clipped_spring import Springs
from clast.contact.contacts import Contacts
from clast.errors import StepOutcome, StepRejected
from clast.linear import assembly
from clast.linear import block_matrix as block_rows
from clast.linear import residual as balance
from clast.linear.couplings import Blocks, Couplings, Graph, Rows
from clast.linear.couplings import Springs as Kept
from clast.model.model import Bools, Floats, Ints


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


class Bearing(Protocol):
    """What links between blocks bear, linearised (see ContactResponse); each of shape (m,)."""

    @property
    def normal_force(self) -> Floats:
        """N, N/m."""
        ...

    @property
    def shear_force(self) -> Floats:
        """T, N/m."""
        ...

    @property
    def normal_stiffness(self) -> Floats:
        """-dN/dgap, N/m per m."""
        ...

    @property
    def shear_stiffness(self) -> Floats:
        """-dT/dslip, N/m per m."""
        ...

    @property
    def coupling(self) -> Floats:
        """dT/dN."""
        ...


@dataclass(frozen=True, kw_only=True)
class BlockSystem:
    """6 x 6 blocks of K and the right-hand side; pairs (i, j) with i < j, sorted."""

    diagonal: Floats
    """K_ii, shape (n, 6, 6)."""
    pairs: Ints
    """Coupled blocks (i, j), i < j, shape (q, 2)."""
    rows: Rows
    """Which pairs each block belongs to."""
    couplings: Couplings
    """K_ij and K_ji."""
    symmetric: bool
    """True where K_ji is the transpose of K_ij: unless friction is solved inside the step."""
    force: Floats
    """F, shape (n, 6)."""
    centroid: Floats
    """Where the blocks are, m, shape (n, 2)."""

    @property
    def upper(self) -> Floats:
        """K_ij, shape (q, 6, 6)."""
        return self.couplings.upper

    @property
    def lower(self) -> Floats:
        """K_ji, shape (q, 6, 6)."""
        return self.couplings.lower


def graph_of(contacts: Contacts | Springs, count: int) -> Graph:
    """Return which pairs ``count`` blocks belong to and which contacts those have."""
    graph: Graph = assembly.graph(count, contacts.pairs, contacts.pair)
    return graph


def inverse_of_blocks(diagonal: Floats) -> Floats:
    """Return the inverses of positive definite blocks (n, 6, 6); raises StepRejected for others."""
    inverse, bad = block_rows.inverse_blocks(diagonal)
    if bad >= 0:
        raise StepRejected(StepOutcome.SINGULAR, f"equations of block {bad + 1}")
    return np.asarray(inverse)


class Links(Protocol):
    """Links between points of two blocks, as contacts are, in the order of the pairs of blocks."""

    @property
    def vertex_block(self) -> Ints:
        """Block of the first point, shape (m,)."""
        ...

    @property
    def edge_block(self) -> Ints:
        """Block of the other point, shape (m,)."""
        ...

    @property
    def levers(self) -> Floats:
        """What they are in the equations (contact/jacobian.py)."""
        ...

    @property
    def pairs(self) -> Ints:
        """Pairs of blocks (lower, higher) that share links, sorted, shape (q, 2)."""
        ...


class Stiffnesses(Protocol):
    """How stiff the springs of links are."""

    @property
    def normal_stiffness(self) -> Floats:
        """-dN/dgap, N/m per m, shape (m,)."""
        ...

    @property
    def shear_stiffness(self) -> Floats:
        """-dT/dslip, N/m per m, shape (m,)."""
        ...

    @property
    def coupling(self) -> Floats:
        """dT/dN, shape (m,), or (0,) where it is 0."""
        ...


def contact_motions(contacts: Links, displacement: Floats) -> tuple[Floats, Floats]:
    """Return how far each contact opens and slips by d (n, 6), m, shape (m,): n.d and t.d."""
    return assembly.contact_motions(
        contacts.vertex_block, contacts.edge_block, contacts.levers, displacement
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
    force: Floats,
    contacts: Contacts | Springs,
    graph: Graph,
    fixed: Bools,
    normal: Floats,
    shear: Floats,
) -> Floats:
    """Return ``force`` (n, 6) plus N n + T t of forces (m,), N/m; 0 for fixed blocks."""
    return balance.loaded(
        force, fixed, graph, contacts.vertex_block, contacts.levers, normal, shear
    )


def _with_contacts(
    base: DiagonalTerms,
    force: Floats,
    contacts: Contacts | Springs,
    response: Bearing,
    loads: tuple[Floats, Floats],
    fixed: Bools,
) -> BlockSystem:
    """Return the system with contact stiffness and loads (m,) added, fixed blocks held."""
    if not response.coupling.any():
        graph = graph_of(contacts, len(fixed))
        force = with_contact_forces(force, contacts, graph, fixed, *loads)
        return symmetric_system(base, contacts, response, force, fixed, graph)
    diagonal, force = base.diagonal.copy(), force.copy()
    upper = np.zeros((len(contacts.pairs), 6, 6))
    lower = np.zeros_like(upper)
    assembly.add_contacts(
        diagonal,
        upper,
        lower,
        force,
        contacts.pair,
        contacts.vertex_block,
        contacts.edge_block,
        contacts.rows,
        response.normal_stiffness,
        response.shear_stiffness,
        response.coupling,
        *loads,
    )
    assembly.hold_blocks(diagonal, upper, lower, force, contacts.pairs, fixed)
    return BlockSystem(
        diagonal=diagonal,
        pairs=contacts.pairs,
        rows=block_rows.row_pointers(len(diagonal), contacts.pairs),
        couplings=Blocks(upper=upper, lower=lower),
        symmetric=False,
        force=force,
        centroid=base.centroid,
    )


def symmetric_system(
    base: DiagonalTerms,
    contacts: Links,
    response: Stiffnesses,
    force: Floats,
    fixed: Bools,
    graph: Graph,
) -> BlockSystem:
    """Return the system of contact springs alone with right-hand side ``force`` (n, 6).

    ``force`` is 0 for fixed blocks already; ``graph`` that of the contacts.
    """
    diagonal = np.empty_like(base.diagonal)
    stiffnesses = response.normal_stiffness, response.shear_stiffness
    vertex_block, levers = contacts.vertex_block, contacts.levers
    coupled, share, least = assembly.assemble(
        base.diagonal, fixed, contacts.pairs, graph, vertex_block, levers, *stiffnesses, diagonal
    )
    return BlockSystem(
        diagonal=diagonal,
        pairs=contacts.pairs,
        rows=graph[1:],
        couplings=Kept(
            graph=graph,
            vertex_block=vertex_block,
            levers=levers,
            normal_stiffness=stiffnesses[0],
            shear_stiffness=stiffnesses[1],
            coupled=coupled,
            shares=(share, least),
        ),
        symmetric=True,
        force=force,
        centroid=base.centroid,
    )


def assemble(
    base: DiagonalTerms,
    contacts: Contacts | Springs,
    response: Bearing,
    gap: Floats,
    slip: Floats,
    fixed: Bools,
) -> BlockSystem:
    """Return the system with the contact law linearised about (gap, slip) at the end of the step.

    ``gap`` and ``slip`` (m,) are where ``response`` was evaluated, in m; F then holds the forces
    that the linearised law gives at d = 0.
    """
    # N(d) = N - k_n (gap0 + n.d - gap), so at d = 0:
    offset = contacts.gap - gap
    normal_load = response.normal_force - response.normal_stiffness * offset
    shear_load = (
        response.shear_force
        + response.shear_stiffness * slip
        + response.coupling * (normal_load - response.normal_force)
    )
    loads = normal_load, shear_load
    return _with_contacts(base, base.force, contacts, response, loads, fixed)
