"""Charts: exact curves as lines and computed values as marks, over one pair of axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import LEGEND, SMALL, TEXT
from clast.thumbnails import CURVE_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EXACT = "#222222"
"""Colour of exact curves."""
EXACT_STYLES = ("-", "--", ":", "-.")
MARKS = ("o", "s", "^", "D", "v", "<", ">")
"""Marks of computed values, in turn as their colours: 56 pairs before the first comes again."""
MARK_DISTANCE, ALL_MARKED_MAX = 0.03, 40
"""Distance of the marks of a curve at least, in diagonals of the axes, and values all marked."""
PANEL = (4.6, 3.3)
"""Width and height of charts beside each other, inches."""

Scale = Literal["linear", "log"]


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Values over x: exact ones are drawn as a line, computed ones as marks."""

    label: str
    """Its text in the legend."""
    x: Floats
    """Abscissa, shape (k,)."""
    y: Floats
    """Ordinate, shape (k,); those that are not finite are runs that stopped."""
    exact: bool = False
    """True for values of a formula."""
    group: int | None = None
    """Number of the colour and mark of computed values; None for their place in the chart."""
    line: Literal["-", "--", ""] = ""
    """Line between the marks, which are filled on a whole line."""


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Curves over one pair of axes."""

    title: str
    """Title; charts of the same title share their axes."""
    x_label: str
    """Quantity and unit of the abscissa."""
    y_label: str
    """Quantity and unit of the ordinate."""
    curves: Sequence[Curve]
    x_scale: Scale = "linear"
    y_scale: Scale = "linear"


def curve(label: str, x: Any, y: Any) -> Curve:
    """Return a curve of computed values."""
    return Curve(label=label, x=np.asarray(x, float), y=np.asarray(y, float))


def exact_curve(label: str, x: Any, y: Any) -> Curve:
    """Return a curve of exact values."""
    return replace(curve(label, x, y), exact=True)


def merged(charts: Sequence[Chart]) -> list[Chart]:
    """Return one chart for every title, with every exact curve once."""
    by_title: dict[str, Chart] = {}
    for chart in charts:
        before = by_title.setdefault(chart.title, replace(chart, curves=()))
        labels = {one.label for one in before.curves}
        added = [one for one in chart.curves if one.label not in labels]
        by_title[chart.title] = replace(before, curves=(*before.curves, *added))
    return list(by_title.values())


def draw_charts(charts: Sequence[Chart], path: Path) -> Path:
    """Draw charts side by side with one legend below; return the picture's path."""
    columns, width = 3 if len(charts) > 1 else 2, 1.0 / len(charts)
    lines = -(-len({one.label for chart in charts for one in chart.curves}) // columns)
    size = (len(charts) * PANEL[0], PANEL[1] + 0.35 + canvas.LINE * lines)
    figure = canvas.new_figure(size, 150)
    below = (0.75 + canvas.LINE * lines) / size[1]
    handles: dict[str, Any] = {}
    for number, chart in enumerate(charts):
        height = 1.0 - below - 0.35 / size[1]
        axes = figure.add_axes(((number + 0.155) * width, below, 0.82 * width, height))
        draw_chart(axes, chart)
        drawn, labels = axes.get_legend_handles_labels()
        handles.update(zip(labels, drawn, strict=True))
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.05 * width, 0.02)}
    figure.legend(handles.values(), handles.keys(), ncols=columns, **place, **LEGEND)
    return canvas.save(figure, path)


def draw_chart(axes: Axes, chart: Chart) -> None:
    """Draw a chart: exact curves as lines, computed values as marks on them."""
    exact = [one for one in chart.curves if one.exact]
    for k, one in enumerate(exact):
        dashes = EXACT_STYLES[k % len(EXACT_STYLES)]
        axes.plot(one.x, one.y, dashes, color=EXACT, lw=1.2, label=one.label)
    for k, one in enumerate(one for one in chart.curves if not one.exact):
        number = k if one.group is None else one.group
        colour, kept = CURVE_COLOURS[number % len(CURVE_COLOURS)], np.isfinite(one.y)
        axes.plot(
            one.x[kept],
            one.y[kept],
            marker=MARKS[number % len(MARKS)],
            ls=one.line or "none",
            lw=1.1,
            color=colour,
            # marks of several variants lie on each other: the first is the largest
            ms=3.2 + 1.3 * max(0, 3 - number),
            mfc=colour if one.line == "-" else "none",
            mew=1.0,
            # marks of a few values would leave the last out, and a single one
            markevery=MARK_DISTANCE if len(one.x) > ALL_MARKED_MAX else None,
            label=one.label,
        )
        if one.group is not None:
            # crosses of several curves would lie on each other
            height = np.full(int((~kept).sum()), 0.98 - 0.05 * (2 * one.group + (one.line == "--")))
            edge = axes.get_xaxis_transform()
            axes.plot(one.x[~kept], height, "x", color=colour, ms=5.0, mew=1.4, transform=edge)
    axes.set_xscale(chart.x_scale)
    axes.set_yscale(chart.y_scale)
    canvas.label_logarithms(axes)
    if chart.x_scale == "linear":
        axes.locator_params(axis="x", nbins=6)
    axes.set_xlabel(chart.x_label, **SMALL)
    axes.set_ylabel(chart.y_label, **SMALL)
    axes.set_title(chart.title, **TEXT)
    axes.grid(color="#dddddd", lw=0.6)
    canvas.style(axes)
