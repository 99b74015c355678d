"""Figures of studies: spread, probability, influence, collapse, blocks that fail, back-analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from clast.model.model import Bools, Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, LEGEND, SMALL, SMALL_SIZE, TEXT, TEXT_SIZE
from clast.thumbnails import CURVE_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

RED, BLUE, GREEN = CURVE_COLOURS[:3]
STANDING = "#f4f4f2"
"""Colour of blocks that do not fail."""
BINS_MAX = 60
SIZE = (5.4, 3.5)
"""Width and height of a figure, inches."""
DOTS = 150
"""Dots per inch."""
NAME_LETTERS_MAX = 34
"""Letters of the name of a parameter."""
SERIES_NAMED_MAX = 12
"""Series that a legend names, and parameters whose correlations are written."""


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A bar of a tornado."""

    label: str
    """Name of the parameter."""
    low: float
    """Value of the measure where the parameter is least."""
    high: float
    """The same where it is largest."""
    ends: tuple[float, float]
    """Least and largest values of the parameter."""
    unit: str = ""
    """Unit of the parameter."""

    @property
    def caption(self) -> str:
        """Its name, and below it the values of the parameter."""
        ends = " to ".join(f"{float(f'{end:.4g}'):g}" for end in self.ends)
        return f"{end_of(self.label)}\n{ends}{behind_number(self.unit)}"


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
    if len(bins) > BINS_MAX + 1:
        bins = np.linspace(bins[0], bins[-1], BINS_MAX + 1)
    if is_wide(kept):
        bins = 10.0**bins
        axes.set_xscale("log")
    failed = fails[sound] > 0.0 if len(fails) else np.zeros(len(kept), bool)
    axes.hist(
        [kept[~failed], kept[failed]],
        bins=bins.tolist(),
        stacked=True,
        color=[BLUE, RED],
        label=["stand", "fail"],
        edgecolor="white",
        lw=0.5,
    )
    if failed.any():
        axes.legend(**LEGEND)
    return save_axes(axes, path)


def is_wide(values: Floats) -> bool:
    """Return whether values (k,) are better seen by their logarithms: over some decades."""
    # Ratio of largest to least value from which an axis is logarithmic
    return bool(len(values)) and 0.0 < 100.0 * float(values.min()) < float(values.max())


def draw_cumulative(
    x: Floats, share: Floats, half: Floats, confidence: float, label: str, path: Path
) -> Path:
    """Draw the ``share`` of runs up to each of the values x (k,); return the picture's path.

    ``half`` (k,) is half the width of the band that holds the whole curve with a ``confidence``;
    zeros: none is known.
    """
    axes = new_axes(label, "share of the runs up to it")
    axes.step(x, share, where="post", color=BLUE, lw=1.3)
    if half.any():
        low, high = np.clip(share - half, 0.0, 1.0), np.clip(share + half, 0.0, 1.0)
        label = f"{100 * confidence:g} %: the whole curve"
        axes.fill_between(x, low, high, step="post", color=BLUE, alpha=0.18, lw=0, label=label)
        axes.legend(**LEGEND)
    if is_wide(x):
        axes.set_xscale("log")
    axes.set_ylim(0.0, 1.02)
    return save_axes(axes, path)


def draw_tornado(bars: Sequence[Bar], middle: float, name: str, path: Path) -> Path:
    """Draw how far a measure goes with each parameter; return the picture's path."""
    size = (SIZE[0], max(SIZE[1], 1.3 + 0.4 * len(bars)))
    axes = new_axes(name, "", left=0.42, height=0.9 - 0.63 / size[1], size=size)
    for colour, end in ((BLUE, "least"), (RED, "largest")):
        axes.barh(0, 0.0, left=middle, color=colour, label=f"parameter {end}")
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
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=2, **LEGEND)
    return save_axes(axes, path)


def draw_factors(
    factors: Floats,
    displacements: Floats,
    verdicts: Sequence[str],
    bracket: tuple[float, float],
    name: str,
    path: Path,
) -> Path:
    """Draw the largest displacement, m, against the factor of k trials; return the path."""
    axes = new_axes(name, "largest displacement (m)")
    low, high = bracket
    if low > 0.0 and np.isfinite(high):
        axes.axvspan(low, high, color=RED, alpha=0.15, lw=0, label=f"{low:.5g} to {high:.5g}")
    positive = displacements[displacements > 0.0]
    shown = np.maximum(displacements, 0.5 * positive.min() if len(positive) else 0.5e-6)
    order = np.argsort(factors, kind="stable")
    axes.plot(factors[order], shown[order], color=FAINT, lw=0.8, zorder=1)
    looks = {"stands": (GREEN, "o"), "fails": (RED, "X"), "undecided": (INK, "D")}
    for verdict, (colour, mark) in looks.items():
        alike = np.array([one == verdict for one in verdicts])
        if alike.any():
            axes.plot(factors[alike], shown[alike], mark, color=colour, ms=5.5, label=verdict)
    axes.set_yscale("log")
    axes.legend(**LEGEND)
    return save_axes(axes, path)


