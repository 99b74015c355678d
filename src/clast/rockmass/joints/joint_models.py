"""Parallel joints: persistent or with rock bridges, and cross joints between other joints."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.spatial import Voronoi as Diagram

from clast.model.distributions import Exponential
from clast.model.model import Floats
from clast.rockmass.joints.plan import NONE, Drawn, JointModel, Plan, Window, along, pieces, until
from clast.rockmass.joints.spacing_distributions import Fixed, Spacing, running

ORIENTED = frozenset({"angle", "dip", "dip_direction", "spacing_is", "angle_spread"})
ORIENTED_AND_SPACED: tuple[tuple[str, ...], ...] = (("angle", "dip"), ("spacing",))
DENSE = ("intensity", "spacing")


@dataclass(frozen=True)
class Parallel(JointModel):
    """Parallel lines at spacings from a distribution, whole or traces between rock bridges.

    One line passes through the origin; the others follow on both sides.  Traces and bridges take
    turns along each line, from the foot of the origin on where both lengths are fixed, every second
    line moved by ``stagger`` of their sum; else from a random place.  P21 = t/((t + g) s).
    """

    name = "parallel"
    takes = ORIENTED | {"spacing", "trace_length", "bridge_length", "origin", "stagger"}
    needs = ORIENTED_AND_SPACED

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return parallel lines, or traces on them, that cover the window, m."""
        window, direction = plan.window, plan.direction
        mean = direction.along
        normal = np.array([-mean[1], mean[0]])
        # Lines that are turned are turned about their point next to the middle of the window.
        reach = window.radius * (1.5 if direction.scattered else 1.0)
        middle = (window.center - plan.origin) @ normal
        place = _positions(
            plan.spacing or Fixed(window.radius), middle - reach, middle + reach, rng
        )
        foot = plan.origin + place[:, 1, None] * normal
        center = foot + ((window.center - foot) @ mean)[:, None] * mean
        units = direction.along_traces(rng, len(place))
        half = 2.5 * window.radius
        whole = along(center, units, half)
        if plan.trace is None or plan.bridge is None:
            return Drawn(ends=whole)
        ends = [NONE]
        # Places along a line count from the foot of the origin, so that the window moves nothing.
        from_foot = ((center - foot) * mean).sum(axis=1)
        for number, at, one, unit in zip(place[:, 0], from_foot, center, units, strict=True):
            shift = plan.stagger * (number % 2)
            spans = _traces(plan.trace, plan.bridge, shift, (at - half, at + half), rng) - at
            ends.append(one + spans[:, :, None] * unit)
        return Drawn(ends=np.concatenate(ends), carriers=whole)


