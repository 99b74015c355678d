"""Still pictures of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.pictures import blocks, canvas
from clast.pictures.canvas import FAINT, INK, NAME_BOX, SMALL_SIZE
from clast.pictures.fields import KINDS, SCALARS, check_field
from clast.pictures.forces import draw_contacts
from clast.pictures.history import plot_history
from clast.results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_history", "plot_results"]

MOST_NAMES = 12
"""Measured points drawn at most with their names."""


def plot_results(
    results: Results,
    path: Path | str,
    *,
    frame: int = -1,
    field: str = "displacement",
    contacts: bool = True,
) -> Path:
    """Draw the blocks of a frame coloured by ``field`` and return the picture's path.

    The start is outlined behind; ``contacts`` draws the contact forces as arrows, on both blocks
    of each contact.  The format follows from the ending of ``path``.
    """
    check_field(field)
    number = results.frame(frame).number
    here, start = results.vertices(number), results.vertices(0)
    low = np.minimum(here.min(axis=0), start.min(axis=0))
    high = np.maximum(here.max(axis=0), start.max(axis=0))
    size = canvas.axes_size(np.maximum(high - low, 1e-3 * np.max(high - low)))
    keys = _Keys(_legend_handles(results, field), size[0])
    title = results.title or results.path.name
    sheet = canvas.sheet_for(size, title, keys.lines + 1, bars=int(field in SCALARS))
    figure = canvas.new_figure(sheet.size, 220 if len(results.block_name) > 500 else 160)
    axes = figure.add_axes(sheet.share(sheet.axes))
    canvas.view(axes, low, high, size)
    time = f"$t$ = {results.times[number]:.4g} s"
    canvas.head(figure, sheet.axes[0], sheet.title, f"{_label(field)} at {time}")
    blocks.draw_start(axes, results, start)
    free = blocks.draw_blocks(axes, results, here)
    blocks.colour(figure, sheet, free, results, field, number)
    if contacts:
        draw_contacts(figure, sheet, axes, results, number)
    if field == "block":
        blocks.draw_names(axes, results, here)
    _draw_points(axes, results, number)
    keys.draw(figure, sheet)
    return canvas.save(figure, Path(path))


def _label(field: str) -> str:
    return SCALARS[field].label if field in SCALARS else KINDS[field]


def _draw_points(axes: Axes, results: Results, frame: int) -> None:
    """Mark the measured points where they are now."""
    for name, start in list(zip(results.point_name, results.point_start, strict=True))[:MOST_NAMES]:
        history = results.history(name)
        row = int(np.abs(history.time - results.times[frame]).argmin())
        at = start + history.displacement[row]
        axes.plot(*at, "o", ms=3.5, mfc="white", mec=INK, mew=0.9, zorder=6)
        axes.annotate(
            canvas.literal(name),
            at,
            xytext=(4, 4),
            textcoords="offset points",
            fontsize=SMALL_SIZE,
            color=INK,
            bbox=NAME_BOX,
            zorder=7,
        )


def _legend_handles(results: Results, field: str) -> list[Any]:
    """Return what the legend explains: outlines, fixed blocks, rocks."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Line2D([], [], color=FAINT, lw=0.8, label="start")]
    if results.fixed.any():
        handles.append(Patch(fc=blocks.FIXED, ec=FAINT, hatch=blocks.HATCH, lw=0.5, label="fixed"))
    if field == "rock":
        handles += [
            Patch(fc=blocks.kind_colour(rock), ec=INK, lw=0.5, label=canvas.literal(name))
            for rock, name in enumerate(results.rock_name)
        ]
    return handles


class _Keys:
    """The legend, in as many lines as it needs below axes that are ``width`` inches wide."""

    def __init__(self, handles: list[Any], width: float) -> None:
        longest = max(len(handle.get_label()) for handle in handles)
        self._handles = handles
        self._columns = max(1, int(max(width, 4.0) / (0.45 + 0.075 * longest)))
        self.lines = -(-len(handles) // self._columns)

    def draw(self, figure: Figure, sheet: canvas.Sheet) -> None:
        width, height = sheet.size
        figure.legend(
            handles=self._handles,
            loc="upper left",
            bbox_to_anchor=(sheet.axes[0] / width, (sheet.legend + 0.2) / height),
            ncols=self._columns,
            frameon=False,
            fontsize=SMALL_SIZE,
            labelcolor=INK,
            borderpad=0.0,
            borderaxespad=0.0,
            handlelength=1.6,
            columnspacing=1.6,
            labelspacing=0.5,
        )
