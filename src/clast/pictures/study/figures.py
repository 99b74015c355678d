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


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A bar of a tornado."""

    label: str
    """Parameter."""
    low: float
    """Value where the parameter is least."""
    high: float
    """Value where it is largest."""


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


def draw_histogram(values: Floats, label: str, path: Path) -> Path:
    """Draw how often values (k,) occur; return the picture's path."""
    axes = new_axes(label, "runs")
    kept = values[np.isfinite(values)]
    bins = np.histogram_bin_edges(kept, bins="auto") if len(kept) else np.array([0.0, 1.0])
    if len(bins) > 61:
        bins = np.linspace(bins[0], bins[-1], 61)
    axes.hist(kept, bins=bins.tolist(), color=BLUE, edgecolor="white", lw=0.5)
    return save_axes(axes, path)


def draw_cumulative(band: Band, label: str, path: Path) -> Path:
    """Draw the share of runs up to a value, with its band; return the picture's path."""
    axes = new_axes(label, "share of the runs up to it")
    axes.step(band.x, band.share, where="post", color=BLUE, lw=1.3)
    if band.half.any():
        low = np.clip(band.share - band.half, 0.0, 1.0)
        high = np.clip(band.share + band.half, 0.0, 1.0)
        axes.fill_between(band.x, low, high, step="post", color=BLUE, alpha=0.18, lw=0)
    axes.set_ylim(0.0, 1.02)
    return save_axes(axes, path)


def draw_tornado(bars: Sequence[Bar], middle: float, name: str, path: Path) -> Path:
    """Draw how far a measure goes with each parameter; return the picture's path."""
    axes = new_axes(name, "", left=0.42, height=0.72)
    for row, bar in enumerate(reversed(bars)):
        for value, colour, said in ((bar.low, BLUE, "least"), (bar.high, RED, "largest")):
            label = f"parameter {said}" if row == 0 else None
            axes.barh(row, value - middle, left=middle, height=0.6, color=colour, label=label)
    labels = [short_label(bar.label) for bar in reversed(bars)]
    axes.set_yticks(range(len(bars)), [canvas.literal(one) for one in labels])
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
        axes.axvspan(low, high, color=RED, alpha=0.15, lw=0)
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


def draw_frequency(section: FailureSection, label: str, path: Path) -> Path:
    """Draw the section, blocks darker the more often they fail; return the picture's path."""
    from matplotlib.collections import PolyCollection

    axes = _section(section.vertices.min(axis=0), section.vertices.max(axis=0))
    blocks = [section.vertices[a:b] for a, b in pairwise(section.block_start)]
    drawn = PolyCollection(blocks, edgecolors=FAINT, linewidths=0.4)
    drawn.set_array(section.share)
    axes.add_collection(drawn)
    return _coloured(axes, drawn, label, path)


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


def _section(low: Floats, high: Floats) -> Axes:
    """Return axes of a section from ``low`` to ``high`` (2,), m, with room for a scale below."""
    width, extent = 6.4, high - low
    box = (width - 1.0, max(1.2, min(6.0, (width - 1.0) * extent[1] / max(extent[0], 1e-9))))
    size = (width, box[1] + 1.5)
    figure = canvas.new_figure(size, DOTS)
    axes = figure.add_axes((0.7 / size[0], 1.05 / size[1], box[0] / size[0], box[1] / size[1]))
    canvas.view(axes, *canvas.seen(low, high, box), box)
    return axes


def _coloured(axes: Axes, drawn: ScalarMappable, label: str, path: Path) -> Path:
    """Colour shares from none to the largest, with their scale; return the picture's path."""
    from matplotlib.colors import LinearSegmentedColormap

    shares = np.asarray(drawn.get_array())
    largest = float(np.max(shares, where=np.isfinite(shares), initial=0.0))
    drawn.set_cmap(LinearSegmentedColormap.from_list("fails", ["#f4f4f2", "#f0b08c", RED]))
    drawn.set_clim(0.0, max(1e-9, largest))
    figure = cast("Figure", axes.get_figure(root=True))
    size, place = figure.get_size_inches(), axes.get_position()
    bar = figure.add_axes((place.x0, 0.44 / size[1], place.width, 0.12 / size[1]))
    scale = figure.colorbar(drawn, cax=bar, orientation="horizontal")
    scale.set_label(label, fontsize=SMALL_SIZE, color=INK)
    bar.tick_params(labelsize=SMALL_SIZE, labelcolor=INK)
    return canvas.save(figure, path)


def new_axes(x_label: str, y_label: str, left: float = 0.14, height: float = 0.78) -> Axes:
    """Return empty axes of a figure of their own."""
    figure = canvas.new_figure(SIZE, DOTS)
    axes = figure.add_axes((left, 0.16, 0.96 - left, height))
    axes.set_xlabel(canvas.literal(x_label), fontsize=TEXT_SIZE, color=INK)
    axes.set_ylabel(canvas.literal(y_label), fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e2e2e2", lw=0.5)
    canvas.style(axes)
    return axes


def save_axes(axes: Axes, path: Path) -> Path:
    """Save the figure of axes; return its path."""
    return canvas.save(axes.get_figure(root=True), path)  # type: ignore[arg-type]


def short_label(label: str) -> str:
    """Return a name that fits beside a bar: its end, which tells it from others."""
    return label if len(label) <= LONGEST_LABEL else "…" + label[1 - LONGEST_LABEL :]