@dataclass(frozen=True)
class CrossJointed(Parallel):
    """Parallel joints that end at the first line of other sets that they meet.

    In every layer between the lines of ``terminates_at`` the spacings are drawn anew; with fixed
    ones, every second layer is moved by ``stagger`` of the spacing: 0.5 is a running bond.
    """

    name = "cross-jointed"
    takes = Parallel.takes | {"terminates_at"}
    needs = (*ORIENTED_AND_SPACED, ("terminates_at",))

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return lines that end at the bounds, m."""
        ends, carriers = [NONE], [NONE]
        normal = np.array([-plan.direction.along[1], plan.direction.along[0]])
        # The areas between the bounds in the window, in order along the joints.
        rings = shapely.get_rings(plan.window.polygon)
        united = shapely.unary_union([*rings, *shapely.linestrings(plan.bounds)])
        faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(united)))
        middle = shapely.point_on_surface(faces)
        faces = faces[shapely.contains(plan.window.polygon, middle)]
        at = shapely.get_coordinates(shapely.centroid(faces))
        order = np.argsort(at @ plan.direction.along, kind="stable")
        for number, layer in enumerate(faces[order]):
            window = Window(polygon=layer)
            shift = (number % 2) * plan.stagger * (plan.spacing or Fixed(0.0)).mean
            moved = replace(plan, window=window, origin=plan.origin + shift * normal)
            drawn = super().lines(moved, rng)
            ends.append(window.clipped(drawn.ends))
            carriers.append(window.clipped(drawn.carriers))
        return Drawn(ends=np.concatenate(ends), carriers=np.concatenate(carriers))

    def blocks(self, plan: Plan) -> float:
        """Return about how many traces lie in the window."""
        return pieces(plan) + len(plan.bounds)


def _positions(spacing: Spacing, low: float, high: float, rng: np.random.Generator) -> Floats:
    """Return number and place of lines from below ``low`` to above ``high``, shape (k, 2)."""
    if spacing.large == spacing.mean:
        s = spacing.mean
        k = np.arange(np.floor(low / s), np.ceil(high / s) + 1.0)
        return np.stack([k, k * s], axis=1)
    up, down = running(spacing, rng, high), running(spacing, rng, -low)
    at = np.concatenate([-down[::-1], [0.0], up])
    k = np.arange(-len(down), len(up) + 1.0)
    first = max(int(np.searchsorted(at, low)) - 1, 0)
    last = int(np.searchsorted(at, high)) + 1
    return np.stack([k, at], axis=1)[first:last]


def _in_turn(
    trace: Spacing, bridge: Spacing, at: float, count: int, rng: np.random.Generator
) -> tuple[Floats, float]:
    """Return starts and ends of traces from ``at`` on, m, (count, 2), and the last end."""
    lengths, gaps = trace.draw(rng, count), bridge.draw(rng, count)
    begin = at + np.concatenate([[0.0], np.cumsum(lengths + gaps)])
    return np.stack([begin[:-1], begin[:-1] + lengths], axis=1), float(begin[-1])


def _traces(
    trace: Spacing,
    bridge: Spacing,
    shift: float,
    between: tuple[float, float],
    rng: np.random.Generator,
) -> Floats:
    """Return start and end of the traces along a line, m, shape (k, 2)."""
    low, high = between
    period = trace.mean + bridge.mean
    if trace.large == trace.mean and bridge.large == bridge.mean:
        start = (np.arange(np.floor(low / period) - 1.0, np.ceil(high / period) + 1.0)) * period
        start = start + shift * period
        return np.stack([start, start + trace.mean], axis=1)
    # Begun well before the window, the place of the first trace there is as random as any.
    at, spans = low - (3.0 + rng.uniform()) * period, np.zeros((0, 2))
    while at < high:
        count = int(1.1 * (high - at) / period) + 8
        more, at = _in_turn(trace, bridge, at, count, rng)
        spans = np.concatenate([spans, more])
    return spans[(spans[:, 1] > low) & (spans[:, 0] < high)]


@dataclass(frozen=True)
class Baecher(JointModel):
    """Traces with uniformly distributed midpoints, until P21 is reached.

    Lengths from their distribution, directions from theirs, all independent (Baecher, Lanney and
    Einstein 1977).  Middles are drawn beyond the window, too, so that its rim is like its interior.
    """

    name = "baecher"
    takes = ORIENTED | {"intensity", "spacing", "trace_length"}
    needs = (DENSE, ("trace_length",))

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return traces, m."""
        low, high = plan.window.box
        trace = plan.trace or Fixed(plan.window.radius)
        margin = 0.5 * trace.large
        low, high = low - margin, high + margin

        def draw(count: int) -> Floats:
            middle = rng.uniform(low, high, (count, 2))
            half = 0.5 * np.minimum(trace.draw(rng, count), trace.large)
            return along(middle, plan.direction.along_traces(rng, count) * half[:, None], 1.0)

        guess = plan.density * float(np.prod(high - low)) / trace.mean
        return Drawn(ends=until(plan, draw, guess))


