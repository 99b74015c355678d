"""Rows as texts, and the page of all problems: Markdown and HTML with a figure of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path

from clast.pictures.verification import draw_problem
from clast.verification.problem import Bracket, Findings, Measure, Problem, Row, Verdict

PAGE = "verification"
"""Name of the pages."""
FIGURES = f"images/{PAGE}"
"""Folder of their figures, beside the pages."""
INTRODUCTION = (
    "Problems whose answer is known, run with every process, contact law and time scheme that "
    "applies. Error and tolerance are relative where they are in %. The reason of every tolerance "
    "stands below the table; what is known to fail is listed with its cause. `clast verify` runs "
    "them, all or by name; `clast verify --quick` what fits into a minute; `make verify` writes "
    "this page."
)
NOT_VERIFIED = (
    "Not verified against a closed answer: the ground reaction curve of rock that slips along many "
    "joints, beyond one ring of blocks (slipping-ring; kirsch where nothing slips); SV waves from "
    "30 degrees to beyond their critical angle at a free surface (speeds of waves in triangles are "
    "off by a little, and where P leaves along the surface its motion hangs on them: 6 % too much "
    "at 30 degrees, as it should be at 32); waves through bonded triangles without weight by the "
    "convex process."
)
"""Quantities that users compute and no problem here compares."""
STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:2px 8px;"
    "text-align:left}img{max-width:100%}.MISS{background:#f6c7b6}.known{background:#f4ecc8}"
)


HEADINGS = ("problem", "quantity", "computed", "exact", "error", "tolerance", "variant", "verdict")
"""Headings of the table."""


def cells(row: Row) -> tuple[str, ...]:
    """Return the texts of a row, in the order of :data:`HEADINGS`; relative errors in %."""
    unit, computed = row.unit, f"{row.computed:.7g}"
    if isinstance(row.computed, Bracket):
        computed = f"{row.computed.low:.5g} to {row.computed.high:.5g}"
    error, tolerance = f"{row.error:.3g} {unit}", f"{row.tolerance:.7g} {unit}"
    if row.measure is Measure.RELATIVE:
        error, tolerance = f"{100.0 * row.error:.3g} %", f"{100.0 * row.tolerance:.3g} %"
    values = (f"{computed} {unit}", f"{row.exact:.7g} {unit}", error, tolerance)
    texts = (row.problem, row.quantity, *values, row.variant, row.verdict.value)
    return tuple(text.strip() for text in texts)


@dataclass(frozen=True)
class ProblemSection:
    """A problem and everything that was found for it."""

    problem: Problem
    rows: tuple[Row, ...]
    figure: str


def write_report(findings: Sequence[Findings], directory: Path) -> list[Path]:
    """Write verification.md, verification.html and their figures; return the files."""
    folder = directory / FIGURES
    folder.mkdir(parents=True, exist_ok=True)
    sections = []
    written = []
    for _, group in groupby(findings, key=lambda one: one.problem.name):
        parts = list(group)
        problem = parts[0].problem
        figure = folder / f"{problem.name}.png"
        draw_problem(problem.set_up(), [chart for part in parts for chart in part.charts], figure)
        rows = tuple(row for part in parts for row in part.rows)
        sections.append(ProblemSection(problem, rows, f"{FIGURES}/{figure.name}"))
        written.append(figure)
    for suffix, page in ((".md", markdown(sections)), (".html", html(sections))):
        path = directory / f"{PAGE}{suffix}"
        path.write_text(page, encoding="utf-8")
        written.append(path)
    return written


def counts(rows: Sequence[Row]) -> tuple[str, ...]:
    """Return how many rows there are, pass, are known to fail and miss."""
    verdicts = [row.verdict for row in rows]
    return (str(len(rows)), *(str(verdicts.count(verdict)) for verdict in Verdict))


def remarks(rows: Sequence[Row]) -> list[str]:
    """Return the reasons for the tolerances: each once, with its quantities."""
    quantities: dict[str, list[str]] = {}
    for row in rows:
        known = row.verdict is Verdict.KNOWN
        reason = f"known to fail: {row.known_failure}" if known else row.reason
        named = quantities.setdefault(reason, [])
        if row.quantity not in named:
            named.append(row.quantity)
    return [f"{_listed(named)}: {reason}." for reason, named in quantities.items()]


def _listed(quantities: Sequence[str]) -> str:
    """Return one or two quantities, or the first and the last of many."""
    if len(quantities) > 2:
        return f"{quantities[0]} ... {quantities[-1]}"
    return ", ".join(quantities)


SUMMARY_HEADINGS = ("problem", "compared", *(verdict.value for verdict in Verdict))


def markdown(sections: Sequence[ProblemSection]) -> str:
    """Return the page as Markdown."""
    lines = ["# Verification", "", INTRODUCTION, ""]
    summary = [
        (f"[{section.problem.title}](#{anchor(section.problem.title)})", *counts(section.rows))
        for section in sections
    ]
    lines += [*_markdown_table(SUMMARY_HEADINGS, summary), "", NOT_VERIFIED]
    for section in sections:
        problem = section.problem
        lines += ["", f"## {problem.title}", "", problem.text, ""]
        lines += [f"- Exact: {problem.formula}.", f"- Source: {problem.source}."]
        lines += [f"- Not run with {problem.left_out}."] if problem.left_out else []
        lines += [f"- Command: `clast verify {problem.name}`.", ""]
        lines += [f"![{problem.title}]({section.figure})", ""]
        lines += _markdown_table(HEADINGS[1:], [cells(row)[1:] for row in section.rows])
        lines += ["", *(f"- {text}" for text in remarks(section.rows))]
    return "\n".join(lines) + "\n"


def anchor(title: str) -> str:
    """Return the anchor that Markdown renderers give to a heading."""
    kept = [letter for letter in title.lower() if letter.isalnum() or letter in " -"]
    return "".join(kept).replace(" ", "-")


def _markdown_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    lines = [headings, ["---"] * len(headings), *rows]
    return ["| " + " | ".join(text.replace("|", "\\|") for text in line) + " |" for line in lines]


def html(sections: Sequence[ProblemSection]) -> str:
    """Return the page as HTML."""
    parts = [
        "<!doctype html>",
        f'<html lang="en"><meta charset="utf-8"><title>Verification</title><style>{STYLE}</style>',
        f"<h1>Verification</h1><p>{escape(INTRODUCTION.replace('`', ''))}</p>",
    ]
    summary = [(section.problem.title, *counts(section.rows)) for section in sections]
    parts.append(_html_table(SUMMARY_HEADINGS, summary, [""] * len(summary)))
    parts.append(f"<p>{escape(NOT_VERIFIED)}</p>")
    for section in sections:
        problem = section.problem
        parts += [
            f'<h2 id="{problem.name}">{escape(problem.title)}</h2><p>{escape(problem.text)}</p>',
            f"<ul><li>Exact: {escape(problem.formula)}.<li>Source: {escape(problem.source)}.",
            f"<li>Not run with {escape(problem.left_out)}." if problem.left_out else "",
            f"<li>Command: <code>clast verify {problem.name}</code>.</ul>",
            f'<img src="{section.figure}" alt="{escape(problem.title)}">',
            _html_table(
                HEADINGS[1:],
                [cells(row)[1:] for row in section.rows],
                [row.verdict.value.split()[0] for row in section.rows],
            ),
            "<ul>" + "".join(f"<li>{escape(text)}" for text in remarks(section.rows)) + "</ul>",
        ]
    return "\n".join(parts) + "\n"


def _html_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], classes: Sequence[str]
) -> str:
    """Return a table whose rows have style classes."""
    head = "".join(f"<th>{escape(text)}" for text in headings)
    body = "".join(
        f'<tr class="{name}">' + "".join(f"<td>{escape(text)}" for text in row)
        for name, row in zip(classes, rows, strict=True)
    )
    return f"<table><tr>{head}{body}</table>"
