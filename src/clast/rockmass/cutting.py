"""From joint sets, traces, openings and regions to blocks that tile the domain.

    from clast.rockmass import Domain, JointSet, Parallel, cut

    domain = Domain(boundary=[(0, 0), (10, 0), (10, 8), (0, 8)], rock="granite")
    bedding = JointSet(name="bedding", angle=30.0, spacing=1.3, joint="bedding")
    cross = JointSet(name="cross", angle=115.0, spacing=0.9, origin=(0.2, 0.1))
    blocks = cut(domain, [bedding, cross])
    print(blocks.report.blocks)

Lines are drawn, clipped and met on a grid; edges that border no face are taken out; the remaining
faces are tidied on shared nodes, so that neighbours agree and nothing is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.arrays import following, owners, polygons_of
from clast.model.model import Bools, Floats, Ints
from clast.rockmass import block_loops as block_loops
from clast.rockmass.cut_lines import (
    CELLS_BEYOND,
    CELLS_TOGETHER,
    WELDED,
    Site,
    joints_of,
    plan_of,
    set_lines,
    sets_of,
    site,
    tables,
    trace_lines,
    turned,
)
from clast.rockmass.cut_report import CutLines, CutRecord, CutReport, report_of
from clast.rockmass.domain import Domain, Opening, Region, Trace
from clast.rockmass.estimate import check_counted, check_expected, limits_of
from clast.rockmass.faces import NOTHING, ROCK, Whole, sided, without_holes
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.masonry import BlockPattern
from clast.rockmass.joints.plan import NONE
from clast.rockmass.noding import Noded, Snapped, loose_ends, noded, snapped
from clast.rockmass.planar import Graph, bordering, straightened

Stages = Callable[[str], AbstractContextManager[None]]
"""Returns the context of a stage of the cut, by its name: entered at its start, left at its end."""


def untimed(_: str) -> AbstractContextManager[None]:
    """Return a context that does nothing."""
    return nullcontext()


@dataclass(frozen=True, kw_only=True, eq=False)
class Cut:
    """Blocks that tile the domain without its voids; frozen arrays, ragged ones flat.

    The joint "welded" is that of edges which split a ring: no joint is there.  The joint
    "construction-joint:NAME" runs along the opening NAME until a stage excavates it.
    """

    vertices: Floats
    """Vertices, counter-clockwise by block, m, shape (nv, 2)."""
    block_start: Ints
    """Index of each block's first vertex; the last is the vertex count, shape (nb + 1,)."""
    rock: Ints
    """Index into ``rock_names`` of each block, shape (nb,)."""
    edge_joint: Ints
    """Index into ``joint_names`` of the edge from each vertex to the next, shape (nv,); -1 where no
    other block is, or where no joint is named: by pair of blocks, rocks, or the default."""
    edge_set: Ints
    """Index into ``set_names`` of the set that cut the edge from each vertex to the next, shape
    (nv,); -1 where no other block is, and where a weld splits a ring."""
    opening: Ints
    """Index into ``opening_names`` of the opening that each block is part of, -1, shape (nb,)."""
    rock_names: tuple[str, ...]
    """Names of the rocks."""
    joint_names: tuple[str, ...]
    """Names of the joints; "welded" is the last."""
    set_names: tuple[str, ...]
    """Names of the joint sets, traces, patterns, regions and openings that cut."""
    opening_names: tuple[str, ...]
    """Names of the openings."""
    report: CutReport
    """Numbers of the cut, and changes to its input."""

    @property
    def block_count(self) -> int:
        """Number of blocks."""
        return len(self.block_start) - 1

    def polygon(self, block: int) -> Floats:
        """Return the outline of one block, m, shape (k, 2)."""
        return self.vertices[self.block_start[block] : self.block_start[block + 1]]


