"""Shi's text geometry in: the input of the block cutting program of Shi's DDA.

Numbers in this order, by spaces: the node distance e00; the number of lines and, of these,
the number of boundary lines, which come first; the numbers of material lines, bolts, fixed points,
load points, measured points and hole points; then

| each | numbers | in a case of clast |
| --- | --- | --- |
| line | x1 y1 x2 y2 type | boundary lines: [domain] boundary; others: [[trace]], joint "type-N" |
| material line | x1 y1 x2 y2 material | a comment: the rock of the blocks it crosses |
| bolt | x1 y1 x2 y2 e0 t0 f0 | a comment: [[bolt]] and [bolt_kind.bolt-N] |
| fixed point | x1 y1 x2 y2 | [[fixed_point]] where both ends are equal, else a comment |
| load point | x y | [[point_load]] where the analysis gives its force, else a comment |
| measured point | x y | [[measured_point]], named M1, M2, ... |
| hole point | x y | [[opening]] in a face of the boundary lines, else a comment |

e00 stands as a comment of [domain].  ``legacy`` says how each is meant.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from clast.errors import CaseError, mistyped, shortened
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of
from clast.rockmass.drawings.drawing import Analysis, Drawing, Floats, LeftOut
from clast.rockmass.drawings.drawing_files import number_of, text_of
from clast.rockmass.drawings.legacy_words import (
    LegacyGeometry,
    NumberRow,
    check_mass_unit,
    legacy_drawing,
    legacy_joint,
    legacy_rock,
    unit_notes,
)


def read_shi_geometry(path: str | Path, mass_unit: float = 1.0) -> Drawing:
    """Return the drawing of a text geometry of Shi's programs, m.

    ``mass_unit`` is the number of kilograms in the unit of mass of bolt strengths.  Raises
    CaseError with the line where it is no such file, and where its lines enclose no area.
    """
    scale, text = check_mass_unit(mass_unit), NumberText(Path(path))
    distance = text.number("the node distance e00")
    if not 0.0 <= distance < 1.0:
        raise CaseError(
            f"{distance:g} is not a node distance e00",
            where=f"{text.file}: line 1",
            remedy="a text geometry begins with a share of the domain's size, such as 0.001",
        )
    lines, boundary = text.count("lines", 5), text.count("boundary lines")
    if boundary > lines:
        raise CaseError(
            f"{boundary} boundary lines are announced, but only {lines} lines in all",
            where=text.file,
            remedy="the first number counts all lines, boundary lines included",
        )
    counts = [
        text.count(what, width)
        for what, width in (
            ("material lines", 5),
            ("bolts", 7),
            ("fixed points", 4),
            ("load points", 2),
            ("measured points", 2),
            ("hole points", 2),
        )
    ]
    drawn = text.rows(lines, 5, "line")
    given = LegacyGeometry(
        file=text.file,
        node_distance=distance,
        boundary=drawn[:boundary],
        joints=drawn[boundary:],
        material_lines=text.rows(counts[0], 5, "material line"),
        bolts=text.rows(counts[1], 7, "bolt"),
        fixed=text.rows(counts[2], 4, "fixed point"),
        load_points=text.rows(counts[3], 2, "load point"),
        measured_points=text.rows(counts[4], 2, "measured point"),
        hole_points=text.rows(counts[5], 2, "hole point"),
        mass_unit=scale,
    )
    return legacy_drawing(replace(given, left_out=rest_of(text)))


def rest_of(text: NumberText) -> tuple[LeftOut, ...]:
    """Return the rest of the file."""
    words, place = text.rest()
    reason = "it follows the end of the expected data"
    return (LeftOut(what=words, place=place, reason=reason),) if words else ()


class NumberText:
    """The numbers of a file in their order, separated by spaces and ends of lines."""

    def __init__(self, path: Path) -> None:
        self.file = str(path)
        lines = text_of(path).split("\n")
        self._words = [(word, k) for k, line in enumerate(lines, 1) for word in line.split()]
        self._next = 0

    def number(self, what: str) -> float:
        """Return the next number, or say where ``what`` is missing or is not a number."""
        if self._next == len(self._words):
            line = f"line {self._words[-1][1]}" if self._words else "line 1"
            raise CaseError(
                f"ends before {what}",
                where=f"{self.file}: {line}",
                remedy="check that the file is complete and its counts are right",
            )
        word, line_number = self._words[self._next]
        self._next += 1
        value = number_of(word)
        if value is None:
            raise CaseError(
                f"{mistyped(word)} is not a number, or far too large: {what} is expected here",
                where=f"{self.file}: line {line_number}",
                remedy="check that it is the right kind of file and that its counts are right",
            )
        return value

    def count(self, what: str, width: int = 0) -> int:
        """Return the next number as a count of things that have ``width`` numbers each."""
        value = self.number(f"the number of {what}")
        line = self._words[self._next - 1][1]
        left = len(self._words) - self._next
        if value != round(value) or value < 0:
            raise CaseError(
                f"{value:g} is not a valid number of {what}",
                where=f"{self.file}: line {line}",
                remedy="give a whole number, 0 or more",
            )
        if value * width > left:
            raise CaseError(
                f"{value:.0f} {what} are announced, but only {left} numbers follow",
                where=f"{self.file}: line {line}",
                remedy="check that the file is complete and its counts are right",
            )
        return int(value)

    def row(self, width: int, what: str) -> NumberRow:
        """Return the next ``width`` numbers."""
        first = self._words[min(self._next, len(self._words) - 1)][1] if self._words else 1
        values = tuple(self.number(what) for _ in range(width))
        return NumberRow(values=values, place=f"line {first}")

    def rows(self, count: int, width: int, what: str) -> tuple[NumberRow, ...]:
        """Return the next ``count`` rows of ``width`` numbers."""
        return tuple(self.row(width, f"{what} {k}") for k in range(1, count + 1))

    def rest(self) -> tuple[str, str]:
        """Return the words that were not read, shortened, and where they begin; empty if none."""
        words = self._words[self._next :]
        if not words:
            return "", ""
        text = " ".join(word for word, _ in words[:12])
        more = f" ... ({len(words)} words)" if len(words) > 12 else ""
        return shortened(text, 120) + more, f"line {words[0][1]}"


def read_shi_analysis(path: str | Path, mass_unit: float = 1.0) -> Analysis:
    """Return the content of an analysis file of Shi's programs, in SI units.

    ``mass_unit`` is the kilograms in its unit of mass: 1000 for a file in t, kN and kPa.  Raises
    CaseError with the line where it is no such file.
    """
    scale, text = check_mass_unit(mass_unit), NumberText(Path(path))
    kind = text.number("the analysis type")
    if not 0.0 <= kind <= 1.0:
        raise CaseError(
            f"{kind:g} is not an analysis type",
            where=f"{text.file}: line 1",
            remedy="an analysis file begins with 0, static, or 1, dynamic",
        )
    steps = text.count("steps")
    blocks, joints = text.count("block materials", 13), text.count("joint materials", 3)
    ratio = text.number("the largest displacement ratio g2")
    step = text.number("the time step")
    for what, value in (("steps", steps), ("time step", step), ("displacement ratio", ratio)):
        if not value > 0:
            raise CaseError(
                f"the {what} is {value:g}", where=text.file, remedy="give a number above 0"
            )
    materials = text.rows(blocks, 13, "block material")
    strengths = text.rows(joints, 3, "joint material")
    rocks = tuple(
        legacy_rock(k, replace(one, values=(*one.values[:7], *one.values[10:])), scale)
        for k, one in enumerate(materials, 1)
    )
    left = [
        LeftOut(
            what=f"columns 8 to 10 of block material {k}: {' '.join(f'{v:g}' for v in tectonic)}",
            place=one.place,
            reason="clast starts from stresses alone, and these are not added to them",
        )
        for k, one in enumerate(materials, 1)
        if any(tectonic := one.values[7:10])
    ]
    return Analysis(
        rocks=rocks,
        joints=tuple(legacy_joint(k, one, scale) for k, one in enumerate(strengths, 1)),
        dynamic_ratio=kind,
        steps=steps,
        step=step,
        displacement_ratio=ratio,
        notes=tuple(unit_notes(rocks, scale)),
        left_out=(*left, *rest_of(text)),
    )


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
        names = [f"type-{one.kind(0, 'joint', text.file)}" if one.values[0] else "" for one in own]
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
    listed = ", ".join(str(number) for number in turned[:10])
    notes = (f"{len(turned)} blocks ran clockwise and were reversed: {listed}",) if turned else ()
    found = blocks_of(np.vstack(parts), start, rocks, joints, text.file)
    return replace(found, notes=notes, left_out=_left_out(text, bolts, points))


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


def _area(at: Floats) -> float:
    """Return the area of a polygon, m2, positive counter-clockwise (the shoelace formula)."""
    x, y = (at - at[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _left_out(text: NumberText, bolts: int, points: list[int]) -> tuple[LeftOut, ...]:
    """Return the bolts and points that follow the vertices."""
    words, place = text.rest()
    if not words:
        return ()
    counted = f"{bolts} bolts, {points[0]} fixed, {points[1]} load, {points[2]} measured points"
    reason = "bolts and points are taken from the geometry file, where blocks have no numbers"
    return (LeftOut(what=f"{counted}: {words}", place=place, reason=reason),)
