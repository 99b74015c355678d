"""Figures of studies: spread, probability, influence, displacement against a factor, blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from clast.model.model import Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

BLUE, RED, GREEN = "#1f6f8b", "#c1440e", "#6a8d2f"
STANDING = "#f4f4f2"
"""Colour of blocks that do not fail."""
MOST_BINS = 60
"""Most bins of a histogram."""
DECADES = 100.0
"""Ratio of largest to least value from which an axis is logarithmic."""
SIZE = (5.4, 3.5)
"""Width and height of a figure, inches."""
DOTS = 150
"""Dots per inch."""
LONGEST_LABEL = 34
"""Most letters of the name of a parameter."""


@dataclass(frozen=True, kw_only=True)
class Band:
    """A cumulative curve with its band; k values."""

    x: Floats
    """Values, ascending, shape (k,)."""
    share: Floats
    """Share of runs up to each, shape (k,)."""
    half: Floats
    """Half the width of the band, shape (k,); zeros: none is known."""
    confidence: float
    """Confidence with which the band holds the whole curve."""


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A bar of a tornado."""

    label: str
    """Parameter."""
    low: float
    """Value where the parameter is least."""
    high: float
    """Value where it is largest."""
    ends: tuple[float, float]
    """Least and largest values of the parameter."""
    unit: str = ""
    """Unit of the parameter; "" where it has none."""

    @property
    def caption(self) -> str:
        """Its name, and below it the values of the parameter."""
        ends = " to ".join(map(_short, self.ends))
        return f"{short_label(self.label)}\n{ends}{behind_number(self.unit)}"


@dataclass(frozen=True, kw_only=True)
class TrialMark:
    """A trial of a study of collapse."""

    factor: float
    """Its factor."""
    displacement: float
    """Largest displacement, m."""
    verdict: str
    """"stands", "fails" or "undecided"."""


@dataclass(frozen=True, kw_only=True)
class TrialCourse:
    """The k steps of a trial, and the limits by which it is judged."""

    moved: Floats
    """Largest movements of the steps, added up, m, shape (k,)."""
    unbalanced: Floats
    """Largest unbalanced force of a block, as a share of the forces on it, shape (k,)."""
    goes: float
    """Movement from which blocks may fail, m."""
    balanced: float
    """Unbalanced force below which they are in equilibrium, as a share of the forces on them."""


@dataclass(frozen=True, kw_only=True)
class FailureSection:
    """A section of n blocks, nv vertices, coloured by how often each fails."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    share: Floats
    """Share of the runs in which each block fails, shape (n,)."""


@dataclass(frozen=True, kw_only=True)
class FailurePlaces:
    """Places of a section, coloured by how often each fails."""

    x: Floats
    """Centres of the cells, m, evenly spaced, shape (nx,)."""
    y: Floats
    """The same along y, shape (ny,)."""
    share: Floats
    """Share of the runs in which each cell fails, shape (ny, nx); NaN where there is no rock."""
    outline: Sequence[Floats]
    """Rings round the rock, m, each of shape (k, 2)."""


def draw_histogram(values: Floats, fails: Floats, label: str, path: Path) -> Path:
    """Draw how often values (k,) occur, in runs that fail and others; return the picture's path.

    ``fails`` is 1 where a run fails, shape (k,), or (0,) where nothing is said of it.
    """
    axes = new_axes(label, "runs")
    sound = np.isfinite(values)
    kept = values[sound]
    place = np.log10 if is_wide(kept) else np.asarray
    bins = np.histogram_bin_edges(place(kept), bins="auto") if len(kept) else np.array([0.0, 1.0])
    if len(bins) > MOST_BINS + 1:
        bins = np.linspace(bins[0], bins[-1], MOST_BINS + 1)
    if is_wide(kept):
        bins = 10.0**bins
        axes.set_xscale("log")
    own = fails[sound] > 0.0 if len(fails) else np.zeros(len(kept), bool)
    axes.hist(
        [kept[~own], kept[own]],
        bins=bins.tolist(),
        stacked=True,
        color=[BLUE, RED],
        label=["stand", "fail"],
        edgecolor="white",
        lw=0.5,
    )
    if own.any():
        axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    return save_axes(axes, path)


def is_wide(values: Floats) -> bool:
    """Return whether values (k,) are better seen by their logarithms: over some decades."""
    return bool(len(values)) and 0.0 < DECADES * float(values.min()) < float(values.max())


def draw_cumulative(band: Band, label: str, path: Path) -> Path:
    """Draw the share of runs up to a value, with its band; return the picture's path."""
    axes = new_axes(label, "share of the runs up to it")
    axes.step(band.x, band.share, where="post", color=BLUE, lw=1.3)
    if band.half.any():
        low = np.clip(band.share - band.half, 0.0, 1.0)
        high = np.clip(band.share + band.half, 0.0, 1.0)
        label = f"{100 * band.confidence:g} %: the whole curve"
        axes.fill_between(band.x, low, high, step="post", color=BLUE, alpha=0.18, lw=0, label=label)
        axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    if is_wide(band.x):
        axes.set_xscale("log")
    axes.set_ylim(0.0, 1.02)
    return save_axes(axes, path)


