"""How gap and slip of the contacts follow the unknowns of two blocks."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

import numpy as np

from clast.block import displacement_kernels as first_order
from clast.block.displacement import DisplacementFunction
from clast.model.model import Floats, Ints

if TYPE_CHECKING:
    from typing_extensions import TypeIs


class ByOffsets(DisplacementFunction, Protocol):
    """Shi's first-order displacement function, in which offsets say all about a point."""

    def displacements(self, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
        """Return T d (k, 2) at offsets (k, 2) in blocks (k,) with d (n, 6), to first order, m."""
        ...

    def movements(self, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
        """Return how far points at offsets (k, 2) in blocks (k,) are moved by d (n, 6), m, (k, 2).

        With the rotation as it is, other than ``displacements``.
        """
        ...


@lru_cache(maxsize=64)
def _by_one_class(kind: type, *names: str) -> bool:
    """Return True where all these methods of a class are defined by the same class.

    One that takes over all of another but a method of its own would else not be asked for that.
    """
    defining = [next((one for one in kind.__mro__ if name in vars(one)), None) for name in names]
    return None not in defining and len(set(defining)) == 1


def by_offsets(displacement: DisplacementFunction) -> TypeIs[ByOffsets]:
    """Return True where kernels need no basis but the offsets."""
    return _by_one_class(type(displacement), "basis", "displacements")


def places_at_once(displacement: DisplacementFunction) -> TypeIs[ByOffsets]:
    """Return True where ``movements`` gives what ``place`` gives, for all points together."""
    return _by_one_class(type(displacement), "place", "movements")


def levers_of(displacement: DisplacementFunction, levers: Floats) -> Floats:
    """Return what contacts are in the equations (contact/levers.py).

    ``levers`` (m, 6) are their normals and the offsets of vertex and foot from the centroids of
    their blocks, m.  Shape (m, 6), or for a displacement function that is known by its basis alone
    (m, 4, 6).
    """
    if by_offsets(displacement):
        return levers
    normal, at_vertex, at_edge = (levers[:, k : k + 2] for k in (0, 2, 4))
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    i, j = displacement.basis(at_vertex), displacement.basis(at_edge)
    return np.stack(
        [
            np.einsum("mxk,mx->mk", i, normal),
            -np.einsum("mxk,mx->mk", j, normal),
            np.einsum("mxk,mx->mk", i, tangent),
            -np.einsum("mxk,mx->mk", j, tangent),
        ],
        axis=1,
    )


def rows_of(levers: Floats) -> Floats:
    """Return T_i^T n, -T_j^T n, T_i^T t and -T_j^T t of contacts, shape (m, 4, 6)."""
    return levers if levers.ndim == 3 else np.asarray(first_order.contact_rows(levers))


def movement(
    displacement: DisplacementFunction, offset: Floats, unknowns: Floats, block: Ints
) -> Floats:
    """Return T d, m, (k, 2): how far points (k, 2) of blocks (k,) move to first order."""
    if by_offsets(displacement):
        return displacement.displacements(offset, unknowns, block)
    return np.einsum("vxk,vk->vx", displacement.basis(offset), unknowns[block])
