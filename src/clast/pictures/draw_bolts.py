"""Rock bolts on a picture: lines as wide as their force is large, coloured by their state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.fields import prefixed
from clast.results import FrameBolts

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS: tuple[tuple[str, str, Any], ...] = (
    ("bolt, not installed", "#8a8a8a", (0, (1, 1.5))),
    ("bolt", "#0b6b50", "-"),
    ("bolt, yielded", "#8e24aa", "-"),
    ("bolt, broken", "#c0143c", (0, (3, 1.5))),
)
"""Label, colour and line of a bolt by its state; those that are lost are not drawn."""
BROKEN = 3
THIN, THICK = 1.3, 3.6
"""Widths of a bolt without a force, and with the largest, points."""
CASING = 1.8
"""Width of the white line around it, points."""


def handles_of(bolts: FrameBolts) -> list[Any]:
    """Return the legend of the bolts: states, and the largest force."""
    from matplotlib.lines import Line2D

    found = []
    for state, (name, colour, line) in enumerate(LOOKS):
        own = bolts.state == state
        if not own.any():
            continue
        largest = float(np.abs(bolts.force[own]).max())
        label = name
        if largest > 0.0:
            factor, unit = prefixed(largest, "N/m")
            label = f"{name}, up to {factor * largest:.3g} {unit}"
        mark = "x" if state == BROKEN else ""
        width = _width(largest, bolts.force)
        found.append(
            Line2D([], [], color=colour, ls=line, lw=width, marker=mark, ms=4.5, label=label)
        )
    return found


def draw_bolts(axes: Axes, bolts: FrameBolts) -> None:
    """Draw the bolts of a frame, heads as dots, broken ones crossed out in their middle."""
    for k in np.flatnonzero(bolts.state < len(LOOKS)):
        points = bolts.points[bolts.bolt == k]
        state = int(bolts.state[k])
        _, colour, line = LOOKS[state]
        width = _width(float(bolts.force[k]), bolts.force)
        axes.plot(*points.T, "-", color="white", lw=width + CASING, zorder=5.2)
        axes.plot(*points.T, ls=line, color=colour, lw=width, zorder=5.3)
        axes.plot(*points[0], "o", color=colour, ms=width + 1.6, mec="white", mew=0.4, zorder=5.4)
        if state == BROKEN:
            middle = 0.5 * (points[0] + points[-1])
            axes.plot(*middle, "x", color=colour, ms=5.0, mew=1.4, zorder=5.4)


def _width(force: float, forces: Floats) -> float:
    """Return the width of a bolt with a force, among all forces, points."""
    largest = float(np.abs(forces).max())
    share = abs(force) / largest if largest > 0.0 else 0.0
    return THIN + (THICK - THIN) * share
