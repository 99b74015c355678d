"""Figures of sweeps: a measure against one parameter, or as matrices of two and more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.distributions import Value
from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, LEGEND, SMALL, SMALL_SIZE, TEXT, TEXT_SIZE, literal
from clast.pictures.study.figures import (
    BLUE,
    DOTS,
    RED,
    STANDING,
    behind_number,
    draw_scale,
    end_of,
    is_wide,
    new_axes,
    save_axes,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

Flags = np.ndarray[Any, np.dtype[np.bool_]]
LEAST_RATIO, MOST_UNEVEN = 5.0, 3.0
"""Values by logarithms: ratio of largest to least, and of the largest step of logarithms to the
least; an outlier among even steps does not make an axis logarithmic."""
VALUE_LETTERS_MAX = 18
"""Letters of a value beside an axis."""
ALONE, AMONG_OTHERS = (4.6, 3.0), (2.3, 1.8)
"""Width and height of a matrix that stands alone, and of one among others, inches."""
PANELS_IN_ROW, MOST_PANELS = 3, 12
"""Matrices in a row, and in a figure, at most."""
ROOM = (0.42, 0.17)
"""Width and height of a cell in which its number can be read, inches."""


@dataclass(frozen=True, kw_only=True)
class SweepAxis:
    """A parameter of a sweep; k values."""

    label: str
    values: tuple[Value, ...]
    """Its values, in the order of the list."""
    unit: str = ""

    @property
    def is_numeric(self) -> bool:
        """Whether its values are numbers, not texts, places, or true and false."""
        return not any(isinstance(one, str | bool | tuple) for one in self.values)

    @property
    def title(self) -> str:
        """Its name and unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    @property
    def order(self) -> list[int]:
        """Positions of its values as figures have them: numbers ascending, others as listed."""
        positions = range(len(self.values))
        return sorted(positions, key=lambda k: self.values[k]) if self.is_numeric else [*positions]

    def written(self, position: int) -> str:
        """Return a value as text."""
        value = self.values[position]
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, tuple):
            return f"({', '.join(f'{one:.4g}' for one in value)})"
        if isinstance(value, str):
            return (
                value if len(value) <= VALUE_LETTERS_MAX else value[: VALUE_LETTERS_MAX - 1] + "…"
            )
        return f"{float(f'{value:.4g}'):g}"


@dataclass(frozen=True, kw_only=True)
class SweepGrid:
    """A measure of the runs of a sweep; an entry for each combination of values, shape (k, ...)."""

    axes: tuple[SweepAxis, ...]
    """The parameters, one for each dimension."""
    label: str
    """The measure and its unit."""
    values: Floats
    """The measure; NaN where a run has none, or is not done."""
    fails: Flags
    lost: Flags
    """Where a run was made that has no result."""
    words: tuple[str, str] = ("stands", "fails")
    """Outcomes of runs that do not fail, and of those that do."""


def is_by_logarithms(values: Floats) -> bool:
    """Return whether values (k,) were chosen by their logarithms, as 1, 2, 5, 10 or 1e3, 1e4, 1e5.

    Their logarithms then lie about evenly, and more so than they do themselves; two values are
    decades apart.
    """
    ordered = np.unique(values)
    if len(ordered) < 2 or ordered[0] <= 0.0 or ordered[-1] < LEAST_RATIO * ordered[0]:
        return False
    if len(ordered) == 2:
        return is_wide(ordered)
    steps, logarithms = np.diff(ordered), np.diff(np.log(ordered))
    uneven = logarithms.max() / logarithms.min()
    return bool(uneven < min(MOST_UNEVEN, steps.max() / steps.min()))


def draw_sweep(grid: SweepGrid, path: Path) -> Path:
    """Draw a measure against one parameter, or matrices of more; return the picture's path."""
    return draw_curve(grid, path) if len(grid.axes) == 1 else draw_matrices(grid, path)


