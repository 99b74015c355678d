"""Water that flows in joints on a picture: dry channels, arrows, water table, flows of openings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from clast.model.model import Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK, Part
from clast.pictures.draw_water import draw_level, draw_sign, level_handle
from clast.pictures.fields import prefixed
from clast.pictures.flow_values import (
    FLOW_FIELDS,
    LITRES,
    LITRES_UNIT,
    STILL,
    dry_channels,
    largest_flow,
    with_widest,
)
from clast.pictures.joint_values import THICK, THIN
from clast.pictures.magnified import as_it_was
from clast.results import Recording
from clast.results.schema import ALL_JOINTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ARROW, CELL = 0.16, 0.55
"""Length of arrows, and of the squares of which each has one, inches."""
CASING = 0.8
"""How much wider than channels their edge is, points."""
ABOVE = (0, 9)
"""Where numbers stand beside their places, points: above the sign of a level."""
LETTER, LINE = 4.2, 12.0
"""Width of a letter of these numbers, and height of a line, points."""
NEAR, FARTHEST = 1e-3, 0.5
"""How near to a line joints come out on it, as a share of the model, and how far above the blocks a
level is still shown, in their heights."""
LEAST = 0.01
"""Share of the largest flow below which a flow has no arrow."""


def flows_of(results: Recording, frame: int) -> list[tuple[str, Floats, float]]:
    """Return name, place, m, and flow out of the rock, m2/s, of boundaries and wells."""
    rows = [(name, results.inflow(name)) for name in results.flow_name if name != ALL_JOINTS]
    if not rows:
        return []
    at = results.rows_at(rows[0][1].time, frame)
    flows = np.array([float(one.inflow[at]) for _, one in rows])
    seen = np.abs(flows) > STILL * np.abs(flows).max()
    place, middle = results.channels.place.copy(), float(results.vertices(0)[:, 0].mean())
    for number, line in levels_of(results, frame).items():
        # at the end of the level that is farther outside
        place[number] = line[np.abs(line[:, 0] - middle).argmax()]
    named = zip(rows, place, flows, seen, strict=False)
    return [(row[0], at, flow) for row, at, flow, is_seen in named if is_seen and at[0] == at[0]]


def levels_of(results: Recording, frame: int) -> dict[int, Floats]:
    """Return the levels of the heads that press in a frame, m, (5, 2), by numbers of boundaries.

    That is the head of joints that come out there, across the part of the boundary below it.
    """
    channels, flow, levels = results.channels, as_it_was(results).flow(frame), {}
    if not len(channels.of_line) or channels.weight == 0.0:
        return {}
    at = np.concatenate([flow.start, flow.end])
    pressure = flow.pressure.T.ravel()
    near = NEAR * float(np.ptp(results.vertices(0), axis=0).max())
    for number in np.unique(channels.of_line).tolist():
        line = channels.line[channels.of_line == number]
        beside = shapely.dwithin(shapely.points(at), shapely.multilinestrings(list(line)), near)
        wet = np.flatnonzero(beside & (pressure > 0.0))
        if not len(wet):
            continue
        head = float(np.median(at[wet, 1] + pressure[wet] / channels.weight))
        x = line[line[..., 1].min(axis=1) <= head + near][..., 0]
        levels[number] = np.stack([np.linspace(x.min(), x.max(), 5), np.full(5, head)], axis=1)
    return levels


def surfaces_of(results: Recording, frame: int) -> list[Floats]:
    """Return the water tables of a frame and the levels of heads that press, m, (c, 2) each."""
    tables = [one for one in results.flow(frame).water_table if len(one) > 1]
    return [*tables, *levels_of(results, frame).values()]


def with_heads(results: Recording, frame: int, part: Part) -> Part:
    """Return the part to show, made so high that levels not far above the blocks are in it."""
    low, high = part
    tops = [float(one[0, 1]) for one in levels_of(results, frame).values()]
    seen = [top for top in tops if top <= high[1] + FARTHEST * (high[1] - low[1])]
    return low, np.array([high[0], max([float(high[1]), *seen])])


def text_of_flow(name: str, flow: float) -> str:
    """Return name and size of a flow out of the rock, m2/s, and which way it goes."""
    factor, unit = prefixed(LITRES * flow, LITRES_UNIT)
    way = "leaves" if flow > 0.0 else "enters"
    return f"{name}: {abs(factor * LITRES * flow):.3g} {unit} {way}"


def largest_of_cells(at: Floats, size: Floats, side: float) -> Ints:
    """Return, of points (k, 2), that with the largest size of each square of a side."""
    cell = np.floor(at / side).astype(np.int64)
    order = np.lexsort((-size, cell[:, 1], cell[:, 0]))
    first = np.any(np.diff(cell[order], axis=0, prepend=cell[order][:1] - 1) != 0, axis=1)
    return np.asarray(order[first])


def draw_flow(axes: Axes, results: Recording, frame: int, seen: Part, widest: float) -> None:
    """Draw dry channels, arrows on the channels with the largest flow, and the flows as numbers.

    ``widest`` is the flow of the widest line, m2/s.
    """
    from matplotlib.collections import LineCollection

    dry = dry_channels(results, frame)
    looks: dict[str, Any] = {"colors": FAINT, "linewidths": THIN, "zorder": 4.4}
    axes.add_collection(LineCollection(list(dry.ends), **looks))
    faces = FLOW_FIELDS["flow"].values(results, frame)
    faces = with_widest(faces, largest_flow(results, frame), widest)
    # an edge, so that the pale colours of low values are seen
    wide = THIN + CASING + (THICK - THIN) * (0.0 if faces.width is None else faces.width)
    axes.add_collection(LineCollection(list(faces.ends), **{**looks, "linewidths": wide}))
    shown = faces.within(*seen) & (faces.value > LEAST * faces.value.max(initial=0.0))
    ends, size = faces.ends[shown], faces.value[shown]
    figure = axes.get_figure(root=True)
    inches = axes.get_position().width * (figure.get_size_inches()[0] if figure else 1.0)
    per_inch = float(seen[1][0] - seen[0][0]) / float(inches)
    middle, along = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    chosen = largest_of_cells(middle, size, CELL * per_inch)
    along = ARROW * per_inch * along / np.maximum(np.hypot(*along.T), 1e-300)[:, None]
    quiver: dict[str, Any] = {"pivot": "mid", "angles": "xy", "scale_units": "xy", "scale": 1.0}
    heads: dict[str, Any] = {"headwidth": 5.0, "headlength": 5.0, "headaxislength": 5.0}
    quiver |= {"units": "inches", "width": 0.014, "edgecolor": "white", "linewidth": 0.3}
    axes.quiver(*middle[chosen].T, *along[chosen].T, color=INK, zorder=5.2, **quiver, **heads)
    _write_flows(axes, results, frame, seen, per_inch)


def _write_flows(axes: Axes, results: Recording, frame: int, seen: Part, per_inch: float) -> None:
    """Write the flows at their places, one above the other where they would lie on each other."""
    low, high = seen
    taken = np.zeros((0, 3))  # left and right end and foot of each text, points
    for name, at, flow in flows_of(results, frame):
        if not ((at >= low) & (at <= high)).all():
            continue
        share = (at[0] - low[0]) / (high[0] - low[0])
        side, before = ("left", 0.0) if share < 0.2 else ("center", 0.5)
        side, before = ("right", 1.0) if share > 0.8 else (side, before)
        text = text_of_flow(name, flow)
        x, y = 72.0 * at / per_inch
        left, width = x - before * LETTER * len(text), LETTER * len(text)
        beside = taken[(taken[:, 0] < left + width) & (taken[:, 1] > left)]
        foot = y
        while (np.abs(beside[:, 2] - foot) < LINE).any():
            foot += LINE
        taken = np.vstack([taken, [left, left + width, foot]])
        above: dict[str, Any] = {"xytext": (ABOVE[0], ABOVE[1] + foot - y)}
        above["textcoords"] = "offset points"
        canvas.write(axes, canvas.literal(text), at, 7.5, ha=side, va="bottom", **above)


def draw_water_tables(axes: Axes, results: Recording, frame: int, seen: Part) -> None:
    """Draw water tables, and levels of heads that press, each with the sign of a level."""
    for points in surfaces_of(results, frame):
        draw_level(axes, points)
        draw_sign(axes, points[(len(points) - 1) // 4], seen)


def handles_of_flow(results: Recording, frame: int, field: str, widest: float) -> list[Any]:
    """Return the legend of water in joints: its table, and of its fields width, arrows, dry."""
    from matplotlib.lines import Line2D

    if not len(results.channels.edge):
        return []
    handles: list[Any] = [level_handle("water table")] if surfaces_of(results, frame) else []
    if field not in FLOW_FIELDS:
        return handles
    if widest > 0.0:
        factor, unit = prefixed(LITRES * widest, LITRES_UNIT)
        label = f"flow as width, up to {factor * LITRES * widest:.3g} {unit}"
        handles.append(Line2D([], [], color=INK, lw=3.0, label=label))
    if len(dry_channels(results, frame).value):
        handles.append(Line2D([], [], color=FAINT, lw=THIN, label="dry joint"))
    return handles
