"""Contacts of one step as flat arrays, and the answer of a contact law."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from clast.contact.jacobian import rows_of
from clast.model.model import Bools, Floats, Ints
from clast.model.state import ContactHistory


@dataclass(frozen=True, kw_only=True, repr=False)
class Places:
    """Where contacts are; m contacts in the order of their pairs of blocks."""

    vertex: Ints
    """Vertex P, or the first vertex of the edge that P lies inside, shape (m,)."""
    edge: Ints
    """Entrance edge: index of its first vertex, shape (m,)."""
    vertex_block: Ints
    """Block of P, shape (m,)."""
    edge_block: Ints
    """Block of the edge, shape (m,)."""
    pair: Ints
    """Index of the pair of blocks, shape (m,)."""
    point: Ints
    """0 for a vertex, 1 to 13 for the points inside a face, shape (m,)."""
    along: Floats
    """Place of P on the edge that begins at ``vertex``, as a fraction of its length, (m,)."""
    gap: Floats
    """Signed distance of P to the edge's line, m, shape (m,)."""
    foot: Floats
    """Foot Q of P on the edge's line, m, shape (m, 2)."""
    arms: Floats
    """Normal, and offsets of P and Q from the centroids (contact/jacobian.py), m, shape (m, 6)."""
    joint: Ints
    """Joint that the contact lies along: index into those of the model, shape (m,)."""
    length: Floats
    """Length of joint that the contact stands for (cohesion, tensile strength), m, shape (m,)."""
    spring_length: Floats
    """Length that its springs stand for, m, above 0 where a tip touches, shape (m,)."""
    row: Ints
    """Row of the contact in the memory, or -1, shape (m,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Contacts(Places, ContactHistory):
    """Vertex-edge contacts of one step, in order of block pairs; m contacts, q touching pairs.

    ``gap`` and ``arms`` belong to the start of the step: the gap at its end is gap + n_i.d_i +
    n_j.d_j to first order in the displacements of the vertex's block i and the edge's block j; the
    slip of the vertex along the edge is t_i.d_i + t_j.d_j (see ``rows``).  ``gap`` is less
    ``rest_gap``, negative where the spring is pressed.  The history is that remembered from the
    last step.
    """

    pairs: Ints
    """Pairs of blocks (lower, higher) that share contacts, sorted, shape (q, 2)."""
    rest_gap: Floats
    """Opening at which the normal spring has no force, m: 0 but for joints that open as they slide
    and rough ones, shape (m,)."""
    normal: Floats
    """Outward unit normal of the edge, shape (m, 2)."""
    normal_stiffness: Floats
    """Normal stiffness that the joint gives, N/m per m; nan: the law has its own, shape (m,)."""
    shear_stiffness: Floats
    """Shear stiffness that the joint gives, N/m per m; nan: the law has its own, shape (m,)."""
    spring_share: Floats
    """Fraction of the springs of the law that the contact has where its joint gives none, (m,)."""
    friction: Floats
    """tan(friction angle) of the joint, shape (m,)."""
    cohesion: Floats
    """Cohesion that the contact has now, Pa: all, the residual one or none, shape (m,)."""
    residual_cohesion: Floats
    """Cohesion that slip leaves, Pa; nan: slip leaves the bond whole, shape (m,)."""
    tensile_strength: Floats
    """Tensile strength of the joint while bonded, Pa (0 once broken), shape (m,)."""
    known: Bools
    """True where the contact memory held this contact, shape (m,)."""
    mobilises: Bools
    """True where the shear spring is the rising branch of a roughness, shape (m,)."""
    friction_base: Floats
    """Normal force that bounds friction, N/m; nan: the force of the moment, shape (m,)."""

    @property
    def ground(self) -> int:
        """-1: none is with the ground beside its blocks (clipped_spring.Springs)."""
        return -1

    def __len__(self) -> int:
        return len(self.vertex)

    @property
    def corners(self) -> Bools:
        """True where P is a vertex, shape (m,)."""
        return np.asarray(self.point == 0)

    @property
    def rows(self) -> Floats:
        """Contact Jacobian n_i, n_j, t_i, t_j: T_i^T n, -T_j^T n, T_i^T t, -T_j^T t, (m, 4, 6)."""
        return rows_of(self.arms)

    def __repr__(self) -> str:
        nearest = f", smallest gap {self.gap.min():.3g} m" if len(self) else ""
        return f"Contacts({len(self)} between {len(self.pairs)} pairs of blocks{nearest})"


def chosen(contacts: Contacts, kept: Bools) -> Contacts:
    """Return the contacts that are ``kept`` (m,); pairs of blocks stay, were it without any."""
    names = (one.name for one in fields(contacts) if one.name != "pairs")
    return replace(contacts, **{name: getattr(contacts, name)[kept] for name in names})


@dataclass(frozen=True, kw_only=True, repr=False)
class ContactResponse:
    """Forces of the contacts at the end of a step and how they change with gap and slip.

    The law is linear about the evaluated point: N = normal_force - normal_stiffness (gap' - gap),
    T = shear_force - shear_stiffness (slip' - slip) + coupling (N' - N).
    """

    normal_force: Floats
    """Normal force N, N/m, compression positive, shape (m,)."""
    shear_force: Floats
    """Shear force T on the vertex along the edge's direction, N/m, shape (m,)."""
    normal_stiffness: Floats
    """-dN/dgap, N/m per m, shape (m,)."""
    shear_stiffness: Floats
    """-dT/dslip, N/m per m, shape (m,)."""
    coupling: Floats
    """dT/dN of sliding friction solved inside the step (signed tan phi, else 0), shape (m,)."""
    mode: Ints
    """0 open, 1 slide, 2 lock, shape (m,)."""
    bonded: Bools
    """True while cohesion and tensile strength are intact, shape (m,)."""
    energy: Floats
    """Energy in the contact's springs, J/m, shape (m,)."""
    dissipation: Floats
    """Work lost in sliding during the step, J/m, >= 0, shape (m,)."""

    def __repr__(self) -> str:
        count, most = np.size(self.normal_force), np.max(self.normal_force, initial=0.0)
        return f"ContactResponse({count} contacts, normal force at most {most:.4g} N/m)"


@dataclass(frozen=True)
class SpringLimits:
    """Linear springs with bounds: offered by a law whose forces are clipped straight lines.

    N = max(-tension, rest_force + multiplier - p gap), T = shear_force - k slip within +-strength.
    """

    normal_stiffness: Floats
    """p, N/m per m, shape (m,)."""
    shear_stiffness: Floats
    """k, N/m per m, shape (m,)."""
    tension: Floats
    """Tension that the contact carries, N/m, >= 0, shape (m,)."""
    strength: Floats
    """Largest shear force, N/m, >= 0, shape (m,)."""


OPEN, SLIDE, LOCK = 0, 1, 2
"""Modes of a contact (Shi 1988)."""
