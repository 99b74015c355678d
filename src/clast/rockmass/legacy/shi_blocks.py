"""Shi's block file in: blocks as his cutting program leaves them.

Numbers in this order, by spaces: the numbers of blocks, bolts and vertices; the numbers of
fixed, load and measured points; for each block its material, its first and its last vertex (from 1,
counter-clockwise); for each vertex its joint and x, y.  After the last - first + 1 vertices of a
block come four more slots, which are passed over.  The edge from a vertex to the next one carries
the joint of the vertex.

| in the file | in clast |
| --- | --- |
| material N of a block | rock-N |
| joint N of a vertex | type-N, edge_joint of the edge that starts there; 0: none |
| what follows the vertices (bolts and points) | not taken over: they are in the geometry file |
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of
from clast.rockmass.drawings.drawing import Floats, LeftOut
from clast.rockmass.legacy.number_text import NumberText
from clast.rockmass.legacy.words import NumberRow


def read_shi_blocks(path: str | Path) -> Blocks:
    """Return the blocks of a block file of Shi's programs, m.

    Clockwise blocks are turned round and noted.  Raises CaseError with the line where it is no such
    file, and for blocks of fewer than three vertices or without area.
    """
    text = NumberText(Path(path))
    blocks, bolts = text.count("blocks", 3), text.count("bolts")
    vertices = text.count("vertices", 3)
    points = [text.count(f"{what} points") for what in ("fixed", "load", "measured")]
    if not blocks:
        raise CaseError("has no blocks", where=text.file, remedy="give the file of a cut system")
    rows = text.rows(blocks, 3, "block")
    corners = text.rows(vertices, 3, "vertex")
    parts, joints, turned = [], [], []
    for number, row in enumerate(rows, 1):
        own = _of_block(row, number, corners, text.file)
        at = np.array([one.values[1:] for one in own])
        names = [_joint(one, text.file) for one in own]
        area = _area(at)
        if area == 0.0:
            raise CaseError(f"block {number} has no area", where=f"{text.file}: {row.place}")
        if area < 0.0:
            turned.append(number)
            # The edge k, k + 1 becomes the edge that starts where it ended.
            at, names = at[::-1], [*names[-2::-1], names[-1]]
        parts.append(at)
        joints += names
    start = np.concatenate([[0], np.cumsum([len(part) for part in parts])])
    rocks = [f"rock-{row.kind(0, 'material', text.file)}" for row in rows]
    found = blocks_of(np.vstack(parts), start, rocks, joints, text.file)
    return replace(found, notes=_notes(turned), left_out=_left_out(text, bolts, points))


def _of_block(
    row: NumberRow, number: int, corners: tuple[NumberRow, ...], file: str
) -> tuple[NumberRow, ...]:
    """Return the vertices of a block, or say that its row names none."""
    _, first, last = row.values
    whole = first == round(first) and last == round(last)
    if not whole or not 1 <= first or not last <= len(corners) or last - first < 2:
        raise CaseError(
            f"block {number} has the vertices {first:g} to {last:g} of {len(corners)}",
            where=f"{file}: {row.place}",
            remedy="a block has at least 3 vertices, numbered from 1",
        )
    return corners[int(first) - 1 : int(last)]


def _joint(corner: NumberRow, file: str) -> str:
    """Return the name of the joint of a vertex, empty for 0."""
    if corner.values[0] == 0.0:
        return ""
    return f"type-{corner.kind(0, 'joint', file)}"


def _area(at: Floats) -> float:
    """Return the area of a polygon, m2, positive counter-clockwise (the shoelace formula)."""
    x, y = (at - at[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _notes(turned: list[int]) -> tuple[str, ...]:
    if not turned:
        return ()
    listed = ", ".join(str(number) for number in turned[:10])
    return (f"{len(turned)} blocks ran clockwise and were reversed: {listed}",)


def _left_out(text: NumberText, bolts: int, points: list[int]) -> tuple[LeftOut, ...]:
    """Return the bolts and points that follow the vertices."""
    words, place = text.rest()
    if not words:
        return ()
    counted = f"{bolts} bolts, {points[0]} fixed, {points[1]} load, {points[2]} measured points"
    reason = "bolts and points are taken from the geometry file, where blocks have no numbers"
    return (LeftOut(what=f"{counted}: {words}", place=place, reason=reason),)
