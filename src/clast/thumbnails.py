"""Objects in notebooks: a small drawing as SVG and a table, without any library."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 320.0, 200.0
"""Size of a drawing at most, pixels."""
MARGIN = 4.0
CURVE_COLOURS = (
    *("#c1440e", "#1f6f8b", "#6a8d2f", "#8e5aa8", "#c08a00", "#a8324a", "#4f5b66", "#00796b"),
)
"""Colours of curves in plots, histories, studies and verification, on pages and in notebooks."""
FIXED, FREE, EDGE = "#dcdcdc", "#efe0b9", "#262626"
RAMP = np.array([(255, 255, 204), (254, 204, 92), (253, 141, 60), (227, 26, 28)], np.float64)
"""Colours of values from 0 to 1."""
CELL = "text-align:right;white-space:nowrap"
MOST_ROWS = 12
CURVE_HEIGHT = 110.0
LINE, LETTER = 14.0, 6.5
"""Height of a line of text and width of a letter, pixels."""


def side_by_side(title: str, drawing: str, rows: Iterable[tuple[str, object]]) -> str:
    """Return a drawing with a table beside it, below a title, as HTML."""
    return (
        f"<div><strong>{escape(title)}</strong>"
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start">'
        f"{drawing}{_pairs(rows)}</div></div>"
    )


def _pairs(rows: Iterable[tuple[str, object]]) -> str:
    return (
        "<table>"
        + "".join(
            f'<tr><th style="text-align:left">{escape(name)}</th>'
            f'<td style="text-align:left">{escape(str(value))}</td></tr>'
            for name, value in rows
        )
        + "</table>"
    )


def table(columns: Mapping[str, NDArray[Any]]) -> str:
    """Return the first and last rows of columns of equal length, as HTML."""
    count = len(next(iter(columns.values()), ()))
    half = MOST_ROWS // 2
    shown: list[int | None] = list(range(count))
    if count > MOST_ROWS:
        shown = [*range(half), None, *range(count - half, count)]
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    lines = [
        "".join(
            f'<td style="{CELL}">{"…" if row is None else _cell(values[row])}</td>'
            for values in columns.values()
        )
        for row in shown
    ]
    return f"<table><tr>{head}</tr>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


def _cell(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else escape(str(value))


def blocks(
    vertices: NDArray[Any],
    block_start: NDArray[Any],
    fixed: NDArray[Any],
    values: NDArray[Any] | None = None,
) -> str:
    """Return blocks as SVG, coloured by ``values`` >= 0 (n,) if there are any.

    ``vertices`` (nv, 2), m; ``block_start`` (n + 1,); ``fixed`` (n,).
    """
    if not len(vertices):
        return ""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    scale = float(np.min((WIDTH, HEIGHT) / np.maximum(high - low, 1e-300)))
    size = scale * (high - low) + 2 * MARGIN
    places = (vertices - (low[0], high[1])) * (scale, -scale) + MARGIN
    colours = np.where(fixed, FIXED, FREE).tolist()
    if values is not None:
        coloured = np.where(fixed, 0.0, np.nan_to_num(values))
        largest = float(coloured.max(initial=0.0)) or 1.0
        ramp = [_ramp(value / largest) for value in coloured]
        colours = [FIXED if held else own for held, own in zip(fixed, ramp, strict=True)]
    outlines = np.split(places, block_start[1:-1])
    # Blocks that are drawn: more are shown by their box
    if len(outlines) > 5_000:
        box = [(low, (low[0], high[1]), high, (high[0], low[1]))]
        outlines, colours = (
            [(np.array(box[0]) - (low[0], high[1])) * (scale, -scale) + MARGIN],
            [FREE],
        )
    width = float(np.clip(8.0 / np.sqrt(len(outlines)), 0.15, 0.8))
    drawn = "".join(
        f'<path d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in outline)}Z" fill="{colour}"/>'
        for outline, colour in zip(outlines, colours, strict=True)
    )
    return _svg(size, f'<g stroke="{EDGE}" stroke-width="{width:.2f}">{drawn}</g>')


def _ramp(share: float) -> str:
    place = float(np.clip(share, 0.0, 1.0)) * (len(RAMP) - 1)
    k = min(int(place), len(RAMP) - 2)
    red, green, blue = np.rint(RAMP[k] + (place - k) * (RAMP[k + 1] - RAMP[k])).astype(int)
    return f"#{red:02x}{green:02x}{blue:02x}"


def curves(x: NDArray[Any], lines: Mapping[str, NDArray[Any]]) -> str:
    """Return curves over the time ``x`` (t,), s, as SVG, below their names in their colours.

    ``lines`` has name -> values (t,); the ends of the axes stand beside them.
    """
    every = np.concatenate(
        [np.asarray(line, np.float64) for line in lines.values()] or [np.zeros(0)]
    )
    sound = every[np.isfinite(every)]
    if len(x) < 2 or not len(sound):
        return ""
    low, high = float(sound.min()), float(sound.max())
    ends = (f"{high:.3g}", f"{low:.3g}")
    left = MARGIN + LETTER * (max(map(len, ends)) + 1)
    top = LINE * len(lines) + MARGIN
    foot = top + CURVE_HEIGHT
    drawn = [_text(left, foot + LINE, f"t = {x[0]:.4g} to {x[-1]:.4g} s")]
    for end, y in zip(ends, (top + 9, foot), strict=True):
        drawn.append(_text(MARGIN, y, end))
    frame = f"{left:.1f},{top:.1f} {left:.1f},{foot:.1f} {left + WIDTH:.1f},{foot:.1f}"
    drawn.append(f'<polyline points="{frame}" fill="none" stroke="#999"/>')
    for number, (name, line) in enumerate(lines.items()):
        ink = CURVE_COLOURS[number % len(CURVE_COLOURS)]
        drawn.append(_text(left, LINE * (number + 1) - 2, name, ink))
        kept = np.unique(np.linspace(0, len(x) - 1, min(len(x), 400)).astype(int))
        kept = kept[np.isfinite(np.asarray(line, np.float64)[kept])]
        across = left + (np.asarray(x)[kept] - x[0]) / (float(x[-1] - x[0]) or 1.0) * WIDTH
        up = top + (high - np.asarray(line)[kept]) / (high - low or 1.0) * CURVE_HEIGHT
        path = "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(across, up, strict=True))
        drawn.append(f'<path d="M{path}" fill="none" stroke="{ink}" stroke-width="1.3"/>')
    return _svg(np.array([left + WIDTH + MARGIN, foot + LINE + MARGIN]), "".join(drawn))


def _text(x: float, y: float, text: str, ink: str = "#777") -> str:
    font = 'font-family="sans-serif" font-size="11"'
    return f'<text x="{x:.1f}" y="{y:.1f}" {font} fill="{ink}">{escape(text)}</text>'


def _svg(size: NDArray[Any], content: str) -> str:
    width, height = size
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.1f} {height:.1f}">{content}</svg>'
    )