def draw_tornado(bars: Sequence[Bar], middle: float, name: str, path: Path) -> Path:
    """Draw how far a measure goes with each parameter; return the picture's path."""
    size = (SIZE[0], max(SIZE[1], 1.3 + 0.4 * len(bars)))
    axes = new_axes(name, "", left=0.42, height=0.9 - 0.63 / size[1], size=size)
    for colour, said in ((BLUE, "least"), (RED, "largest")):
        axes.barh(0, 0.0, left=middle, color=colour, label=f"parameter {said}")
    for row, bar in enumerate(reversed(bars)):
        # on one side each has half of the height, so that neither hides the other
        both = (bar.low - middle) * (bar.high - middle) > 0.0
        height, away = (0.3, 0.15) if both else (0.6, 0.0)
        for value, colour, place in ((bar.low, BLUE, row + away), (bar.high, RED, row - away)):
            axes.barh(place, value - middle, left=middle, height=height, color=colour)
    captions = [canvas.literal(bar.caption) for bar in reversed(bars)]
    axes.set_yticks(range(len(bars)), captions)
    axes.axvline(middle, color=INK, lw=0.8)
    axes.grid(axis="y", visible=False)
    axes.set_ylim(-0.6, len(bars) - 0.4)
    axes.legend(
        fontsize=SMALL_SIZE,
        frameon=False,
        labelcolor=INK,
        loc="lower right",
        bbox_to_anchor=(1.0, 0.99),
        ncols=2,
    )
    return save_axes(axes, path)


def draw_factors(
    marks: Sequence[TrialMark], bracket: tuple[float, float], path: Path, name: str
) -> Path:
    """Draw displacement against factor, with the bracket shaded; return the picture's path."""
    axes = new_axes(name, "largest displacement (m)")
    low, high = bracket
    if low > 0.0 and np.isfinite(high):
        label = f"{low:.5g} to {high:.5g}"
        axes.axvspan(low, high, color=RED, alpha=0.15, lw=0, label=label)
    moved = [one.displacement for one in marks if one.displacement > 0.0]
    least = min(moved, default=1e-6)
    shown = sorted(marks, key=lambda one: one.factor)
    axes.plot(
        [one.factor for one in shown],
        [max(one.displacement, 0.5 * least) for one in shown],
        color=FAINT,
        lw=0.8,
        zorder=1,
    )
    for verdict, colour, mark in (
        ("stands", GREEN, "o"),
        ("fails", RED, "X"),
        ("undecided", INK, "D"),
    ):
        own = [one for one in shown if one.verdict == verdict]
        if own:
            axes.plot(
                [one.factor for one in own],
                [max(one.displacement, 0.5 * least) for one in own],
                mark,
                color=colour,
                ms=5.5,
                label=verdict,
            )
    axes.set_yscale("log")
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    return save_axes(axes, path)


def draw_course(course: TrialCourse, path: Path) -> Path:
    """Draw movement and unbalanced force of a trial step by step; return the picture's path."""
    size = (SIZE[0], 1.5 * SIZE[1])
    below = new_axes("step", "unbalanced force / forces", height=0.37, size=size)
    figure = cast("Figure", below.get_figure(root=True))
    place = below.get_position()
    above = figure.add_axes((place.x0, place.y1 + 0.08, place.width, place.height), sharex=below)
    label_axes(above, "", "movement (m)")
    step = np.arange(1, len(course.moved) + 1)
    for axes, values, limit, said in (
        (above, course.moved, course.goes, "may fail above"),
        (below, course.unbalanced, course.balanced, "equilibrium below"),
    ):
        axes.plot(step, np.where(values > 0.0, values, np.nan), color=BLUE, lw=1.3)
        axes.axhline(limit, color=RED, lw=1.0, ls="--", label=f"{said} {limit:.3g}")
        axes.set_yscale("log")
        axes.legend(
            fontsize=SMALL_SIZE,
            frameon=False,
            labelcolor=INK,
            loc="lower right",
            bbox_to_anchor=(1.0, 0.99),
        )
        canvas.label_logarithms(axes)
    above.tick_params(labelbottom=False)
    return save_axes(below, path)


def draw_frequency(section: FailureSection, label: str, path: Path) -> Path:
    """Draw the section, blocks darker the more often they fail; return the picture's path."""
    from matplotlib.collections import PolyCollection

    axes = _section(section.vertices.min(axis=0), section.vertices.max(axis=0))
    blocks = [section.vertices[a:b] for a, b in pairwise(section.block_start)]
    drawn = PolyCollection(blocks, edgecolors=FAINT, linewidths=0.4)
    drawn.set_array(section.share)
    axes.add_collection(drawn)
    return _coloured(axes, drawn, label, path)