def cut(
    domain: Domain,
    sets: Sequence[JointSet] = (),
    traces: Sequence[Trace] = (),
    openings: Sequence[Opening] = (),
    regions: Sequence[Region] = (),
    seed: int = 0,
    patterns: Sequence[BlockPattern] = (),
    stages: Stages = untimed,
) -> Cut:
    """Return the blocks into which lines and outlines cut a domain.

    ``seed`` is that of all sets that have none of their own; the number of a set is part of it, so
    that another set at the end leaves the lines of the others as they were.  Where lines coincide
    the later one has the joint: sets, traces, patterns, regions, openings, boundary.  ``stages``
    may be a stopwatch: lines, noding, faces, tidying, vertices, blocks, report.

    ModelError for invalid input: outlines that cross themselves or lie outside, numbers that are
    not finite, sets that cut nothing, more blocks than ``Domain.most_blocks``.
    """
    with stages("lines"):
        lines = _drawn(site(domain, openings, regions), sets, traces, seed, patterns)
    at, ends = lines.site, lines.ends
    names, joint = joints_of(lines.tables)
    rank = _ranks(lines)
    with stages("noding"):
        met = _met(at, ends, int((rank == 0).sum()))
        net = noded(met.ends, met.carrier, met.on)
        graph = _graph(at, net, joint[lines.table], rank > 0)
    smallest2 = 2.0 * lines.smallest_block / at.grid**2
    with stages("faces"):
        whole, dangling = _faces(at, graph, smallest2)
    with stages("tidying"):
        on_grid = _on_grid(net.xy, at), at.grid
        held, places = block_loops.anchors(
            net, np.unique(whole.graph.edge), rank, ends + at.origin, on_grid
        )
        blocks = block_loops.tidied(
            whole.graph, held, joint[lines.table], lines.smallest_edge / at.grid, smallest2
        )
    with stages("vertices"):
        vertices = _vertices(blocks, places, at.grid)
    work = CutRecord(
        lines=lines,
        joint=joint,
        net=net,
        whole=whole,
        dangling=dangling,
        blocks=blocks,
        vertices=vertices,
        loose=loose_ends(net, dangling, met.ends, rank == 0),
    )
    return _assemble(work, names, stages)


def lines(
    domain: Domain,
    sets: Sequence[JointSet] = (),
    traces: Sequence[Trace] = (),
    openings: Sequence[Opening] = (),
    regions: Sequence[Region] = (),
    seed: int = 0,
    patterns: Sequence[BlockPattern] = (),
) -> Floats:
    """Return both ends of all lines that ``cut`` cuts by, outlines too, m, shape (n, 2, 2).

    Raises ModelError where the lines cannot be drawn.
    """
    drawn = _drawn(site(domain, openings, regions), sets, traces, seed, patterns)
    return drawn.ends + drawn.site.origin


def _drawn(
    at: Site,
    sets: Sequence[JointSet],
    traces: Sequence[Trace],
    seed: int,
    patterns: Sequence[BlockPattern],
) -> CutLines:
    """Return all lines by their tables, and the numbers known before they meet."""
    for one in sets:
        one.check()
    most_blocks = at.domain.most_blocks
    check_expected(sets, [plan_of(at, one, NONE) for one in sets], patterns, most_blocks)
    drawn, moved, notes = trace_lines(at, traces)
    lines = [*set_lines(at, sets, drawn, seed), *drawn]
    by_table = tables(at, sets, lines, traces, patterns)
    estimate = check_counted(by_table, sets, most_blocks)
    smallest_edge, smallest_block = limits_of(at, lines, patterns)
    return CutLines(
        site=at,
        lines=lines,
        tables=by_table,
        smallest_edge=smallest_edge,
        smallest_block=smallest_block,
        estimate=estimate,
        snapped=np.concatenate([at.snapped, moved]),
        notes=(*turned(at), *notes),
    )


def _met(at: Site, ends: Floats, free: int) -> Snapped:
    """Return all lines (n, 2, 2), in cells, with their ends on the lines that they end at.

    The first ``free`` are not outlines.  Ends of those move by a cell at most; where lines are cut
    beyond the boundary they stay.
    """
    lines = ends / at.grid
    x, y = ends[:free].reshape(-1, 2).T
    outer = ~shapely.contains_xy(at.window.polygon, x, y).reshape(-1, 2)
    met = snapped(lines[:free], lines[free:], 1.0, outer)
    return replace(met, ends=np.concatenate([met.ends, lines[free:]]))


