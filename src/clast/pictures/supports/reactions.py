"""Reactions on a picture: arrows that push where supports push the blocks, with their forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import SMALL_SIZE
from clast.pictures.fields import prefixed
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOUR = "#7a3b00"
LONGEST, SHORTEST = 0.16, 0.05
"""Lengths of the arrows of the largest force and of small ones, in units of the picture's width."""
LEAST = 1e-6
"""Force, in units of the largest, that is not drawn."""


def draw_reactions(axes: Axes, results: Recording, frame: int) -> None:
    """Draw the reactions of the step before a frame, each with its name and size."""
    found = forces_in(results, frame)
    sizes = np.array([np.hypot(*force) for _, _, force in found])
    largest = float(sizes.max(initial=0.0))
    if largest == 0.0:
        return
    wide = float(np.ptp(axes.get_xlim()))
    for (name, at, force), size in zip(found, sizes, strict=True):
        if not size > LEAST * largest:
            continue
        length = wide * max(SHORTEST, LONGEST * size / largest)
        tail = at - length * force / size
        axes.annotate(
            "",
            (float(at[0]), float(at[1])),
            xytext=(float(tail[0]), float(tail[1])),
            arrowprops={
                "arrowstyle": "-|>",
                "color": COLOUR,
                "lw": 1.8,
                "shrinkA": 0,
                "shrinkB": 0,
            },
            zorder=8,
        )
        factor, unit = prefixed(size, "N/m")
        axes.annotate(
            canvas.literal(f"{name}: {factor * size:.3g} {unit}"),
            (float(tail[0]), float(tail[1])),
            xytext=(4, -9 if force[1] > 0.0 else 4),
            textcoords="offset points",
            fontsize=SMALL_SIZE,
            color=COLOUR,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8},
            zorder=9,
        )


def forces_in(results: Recording, frame: int) -> list[tuple[str, Floats, Floats]]:
    """Return name, point of application (2,), m, and force (2,), N/m, of reactions in a frame.

    Of those that are one and the same, a total and its only part, the last.
    """
    found: dict[tuple[float, ...], tuple[str, Floats, Floats]] = {}
    for name in results.reaction_name:
        rows = results.reaction(name)
        row = int(np.abs(rows.time - results.times[frame]).argmin())
        if np.isfinite(rows.position[row]).all():
            at, force = rows.position[row], rows.force[row]
            found[tuple(np.round([*at, *force], 6).tolist())] = (name, at, force)
    return list(found.values())
