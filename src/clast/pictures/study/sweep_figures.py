"""Figures of sweeps: a measure against one parameter, or as matrices of two and more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT_SIZE
from clast.pictures.study.figures import (
    BLUE,
    DOTS,
    RED,
    STANDING,
    behind_number,
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
MANY = 60
"""Runs from which a curve has small marks."""
LONGEST_TEXT = 18
"""Most letters of a value beside an axis."""
WHOLE, SMALL = (4.6, 3.0), (2.3, 1.8)
"""Width and height of a matrix that stands alone, and of one among others, inches."""
ROW = 3
"""Matrices in a row."""
MOST_PANELS = 12
"""Most matrices of a figure."""
ROOM = (0.42, 0.17)
"""Width and height of a cell in which its number can be read, inches."""


@dataclass(frozen=True, kw_only=True)
class SweepAxis:
    """A parameter of a sweep; k values."""

    label: str
    """Parameter."""
    values: tuple[float | int | str | bool, ...]
    """Its values, in the order of the list."""
    unit: str = ""
    """Unit; "" where it has none."""

    @property
    def is_numeric(self) -> bool:
        """Whether its values are numbers, not texts or true and false."""
        return not any(isinstance(one, str | bool) for one in self.values)

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
        if isinstance(value, str):
            return value if len(value) <= LONGEST_TEXT else value[: LONGEST_TEXT - 1] + "…"
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
    """Where a run fails."""
    lost: Flags
    """Where a run was made that has no result."""


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
    own, logarithms = np.diff(ordered), np.diff(np.log(ordered))
    uneven = logarithms.max() / logarithms.min()
    return bool(uneven < min(MOST_UNEVEN, own.max() / own.min()))


def draw_sweep(grid: SweepGrid, path: Path) -> Path:
    """Draw a measure against one parameter, or matrices of more; return the picture's path."""
    return draw_curve(grid, path) if len(grid.axes) == 1 else draw_matrices(grid, path)


def draw_curve(grid: SweepGrid, path: Path) -> Path:
    """Draw a measure against a parameter (k,); return the picture's path.

    Runs without a result interrupt the curve and are marked at the lower edge.
    """
    axis = grid.axes[0]
    order = axis.order
    axes = new_axes(axis.title, grid.label, height=0.75)
    x: Floats = np.arange(len(order), dtype=np.float64)
    if axis.is_numeric:
        x = np.array([axis.values[k] for k in order], np.float64)
        if is_by_logarithms(x):
            axes.set_xscale("log")
    else:
        axes.set_xticks(x.tolist(), [canvas.literal(axis.written(k)) for k in order])
    y, fails, lost = grid.values[order], grid.fails[order], grid.lost[order]
    axes.plot(x, y, color=FAINT, lw=0.9, zorder=1)
    size = 5.5 if len(x) <= MANY else 2.5
    for own, mark, colour, label in ((~fails, "o", BLUE, "stands"), (fails, "X", RED, "fails")):
        axes.plot(x[own], y[own], mark, color=colour, ms=size, label=label)
    if is_wide(y[np.isfinite(y)]):
        axes.set_yscale("log")
    bottom = np.full(int(lost.sum()), 0.03)
    edge = axes.get_xaxis_transform()
    axes.plot(x[lost], bottom, "x", color=INK, ms=6, transform=edge, label="no result")
    if fails.any() or lost.any():
        _key(axes, bool(fails.any()), bool(lost.any()))
    return save_axes(axes, path)


def _key(axes: Axes, fails: bool, lost: bool) -> None:
    """Explain the marks of a curve, above it; those alone that there are."""
    wanted = {"stands": fails, "fails": fails, "no result": lost}
    found = [one for one in axes.get_lines() if wanted.get(str(one.get_label()))]
    place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.99), "ncols": 3}
    axes.legend(handles=found, fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, **place)


