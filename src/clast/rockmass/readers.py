"""Finished blocks in: archives, tables and drawings of closed lines.

| file | form of blocks |
| --- | --- |
| .npz | as ``write_blocks_npz`` writes them |
| .csv | rows of one ``block`` in their order: block, x, y [, joint [, rock]] [, vertex] |
| .dxf | a closed line or a face on any layer but JOINTS; its rock is the layer's name |
| any other | a block of Shi's block file |

Lines on the layers JOINTS and JOINTS_name of a DXF are the joints of the edges that lie on them.
Blocks of a DXF have the name of their layer, with a number where it has several; those of a table
the name in its column.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import shapely
from scipy.spatial import cKDTree

from clast.errors import CaseError, shortened
from clast.model.arrays import Floats, following
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of, counter_clockwise
from clast.rockmass.drawings.blocks_out import HEADING as BLOCK_COLUMNS
from clast.rockmass.drawings.blocks_out import read_blocks_npz
from clast.rockmass.drawings.csv_lines import read_csv, table_of
from clast.rockmass.drawings.dda_xml import read_dda_xml
from clast.rockmass.drawings.drawing import DEFAULT_JOINT, DEFAULT_ROCK, Drawing, LeftOut
from clast.rockmass.drawings.drawing_files import checked_file
from clast.rockmass.drawings.drawn_loops import without_repeats
from clast.rockmass.drawings.dxf import (
    DxfReading,
    MissingLayer,
    numbered,
    read_dda_dxf,
    read_dxf,
    role_of,
)
from clast.rockmass.drawings.dxf_entities import DxfContent, Piece, dxf_content
from clast.rockmass.drawings.features import READERS as FEATURE_READERS
from clast.rockmass.drawings.features import feature_lines, feature_outline, features_of
from clast.rockmass.drawings.shi_files import read_shi_analysis, read_shi_blocks, read_shi_geometry


@dataclass(frozen=True, kw_only=True)
class BlockReading:
    """How blocks are read, as far as the kind of file asks."""

    dxf: DxfReading = field(default_factory=DxfReading)
    layer: str | None = None
    """Layer of a DXF on which the blocks are, case-blind; all but JOINTS if absent."""
    near: float | None = None
    """Edges this near to a joint of a DXF lie on it, m; 1e-6 of the diagonal if absent."""


def read_blocks(path: str | Path, reading: BlockReading | None = None) -> Blocks:
    """Return the blocks of a file, m, counter-clockwise: .npz, .csv, .dxf, else Shi's block file.

    Blocks that run clockwise are turned round, and noted.  Raises CaseError for files that hold no
    blocks, naming the line or the entity.
    """
    path, how = Path(path), reading or BlockReading()
    reader = BLOCK_READERS.get(path.suffix.casefold())
    return counter_clockwise(reader(path, how) if reader else read_shi_blocks(path))


def has_blocks(path: Path) -> bool:
    """Return whether a file can only hold finished blocks: an archive, or a table of blocks."""
    ending = path.suffix.casefold()
    return ending == ".npz" or (ending == ".csv" and "block" in table_of(path).columns)


def read_blocks_csv(path: str | Path) -> Blocks:
    """Return the blocks of a CSV file with the columns block, x, y, m; joint and rock if given.

    The rows of a block stand together, in the order of its vertices; the joint is that of the edge
    to the next vertex, the rock that of the block's first row.
    """
    table = table_of(Path(path))
    missing = [name for name in ("block", "x", "y") if name not in table.columns]
    if missing:
        remedy = "a table of blocks has the columns block, x, y and may have joint and rock"
        raise CaseError(f"has no column {', '.join(missing)}", where=table.heading, remedy=remedy)
    rows = table.rows
    names = [row.text("block") for row in rows]
    first = [k for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    ended: set[str] = set()
    for k, end in pairwise([*first, len(rows)]):
        faults = {
            "names no block": not names[k],
            f"goes on with block {names[k]}, whose rows ended before": names[k] in ended,
            f"block {names[k]} has {end - k} vertices, and a block at least 3": end - k < 3,
        }
        for fault, there in faults.items():
            if there:
                remedy = "list the vertices of a block in consecutive rows"
                raise rows[k].fault(fault, remedy, "block")
        ended.add(names[k])
    points = np.array([row.point() for row in rows])
    rocks = [rows[k].text("rock", DEFAULT_ROCK) for k in first]
    joints = [row.text("joint") for row in rows]
    reason = "a table of blocks has no such column"
    left = [
        LeftOut(what=f"column {name}", place=table.heading, reason=reason)
        for name in table.columns
        if name not in BLOCK_COLUMNS
    ]
    own = [names[k] for k in first]
    if own == [str(k) for k in range(len(own))]:  # as clast writes them: numbers, no names
        own = []
    blocks = blocks_of(points, [*first, len(rows)], rocks, joints, table.file, own)
    return replace(blocks, notes=table.notes, left_out=tuple(left))


def read_blocks_dxf(path: str | Path, reading: BlockReading | None = None) -> Blocks:
    """Return the closed lines of a DXF as blocks, m, of the rock that their layer names."""
    path, how = Path(path), reading or BlockReading()
    asked = None if how.layer is None else how.layer.strip().casefold()
    content = dxf_content(path, lambda _: True, how.dxf.unit, how.dxf.sagitta)
    loops: list[Floats] = []
    drawn: list[Piece] = []
    lines: list[tuple[Floats, str]] = []
    left = [*content.left_out, *content.elsewhere]
    for piece in content.pieces:
        role, name = role_of(piece.layer)
        points = without_repeats(content.flat(piece), 0.0)
        ends_meet = len(piece.points) > 2 and (piece.points[0] == piece.points[-1]).all()
        reason = ""
        if role == "joints":
            lines.append((points, name or DEFAULT_JOINT))
            continue
        if len(points) > 2 and (points[0] == points[-1]).all() and role == "":
            points = points[:-1]
        if asked is not None and piece.layer.strip().casefold() != asked:
            reason = f"the blocks are on the layer {how.layer}"
        elif len(points) < 3 or not (piece.closed or ends_meet):
            reason = "a block is a closed line of at least 3 corners"
        if reason:
            left.append(piece.left_out(piece.kind, reason))
        else:
            loops.append(points)
            drawn.append(piece)
    if not loops:
        raise _no_blocks(path, content, how.layer)
    repeats = _drawn_again(loops, how.near)
    kept = [k for k in range(len(loops)) if k not in repeats]
    start = np.cumsum([0, *(len(loops[k]) for k in kept)])
    layers = [drawn[k].layer.strip() for k in kept]
    rocks = layers if asked is None else [DEFAULT_ROCK] * len(kept)
    names = list(numbered(layers, "block"))
    corners = np.concatenate([loops[k] for k in kept])
    blocks = blocks_of(corners, start, rocks, None, str(path), names)
    notes = (
        content.unit_source,
        *(n for n in content.notes if n != content.unit_source),
        *_again_note({drawn[k]: drawn[first] for k, first in repeats.items()}),
    )
    joints = _joints(blocks, lines, how.near)
    return replace(
        blocks, edge_joint=joints, layer=tuple(layers), notes=notes, left_out=tuple(left)
    )


def _no_blocks(path: Path, content: DxfContent, layer: str | None) -> CaseError:
    """Return the refusal of a drawing without blocks, with the kinds of entities that it has."""
    what = f"has no closed line{'' if layer is None else f' on the layer {layer}'}"
    kinds = Counter(one.kind for one in content.pieces)
    kinds.update(one.place.split()[0] for one in content.left_out)
    if kinds:
        what += f", but {', '.join(f'{count} {kind}' for kind, count in kinds.items())}"
    remedy = "draw each block as one closed polyline, SOLID or 3DFACE; the layers are: "
    return CaseError(what, where=str(path), remedy=remedy + ", ".join(content.layers[:20]))


def _drawn_again(loops: list[Floats], near: float | None) -> dict[int, int]:
    """Return the loops that repeat an earlier one within a distance, m, and which that is."""
    bounds = np.array([[*loop.min(axis=0), *loop.max(axis=0)] for loop in loops])
    size = float(np.hypot(*(bounds[:, 2:].max(axis=0) - bounds[:, :2].min(axis=0))))
    reach = 1e-6 * size if near is None else near
    close = cKDTree(bounds - bounds[0]).query_pairs(reach, p=np.inf, output_type="ndarray")
    pairs = np.sort(close, axis=1)
    rings = np.array([shapely.LinearRing(loop) for loop in loops])
    same = shapely.hausdorff_distance(rings[pairs[:, 0]], rings[pairs[:, 1]]) <= reach
    first: dict[int, int] = {}
    for one, other in sorted(pairs[same].tolist()):
        first.setdefault(other, first.get(one, one))
    return first


def _again_note(repeats: dict[Piece, Piece]) -> Iterator[str]:
    """Yield the note on outlines that were drawn again."""
    if repeats:
        # Most outlines drawn again that a note names
        listed = [
            f"{one.place} on layer {one.layer} (as {first.place} on layer {first.layer})"
            for one, first in islice(repeats.items(), 10)
        ]
        more = f" and {len(repeats) - len(listed)} more" if len(repeats) > len(listed) else ""
        yield f"outlines drawn again were taken once: {', '.join(listed)}{more}"


def _joints(blocks: Blocks, lines: list[tuple[Floats, str]], near: float | None) -> tuple[str, ...]:
    """Return the joint of each edge: that of the line that both its ends lie on, shape (nv,)."""
    joints = np.full(len(blocks.vertices), "", object)
    drawn = [(line, name) for line, name in lines if len(line) > 1]
    if not drawn:
        return tuple(joints)
    origin = np.floor(blocks.vertices.min(axis=0))
    at = blocks.vertices - origin
    # Distance within which an edge lies on a drawn joint, over the drawing's diagonal
    reach = 1e-6 * float(np.hypot(*np.ptp(at, axis=0))) if near is None else near
    after = following(blocks.block_start)
    pieces = np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p, _ in drawn]) - origin
    names = [name for p, name in drawn for _ in range(len(p) - 1)]
    segments = shapely.linestrings(pieces)
    middle, line = shapely.STRtree(segments).query(
        shapely.points(0.5 * (at + at[after])), predicate="dwithin", distance=reach
    )
    on = np.ones(len(middle), np.bool_)
    for end in (at, at[after]):
        on &= shapely.dwithin(segments[line], shapely.points(end[middle]), reach)
    for k, number in zip(middle[on].tolist(), line[on].tolist(), strict=True):
        joints[k] = names[number]
    return tuple(joints.tolist())


BLOCK_READERS: dict[str, Callable[[Path, BlockReading], Blocks]] = {
    ".npz": lambda path, _: read_blocks_npz(path),
    ".csv": lambda path, _: read_blocks_csv(path),
    ".dxf": read_blocks_dxf,
}
"""Ending of a file's name -> who reads its blocks; any other is a block file of Shi."""


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a drawing is read, as far as its kind of file asks."""

    dxf: DxfReading = field(default_factory=DxfReading)
    mass_unit: float = 1.0
    """Kilograms in the unit of mass of Shi's files: 1000 for t, kN and kPa."""


