"""Directions of joints in the section: angle, or dip and dip direction; scatter about them.

A joint plane with dip d and dip direction D (degrees, clockwise from north) has the upward normal
n = (sin d sin D, sin d cos D, cos d) in east, north, up.  The section holds +x, the horizontal
direction of the azimuth a, and +y, up.  The trace is perpendicular to (n.x, n.y) in the section,
tan(angle) = -tan d cos(D - a), and planes at a true spacing s are s / |(n.x, n.y)| apart there
(Priest 1993, Discontinuity analysis for rock engineering, chapter 3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from clast.errors import ModelError
from clast.model.model import Floats

LARGEST_FACTOR = 50.0
"""A section in which the spacing is more than this many times the true one shows no joints."""


def apparent(dip: float, dip_direction: float, section_azimuth: float) -> tuple[float, float]:
    """Return the angle of the trace in the section, degrees in (-90, 90], and the spacing factor.

    All angles in degrees; the factor is 1/|n in the section|, infinite where they are parallel.
    """
    return _trace(_in_section(normal_of(dip, dip_direction)[None], section_azimuth)[0])


def normal_of(dip: float, dip_direction: float) -> Floats:
    """Return the upward unit normal of a plane (east, north, up), shape (3,)."""
    d, D = math.radians(dip), math.radians(dip_direction)
    return np.array([math.sin(d) * math.sin(D), math.sin(d) * math.cos(D), math.cos(d)])


def _in_section(normal: Floats, section_azimuth: float) -> Floats:
    """Return the parts of normals (n, 3) in the section, shape (n, 2); round-off of 0 is 0."""
    a = math.radians(section_azimuth)
    parts = np.stack([normal @ [math.sin(a), math.cos(a), 0.0], normal[:, 2]], axis=1)
    return np.where(np.abs(parts) < 1e-12, 0.0, parts)


def _trace(normal: Floats) -> tuple[float, float]:
    length = float(np.hypot(*normal))
    angle = math.degrees(math.atan2(-normal[0], normal[1]))
    return 90.0 - (90.0 - angle) % 180.0, 1.0 / length if length > 0.0 else math.inf


class Scatter(Protocol):
    """How the directions of single joints scatter about that of their set."""

    @property
    def in_space(self) -> bool:
        """Whether it is one of planes in space, which needs dip and dip direction."""
        ...

    def check(self, where: str) -> None:
        """Raise ModelError for numbers that it cannot have."""
        ...

    def angles(self, mean: MeanDirection, rng: np.random.Generator, count: int) -> Floats:
        """Return angles in the section, radians, shape (count,)."""
        ...


@dataclass(frozen=True, kw_only=True)
class MeanDirection:
    """The mean direction of a set in the section."""

    angle: float | None
    """Angle of the traces from +x, radians, counter-clockwise; None: all directions alike."""
    factor: float = 1.0
    """Spacing in the section over spacing in space."""
    normal: Floats | None = None
    """Normal in space (east, north, up), shape (3,); None where only an angle was given."""
    section_azimuth: float = 90.0
    """Direction of +x, degrees clockwise from north."""
    scatter: Scatter | None = None
    """How single joints scatter; None: not at all."""

    @property
    def scattered(self) -> bool:
        """Whether single joints have directions of their own."""
        return self.angle is None or self.scatter is not None

    @property
    def along(self) -> Floats:
        """Unit vector along the mean trace, +x where there is none, shape (2,)."""
        angle = self.angle or 0.0
        # Whole quarter turns are exact, so that brick walls and benches are.
        quarter = angle / (0.5 * math.pi)
        if abs(quarter - round(quarter)) < 1e-14:
            return np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][round(quarter) % 4])
        return np.array([math.cos(angle), math.sin(angle)])

    def ways(self, rng: np.random.Generator, count: int) -> Floats:
        """Return unit vectors along traces, shape (count, 2)."""
        if self.angle is None:
            angles = rng.uniform(0.0, math.pi, count)
        elif self.scatter is None:
            return np.tile(self.along, (count, 1))
        else:
            angles = self.scatter.angles(self, rng, count)
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _check_kappa(kappa: float, where: str) -> None:
    if not 0.0 < kappa < math.inf:
        raise ModelError(
            f"{kappa:g} must be above 0",
            where=f"{where}, kappa",
            remedy="the larger, the less scatter: 60 is a standard deviation of about 7.4 degrees",
        )


@dataclass(frozen=True, kw_only=True)
class VonMises:
    """Scatter in the section: exp(kappa cos(deviation)); std about 1/sqrt(kappa) rad."""

    kappa: float
    """Concentration, -."""
    in_space: bool = False

    def check(self, where: str) -> None:
        """Refuse a concentration that is not above 0."""
        _check_kappa(self.kappa, where)

    def angles(self, mean: MeanDirection, rng: np.random.Generator, count: int) -> Floats:
        """Return angles in the section, radians, shape (count,)."""
        return (mean.angle or 0.0) + rng.vonmises(0.0, self.kappa, count)


@dataclass(frozen=True, kw_only=True)
class Fisher:
    """Scatter of normals in space about the mean normal, then seen in the section.

    The density is proportional to exp(kappa cos(deviation)) on the sphere, so that the cosine of
    the deviation is 1 + ln(u + (1 - u) exp(-2 kappa))/kappa with u uniform (Fisher 1953, Proc.
    R. Soc. A 217).
    """

    kappa: float
    """Concentration, -."""
    in_space: bool = True

    def check(self, where: str) -> None:
        """Refuse a concentration that is not above 0."""
        _check_kappa(self.kappa, where)

    def angles(self, mean: MeanDirection, rng: np.random.Generator, count: int) -> Floats:
        """Return angles in the section, radians, shape (count,)."""
        u, turn = rng.uniform(size=count), rng.uniform(0.0, 2.0 * math.pi, count)
        cosine = np.clip(
            1.0 + np.log(u + (1.0 - u) * math.exp(-2.0 * self.kappa)) / self.kappa, -1, 1
        )
        sine = np.sqrt(1.0 - cosine**2)
        pole = np.array([0.0, 0.0, 1.0]) if mean.normal is None else mean.normal
        aside = np.cross(pole, [1.0, 0.0, 0.0] if abs(pole[0]) < 0.9 else [0.0, 1.0, 0.0])
        aside = aside / np.linalg.norm(aside)
        third = np.cross(pole, aside)
        normal = (
            cosine[:, None] * pole
            + (sine * np.cos(turn))[:, None] * aside
            + (sine * np.sin(turn))[:, None] * third
        )
        x, y = _in_section(normal, mean.section_azimuth).T
        # Of a joint parallel to the section nothing is seen; it keeps the mean direction.
        seen = np.hypot(x, y) > 1e-9
        return np.where(seen, np.arctan2(-x, y), mean.angle or 0.0)