@dataclass(frozen=True)
class PoissonLines(JointModel):
    """Infinite lines at uniformly distributed distances: P21 for every direction.

    The number that meets a circle of radius R has Poisson's distribution with the mean 2 R P21
    (Miles 1964, Proc. Natl. Acad. Sci. 52).
    """

    name = "poisson-lines"
    takes = ORIENTED | {"intensity", "spacing"}
    needs = (DENSE,)

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return lines, m."""
        return Drawn(ends=_endless(plan, plan.density, rng))


@dataclass(frozen=True)
class Veneziano(JointModel):
    """Poisson lines, divided into traces and rock bridges by Poisson points.

    Marking the parts of a line as joint or rock at random makes both lengths exponential, with
    the means ``trace_length`` and ``bridge_length`` (Veneziano 1978; Dershowitz and Einstein
    1988, Rock Mech. Rock Eng. 21); another distribution may be given for each.  P21 counts traces.
    """

    name = "veneziano"
    takes = ORIENTED | {"intensity", "spacing", "trace_length", "bridge_length"}
    needs = (DENSE, ("trace_length",), ("bridge_length",))

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return traces, m."""
        whole = _endless(plan, plan.density / plan.persistence, rng)
        # Fixed lengths are the means of exponential ones.
        trace, bridge = (
            Exponential(mean=one.mean if one else math.inf)
            if one is None or isinstance(one, Fixed)
            else one
            for one in (plan.trace, plan.bridge)
        )
        period = trace.mean + bridge.mean
        ends = [NONE]
        for start, end in whole:
            length = float(np.hypot(*(end - start)))
            count = int(1.5 * length / period) + 16
            at, spans = -rng.uniform(2.0, 3.0) * period, np.zeros((0, 2))
            while at < length:
                more, at = _in_turn(trace, bridge, at, count, rng)
                spans = np.concatenate([spans, more])
            spans = spans[(spans[:, 1] > 0.0) & (spans[:, 0] < length)]
            ends.append(start + spans[:, :, None] * (end - start) / length)
        return Drawn(ends=np.concatenate(ends), carriers=whole)


@dataclass(frozen=True)
class Voronoi(JointModel):
    """Voronoi cells of random points.

    Area over ``spacing`` squared cells, or ``count`` of them.  With ``rounds`` above 0 the points
    move to the centroids of their cells, which then become more regular (Lloyd 1982).
    """

    name = "voronoi"
    cells = True
    takes = frozenset({"spacing"})
    count: int | None = None
    """Number of cells; from the spacing if absent."""
    rounds: int = 0
    """Number of times that points move to the centroids of their cells."""

    @property
    def needs(self) -> tuple[tuple[str, ...], ...]:
        """Return the spacing, unless the number of cells is given."""
        return () if self.count else (("spacing",),)

    def lines(self, plan: Plan, rng: np.random.Generator) -> Drawn:
        """Return the edges of the cells, m."""
        low, high = plan.window.box
        count = max(round(self.blocks(plan)), 1)
        points = np.zeros((0, 2))
        while len(points) < count:
            more = rng.uniform(low, high, (2 * (count - len(points)) + 16, 2))
            inside = shapely.contains_xy(plan.window.polygon, more[:, 0], more[:, 1])
            points = np.concatenate([points, more[inside]])[:count]
        for _ in range(self.rounds):
            points = _centroids(points, plan)
        diagram = _diagram(points, plan)
        ridges = np.array(diagram.ridge_vertices)
        return Drawn(ends=diagram.vertices[ridges[(ridges >= 0).all(axis=1)]])

    def blocks(self, plan: Plan) -> float:
        """Return the number of cells."""
        if self.count:
            return float(self.count)
        return plan.window.area / plan.spacing.mean**2 if plan.spacing else 1.0


def _endless(plan: Plan, density: float, rng: np.random.Generator) -> Floats:
    """Return lines of Poisson of a density, m/m2, that cross the circle about the window."""
    window = plan.window
    count = int(rng.poisson(2.0 * window.radius * density))
    units = plan.direction.along_traces(rng, count)
    place = rng.uniform(-window.radius, window.radius, count)
    normal = np.stack([-units[:, 1], units[:, 0]], axis=1)
    return along(window.center + place[:, None] * normal, units, 1.01 * window.radius)


def _diagram(points: Floats, plan: Plan) -> Diagram:
    """Return the cells of points (n, 2); far points about them close those at the rim."""
    far = 20.0 * plan.window.radius
    turn = np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False)
    ring = plan.window.center + far * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return Diagram(np.concatenate([points, ring]))


def _centroids(points: Floats, plan: Plan) -> Floats:
    """Return the centroids of the cells of points (n, 2) inside the window; others stay."""
    diagram = _diagram(points, plan)
    cells = [diagram.vertices[diagram.regions[diagram.point_region[k]]] for k in range(len(points))]
    inside = shapely.intersection(
        np.array([shapely.Polygon(cell).convex_hull for cell in cells]), plan.window.polygon
    )
    at = shapely.get_coordinates(shapely.centroid(inside))
    held = shapely.contains_xy(plan.window.polygon, at[:, 0], at[:, 1])
    return np.where(held[:, None], at, points)
