"""Marks beside a drawing: a bar of a round length, and an arrow the way gravity pulls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clast.pictures import canvas
from clast.pictures.canvas import INK, SMALL_SIZE, Part, Sheet
from clast.pictures.fields import prefixed, round_below
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

BAR = 0.2
"""Length of the scale bar at most, as a share of the width of the axes."""


def draw_scale_bar(figure: Figure, sheet: Sheet, seen: Part, up: float = 0.2) -> None:
    """Draw a bar of a round length at a height, inches, with the length beside it."""
    from matplotlib.lines import Line2D

    per_inch = float(seen[1][0] - seen[0][0]) / sheet.axes[2]
    length = round_below(BAR * sheet.axes[2] * per_inch)
    factor, unit = prefixed(length, "m")
    width, height = sheet.size
    left, right = sheet.axes[0], sheet.axes[0] + length / per_inch
    for x, y in (
        ((left, right), (up, up)),
        ((left, left), (up - 0.04, up + 0.04)),
        ((right, right), (up - 0.04, up + 0.04)),
    ):
        place = np.array(x) / width, np.array(y) / height
        figure.add_artist(Line2D(*place, color=canvas.INK, lw=1.2, solid_capstyle="butt"))
    figure.text(
        (right + 0.08) / width,
        up / height,
        f"{factor * length:g} {unit}",
        fontsize=canvas.SMALL_SIZE,
        color=canvas.INK,
        va="center",
    )


def draw_gravity(figure: Figure, sheet: Sheet, results: Recording) -> None:
    """Draw an arrow the way gravity pulls, in the upper right corner, beside the title."""
    size = float(np.hypot(*results.gravity))
    if size == 0.0:
        return
    width, height = sheet.size
    along = 0.13 * results.gravity / size
    middle = np.array([width - 0.22, height - 0.2])
    figure.add_artist(_arrow((middle - along) / sheet.size, (middle + along) / sheet.size))
    figure.text(
        (middle[0] - 0.12) / width,
        middle[1] / height,
        "g",
        fontsize=SMALL_SIZE,
        color=INK,
        ha="right",
        va="center",
        style="italic",
    )


def _arrow(tail: np.ndarray, head: np.ndarray) -> Artist:
    from matplotlib.patches import FancyArrowPatch

    return FancyArrowPatch(
        tuple(tail), tuple(head), arrowstyle="-|>", mutation_scale=7, color=INK, lw=1.0
    )
