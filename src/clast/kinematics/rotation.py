"""Rotation rules: what the third unknown means and how a block is placed with it.

To first order all three are the same; they differ in how the block is placed after the solve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model import Floats


@dataclass(frozen=True)
class Exact:
    """The third unknown is the angle r0: the strained block is turned by it, area is kept."""

    name: str = "exact"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape."""
        return unknown

    def displacement(self, offset: Floats, strained: Floats, unknown: Floats) -> Floats:
        """Return the displacement (m, 2), m, without translation, of offsets and their strain.

        ``offset`` (m, 2) from the centroid, ``strained`` (m, 2) their displacement by strain
        alone, ``unknown`` (m,) the third unknown.  u = R(r) (x + u_strain) - x.
        """
        position = offset + strained
        cosine, sine = np.cos(unknown), np.sin(unknown)
        turned = np.stack(
            [
                cosine * position[:, 0] - sine * position[:, 1],
                sine * position[:, 0] + cosine * position[:, 1],
            ],
            axis=1,
        )
        return turned - offset


@dataclass(frozen=True)
class Sine:
    """The third unknown is sin r0 (Ke 1995; the paper's rule); area is kept."""

    name: str = "sine"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation asin(unknown), rad; nan where the unknown exceeds 1."""
        with np.errstate(invalid="ignore"):
            return np.arcsin(unknown)

    def displacement(self, offset: Floats, strained: Floats, unknown: Floats) -> Floats:
        """Return the displacement (m, 2), m, without translation (see :class:`Exact`).

        T's third column is (-(y + x tan(r/2)), x - y tan(r/2)).
        """
        half = np.tan(0.5 * self.angle(unknown))
        x, y = offset[:, 0], offset[:, 1]
        column = np.stack([-(y + x * half), x - y * half], axis=1)
        return strained + unknown[:, None] * column


@dataclass(frozen=True)
class Linear:
    """Rotation to first order (Shi 1988): the area grows by 1 + r^2 a step; kept as a warning."""

    name: str = "linear"

    def angle(self, unknown: Floats) -> Floats:
        """Return the rotation, rad, of the third unknown, same shape."""
        return unknown

    def displacement(self, offset: Floats, strained: Floats, unknown: Floats) -> Floats:
        """Return the displacement (m, 2), m, without translation (see :class:`Exact`)."""
        column = np.stack([-offset[:, 1], offset[:, 0]], axis=1)
        return strained + unknown[:, None] * column
