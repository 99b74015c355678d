"""Quantities over the variable of a study: a line with marks for every series, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#c1440e", "#1f6f8b", "#6a8d2f", "#8e5aa8")
"""Colours of the groups of series."""
MARKS = ("o", "s", "^", "D")
"""Marks of the groups of series."""
RULE_STYLES = ("-", ":")
"""Lines of exact or quoted values, in turn."""
PANEL = (4.6, 3.3)
"""Width and height of a panel, inches."""
DOTS = 150
"""Dots per inch."""


@dataclass(frozen=True, kw_only=True)
class Series:
    """Values over x; those that are not finite are runs that stopped."""

    label: str
    """Its text in the legend."""
    group: int
    """Number of its colour and mark."""
    line: Literal["-", "--", ""]
    """Line between the marks: dashed ones have open marks."""
    x: Floats
    """Abscissa, shape (k,)."""
    y: Floats
    """Ordinate, shape (k,)."""


@dataclass(frozen=True, kw_only=True)
class Rule:
    """A curve of exact or quoted values, drawn thin and grey; two in a diagram at most."""

    label: str
    """Its text in the legend."""
    x: Floats
    """Abscissa, shape (k,)."""
    y: Floats
    """Ordinate, shape (k,)."""


@dataclass(frozen=True, kw_only=True)
class Diagram:
    """Series over one pair of axes."""

    title: str
    """Title."""
    x_label: str
    """Quantity and unit of the abscissa."""
    y_label: str
    """Quantity and unit of the ordinate."""
    series: Sequence[Series]
    """The computed values."""
    rules: Sequence[Rule] = ()
    """The values for comparison."""
    x_scale: Literal["linear", "log"] = "linear"
    """Scale of the abscissa."""
    y_scale: Literal["linear", "log"] = "linear"
    """Scale of the ordinate."""


def draw_diagrams(diagrams: Sequence[Diagram], path: Path) -> Path:
    """Draw diagrams side by side with one legend below; return the picture's path."""
    labels = {one.label for d in diagrams for one in d.series}
    labels |= {one.label for d in diagrams for one in d.rules}
    columns = 3 if len(diagrams) > 1 else 2
    lines = -(-len(labels) // columns)
    size = (len(diagrams) * PANEL[0], PANEL[1] + 0.35 + canvas.LINE * lines)
    figure = canvas.new_figure(size, DOTS)
    below = (0.75 + canvas.LINE * lines) / size[1]
    handles = {}
    for number, diagram in enumerate(diagrams):
        left = (number + 0.155) / len(diagrams)
        axes = figure.add_axes((left, below, 0.82 / len(diagrams), 1.0 - below - 0.35 / size[1]))
        _draw(axes, diagram)
        drawn, named = axes.get_legend_handles_labels()
        handles.update(dict(zip(named, drawn, strict=True)))
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="lower left",
        bbox_to_anchor=(0.05 / len(diagrams), 0.02),
        ncols=columns,
        fontsize=SMALL_SIZE,
        frameon=False,
        labelcolor=INK,
        columnspacing=1.4,
    )
    return canvas.save(figure, path)


def _draw(axes: Axes, diagram: Diagram) -> None:
    """Draw one diagram; runs that stopped are crosses at the upper edge."""
    for style, rule in zip(RULE_STYLES, diagram.rules, strict=False):
        axes.plot(rule.x, rule.y, style, color=FAINT, lw=1.4, label=rule.label, zorder=1)
    for one in diagram.series:
        colour, mark = COLOURS[one.group % len(COLOURS)], MARKS[one.group % len(MARKS)]
        kept, dashed = np.isfinite(one.y), one.line == "--"
        axes.plot(
            one.x[kept],
            one.y[kept],
            linestyle=one.line,
            marker=mark,
            color=colour,
            mfc="white" if dashed else colour,
            # marks lie on each other: the first group has the largest
            ms=(6.0 if dashed else 8.0) - 1.2 * one.group,
            lw=1.1,
            label=one.label,
            zorder=3 if dashed else 2,
        )
        # crosses of several series would lie on each other
        height = 0.98 - 0.05 * (2 * one.group + dashed)
        axes.plot(
            one.x[~kept],
            np.full(int((~kept).sum()), height),
            "x",
            color=colour,
            ms=5.0,
            mew=1.4,
            transform=axes.get_xaxis_transform(),
        )
    axes.set_xscale(diagram.x_scale)
    axes.set_yscale(diagram.y_scale)
    canvas.label_logarithms(axes)
    axes.set_title(diagram.title, fontsize=TEXT_SIZE, fontweight="bold", color=INK, loc="left")
    axes.set_xlabel(diagram.x_label, fontsize=TEXT_SIZE, color=INK)
    axes.set_ylabel(diagram.y_label, fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e2e2e2", lw=0.5)
    canvas.style(axes)
