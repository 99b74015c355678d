"""Rows of the contacts in the equations: how gap and slip follow the unknowns of two blocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from clast.interfaces import DisplacementFunction
from clast.model import Floats, Ints

if TYPE_CHECKING:
    from typing_extensions import TypeIs


@dataclass(frozen=True, kw_only=True)
class Rows:
    """First-order changes of gap and slip with the unknowns (see :class:`Contacts`)."""

    normal_vertex: Floats
    """T_i(P)^T n, shape (m, 6)."""
    normal_edge: Floats
    """-T_j(Q)^T n, shape (m, 6)."""
    tangent_vertex: Floats
    """T_i(P)^T t, shape (m, 6)."""
    tangent_edge: Floats
    """-T_j(Q)^T t, shape (m, 6)."""


class FusedRows(DisplacementFunction, Protocol):
    """A displacement function that gives what contacts need without forming T."""

    def contact_rows(
        self, at_vertex: Floats, at_edge: Floats, normal: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the four rows (m, 6) of :class:`Rows` in their order (see ``rows_of``)."""
        ...

    def displacements(self, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
        """Return T d (k, 2) at offsets (k, 2) in blocks (k,) with d (n, 6), to first order, m."""
        ...


def is_fused(displacement: DisplacementFunction) -> TypeIs[FusedRows]:
    """Return True where the fused path can be taken."""
    return hasattr(displacement, "contact_rows")


def rows_of(
    displacement: DisplacementFunction, at_vertex: Floats, at_edge: Floats, normal: Floats
) -> Rows:
    """Return the rows of contacts with normals (m, 2).

    ``at_vertex`` (m, 2) and ``at_edge`` (m, 2) are the offsets of the vertex and of its foot from
    the centroids of their blocks, m.  Any displacement function gives them by its basis.
    """
    if is_fused(displacement):
        fused = displacement.contact_rows(at_vertex, at_edge, normal)
        return Rows(
            normal_vertex=fused[0],
            normal_edge=fused[1],
            tangent_vertex=fused[2],
            tangent_edge=fused[3],
        )
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    i, j = displacement.basis(at_vertex), displacement.basis(at_edge)
    return Rows(
        normal_vertex=np.einsum("mxk,mx->mk", i, normal),
        normal_edge=-np.einsum("mxk,mx->mk", j, normal),
        tangent_vertex=np.einsum("mxk,mx->mk", i, tangent),
        tangent_edge=-np.einsum("mxk,mx->mk", j, tangent),
    )


def movement(
    displacement: DisplacementFunction, offset: Floats, unknowns: Floats, block: Ints
) -> Floats:
    """Return T d, m, (k, 2): how far points (k, 2) of blocks (k,) move to first order."""
    if is_fused(displacement):
        return displacement.displacements(offset, unknowns, block)
    return np.einsum("vxk,vk->vx", displacement.basis(offset), unknowns[block])
