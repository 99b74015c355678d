"""The input and the output of a model of joints: straight lines in the section."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.arrays import Floats, no_floats
from clast.rockmass.joints.spacing_distributions import Spacing


@dataclass(frozen=True, kw_only=True)
class Window:
    """The area that a set has lines in, as a shapely polygon about the origin of the cut."""

    polygon: Any
    """Domain, or the part of it that the set is limited to, m."""

    @cached_property
    def area(self) -> float:
        """Area, m2."""
        return float(self.polygon.area)

    @cached_property
    def center(self) -> Floats:
        """Middle of its bounding box, m, shape (2,)."""
        low, high = self.box
        return np.asarray(0.5 * (low + high))

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """Lower left and upper right corner of its bounding box, m, shape (2,) each."""
        bounds = np.array(self.polygon.bounds)
        return bounds[:2], bounds[2:]

    @cached_property
    def radius(self) -> float:
        """Radius of the circle about ``center`` that holds it, m."""
        return float(0.5 * np.hypot(*(self.box[1] - self.box[0])))

    def clipped(self, ends: Floats) -> Floats:
        """Return the parts of lines (n, 2, 2) inside it, m, shape (k, 2, 2), in their order."""
        if len(ends) == 0:
            return ends
        lines = shapely.linestrings(ends)
        shapely.prepare(self.polygon)
        inside = shapely.contains_properly(self.polygon, lines)
        parts = [ends[inside]]
        number = [np.flatnonzero(inside)]
        outer = np.flatnonzero(~inside & shapely.intersects(self.polygon, lines))
        cut = shapely.intersection(lines[outer], self.polygon)
        pieces, of = shapely.get_parts(cut, return_index=True)
        straight = shapely.get_type_id(pieces) == 1
        pieces, of = pieces[straight], of[straight]
        at, part = shapely.get_coordinates(pieces, return_index=True)
        along = np.flatnonzero(part[1:] == part[:-1])
        parts.append(np.stack([at[along], at[along + 1]], axis=1))
        number.append(outer[of[part[along]]])
        order = np.argsort(np.concatenate(number), kind="stable")
        return np.asarray(np.concatenate(parts)[order])


@dataclass(frozen=True, kw_only=True)
class Plan:
    """The numbers of one set, as the section shows them."""

    direction: MeanDirection
    """Direction of its lines."""
    spacing: Spacing | None
    """Spacing in the section, m."""
    intensity: float | None
    """Length of lines per area P21, m/m2."""
    trace: Spacing | None
    """Length of traces, m; None: persistent."""
    bridge: Spacing | None
    """Length of the rock bridges between traces of a line, m."""
    origin: Floats
    """A line passes here, m, shape (2,)."""
    stagger: float
    """Share of trace + bridge, or of the spacing, by which every second line or layer is moved."""
    bounds: Floats
    """Lines at which traces end, m, shape (k, 2, 2)."""
    window: Window
    """Where lines are wanted."""

    @property
    def density(self) -> float:
        """Length of lines per area, m/m2: the intensity, else that of the spacing."""
        if self.intensity is not None:
            return self.intensity
        return self.persistence / self.spacing.mean if self.spacing else 0.0

    @property
    def persistence(self) -> float:
        """Share of a line that is trace: t/(t + g)."""
        if self.trace is None or self.bridge is None:
            return 1.0
        return self.trace.mean / (self.trace.mean + self.bridge.mean)


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """Lines of a set, which may reach beyond its window."""

    ends: Floats
    """Ends of each straight line, m, shape (n, 2, 2)."""
    carriers: Floats = no_floats(2, 2)
    """The whole lines that traces and bridges lie on, m, shape (k, 2, 2); (0, 2, 2) for others."""


NONE = np.zeros((0, 2, 2))


class JointModel:
    """A model of joints: where the lines of a set are."""

    name: ClassVar[str]
    """Name in case files."""
    takes: ClassVar[frozenset[str]]
    """Keys of a joint set that it uses."""
    cells: ClassVar[bool] = False
    """Whether its lines are edges of cells, and cross none of their own."""

    @property
    def needs(self) -> tuple[tuple[str, ...], ...]:
        """Keys that it cannot do without: one of each group."""
        return ()

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return lines, m; those in the window must be complete."""
        raise NotImplementedError

    def blocks(self, plan: Plan) -> float:
        """Return about how many pieces of lines (or cells) it makes in the window."""
        return pieces(plan)


def along(points: Floats, units: Floats, reach: float) -> Floats:
    """Return lines (n, 2, 2) through points (n, 2) along vectors (n, 2), ``reach`` to each side."""
    return np.stack([points - reach * units, points + reach * units], axis=1)


