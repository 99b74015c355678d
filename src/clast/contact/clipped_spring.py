"""The clipped spring f = clip(f0 - k x, low, high), and the table of all such springs of a step.

A spring acts along a link between a point of one block and a point of another: its stretch x is
how far the link opens, or how far it slips.  A contact's normal force is clipped to [-tension, inf)
and its shear force to [-b, b], a bolt's to [-yield, yield], a linear spring's not at all.  The
force falls with x: the energy phi, f = -dphi/dx, is convex and once continuously differentiable.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared, summed
from clast.compute.reductions import in_part
from clast.contact.contacts import Contacts
from clast.contact.jacobian import rows_of
from clast.model.model import Floats, Ints
from clast.read_only import changed

# --- one spring ----------------------------------------------------------------------------


@kernel(forceinline=True)
def clipped(at_zero, stiffness, low, high, stretch):
    """Return the force of a spring and its stiffness, the one against stretching at a kink.

    Between equal bounds the force is given and nothing is stiff.
    """
    straight = at_zero - stiffness * stretch
    force = min(max(straight, low), high)
    return force, stiffness if (force == straight) & (low < high) else 0.0


@kernel(forceinline=True)
def energy(at_zero, stiffness, low, high, stretch):
    """Return the energy of a spring, J/m: the one whose force at 0 is all it has, if it is 0.

    f^2/(2 k) on the straight part, beyond which it rises by f per unit of stretch.
    """
    straight = at_zero - stiffness * stretch
    force = min(max(straight, low), high)
    if stiffness > 0.0:
        return force * (straight - 0.5 * force) / stiffness
    return -force * stretch


Rows = Ints | slice
"""Where some rows are in a table."""

# --- all springs ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Clipped:
    """Springs f = clip(f0 - k x, low, high), one for each link."""

    at_zero: Floats
    """Force at stretch 0, f0, N/m, shape (m,)."""
    stiffness: Floats
    """Stiffness k, N/m per m, >= 0, shape (m,)."""
    low: Floats
    """Least force, N/m, -inf for none, shape (m,)."""
    high: Floats
    """Largest force, N/m, inf for none, shape (m,)."""

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Floats]:
        """The same as kernels take it."""
        return self.at_zero, self.stiffness, self.low, self.high

    def taken_at(self, place: Floats, start: Floats) -> Clipped:
        """Return springs with these forces at x, taken at a ``place`` between start and x.

        ``start`` (m,), m, is the stretch there, ``place`` (m,) 0 at the start and 1 at x.
        """
        before = self.at_zero - (1.0 - place) * self.stiffness * start
        return changed(self, at_zero=before, stiffness=place * self.stiffness)

    def put(self, rows: Rows, others: Clipped) -> Clipped:
        """Return the springs with others in some of their rows."""
        result = [one.copy() for one in self.arrays]
        for into, values in zip(result, others.arrays, strict=True):
            into[rows] = values
        return Clipped(*result)


@dataclass(frozen=True, kw_only=True, repr=False)
class Springs:
    """Links between points of two blocks, each with a normal and a shear spring.

    m links in the order of their pairs of blocks, q pairs.  A link opens by x_n = gap + n.d and
    slips by x_t = slip + t.d (contact/jacobian.py); on its first block act N n + T t.
    """

    vertex_block: Ints
    """Block of the first point, the vertex of a contact, shape (m,)."""
    edge_block: Ints
    """Block of the other point, on the edge of a contact, shape (m,)."""
    arms: Floats
    """Normal and offsets of both points from the centroids of their blocks, m, (m, 6)."""
    pair: Ints
    """Index into ``pairs``, ascending, shape (m,)."""
    pairs: Ints
    """Pairs of blocks (lower, higher) that share links, sorted, shape (q, 2)."""
    gap: Floats
    """Opening before anything moves, m, shape (m,)."""
    slip: Floats
    """Slip before anything moves, m, shape (m,)."""
    normal: Clipped
    """Normal springs, compression positive."""
    shear: Clipped
    """Shear springs."""
    ground: int = -1
    """Number of blocks n, which stands for the ground where links hold on to it; else -1."""

    def __len__(self) -> int:
        return len(self.gap)

    def __repr__(self) -> str:
        return f"Springs({len(self)} between {len(self.pairs)} pairs of blocks)"

    @cached_property
    def arrays(self) -> tuple[Floats, ...]:
        """Normal springs and shear springs as kernels take them, eight arrays in all.

        One tuple, for loops that threads share take no tuples of tuples.
        """
        return *self.normal.arrays, *self.shear.arrays

    @property
    def rows(self) -> Floats:
        """n_i, n_j, t_i, t_j of each link (contact/jacobian.py), shape (m, 4, 6)."""
        return rows_of(self.arms)

    def put(self, rows: Rows, normal: Clipped, shear: Clipped) -> Springs:
        """Return the table with other springs in some of its rows."""
        if isinstance(rows, slice):
            return changed(self, normal=normal, shear=shear)
        return changed(
            self, normal=self.normal.put(rows, normal), shear=self.shear.put(rows, shear)
        )

    def at(self, gap: Floats, slip: Floats) -> Forces:
        """Return the forces of the springs at gaps and slips (m,), m."""
        return Forces(*forces_at(gap, slip, self.arrays))

    def energy(self, gap: Floats, slip: Floats) -> float:
        """Return the energy of all springs at gaps and slips (m,), m, in J/m."""
        return float(energies(len(self), gap, slip, self.arrays))


def no_springs(count: int) -> Clipped:
    """Return so many springs without force."""
    none = np.zeros(count)
    return Clipped(none, none, none, none)


NO_COUPLING: Floats = np.zeros(0)
"""dT/dN of springs: the bounds of a force do not follow the other one."""


@dataclass(frozen=True)
class Forces:
    """Forces of springs, and their stiffness."""

    normal_force: Floats
    """N, N/m, compression positive, shape (m,)."""
    shear_force: Floats
    """T on the first block along the tangent, N/m, shape (m,)."""
    normal_stiffness: Floats
    """-dN/dgap, N/m per m, shape (m,)."""
    shear_stiffness: Floats
    """-dT/dslip, N/m per m, shape (m,)."""
    coupling: Floats = field(default_factory=lambda: NO_COUPLING)
    """dT/dN, shape (m,), or (0,) where there is none."""


def table(
    *,
    vertex_block: Ints,
    edge_block: Ints,
    arms: Floats,
    gap: Floats,
    slip: Floats,
    normal: Clipped,
    shear: Clipped,
) -> tuple[Springs, Ints]:
    """Return links between any blocks as a table in the order of their pairs, and their rows (m,).

    Links of the same pair keep their order.
    """
    lower, higher = np.minimum(vertex_block, edge_block), np.maximum(vertex_block, edge_block)
    key = lower.astype(np.int64) * (int(higher.max(initial=0)) + 1) + higher
    order = np.argsort(key, kind="stable")
    starts = np.append(True, np.diff(key[order]) != 0)[: len(key)]
    first = order[starts]
    pairs = np.stack([lower[first], higher[first]], axis=1).astype(np.int64)
    pair = np.cumsum(starts) - 1
    rows = np.empty(len(order), np.int64)
    rows[order] = np.arange(len(order))
    springs = Springs(
        vertex_block=np.ascontiguousarray(vertex_block[order], np.int64),
        edge_block=np.ascontiguousarray(edge_block[order], np.int64),
        arms=np.ascontiguousarray(arms[order]),
        pair=pair,
        pairs=pairs,
        gap=gap[order],
        slip=slip[order],
        normal=Clipped(*(one[order] for one in normal.arrays)),
        shear=Clipped(*(one[order] for one in shear.arrays)),
    )
    return springs, rows


def springs_of(contacts: Contacts) -> Springs:
    """Return the links of the contacts as a table, with no springs in them yet."""
    nothing = no_springs(len(contacts))
    return Springs(
        vertex_block=contacts.vertex_block,
        edge_block=contacts.edge_block,
        arms=contacts.arms,
        pair=contacts.pair,
        pairs=contacts.pairs,
        gap=contacts.gap,
        slip=nothing.at_zero,
        normal=nothing,
        shear=nothing,
    )


def merged(first: Springs, others: Sequence[Springs]) -> tuple[Springs, tuple[Rows, ...]]:
    """Return one table of several, and where the rows of each are in it.

    Without ``others`` it is the ``first`` itself.
    """
    if not others:
        return first, (slice(None),)
    every = (first, *others)

    def joined(name: str) -> Any:
        return np.concatenate([getattr(one, name) for one in every])

    def joined_springs(kind: str) -> Clipped:
        each = [getattr(one, kind).arrays for one in every]
        return Clipped(*(np.concatenate(column) for column in zip(*each, strict=True)))

    names = ("vertex_block", "edge_block", "arms", "gap", "slip")
    springs, rows = table(
        **{name: joined(name) for name in names},
        normal=joined_springs("normal"),
        shear=joined_springs("shear"),
    )
    ends = np.cumsum([len(one) for one in every])[:-1]
    springs = changed(springs, ground=max(one.ground for one in every))
    return springs, tuple(np.split(rows, ends))


# --- their kernels -------------------------------------------------------------------------


@kernel()
def in_piece(springs, kind, first, last):
    """Return the springs ``first`` to ``last`` - 1, normal (``kind`` 0) or shear (1) ones.

    Force at zero, stiffness, least and largest force, (m,) each; ``springs`` are Springs.arrays.
    """
    at = 4 * kind
    return (
        springs[at][first:last],
        springs[at + 1][first:last],
        springs[at + 2][first:last],
        springs[at + 3][first:last],
    )


@kernel()
def _respond(stretch, springs, force, stiffness):
    at_zero, k, low, high = springs
    for c in range(len(stretch)):
        force[c], stiffness[c] = clipped(at_zero[c], k[c], low[c], high[c], stretch[c])


@shared(CONTACTS)
def _respond_all(first, last, gap, slip, springs, forces, stiffnesses):
    gap, slip = in_part((gap, slip), first, last)
    normal, shear = in_part(forces, first, last)
    kn, ks = in_part(stiffnesses, first, last)
    _respond(gap, in_piece(springs, 0, first, last), normal, kn)
    _respond(slip, in_piece(springs, 1, first, last), shear, ks)


@kernel()
def forces_at(gap, slip, springs):
    """Return N, T and their stiffnesses (m,) at gaps and slips (m,) (Springs.arrays)."""
    count = len(gap)
    forces = np.empty(count), np.empty(count)
    stiffnesses = np.empty(count), np.empty(count)
    _respond_all(count, gap, slip, springs, forces, stiffnesses)
    return forces[0], forces[1], stiffnesses[0], stiffnesses[1]


@summed(CONTACTS)
def energies(first, last, gap, slip, springs):
    """Return the energy of all springs at gaps and slips (m,), J/m (Springs.arrays)."""
    normal, shear = in_piece(springs, 0, first, last), in_piece(springs, 1, first, last)
    gap, slip = in_part((gap, slip), first, last)
    total = 0.0
    for c in range(len(gap)):
        total += energy(normal[0][c], normal[1][c], normal[2][c], normal[3][c], gap[c])
        total += energy(shear[0][c], shear[1][c], shear[2][c], shear[3][c], slip[c])
    return total
