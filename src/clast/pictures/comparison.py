"""End states of the same system side by side, coloured on one scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import INK, SMALL, TEXT
from clast.pictures.fields import colours_between, prefixed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection

STOPPED = "#b3261e"
"""Colour of the remark on a run that could not go on."""
BETWEEN, HEADS = 0.35, 0.5
"""Space between panels, and for the two lines above each, inches."""


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One end state."""

    title: str
    remark: str
    """A line below the title."""
    finished: bool
    """False for a run that stopped: its remark is coloured, and it does not set the limits."""
    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    absent: Bools | None = None
    """True where a block has been excavated, shape (n,); None: they are all there."""


@dataclass(frozen=True, kw_only=True)
class SideBySide:
    """The system that all panels show; n blocks, nv vertices."""

    title: str
    start: Floats
    """Vertices at the start, m, shape (nv, 2)."""
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,)."""
    panels: Sequence[Panel]
    """The end states, row by row."""
    columns: int
    """Panels in a row."""

    def displacement(self, panel: Panel) -> Floats:
        """Return how far the centre of each block's vertices has moved, m, shape (n,)."""
        count = np.diff(self.block_start)
        moved = np.add.reduceat(panel.vertices - self.start, self.block_start[:-1])
        return np.hypot(*(moved / count[:, None]).T)

    def free(self, panel: Panel) -> Bools:
        """Return which blocks are there and can move, shape (n,)."""
        return ~self.fixed if panel.absent is None else ~self.fixed & ~panel.absent

    def farthest(self, panel: Panel) -> float:
        """Return the largest displacement of a block that is there and can move, m."""
        return float(self.displacement(panel)[self.free(panel)].max(initial=0.0))


def draw_side_by_side(scene: SideBySide, path: Path) -> Path:
    """Draw end states on one scale of colours and of lengths; return the picture's path."""
    shown = [panel for panel in scene.panels if panel.finished] or list(scene.panels)
    low, high = _limits(scene, shown)
    rows = -(-len(scene.panels) // scene.columns)
    extent = np.maximum(high - low, 0.05 * (high - low).max())
    across, up = min(4.0, 11.0 / scene.columns), min(4.0, 9.0 / rows)
    scale = min(across / extent[0], up / extent[1])
    size = max(1.8, float(scale * extent[0])), max(1.0, float(scale * extent[1]))
    width = canvas.LEFT + scene.columns * (size[0] + BETWEEN) + canvas.RIGHT
    title = canvas.wrapped(scene.title, width - canvas.LEFT - 0.1, canvas.TITLE_SIZE)
    top = 0.32 + canvas.LINE * len(title)
    # Space for the colour bar below the panels, inches
    height = top + rows * (size[1] + HEADS) + canvas.BELOW + 0.75
    figure = canvas.new_figure((width, height), 150)
    canvas.head(figure, canvas.LEFT, title, "")
    largest = max(map(scene.farthest, shown))
    drawn = None
    for number, panel in enumerate(scene.panels):
        row, column = divmod(number, scene.columns)
        left = canvas.LEFT + column * (size[0] + BETWEEN)
        low_edge = height - top - (row + 1) * (size[1] + HEADS) + 0.08
        box = (left / width, low_edge / height, size[0] / width, size[1] / height)
        axes = figure.add_axes(box)
        canvas.view(axes, *canvas.seen(low, high, size), size)
        drawn = _draw_panel(axes, scene, panel, largest)
        if row < rows - 1:
            axes.set_xlabel("")
            axes.tick_params(labelbottom=False)
        if column > 0:
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
    if drawn is not None:
        beyond = any(scene.farthest(panel) > 1.001 * largest for panel in scene.panels)
        long = min(width - canvas.LEFT - canvas.RIGHT, 5.0)
        box = (canvas.LEFT / width, 0.5 / height, long / width, 0.14 / height)
        label = f"Displacement of a block ({prefixed(largest, 'm')[1]})"
        canvas.colour_bar(figure, drawn, box, label, "max" if beyond else "neither")
    return canvas.save(figure, path)


def _limits(scene: SideBySide, shown: Sequence[Panel]) -> tuple[Floats, Floats]:
    """Return the corners (2,), (2,) of the box that holds the start and the panels shown, m."""
    states = np.concatenate([scene.start, *(panel.vertices for panel in shown)])
    first, extent = scene.start.min(axis=0), np.ptp(scene.start, axis=0).max()
    # what has flown away is left outside
    low = np.maximum(states.min(axis=0), first - 0.5 * extent)
    high = np.minimum(states.max(axis=0), scene.start.max(axis=0) + 0.5 * extent)
    return low, high


def _draw_panel(axes: Axes, scene: SideBySide, panel: Panel, largest: float) -> PolyCollection:
    draw_blocks.draw_start(axes, scene, scene.start, panel.absent)
    free = draw_blocks.draw_blocks(axes, scene, panel.vertices, absent=panel.absent)
    values = scene.displacement(panel)[scene.free(panel)]
    factor, _ = prefixed(largest, "m")
    colours = colours_between(0.0, 1.0)
    free.set_array(factor * values)
    free.set_cmap(colours)
    free.set_clim(0.0, factor * largest or 1.0)
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
    title, remark = canvas.literal(panel.title), canvas.literal(panel.remark)
    axes.annotate(title, (0.0, 1.0), xytext=(0, 17), **place, **TEXT, fontweight="bold")
    colour = INK if panel.finished else STOPPED
    axes.annotate(remark, (0.0, 1.0), xytext=(0, 5), **place, **{**SMALL, "color": colour})
    return free
