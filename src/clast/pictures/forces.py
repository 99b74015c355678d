"""Contact forces on a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clast.pictures.blocks import outlines_of
from clast.pictures.canvas import INK, SMALL_SIZE, Sheet
from clast.pictures.fields import prefixed, round_below
from clast.results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_ARROWS = 1500
"""Contacts drawn at most: those with the largest forces."""
ARROW = "#111111"


def draw_contacts(figure: Figure, sheet: Sheet, axes: Axes, results: Results, frame: int) -> None:
    """Draw the largest contact forces, a pair of arrows each: on one block and on the other."""
    contacts = results.contacts(frame)
    force = contacts.force
    size = np.hypot(*force.T)
    drawn = np.argsort(-size, kind="stable")[:MOST_ARROWS]
    if len(drawn) == 0 or size[drawn[0]] == 0.0:
        return
    largest, longest = float(size[drawn[0]]), _arrow_length(results, axes)
    inches = longest * sheet.axes[2] / float(np.ptp(axes.get_xlim()))
    position, force = contacts.position[drawn], force[drawn]
    arrows = axes.quiver(
        *np.concatenate([position, position]).T,
        *np.concatenate([force, -force]).T,
        color=ARROW,
        edgecolor="white",
        linewidth=0.3 if inches > 0.2 else 0.0,
        angles="xy",
        scale_units="xy",
        scale=largest / longest,
        units="inches",
        width=float(np.clip(0.08 * inches, 0.005, 0.022)),
        minlength=0.0,
        zorder=5,
    )
    shown = round_below(largest)
    factor, unit = prefixed(shown, "N/m")
    text = f"contact force, {shown * factor:g} {unit}"
    if len(drawn) < len(contacts):
        text += f" (largest {len(drawn):,} of {len(contacts):,})"
    width, height = sheet.size
    axes.quiverkey(
        arrows,
        (sheet.axes[0] + inches * shown / largest) / width,
        0.2 / height,
        shown,
        text,
        coordinates="figure",
        labelpos="E",
        labelsep=0.15,
        fontproperties={"size": SMALL_SIZE},
        labelcolor=INK,
    )


def _arrow_length(results: Results, axes: Axes) -> float:
    """Return the length of the longest arrow, m: about a block, but seen in the picture."""
    shown = float(np.hypot(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())))
    outlines = outlines_of(results, results.vertices(0))
    block = float(np.median([np.ptp(outline, axis=0).min() for outline in outlines]))
    return float(np.clip(0.9 * block, 0.012 * shown, 0.09 * shown))
