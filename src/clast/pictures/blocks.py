"""Blocks on a picture: outlines, colours and names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from clast.model import Bools, Floats, Ints
from clast.pictures.canvas import FAINT, INK, NAME_BOX, SMALL_SIZE, TEXT_SIZE, Sheet, literal
from clast.pictures.fields import KINDS, SCALARS, prefixed
from clast.results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

MOST_NAMES = 40
"""Blocks that get their names written into them, at most."""
ONE_SIDED = 0.02
"""Values on one side of zero but for this share get a scale of one colour."""
FIXED = "#dcdcdc"
"""Fill of fixed blocks."""
HATCH = "////"
"""Hatching of fixed blocks."""
KIND_COLOURS = (
    "#8dbcd8",
    "#f0b67f",
    "#9cc99c",
    "#d8a0b4",
    "#c9c07a",
    "#a9a3d1",
    "#d4a88c",
    "#8fc7c1",
)
"""Muted colours for rocks and blocks, told apart by most eyes."""


class Outlined(Protocol):
    """Blocks whose outlines can be drawn: results, and whatever else knows them."""

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        ...

    @property
    def fixed(self) -> Bools:
        """True where a block cannot move at all, shape (n,)."""
        ...


def outlines_of(results: Outlined, vertices: Floats) -> list[Floats]:
    """Return the outline of each block, (k, 2), from the vertices of a frame."""
    return np.split(vertices, results.block_start[1:-1])


def _line_width(blocks: int) -> float:
    """Return a width of outlines, points, that leaves room for the colours of small blocks."""
    return float(np.clip(8.0 / np.sqrt(blocks), 0.12, 0.8))


def draw_start(axes: Axes, results: Outlined, start: Floats) -> None:
    """Outline the blocks where they were at the start."""
    from matplotlib.collections import PolyCollection

    outlines = outlines_of(results, start)
    axes.add_collection(
        PolyCollection(
            outlines,
            facecolors="none",
            edgecolors=FAINT,
            linewidths=0.8 * _line_width(len(outlines)),
            zorder=1,
        )
    )


def draw_blocks(axes: Axes, results: Outlined, vertices: Floats) -> PolyCollection:
    """Draw all blocks, the fixed ones hatched, and return those that are to be coloured."""
    from matplotlib.collections import PolyCollection

    outlines = outlines_of(results, vertices)
    width = _line_width(len(outlines))
    fixed, free = np.flatnonzero(results.fixed), np.flatnonzero(~results.fixed)
    axes.add_collection(
        PolyCollection(
            [outlines[b] for b in fixed],
            facecolors=FIXED,
            edgecolors=FAINT,
            linewidths=width,
            hatch=HATCH,
            zorder=2,
        )
    )
    blocks = PolyCollection([outlines[b] for b in free], edgecolors=INK, linewidths=width, zorder=3)
    axes.add_collection(blocks)
    return blocks


def colour(
    figure: Figure,
    sheet: Sheet,
    blocks: PolyCollection,
    results: Results,
    field: str,
    frame: int,
) -> None:
    """Colour the free blocks by a field and explain the colours."""
    free = ~results.fixed
    if not free.any():
        return
    if field in KINDS:
        kinds = results.field(field, frame)[free]
        blocks.set_facecolor([kind_colour(kind) for kind in kinds])
        return
    quantity = SCALARS[field]
    values = quantity.values(results, frame)[free]
    factor, unit = prefixed(float(np.abs(values).max()), quantity.unit)
    values = factor * values
    colours, low, high = scale_of(values)
    blocks.set_array(values)
    blocks.set_cmap(colours)
    blocks.set_clim(low, high)
    place = figure.add_axes(sheet.share(sheet.bar))
    bar = figure.colorbar(
        blocks, cax=place, orientation="vertical" if sheet.upright else "horizontal"
    )
    bar.set_label(f"{quantity.label} ({unit})", fontsize=TEXT_SIZE, color=INK)
    bar.ax.tick_params(labelsize=SMALL_SIZE, color=FAINT, labelcolor=INK, width=0.6, length=3)
    bar.outline.set_linewidth(0.5)
    bar.outline.set_edgecolor(FAINT)


RISING, FALLING, BOTH = ("YlOrRd", 0.0, 0.66), ("YlGnBu_r", 0.32, 1.0), ("RdBu_r", 0.14, 0.86)
"""Colours for values above zero, below, and on both sides: red is up or tension, blue the other.

The shares leave out the dark ends, on which no outline and no arrow could be seen.
"""


def scale_of(values: Floats) -> tuple[Colormap, float, float]:
    """Return the colours for values (n,) and the limits of the scale."""
    low, high = float(values.min()), float(values.max())
    size = max(abs(low), abs(high)) or 1.0
    if low >= -ONE_SIDED * size:
        return _colours(*RISING), 0.0, size
    if high <= ONE_SIDED * size:
        return _colours(*FALLING), -size, 0.0
    return _colours(*BOTH), -size, size


def _colours(name: str, first: float, last: float) -> Colormap:
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps[name](np.linspace(first, last, 256)))


def kind_colour(kind: int) -> str:
    """Return the colour of a rock or block; rows of eight do not line up in columns."""
    return KIND_COLOURS[(kind + kind // len(KIND_COLOURS)) % len(KIND_COLOURS)]


def draw_names(axes: Axes, results: Results, vertices: Floats) -> None:
    """Write the names of the blocks into them, where they are few."""
    outlines = outlines_of(results, vertices)
    if len(outlines) > MOST_NAMES:
        return
    for name, outline in zip(results.block_name, outlines, strict=True):
        axes.annotate(
            literal(name),
            outline.mean(axis=0),
            fontsize=SMALL_SIZE,
            color=INK,
            ha="center",
            va="center",
            bbox=NAME_BOX,
            zorder=4,
        )
