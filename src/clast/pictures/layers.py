"""Layers above blocks: force chains, stresses, displacements; scale bar and arrow of gravity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import INK, SMALL_SIZE, Part, Sheet
from clast.pictures.draw_blocks import areas_of, outlines_of
from clast.pictures.fields import prefixed, round_below
from clast.pictures.joint_values import resultants_of
from clast.pictures.linings import DIAGRAMS, drawing_of, handles_of_diagram
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CHAIN, PRESSED, PULLED, MOVED = "#5b2a86", "#2166ac", "#b2182b", "#0b5345"
THIN, THICK = 0.4, 5.0
"""Widths of the lines of the smallest and the largest force, points."""
FAINTEST = 0.005
"""Forces below this share of the largest are not drawn."""
LEVELS = 8
"""Levels of displacement at most."""
LONGEST = 0.12
"""Longest arrow of a displacement, as a share of the picture's smaller side."""


@dataclass(frozen=True)
class StillLayer:
    """A layer: the text of its legend, and how it is drawn."""

    handles: Callable[[Recording, int], list[Any]]
    """Returns the entries of the legend, nothing where there is nothing to draw."""
    draw: Callable[[Axes, Recording, int], None]
    """Draws it on axes that show their part already."""


def _centres(results: Recording, frame: int) -> Floats:
    """Return the middle of the vertices of each block, m, (n, 2)."""
    start = results.block_start
    return np.asarray(
        np.add.reduceat(results.vertices(frame), start[:-1]) / np.diff(start)[:, None]
    )


def _line(colour: str, label: str, width: float = 1.4) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, lw=width, label=label)


def _up_to(what: str, largest: float, unit: str) -> str:
    factor, unit = prefixed(largest, unit)
    return f"{what}, up to {factor * largest:.3g} {unit}"


# Force chains ------------------------------------------------------------------------------------


def _chain_handles(results: Recording, frame: int) -> list[Any]:
    largest = float(resultants_of(results.contacts(frame)).size.max(initial=0.0))
    if not largest > 0.0:
        return []
    return [_line(CHAIN, _up_to("force between blocks as width", largest, "N/m"), 3.0)]


def _draw_chains(axes: Axes, results: Recording, frame: int) -> None:
    """Draw the resultant of each face from block to block through it, as wide as it is large."""
    from matplotlib.collections import LineCollection

    faces, centres = resultants_of(results.contacts(frame)), _centres(results, frame)
    size = faces.size
    largest = float(size.max(initial=0.0))
    if largest == 0.0:
        return
    # a fixed block may reach far: its chain begins at the face
    ends = [
        np.where(results.fixed[block][:, None], faces.at, centres[block]) for block in faces.block.T
    ]
    lines = np.stack([ends[0], faces.at, ends[1]], axis=1)
    kept = np.flatnonzero(size > FAINTEST * largest)
    kept = kept[np.argsort(size[kept], kind="stable")]
    widths = THIN + (THICK - THIN) * size[kept] / largest
    axes.add_collection(
        LineCollection(
            list(lines[kept]),
            colors=CHAIN,
            linewidths=widths,
            capstyle="round",
            joinstyle="round",
            zorder=4.6,
        )
    )


# Principal stresses ------------------------------------------------------------------------------


def _principal(results: Recording, frame: int) -> tuple[Floats, Floats]:
    """Return principal stresses, Pa, (n, 2), and their directions, rad, (n, 2)."""
    xx, yy, xy = results.field("stress", frame).T
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius, turn = np.hypot(half, xy), 0.5 * np.arctan2(xy, half)
    sizes = np.stack([mean + radius, mean - radius], axis=1)
    there = ~(results.fixed | absent_in_frame(results, frame))
    return sizes * there[:, None], np.stack([turn, turn + 0.5 * np.pi], axis=1)


def _cross_handles(results: Recording, frame: int) -> list[Any]:
    sizes, _ = _principal(results, frame)
    found = []
    for colour, what, most in (
        (PRESSED, "compression", -float(sizes.min(initial=0.0))),
        (PULLED, "tension", float(sizes.max(initial=0.0))),
    ):
        if most > 0.0:
            found.append(_line(colour, _up_to(f"principal stress, {what}", most, "Pa")))
    return found


