"""What couples the blocks in K: given blocks K_ij, or the contact springs that they come from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from clast.linear import assembly, parts
from clast.linear import block_matrix as block_rows
from clast.model.model import Bools, Floats, Ints

Rows = tuple[Ints, Ints, Ints]
"""Right (n + 1,), left (n + 1,) and listed (q,) of pairs (linear/block_matrix.py)."""
Graph = tuple[Ints, Ints, Ints, Ints]
"""First contact of each pair (q + 1,), then the Rows of the pairs."""
Precision = type[np.float32] | type[np.float64]
"""In which K is read, over and over, by an iteration."""


class Couplings(Protocol):
    """The blocks of K beside the diagonal, of pairs (i, j) with i < j."""

    @property
    def upper(self) -> Floats:
        """K_ij, shape (q, 6, 6)."""
        ...

    @property
    def lower(self) -> Floats:
        """K_ji, shape (q, 6, 6)."""
        ...

    @property
    def coupled(self) -> Bools:
        """Which pairs are coupled at all, shape (q,)."""
        ...

    @property
    def known(self) -> Any:
        """From what kernels find K_ij (linear/coupling_kernels.py)."""
        ...

    def in_precision(self, precision: Precision) -> Any:
        """Return K_ij, shape (q, 6, 6), in a precision."""
        ...

    def inertia_shares(self, diagonal: Floats, rows: Rows) -> tuple[float, float]:
        """Return which share of ``diagonal`` (n, 6, 6) they leave to translations.

        To all blocks that are coupled and to the one with the least, in its weakest direction.
        """
        ...


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """Couplings that are given block by block."""

    upper: Floats
    """K_ij, shape (q, 6, 6)."""
    lower: Floats
    """K_ji, shape (q, 6, 6)."""

    @property
    def coupled(self) -> Bools:
        """Which pairs are coupled at all, shape (q,)."""
        return np.asarray(parts.coupled_pairs(self.upper))

    @property
    def known(self) -> Any:
        """From what kernels find K_ij: the blocks."""
        return self.upper

    def in_precision(self, precision: Precision) -> Any:
        """Return K_ij, shape (q, 6, 6), in a precision."""
        return self.upper.astype(precision, copy=False)

    def inertia_shares(self, diagonal: Floats, rows: Rows) -> tuple[float, float]:
        """Return which share of ``diagonal`` (n, 6, 6) they leave to translations, and the least.

        What is left of a row is the sum of its blocks.
        """
        share, least = block_rows.inertia_shares(diagonal, self.upper, rows)
        return float(share), float(least)


@dataclass(frozen=True, kw_only=True)
class Springs:
    """Contact springs, whose K_ij are found where they are wanted; symmetric."""

    graph: Graph
    """Which contacts the pairs have."""
    vertex_block: Ints
    """Block of each contact's vertex, shape (m,)."""
    levers: Floats
    """What contacts are in the equations (contact/jacobian.py)."""
    normal_stiffness: Floats
    """Stiffness of each contact against opening, N/m2, shape (m,)."""
    shear_stiffness: Floats
    """Stiffness of each contact against slip, N/m2, shape (m,)."""
    coupled: Bools
    """Which pairs are coupled at all, shape (q,)."""
    shares: tuple[float, float]
    """What they leave to translations, of all coupled blocks and the least of any."""

    @cached_property
    def upper(self) -> Floats:
        """K_ij, shape (q, 6, 6)."""
        return np.asarray(self.in_precision(np.float64))

    @property
    def lower(self) -> Floats:
        """K_ji, shape (q, 6, 6)."""
        return self.upper.transpose(0, 2, 1)

    @property
    def known(self) -> Any:
        """From what kernels find K_ij: the springs."""
        of_contacts = self.normal_stiffness, self.shear_stiffness
        return self.graph[0], self.vertex_block, self.levers, *of_contacts

    def in_precision(self, precision: Precision) -> Any:
        """Return K_ij, shape (q, 6, 6), in a precision."""
        upper = np.empty((len(self.coupled), 6, 6), precision)
        assembly.assemble_couplings(
            self.coupled,
            self.graph,
            self.vertex_block,
            self.levers,
            self.normal_stiffness,
            self.shear_stiffness,
            upper,
        )
        return upper

    def inertia_shares(self, diagonal: Floats, rows: Rows) -> tuple[float, float]:
        """Return what they leave to translations, as it was found with the diagonal blocks."""
        return self.shares
