"""Water on a picture: its level with a triangle, and the pressures on the edges that it wets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from clast.actions.water import pressed_by
from clast.model.drainage import drained
from clast.model.model import Floats, Ints
from clast.model.stages import standing
from clast.model.water import Water, surface_at
from clast.pictures.canvas import Part
from clast.pictures.fields import prefixed
from clast.pictures.forces import length_of_longest
from clast.pictures.magnified import as_it_was, carried
from clast.pictures.strokes import following
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, PALE = "#1f6fb4", "#5aa5dc"
"""Colours of the level and of pressures."""
LONGEST, CLEAR = 0.6, 0.3
"""Ordinate of the largest pressure in lengths of the longest arrow of a contact, and how much of
the background of diagrams their fill covers: colours of blocks are seen through and beside them."""
TRIANGLE_SIZE, TRIANGLE_PLACE = 8.0, 0.06
"""Size of the triangle, points, and its place from the left, as a share of the picture."""


@dataclass(frozen=True, kw_only=True)
class PressureDiagrams:
    """Pressures to be drawn: k diagrams on lines under water."""

    ends: Floats
    """Ends of the lines, m, shape (k, 2, 2)."""
    edge: Ints
    """Edge that each lies along, or the first of two, shape (k,)."""
    pressure: Floats
    """Pressure at their ends, Pa, shape (k, 2)."""
    sides: Floats
    """How much of a diagram stands to the left and to the right of its line, shape (k, 2)."""

    @property
    def largest(self) -> float:
        """Largest pressure, Pa."""
        return float(self.pressure.max(initial=0.0))


def waters_of(results: Recording, frame: int) -> tuple[Water, ...]:
    """Return the waters that press in a frame, those that a later stage brings left out."""
    since = results.begun_at(frame)
    now = float(results.times[frame])
    standings = (standing(water, since) for water in results.water)
    return tuple(water for water in standings if water.pressure_of_head(now) > 0.0)


def pressures_of(
    results: Recording, waters: Sequence[Water], frame: int, here: Floats
) -> PressureDiagrams:
    """Return the pressures of waters in a frame with vertices ``here`` (nv, 2), m."""
    count = np.diff(results.block_start)
    blocks: Any = SimpleNamespace(
        vertex_block=np.repeat(np.arange(len(count)), count),
        vertex_after=following(results.block_start),
        absent=absent_in_frame(results, frame),
    )
    time, vertices = float(results.times[frame]), here - results.origin
    every = [pressed_by(drained(water, blocks.absent), blocks, vertices, time) for water in waters]

    def whole(name: str, *shape: int) -> Floats:
        return np.concatenate([np.zeros((0, *shape)), *(getattr(one, name) for one in every)])

    in_joint = whole("other")[:, None] >= 0.0
    return PressureDiagrams(
        ends=whole("ends", 2, 2) + results.origin,
        edge=whole("edge").astype(np.int64),
        pressure=whole("pressure", 2),
        sides=np.where(in_joint, [0.5, 0.5], [0.0, 1.0]),
    )


def dry_of(results: Recording, water: Water, frame: int) -> Floats:
    """Return the ranges of x, m, in which a surface lies in excavated ground, (k, 2), in order."""
    absent = absent_in_frame(results, frame)
    excavated = absent & ~results.awaited(frame)
    if not excavated.any():
        return np.zeros((0, 2))
    here = results.vertices(frame)
    low, high = here.min(axis=0), here.max(axis=0)
    line = shapely.linestrings(_points(water, results, (low, high)))
    owner = np.repeat(np.arange(len(absent)), np.diff(results.block_start))
    polygons = shapely.polygons(shapely.linearrings(here, indices=owner))
    near = 1e-3 * float(np.hypot(*(high - low)))  # a level so far above a void belongs to it
    void = shapely.union_all(shapely.buffer(polygons[excavated], near, join_style="mitre"))
    rock = polygons[~absent]
    rock = shapely.union_all(rock[shapely.intersects(rock, line)])
    parts = shapely.get_parts(shapely.difference(shapely.intersection(line, void), rock))
    ends = np.reshape([shapely.bounds(part)[[0, 2]] for part in parts], (-1, 2))
    ends = ends[ends[:, 1] - ends[:, 0] > near]
    return np.asarray(ends[np.argsort(ends[:, 0])])


def with_levels(results: Recording, waters: Sequence[Water], part: Part) -> Part:
    """Return the part to show, made so high that levels not far above the blocks are in it."""
    low, high = part
    # How far above the blocks a level is still shown, in their heights
    most = float(high[1] + 0.5 * (high[1] - low[1]))
    tops = [float(_points(water, results, part)[:, 1].max()) for water in waters]
    seen = [top for top in tops if top <= most]
    return low, np.array([high[0], max([float(high[1]), *seen])])


def _points(water: Water, results: Recording, part: Part) -> Floats:
    """Return the points of a surface from one side of a part to the other, m, shape (k, 2)."""
    low, high = part[0] - results.origin, part[1] - results.origin
    inner = water.surface[:, 0]
    x = np.concatenate([[low[0]], inner[(inner > low[0]) & (inner < high[0])], [high[0]]])
    return np.stack([x, surface_at(water.surface, x)], axis=1) + results.origin


def level_handle(label: str) -> Any:
    """Return the entry of the legend of a level."""
    from matplotlib.lines import Line2D

    level: dict[str, Any] = {"marker": "v", "mfc": "white", "mec": BLUE, "ms": 5.0}
    return Line2D([], [], color=BLUE, lw=0.9, label=label, **level)


def handles_of_water(waters: Sequence[Water], pressures: PressureDiagrams) -> list[Any]:
    """Return the legend of water, nothing where there is none."""
    from matplotlib.patches import Patch

    if not waters:
        return []
    handles = [level_handle("water level")]
    if pressures.largest > 0.0:
        factor, unit = prefixed(pressures.largest, "Pa")
        label = f"water pressure, up to {pressures.largest * factor:.3g} {unit}"
        handles.append(Patch(fc=(PALE, CLEAR), ec=BLUE, lw=0.3, label=label))
    return handles


def draw_water(
    axes: Axes, results: Recording, waters: Sequence[Water], frame: int, part: Part
) -> None:
    """Draw the levels, but for voids, and the pressures: outside faces, and across joints."""
    from matplotlib.collections import PolyCollection

    if not waters:
        return
    drawn, results = results, as_it_was(results)
    pressures = pressures_of(results, waters, frame, results.vertices(frame))
    if pressures.largest > 0.0:
        block = np.searchsorted(results.block_start, pressures.edge, side="right") - 1
        both = [carried(drawn, frame, block, pressures.ends[:, end]) for end in (0, 1)]
        pressures = replace(pressures, ends=np.stack(both, axis=1))
        outlines = list(_diagrams(pressures, LONGEST * length_of_longest(results, *part)))
        looks: dict[str, Any] = {"fc": (PALE, CLEAR), "ec": BLUE, "lw": 0.3, "zorder": 3.5}
        axes.add_collection(PolyCollection(outlines, **looks))
    for number, water in enumerate(waters):
        points = _points(water, results, part)
        ends = np.clip(dry_of(results, water, frame), part[0][0], part[1][0])
        wet = np.reshape([part[0][0], *ends.ravel(), part[1][0]], (-1, 2))
        for low, high in wet[wet[:, 1] > wet[:, 0]]:
            inner = points[(points[:, 0] > low) & (points[:, 0] < high), 0]
            across = np.concatenate([[low], inner, [high]])
            draw_level(axes, np.stack([across, np.interp(across, *points.T)], axis=1))
        x = float(part[0][0] + (1.0 + 0.7 * number) * TRIANGLE_PLACE * (part[1][0] - part[0][0]))
        if not ((wet[:, 0] < x) & (x < wet[:, 1])).any():
            x = float(wet[np.diff(wet).argmax()].mean())  # the sign stands on water
        draw_sign(axes, np.array([x, np.interp(x, *points.T)]), part)


def draw_level(axes: Axes, points: Floats) -> None:
    """Draw a level through points (k, 2), m."""
    axes.plot(*points.T, color=BLUE, lw=0.9, zorder=5.5)


def draw_sign(axes: Axes, at: Floats, part: Part) -> None:
    """Draw the triangle that stands on a level at a point (2,), m, if its height is in a part."""
    from matplotlib.transforms import ScaledTranslation

    if not part[0][1] <= at[1] <= part[1][1]:
        return
    figure, tip = axes.get_figure(root=True), axes.transData
    if figure:
        # it stands on the level, which may be the upper edge of the picture
        up = ScaledTranslation(0.0, 0.5 * TRIANGLE_SIZE / 72.0, figure.dpi_scale_trans)
        tip = tip + up
    looks: dict[str, Any] = {
        "ms": TRIANGLE_SIZE,
        "mfc": "white",
        "mec": BLUE,
        "mew": 0.9,
        "zorder": 5.6,
    }
    axes.plot([at[0]], [at[1]], "v", transform=tip, clip_on=False, **looks)


def _diagrams(pressures: PressureDiagrams, longest: float) -> Floats:
    """Return the outlines of diagrams, m, shape (k, 4, 2); the largest pressure is so long, m."""
    ends = pressures.ends
    along = ends[:, 1] - ends[:, 0]
    along = along / np.maximum(np.hypot(*along.T), 1e-300)[:, None]
    right = np.stack([along[:, 1], -along[:, 0]], axis=1)[:, None]
    high = (longest / pressures.largest * pressures.pressure)[..., None]
    left, beside = pressures.sides[:, :1, None], pressures.sides[:, 1:, None]
    upper, lower = ends - left * high * right, ends + beside * high * right
    return np.concatenate([upper, lower[:, ::-1]], axis=1)
