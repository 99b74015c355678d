"""All lines that cut a domain, table by table, about the origin of the cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Generic, TypeVar

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError
from clast.model.arrays import Floats, Ints, no_floats
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
CELLS_TOGETHER = 1.5
"""Outlines are one where they are nearer than this: sqrt(1/2) twice, and round-off."""
PLACES_NAMED = 5
"""Places that a note or a finding names."""
CELLS_BEYOND = 4.0
"""Lines that end at the boundary are cut this far beyond it, so that they do reach it."""


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
    """Lines of a joint set, with its requested statistics, or pieces of a drawn trace."""

    name: str
    plan: Plan | None
    """Its plan; None for drawn traces."""
    window: Window
    ends: Floats
    """Lines in the window, m, shape (n, 2, 2)."""
    carriers: Floats = no_floats(2, 2)
    """Whole lines that traces lie on, in the window, m, shape (k, 2, 2)."""


Kind = TypeVar("Kind", Opening, Region)


@dataclass(frozen=True, kw_only=True)
class PlacedOutline(Generic[Kind]):
    """An opening or a region, with its outline as it is cut."""

    given: Kind
    outline: Outline
    polygon: Any
    """Its outline as a shapely polygon about the origin of the cut, m."""


@dataclass(frozen=True, kw_only=True)
class Site:
    """The domain to cut, checked, about an origin near it."""

    domain: Domain
    outline: Outline
    openings: Sequence[PlacedOutline[Opening]]
    regions: Sequence[PlacedOutline[Region]]
    origin: Floats
    """Whole metres next to the lower left of the domain, m, shape (2,)."""
    grid: float
    """The tolerance, m."""
    window: Window
    """The domain as a window."""
    snapped: Floats
    """Corners of openings that were moved onto other outlines, m, shape (k, 2)."""

    @property
    def placed(self) -> list[PlacedOutline[Any]]:
        """Openings, then regions."""
        return [*self.openings, *self.regions]


def site(domain: Domain, openings: Sequence[Opening], regions: Sequence[Region]) -> Site:
    """Return the domain to cut; ModelError for invalid outlines, or outlines outside the domain."""
    domain.check()
    rim, grid = domain.outline(), domain.grid()
    origin = np.floor(rim.corners.min(axis=0))
    window = Window(polygon=rim.polygon(origin))
    rims, moved = [rim], [np.zeros((0, 2))]
    for one in openings:
        # A corner moves to the middle of its cell, with the line that passes through that cell.
        shape, points = _snapped_outline(one, rims, CELLS_TOGETHER * grid)
        rims.append(shape)
        moved.append(points)
    check_names("opening", [one.name for one in openings])
    check_names("region", [one.name for one in regions])
    at = Site(
        domain=domain,
        outline=rim,
        openings=[
            PlacedOutline(given=one, outline=shape, polygon=shape.polygon(origin))
            for one, shape in zip(openings, rims[1:], strict=True)
        ],
        regions=[
            PlacedOutline(
                given=one, outline=(shape := one.outline()), polygon=shape.polygon(origin)
            )
            for one in regions
        ],
        origin=origin,
        grid=grid,
        window=window,
        snapped=np.concatenate(moved),
    )
    for placed in at.placed:
        if (
            shapely.intersection(window.polygon, placed.polygon).area
            <= grid * placed.polygon.length
        ):
            gap = float(shapely.distance(window.polygon, placed.polygon))
            away = f"{gap:.3g} m away from it" if gap > 0.0 else "and touches it at most"
            what = f"lies outside the domain, {away}"
            remedy = "move it, or widen the boundary of the domain"
            raise ModelError(what, where=placed.given.where, remedy=remedy)
    for first, other in combinations([one for one in at.regions if one.given.one_block], 2):
        common = shapely.intersection(first.polygon, other.polygon).area
        if common > grid * min(first.polygon.length, other.polygon.length):
            what = f"overlaps {other.given.where}, and both have one_block"
            remedy = "move one of them, or leave one_block out"
            raise ModelError(what, where=f"{first.given.where}, one_block", remedy=remedy)
    return at


def turned(at: Site) -> tuple[str, ...]:
    """Return notes on the outlines that were turned round."""
    outlines = [("domain, boundary", at.outline)]
    outlines += [(one.given.where, one.outline) for one in at.placed]
    return tuple(f"{where}: clockwise, turned round" for where, one in outlines if one.turned)


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
    near = snapped(np.stack([at, at], axis=1), edges, reach)
    corners, met = through(near.ends[:, 0], edges[:, 0], reach)
    moved = np.concatenate([near.moved, met])
    if np.array_equal(corners, at):
        return shape, moved
    return replace(outline(corners + origin, one.where), turned=shape.turned), moved + origin


def set_lines(
    at: Site, sets: Sequence[JointSet], traces: Sequence[SetLines], seed: int
) -> list[SetLines]:
    """Return the lines of joint sets, those that end at others after them, in their own order."""
    check_names("joint_set", [one.name for one in sets])
    drawn: dict[str, Floats] = {}
    for trace in traces:
        drawn[trace.name] = np.concatenate([drawn.get(trace.name, NONE), trace.ends])
    lines: dict[int, SetLines] = {}
    waiting = list(enumerate(sets))
    known = tuple(dict.fromkeys([*(one.name for one in sets), *drawn]))
    for one in sets:
        one.check()
        for name in one.terminates_at or ():
            if name not in known:
                what = f"there is no set '{name}'"
                remedy = spelling.advice(name, known, kind="set")
                raise ModelError(what, where=f"{one.where}, terminates_at", remedy=remedy)
    while waiting:
        names = {one.name for _, one in waiting}
        ready = [(n, one) for n, one in waiting if not set(one.terminates_at or ()) & names]
        if not ready:
            what = "sets terminate at each other: " + ", ".join(one.name for _, one in waiting)
            remedy = "let one of them terminate at none of the others"
            raise ModelError(what, where=f"{waiting[0][1].where}, terminates_at", remedy=remedy)
        for number, one in ready:
            bounds = np.concatenate([NONE, *(drawn[name] for name in one.terminates_at or ())])
            lines[number] = _drawn(at, one, number, seed, bounds)
        for number, one in ready:
            drawn[one.name] = np.concatenate([drawn.get(one.name, NONE), lines[number].ends])
        waiting = [(n, one) for n, one in waiting if n not in lines]
    return [lines[number] for number in range(len(sets))]


def _window(at: Site, one: JointSet) -> Window:
    """Return the part of the domain in which a set has lines."""
    if one.within is None:
        return at.window
    where = f"{one.where}, within"
    if isinstance(one.within, str):
        names = [region.given.name for region in at.regions]
        if one.within not in names:
            remedy = spelling.advice(one.within, names, kind="region")
            raise ModelError(f"there is no region '{one.within}'", where=where, remedy=remedy)
        shape = at.regions[names.index(one.within)].outline
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
        if len(drawn.ends):
            gap = float(
                shapely.distance(shapely.linestrings(drawn.ends), plan.window.polygon).min()
            )
            why = "its lines run along the boundary, or are shorter than the tolerance"
            why = f"its nearest line passes {gap:.3g} m beside the domain" if gap else why
        else:
            why = f"{one.model.blocks(plan):.3g} lines are expected, and none was drawn"
        raise ModelError(
            f"cuts nothing: {why}",
            where=one.where,
            remedy="move its origin into the domain, or lower its spacing (raise its intensity)",
        )
    carriers = plan.window.clipped(drawn.carriers)
    return SetLines(name=one.name, plan=plan, window=plan.window, ends=ends, carriers=carriers)


def trace_lines(
    at: Site, traces: Sequence[Trace]
) -> tuple[list[SetLines], Floats, tuple[str, ...]]:
    """Return the pieces of drawn traces in the domain, clipped and snapped.

    Then the points that were moved onto others, m, (k, 2), and a note on traces outside, which have
    no pieces.  ModelError where a set has none in the domain.
    """
    if not traces:
        return [], np.zeros((0, 2)), ()
    pieces = [one.pieces(f"trace {k}") - at.origin for k, one in enumerate(traces, 1)]
    rims = [at.outline, *(one.outline for one in at.openings if one.given.cut)]
    edges = np.concatenate([one.edges - at.origin for one in rims])
    drawn = snapped(np.concatenate(pieces), edges, at.grid)
    start = np.cumsum([len(one) for one in pieces])[:-1]
    lines: list[SetLines] = []
    outside: dict[int, float] = {}
    for k, (one, ends) in enumerate(zip(traces, np.split(drawn.ends, start), strict=True)):
        inside = at.window.clipped(ends)
        inside = inside[np.hypot(*(inside[:, 1] - inside[:, 0]).T) > 0.0]
        if len(inside) == 0:
            outside[k] = float(shapely.distance(shapely.linestrings(ends), at.window.polygon).min())
        lines.append(SetLines(name=one.set, plan=None, window=at.window, ends=inside))
    return lines, drawn.moved + at.origin, _outside(traces, outside)


def _outside(traces: Sequence[Trace], outside: dict[int, float]) -> tuple[str, ...]:
    """Return a note on traces outside; ModelError for sets with no others.

    ``outside`` are their distances from the domain, m, by number.
    """
    for name in dict.fromkeys(one.set for one in traces):
        same = [k for k, one in enumerate(traces) if one.set == name]
        if all(k in outside for k in same):
            gap = min(outside[k] for k in same)
            what = f"no trace of the set '{name}' cuts anything: the nearest"
            raise ModelError(
                f"{'cuts nothing: it' if len(same) == 1 else what} passes {gap:.3g} m beside "
                "the domain",
                where=f"trace {same[0] + 1}",
                remedy="check that units and origin agree with the boundary, or remove it",
            )
    if not outside:
        return ()
    first = list(outside.items())[:PLACES_NAMED]
    named = ", ".join(f"trace {k + 1} ({gap:.3g} m)" for k, gap in first)
    more = f" and {len(outside) - len(first)} more" if len(outside) > len(first) else ""
    return (f"outside of the domain, and cutting nothing: {named}{more}",)


def overreaching(at: Site, ends: Floats) -> Floats:
    """Return lines (n, 2, 2) with those ends that lie on the boundary moved beyond it."""
    rim = shapely.boundary(at.window.polygon)
    shapely.prepare(rim)
    on = shapely.dwithin(rim, shapely.points(ends.reshape(-1, 2)), 1e-2 * at.grid).reshape(-1, 2)
    return np.where(on[:, :, None], lengthened(ends, CELLS_BEYOND * at.grid), ends)


def lengthened(ends: Floats, by: float) -> Floats:
    """Return lines (n, 2, 2) that reach further at both ends, m."""
    along = ends[:, 1] - ends[:, 0]
    along = along / np.maximum(np.hypot(*along.T), 1e-300)[:, None] * by
    return ends + np.stack([-along, along], axis=1)


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
    given = [(one.where, one.joint) for one in sets]
    given += [(f"trace {k}", one.joint) for k, one in enumerate(traces, 1)]
    given += [(one.given.where, one.given.joint) for one in at.regions]
    given += [(one.where, one.joint) for one in patterns]
    given += [(one.where, one.head_joint) for one in patterns]
    for where, name in given:
        if name is not None and (name == WELDED or name.startswith(CONSTRUCTION)):
            what = f"'{name}' is reserved for welded edges"
            raise ModelError(what, where=f"{where}, joint", remedy="give the joint another name")
    rows = []
    kinds: list[JointSet | Trace] = [*sets, *traces]
    for one, kind in zip(lines, kinds, strict=True):
        # The pieces of a polyline are one line, which meets itself at its corners only.
        whole, faces = True, float(len(one.ends) > 0)
        if isinstance(kind, JointSet) and one.plan is not None:
            whole = kind.model.cells
            faces = kind.model.blocks(one.plan) - 1.0 if whole else 0.0
        ends = overreaching(at, one.ends)
        rows.append(LineTable(name=one.name, joint=kind.joint, ends=ends, whole=whole, faces=faces))
    for pattern in patterns:
        rows += _courses(at, pattern)
    for region in at.regions:
        if region.given.cut:
            label, joint = region.given.name, region.given.joint
            ends = overreaching(at, at.window.clipped(region.outline.edges - at.origin))
            rows.append(LineTable(name=label, joint=joint, ends=ends, whole=True, faces=1.0))
    for opening in at.openings:
        if opening.given.cut:
            label = opening.given.name
            joint = None if opening.given.excavated else f"{CONSTRUCTION}{label}"
            ends = opening.outline.edges - at.origin
            rows.append(LineTable(name=label, joint=joint, ends=ends, whole=True, faces=1.0))
    return [*rows, LineTable(name="boundary", joint=None, ends=at.outline.edges - at.origin)]


def _courses(at: Site, pattern: BlockPattern) -> list[LineTable]:
    """Return the bed joints, which count the bricks, and the head joints."""
    beds, heads = (at.window.clipped(one - at.origin) for one in pattern.lines())
    if len(beds) + len(heads) == 0:
        raise ModelError("lies outside the domain", where=pattern.where, remedy="move it")
    bed = LineTable(
        name=pattern.name,
        joint=pattern.joint,
        ends=overreaching(at, beds),
        whole=True,
        faces=float(np.prod(pattern.bricks())),
        courses=True,
    )
    joint = pattern.head_joint or pattern.joint
    return [bed, replace(bed, joint=joint, ends=overreaching(at, heads), faces=0.0)]


def joints_of(tables: Sequence[LineTable]) -> tuple[tuple[str, ...], Ints]:
    """Return the names of all joints, and the joint of each table, -1 for none, shape (k,)."""
    given = dict.fromkeys(one.joint for one in tables if one.joint is not None)
    names = (*given, WELDED)
    return names, np.array([-1 if t.joint is None else names.index(t.joint) for t in tables])


def sets_of(tables: Sequence[LineTable]) -> tuple[tuple[str, ...], Ints]:
    """Return the names of the sets that cut, and the number of each table's, shape (k,).

    Tables of one name are one; those of several joints, as beds and head joints are, have these
    added.
    """
    joints: dict[str, set[str | None]] = {}
    for one in tables:
        joints.setdefault(one.name, set()).add(one.joint)
    labels = [t.name if len(joints[t.name]) == 1 else f"{t.name}: {t.joint}" for t in tables]
    names = tuple(dict.fromkeys(labels))
    return names, np.array([names.index(label) for label in labels])
