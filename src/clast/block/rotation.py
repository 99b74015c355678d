"""Rotation rules: what the third unknown means and how a block is placed with it.

To first order all three are the same; they differ in how the block is placed after the solve:
a point at x from the centroid moves by u(x) = (u0, v0) + G x, E being the strain and J a quarter
turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block import rotation_kernels as kernel
from clast.model.model import Floats


@dataclass(frozen=True)
class Exact:
    """The third unknown is the angle r0: the strained block is turned by it, area is kept."""

    name: str = "exact"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape."""
        return unknown

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = R (I + E) - I of d (n, 6), shape (n, 2, 2)."""
        return np.asarray(kernel.exact(unknowns))


@dataclass(frozen=True)
class Sine:
    """The third unknown is sin r0 (Ke 1995; the paper's rule); area is kept."""

    name: str = "sine"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation asin(unknown), rad; nan where the unknown exceeds 1."""
        with np.errstate(invalid="ignore"):
            return np.arcsin(unknown)

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = R - I + E of d (n, 6), shape (n, 2, 2): strain and rotation add up.

        T's third column is (-(y + x tan(r/2)), x - y tan(r/2)), and sin r tan(r/2) = 1 - cos r.
        nan where the third unknown exceeds 1.
        """
        return np.asarray(kernel.sine(unknowns))


@dataclass(frozen=True)
class Linear:
    """Rotation to first order (Shi 1988): the area grows by 1 + r^2 a step; kept as a warning."""

    name: str = "linear"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape."""
        return unknown

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = E + r0 J of d (n, 6), shape (n, 2, 2)."""
        return np.asarray(kernel.linear(unknowns))