def read_drawing(
    path: str | Path, analysis: str | Path | None = None, reading: Reading | None = None
) -> Drawing:
    """Return the drawing of a file: .dxf, .csv, .xml, of features, or a text geometry of Shi.

    A DXF file without a layer of clast is read by the convention of DDA for Windows where it has
    the texts F, L, M or H of that.  ``analysis`` is the analysis file, .xml or text, that belongs
    to a legacy geometry.  Raises CaseError for files that cannot be read.
    """
    path, how = Path(path), reading or Reading()
    reader = DRAWING_READERS.get(path.suffix.casefold())
    drawing = reader(path, how) if reader else read_shi_geometry(path, how.mass_unit)
    if analysis is None:
        return drawing
    if Path(analysis).suffix.casefold() != ".xml":
        return replace(drawing, analysis=read_shi_analysis(analysis, how.mass_unit))
    materials = read_dda_xml(analysis, how.mass_unit).analysis
    if not materials.rocks:
        raise CaseError("has no materials", where=str(analysis), remedy="give the analysis file")
    return replace(drawing, analysis=materials)


def _dxf(path: Path, how: Reading) -> Drawing:
    """Return a DXF drawing by clast's layers, else by the convention of DDA for Windows."""
    try:
        return read_dxf(path, how.dxf)
    except MissingLayer as missing:
        if any(role_of(layer)[0] for layer in missing.layers):
            raise
        refused = missing
    try:
        drawing = read_dda_dxf(path, how.dxf)
    except CaseError:
        raise refused from None
    marks = (drawing.fixed_points, drawing.load_points, drawing.measured_points)
    if any(marks) or drawing.hole_points:
        return drawing
    raise refused


