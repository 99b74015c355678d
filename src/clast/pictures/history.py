"""How a measured point moved, as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import INK, SMALL_SIZE, TEXT_SIZE
from clast.pictures.fields import prefixed
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from clast.results import BoltHistory


def plot_history(results: Recording, path: Path | str, point: str) -> Path:
    """Draw displacement and velocity of a measured point against time; return the path."""
    history = results.history(point)
    figure, upper, lower = _two_axes(results, f"Measured point {canvas.literal(point)}")
    _curves(upper, history.time, history.displacement, "Displacement", "m")
    _curves(lower, history.time, history.velocity, "Velocity", "m/s")
    upper.legend(loc="best", frameon=False, fontsize=SMALL_SIZE, labelcolor=INK)
    return canvas.save(figure, Path(path))


def plot_bolt_history(results: Recording, path: Path | str, bolt: str) -> Path:
    """Draw force and elongation of a rock bolt against time; return the path.

    Where it yielded or broke is marked.  Raises CaseError for a bolt that does not exist.
    """
    history = results.bolt_history(bolt)
    figure, upper, lower = _two_axes(results, f"Bolt {canvas.literal(bolt)}")
    _curve(upper, history, history.force, "Force", "N/m")
    _curve(lower, history, history.elongation, "Elongation", "m")
    if upper.get_legend_handles_labels()[1]:
        upper.legend(loc="best", frameon=False, fontsize=SMALL_SIZE, labelcolor=INK)
    return canvas.save(figure, Path(path))


def _two_axes(results: Recording, below: str) -> tuple[Figure, Axes, Axes]:
    """Return a figure with a title, and its upper and lower axes over the same time."""
    title = canvas.wrapped(results.title or results.name, 6.0, canvas.TITLE_SIZE)
    up, between = 1.95, 0.25
    bottom = canvas.BELOW
    size = (6.4, bottom + 2 * up + between + 0.3 + canvas.LINE * (len(title) + 1))
    figure = canvas.new_figure(size, 160)
    canvas.head(figure, 0.8, title, below)
    lower, upper = (
        figure.add_axes((0.8 / size[0], height / size[1], 5.35 / size[0], up / size[1]))
        for height in (bottom, bottom + up + between)
    )
    upper.tick_params(labelbottom=False)
    lower.set_xlabel("Time (s)", fontsize=TEXT_SIZE, color=INK)
    return figure, upper, lower


CURVES = {"in x": ("#1f6f8b", "-"), "in y": ("#c1440e", "--")}
"""Colour and line of each component."""


MARKED = {2: ("yielded", "#8e24aa"), 3: ("broke", "#c0143c")}
"""State of a bolt -> its text in the history, and its colour."""


def _curve(axes: Axes, history: BoltHistory, values: Floats, quantity: str, unit: str) -> None:
    """Draw a quantity of a bolt against time, and when it yielded or broke."""
    factor, unit = prefixed(float(np.abs(values).max()), unit)
    axes.plot(history.time, factor * values, color="#1b4f9c", lw=1.3)
    for state, (what, colour) in MARKED.items():
        for at in history.time[history.state == state][:1]:
            axes.axvline(at, color=colour, ls="--", lw=1.0, label=f"{what} at {at:.4g} s")
    axes.set_ylabel(f"{quantity} ({unit})", fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e4e4e4", lw=0.6)
    axes.margins(x=0.01)
    canvas.style(axes)


def _curves(axes: Axes, time: Floats, values: NDArray[Any], quantity: str, unit: str) -> None:
    """Draw the two components of a vector against time."""
    factor, unit = prefixed(float(np.abs(values).max()), unit)
    for (name, (colour, line)), component in zip(CURVES.items(), values.T, strict=True):
        axes.plot(time, factor * component, line, color=colour, lw=1.3, label=name)
    axes.set_ylabel(f"{quantity} ({unit})", fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e4e4e4", lw=0.6)
    axes.margins(x=0.01)
    canvas.style(axes)
