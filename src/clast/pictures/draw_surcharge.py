"""Fill and the axles of load trains on a picture, where they are at the start."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.surcharge import Surcharge
from clast.pictures.canvas import Part
from clast.pictures.fields import prefixed
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILL, AXLE = "#e3d2a6", "#a13d0b"
"""Colours of fill and of axles."""
SHORT, LONG = 9.0, 26.0
"""Lengths of the arrows of a small and of the largest load, points."""
ROOM = 0.08
"""Room above wheels, in units of the width of the picture."""


def surcharge_of(results: Recording, frame: int) -> Surcharge:
    """Return the fill and the axles that act in a frame, in the user's coordinates, m."""
    begun = results.begun_at(frame)
    every, origin = results.surcharge, results.origin

    def acts(name: str) -> bool:
        return name not in begun or begun[name] is not None

    fill = [k for k, name in enumerate(every.fill_name) if acts(name)]
    axle = [k for k, name in enumerate(every.axle_name) if acts(name) and every.load[k] > 0.0]
    return replace(
        every,
        fill=tuple(every.fill[k] + origin for k in fill),
        fill_name=tuple(every.fill_name[k] for k in fill),
        axle=every.axle[axle] + origin,
        load=every.load[axle],
        axle_name=tuple(every.axle_name[k] for k in axle),
    )


def with_surcharge(shown: Surcharge, part: Part) -> Part:
    """Return the part to show, made so large that fill and axles are in it."""
    points = [*shown.fill, *shown.axle]
    if not points:
        return part
    low, high = (end(np.concatenate(points), axis=0) for end in (np.min, np.max))
    low, high = np.minimum(part[0], low), np.maximum(part[1], high)
    if len(shown.axle):
        top = float(shown.axle[:, 0, 1].max()) + ROOM * float(high[0] - low[0])
        high = np.maximum(high, [high[0], top])
    return low, high


def handles_of_surcharge(shown: Surcharge) -> list[Any]:
    """Return the legend of fill and axles, nothing where there are none."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(fc=FILL, lw=0.0, label="fill")] if shown.fill else []
    if len(shown.load):
        factor, unit = prefixed(float(shown.load.max()), "N/m")
        label = f"axle, up to {factor * shown.load.max():.3g} {unit}"
        handles.append(Line2D([], [], color=AXLE, lw=1.6, marker="v", ms=4.5, label=label))
    return handles


def draw_surcharge(axes: Axes, shown: Surcharge) -> None:
    """Draw fill behind the blocks, and axles as arrows, as long as they are heavy."""
    from matplotlib.collections import LineCollection, PolyCollection

    if len(shown.fill):
        axes.add_collection(PolyCollection([*shown.fill], fc=FILL, ec="none", zorder=0.5))
    wheel, *feet = np.moveaxis(shown.axle, 1, 0)
    spread = [line for foot in feet for line in np.stack([wheel, foot], axis=1)]
    axes.add_collection(
        LineCollection(spread, colors=AXLE, linewidths=0.6, linestyles="dashed", zorder=5.1)
    )
    arrow = {"arrowstyle": "-|>", "color": AXLE, "lw": 1.6, "shrinkA": 0.0, "shrinkB": 0.0}
    for at, load in zip(wheel.tolist(), shown.load, strict=True):
        high = SHORT + (LONG - SHORT) * float(load / shown.load.max())
        place: dict[str, Any] = {"xytext": (0.0, high), "textcoords": "offset points"}
        axes.annotate("", at, arrowprops=arrow, zorder=5.7, **place)
