"""Rotation rules: the meaning of the third unknown, and how a block is placed with it.

To first order all three are the same; they differ in how the block is placed after the solve:
a point at x from the centroid moves by u(x) = (u0, v0) + G x, E being the strain, R the rotation
and J a quarter turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from clast.compute.jit import kernel
from clast.compute.reductions import largest_size
from clast.model.model import Floats


class RotationRule(Protocol):
    """The meaning of the third unknown, and the displacement gradient that follows from it."""

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape; nan where impossible."""
        ...

    def unknown(self, angle: float) -> float:
        """Return the third unknown of a rotation, rad."""
        ...

    def gradient(self, unknowns: Floats) -> Floats:
        """Return the displacement gradient G (n, 2, 2) of d (n, 6): u(x) = (u0, v0) + G x."""
        ...


def turned_by(vectors: Floats, angle: Floats) -> Floats:
    """Return vectors (k, 2) turned by angles (k,), rad."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)


@dataclass(frozen=True)
class Exact:
    """The third unknown is the angle r0: the strained block is turned by it, area is kept."""

    name: str = "exact"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape."""
        return unknown

    def unknown(self, angle: float) -> float:
        """Return the third unknown of a rotation, rad."""
        return angle

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = R (I + E) - I of d (n, 6), shape (n, 2, 2)."""
        gradient: Floats = _exact_gradients(unknowns)
        return gradient


@kernel()
def _exact_gradients(unknowns):
    """Return G = R (I + E) - I of d (n, 6), R being the rotation by the third, (n, 2, 2)."""
    gradient = np.empty((len(unknowns), 2, 2))
    for b in range(len(unknowns)):
        _, _, angle, ex, ey, gxy = unknowns[b]
        sine, half = np.sin(angle), np.sin(0.5 * angle)
        less, exy = -2.0 * half * half, 0.5 * gxy  # less = cos(angle) - 1, with all its digits
        gradient[b, 0, 0] = less + (1.0 + less) * ex - sine * exy
        gradient[b, 0, 1] = -sine + (1.0 + less) * exy - sine * ey
        gradient[b, 1, 0] = sine + sine * ex + (1.0 + less) * exy
        gradient[b, 1, 1] = less + sine * exy + (1.0 + less) * ey
    return gradient


@dataclass(frozen=True)
class Sine:
    """The third unknown is sin r0 (Ke 1995; the paper's rule); area is kept."""

    name: str = "sine"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation asin(unknown), rad; nan where the unknown exceeds 1."""
        if largest_size(unknown) <= 1.0:
            return np.arcsin(unknown)
        with np.errstate(invalid="ignore"):
            return np.arcsin(unknown)

    def unknown(self, angle: float) -> float:
        """Return the third unknown of a rotation, rad."""
        return float(np.sin(angle))

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = R - I + E of d (n, 6), shape (n, 2, 2): strain and rotation add up.

        T's third column is (-(y + x tan(r/2)), x - y tan(r/2)), and sin r tan(r/2) = 1 - cos r.
        nan where the third unknown exceeds 1.
        """
        gradient: Floats = _sine_gradients(unknowns)
        return gradient


@kernel()
def _sine_gradients(unknowns):
    """Return G = R - I + E of d (n, 6), R being the rotation with sine d_3, shape (n, 2, 2)."""
    gradient = np.empty((len(unknowns), 2, 2))
    for b in range(len(unknowns)):
        _, _, s, ex, ey, gxy = unknowns[b]
        less, exy = -s * s / (1.0 + np.sqrt(1.0 - s * s)), 0.5 * gxy  # less = cosine - 1
        gradient[b, 0, 0], gradient[b, 0, 1] = less + ex, exy - s
        gradient[b, 1, 0], gradient[b, 1, 1] = exy + s, less + ey
    return gradient


@dataclass(frozen=True)
class Linear(Exact):
    """Rotation to first order (Shi 1988): the area grows by 1 + r^2 a step; kept as a warning."""

    name: str = "linear"

    def gradient(self, unknowns: Floats) -> Floats:
        """Return G = E + r0 J of d (n, 6), shape (n, 2, 2)."""
        gradient: Floats = _linear_gradients(unknowns)
        return gradient


@kernel()
def _linear_gradients(unknowns):
    """Return G = E + d_3 J, J being a quarter turn, of d (n, 6), shape (n, 2, 2)."""
    gradient = np.empty((len(unknowns), 2, 2))
    for b in range(len(unknowns)):
        _, _, r, ex, ey, gxy = unknowns[b]
        gradient[b, 0, 0], gradient[b, 0, 1] = ex, 0.5 * gxy - r
        gradient[b, 1, 0], gradient[b, 1, 1] = 0.5 * gxy + r, ey
    return gradient
