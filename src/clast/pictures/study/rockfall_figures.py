"""Figures of rockfall: paths over the profile, envelopes, end points, energy at barriers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import INK, SMALL, TEXT
from clast.thumbnails import CURVE_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DOTS = 150
"""Dots per inch."""
WIDE, SMALLER = (9.0, 4.2), (5.4, 3.5)
"""Width and height of a figure, inches."""
BINS = 40


def _axes(size: tuple[float, float], across: str, up: str) -> Axes:
    """Return the axes of a new figure with the names of its quantities."""
    figure = canvas.new_figure(size, DOTS)
    axes = figure.add_axes((0.09, 0.14, 0.88, 0.8) if size == WIDE else (0.15, 0.16, 0.81, 0.78))
    canvas.style(axes)
    axes.set_xlabel(across, **SMALL)
    axes.set_ylabel(up, **SMALL)
    return axes


def _save(axes: Any, file: Path) -> Path:
    return canvas.save(axes.get_figure(root=True), file)


def draw_paths(
    file: Path,
    profile: Floats,
    names: Sequence[str],
    lines: Sequence[Floats],
    barriers: Floats,
    blocks: Sequence[Floats],
) -> Path:
    """Draw paths (n, 2) each over a profile (k + 1, 2) with the surface of each segment, m.

    Blocks that stand, (c, 2) each, are drawn below them.
    """
    from matplotlib.collections import LineCollection, PolyCollection

    axes = _axes(WIDE, "x, m", "y, m")
    stones = PolyCollection(list(blocks), fc="#eeeeee", ec="#999999", linewidths=0.4)
    axes.add_collection(stones)
    axes.add_collection(LineCollection(list(lines), colors="#777777", linewidths=0.4, alpha=0.5))
    kinds = list(dict.fromkeys(names))
    for number, name in enumerate(kinds):
        colour = CURVE_COLOURS[number % len(CURVE_COLOURS)]
        parts = [profile[k : k + 2] for k in range(len(names)) if names[k] == name]
        label = canvas.literal(name)
        axes.add_collection(LineCollection(parts, colors=colour, linewidths=2.0, label=label))
    axes.add_collection(LineCollection(list(barriers), colors=INK, linewidths=2.5))
    axes.autoscale()
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(frameon=False, fontsize="small")
    return _save(axes, file)


def draw_envelopes(
    file: Path, rows: Sequence[Mapping[str, Any]], key: str, up: str, unit: float
) -> Path:
    """Draw mean, percentiles and largest of a quantity along the profile, times ``unit``."""
    axes = _axes(SMALLER, "x, m", up)
    x = [row["x"] for row in rows]
    for number, part in enumerate(("mean", "p95", "max")):
        known = [row[f"{key}_{part}"] for row in rows]
        values = [np.nan if one is None else unit * one for one in known]
        axes.plot(x, values, color=CURVE_COLOURS[number], linewidth=1.2, label=part.upper()
                  if part == "p95" else part)  # fmt: skip
    axes.legend(frameon=False, fontsize="small")
    return _save(axes, file)


def draw_distribution(file: Path, values: Floats, across: str) -> Path:
    """Draw the histogram of values (n,), and their cumulative share as a curve."""
    axes = _axes(SMALLER, across, "paths")
    axes.hist(values, bins=BINS, color=CURVE_COLOURS[1], alpha=0.6)
    other = axes.twinx()
    axes.get_figure(root=True).subplots_adjust(right=0.86)  # type: ignore[union-attr]
    axes.set_position((0.15, 0.16, 0.68, 0.78))
    other.set_position((0.15, 0.16, 0.68, 0.78))
    order = np.sort(values)
    other.plot(order, (np.arange(len(order)) + 1.0) / max(1, len(order)), color=INK, linewidth=1.2)
    other.set_ylim(0.0, 1.0)
    other.set_ylabel("share below", **TEXT)
    return _save(axes, file)
