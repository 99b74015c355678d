"""The report of a cut as one page for a browser: pictures, sizes, sets, changes."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.page.document import html_path, write_html
from clast.pictures.rock_mass.cut_statistics import statistics_figure
from clast.pictures.rock_mass.section import BY, cut_figure
from clast.rockmass import Cut, CutReport, Finding
from clast.rockmass.cut_report import place_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;color:#262626;max-width:62rem;margin:1.5rem auto;"
    "padding:0 1rem}h1{font-size:1.5rem;overflow-wrap:anywhere}"
    "h2{font-size:1.15rem;margin-top:2rem}"
    "img{width:100%;height:auto}figure{margin:1rem 0;break-inside:avoid}"
    "figcaption{font-size:.9rem;color:#555}.wide{overflow-x:auto}"
    "table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}"
    "th,td{border-bottom:1px solid #ddd;padding:.25rem .7rem;text-align:right;white-space:nowrap}"
    "th:first-child,td:first-child{text-align:left;white-space:normal}"
    "td.places{text-align:left;white-space:normal;min-width:14rem}tr{break-inside:avoid}"
    ".wide img{min-width:44rem}"
    "@media print{body{font-size:10pt;margin:0;max-width:none}.wide{overflow:visible}"
    ".wide img{min-width:0}h2{break-after:avoid}}"
)
"""How the page looks: tables and sheets that are wider than a phone scroll by themselves."""
CAPTIONS = {"set": "Edges by joint set.", "rock": "Blocks by rock."}
FINDINGS = {
    "dangling": "Ends of lines that border nothing, taken out",
    "loose": "Of these, ends just short of another line",
    "collapsed": "Edges collapsed",
    "merged": "Blocks merged with a neighbour",
    "rings": "Holes and touching loops split by welds",
    "coincident": "Edges on which lines of different joints coincide; the later has it",
    "snapped": "Points of traces and outlines moved onto others",
}
"""Changes on the way: field of the report -> its name on the page."""


def _table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], classes: Sequence[str] = ()
) -> str:
    """Return rows of text under headings; ``classes`` are the styles of the columns."""
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in headings)
    cells = [
        f'<td class="{style}">' if style else "<td>" for style in classes or [""] * len(headings)
    ]
    lines = []
    for row in rows:
        line = (f"{cell}{escape(text)}</td>" for cell, text in zip(cells, row, strict=True))
        lines.append(f"<tr>{''.join(line)}</tr>")
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"
    return f'<div class="wide">{table}</div>'


def write_cut_report(
    cut: Cut, path: Path | str, *, title: str = "Cut rock mass", look: Look = DEFAULT
) -> Path:
    """Write a page with pictures and tables of a cut, complete in one file; return its path.

    ``look`` has size, resolution and part of the sections.  CaseError where the page cannot be
    written, or a picture of it not be drawn.
    """
    path = html_path(path)
    return write_html(page(cut, title=title, look=look), path)


def page(cut: Cut, *, title: str, look: Look) -> str:
    """Return the text of the page."""
    report = cut.report
    summary = (
        f"{report.blocks:,} blocks cover {report.area:.9g} m²; the domain has "
        f"{report.domain_area:.9g} m² of rock, a difference of {abs(report.area_error):.1g} of it. "
        f"Before anything was cut, {report.estimate:,} blocks were expected."
    )
    drawn = ["set", "rock"] if len(cut.rock_names) > 1 else ["set"]
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width,initial-scale=1">',
        f"<title>{escape(title)}</title><style>{STYLE}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        f"<p>{escape(summary)}</p>",
        *(
            _figure(cut_figure(cut, by=by, title="", look=look), CAPTIONS[by])
            for by in BY
            if by in drawn
        ),
        "<h2>Sizes</h2>",
        _sizes(report),
        f"<p>{escape(_limits(report))}</p>",
        _figure(
            statistics_figure(cut, title=""),
            "Directions of the joints between blocks, weighted by length (counter-clockwise from "
            "+x), areas of blocks, lengths of edges.",
            wide=' class="wide"',
        ),
        *_joint_sets(report),
        "<h2>Changes on the way</h2>",
        _changes(report),
        *_notes(report),
        "</body></html>",
    ]
    return "\n".join(parts) + "\n"


def _figure(figure: Figure, caption: str, wide: str = "") -> str:
    """Return a picture with its data in the page itself; ``wide`` is its class, if it has one."""
    data = BytesIO()
    figure.savefig(data, format="png")
    source = base64.b64encode(data.getvalue()).decode("ascii")
    image = f'<img alt="{escape(caption)}" src="data:image/png;base64,{source}">'
    return f"<figure{wide}>{image}<figcaption>{escape(caption)}</figcaption></figure>"


def _limits(report: CutReport) -> str:
    return (
        f"Lines were rounded to {report.tolerance:g} m. Edges below {report.smallest_edge:.4g} m "
        f"are collapsed ({report.short_edges:,} stayed shorter), blocks below "
        f"{report.smallest_block:.4g} m² merged ({report.small_blocks:,} stayed smaller)."
    )


def _sizes(report: CutReport) -> str:
    named = {
        "Area of block, m²": report.block_area,
        "Length of edge, m": report.edge_length,
        "Aspect of block": report.aspect,
    }
    rows = [
        (name, *(f"{value:.4g}" for value in (one.smallest, one.median, one.largest)))
        for name, one in named.items()
    ]
    return _table(("", "smallest", "median", "largest"), rows)


def _joint_sets(report: CutReport) -> list[str]:
    if not report.sets:
        return []
    headings = (
        "set",
        "apparent dip",
        "lines",
        "length, m",
        "P21, m/m²",
        "asked",
        "P10, 1/m",
        "persistence",
    )
    rows = [
        (
            one.name,
            one.seen or "–",
            f"{one.lines:,}",
            f"{one.length:.5g}",
            f"{one.p21:.4g}",
            "–" if one.p21_asked is None else f"{one.p21_asked:.4g}",
            f"{one.p10:.4g}",
            f"{one.persistence:.3f}",
            f"{one.persistence_asked:.3f}",
            f"{100.0 * one.kept:.1f} %",
        )
        for one in report.sets
    ]
    table = _table((*headings, "asked", "kept as edges"), rows)
    return ["<h2>Joint sets and traces</h2>", table]


def _changes(report: CutReport) -> str:
    rows = []
    for field, text in FINDINGS.items():
        one: Finding = getattr(report, field)
        places = "; ".join(place_text(at, report.tolerance) for at in one.places)
        length = f"{one.length:.4g}" if one.length > 0.0 else ""
        rows.append((text, f"{one.count:,}", length, places))
    headings = ("", "times", "length, m", "first places (x, y), m")
    return _table(headings, rows, classes=("", "", "", "places"))


def _notes(report: CutReport) -> list[str]:
    parts = []
    for heading, texts in (("Warnings", report.warnings), ("Notes", report.notes)):
        if texts:
            items = "".join(f"<li>{escape(text)}</li>" for text in texts)
            parts.append(f"<h2>{heading}</h2><ul>{items}</ul>")
    return parts