def draw_course(
    displacement: Floats, unbalanced: Floats, limits: tuple[float, float], path: Path
) -> Path:
    """Draw displacement, m, and unbalanced force of the k steps of a trial; return the path.

    ``limits`` are the displacement from which blocks may fail, and the unbalanced force, as a share
    of the forces on a block, below which they are in equilibrium.
    """
    size = (SIZE[0], 1.5 * SIZE[1])
    below = new_axes("step", "unbalanced force / forces", height=0.37, size=size)
    figure = cast("Figure", below.get_figure(root=True))
    place = below.get_position()
    above = figure.add_axes((place.x0, place.y1 + 0.08, place.width, place.height), sharex=below)
    label_axes(above, "", "movement (m)")
    step = np.arange(1, len(displacement) + 1)
    for axes, values, limit, text in (
        (above, displacement, limits[0], "may fail above"),
        (below, unbalanced, limits[1], "equilibrium below"),
    ):
        axes.plot(step, np.where(values > 0.0, values, np.nan), color=BLUE, lw=1.3)
        axes.axhline(limit, color=RED, lw=1.0, ls="--", label=f"{text} {limit:.3g}")
        axes.set_yscale("log")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), **LEGEND)
        canvas.label_logarithms(axes)
    above.tick_params(labelbottom=False)
    return save_axes(below, path)


def draw_frequency(blocks: Sequence[Floats], share: Floats, label: str, path: Path) -> Path:
    """Draw n blocks, outlines (k, 2), m, darker the more often they fail; return the path."""
    axes, drawn = _section_of(blocks, 1.5)
    drawn.set_array(share)
    return _coloured(axes, drawn, label, path)


def draw_failing(blocks: Sequence[Floats], fails: Bools, path: Path) -> Path:
    """Draw n blocks, outlines (k, 2), m, those that fail (n,) in colour; return the path."""
    from matplotlib.patches import Patch

    axes, drawn = _section_of(blocks, 1.0)
    drawn.set_facecolor([RED if one else STANDING for one in fails])
    looks = {"fails": RED, "stands": STANDING}
    handles = [Patch(fc=colour, ec=FAINT, label=label) for label, colour in looks.items()]
    figure = cast("Figure", axes.get_figure(root=True))
    figure.legend(handles=handles, loc="upper right", ncols=2, **LEGEND)
    return canvas.save(figure, path)


def _section_of(blocks: Sequence[Floats], below: float) -> tuple[Axes, PolyCollection]:
    """Return axes of the section of blocks, with ``below`` inches beside them, and the blocks."""
    from matplotlib.collections import PolyCollection

    every = np.concatenate(blocks)
    axes = _section(every.min(axis=0), every.max(axis=0), below)
    drawn = PolyCollection(list(blocks), edgecolors=FAINT, linewidths=0.4)
    axes.add_collection(drawn)
    return axes, drawn


def draw_places(places: FailurePlaces, label: str, path: Path) -> Path:
    """Draw the section, places darker the more often they fail; return the picture's path."""
    centres = places.x, places.y
    half = [0.5 * float(one[1] - one[0]) if len(one) > 1 else 0.5 for one in centres]
    low = np.array([one[0] for one in centres]) - half
    high = np.array([one[-1] for one in centres]) + half
    axes = _section(low, high, 1.5)
    for ring in places.outline:
        axes.plot(*ring.T, color=INK, lw=0.8)
    extent = (low[0], high[0], low[1], high[1])
    drawn = axes.imshow(places.share, origin="lower", extent=extent, aspect="auto", zorder=0)
    return _coloured(axes, drawn, label, path)


def _section(low: Floats, high: Floats, below: float) -> Axes:
    """Return axes of a section from ``low`` to ``high`` (2,), m, with room for a scale below."""
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
    place = axes.get_position()
    draw_scale(figure, drawn, place.x0, place.width, 0.44, label)
    return canvas.save(figure, path)


def draw_scale(
    figure: Figure, drawn: ScalarMappable, left: float, width: float, up: float, label: str
) -> None:
    """Draw the scale of colours, ``up`` inches from below; ``left``, ``width``: of the figure's."""
    height = figure.get_size_inches()[1]
    bar = figure.add_axes((left, up / height, width, 0.12 / height))
    scale = figure.colorbar(drawn, cax=bar, orientation="horizontal")
    scale.set_label(label, **SMALL)
    bar.tick_params(which="both", labelsize=SMALL_SIZE, labelcolor=INK, color=FAINT)
    cast("Any", scale).outline.set_edgecolor(FAINT)


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
    axes.set_xlabel(canvas.literal(x_label), **TEXT)
    axes.set_ylabel(canvas.literal(y_label), **TEXT)
    axes.grid(color="#e2e2e2", lw=0.5)
    canvas.style(axes)


