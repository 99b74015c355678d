"""The report of a cut: plain numbers and texts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.arrays import areas, following, polygons_of
from clast.model.model import Floats, Ints
from clast.rockmass.block_loops import Tidied
from clast.rockmass.cut_lines import PLACES_NAMED, LineTable, SetLines, Site
from clast.rockmass.faces import Whole
from clast.rockmass.joints.plan import Plan
from clast.rockmass.noding import CELLS_SHORT_OF, Noded
from clast.rockmass.planar import Graph


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Something that was done to the lines or the blocks, how often, and where first."""

    count: int = 0
    """How often."""
    places: tuple[tuple[float, float], ...] = ()
    """The first places, m, at most five."""
    length: float = 0.0
    """Length of line that it concerns, m; 0 where it concerns none."""


def finding(places: Floats, count: int | None = None, length: float = 0.0) -> Finding:
    """Return a finding with its first places (k, 2), m."""
    some = np.asarray(places, float).reshape(-1, 2)[:PLACES_NAMED]
    return Finding(
        count=len(places) if count is None else count,
        places=tuple((float(x), float(y)) for x, y in some),
        length=float(length),
    )


def place_text(place: tuple[float, float], tolerance: float) -> str:
    """Return a place (x, y), m, as text with as many decimals as the tolerance, m, has."""
    decimals = max(0, math.ceil(-math.log10(tolerance) - 1e-9))
    texts = [f"{value:.{decimals}f}" for value in place]
    x, y = (text.rstrip("0").rstrip(".") if "." in text else text for text in texts)
    return f"({x}, {y})"


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Smallest, median and largest of some sizes."""

    smallest: float
    median: float
    largest: float


def sizes(values: Floats) -> Sizes:
    """Return smallest, median and largest of values (k,)."""
    return Sizes(
        smallest=float(values.min()), median=float(np.median(values)), largest=float(values.max())
    )


LEVEL_DEG = 1e-6
"""Difference from level and from plumb, degrees, that goes down to no side."""


@dataclass(frozen=True, kw_only=True)
class SetReport:
    """Statistics of a joint set, or of the drawn traces of one name."""

    name: str
    """Name of the set."""
    lines: int
    """Straight lines inside the window."""
    length: float
    """Their length, m."""
    p21: float
    """Length per area of the window, m/m2."""
    p21_asked: float | None
    """Intensity that is asked for, directly or by the spacing, m/m2."""
    p10: float
    """Lines per length of all scanlines along the normal of the set, 1/m."""
    persistence: float
    """Share of the lines that is trace."""
    persistence_asked: float
    """Share asked for: t/(t + g)."""
    kept: float
    """Share of the length that became edges of blocks."""
    angle: float | None = None
    """Mean angle of its traces in the section, degrees counter-clockwise from +x, in (-90, 90]; its
    size is the apparent dip.  None: drawn traces, and sets without a direction."""
    spacing_factor: float = 1.0
    """Spacing in the section over spacing in space, for sets given by dip and dip direction."""

    @property
    def seen(self) -> str:
        """Its apparent dip and to which side it goes down, "34.1° to the left"; "" without one."""
        if self.angle is None:
            return ""
        steep = abs(self.angle)
        side = "" if steep < LEVEL_DEG or steep > 90.0 - LEVEL_DEG else " to the "
        return f"{steep:.3g}°" + (side and side + ("left" if self.angle > 0.0 else "right"))


@dataclass(frozen=True, kw_only=True)
class CutReport:
    """Number and quality of the blocks of a cut, and changes to its input."""

    blocks: int
    """Number of blocks."""
    estimate: int
    """Blocks that the lines make by Euler's formula, before small ones are merged, holes split."""
    domain_area: float
    """Area of the domain without voids, m2."""
    area: float
    """Sum of the areas of the blocks, m2."""
    area_error: float
    """Difference of the two as a share of the domain."""
    block_area: Sizes
    """Areas of the blocks, m2."""
    edge_length: Sizes
    """Lengths of their edges, m."""
    aspect: Sizes
    """Longer over shorter side of the smallest rectangle about each block."""
    tolerance: float
    """Grid to which lines were rounded, m."""
    smallest_edge: float
    """Length below which edges were collapsed, m."""
    smallest_block: float
    """Area below which blocks were merged, m2."""
    sets: tuple[SetReport, ...]
    """Joint sets, and drawn traces by their set."""
    dangling: Finding
    """Ends of lines that border nothing, and bridges: taken out."""
    loose: Finding
    """Those of them that stop just short of another line, within ten tolerances."""
    collapsed: Finding
    """Edges that were collapsed."""
    merged: Finding
    """Blocks that joined a neighbour."""
    rings: Finding
    """Holes and touching loops that were split by welds."""
    coincident: Finding
    """Edges on which lines of different joints coincide; the later table has it."""
    snapped: Finding
    """Points of traces and outlines that moved to points or lines within the tolerance."""
    short_edges: int
    """Edges that stayed shorter: corners of outlines, or collapsing them would spoil a block."""
    small_blocks: int
    """Blocks that stayed smaller, because no neighbour would leave a simple loop."""
    notes: tuple[str, ...] = field(default=())
    """Other changes to the input, e.g. boundaries that were turned round."""
    warnings: tuple[str, ...] = field(default=())
    """Doubts about the input, each with its remedy."""

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain dictionaries, lists, numbers and texts, for JSON."""
        return asdict(self)


@dataclass(frozen=True, kw_only=True)
class CutLines:
    """All lines before they meet, with their tables and the changes made to them."""

    site: Site
    """The domain to cut."""
    lines: Sequence[SetLines]
    """Joint sets, then drawn traces."""
    tables: Sequence[LineTable]
    """Tables of all lines, the boundary last."""
    smallest_edge: float
    """Shorter edges are collapsed, m."""
    smallest_block: float
    """Smaller blocks are merged, m2."""
    estimate: int
    """Blocks that are expected."""
    snapped: Floats
    """Points that were moved to others, m, shape (k, 2)."""
    notes: tuple[str, ...]
    """Other changes to the input, and omissions."""

    @cached_property
    def ends(self) -> Floats:
        """Ends of all lines, m, about the origin of the cut, shape (n, 2, 2)."""
        return np.concatenate([one.ends for one in self.tables])

    @cached_property
    def table(self) -> Ints:
        """Table of each line, shape (n,)."""
        return np.repeat(np.arange(len(self.tables)), [len(one.ends) for one in self.tables])


@dataclass(frozen=True, kw_only=True)
class CutRecord:
    """All that a cut went through."""

    lines: CutLines
    """Its lines."""
    joint: Ints
    """Joint of each table."""
    net: Noded
    """Pieces of the lines."""
    whole: Whole
    """Faces without holes."""
    dangling: Graph
    """Edges that were taken out."""
    blocks: Tidied
    """Blocks after short edges and small blocks have been removed."""
    vertices: Floats
    """Vertices of the blocks, m, shape (nv, 2)."""
    loose: Floats
    """Ends that were taken out just short of another line, cells, shape (k, 2)."""


def report_of(work: CutRecord) -> CutReport:
    """Return the report of a cut."""
    lines, at, blocks = work.lines, work.lines.site, work.blocks
    area = areas(work.vertices, blocks.start)
    edge = np.hypot(*(work.vertices[following(blocks.start)] - work.vertices).T)
    voids = shapely.unary_union([one.polygon for one in at.openings if one.given.excavated])
    domain_area = at.window.area - float(shapely.intersection(voids, at.window.polygon).area)
    total = float(np.sum(area))
    error = (total - domain_area) / domain_area

    def place(cells: Floats | Ints) -> Floats:
        return np.asarray(cells, float).reshape(-1, 2) * at.grid + at.origin

    merged = np.concatenate([work.whole.islands, blocks.merged])
    loose = finding(place(work.loose))
    return CutReport(
        blocks=len(area),
        estimate=lines.estimate,
        domain_area=domain_area,
        area=total,
        area_error=error,
        block_area=sizes(area),
        edge_length=sizes(edge),
        aspect=sizes(_aspects(work)),
        tolerance=at.grid,
        smallest_edge=lines.smallest_edge,
        smallest_block=lines.smallest_block,
        sets=_sets(work),
        dangling=finding(
            place(work.dangling.middles), length=float(work.dangling.lengths.sum()) * at.grid
        ),
        loose=loose,
        collapsed=finding(place(blocks.collapsed)),
        merged=finding(place(merged), count=work.whole.island_blocks + len(blocks.merged)),
        rings=finding(place(work.whole.split)),
        coincident=_coincident(work),
        snapped=finding(lines.snapped),
        short_edges=blocks.short_edges,
        small_blocks=blocks.small_blocks,
        notes=(*lines.notes, *_area_note(error, at)),
        warnings=_loose_ends(loose, at.grid),
    )


def _loose_ends(loose: Finding, grid: float) -> tuple[str, ...]:
    """Warn of ends that stop just short of another line: blocks are one that should be two."""
    if loose.count == 0:
        return ()
    places = ", ".join(place_text(at, grid) for at in loose.places)
    rest = loose.count - len(loose.places)
    more = f" and {rest} more" if rest else ""
    ends = "an end of a line stops" if loose.count == 1 else f"{loose.count} ends of lines stop"
    return (
        f"cut: {ends} less than {CELLS_SHORT_OF * grid:.3g} m short of another line and cut "
        f"nothing there, so that blocks stay in one piece: {places}{more}. Draw lines so that they "
        f"meet where they should, or raise domain.tolerance ({grid:.3g} m): ends within it join",
    )


def _area_note(error: float, at: Site) -> tuple[str, ...]:
    """Return a note where areas differ by no more than the grid explains; ModelError for more."""
    if abs(error) <= 1e-9:
        return ()
    length = at.window.polygon.length + sum(one.polygon.length for one in at.openings)
    if abs(error) > at.grid * length / at.window.area:
        what = f"the areas of the blocks differ from that of the domain by {error:+.2g} of it"
        remedy = "this is a fault of clast: another tolerance may get round it; please report it"
        raise ModelError(what, where="domain", remedy=remedy)
    return (
        f"the areas of the blocks differ from that of the domain by {error:+.2g} of it: thin "
        "blocks at outlines, or outlines that meet at a small angle, were left on the grid; a "
        "finer tolerance brings them onto the outlines",
    )


def _aspects(work: CutRecord) -> Floats:
    """Return longer over shorter side of the smallest rectangle about each block, shape (nb,)."""
    start = work.blocks.start
    boxes = shapely.minimum_rotated_rectangle(
        polygons_of(work.vertices - work.lines.site.origin, start)
    )
    at, of = shapely.get_coordinates(boxes, return_index=True)
    first = np.searchsorted(of, np.arange(len(start) - 1))
    one, other = (np.hypot(*(at[first + k + 1] - at[first + k]).T) for k in (0, 1))
    return np.asarray(np.maximum(one, other) / np.maximum(np.minimum(one, other), 1e-300))


def _lengths(ends: Floats) -> Floats:
    return np.asarray(np.hypot(*(ends[:, 1] - ends[:, 0]).T))


def _sets(work: CutRecord) -> tuple[SetReport, ...]:
    after = work.blocks.node[following(work.blocks.start)]
    here = work.blocks.node
    once = (here < after) & (work.blocks.line >= 0)
    length = np.hypot(*(work.net.xy[after[once]] - work.net.xy[here[once]]).T.astype(float))
    kept = np.zeros(len(work.lines.tables))
    np.add.at(kept, work.lines.table[work.blocks.line[once]], length)
    # Joint sets one by one, and drawn traces of one name together.
    groups: dict[tuple[str, bool], list[int]] = {}
    for k, one in enumerate(work.lines.lines):
        groups.setdefault((one.name, one.plan is None), []).append(k)
    ordered = sorted(groups.items(), key=lambda group: group[0][1])
    return tuple(
        _set([work.lines.lines[k] for k in some], sum(kept[some].tolist()) * work.lines.site.grid)
        for _, some in ordered
    )


def _set(some: Sequence[SetLines], kept: float) -> SetReport:
    """Return the statistics of one set, of whose lines the length ``kept``, m, became edges."""
    plan, area = some[0].plan, some[0].window.area
    ends = np.concatenate([one.ends for one in some])
    total = float(_lengths(ends).sum())
    carried = float(_lengths(some[0].carriers).sum())
    # The unit normal of lines (n, 2, 2), weighted by length, shape (2,).
    along = ends[:, 1] - ends[:, 0]
    double = 2.0 * np.arctan2(along[:, 1], along[:, 0])
    length = _lengths(ends)
    angle = 0.5 * np.arctan2((length * np.sin(double)).sum(), (length * np.cos(double)).sum())
    return SetReport(
        name=some[0].name,
        lines=len(ends),
        length=total,
        p21=total / area,
        p21_asked=float(plan.density) if plan is not None and plan.density > 0.0 else None,
        p10=frequency(ends, np.array([-np.sin(angle), np.cos(angle)]), area),
        persistence=total / carried if carried > 0.0 else 1.0,
        persistence_asked=1.0 if plan is None else float(plan.persistence),
        kept=min(kept / total, 1.0),
        angle=_angle_of(plan),
        spacing_factor=1.0 if plan is None else float(plan.direction.factor),
    )


def _angle_of(plan: Plan | None) -> float | None:
    """Return the mean angle of a set in the section, degrees in (-90, 90]; None for none."""
    if plan is None or plan.direction.angle is None:
        return None
    return float(90.0 - (90.0 - np.degrees(plan.direction.angle)) % 180.0)


def frequency(ends: Floats, scanline: Floats, area: float) -> float:
    """Return P10, 1/m: lines (n, 2, 2) met per length of scanlines along a unit vector (2,).

    All parallel scanlines over ``area`` together meet a line over its width across them:
    P10 = sum |l x m| / A (Crofton; for isotropic lines 2 P21/pi).
    """
    along = ends[:, 1] - ends[:, 0]
    return float(np.abs(along[:, 0] * scanline[1] - along[:, 1] * scanline[0]).sum() / area)


def _coincident(work: CutRecord) -> Finding:
    """Return the edges on which lines of different joints coincide, boundaries not counted."""
    at, table = work.lines.site, work.lines.table[work.net.of[:, 1]]
    inner = np.array([one.joint is not None for one in work.lines.tables])[table]
    piece, joint = work.net.of[inner, 0], work.joint[table[inner]]
    low = np.full(len(work.net.edge), np.iinfo(np.int64).max)
    high = np.full(len(work.net.edge), -1)
    np.minimum.at(low, piece, joint)
    np.maximum.at(high, piece, joint)
    both = np.flatnonzero((high >= 0) & (low != high))
    ends = work.net.xy[work.net.edge[both]] * at.grid
    middle = ends.mean(axis=1)
    inside = shapely.contains_xy(at.window.polygon, middle[:, 0], middle[:, 1])
    return finding(middle[inside] + at.origin, length=float(_lengths(ends[inside]).sum()))
