"""Linings: diagrams of N, Q and M along them, and N and M beside the interaction curve.

Values are drawn across the lining from its middle: positive ones to the inside, so that a moment
stands on the face that it stretches.  Beside the curve, moments lie along the abscissa and normal
forces upwards, compression at the top: so engineers of concrete draw it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.actions.linings import InteractionCurve, interaction_curve
from clast.errors import CaseError
from clast.model.model import Bools, Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, LEGEND, NAME_BOX, TEXT
from clast.results import Recording
from clast.results.result_tables import LiningHistory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

APART_MAX = 0.5
"""Distance of the middles of two ends that are joined, in units of the smaller thickness."""
TALLEST = 0.12
"""Largest ordinate, as a share of the smaller side of the picture."""


@dataclass(frozen=True)
class LiningQuantity:
    """A quantity that is drawn along linings: its letter, and its column of the table."""

    letter: str
    column: str
    unit: str
    """Unit in which it is drawn and written, a thousand times that of the column."""
    colour: str


KILO = 1e-3
"""Factor from the units of columns to those of diagrams."""
DIAGRAMS = {
    "normal-forces": LiningQuantity("N", "normal_force", "kN/m", "#1b4f9c"),
    "shear-forces": LiningQuantity("Q", "shear_force", "kN/m", "#2b7a3f"),
    "moments": LiningQuantity("M", "moment", "kN m/m", "#b3261e"),
}
"""Name of a layer -> its diagram."""


def carries(lining: LiningHistory) -> Bools:
    """Return where and when the joints of a lining carry, shape (t, k)."""
    return np.asarray((lining.state > 0) & (lining.state < LOST))


def diagram(
    one: LiningQuantity, results: Recording, frame: int
) -> tuple[list[Any], Callable[[Axes], None]]:
    """Return the legend of a diagram, its extremes, and the function that draws it on axes."""
    from matplotlib.lines import Line2D

    drawn: list[tuple[str, Floats, Bools]] = []
    for name in results.lining_name:
        lining = results.lining(name)
        row = int(results.rows_at(lining.time, frame))
        here = carries(lining)[row]
        drawn.append((name, np.where(here, getattr(lining, one.column)[row], 0.0), here))
    drawn = drawn if any(here.any() for _, _, here in drawn) else []
    largest = max((float(np.abs(values).max()) for _, values, _ in drawn), default=0.0)

    def draw(axes: Axes) -> None:
        if largest == 0.0:
            return
        room = min(float(np.ptp(axes.get_xlim())), float(np.ptp(axes.get_ylim())))
        scale, bears = TALLEST * room / largest, np.concatenate([here for *_, here in drawn])
        ends = [_ordinates(results, frame, name, scale * values) for name, values, _ in drawn]
        foot, tip = (np.concatenate(part) for part in zip(*ends, strict=True))
        pairs = pairs_of(results)
        _draw_diagram(axes, foot, tip, pairs[bears[pairs].all(axis=1)], one)
        for (_, tips), (_, values, here) in zip(ends, drawn, strict=True):
            for k in {int(values.argmin()), int(values.argmax())} if here.any() else ():
                text = f"{one.letter} {KILO * values[k]:.3g} {one.unit}"
                canvas.write(
                    axes, text, tips[k], 8, color=one.colour, bbox={**NAME_BOX, "alpha": 0.85}
                )

    if not drawn:
        return [], draw
    every = np.concatenate([values[here] for _, values, here in drawn])
    least, most = KILO * every.min(), KILO * every.max()
    label = f"{one.letter} of the lining, {least:.3g} to {most:.3g} {one.unit}"
    return [Line2D([], [], color=one.colour, lw=1.4, label=label)], draw


def _ordinates(results: Recording, frame: int, name: str, scaled: Floats) -> tuple[Floats, Floats]:
    """Return feet and tips (k, 2) of the ordinates (k,) of a lining, m."""
    outer, inner = results.vertices(frame)[results.lining(name).face.T]
    inwards = (inner - outer) / np.hypot(*(inner - outer).T)[:, None]
    foot = 0.5 * (outer + inner)
    return foot, foot + scaled[:, None] * inwards


def _draw_diagram(axes: Axes, foot: Floats, tip: Floats, pairs: Ints, one: LiningQuantity) -> None:
    """Draw the ordinates of linings between ``pairs`` (p, 2) of joints, and their outline."""
    from matplotlib.collections import LineCollection, PolyCollection

    areas = [np.array([foot[k], foot[j], tip[j], tip[k]]) for k, j in pairs.tolist()]
    axes.add_collection(PolyCollection(areas, facecolors=one.colour, alpha=0.22, zorder=6.0))
    for ends, width, zorder in ((tip, 1.2, 6.2), (foot, 0.5, 6.1)):
        axes.add_collection(
            LineCollection(list(ends[pairs]), colors=one.colour, lw=width, zorder=zorder)
        )


def pairs_of(results: Recording) -> Ints:
    """Return the joints between which diagrams run, by their numbers in all linings, (p, 2).

    They follow each other along a lining.  A ring closes, and a lining goes on into another that
    it is joined with: the joint there is that of one of the two, at the end of its last segment.
    """
    vertices, offset = results.vertices(0), 0
    pairs: list[tuple[int, int]] = []
    made: list[tuple[int, Floats]] = []
    open_ends: list[tuple[int, Floats]] = []
    for name in results.lining_name:
        face = results.lining(name).face
        count = len(face)
        pairs += [(offset + k, offset + k + 1) for k in range(count - 1)]
        for end, own in zip(_end_faces(results, name), (0, count - 1), strict=True):
            ends = made if (face[own] == end).all() else open_ends
            ends.append((offset + own, vertices[end]))
        offset += count
    for own, open_end in open_ends:
        for joint, other in made:
            thick = min(float(np.hypot(*(one[1] - one[0]))) for one in (open_end, other))
            if np.hypot(*(open_end - other).mean(axis=0)) <= APART_MAX * thick:
                pairs.append((joint, own))
    return np.array(pairs, np.int64).reshape(-1, 2)


def _end_faces(results: Recording, name: str) -> tuple[Ints, Ints]:
    """Return the vertices, outside and inside, of the faces in which a lining begins and ends."""
    own = [k for k, one in enumerate(results.block_name) if one.rpartition("/")[0] == name]
    first, past = results.block_start[own[0]], results.block_start[own[-1] + 1]
    # outer points along the line, then the inner ones of the end and of the start
    start = np.array([first, results.block_start[own[0] + 1] - 1])
    return start, np.array([past - 3, past - 2])


CURVE, CRACKS, POINTS, CLOUD = "#262626", "#c1440e", "#1b4f9c", "#9ab3d6"
"""Colours of the curve, of the limit of cracks, of the points of the frame and of the others."""
SIZE = 4.6, 4.2
"""Width and height of the axes, inches."""
LOST = 4
"""State of a joint of a lining from which on it carries nothing."""


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
    there = carries(history)
    if not there[row].any():
        raise CaseError(
            f"lining '{lining}' does not exist at {results.times[number]:.4g} s",
            where="interaction",
            remedy="ask for a later frame or stage",
        )
    title = canvas.wrapped(results.title or results.name, SIZE[0], canvas.TITLE_SIZE)
    # Lines of the legend
    below = canvas.BELOW + 0.12 + canvas.LINE * 3
    width = canvas.LEFT + SIZE[0] + canvas.RIGHT
    height = below + SIZE[1] + 0.32 + canvas.LINE * (len(title) + 1)
    figure = canvas.new_figure((width, height), 160)
    text = f"Lining {canvas.literal(lining)} at $t$ = {results.times[number]:.4g} s"
    if stage := results.frame(frame).stage:
        text += f", stage {canvas.literal(stage)}"
    canvas.head(figure, canvas.LEFT, title, text)
    box = (canvas.LEFT / width, below / height, SIZE[0] / width, SIZE[1] / height)
    axes = figure.add_axes(box)
    _draw_curve(axes, history, curve, there, row)
    place = (canvas.LEFT / width, 0.1 / height)
    padding: dict[str, Any] = {"borderpad": 0.0, "borderaxespad": 0.0}
    figure.legend(loc="lower left", bbox_to_anchor=place, ncols=2, **padding, **LEGEND)
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


def _draw_curve(
    axes: Axes, history: LiningHistory, curve: InteractionCurve, there: Bools, row: int
) -> None:
    """Draw the curve, the limit of cracks, and N and M of all instants and of one ``row``."""
    sides = np.concatenate([curve.moment, -curve.moment[::-1]])
    around = np.concatenate([curve.normal, curve.normal[::-1]])
    axes.plot(KILO * sides, KILO * around, color=CURVE, lw=1.3, label="strength")
    # N/t + 6 |M|/t2 = f_t, from the compression at which the other face has f_c on
    thickness, tension, compression = history.section[0]
    mean = 0.5 * (tension - compression)
    edge = (tension - mean) * thickness**2 / 6.0
    normal = KILO * thickness * np.array([mean, tension, mean])
    moment = KILO * np.array([-edge, 0.0, edge])
    axes.plot(moment, normal, color=CRACKS, lw=1.0, ls="--", label="a face cracks")
    _draw_states(axes, history, there, row)
    axes.axhline(0.0, color=FAINT, lw=0.6)
    axes.axvline(0.0, color=FAINT, lw=0.6)
    axes.invert_yaxis()
    axes.set_xlabel("M (kN m/m), positive: stretched inside", **TEXT)
    axes.set_ylabel("N (kN/m), compression upwards", **TEXT)
    axes.grid(color="#e4e4e4", lw=0.6)
    canvas.style(axes)


def _draw_states(axes: Axes, history: LiningHistory, there: Bools, row: int) -> None:
    """Draw N and M of all instants, those of one ``row`` above, and the largest utilisation."""
    normal, moment = KILO * history.normal_force, KILO * history.moment
    every = np.flatnonzero(there.ravel())
    # Points of other instants that are drawn at most
    every = every[:: max(1, -(-len(every) // 20_000))]
    looks: dict[str, Any] = {"color": CLOUD, "ms": 2.5, "label": "at all times", "zorder": 2.5}
    axes.plot(moment.ravel()[every], normal.ravel()[every], ".", **looks)
    now = there[row]
    looks = {"color": POINTS, "ms": 4.0, "mec": "white", "mew": 0.4, "zorder": 3}
    axes.plot(moment[row, now], normal[row, now], "o", label="joints of the lining", **looks)
    used = np.where(there, history.utilisation, -1.0)
    at, joint = np.unravel_index(int(used.argmax()), used.shape)
    place = f"{history.along[joint]:.3g} m along, $t$ = {history.time[at]:.4g} s"
    label = f"largest utilisation: {100.0 * used[at, joint]:.3g} %, {place}"
    looks = {"ms": 8.0, "mfc": "none", "mec": CRACKS, "mew": 1.2, "zorder": 4}
    axes.plot(moment[at, joint], normal[at, joint], "o", label=label, **looks)
