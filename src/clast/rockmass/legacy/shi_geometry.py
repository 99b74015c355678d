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

from clast.errors import CaseError
from clast.rockmass.drawings.drawing import Drawing, LeftOut
from clast.rockmass.legacy.number_text import NumberText
from clast.rockmass.legacy.words import LegacyGeometry, check_mass_unit, legacy_drawing


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
