"""A comparison as a table of texts, for the command line and the pages."""

from __future__ import annotations

from collections.abc import Sequence

from clast.studies.comparing import ComparedMethods, ComparedRun

MOST_POINTS = 4
"""Measured points that get a column of their own, at most; JSON has all."""


def headings(comparison: ComparedMethods) -> tuple[str, ...]:
    """Return the headings of the table; passes and solves are per step."""
    points = _points(comparison)
    ways = ("u, m", "v, m") if len(points) == 1 else ("way, m",)
    return (
        "process",
        "law",
        *(f"{point}: {way}" for point in points for way in ways),
        *(("error",) if comparison.rows[0].deviations else ()),
        "penetration, m",
        "passes",
        "solves",
        "cut",
        "steps",
        "wall",
        "outcome",
    )


def cells(comparison: ComparedMethods, row: ComparedRun) -> tuple[str, ...]:
    """Return the texts of a row, in the order of the headings."""
    points = _points(comparison)
    ways = [row.displacement[point] for point in points]
    if len(points) == 1:
        moved = [f"{way:.5g}" for way in ways[0]]
    else:
        moved = [f"{(u * u + v * v) ** 0.5:.4g}" for u, v in ways]
    report = row.report
    return (
        row.combination.process,
        row.combination.law,
        *moved,
        *((row.error.as_text(),) if row.error else ()),
        f"{report.largest_penetration:.3g}",
        f"{row.passes_per_step:.3g}",
        f"{row.solves_per_step:.3g}",
        str(report.cut_steps),
        str(report.steps),
        f"{report.wall_seconds:.3g} s",
        row.outcome,
    )


def remarks(comparison: ComparedMethods) -> list[str]:
    """Return the remarks below the table: references, why runs stopped, warnings, notes."""
    said = ["passes and solves: per step; penetration: the largest of the run"]
    said += _stiffness_texts(comparison)
    for one in comparison.rows[0].deviations:
        u, v = one.reference
        source = f" ({one.source})" if one.source else ""
        said.append(
            f"reference at t = {one.time:g} s: {one.point} has moved ({u:g}, {v:g}) m{source}"
        )
    for row in comparison.rows:
        told = [] if row.report.finished else [row.report.outcome]
        said += [f"{row.combination}: {text}" for text in (*told, *row.report.warnings)]
        said += [f"{row.combination}: {text}" for text in row.report.notes]
    return list(dict.fromkeys(said))


def _stiffness_texts(comparison: ComparedMethods) -> list[str]:
    """Return the normal stiffness of all rows, where it is the same and was given."""
    values = {row.stiffness for row in comparison.rows}
    if len(values) > 1 or comparison.rows[0].report.notes:
        return []
    return [f"normal stiffness p: {values.pop():.4g} N/m per m"]


def _points(comparison: ComparedMethods) -> Sequence[str]:
    return list(comparison.rows[0].displacement)[:MOST_POINTS]
