"""Layers above blocks: force chains, stresses, displacements; scale bar and arrow of gravity."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.canvas import INK, SMALL, SMALL_SIZE, Part, Sheet
from clast.pictures.draw_blocks import areas_of, outlines_of
from clast.pictures.fields import prefixed, round_below
from clast.pictures.joint_values import resultants_of
from clast.pictures.linings import DIAGRAMS, diagram
from clast.pictures.magnified import as_it_was
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CHAIN, PRESSED, PULLED, MOVED = "#5b2a86", "#2166ac", "#b2182b", "#0b5345"
THIN, THICK = 0.4, 5.0
"""Widths of the lines of the smallest and the largest force, points."""


Layer = Callable[[Recording, int], tuple[list[Any], Callable[[Any], None]]]
"""Returns, of a frame, the entries of the legend and the function that draws the layer on axes; the
legend is empty where there is nothing to draw."""


def _centres(results: Recording, frame: int) -> Floats:
    """Return the middle of the vertices of each block, m, (n, 2)."""
    start = results.block_start
    return np.asarray(
        np.add.reduceat(results.vertices(frame), start[:-1]) / np.diff(start)[:, None]
    )


def _legend(colour: str, text: str, largest: float, unit: str, width: float = 1.4) -> Any:
    """Return the entry of a quantity that goes up to ``largest``."""
    from matplotlib.lines import Line2D

    factor, unit = prefixed(largest, unit)
    label = f"{text}, up to {factor * largest:.3g} {unit}"
    return Line2D([], [], color=colour, lw=width, label=label)


def chains(results: Recording, frame: int) -> tuple[list[Any], Callable[[Axes], None]]:
    """The resultant of each face from block to block through it, as wide as it is large."""
    faces = resultants_of(results.contacts(frame))
    size, largest = faces.size, float(faces.size.max(initial=0.0))

    def draw(axes: Axes) -> None:
        from matplotlib.collections import LineCollection

        if largest == 0.0:
            return
        # a fixed block may reach far: its chain begins at the face
        centres = _centres(results, frame)
        first, last = (
            np.where(results.fixed[block][:, None], faces.at, centres[block])
            for block in faces.block.T
        )
        kept = np.flatnonzero(size > 0.005 * largest)
        kept = kept[np.argsort(size[kept], kind="stable")]
        axes.add_collection(
            LineCollection(
                list(np.stack([first, faces.at, last], axis=1)[kept]),
                colors=CHAIN,
                linewidths=THIN + (THICK - THIN) * size[kept] / largest,
                capstyle="round",
                joinstyle="round",
                zorder=4.6,
            )
        )

    text = "force between blocks as width"
    return [_legend(CHAIN, text, largest, "N/m", 3.0)] if largest > 0.0 else [], draw


def crosses(results: Recording, frame: int) -> tuple[list[Any], Callable[[Axes], None]]:
    """A cross in each free block: as long as its principal stresses are large."""
    xx, yy, xy = results.field("stress", frame).T
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius, turn = np.hypot(half, xy), 0.5 * np.arctan2(xy, half)
    there = ~(results.fixed | absent_in_frame(results, frame))
    sizes = np.stack([mean + radius, mean - radius], axis=1) * there[:, None]
    turns = np.stack([turn, turn + 0.5 * np.pi], axis=1)
    largest = float(np.abs(sizes).max(initial=0.0))

    def draw(axes: Axes) -> None:
        from matplotlib.collections import LineCollection

        if largest == 0.0:
            return
        reach = 0.45 * np.sqrt(areas_of(results, results.vertices(frame)))
        arm = (reach[:, None] * np.abs(sizes) / largest)[..., None]
        arm = arm * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
        middle = _centres(results, frame)[:, None]
        lines = np.stack([middle - arm, middle + arm], axis=2)
        for colour, chosen in ((PRESSED, sizes < 0.0), (PULLED, sizes > 0.0)):
            axes.add_collection(
                LineCollection(list(lines[chosen]), colors=colour, linewidths=1.1, zorder=4.7)
            )

    ends = (
        (PRESSED, "compression", -float(sizes.min(initial=0.0))),
        (PULLED, "tension", float(sizes.max(initial=0.0))),
    )
    legend = [
        _legend(colour, f"principal stress, {sign}", most, "Pa")
        for colour, sign, most in ends
        if most > 0.0
    ]
    return legend, draw


def vectors(results: Recording, frame: int) -> tuple[list[Any], Callable[[Axes], None]]:
    """The displacement of each block as an arrow that ends where the block is."""
    moved = results.field("displacement", frame)

    def draw(axes: Axes) -> None:
        there = ~absent_in_frame(results, frame)
        largest = float(np.hypot(*moved[there].T).max(initial=0.0))
        if largest == 0.0:
            return
        seen = float(min(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())))
        # as they are where they can be seen, else enlarged
        arrow = max(1.0, 0.12 * seen / largest) * moved[there]
        axes.quiver(
            *(_centres(results, frame)[there] - 0.5 * arrow).T,
            *arrow.T,
            color=MOVED,
            angles="xy",
            scale_units="xy",
            scale=1.0,
            units="inches",
            width=0.014,
            minlength=0.0,
            zorder=4.8,
        )

    largest = float(np.hypot(*moved.T).max(initial=0.0))
    return [_legend(MOVED, "displacement", largest, "m")] if largest > 0.0 else [], draw


def levels(results: Recording, frame: int) -> tuple[list[Any], Callable[[Axes], None]]:
    """Lines of equal displacement within blocks, with their values."""
    from matplotlib.lines import Line2D
    from matplotlib.ticker import MaxNLocator

    since = 0
    for event in results.events:
        if event.kind == "displacements reset":
            last = results.frame(-1, stage=event.stage).number
            since = last if last < frame else since
    here, run = results.vertices(frame), as_it_was(results)
    size = np.hypot(*(run.vertices(frame) - run.vertices(since)).T)
    there = np.repeat(~absent_in_frame(results, frame), np.diff(results.block_start))
    largest = float(size[there].max(initial=0.0))
    factor, unit = prefixed(largest, "m")
    values = np.asarray(MaxNLocator(8).tick_values(0.0, factor * largest))
    values = values[(values > 0.0) & (values < factor * largest)]

    def draw(axes: Axes) -> None:
        from matplotlib.patheffects import Normal, Stroke
        from matplotlib.tri import Triangulation

        corners = _triangles(results, here, frame)
        if not len(values) or not len(corners):
            return
        drawn = axes.tricontour(
            Triangulation(here[:, 0], here[:, 1], corners),
            factor * size,
            values,
            colors=INK,
            linewidths=0.7,
            zorder=4,
        )
        for number in axes.clabel(drawn, fontsize=SMALL_SIZE, fmt=lambda one: f"{one:g} {unit}"):
            # above bolts and lines, and to be read on them
            number.set(zorder=9, path_effects=[Stroke(linewidth=2.0, foreground="white"), Normal()])

    if not len(values):
        return [], draw
    label = f"equal displacement, every {values[0]:g} {unit}"
    return [Line2D([], [], color=INK, lw=0.8, label=label)], draw


def _triangles(results: Recording, here: Floats, frame: int) -> Any:
    """Return triangles (k, 3) of the vertices of the blocks that are there."""
    import shapely

    absent = absent_in_frame(results, frame)
    triangles = []
    for block, outline in enumerate(outlines_of(results, here)):
        if absent[block]:
            continue
        first = int(results.block_start[block])
        parts = shapely.delaunay_triangles(shapely.MultiPoint(outline))
        inside = shapely.Polygon(outline).buffer(0.0)
        place = {tuple(point): first + k for k, point in enumerate(outline.tolist())}
        for part in shapely.get_parts(parts):
            if inside.covers(part.centroid):
                ring = shapely.get_coordinates(part)[:3].tolist()
                triangles.append([place[tuple(point)] for point in ring])
    return np.array(triangles, np.int64).reshape(-1, 3)


LAYERS: dict[str, Layer] = {
    "chains": chains,
    "crosses": crosses,
    "vectors": vectors,
    "levels": levels,
    **{name: partial(diagram, one) for name, one in DIAGRAMS.items()},
}
"""Name of a layer, as ``Look.layers`` has it -> the layer."""


def draw_scale_bar(figure: Figure, sheet: Sheet, seen: Part, up: float = 0.2) -> None:
    """Draw a bar of a round length at a height, inches, with the length beside it."""
    from matplotlib.lines import Line2D

    per_inch = float(seen[1][0] - seen[0][0]) / sheet.axes[2]
    length = round_below(0.2 * sheet.axes[2] * per_inch)
    factor, unit = prefixed(length, "m")
    width, height = sheet.size
    left, right = sheet.axes[0], sheet.axes[0] + length / per_inch
    for x, y in (
        ((left, right), (up, up)),
        ((left, left), (up - 0.04, up + 0.04)),
        ((right, right), (up - 0.04, up + 0.04)),
    ):
        place = np.array(x) / width, np.array(y) / height
        figure.add_artist(Line2D(*place, color=INK, lw=1.2, solid_capstyle="butt"))
    text = f"{factor * length:g} {unit}"
    figure.text((right + 0.08) / width, up / height, text, va="center", **SMALL)


def draw_gravity(figure: Figure, sheet: Sheet, results: Recording) -> None:
    """Draw an arrow in the direction of gravity, in the upper right corner, beside the title."""
    from matplotlib.patches import FancyArrowPatch

    size = float(np.hypot(*results.gravity))
    if size == 0.0:
        return
    width, height = sheet.size
    along = 0.13 * results.gravity / size
    middle = np.array([width - 0.22, height - 0.2])
    figure.add_artist(
        FancyArrowPatch(
            tuple((middle - along) / sheet.size),
            tuple((middle + along) / sheet.size),
            arrowstyle="-|>",
            mutation_scale=7,
            color=INK,
            lw=1.0,
        )
    )
    place: dict[str, Any] = {"ha": "right", "va": "center", "style": "italic"}
    figure.text((middle[0] - 0.12) / width, middle[1] / height, "g", **place, **SMALL)