def pieces(plan: Plan) -> float:
    """Return about how many straight lines the density of a set comes to in its window."""
    window = plan.window
    mean_chord = 0.5 * math.pi * window.area / (math.pi * window.radius)
    mean = mean_chord if plan.trace is None else min(plan.trace.mean, mean_chord)
    return plan.density * window.area / mean


def until(plan: Plan, draw: Callable[[int], Floats], guess: float) -> Floats:
    """Return lines (n, 2, 2) from ``draw`` until the asked length lies in the window.

    The last one is kept if that comes nearer to the intensity.  ``guess`` lines are expected.
    """
    target = plan.density * plan.window.area
    lines = [NONE]
    total = 0.0
    while total < target:
        ends = draw(int(1.05 * guess * (1.0 - total / target)) + 16)
        inside = shapely.length(
            shapely.intersection(shapely.linestrings(ends), plan.window.polygon)
        )
        sums = total + np.cumsum(inside)
        stop = int(np.searchsorted(sums, target)) + 1
        if stop <= len(ends):
            before = sums[stop - 2] if stop > 1 else total
            stop -= int(target - before < sums[stop - 1] - target)
        lines.append(ends[:stop])
        total = float(sums[-1])
    return np.concatenate(lines)


SPACING_FACTOR_MAX = 50.0
"""A section in which the spacing is more than this many times the true one shows no joints."""


def apparent(dip: float, dip_direction: float, section_azimuth: float) -> tuple[float, float]:
    """Return the angle of the trace in the section, degrees in (-90, 90], and the spacing factor.

    All angles in degrees; the factor is 1/|n in the section|, infinite where they are parallel.
    """
    x, y = _in_section(normal_of(dip, dip_direction)[None], section_azimuth)[0]
    length, angle = float(np.hypot(x, y)), math.degrees(math.atan2(-x, y))
    return 90.0 - (90.0 - angle) % 180.0, 1.0 / length if length > 0.0 else math.inf


def normal_of(dip: float, dip_direction: float) -> Floats:
    """Return the upward unit normal of a plane (east, north, up), shape (3,)."""
    d, D = math.radians(dip), math.radians(dip_direction)
    return np.array([math.sin(d) * math.sin(D), math.sin(d) * math.cos(D), math.cos(d)])


def _in_section(normal: Floats, section_azimuth: float) -> Floats:
    """Return the parts of normals (n, 3) in the section, shape (n, 2); round-off of 0 is 0."""
    a = math.radians(section_azimuth)
    parts = np.stack([normal @ [math.sin(a), math.cos(a), 0.0], normal[:, 2]], axis=1)
    return np.where(np.abs(parts) < 1e-12, 0.0, parts)


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

    def along_traces(self, rng: np.random.Generator, count: int) -> Floats:
        """Return unit vectors along traces, shape (count, 2)."""
        if self.angle is None:
            angles = rng.uniform(0.0, math.pi, count)
        elif self.scatter is None:
            return np.tile(self.along, (count, 1))
        else:
            angles = self.scatter.angles(self, rng, count)
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """How the directions of single joints scatter about that of their set."""

    in_space: ClassVar[bool]
    """Whether it is one of planes in space, which needs dip and dip direction."""
    kappa: float
    """Concentration, -."""

    def check(self, where: str) -> None:
        """Refuse a concentration that is not above 0."""
        if not 0.0 < self.kappa < math.inf:
            raise ModelError(
                f"{self.kappa:g} must be above 0",
                where=f"{where}, kappa",
                remedy="the larger, the less scatter: 60 is a standard deviation of about 7.4 "
                "degrees",
            )

    def angles(self, mean: MeanDirection, rng: np.random.Generator, count: int) -> Floats:
        """Return angles in the section, radians, shape (count,)."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class VonMises(Scatter):
    """Scatter in the section: exp(kappa cos(deviation)); std about 1/sqrt(kappa) rad."""

    in_space = False

    def angles(self, mean: MeanDirection, rng: np.random.Generator, count: int) -> Floats:
        """Return angles in the section, radians, shape (count,)."""
        return (mean.angle or 0.0) + rng.vonmises(0.0, self.kappa, count)


@dataclass(frozen=True, kw_only=True)
class Fisher(Scatter):
    """Scatter of normals in space about the mean normal, then seen in the section.

    The density is proportional to exp(kappa cos(deviation)) on the sphere, so that the cosine of
    the deviation is 1 + ln(u + (1 - u) exp(-2 kappa))/kappa with u uniform (Fisher 1953, Proc.
    R. Soc. A 217).
    """

    in_space = True

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
