"""Figures of a back-analysis: computed against measured values, differences, correlation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT_SIZE
from clast.pictures.study.figures import BLUE, GREEN, RED, new_axes, save_axes, short_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = (BLUE, RED, GREEN, "#7a4f9a", "#b8860b", "#4a4a4a")
MOST_NAMED = 12
"""Most series that a legend names."""


@dataclass(frozen=True, kw_only=True)
class Match:
    """Measured and computed values; k of them."""

    label: Sequence[str]
    """Point and part of each."""
    time: Floats
    """When each was measured, s, shape (k,); NaN: at the end of the run."""
    observed: Floats
    """Measured, m, shape (k,)."""
    predicted: Floats
    """Computed, m, shape (k,)."""
    deviation: Floats | None
    """Standard deviations, m, shape (k,); None where they are not known."""

    def series(self) -> list[tuple[str, str, np.ndarray]]:
        """Return label, colour and members (k,) of each series."""
        names = list(dict.fromkeys(self.label))
        own = np.array(self.label)
        return [(name, COLOURS[k % len(COLOURS)], own == name) for k, name in enumerate(names)]


def draw_match(match: Match, path: Path) -> Path:
    """Draw computed against measured values, with bars of two deviations; return the path."""
    axes = new_axes("measured (mm)", "computed (mm)")
    both = 1e3 * np.concatenate([match.observed, match.predicted])
    ends = [float(both.min()), float(both.max())]
    axes.plot(ends, ends, color=FAINT, lw=0.8, zorder=1)
    for name, colour, own in match.series():
        bars = None if match.deviation is None else 2e3 * match.deviation[own]
        axes.errorbar(
            1e3 * match.observed[own],
            1e3 * match.predicted[own],
            xerr=bars,
            fmt="o",
            ms=4,
            lw=0.8,
            color=colour,
            label=canvas.literal(short_label(name)),
        )
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
    for name, colour, own in match.series():
        label = canvas.literal(short_label(name))
        axes.plot(x[own], scaled[own], "o-", color=colour, ms=4, lw=0.8, label=label)
    _legend(axes, match)
    return save_axes(axes, path)


def draw_correlation(names: Sequence[str], correlation: Floats, path: Path) -> Path:
    """Draw correlations (m, m) of the errors of parameters, 1 red, -1 blue; return the path."""
    axes = new_axes("", "", left=0.42)
    axes.grid(visible=False)
    axes.imshow(correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    labels = [canvas.literal(short_label(one)) for one in names]
    axes.set_yticks(range(len(names)), labels)
    axes.set_xticks(range(len(names)), [str(k + 1) for k in range(len(names))])
    axes.set_yticks(range(len(names)), [f"{one}  {k}" for k, one in enumerate(labels, 1)])
    if len(names) <= MOST_NAMED:
        for (row, column), value in np.ndenumerate(correlation):
            colour = "white" if abs(value) > 0.6 else INK
            axes.text(
                column,
                row,
                f"{value:.2f}",
                ha="center",
                va="center",
                color=colour,
                fontsize=SMALL_SIZE,
            )
    axes.tick_params(labelsize=TEXT_SIZE - 1)
    return save_axes(axes, path)


def _legend(axes: Axes, match: Match) -> None:
    """Name the series where there are a few."""
    if 1 < len(match.series()) <= MOST_NAMED:
        axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