def _ranks(lines: CutLines) -> Ints:
    """Return 2 for lines that are outlines of the rock, 1 for those of openings in it, else 0."""
    cut = [1 + one.given.excavated for one in lines.site.openings if one.given.cut]
    before = len(lines.tables) - len(cut) - 1
    return np.array([*[0] * before, *cut, 2], np.int64)[lines.table]


def _graph(at: Site, net: Noded, joint: Ints, outline: Bools) -> Graph:
    """Return the pieces as a graph, each with the latest of its lines.

    Those inside of regions that are one block are left out.
    """
    count = len(net.edge)
    line = np.zeros(count, np.int64)
    np.maximum.at(line, net.of[:, 0], net.of[:, 1])
    barrier = np.zeros(count, np.bool_)
    np.logical_or.at(barrier, net.of[:, 0], outline[net.of[:, 1]])
    side = np.full((count, 2), NOTHING, np.int64)
    graph = Graph(
        xy=net.xy, edge=net.edge, line=line, joint=joint[line], barrier=barrier, side=side
    )
    x, y = graph.middles.T
    inside = np.zeros(count, np.bool_)
    for one in at.regions:
        if one.given.one_block:
            # What is nearer to the outline than its pieces may be is one of them.
            inner = _in_cells(at, one.polygon).buffer(-CELLS_TOGETHER)
            inside |= shapely.contains_xy(inner, x, y)
    return graph.only(~inside | barrier)


def _faces(at: Site, graph: Graph, smallest2: float) -> tuple[Whole, Graph]:
    """Return the faces without holes, and the edges that border nothing, which are taken out."""
    # Later openings go before earlier ones, and voids before all.
    kinds = [
        (NOTHING if one.given.excavated else number, _in_cells(at, one.polygon))
        for number, one in enumerate(at.openings)
        if one.given.cut
    ]
    kinds.sort(key=lambda kind: kind[0] == NOTHING)
    kinds.insert(0, (ROCK, _in_cells(at, at.window.polygon)))
    border = bordering(graph)
    dangling = graph.only(~border)
    graph = sided(graph.only(border), kinds)
    graph = straightened(graph.only((graph.side != NOTHING).any(axis=1)))
    # Edges that fell together enclose nothing any more.
    while not (border := bordering(graph)).all():
        graph = straightened(graph.only(border))
    whole = without_holes(sided(graph, kinds), smallest2)
    if not (whole.graph.side != NOTHING).any():
        voids = [one.given.where for one in at.openings if one.given.excavated]
        raise ModelError(
            "nothing is left of the domain",
            where=voids[0] if len(voids) == 1 else "openings that are void from the start",
            remedy="make it smaller, or the domain larger; or let a stage excavate it: excavated = "
            "false",
        )
    return whole, _inside(at, dangling)


def _in_cells(at: Site, polygon: shapely.Polygon) -> shapely.Polygon:
    return shapely.transform(polygon, lambda xy: xy / at.grid)


def _inside(at: Site, dangling: Graph) -> Graph:
    """Return those edges whose middles lie in rock.

    Lines are cut a little beyond the boundary, and where this turns in they end in rock: ends as
    short as that are of clast's own making.
    """
    x, y = (dangling.middles * at.grid).T
    inside = shapely.contains_xy(at.window.polygon, x, y) & (dangling.lengths > CELLS_BEYOND + 2.0)
    for one in at.openings:
        if one.given.excavated:
            inside &= ~shapely.contains_xy(one.polygon, x, y)
    return dangling.only(inside)


def _on_grid(xy: Ints, at: Site) -> Floats:
    """Return nodes (nn, 2) in m: dividing by a whole number keeps decimals exact."""
    inverse = round(1.0 / at.grid)
    whole = inverse > 0 and abs(inverse * at.grid - 1.0) < 1e-12
    return at.origin + (xy / inverse if whole else xy * at.grid)


