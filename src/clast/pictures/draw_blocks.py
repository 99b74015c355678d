"""Blocks on a picture: outlines, colours and names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures.canvas import FAINT, INK, Sheet, colour_bar, literal, write
from clast.pictures.fields import ColourScale, prefixed
from clast.pictures.strokes import following
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection, PolyCollection
    from matplotlib.figure import Figure

FIXED = "#dcdcdc"
"""Fill of fixed blocks."""
EXCAVATED = (0, (4.0, 3.0))
"""Dashes of the outlines of excavated blocks."""
HATCH = "////"
"""Hatching of fixed blocks."""
KIND_COLOURS = (
    "#e0c9a0",
    "#a9b88f",
    "#d9a384",
    "#c3b9c9",
    "#c9c07a",
    "#b59a7a",
    "#e3b7b7",
    "#9c9c8e",
)
"""Muted colours for rocks and blocks, told apart by most eyes; none is blue, as water is."""


class Divided(Protocol):
    """Vertices that are divided into blocks: results, cuts, and whatever else knows them."""

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        ...


class Outlined(Divided, Protocol):
    """Blocks whose outlines can be drawn as those of a run."""

    @property
    def fixed(self) -> Bools:
        """True where a block cannot move at all, shape (n,)."""
        ...


def outlines_of(results: Divided, vertices: Floats) -> list[Floats]:
    """Return the outline of each block, (k, 2), from the vertices of a frame."""
    return np.split(vertices, results.block_start[1:-1])


def _line_width(axes: Axes, results: Divided, vertices: Floats) -> float:
    """Return a width of outlines, points, that leaves room for the colours of small blocks."""
    box = axes.get_window_extent()
    figure = axes.get_figure(root=True)
    dots = figure.dpi if figure else 72.0
    scale = box.width / abs(float(np.ptp(axes.get_xlim()))) * 72.0 / dots
    size = scale * float(np.sqrt(np.median(areas_of(results, vertices))))
    return float(np.clip(0.02 * size, 0.05, 0.8))


def draw_start(axes: Axes, results: Outlined, start: Floats, absent: Bools | None = None) -> None:
    """Outline the blocks that are not ``absent`` (n,) where they were at the start."""
    from matplotlib.collections import PolyCollection

    outlines = outlines_of(results, start)
    if absent is not None:
        outlines = [outlines[block] for block in np.flatnonzero(~absent)]
    width = 0.8 * _line_width(axes, results, start)
    axes.add_collection(PolyCollection(outlines, fc="none", ec=FAINT, lw=width, zorder=1))


def draw_blocks(
    axes: Axes,
    results: Outlined,
    vertices: Floats,
    share: float = 1.0,
    absent: Bools | None = None,
    awaited: Bools | None = None,
) -> PolyCollection:
    """Draw all blocks, the fixed ones hatched, and return those that are to be coloured.

    Outlines have a ``share`` of their width, 0 where something else draws them.  Of blocks that are
    ``absent`` (n,) there is a thin outline only, of those ``awaited`` in a later stage (n,) none.
    """
    from matplotlib.collections import PolyCollection

    outlines = outlines_of(results, vertices)
    whole = _line_width(axes, results, vertices)
    gone = np.zeros(len(outlines), np.bool_) if absent is None else absent
    excavated = gone if awaited is None else gone & ~awaited
    excavated_looks: dict[str, Any] = {
        "fc": "none",
        "ec": FAINT,
        "lw": 0.6 * whole,
        "ls": EXCAVATED,
    }
    fixed_looks: dict[str, Any] = {"fc": FIXED, "ec": FAINT, "lw": share * whole, "hatch": HATCH}
    free_looks: dict[str, Any] = {"ec": INK, "lw": share * whole}
    blocks = []
    for zorder, drawn, looks in (
        (1, excavated, excavated_looks),
        (2, results.fixed & ~gone, fixed_looks),
        (3, ~results.fixed & ~gone, free_looks),
    ):
        chosen = [outlines[block] for block in np.flatnonzero(drawn)]
        blocks.append(PolyCollection(chosen, zorder=zorder, **looks))
        axes.add_collection(blocks[-1])
    return blocks[-1]


def paint(blocks: Collection, values: Floats, scale: ColourScale, unit: str) -> str:
    """Colour blocks or lines by their values (k,) on a scale; return the unit, with its prefix."""
    factor, unit = prefixed(max(abs(scale.low), abs(scale.high)), unit)
    blocks.set_array(factor * values)
    blocks.set_cmap(scale.colours)
    blocks.set_clim(factor * scale.low, factor * scale.high)
    return unit


def draw_colour_bar(
    figure: Figure, sheet: Sheet, coloured: Collection, label: str, extend: str
) -> None:
    """Explain on a sheet how blocks or lines are coloured; ``extend`` as matplotlib has it."""
    from matplotlib.ticker import MaxNLocator

    orientation = "vertical" if sheet.upright else "horizontal"
    bar = colour_bar(figure, coloured, sheet.parts(sheet.bar), label, extend, orientation)
    if not sheet.upright:
        most = max(2, int(sheet.bar[2] / 0.45))  # inches that a number takes
        bar.locator = MaxNLocator(min(9, most), steps=[1, 2, 2.5, 5, 10])
        bar.update_ticks()


def areas_of(results: Divided, vertices: Floats) -> Floats:
    """Return the area of each block, m2, shape (n,)."""
    # about the middle, or the digits of far coordinates are lost
    vertices = vertices - vertices.mean(axis=0)
    (x, y), (x2, y2) = vertices.T, vertices[following(results.block_start)].T
    return np.asarray(0.5 * np.abs(np.add.reduceat(x * y2 - x2 * y, results.block_start[:-1])))


def within(results: Divided, vertices: Floats, low: Floats, high: Floats) -> Bools:
    """Return which blocks may be seen in the box (low, high), m, shape (n,)."""
    first = results.block_start[:-1]
    left, right = np.minimum.reduceat(vertices, first), np.maximum.reduceat(vertices, first)
    return np.asarray(np.all((right >= low) & (left <= high), axis=1))


def kind_colour(kind: int) -> str:
    """Return the colour of a rock or block; rows of eight do not line up in columns."""
    return KIND_COLOURS[(kind + kind // len(KIND_COLOURS)) % len(KIND_COLOURS)]


def draw_names(axes: Axes, results: Recording, vertices: Floats, absent: Bools) -> None:
    """Write the names of the blocks that are not ``absent`` (n,) into them, where they are few."""
    outlines = outlines_of(results, vertices)
    # Blocks that get their names written into them
    if len(outlines) > 40:
        return
    for block in np.flatnonzero(~absent):
        write(axes, literal(results.block_name[block]), outlines[block].mean(axis=0), 4)
