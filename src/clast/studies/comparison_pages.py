"""A comparison as a table of texts, and as files: a page with its picture, JSON, PNG."""

from __future__ import annotations

import json
import math
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from clast.studies.comparing import ComparedMethods, ComparedRun

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:3px 9px;"
    "text-align:right}td:nth-child(-n+2),td:last-child,th:nth-child(-n+2),th:last-child{text-align:left}"
    "img{max-width:100%}.stopped{background:#f6c7b6}"
)


def write_comparison(comparison: ComparedMethods, directory: Path) -> list[Path]:
    """Write comparison.html, .json and .png into a directory; return their paths."""
    directory.mkdir(parents=True, exist_ok=True)
    page, table, picture = (directory / f"comparison.{end}" for end in ("html", "json", "png"))
    draw(comparison, picture)
    page.write_text(html(comparison, picture.read_bytes()), encoding="utf-8")
    content = json.dumps(finite(comparison.as_dict()), indent=2, ensure_ascii=False)
    table.write_text(f"{content}\n", encoding="utf-8")
    return [page, table, picture]


def draw(comparison: ComparedMethods, path: Path) -> Path:
    """Draw the end states, processes side by side and laws below each other."""
    from clast.pictures.comparison import Panel, SideBySide, draw_side_by_side

    processes = list(dict.fromkeys(row.combination.process for row in comparison.rows))
    laws = [row.combination.law for row in comparison.rows]
    rows = sorted(comparison.rows, key=lambda row: laws.index(row.combination.law))
    panels = [
        Panel(
            title=str(row.combination),
            remark=f"t = {row.time:.4g} s" if row.report.finished else row.outcome,
            finished=row.report.finished,
            vertices=row.vertices,
            absent=row.absent,
        )
        for row in rows
    ]
    scene = SideBySide(
        title=comparison.title,
        start=comparison.start,
        block_start=comparison.block_start,
        fixed=comparison.fixed,
        panels=panels,
        columns=len(processes),
    )
    return draw_side_by_side(scene, path)


def html(comparison: ComparedMethods, picture: bytes) -> str:
    """Return the comparison as one HTML page with its picture (PNG) inside."""
    title = escape(comparison.title)
    head = "".join(f"<th>{escape(text)}" for text in headings(comparison))
    body = "".join(
        f"<tr{'' if row.report.finished else ' class=stopped'}>"
        + "".join(f"<td>{escape(text)}" for text in cells(comparison, row))
        for row in comparison.rows
    )
    listed = "".join(f"<li>{escape(text)}" for text in remarks(comparison))
    source = f"data:image/png;base64,{b64encode(picture).decode()}"
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{title}</title>'
        f"<style>{STYLE}</style>\n<h1>{title}</h1>\n<table><tr>{head}\n{body}</table>\n"
        f'<ul>{listed}</ul>\n<img alt="End states side by side" src="{source}">\n'
    )


def finite(value: Any) -> Any:
    """Return a value for JSON: numbers that JSON does not know become null."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def headings(comparison: ComparedMethods) -> tuple[str, ...]:
    """Return the headings of the table; passes and solves are per step."""
    points = _points(comparison)
    parts = ("u, m", "v, m") if len(points) == 1 else ("displacement, m",)
    return (
        "process",
        "law",
        *(f"{point}: {part}" for point in points for part in parts),
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
    vectors = [row.displacement[point] for point in points]
    if len(points) == 1:
        moved = [f"{part:.5g}" for part in vectors[0]]
    else:
        moved = [f"{(u * u + v * v) ** 0.5:.4g}" for u, v in vectors]
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
    texts = ["passes and solves: per step; penetration: the largest of the run"]
    stiffness = {row.stiffness for row in comparison.rows}
    if len(stiffness) == 1 and not comparison.rows[0].report.notes:  # all the same, and given
        texts.append(f"normal stiffness p: {stiffness.pop():.4g} N/m per m")
    for one in comparison.rows[0].deviations:
        u, v = one.reference
        source = f" ({one.source})" if one.source else ""
        texts.append(
            f"reference at t = {one.time:g} s: {one.point} has moved ({u:g}, {v:g}) m{source}"
        )
    for row in comparison.rows:
        outcome = [] if row.report.finished else [row.report.outcome]
        for text in (*outcome, *row.report.warnings, *row.report.notes):
            texts.append(f"{row.combination}: {text}")
    return list(dict.fromkeys(texts))


def _points(comparison: ComparedMethods) -> Sequence[str]:
    # Measured points that get a column of their own, at most; JSON has all
    return list(comparison.rows[0].displacement)[:4]