def _not_read(path: Path, how: Reading) -> Drawing:
    """Refuse kinds of file that are known not to be drawings."""
    checked_file(path)
    what = f"a {shortened(path.suffix)} file is not a drawing that clast can read"
    remedy = "save it as DXF (R2000 or later), or as CSV with a heading x1,y1,x2,y2"
    raise CaseError(what, where=str(path), remedy=remedy)


def _features(path: Path, how: Reading) -> Drawing:
    """Return the one polygon of a file of features as the boundary, or its lines as traces."""
    parts = [shapely.get_parts(one.shape) for one in features_of(path)]
    if all(part.geom_type == "Polygon" for part in np.concatenate(parts)):
        boundary, notes = feature_outline(path)
        return Drawing(file=str(path), boundary=boundary, notes=notes)
    traces, notes = feature_lines(path)
    return Drawing(file=str(path), traces=traces, notes=notes)


DRAWING_READERS: dict[str, Callable[[Path, Reading], Drawing]] = {
    ".dxf": _dxf,
    ".csv": lambda path, _: read_csv(path),
    **dict.fromkeys(FEATURE_READERS, _features),
    ".xml": lambda path, how: read_dda_xml(path, how.mass_unit),
    **dict.fromkeys((".dwg", ".svg", ".pdf", ".png", ".toml", ".xlsx", ".xls", ".npz"), _not_read),
}
"""Ending of a file's name -> who reads it; any other is a text geometry of Shi."""
