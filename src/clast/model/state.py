"""The state of a run at one instant: replaced at every accepted step, never edited."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from functools import reduce
from operator import add, attrgetter
from typing import Any

import numpy as np

from clast.model.arrays import no_bools, no_floats, no_ints
from clast.model.model import Bools, Floats, Ints, Model
from clast.read_only import seal

POINT_NUMBERS = 14
"""Numbers that points of a contact may have."""


@dataclass(frozen=True, kw_only=True, repr=False)
class ContactHistory:
    """History of a contact, carried from step to step."""

    normal_force: Floats = no_floats()
    """Normal contact force at the end of the step, N/m, compression positive, shape (k,)."""
    shear_force: Floats = no_floats()
    """Shear force on the vertex along the edge's direction, N/m, shape (k,)."""
    multiplier: Floats = no_floats()
    """Lagrange multiplier of the normal force, N/m (0 with the penalty law), shape (k,)."""
    rest_force: Floats = no_floats()
    """Normal force at zero gap that was there at the start (in-situ stress), N/m, shape (k,)."""
    slip: Floats = no_floats()
    """Way of the vertex along the edges since the contact was made, m, to the left as seen from
    the block of the edge; it has the same sign seen from the other block, shape (k,)."""
    slide_length: Floats = no_floats()
    """Length of the path that the contact has slid to and fro, without the part that its shear
    spring recovers, m, >= 0, shape (k,)."""
    slide: Floats = no_floats()
    """The same with the sign of ``slip``: sliding back is subtracted, shape (k,)."""
    slide_speed: Floats = no_floats()
    """Speed of sliding in the last step, m/s, >= 0, 0 in statics, shape (k,)."""
    dilation: Floats = no_floats()
    """Opening that sliding has brought about, m, >= 0, shape (k,)."""
    mode: Ints = no_ints()
    """0 open, 1 slide, 2 lock, shape (k,)."""
    bonded: Bools = no_bools()
    """True while cohesion and tensile strength are intact, shape (k,)."""
    cohesive: Bools = no_bools()
    """True while the contact is bonded, or has slipped but not opened since, shape (k,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class ContactMemory(ContactHistory):
    """Memory of a contact from step to step, keyed by (vertex, block of the edge).

    Sorted by vertex, then by the block of the edge, then by edge.  At a re-entrant corner one key
    may hold two rows, told apart by their edge.  Points inside faces (contact/joints/faces.py) come
    after all vertices; their key is the first vertex of their own edge, the other edge and their
    number.
    """

    vertex: Ints = no_ints()
    """Invading vertex, shape (k,)."""
    block: Ints = no_ints()
    """Block that owns the entrance edge, shape (k,)."""
    edge: Ints = no_ints()
    """Entrance edge (index of its first vertex), shape (k,)."""
    point: Ints = no_ints()
    """0 for a vertex, 1 to 13 for the points inside a face, shape (k,)."""
    gap: Floats = no_floats()
    """Gap at the end of the step, m, negative in penetration, shape (k,)."""

    def __len__(self) -> int:
        return len(self.vertex)

    @property
    def corner_count(self) -> int:
        """Number of rows of vertices, which come first."""
        return len(self) - int(np.count_nonzero(self.point))

    @property
    def corners(self) -> ContactMemory:
        """The rows of vertices alone."""
        if len(self.point) == 0 or self.point[-1] == 0:
            return self
        count = self.corner_count
        return ContactMemory(**{one.name: getattr(self, one.name)[:count] for one in fields(self)})

    def keys(self, count: int) -> Ints:
        """Return a number for each row, ascending, (k,), of a system of ``count`` vertices."""
        return contact_keys(self.vertex, self.edge, self.point, count)

    def __repr__(self) -> str:
        return f"ContactMemory({len(self)} contacts)"


def contact_keys(vertex: Ints, edge: Ints, point: Ints, count: int) -> Ints:
    """Return a number for each contact (k,) that no other has, of a system of ``count`` vertices.

    In the order of the contact memory.
    """
    inside = point > 0
    return np.asarray(((inside * count + vertex) * count + edge) * POINT_NUMBERS + point)


class Kind(Enum):
    """Kinds of entries of the energy ledger."""

    STORED = "stored"
    """Energy in the system now."""
    BROUGHT = "brought in"
    """Energy that has come in from outside since the start."""
    LOST = "lost"
    """Energy lost since the start, but for that which the time integration removed."""
    NUMERICAL = "numerical"
    """Energy that the time integration removed, less that which it brought in."""
    UNEXPLAINED = "unexplained"
    """The remainder that the others fail to explain."""


def entry(kind: Kind) -> Any:
    """Return an entry of the ledger, J/m, of a kind."""
    return field(default=0.0, metadata={"kind": kind})


@dataclass(frozen=True, kw_only=True)
class Ledger:
    """The energy of the system and where it went, J per metre of thickness.

    Stored energies are those of the instant, all others are sums since the start.  Stored energy,
    less the energy ``brought`` in, plus the ``lost`` energy, stays at its first value but for
    ``unaccounted``, which is measured, not assumed.  Each entry has its kind (``LEDGER``); sums,
    warnings, the result file and its reference follow from that.
    """

    kinetic: float = entry(Kind.STORED)
    """Kinetic energy 1/2 v.M v."""
    elastic: float = entry(Kind.STORED)
    """Strain energy of the blocks."""
    gravity: float = entry(Kind.STORED)
    """Potential energy of gravity, zero at the start."""
    contact: float = entry(Kind.STORED)
    """Energy in the normal and shear contact springs."""
    fixed_points: float = entry(Kind.STORED)
    """Energy in the springs of the fixed points."""
    bolts: float = entry(Kind.STORED)
    """Elastic energy in the bolts."""
    links: float = entry(Kind.STORED)
    """Elastic energy in the links."""
    water_stored: float = entry(Kind.STORED)
    """Elastic energy in the water of joints, of "full" coupling."""
    loads: float = entry(Kind.BROUGHT)
    """Work done by loads and pressures and by the ground motion."""
    water: float = entry(Kind.BROUGHT)
    """Work done by water."""
    motions: float = entry(Kind.BROUGHT)
    """Work done by prescribed motions and their servos."""
    friction: float = entry(Kind.LOST)
    """Work lost in sliding, >= 0 (and in the breaking of bonds)."""
    impacts: float = entry(Kind.LOST)
    """Energy lost in impacts: by restitution, and by friction within them."""
    yielding: float = entry(Kind.LOST)
    """Work lost in bolts and links that yield or break, >= 0."""
    damping: float = entry(Kind.LOST)
    """Energy taken by damping, >= 0."""
    boundary: float = entry(Kind.LOST)
    """Energy that left through viscous boundaries, less that which came in through them."""
    seepage: float = entry(Kind.LOST)
    """Energy that water has lost flowing in joints, of "full" coupling."""
    removed: float = entry(Kind.LOST)
    """Energy that was taken out with blocks, or by resets, when stages began."""
    actions: float = entry(Kind.STORED)
    """Energy that further actions store, and their losses."""
    numerical: float = entry(Kind.NUMERICAL)
    """Energy removed by the time integration (positive) or brought in by it (negative)."""
    unaccounted: float = entry(Kind.UNEXPLAINED)
    """The remainder that the entries above fail to explain."""

    @property
    def stored(self) -> float:
        """Energy in the system now."""
        return reduce(add, _stored(self))

    @property
    def brought(self) -> float:
        """Energy that has come in from outside."""
        return reduce(add, _brought(self))

    @property
    def lost(self) -> float:
        """Energy lost, but for that which the time integration removed."""
        return reduce(add, _lost(self))

    def plus(self, *changes: Ledger) -> Ledger:
        """Return the ledger with every entry changed by those of ``changes``, in their order."""
        sums = map(sum, zip(_entries(self), *map(_entries, changes), strict=True))
        return Ledger(**dict(zip(LEDGER_ENTRIES, sums, strict=True)))


LEDGER: dict[str, Mapping[str, Any]] = {one.name: one.metadata for one in fields(Ledger)}
"""Entries of a ledger: name -> kind."""
LEDGER_ENTRIES = tuple(LEDGER)
"""Their names."""
_entries = attrgetter(*LEDGER_ENTRIES)


def entries_of(*kinds: Kind) -> tuple[str, ...]:
    """Return the names of the entries of some kinds, in their order."""
    return tuple(name for name, about in LEDGER.items() if about["kind"] in kinds)


_stored, _brought, _lost = (
    attrgetter(*entries_of(kind)) for kind in (Kind.STORED, Kind.BROUGHT, Kind.LOST)
)


@dataclass(frozen=True, kw_only=True, repr=False)
class State:
    """One instant of a run."""

    time: float
    """Time, s."""
    vertices: Floats
    """Vertices, m, relative to the model's origin, shape (nv, 2)."""
    velocity: Floats
    """Velocity (u, v, r, ex, ey, gxy) of each block about its centroid, shape (n, 6)."""
    stress: Floats
    """Stress (xx, yy, xy) of each block, Pa, tension positive, shape (n, 3)."""
    rotation: Floats
    """Rotation of each block since the start, rad, counter-clockwise, shape (n,)."""
    points: Floats
    """Material points in the order of ``Model.material_points``, m, shape (np, 2)."""
    memory: ContactMemory
    """Contact memory."""
    ledger: Ledger
    """Energy ledger."""
    actions: tuple[Any, ...] = ()
    """Own state of each action, in the order of ``clast.actions.active.actions_of``."""
    reactions: Floats = no_floats(3)
    """Forces (x, y), N/m, by which supports held in the last step, and their moments about the
    points of ``Model.reactions``, N, shape (k, 3); (0, 3) before the first step."""

    def __post_init__(self) -> None:
        """Make the arrays read-only: a state is replaced, never edited."""
        seal(self)

    def __repr__(self) -> str:
        speed = np.hypot(*self.velocity[:, :2].T).max(initial=0.0)
        return (
            f"State(t = {self.time:.6g} s, {len(self.rotation)} blocks at up to {speed:.3g} m/s, "
            f"{len(self.memory)} contacts)"
        )


@dataclass(frozen=True, kw_only=True)
class Overlap:
    """Two blocks that overlap deeper than their contacts know."""

    blocks: tuple[str, str]
    """Names of the blocks."""
    time: float
    """Time at which it was deepest, s."""
    depth: float
    """Diameter of the largest circle in the overlap, m."""
    area: float
    """Area of the overlap, m2."""
    known: float
    """Largest penetration of their contacts, m."""


def initial_state(model: Model) -> State:
    """Return the state of a model at time zero, at rest but for its initial velocities."""
    return State(
        time=0.0,
        vertices=model.vertices,
        velocity=model.velocity,
        stress=model.initial_stress,
        rotation=np.zeros(model.block_count),
        points=model.material_points.at,
        memory=ContactMemory(),
        ledger=Ledger(),
    )


@dataclass(frozen=True, kw_only=True, repr=False)
class ReferenceState:
    """Where displacements and rotations count from."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    points: Floats
    """Material points, m, shape (np, 2)."""
    rotation: Floats
    """Rotation of each block since the start of the run, rad, shape (n,)."""


def here(state: State) -> ReferenceState:
    """Return a state as the reference of displacements."""
    return ReferenceState(vertices=state.vertices, points=state.points, rotation=state.rotation)
