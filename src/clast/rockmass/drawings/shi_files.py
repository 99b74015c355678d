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
from clast.model.arrays import areas
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of, counter_clockwise
from clast.rockmass.drawings.drawing import Analysis, Drawing, LeftOut
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
        remedy = "a text geometry begins with a share of the domain's size, such as 0.001"
        raise text.fault(f"{distance:g} is not a node distance e00", remedy, "line 1")
    lines, boundary = text.count("lines", 5), text.count("boundary lines")
    if boundary > lines:
        what = f"{boundary} boundary lines are announced, but only {lines} lines in all"
        raise text.fault(what, "the first number counts all lines, boundary lines included")
    kinds = {
        "material line": 5,
        "bolt": 7,
        "fixed point": 4,
        "load point": 2,
        "measured point": 2,
        "hole point": 2,
    }
    counts = {kind: text.count(f"{kind}s", width) for kind, width in kinds.items()}
    drawn = text.rows(lines, 5, "line")
    rows = {kind: text.rows(counts[kind], width, kind) for kind, width in kinds.items()}
    return legacy_drawing(
        LegacyGeometry(
            file=text.file,
            node_distance=distance,
            boundary=drawn[:boundary],
            joints=drawn[boundary:],
            material_lines=rows["material line"],
            bolts=rows["bolt"],
            fixed=rows["fixed point"],
            load_points=rows["load point"],
            measured_points=rows["measured point"],
            hole_points=rows["hole point"],
            mass_unit=scale,
            left_out=text.rest(),
        )
    )


class NumberText:
    """The numbers of a file in their order, separated by spaces and ends of lines."""

    def __init__(self, path: Path) -> None:
        self.file = str(path)
        lines = text_of(path).split("\n")
        self._words = [(word, k) for k, line in enumerate(lines, 1) for word in line.split()]
        self._next = 0

    def _line(self, number: int) -> str:
        """Return the line of a word, that of the last one where there are fewer."""
        return f"line {self._words[min(number, len(self._words) - 1)][1] if self._words else 1}"

    def fault(self, what: str, remedy: str, place: str = "") -> CaseError:
        """Return the error of a fault at a place of the file."""
        where = f"{self.file}: {place}" if place else self.file
        return CaseError(what, where=where, remedy=remedy)

    def number(self, what: str) -> float:
        """Return the next number; CaseError where it is missing or is not a number."""
        if self._next == len(self._words):
            remedy = "check that the file is complete and its counts are right"
            raise self.fault(f"ends before {what}", remedy, self._line(self._next))
        word = self._words[self._next][0]
        value = number_of(word)
        if value is None:
            what = f"{mistyped(word)} is not a number, or far too large: {what} is expected here"
            remedy = "check that it is the right kind of file and that its counts are right"
            raise self.fault(what, remedy, self._line(self._next))
        self._next += 1
        return value

    def count(self, what: str, width: int = 0) -> int:
        """Return the next number as a count of things that have ``width`` numbers each."""
        value, line = self.number(f"the number of {what}"), self._line(self._next - 1)
        left = len(self._words) - self._next
        if value != round(value) or value < 0:
            remedy = "give a whole number, 0 or more"
            raise self.fault(f"{value:g} is not a valid number of {what}", remedy, line)
        if value * width > left:
            what = f"{value:.0f} {what} are announced, but only {left} numbers follow"
            raise self.fault(what, "check that the file is complete and its counts are right", line)
        return int(value)

    def rows(self, count: int, width: int, what: str) -> tuple[NumberRow, ...]:
        """Return the next ``count`` rows of ``width`` numbers."""
        rows = []
        for k in range(1, count + 1):
            place = self._line(self._next)
            values = tuple(self.number(f"{what} {k}") for _ in range(width))
            rows.append(NumberRow(values=values, place=place))
        return tuple(rows)

    def rest(
        self, counted: str = "", reason: str = "it follows the end of the expected data"
    ) -> tuple[LeftOut, ...]:
        """Return the words that were not read, shortened, after the text ``counted``."""
        words = [word for word, _ in self._words[self._next :]]
        if not words:
            return ()
        more = f" ... ({len(words)} words)" if len(words) > 12 else ""
        what = f"{counted}{shortened(' '.join(words[:12]), 120)}{more}"
        return (LeftOut(what=what, place=self._line(self._next), reason=reason),)


def read_shi_analysis(path: str | Path, mass_unit: float = 1.0) -> Analysis:
    """Return the content of an analysis file of Shi's programs, in SI units.

    ``mass_unit`` is the kilograms in its unit of mass: 1000 for a file in t, kN and kPa.  Raises
    CaseError with the line where it is no such file.
    """
    scale, text = check_mass_unit(mass_unit), NumberText(Path(path))
    kind = text.number("the analysis type")
    if not 0.0 <= kind <= 1.0:
        remedy = "an analysis file begins with 0, static, or 1, dynamic"
        raise text.fault(f"{kind:g} is not an analysis type", remedy, "line 1")
    steps = text.count("steps")
    blocks, joints = text.count("block materials", 13), text.count("joint materials", 3)
    ratio = text.number("the largest displacement ratio g2")
    step = text.number("the time step")
    for what, value in (("steps", steps), ("time step", step), ("displacement ratio", ratio)):
        if not value > 0:
            raise text.fault(f"the {what} is {value:g}", "give a number above 0")
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
        left_out=(*left, *text.rest()),
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
        raise text.fault("has no blocks", "give the file of a cut system")
    rows = text.rows(blocks, 3, "block")
    given = text.rows(vertices, 3, "vertex")
    corners: list[NumberRow] = []
    start = [0]
    for number, row in enumerate(rows, 1):
        _, first, last = row.values
        whole = first == round(first) and last == round(last)
        if not whole or not 1 <= first or not last <= len(given) or last - first < 2:
            what = f"block {number} has the vertices {first:g} to {last:g} of {len(given)}"
            raise text.fault(what, "a block has at least 3 vertices, numbered from 1", row.place)
        corners += given[int(first) - 1 : int(last)]
        start.append(len(corners))
    at = np.array([one.values[1:] for one in corners])
    joints = [f"type-{one.kind(0, 'joint', text.file)}" if one.values[0] else "" for one in corners]
    for empty in np.flatnonzero(areas(at, np.array(start)) == 0.0):
        raise text.fault(f"block {empty + 1} has no area", "", rows[empty].place)
    rocks = [f"rock-{row.kind(0, 'material', text.file)}" for row in rows]
    counted = f"{bolts} bolts, {points[0]} fixed, {points[1]} load, {points[2]} measured points: "
    reason = "bolts and points are taken from the geometry file, where blocks have no numbers"
    return replace(
        counter_clockwise(blocks_of(at, start, rocks, joints, text.file)),
        left_out=text.rest(counted, reason),
    )
