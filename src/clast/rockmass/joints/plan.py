"""The input and the output of a model of joints: straight lines in the section."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import shapely

from clast.model.model import Floats
from clast.rockmass.joints.directions import MeanDirection
from clast.rockmass.joints.spacing_distributions import Distribution


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
    spacing: Distribution | None
    """Spacing in the section, m."""
    intensity: float | None
    """Length of lines per area P21, m/m2."""
    trace: Distribution | None
    """Length of traces, m; None: persistent."""
    bridge: Distribution | None
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
    carriers: Floats
    """The whole lines that traces and bridges lie on, m, shape (k, 2, 2); (0, 2, 2) for others."""


NONE = np.zeros((0, 2, 2))


class JointModel(Protocol):
    """A model of joints: where the lines of a set are."""

    @property
    def name(self) -> str:
        """Return the name in case files."""
        ...

    @property
    def takes(self) -> frozenset[str]:
        """Return the keys of a joint set that it uses."""
        ...

    @property
    def needs(self) -> tuple[tuple[str, ...], ...]:
        """Return the keys that it cannot do without: one of each group."""
        ...

    @property
    def cells(self) -> bool:
        """Return whether its lines are edges of cells, and cross none of their own."""
        ...

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return lines, m; those in the window must be complete."""
        ...

    def blocks(self, plan: Plan) -> float:
        """Return about how many pieces of lines (or cells) it makes in the window."""
        ...


def along(points: Floats, ways: Floats, reach: float) -> Floats:
    """Return lines (n, 2, 2) through points (n, 2) along ways (n, 2), ``reach`` to each side."""
    return np.stack([points - reach * ways, points + reach * ways], axis=1)


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
    found: list[Floats] = []
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
        found.append(ends[:stop])
        total = float(sums[-1])
    return np.concatenate([NONE, *found])