def draw_curve(grid: SweepGrid, path: Path) -> Path:
    """Draw a measure against a parameter (k,); return the picture's path."""
    axis = grid.axes[0]
    order = axis.order
    axes = new_axes(axis.title, grid.label, height=0.75)
    x: Floats = np.arange(len(order), dtype=np.float64)
    if axis.is_numeric:
        x = np.array([axis.values[k] for k in order], np.float64)
        if is_by_logarithms(x):
            axes.set_xscale("log")
    else:
        axes.set_xticks(x.tolist(), [literal(axis.written(k)) for k in order])
    y, fails, lost = grid.values[order], grid.fails[order], grid.lost[order]
    axes.plot(x, y, color=FAINT, lw=0.9, zorder=1)
    # Runs up to which a curve has large marks
    size = 5.5 if len(x) <= 60 else 2.5
    stand, fail = grid.words
    for alike, mark, colour, label in ((~fails, "o", BLUE, stand), (fails, "X", RED, fail)):
        axes.plot(x[alike], y[alike], mark, color=colour, ms=size, label=label)
    if is_wide(y[np.isfinite(y)]):
        axes.set_yscale("log")
    bottom = np.full(int(lost.sum()), 0.03)
    edge = axes.get_xaxis_transform()
    axes.plot(x[lost], bottom, "x", color=INK, ms=6, transform=edge, label="no result")
    there = {stand: fails.any(), fail: fails.any(), "no result": lost.any()}
    marks = [one for one in axes.get_lines() if there.get(str(one.get_label()))]
    if marks:
        place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.99), "ncols": 3}
        axes.legend(handles=marks, **place, **LEGEND)
    return save_axes(axes, path)


# Matrices ----------------------------------------------------------------------------------------


def panels_in(grid: SweepGrid) -> int:
    """Return how many matrices all of a grid has; 1 for a curve."""
    return math.prod(sorted(grid.values.shape)[:-2])


def panels_of(grid: SweepGrid) -> tuple[SweepGrid, list[tuple[str, ...]], list[tuple[int, ...]]]:
    """Return the grid by panels, shape (..., rows, columns), their titles and their positions."""
    lengths = [len(one.values) for one in grid.axes]
    inner = sorted(range(len(lengths)), key=lambda k: -lengths[k])[:2]
    order = [k for k in range(len(lengths)) if k not in inner] + inner[::-1]
    axes = tuple(grid.axes[k] for k in order)
    sort = np.ix_(*(one.order for one in axes))
    sorted_axes = tuple(
        SweepAxis(label=one.label, unit=one.unit, values=tuple(one.values[k] for k in one.order))
        for one in axes
    )
    by_panel = SweepGrid(
        axes=sorted_axes,
        label=grid.label,
        values=np.transpose(grid.values, order)[sort],
        fails=np.transpose(grid.fails, order)[sort],
        lost=np.transpose(grid.lost, order)[sort],
    )
    outer = sorted_axes[:-2]
    places = [*product(*(range(len(one.values)) for one in outer))]
    titles = [
        tuple(
            f"{one.label} = {one.written(k)}{behind_number(one.unit)}"
            for one, k in zip(outer, place, strict=True)
        )
        for place in places
    ]
    return by_panel, titles, places


def draw_matrices(grid: SweepGrid, path: Path) -> Path:
    """Draw a matrix of two parameters for each combination of the others; return the path."""
    from matplotlib.cm import ScalarMappable

    by_panel, titles, places = panels_of(grid)
    titles, places = titles[:MOST_PANELS], places[:MOST_PANELS]
    rows, columns = by_panel.axes[-2:]
    longest = max(len(rows.written(k)) for k in range(len(rows.values)))
    # a legend above and a scale below; values at the left of each matrix, its title above it
    across = min(PANELS_IN_ROW, len(places))
    box, gap = ALONE if len(places) == 1 else AMONG_OTHERS, 0.45 + 0.075 * longest
    head = 0.06 + 0.17 * len(titles[0])
    tall = box[1] + 0.55 + head
    width, height = across * (box[0] + gap) + 0.3, -(-len(places) // across) * tall + 0.3 + 0.65
    figure = canvas.new_figure((width, height), DOTS)
    shown = np.array([by_panel.values[place] for place in places])
    norm = _norm(shown[np.isfinite(shown)])
    for number, (place, title) in enumerate(zip(places, titles, strict=True)):
        row, column = divmod(number, across)
        left, bottom = column * (box[0] + gap) + gap, height - (0.3 + row * tall + head) - box[1]
        axes = figure.add_axes((left / width, bottom / height, box[0] / width, box[1] / height))
        panel = SweepGrid(
            axes=(rows, columns),
            label=grid.label,
            values=by_panel.values[place],
            fails=by_panel.fails[place],
            lost=by_panel.lost[place],
        )
        _draw_panel(axes, panel, box, norm)
        letters = canvas.letters_in(box[0] + 0.5 * gap, SMALL_SIZE)
        text = literal("\n".join(end_of(one, letters) for one in title))
        axes.set_title(text, pad=3, **SMALL)
    long = min(4.6, width - 1.0)
    colours = ScalarMappable(norm, _colours())
    draw_scale(figure, colours, (width - long) / 2 / width, long / width, 0.45, literal(grid.label))
    _explain(figure, by_panel)
    return canvas.save(figure, path)


def _norm(values: Floats) -> Normalize:
    """Return the scale of colours of values (k,), by logarithms over some decades."""
    from matplotlib.colors import LogNorm, Normalize

    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if is_wide(values):
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + max(1e-9, abs(low)))


