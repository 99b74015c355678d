"""Rotation rules block by block: the displacement gradient G of u(x) = (u0, v0) + G x."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel()
def exact(unknowns):
    """Return G = R (I + E) - I of d (n, 6), R being the rotation by the third, shape (n, 2, 2)."""
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


@kernel()
def sine(unknowns):
    """Return G = R - I + E of d (n, 6), R being the rotation with sine d_3, shape (n, 2, 2).

    nan where the third unknown exceeds 1.
    """
    gradient = np.empty((len(unknowns), 2, 2))
    for b in range(len(unknowns)):
        _, _, s, ex, ey, gxy = unknowns[b]
        less, exy = -s * s / (1.0 + np.sqrt(1.0 - s * s)), 0.5 * gxy  # less = cosine - 1
        gradient[b, 0, 0], gradient[b, 0, 1] = less + ex, exy - s
        gradient[b, 1, 0], gradient[b, 1, 1] = exy + s, less + ey
    return gradient


@kernel()
def linear(unknowns):
    """Return G = E + d_3 J, J being a quarter turn, of d (n, 6), shape (n, 2, 2)."""
    gradient = np.empty((len(unknowns), 2, 2))
    for b in range(len(unknowns)):
        _, _, r, ex, ey, gxy = unknowns[b]
        gradient[b, 0, 0], gradient[b, 0, 1] = ex, 0.5 * gxy - r
        gradient[b, 1, 0], gradient[b, 1, 1] = 0.5 * gxy + r, ey
    return gradient
