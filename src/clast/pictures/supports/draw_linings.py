"""Linings on a picture: diagrams of N, Q and M along them, with their extremes.

Values are drawn across the lining from its middle: positive ones to the inside, so that a moment
stands on the face that it stretches.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Bools, Floats
from clast.pictures.canvas import SMALL_SIZE
from clast.pictures.fields import prefixed
from clast.results import Recording
from clast.results.result_tables import LiningHistory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TALLEST = 0.12
"""Largest ordinate, as a share of the smaller side of the picture."""


@dataclass(frozen=True)
class LiningQuantity:
    """A quantity that is drawn along linings."""

    letter: str
    """Its sign in the legend."""
    column: str
    """Its column of the table."""
    unit: str
    """Its unit."""
    colour: str
    """Its colour."""


DIAGRAMS = {
    "normal-forces": LiningQuantity("N", "normal_force", "N/m", "#1b4f9c"),
    "shear-forces": LiningQuantity("Q", "shear_force", "N/m", "#2b7a3f"),
    "moments": LiningQuantity("M", "moment", "N m/m", "#b3261e"),
}
"""Name of a layer -> its diagram."""


def _values(
    results: Recording, frame: int, one: LiningQuantity
) -> Iterator[tuple[str, Any, Floats, Bools]]:
    """Give name, history, values (k,) and whether each joint carries (k,) of each lining there."""
    for name in results.lining_name:
        lining = results.lining(name)
        row = int(results.rows_at(lining.time, frame))
        carries = (lining.state[row] > 0) & (lining.state[row] < 4)
        if carries.any():
            yield name, lining, np.where(carries, getattr(lining, one.column)[row], 0.0), carries


def handles_of(one: LiningQuantity) -> Callable[[Recording, int], list[Any]]:
    """Return the function that gives the legend of a diagram: its extremes."""

    def handles(results: Recording, frame: int) -> list[Any]:
        from matplotlib.lines import Line2D

        found = [values[carries] for _, _, values, carries in _values(results, frame, one)]
        if not found:
            return []
        values = np.concatenate(found)
        factor, unit = prefixed(float(np.abs(values).max(initial=0.0)), one.unit)
        least, most = factor * values.min(), factor * values.max()
        label = f"{one.letter} of the lining, {least:.3g} to {most:.3g} {unit}"
        return [Line2D([], [], color=one.colour, lw=1.4, label=label)]

    return handles


def drawing_of(one: LiningQuantity) -> Callable[[Axes, Recording, int], None]:
    """Return the function that draws a diagram."""

    def draw(axes: Axes, results: Recording, frame: int) -> None:
        found = list(_values(results, frame, one))
        largest = max((float(np.abs(values).max()) for _, _, values, _ in found), default=0.0)
        if largest == 0.0:
            return
        room = min(float(np.ptp(axes.get_xlim())), float(np.ptp(axes.get_ylim())))
        for name, lining, values, carries in found:
            scaled = TALLEST * room / largest * values
            _draw(axes, results, frame, (name, lining), scaled, carries, one)
            _label(axes, results, frame, lining, values, scaled, one)

    return draw


def _draw(
    axes: Axes,
    results: Recording,
    frame: int,
    of: tuple[str, LiningHistory],
    scaled: Floats,
    carries: Bools,
    one: LiningQuantity,
) -> None:
    """Draw the ordinates (k,), m, of a lining, and the line through their ends."""
    from matplotlib.collections import LineCollection, PolyCollection

    foot, tip = _ordinates(results, frame, of[1], scaled)
    order = np.arange(len(foot))
    if comes_back(results, *of):
        order = np.append(order, 0)
    pairs = [(k, j) for k, j in itertools.pairwise(order) if carries[k] and carries[j]]
    areas = [np.array([foot[k], foot[j], tip[j], tip[k]]) for k, j in pairs]
    axes.add_collection(PolyCollection(areas, facecolors=one.colour, alpha=0.22, zorder=6.0))
    lines = [np.array([tip[k], tip[j]]) for k, j in pairs]
    axes.add_collection(LineCollection(lines, colors=one.colour, lw=1.2, zorder=6.2))
    feet = [np.array([foot[k], foot[j]]) for k, j in pairs]
    axes.add_collection(LineCollection(feet, colors=one.colour, lw=0.5, zorder=6.1))


def _label(
    axes: Axes,
    results: Recording,
    frame: int,
    lining: LiningHistory,
    values: Floats,
    scaled: Floats,
    one: LiningQuantity,
) -> None:
    """Write the least and the largest value where they are."""
    _, tip = _ordinates(results, frame, lining, scaled)
    factor, unit = prefixed(float(np.abs(values).max()), one.unit)
    for k in {int(values.argmin()), int(values.argmax())}:
        axes.annotate(
            f"{one.letter} {factor * values[k]:.3g} {unit}",
            (float(tip[k, 0]), float(tip[k, 1])),
            fontsize=SMALL_SIZE,
            color=one.colour,
            ha="center",
            va="center",
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
            zorder=8,
        )


def _ordinates(
    results: Recording, frame: int, lining: LiningHistory, scaled: Floats
) -> tuple[Floats, Floats]:
    """Return feet and tips (k, 2) of the ordinates (k,) of a lining, m."""
    outer, inner = results.vertices(frame)[lining.face.T]
    inwards = (inner - outer) / np.hypot(*(inner - outer).T)[:, None]
    foot = 0.5 * (outer + inner)
    return foot, foot + scaled[:, None] * inwards


def comes_back(results: Recording, name: str, lining: LiningHistory) -> bool:
    """Return whether the last joint of a lining is beside its first segment."""
    first = results.block_name.index(f"{name}/1")
    start, last = results.vertices(0)[[results.block_start[first], lining.face[-1, 0]]]
    count = sum(block.rpartition("/")[0] == name for block in results.block_name)
    spacing = float(np.hypot(*np.ptp(results.vertices(0)[lining.face[:, 0]], axis=0)))
    return len(lining.along) == count and bool(np.hypot(*(start - last)) <= 1e-6 * spacing)