def _colours() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("sweep", [STANDING, "#9cc3cd", BLUE])


def _draw_panel(axes: Axes, panel: SweepGrid, box: tuple[float, float], norm: Normalize) -> None:
    """Draw a matrix (rows, columns), the first row below."""
    from matplotlib.collections import PolyCollection

    rows, columns = panel.values.shape
    room = box[0] / columns, box[1] / rows
    seen = np.ma.masked_invalid(panel.values)
    axes.imshow(seen, origin="lower", aspect="auto", cmap=_colours(), norm=norm)
    canvas.style(axes)
    line = min(1.6, 72.0 * 0.1 * min(room))
    in_cell = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    half = 0.5 - 0.5 * line / 72.0 / np.array(room)
    frames = [in_cell * half + (column, row) for row, column in np.argwhere(panel.fails)]
    axes.add_collection(PolyCollection(frames, facecolors="none", edgecolors=RED, linewidths=line))
    at = np.argwhere(panel.lost)
    size = min(7.0, 72.0 * 0.5 * min(room))
    axes.plot(at[:, 1], at[:, 0], "x", color=INK, ms=size, mew=min(1.2, 0.2 * size))
    if room[0] >= ROOM[0] and room[1] >= ROOM[1]:
        for row, column in np.argwhere(np.isfinite(panel.values)):
            value = panel.values[row, column]
            dark = float(norm(value)) > 0.75
            colour = "white" if dark else INK
            place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": SMALL_SIZE - 1.0}
            axes.text(column, row, f"{value:.3g}", color=colour, **place)
    _ticks(axes, panel.axes, box)


def _ticks(axes: Axes, of: Sequence[SweepAxis], box: tuple[float, float]) -> None:
    """Write values beside a matrix, as many as there is room for, and the names of parameters."""
    rows, columns = of
    longest = max(len(columns.written(k)) for k in range(len(columns.values)))
    for axis, one, fitting in (
        (axes.xaxis, columns, int(box[0] / (0.12 + 0.075 * longest))),
        (axes.yaxis, rows, int(box[1] / 0.18)),
    ):
        every = -(-len(one.values) // max(1, fitting))
        places = range(0, len(one.values), every)
        axis.set_ticks([*places], [literal(one.written(k)) for k in places])
    letters = canvas.letters_in(box[1] + 0.3, TEXT_SIZE), canvas.letters_in(box[0], TEXT_SIZE)
    axes.set_ylabel(literal(end_of(rows.title, letters[0])), **TEXT)
    axes.set_xlabel(literal(end_of(columns.title, letters[1])), **TEXT)


def _explain(figure: Figure, grid: SweepGrid) -> None:
    """Explain the marks of matrices at the upper end of a figure; those alone that there are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if grid.fails.any():
        handles.append(Patch(facecolor="none", edgecolor=RED, lw=1.6, label="fails"))
    if grid.lost.any():
        handles.append(Line2D([], [], color=INK, marker="x", ls="none", label="no result"))
    if handles:
        figure.legend(handles=handles, loc="upper right", ncols=2, **LEGEND)
