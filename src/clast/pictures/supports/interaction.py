"""N and M of a lining beside the interaction curve of its section.

Moments lie along the abscissa and normal forces upwards, compression at the top: so engineers of
concrete draw it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clast.actions.linings import InteractionCurve, interaction_curve
from clast.errors import CaseError
from clast.model.model import Bools, Floats
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT_SIZE
from clast.pictures.fields import prefixed
from clast.results import Recording
from clast.results.result_tables import LiningHistory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CURVE, CRACKS, POINTS, CLOUD = "#262626", "#c1440e", "#1b4f9c", "#9ab3d6"
"""Colours of the curve, of the limit of cracks, of the points of the frame and of the others."""
SIZE = 4.6, 4.2
"""Width and height of the axes, inches."""
LEGEND_LINES = 3
"""Lines of the legend."""
MOST_POINTS = 20_000
"""Points of other instants that are drawn at most."""


def plot_interaction(results: Recording, path: Path | str, lining: str, *, frame: int = -1) -> Path:
    """Draw N and M of a lining with the interaction curve of its section; return the path.

    The joints in a ``frame`` are filled dots, those at all other instants lie pale behind them.
    The format follows from the ending of ``path``.  Raises CaseError for a lining that does not
    exist, has no strengths or is not there yet.
    """
    history = results.lining(lining)
    number = results.frame(frame).number
    curve = _curve_of(history, lining)
    row = int(results.rows_at(history.time, number))
    there = (history.state > 0) & (history.state < 4)
    if not there[row].any():
        raise CaseError(
            f"lining '{lining}' does not exist at {results.times[number]:.4g} s",
            where="interaction",
            remedy="ask for a later frame or stage",
        )
    title = canvas.wrapped(results.title or results.name, SIZE[0], canvas.TITLE_SIZE)
    below = canvas.BELOW + 0.12 + canvas.LINE * LEGEND_LINES
    size = (
        canvas.LEFT + SIZE[0] + canvas.RIGHT,
        below + SIZE[1] + 0.32 + canvas.LINE * (len(title) + 1),
    )
    figure = canvas.new_figure(size, 160)
    stage = results.frame(frame).stage
    text = f"Lining {canvas.literal(lining)} at $t$ = {results.times[number]:.4g} s"
    if stage:
        text += f", stage {canvas.literal(stage)}"
    canvas.head(figure, canvas.LEFT, title, text)
    axes = figure.add_axes(
        (canvas.LEFT / size[0], below / size[1], SIZE[0] / size[0], SIZE[1] / size[1])
    )
    _draw(axes, history, curve, there, row)
    figure.legend(
        loc="lower left",
        bbox_to_anchor=(canvas.LEFT / size[0], 0.1 / size[1]),
        ncols=2,
        frameon=False,
        fontsize=SMALL_SIZE,
        labelcolor=INK,
        borderpad=0.0,
        borderaxespad=0.0,
    )
    return canvas.save(figure, Path(path))


def _curve_of(history: LiningHistory, lining: str) -> InteractionCurve:
    """Return the interaction curve of a lining, or raise CaseError where it has none."""
    if not len(history.section):
        raise CaseError(
            "these results are from an older version and have no sections of linings",
            where=f"lining '{lining}'",
            remedy="run the case again",
        )
    thickness, tension, compression = history.section[0]
    if not np.isfinite(compression):
        raise CaseError(
            "has no strengths, and so no interaction curve",
            where=f"lining '{lining}'",
            remedy="give tension and compression in the case, and run it again",
        )
    return interaction_curve(float(thickness), float(tension), float(compression))


def _draw(
    axes: Axes, history: LiningHistory, curve: InteractionCurve, there: Bools, row: int
) -> None:
    """Draw the curve, the limit of cracks, and N and M of all instants and of one ``row``."""
    of_force, newton = prefixed(float(np.abs(curve.normal).max()), "N/m")
    of_moment, metre = prefixed(curve.largest, "N m/m")
    sides = np.concatenate([curve.moment, -curve.moment[::-1]])
    around = np.concatenate([curve.normal, curve.normal[::-1]])
    axes.plot(of_moment * sides, of_force * around, color=CURVE, lw=1.3, label="strength")
    cracked = _cracks(history.section[0])
    axes.plot(
        of_moment * cracked[:, 0],
        of_force * cracked[:, 1],
        color=CRACKS,
        lw=1.0,
        ls="--",
        label="a face cracks",
    )
    _draw_states(axes, history, there, row, (of_force, of_moment))
    axes.axhline(0.0, color=FAINT, lw=0.6)
    axes.axvline(0.0, color=FAINT, lw=0.6)
    axes.invert_yaxis()
    axes.set_xlabel(f"M ({metre}), positive: stretched inside", fontsize=TEXT_SIZE, color=INK)
    axes.set_ylabel(f"N ({newton}), compression upwards", fontsize=TEXT_SIZE, color=INK)
    axes.grid(color="#e4e4e4", lw=0.6)
    canvas.style(axes)


def _draw_states(
    axes: Axes, history: LiningHistory, there: Bools, row: int, scale: tuple[float, float]
) -> None:
    """Draw N and M of all instants, those of one ``row`` above, and the largest utilisation.

    ``scale`` has the units of N and M in the picture.
    """
    of_force, of_moment = scale
    normal, moment = history.normal_force, history.moment
    every = np.flatnonzero(there.ravel())
    every = every[:: max(1, -(-len(every) // MOST_POINTS))]
    axes.plot(
        of_moment * moment.ravel()[every],
        of_force * normal.ravel()[every],
        ".",
        color=CLOUD,
        ms=2.5,
        label="at all times",
        zorder=2.5,
    )
    now = there[row]
    axes.plot(
        of_moment * moment[row, now],
        of_force * normal[row, now],
        "o",
        color=POINTS,
        ms=4.0,
        mec="white",
        mew=0.4,
        label="joints of the lining",
        zorder=3,
    )
    used = np.where(there, history.utilisation, -1.0)
    at, joint = np.unravel_index(int(used.argmax()), used.shape)
    axes.plot(
        of_moment * moment[at, joint],
        of_force * normal[at, joint],
        "o",
        ms=8.0,
        mfc="none",
        mec=CRACKS,
        mew=1.2,
        label=f"largest utilisation: {used[at, joint]:.3g}, {history.along[joint]:.3g} m along, "
        f"$t$ = {history.time[at]:.4g} s",
        zorder=4,
    )


def _cracks(section: Floats) -> Floats:
    """Return M, N, and N, N/m, at which a face has its tensile strength, shape (3, 2).

    N/t + 6 |M|/t2 = f_t, from the compression at which the other face has f_c on.
    """
    thickness, tension, compression = section
    mean = 0.5 * (tension - compression)
    edge = (tension - mean) * thickness**2 / 6.0
    return np.array(
        [[-edge, mean * thickness], [0.0, tension * thickness], [edge, mean * thickness]]
    )
