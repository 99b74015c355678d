"""A comparison as files: a Markdown page, an HTML page that holds its picture, JSON, a picture."""

from __future__ import annotations

import json
import math
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from clast.pictures.comparison import Panel, SideBySide, draw_side_by_side
from clast.studies.comparing import ComparedMethods
from clast.studies.comparison_table import cells, headings, remarks

PAGE = "comparison"
"""Name of the files, without their endings."""
STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:3px 9px;"
    "text-align:right}td:nth-child(-n+2),td:last-child,th:nth-child(-n+2),th:last-child{text-align:left}"
    "img{max-width:100%}.stopped{background:#f6c7b6}"
)


def write_comparison(comparison: ComparedMethods, directory: Path) -> list[Path]:
    """Write comparison.md, .html, .json and .png into a directory; return their paths."""
    directory.mkdir(parents=True, exist_ok=True)
    picture = draw(comparison, directory / f"{PAGE}.png")
    content = json.dumps(finite(comparison.as_dict()), indent=2, ensure_ascii=False)
    texts = {
        ".md": markdown(comparison, picture.name),
        ".html": html(comparison, picture.read_bytes()),
        ".json": content + "\n",
    }
    for suffix, text in texts.items():
        (directory / f"{PAGE}{suffix}").write_text(text, encoding="utf-8")
    return [*(directory / f"{PAGE}{suffix}" for suffix in texts), picture]


def draw(comparison: ComparedMethods, path: Path) -> Path:
    """Draw the end states, processes side by side and laws below each other."""
    processes = list(dict.fromkeys(row.combination.process for row in comparison.rows))
    rows = sorted(
        comparison.rows,
        key=lambda row: _order_of_law(comparison, row.combination.law),
    )
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


def _order_of_law(comparison: ComparedMethods, law: str) -> int:
    return [row.combination.law for row in comparison.rows].index(law)


def markdown(comparison: ComparedMethods, picture: str) -> str:
    """Return the comparison as a Markdown page; ``picture`` is the picture's address."""
    lines = [f"# {comparison.title}", ""]
    lines += markdown_table(headings(comparison), [cells(comparison, r) for r in comparison.rows])
    lines += ["", *(f"- {text}" for text in remarks(comparison))]
    lines += ["", f"![End states side by side]({picture})"]
    return "\n".join(lines) + "\n"


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a Markdown table: words to the left, numbers to the right."""
    columns = zip(*rows, strict=True)
    under = ["---:" if all(map(_is_number, column)) else "---" for column in columns]
    return [
        "| " + " | ".join(text.replace("|", "\\|") for text in line) + " |"
        for line in (heads, under, *rows)
    ]


def _is_number(text: str) -> bool:
    """Return True for texts that begin with a number, and for empty ones."""
    return text[:1] in "-0123456789"


def html(comparison: ComparedMethods, picture: bytes) -> str:
    """Return the comparison as one HTML page with its picture (PNG) inside."""
    title = escape(comparison.title)
    head = "".join(f"<th>{escape(text)}" for text in headings(comparison))
    body = "".join(
        f"<tr{'' if row.report.finished else ' class=stopped'}>"
        + "".join(f"<td>{escape(text)}" for text in cells(comparison, row))
        for row in comparison.rows
    )
    said = "".join(f"<li>{escape(text)}" for text in remarks(comparison))
    source = f"data:image/png;base64,{b64encode(picture).decode()}"
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{title}</title>'
        f"<style>{STYLE}</style>\n<h1>{title}</h1>\n<table><tr>{head}\n{body}</table>\n"
        f'<ul>{said}</ul>\n<img alt="End states side by side" src="{source}">\n'
    )


def finite(value: Any) -> Any:
    """Return a value for JSON: numbers that JSON does not know become null."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