# Matrices ----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Where matrices stand on their sheet; inches."""

    rows: int
    """Rows of matrices."""
    columns: int
    """Matrices in a row."""
    box: tuple[float, float]
    """Width and height of one."""
    gap: tuple[float, float]
    """Room at the left of each and below it, for values and names."""
    head: float
    """Room above each, for its title."""

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the sheet; there is a legend above and a scale below."""
        width = self.columns * (self.box[0] + self.gap[0]) + 0.3
        return width, self.rows * (self.box[1] + self.gap[1] + self.head) + 0.3 + 0.65

    def place(self, number: int) -> tuple[float, float, float, float]:
        """Return left, bottom, width and height of a matrix as shares of the sheet."""
        row, column = divmod(number, self.columns)
        left = column * (self.box[0] + self.gap[0]) + self.gap[0]
        above = 0.3 + row * (self.box[1] + self.gap[1] + self.head) + self.head
        width, height = self.size
        bottom = height - above - self.box[1]
        return left / width, bottom / height, self.box[0] / width, self.box[1] / height


def panels_in(grid: SweepGrid) -> int:
    """Return how many matrices all of a grid has; 1 for a curve."""
    return math.prod(sorted(grid.values.shape)[:-2])


def panels_of(grid: SweepGrid) -> tuple[SweepGrid, list[tuple[str, ...]], list[tuple[int, ...]]]:
    """Return the grid by panels, shape (..., rows, columns), their titles and their positions.

    The two parameters with most values are rows and columns, the one with more along x; values are
    in the order of the axes.
    """
    lengths = [len(one.values) for one in grid.axes]
    inner = sorted(range(len(lengths)), key=lambda k: -lengths[k])[:2]
    order = [k for k in range(len(lengths)) if k not in inner] + inner[::-1]
    axes = tuple(grid.axes[k] for k in order)
    sort = np.ix_(*(one.order for one in axes))
    sorted_axes = tuple(
        SweepAxis(label=one.label, unit=one.unit, values=tuple(one.values[k] for k in one.order))
        for one in axes
    )
    found = SweepGrid(
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
    return found, titles, places


def draw_matrices(grid: SweepGrid, path: Path) -> Path:
    """Draw a matrix of two parameters for each combination of the others; return the path.

    At most MOST_PANELS of them, all with the same colours.
    """
    by_panel, titles, places = panels_of(grid)
    titles, places = titles[:MOST_PANELS], places[:MOST_PANELS]
    rows, columns = by_panel.axes[-2:]
    longest = max(len(rows.written(k)) for k in range(len(rows.values)))
    columns_of_sheet = min(ROW, len(places))
    layout = Layout(
        rows=-(-len(places) // columns_of_sheet),
        columns=columns_of_sheet,
        box=WHOLE if len(places) == 1 else SMALL,
        gap=(0.45 + 0.075 * longest, 0.55),
        head=0.06 + 0.17 * len(titles[0]),
    )
    figure = canvas.new_figure(layout.size, DOTS)
    shown = np.array([by_panel.values[place] for place in places])
    norm = _norm(shown[np.isfinite(shown)])
    for number, (place, title) in enumerate(zip(places, titles, strict=True)):
        axes = figure.add_axes(layout.place(number))
        panel = SweepGrid(
            axes=(rows, columns),
            label=grid.label,
            values=by_panel.values[place],
            fails=by_panel.fails[place],
            lost=by_panel.lost[place],
        )
        _draw_panel(axes, panel, layout.box, norm)
        fitting = canvas.letters_in(layout.box[0] + 0.5 * layout.gap[0], SMALL_SIZE)
        named = [one if len(one) <= fitting else "…" + one[1 - fitting :] for one in title]
        text = canvas.literal("\n".join(named))
        axes.set_title(text, fontsize=SMALL_SIZE, color=INK, pad=3)
    _scale(figure, norm, grid.label)
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
        axis.set_ticks([*places], [canvas.literal(one.written(k)) for k in places])
    letters = canvas.letters_in(box[1] + 0.3, TEXT_SIZE), canvas.letters_in(box[0], TEXT_SIZE)
    names = [
        one.title if len(one.title) <= most else "…" + one.title[1 - most :]
        for one, most in zip(of, letters, strict=True)
    ]
    axes.set_ylabel(canvas.literal(names[0]), fontsize=TEXT_SIZE, color=INK)
    axes.set_xlabel(canvas.literal(names[1]), fontsize=TEXT_SIZE, color=INK)


def _scale(figure: Figure, norm: Normalize, label: str) -> None:
    """Draw the scale of colours at the lower end of a figure."""
    from matplotlib.cm import ScalarMappable

    width, height = figure.get_size_inches()
    long = min(4.6, width - 1.0)
    box = ((width - long) / 2 / width, 0.45 / height, long / width, 0.12 / height)
    bar = figure.add_axes(box)
    colours = ScalarMappable(norm, _colours())
    scale = figure.colorbar(colours, cax=bar, orientation="horizontal")
    scale.set_label(canvas.literal(label), fontsize=SMALL_SIZE, color=INK)
    bar.tick_params(which="both", labelsize=SMALL_SIZE, labelcolor=INK, color=FAINT)
    cast("Any", scale).outline.set_edgecolor(FAINT)


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
        place: dict[str, Any] = {"loc": "upper right", "ncols": 2, "frameon": False}
        figure.legend(handles=handles, fontsize=SMALL_SIZE, labelcolor=INK, **place)