def draw_failing(section: FailureSection, path: Path) -> Path:
    """Draw the section, blocks that fail (share above 0) in colour; return the picture's path."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    axes = _section(section.vertices.min(axis=0), section.vertices.max(axis=0), below=1.0)
    blocks = [section.vertices[a:b] for a, b in pairwise(section.block_start)]
    colours = [RED if share > 0.0 else STANDING for share in section.share]
    axes.add_collection(
        PolyCollection(blocks, facecolors=colours, edgecolors=FAINT, linewidths=0.4)
    )
    figure = cast("Figure", axes.get_figure(root=True))
    figure.legend(
        handles=[
            Patch(facecolor=RED, edgecolor=FAINT, label="fails"),
            Patch(facecolor=STANDING, edgecolor=FAINT, label="stands"),
        ],
        loc="upper right",
        ncols=2,
        fontsize=SMALL_SIZE,
        frameon=False,
        labelcolor=INK,
    )
    return canvas.save(figure, path)


def draw_places(places: FailurePlaces, label: str, path: Path) -> Path:
    """Draw the section, places darker the more often they fail; return the picture's path."""
    half = 0.5 * np.array([_spaced(places.x), _spaced(places.y)])
    low = np.array([places.x[0], places.y[0]]) - half
    high = np.array([places.x[-1], places.y[-1]]) + half
    axes = _section(low, high)
    for ring in places.outline:
        axes.plot(*ring.T, color=INK, lw=0.8)
    extent = (low[0], high[0], low[1], high[1])
    drawn = axes.imshow(places.share, origin="lower", extent=extent, aspect="auto", zorder=0)
    return _coloured(axes, drawn, label, path)


def _spaced(centres: Floats) -> float:
    """Return the distance between centres of cells (k,), m."""
    return float(centres[1] - centres[0]) if len(centres) > 1 else 1.0


def _section(low: Floats, high: Floats, below: float = 1.5) -> Axes:
    """Return axes of a section from ``low`` to ``high`` (2,), m.

    It has ``below`` inches of room beside its own, most of it for a scale below.
    """
    width, extent = 6.4, high - low
    box = (width - 1.0, max(1.2, min(6.0, (width - 1.0) * extent[1] / max(extent[0], 1e-9))))
    size = (width, box[1] + below)
    figure = canvas.new_figure(size, DOTS)
    axes = figure.add_axes(
        (0.7 / size[0], (below - 0.45) / size[1], box[0] / size[0], box[1] / size[1])
    )
    canvas.view(axes, *canvas.seen(low, high, box), box)
    return axes


def _coloured(axes: Axes, drawn: ScalarMappable, label: str, path: Path) -> Path:
    """Colour shares from none to the largest, with their scale; return the picture's path."""
    from matplotlib.colors import LinearSegmentedColormap

    shares = np.asarray(drawn.get_array())
    largest = float(np.max(shares, where=np.isfinite(shares), initial=0.0))
    drawn.set_cmap(LinearSegmentedColormap.from_list("fails", [STANDING, "#f0b08c", RED]))
    drawn.set_clim(0.0, max(1e-9, largest))
    figure = cast("Figure", axes.get_figure(root=True))
    size, place = figure.get_size_inches(), axes.get_position()
    bar = figure.add_axes((place.x0, 0.44 / size[1], place.width, 0.12 / size[1]))
    scale = figure.colorbar(drawn, cax=bar, orientation="horizontal")
    scale.set_label(label, fontsize=SMALL_SIZE, color=INK)
    bar.tick_params(labelsize=SMALL_SIZE, labelcolor=INK, color=FAINT)
    scale.outline.set_edgecolor(FAINT)
    return canvas.save(figure, path)


def new_axes(
    x_label: str,
    y_label: str,
    left: float = 0.14,
    height: float = 0.78,
    size: tuple[float, float] = SIZE,
) -> Axes:
    """Return empty axes of a figure of their own, its size in inches."""
    figure = canvas.new_figure(size, DOTS)
    axes = figure.add_axes((left, 0.56 / size[1], 0.96 - left, height))
    label_axes(axes, x_label, y_label)
    return axes


def label_axes(axes: Axes, x_label: str, y_label: str) -> None:
    """Label axes, with a grid, in the style of all figures."""
    axes.set_xlabel(canvas.literal(x_label), fontsize=TEXT_SIZE, color=INK)
    axes.set_ylabel(canvas.literal(y_label), fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e2e2e2", lw=0.5)
    canvas.style(axes)


def save_axes(axes: Axes, path: Path) -> Path:
    """Save the figure of axes; return its path."""
    canvas.label_logarithms(axes)
    return canvas.save(axes.get_figure(root=True), path)  # type: ignore[arg-type]


def _short(value: float) -> str:
    """Return a number with four digits, up to a million without an exponent."""
    return f"{float(f'{value:.4g}'):g}"


def behind_number(unit: str) -> str:
    """Return a unit as it stands behind a number: after a space, but for the sign of degrees."""
    return f" {unit}" if unit not in ("", "°") else unit


def short_label(label: str) -> str:
    """Return a name that fits beside a bar: its end, which tells it from others."""
    return label if len(label) <= LONGEST_LABEL else "…" + label[1 - LONGEST_LABEL :]
