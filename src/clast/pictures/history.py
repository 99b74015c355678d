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


def plot_history(results: Recording, path: Path | str, point: str) -> Path:
    """Draw displacement and velocity of a measured point against time; return the path."""
    history = results.history(point)
    title = canvas.wrapped(results.title or results.name, 6.0, canvas.TITLE_SIZE)
    up, between = 1.95, 0.25
    bottom = canvas.BELOW
    size = (6.4, bottom + 2 * up + between + 0.3 + canvas.LINE * (len(title) + 1))
    figure = canvas.new_figure(size, 160)
    canvas.head(figure, 0.8, title, f"Measured point {canvas.literal(point)}")
    lower, upper = (
        figure.add_axes((0.8 / size[0], height / size[1], 5.35 / size[0], up / size[1]))
        for height in (bottom, bottom + up + between)
    )
    _curves(upper, history.time, history.displacement, "Displacement", "m")
    _curves(lower, history.time, history.velocity, "Velocity", "m/s")
    upper.tick_params(labelbottom=False)
    lower.set_xlabel("Time (s)", fontsize=TEXT_SIZE, color=INK)
    upper.legend(loc="best", frameon=False, fontsize=SMALL_SIZE, labelcolor=INK)
    return canvas.save(figure, Path(path))


CURVES = {"in x": ("#1f6f8b", "-"), "in y": ("#c1440e", "--")}
"""Colour and line of each component."""


def _curves(axes: Axes, time: Floats, values: NDArray[Any], quantity: str, unit: str) -> None:
    """Draw the two components of a vector against time."""
    factor, unit = prefixed(float(np.abs(values).max()), unit)
    for (name, (colour, line)), component in zip(CURVES.items(), values.T, strict=True):
        axes.plot(time, factor * component, line, color=colour, lw=1.3, label=name)
    axes.set_ylabel(f"{quantity} ({unit})", fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e4e4e4", lw=0.6)
    axes.margins(x=0.01)
    canvas.style(axes)