def save_axes(axes: Axes, path: Path) -> Path:
    """Save the figure of axes; return its path."""
    canvas.label_logarithms(axes)
    return canvas.save(axes.get_figure(root=True), path)  # type: ignore[arg-type]


def behind_number(unit: str) -> str:
    """Return a unit as it stands behind a number: after a space, but for the sign of degrees."""
    return f" {unit}" if unit not in ("", "°") else unit


def end_of(name: str, letters: int = NAME_LETTERS_MAX) -> str:
    """Return a name or its end, which tells it from others, in so many letters."""
    return name if len(name) <= letters else "…" + name[1 - letters :]


@dataclass(frozen=True, kw_only=True)
class Match:
    """Measured and computed values; k of them."""

    label: Sequence[str]
    """Point and component of each."""
    time: Floats
    """When each was measured, s, shape (k,); NaN: at the end of the run."""
    observed: Floats
    """Measured, m, shape (k,)."""
    predicted: Floats
    """Computed, m, shape (k,)."""
    deviation: Floats | None
    """Standard deviations, m, shape (k,); None where they are not known."""

    @property
    def series(self) -> list[tuple[str, str, np.ndarray]]:
        """Label, colour and members (k,) of each series."""
        names = list(dict.fromkeys(self.label))
        labels = np.array(self.label)
        return [
            (name, CURVE_COLOURS[k % len(CURVE_COLOURS)], labels == name)
            for k, name in enumerate(names)
        ]


def draw_match(match: Match, path: Path) -> Path:
    """Draw computed against measured values, with bars of two deviations; return the path."""
    axes = new_axes("measured (mm)", "computed (mm)")
    both = 1e3 * np.concatenate([match.observed, match.predicted])
    ends = [float(both.min()), float(both.max())]
    axes.plot(ends, ends, color=FAINT, lw=0.8, zorder=1)
    for name, colour, alike in match.series:
        bars = None if match.deviation is None else 2e3 * match.deviation[alike]
        x, y = 1e3 * match.observed[alike], 1e3 * match.predicted[alike]
        label = canvas.literal(end_of(name))
        axes.errorbar(x, y, xerr=bars, fmt="o", ms=4, lw=0.8, color=colour, label=label)
    _legend(axes, match)
    return save_axes(axes, path)


def draw_differences(match: Match, path: Path) -> Path:
    """Draw computed less measured values over time, or by number; return the path."""
    is_timed = bool(np.isfinite(match.time).all())
    x = match.time if is_timed else np.arange(1.0, len(match.time) + 1.0)
    left = match.predicted - match.observed
    scaled = 1e3 * left if match.deviation is None else left / match.deviation
    label = "computed less measured " + ("(mm)" if match.deviation is None else "(sd)")
    axes = new_axes("time (s)" if is_timed else "observation", label)
    axes.axhline(0.0, color=INK, lw=0.8)
    if match.deviation is not None:
        axes.axhspan(-2.0, 2.0, color=FAINT, alpha=0.15, lw=0)
    for name, colour, alike in match.series:
        label = canvas.literal(end_of(name))
        axes.plot(x[alike], scaled[alike], "o-", color=colour, ms=4, lw=0.8, label=label)
    _legend(axes, match)
    return save_axes(axes, path)


def draw_correlation(names: Sequence[str], correlation: Floats, path: Path) -> Path:
    """Draw correlations (m, m) of the errors of parameters, 1 red, -1 blue; return the path."""
    axes = new_axes("", "", left=0.42)
    axes.grid(visible=False)
    axes.imshow(correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    labels = [canvas.literal(end_of(one)) for one in names]
    axes.set_xticks(range(len(names)), [str(k + 1) for k in range(len(names))])
    axes.set_yticks(range(len(names)), [f"{one}  {k}" for k, one in enumerate(labels, 1)])
    if len(names) <= SERIES_NAMED_MAX:
        for (row, column), value in np.ndenumerate(correlation):
            colour = "white" if abs(value) > 0.6 else INK
            place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": SMALL_SIZE}
            axes.text(column, row, f"{value:.2f}", color=colour, **place)
    axes.tick_params(labelsize=TEXT_SIZE - 1)
    return save_axes(axes, path)


def _legend(axes: Axes, match: Match) -> None:
    if 1 < len(match.series) <= SERIES_NAMED_MAX:
        axes.legend(**LEGEND)
