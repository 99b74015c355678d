"""All lines that cut a domain, table by table, about the origin of the cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError
from clast.model.model import Floats, Ints
from clast.model.ranges import check_names
from clast.rockmass.domain import Domain, Opening, Outline, Region, Trace, outline
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.masonry import BlockPattern
from clast.rockmass.joints.plan import NONE, Drawn, Plan, Window
from clast.rockmass.noding import snapped, through

WELDED = "welded"
"""Joint of the edges that split a ring: they are not joints, and hold for good."""
CONSTRUCTION = "construction-joint:"
"""Begin of the name of the joint along an opening until it is excavated; its name follows."""
TOGETHER = 1.5
"""Outlines are one where they are nearer than this many cells: sqrt(1/2) twice, and round-off."""
PLACES = 5
"""Places that a note or a finding names."""
OVER = 4.0
"""Lines that end at the boundary are cut this many cells beyond it, so that they do reach it."""


@dataclass(frozen=True, kw_only=True)
class LineTable:
    """Lines of one table: a set, a trace, an outline."""

    name: str
    """Name of the set, trace, region, opening or pattern."""
    joint: str | None
    """Joint of its lines."""
    ends: Floats
    """Lines inside the domain, m, about the origin of the cut, shape (n, 2, 2)."""
    whole: bool = False
    """Whether its lines are counted by ``faces``, as those of cells, courses and outlines."""
    faces: float = 0.0
    """Blocks that such lines make alone."""
    courses: bool = False
    """Whether it is one of the two tables of a pattern of blocks."""


@dataclass(frozen=True, kw_only=True)
class SetLines:
    """Lines of a joint set, with its requested statistics."""

    name: str
    plan: Plan | None
    """Its plan; None for drawn traces."""
    window: Window
    ends: Floats
    """Lines in the window, m, shape (n, 2, 2)."""
    carriers: Floats
    """Whole lines that traces lie on, in the window, m, shape (k, 2, 2)."""
    table: int
    """Its table."""


@dataclass(frozen=True, kw_only=True)
class Site:
    """The domain to cut, checked, about an origin near it."""

    domain: Domain
    outline: Outline
    openings: Sequence[Opening]
    opening_outlines: Sequence[Outline]
    regions: Sequence[Region]
    region_outlines: Sequence[Outline]
    snapped: Floats
    """Corners of openings that were moved onto other outlines, m, shape (k, 2)."""

    @cached_property
    def origin(self) -> Floats:
        """Whole metres next to the lower left of the domain, m, shape (2,)."""
        return np.floor(self.outline.corners.min(axis=0))

    @cached_property
    def grid(self) -> float:
        """The tolerance, m."""
        return self.domain.grid()

    @cached_property
    def window(self) -> Window:
        """The domain as a window."""
        return Window(polygon=self.outline.polygon(self.origin))

    def polygons(self, outlines: Sequence[Outline]) -> list[Any]:
        """Return outlines as shapely polygons about the origin."""
        return [one.polygon(self.origin) for one in outlines]

    @property
    def turned(self) -> tuple[str, ...]:
        """Say which outlines were turned round."""
        named = [("domain, boundary", self.outline)]
        named += [
            (o.where, one) for o, one in zip(self.openings, self.opening_outlines, strict=True)
        ]
        named += [(r.where, one) for r, one in zip(self.regions, self.region_outlines, strict=True)]
        return tuple(f"{name}: clockwise, turned round" for name, one in named if one.turned)


def site(domain: Domain, openings: Sequence[Opening], regions: Sequence[Region]) -> Site:
    """Return the domain to cut; ModelError for invalid outlines, or outlines outside the domain."""
    domain.check()
    rim = domain.outline()
    # A corner moves to the middle of its cell, and with it the line that passes through that cell.
    reach, moved = TOGETHER * domain.grid(), [np.zeros((0, 2))]
    outlines: list[Outline] = []
    for one in openings:
        shape, points = _snapped_outline(one, [rim, *outlines], reach)
        outlines.append(shape)
        moved.append(points)
    check_names("opening", [one.name for one in openings])
    check_names("region", [one.name for one in regions])
    found = Site(
        domain=domain,
        outline=rim,
        openings=openings,
        opening_outlines=outlines,
        snapped=np.concatenate(moved),
        regions=regions,
        region_outlines=[one.outline() for one in regions],
    )
    outer = found.window.polygon
    where = [*(one.where for one in openings), *(one.where for one in regions)]
    shapes = found.polygons([*found.opening_outlines, *found.region_outlines])
    for label, polygon in zip(where, shapes, strict=True):
        if shapely.intersection(outer, polygon).area <= found.grid * polygon.length:
            gap = float(shapely.distance(outer, polygon))
            away = f"{gap:.3g} m away from it" if gap > 0.0 else "and touches it at most"
            raise ModelError(
                f"lies outside the domain, {away}",
                where=label,
                remedy="move it, or widen the boundary of the domain",
            )
    _check_single_blocks(found)
    return found


def _check_single_blocks(at: Site) -> None:
    """Refuse regions of one block each that share some of it."""
    single = [
        (one.where, polygon)
        for one, polygon in zip(at.regions, at.polygons(at.region_outlines), strict=True)
        if one.one_block
    ]
    for (here, one), (there, other) in combinations(single, 2):
        if shapely.intersection(one, other).area > at.grid * min(one.length, other.length):
            raise ModelError(
                f"overlaps {there}, and both have one_block",
                where=f"{here}, one_block",
                remedy="move one of them, or leave one_block out",
            )


def _snapped_outline(
    one: Opening, others: Sequence[Outline], reach: float
) -> tuple[Outline, Floats]:
    """Return the outline of an opening with its corners on outlines within reach, and which moved.

    Outlines that nearly coincide are meant to: a sliver between them would be no rock.
    """
    shape = one.outline()
    origin = shape.corners[0]
    edges = np.concatenate([other.edges for other in others]) - origin
    at = shape.corners - origin
    found = snapped(np.stack([at, at], axis=1), edges, reach)
    corners, met = through(found.ends[:, 0], edges[:, 0], reach)
    moved = np.concatenate([found.moved, met])
    if np.array_equal(corners, at):
        return shape, moved
    again = outline(corners + origin, one.where)
    return Outline(corners=again.corners, turned=shape.turned), moved + origin


def set_lines(
    at: Site, sets: Sequence[JointSet], traces: Sequence[SetLines], seed: int
) -> list[SetLines]:
    """Return the lines of joint sets, those that end at others after them, in their own order."""
    check_names("joint_set", [one.name for one in sets])
    drawn: dict[str, Floats] = {}
    for trace in traces:
        drawn[trace.name] = np.concatenate([drawn.get(trace.name, NONE), trace.ends])
    found: dict[int, SetLines] = {}
    waiting = list(enumerate(sets))
    known = tuple(dict.fromkeys([*(one.name for one in sets), *drawn]))
    for _, one in waiting:
        one.check()
        for name in one.terminates_at or ():
            if name not in known:
                raise ModelError(
                    f"there is no set '{name}'",
                    where=f"{one.where}, terminates_at",
                    remedy=spelling.advice(name, known, kind="set"),
                )
    left = {one.name for one in sets}
    while waiting:
        ready = [(n, one) for n, one in waiting if not set(one.terminates_at or ()) & left]
        if not ready:
            raise ModelError(
                "sets terminate at each other: " + ", ".join(one.name for _, one in waiting),
                where=f"{waiting[0][1].where}, terminates_at",
                remedy="let one of them terminate at none of the others",
            )
        for number, one in ready:
            bounds = np.concatenate([NONE, *(drawn[name] for name in one.terminates_at or ())])
            found[number] = _drawn(at, one, number, seed, bounds)
        for _, one in ready:
            left.discard(one.name)
        for number, one in ready:
            drawn[one.name] = np.concatenate([drawn.get(one.name, NONE), found[number].ends])
        waiting = [(n, one) for n, one in waiting if one.name in left]
    return [found[number] for number in range(len(sets))]


def _window(at: Site, one: JointSet) -> Window:
    """Return the part of the domain in which a set has lines."""
    if one.within is None:
        return at.window
    where = f"{one.where}, within"
    if isinstance(one.within, str):
        names = [region.name for region in at.regions]
        if one.within not in names:
            raise ModelError(
                f"there is no region '{one.within}'",
                where=where,
                remedy=spelling.advice(one.within, names, kind="region"),
            )
        shape = at.region_outlines[names.index(one.within)]
    else:
        shape = outline(one.within, where)
    polygon = shapely.intersection(at.window.polygon, shape.polygon(at.origin))
    if polygon.area <= at.grid * polygon.length:
        raise ModelError("lies outside the domain", where=where, remedy="move it")
    return Window(polygon=polygon)


def plan_of(at: Site, one: JointSet, bounds: Floats) -> Plan:
    """Return the plan of a set in its window."""
    return one.plan(_window(at, one), at.domain.section_azimuth, at.origin, bounds)


def _drawn(at: Site, one: JointSet, number: int, seed: int, bounds: Floats) -> SetLines:
    # Bounds that end at each other part the window only if they do reach each other.
    plan = plan_of(at, one, lengthened(bounds, at.grid))
    drawn: Drawn = one.model.lines(plan, one.random(seed, number))
    ends = plan.window.clipped(drawn.ends)
    rim = shapely.boundary(at.window.polygon)
    lines = shapely.linestrings(ends)
    # A line along the boundary cuts nothing.
    along = shapely.distance(shapely.centroid(lines), rim) <= at.grid
    near = shapely.points(ends.reshape(-1, 2))
    along &= (shapely.distance(near, rim).reshape(-1, 2) <= at.grid).all(axis=1)
    ends = ends[~along & (shapely.length(lines) > 0.0)]
    if len(ends) == 0:
        raise _cuts_nothing(plan, one, drawn)
    return SetLines(
        name=one.name,
        plan=plan,
        window=plan.window,
        ends=ends,
        carriers=plan.window.clipped(drawn.carriers),
        table=number,
    )


def _cuts_nothing(plan: Plan, one: JointSet, drawn: Drawn) -> ModelError:
    what = "cuts nothing"
    if len(drawn.ends):
        gap = float(shapely.distance(shapely.linestrings(drawn.ends), plan.window.polygon).min())
        what += (
            f": its nearest line passes {gap:.3g} m beside the domain"
            if gap
            else (": its lines run along the boundary, or are shorter than the tolerance")
        )
    else:
        what += f": {one.model.blocks(plan):.3g} lines are expected, and none was drawn"
    return ModelError(
        what,
        where=one.where,
        remedy="move its origin into the domain, or lower its spacing (raise its intensity)",
    )


@dataclass(frozen=True, kw_only=True)
class Drawings:
    """Drawn traces, clipped and snapped."""

    lines: list[SetLines]
    """Pieces of each trace in the domain, none for those outside."""
    snapped: Floats
    """Points that were moved onto others, m, shape (k, 2)."""
    notes: tuple[str, ...]
    """Which traces lie outside of the domain."""


def trace_lines(at: Site, traces: Sequence[Trace], set_count: int) -> Drawings:
    """Return the pieces of drawn traces in the domain; ModelError where a set has none there."""
    pieces = [one.pieces(f"trace {k}") - at.origin for k, one in enumerate(traces, 1)]
    if not pieces:
        return Drawings(lines=[], snapped=np.zeros((0, 2)), notes=())
    rims = [at.outline]
    rims += [o for o, one in zip(at.opening_outlines, at.openings, strict=True) if one.cut]
    edges = np.concatenate([one.edges - at.origin for one in rims])
    drawn = snapped(np.concatenate(pieces), edges, at.grid)
    start = np.cumsum([0, *(len(one) for one in pieces)])
    found: list[SetLines] = []
    beside: dict[int, float] = {}
    for k, one in enumerate(traces):
        own = drawn.ends[start[k] : start[k + 1]]
        inside = at.window.clipped(own)
        inside = inside[np.hypot(*(inside[:, 1] - inside[:, 0]).T) > 0.0]
        if len(inside) == 0:
            beside[k] = float(shapely.distance(shapely.linestrings(own), at.window.polygon).min())
        found.append(
            SetLines(
                name=one.set,
                plan=None,
                window=at.window,
                ends=inside,
                carriers=NONE,
                table=set_count + k,
            )
        )
    _refuse_outside(traces, beside)
    return Drawings(lines=found, snapped=drawn.moved + at.origin, notes=_outside(beside))


def _refuse_outside(traces: Sequence[Trace], beside: dict[int, float]) -> None:
    """Refuse sets of traces none of which meets the domain; ``beside`` are distances, m."""
    for name in dict.fromkeys(one.set for one in traces):
        own = [k for k, one in enumerate(traces) if one.set == name]
        if all(k in beside for k in own):
            gap = min(beside[k] for k in own)
            what = (
                "cuts nothing" if len(own) == 1 else f"no trace of the set '{name}' cuts anything"
            )
            raise ModelError(
                f"{what}: {'it' if len(own) == 1 else 'the nearest'} passes {gap:.3g} m beside "
                "the domain",
                where=f"trace {own[0] + 1}",
                remedy="check that units and origin agree with the boundary, or remove it",
            )


def _outside(beside: dict[int, float]) -> tuple[str, ...]:
    """Say which traces lie outside."""
    if not beside:
        return ()
    named = ", ".join(f"trace {k + 1} ({gap:.3g} m)" for k, gap in list(beside.items())[:PLACES])
    more = f" and {len(beside) - PLACES} more" if len(beside) > PLACES else ""
    return (f"outside of the domain, and cutting nothing: {named}{more}",)


def overreaching(at: Site, ends: Floats) -> Floats:
    """Return lines (n, 2, 2) with those ends that lie on the boundary moved beyond it."""
    rim = shapely.boundary(at.window.polygon)
    shapely.prepare(rim)
    on = shapely.dwithin(rim, shapely.points(ends.reshape(-1, 2)), 1e-2 * at.grid).reshape(-1, 2)
    return np.where(on[:, :, None], lengthened(ends, OVER * at.grid), ends)


def lengthened(ends: Floats, by: float) -> Floats:
    """Return lines (n, 2, 2) that reach further at both ends, m."""
    way = ends[:, 1] - ends[:, 0]
    way = way / np.maximum(np.hypot(*way.T), 1e-300)[:, None] * by
    return ends + np.stack([-way, way], axis=1)


def tables(
    at: Site,
    sets: Sequence[JointSet],
    lines: Sequence[SetLines],
    traces: Sequence[Trace],
    patterns: Sequence[BlockPattern],
) -> list[LineTable]:
    """Return the lines of all tables in their order: later ones have the joint where they coincide.

    Sets, traces, patterns of blocks, regions, openings, and last the boundary.
    """
    check_joint_names(
        [(one.where, one.joint) for one in sets]
        + [(f"trace {k}", one.joint) for k, one in enumerate(traces, 1)]
        + [(one.where, one.joint) for one in at.regions]
        + [(one.where, one.joint) for one in patterns]
        + [(one.where, one.head_joint) for one in patterns]
    )
    joints = [(one.joint, one.model) for one in sets] + [(one.joint, None) for one in traces]
    found = []
    for one, (joint, model) in zip(lines, joints, strict=True):
        cells = model is not None and model.cells
        faces = model.blocks(one.plan) - 1.0 if cells and model and one.plan else 0.0
        # The pieces of a polyline are one line, which meets itself at its corners only.
        drawn = one.plan is None
        found.append(
            LineTable(
                name=one.name,
                joint=joint,
                ends=overreaching(at, one.ends),
                whole=cells or drawn,
                faces=float(len(one.ends) > 0) if drawn else faces,
            )
        )
    for pattern in patterns:
        found += _courses(at, pattern)
    for region, shape in zip(at.regions, at.region_outlines, strict=True):
        if region.cut:
            ends = overreaching(at, at.window.clipped(shape.edges - at.origin))
            found.append(
                LineTable(name=region.name, joint=region.joint, ends=ends, whole=True, faces=1.0)
            )
    for opening, shape in zip(at.openings, at.opening_outlines, strict=True):
        if opening.cut:
            found.append(
                LineTable(
                    name=opening.name,
                    joint=None if opening.excavated else f"{CONSTRUCTION}{opening.name}",
                    ends=shape.edges - at.origin,
                    whole=True,
                    faces=1.0,
                )
            )
    return [*found, LineTable(name="boundary", joint=None, ends=at.outline.edges - at.origin)]


def check_joint_names(named: Sequence[tuple[str, str | None]]) -> None:
    """Refuse names of joints that stand for welds; ``named`` are places and names."""
    for where, name in named:
        if name is not None and (name == WELDED or name.startswith(CONSTRUCTION)):
            raise ModelError(
                f"'{name}' is reserved for welded edges",
                where=f"{where}, joint",
                remedy="give the joint another name",
            )


def _courses(at: Site, pattern: BlockPattern) -> list[LineTable]:
    beds, heads = (at.window.clipped(one - at.origin) for one in pattern.lines())
    if len(beds) + len(heads) == 0:
        raise ModelError("lies outside the domain", where=pattern.where, remedy="move it")
    bricks = float(np.prod(pattern.bricks()))
    return [
        LineTable(
            name=pattern.name,
            joint=joint,
            ends=overreaching(at, ends),
            whole=True,
            faces=faces,
            courses=True,
        )
        for ends, joint, faces in (
            (beds, pattern.joint, bricks),
            (heads, pattern.head_joint or pattern.joint, 0.0),
        )
    ]


def joints_of(found: Sequence[LineTable]) -> tuple[tuple[str, ...], Ints]:
    """Return the names of all joints, and the joint of each table, -1 for none, shape (k,)."""
    given = dict.fromkeys(one.joint for one in found if one.joint is not None)
    names = (*given, WELDED)
    return names, np.array([-1 if t.joint is None else names.index(t.joint) for t in found])