def _draw_crosses(axes: Axes, results: Recording, frame: int) -> None:
    """Draw a cross in each free block: as long as its principal stresses are large."""
    from matplotlib.collections import LineCollection

    sizes, turns = _principal(results, frame)
    largest = float(np.abs(sizes).max(initial=0.0))
    if largest == 0.0:
        return
    reach = 0.45 * np.sqrt(areas_of(results, results.vertices(frame)))
    arm = (reach[:, None] * np.abs(sizes) / largest)[..., None]
    arm = arm * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    middle = _centres(results, frame)[:, None]
    lines = np.stack([middle - arm, middle + arm], axis=2)
    for colour, own in ((PRESSED, sizes < 0.0), (PULLED, sizes > 0.0)):
        axes.add_collection(
            LineCollection(list(lines[own]), colors=colour, linewidths=1.1, zorder=4.7)
        )


# Displacements -----------------------------------------------------------------------------------


def _vector_handles(results: Recording, frame: int) -> list[Any]:
    largest = float(np.hypot(*results.field("displacement", frame).T).max(initial=0.0))
    return [_line(MOVED, _up_to("displacement", largest, "m"))] if largest > 0.0 else []


def _draw_vectors(axes: Axes, results: Recording, frame: int) -> None:
    """Draw the displacement of each block as an arrow that ends where the block is."""
    moved = results.field("displacement", frame)
    there = ~absent_in_frame(results, frame)
    largest = float(np.hypot(*moved[there].T).max(initial=0.0))
    if largest == 0.0:
        return
    shown = min(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
    # as they are where they can be seen, else enlarged
    scale = max(1.0, LONGEST * float(shown) / largest)
    arrow = scale * moved[there]
    at = _centres(results, frame)[there] - 0.5 * arrow
    axes.quiver(
        *at.T,
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


def _reference(results: Recording, frame: int) -> Floats:
    """Return the vertices that displacements of a frame count from, m, (nv, 2)."""
    since = 0
    for event in results.events:
        if event.kind == "displacements reset":
            last = results.frame(-1, stage=event.stage).number
            since = last if last < frame else since
    return results.vertices(since)


def _levels(results: Recording, frame: int) -> tuple[Floats, float, str]:
    """Return the levels of displacement, their factor from metres, and their unit."""
    from matplotlib.ticker import MaxNLocator

    moved = results.vertices(frame) - _reference(results, frame)
    there = np.repeat(~absent_in_frame(results, frame), np.diff(results.block_start))
    largest = float(np.hypot(*moved[there].T).max(initial=0.0))
    if largest == 0.0:
        return np.zeros(0), 1.0, "m"
    factor, unit = prefixed(largest, "m")
    levels = np.asarray(MaxNLocator(LEVELS).tick_values(0.0, factor * largest))
    return levels[(levels > 0.0) & (levels < factor * largest)], factor, unit


def _level_handles(results: Recording, frame: int) -> list[Any]:
    levels, _, unit = _levels(results, frame)
    if not len(levels):
        return []
    return [_line(INK, f"equal displacement, every {levels[0]:g} {unit}", 0.8)]


def _draw_levels(axes: Axes, results: Recording, frame: int) -> None:
    """Draw lines of equal displacement within blocks, with their values."""
    from matplotlib.patheffects import Normal, Stroke
    from matplotlib.tri import Triangulation

    here = results.vertices(frame)
    size = np.hypot(*(here - _reference(results, frame)).T)
    levels, factor, unit = _levels(results, frame)
    corners = _triangles(results, here, frame)
    if not len(levels) or not len(corners):
        return
    drawn = axes.tricontour(
        Triangulation(here[:, 0], here[:, 1], corners),
        factor * size,
        levels,
        colors=INK,
        linewidths=0.7,
        zorder=4,
    )
    numbers = axes.clabel(drawn, fontsize=SMALL_SIZE, fmt=lambda level: f"{level:g} {unit}")
    for number in numbers:
        # above bolts and lines, and to be read on them
        number.set(zorder=9, path_effects=[Stroke(linewidth=2.0, foreground="white"), Normal()])


def _triangles(results: Recording, here: Floats, frame: int) -> Any:
    """Return triangles (k, 3) of the vertices of the blocks that are there."""
    import shapely

    absent = absent_in_frame(results, frame)
    found = []
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
                found.append([place[tuple(point)] for point in ring])
    return np.array(found, np.int64).reshape(-1, 3)


LAYERS = {
    "chains": StillLayer(_chain_handles, _draw_chains),
    "crosses": StillLayer(_cross_handles, _draw_crosses),
    "vectors": StillLayer(_vector_handles, _draw_vectors),
    "levels": StillLayer(_level_handles, _draw_levels),
    **{
        name: StillLayer(handles_of_diagram(one), drawing_of(one)) for name, one in DIAGRAMS.items()
    },
}
"""Name of a layer, as ``Look.layers`` has it -> the layer."""


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
