"""The complete first-order displacement function of Shi: u0, v0, r0, ex, ey, gxy.

T(x, y) = | 1 0 -y  x  0  y/2 |      x = X - Xc, y = Y - Yc  (Shi 1988)
          | 0 1  x  0  y  x/2 |
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from clast.block import displacement_kernels as kernel
from clast.block.rotation import Sine
from clast.model.model import Floats, Ints


class RotationRule(Protocol):
    """What the third unknown means (see :mod:`clast.block.rotation`)."""

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad."""
        ...

    def gradient(self, unknowns: Floats) -> Floats:
        """Return the displacement gradient G (n, 2, 2) of d (n, 6): u(x) = (u0, v0) + G x."""
        ...


@dataclass(frozen=True)
class FirstOrder:
    """Constant strain in each block; large rotation by the rule given."""

    rotation: RotationRule = field(default_factory=Sine)

    def basis(self, offset: Floats) -> Floats:
        """Return T (m, 2, 6) at offsets (m, 2) from the centroid, m."""
        x, y = offset[:, 0], offset[:, 1]
        t = np.zeros((len(offset), 2, 6))
        t[:, 0, 0] = 1.0
        t[:, 0, 2] = -y
        t[:, 0, 3] = x
        t[:, 0, 5] = 0.5 * y
        t[:, 1, 1] = 1.0
        t[:, 1, 2] = x
        t[:, 1, 4] = y
        t[:, 1, 5] = 0.5 * x
        return t

    def mass_matrix(self, mass: Floats, moments: Floats) -> Floats:
        """Return M = int T^T T dm (n, 6, 6), exact, from mass (n,) kg/m and moments (n, 3).

        ``moments`` are the mass moments about the centroid int x2, int y2, int xy dm, kg m2/m.
        """
        matrices: Floats = kernel.mass_matrices(mass, moments)
        return matrices

    def displacements(self, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
        """Return T d (k, 2) at offsets (k, 2) in blocks (k,) with d (n, 6), m."""
        moved: Floats = kernel.displacements(offset, unknowns, block)
        return moved

    def movements(self, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
        """Return how far points at offsets (k, 2) in blocks (k,) are moved by d (n, 6), m, (k, 2).

        Not to first order: the blocks turn as the rotation rule says.
        """
        gradient = self.rotation.gradient(unknowns)
        moved: Floats = kernel.movements(offset, unknowns, gradient, block)
        return moved

    def place(self, offset: Floats, displacement: Floats) -> Floats:
        """Return new offsets (m, 2) from the *old* centroid after displacements d (m, 6)."""
        return offset + self.movements(offset, displacement, np.arange(len(offset)))

    def turn(self, displacement: Floats) -> Floats:
        """Return the rotation, rad, of displacements d (n, 6); nan where it is impossible."""
        return self.rotation.angle(displacement[:, 2])


class DisplacementFunction(Protocol):
    """How a block moves and strains with its six unknowns about its centroid."""

    def basis(self, offset: Floats) -> Floats:
        """Return T (m, 2, 6) at offsets (m, 2) from the centroid, m."""
        ...

    def mass_matrix(self, mass: Floats, moments: Floats) -> Floats:
        """Return M (n, 6, 6) from mass (n,) and mass moments (n, 3): int x2, y2, xy dm, kg m2."""
        ...

    def place(self, offset: Floats, displacement: Floats) -> Floats:
        """Return the new offsets (m, 2) from the *old* centroid after displacements d (m, 6)."""
        ...

    def turn(self, displacement: Floats) -> Floats:
        """Return the rotation, rad, of displacements d (n, 6); nan where it is impossible."""
        ...