def _vertices(blocks: block_loops.Tidied, places: Sequence[Floats], grid: float) -> Floats:
    """Return the vertices (nv, 2), m: at the best places that spoil no block.

    Blocks are spoiled by short edges, as a rule: their nodes move first.
    """
    at = np.stack(places)
    choice = np.zeros(at.shape[1], np.int64)
    worst = len(places) - 1
    owner = owners(blocks.start)
    after = following(blocks.start)
    for _ in range(20):
        vertices = at[choice[blocks.node], blocks.node]
        bad = ~block_loops.sound(vertices, blocks.start)
        movable = bad[owner] & (choice[blocks.node] < worst)
        if not movable.any():
            return vertices
        short = np.hypot(*(vertices[after] - vertices).T) < block_loops.CELLS_OF_ROUNDING * grid
        short[after] |= short.copy()
        first = movable & short
        # Blocks without short edges that can move do so with all their nodes.
        rest = movable & ~np.isin(owner, owner[first])
        choice[np.unique(blocks.node[first | rest])] += 1
    return at[worst, blocks.node]


def _assemble(work: CutRecord, names: tuple[str, ...], stages: Stages) -> Cut:
    """Return the blocks with rocks, joints and openings, as frozen arrays."""
    blocks, at = work.blocks, work.lines.site
    with stages("blocks"):
        given = [at.domain.rock if o.given.rock is None else o.given.rock for o in at.regions]
        rocks = tuple(dict.fromkeys([at.domain.rock, *given]))
        rock = np.array([rocks.index(name) for name in (*given, at.domain.rock)], np.int64)
        sets, of_table = sets_of(work.lines.tables)
        uncut = [k for k, one in enumerate(at.openings) if not one.given.cut]
        lies_in = _owners(work, [at.openings[k].polygon for k in uncut])
        arrays = {
            "vertices": work.vertices,
            "block_start": blocks.start,
            "rock": rock[_owners(work, [one.polygon for one in at.regions])],
            "edge_joint": _on_edges(work, work.joint, names.index(WELDED)),
            "edge_set": _on_edges(work, of_table, -1),
            "opening": np.where(
                blocks.group >= 0, blocks.group, np.array([*uncut, -1], np.int64)[lies_in]
            ),
        }
    for name, array in arrays.items():
        arrays[name] = np.ascontiguousarray(array)
        arrays[name].setflags(write=False)
    with stages("report"):
        report = report_of(work)
    return Cut(
        **arrays,
        rock_names=rocks,
        joint_names=names,
        set_names=sets,
        opening_names=tuple(one.given.name for one in at.openings),
        report=report,
    )


def _on_edges(work: CutRecord, of_table: Ints, welded: int) -> Ints:
    """Return the number of each edge's table, of welds ``welded``, -1 on rims, shape (nv,)."""
    blocks = work.blocks
    here, there = blocks.node, blocks.node[following(blocks.start)]
    count = np.int64(here.max() + 1)
    shared = np.isin(here * count + there, there * count + here)
    number = np.append(of_table[work.lines.table], welded)[blocks.line]
    return np.where(shared, number, -1)


def _owners(work: CutRecord, polygons: Sequence[shapely.Polygon]) -> Ints:
    """Return which polygon holds most of each block, and more than half of it, else -1, (nb,)."""
    blocks = work.blocks
    count = len(blocks.group)
    if not polygons:
        return np.full(count, -1, np.int64)
    shapes = polygons_of(work.vertices - work.lines.site.origin, blocks.start)
    area = shapely.area(shapes)
    number, block = shapely.STRtree(shapes).query(polygons, predicate="intersects")
    common = np.zeros(len(block))
    for k, polygon in enumerate(polygons):
        near = np.flatnonzero(number == k)
        shapely.prepare(polygon)
        inside = shapely.contains(polygon, shapes[block[near]])
        common[near[inside]] = area[block[near[inside]]]
        rest = near[~inside]
        common[rest] = shapely.area(shapely.intersection(shapes[block[rest]], polygon))
    # Later regions go before earlier ones where both hold most of a block.
    best = np.full(count, -1, np.int64)
    most = common > 0.5 * area[block]
    np.maximum.at(best, block[most], number[most])
    return best
