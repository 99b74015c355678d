"""Figures of the verification problems: the set-up, and computed values against exact curves."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clast.model.ground_motion import Still
from clast.model.model import Floats, Model
from clast.model.water import faces_of_joints, surface_at, wetted
from clast.pictures.canvas import LEGEND, TEXT, style
from clast.pictures.charts import Chart, Curve, curve, draw_chart, exact_curve, merged
from clast.pictures.draw_water import BLUE
from clast.pictures.forces import keep_apart
from clast.pictures.strokes import following
from clast.pictures.supports import LINK_COLOURS, draw_links_at_start

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Chart", "Curve", "curve", "draw_problem", "exact_curve"]

ROCK, FIXED, OUTLINE = "#e6dccb", "#b7aea1", "#4a443c"
"""Colours of free blocks, fixed blocks and their outlines."""
ARROW = "#c1440e"
"""Colour of loads and velocities."""
SUPPORT = LINK_COLOURS["intact"]
"""Colour of bolts and links."""
SET_UP, CHART, HIGH = 2.3, 2.9, 2.4
"""Width of the set-up and of a chart, and their height, inches."""
KEY, LETTER, LINE = 0.5, 0.062, 0.175
"""Width of a line in a legend, width of a letter and height of a line of text, inches."""
CROWD, ROOM, LEAST = 12, 0.12, 3
"""Arrows all drawn; of more, how far apart they are, in widths of the set-up, and how many at least
tell something."""
MANY, FLAT = 100, 5.0
"""Blocks with thin lines: so many, or as flat as this, points."""
LONGEST, BAR = 0.18, 0.06
"""Lengths of the longest arrow and of half a link's bar, in widths of the set-up."""
FAR, TOUCH = 1.25, 1e-6
"""Distance from free blocks beyond which fixed ones are left out, and of blocks that touch, in
widths of the free ones."""


def draw_problem(set_up: Model, charts: Sequence[Chart], path: Path) -> None:
    """Draw the set-up and, beside it, the charts one below the other into a picture."""
    from PIL import Image

    buffer = BytesIO()
    figure_of(set_up, merged(charts)).savefig(buffer, dpi=150, format="png")
    picture = Image.open(buffer).convert("RGB")
    # a palette takes a third of the size of full colours; the median cut would give thin marks the
    # grey of their neighbours; without the means the largest coverage would tinge the blocks
    few = picture.quantize(160, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


def figure_of(set_up: Model, charts: Sequence[Chart]) -> Figure:
    """Return the figure of a set-up and its charts, with legends beside them that cover nothing."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    longest = max((len(one.label) for chart in charts for one in chart.curves), default=0)
    heights = [max(HIGH, LINE * (2 + len(chart.curves))) for chart in charts] or [HIGH]
    widths = [SET_UP, CHART + KEY + LETTER * longest] if charts else [SET_UP]
    figure = Figure(figsize=(sum(widths), sum(heights)), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        len(heights), len(widths), width_ratios=widths, height_ratios=heights
    )
    draw_set_up(figure.add_subplot(grid[0, 0]), set_up)
    for row, chart in enumerate(charts):
        axes = figure.add_subplot(grid[row, 1])
        draw_chart(axes, chart)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0, **LEGEND)
    return figure


def draw_set_up(axes: Axes, model: Model) -> None:
    """Draw the blocks at the start with their supports, loads and velocities."""
    from matplotlib.patches import Polygon

    drawn = _in_sight(model)
    corners = np.concatenate([model.polygon(block) for block in drawn])
    width, height = np.ptp(corners, axis=0)
    size = float(max(width, height))
    # thin outlines where blocks are many, or flat in the picture
    flat = float(np.median([np.ptp(model.polygon(block), axis=0).min() for block in drawn]))
    is_crowded = model.block_count >= MANY or flat * 72.0 * SET_UP / size <= FLAT
    for block in drawn:
        fixed = bool(model.fixed[block])
        patch = Polygon(
            model.polygon(block),
            closed=True,
            fc=FIXED if fixed else ROCK,
            ec=OUTLINE,
            lw=0.3 if is_crowded else 0.8,
            hatch="///" if fixed else None,
        )
        axes.add_patch(patch)
    held = model.fixed_points.at + model.origin
    if len(held):
        # without a point an artist that is not clipped would ask for room at the edge of the figure
        axes.plot(held[:, 0], held[:, 1], "^", color=OUTLINE, ms=6, clip_on=False)
    moving = np.flatnonzero(np.hypot(*model.velocity[:, :2].T) > 0.0)
    centres = np.reshape([model.polygon(int(block)).mean(axis=0) for block in moving], (-1, 2))
    _draw_arrows(axes, *_loads(model), LONGEST * size)
    _draw_arrows(axes, centres, model.velocity[moving, :2], LONGEST * size)
    _draw_spins(axes, model)
    _draw_ground_motion(axes, model, size)
    _draw_water(axes, model, float(corners[:, 0].min()), float(corners[:, 0].max()))
    for bolt in range(len(model.bolts)):
        points = model.bolts.at[model.bolts.bolt == bolt] + model.origin
        axes.plot(*points.T, "-", color=SUPPORT, lw=1.3)
        axes.plot(*points[0], "o", color=SUPPORT, ms=3.0)
    draw_links_at_start(axes, model.link_lines, BAR * size)
    axes.set_aspect("equal")
    axes.margins(0.12)
    axes.autoscale_view()
    # numbers beside each other take more room than above each other
    axes.locator_params(axis="x", nbins=max(1, min(3, round(3 * width / height))))
    upright = max(1, min(6, int(6 * height / width)))
    axes.locator_params(axis="y", nbins=upright, min_n_ticks=min(2, upright))
    axes.set_title("set-up (m)", **TEXT)
    style(axes)
    if height < 0.1 * width:
        axes.set_yticks([])  # no room for numbers
    if width < 0.4 * height:
        axes.set_xticks([])


def _draw_water(axes: Axes, model: Model, low: float, high: float) -> None:
    """Draw water levels from one x to another, m; where joints alone are wet, these."""
    after = following(model.block_start)
    for water in model.water:
        face, _ = faces_of_joints(water.joints, model.vertices, after)
        wet = list(wetted(water.surface, face).ends)
        if len(water.faces.edge):
            left, right = low - model.origin[0], high - model.origin[0]
            x = np.unique(np.clip([left, right, *water.surface[:, 0]], left, right))
            wet = [np.stack([x, surface_at(water.surface, x)], axis=1)]
        for line in wet:
            axes.plot(*(line + model.origin).T, color=BLUE, lw=1.2)
        ends = np.concatenate(wet) + model.origin
        axes.plot(*ends[np.argmax(ends[:, 1])], "v", ms=5.0, mfc="white", mec=BLUE, mew=0.9)


def _in_sight(model: Model) -> list[int]:
    """Return the blocks of a set-up, without fixed ones that are far away and hold no bolt."""
    low, high = (
        np.array([end(model.polygon(block), axis=0) for block in range(model.block_count)])
        for end in (np.min, np.max)
    )
    kept = ~model.fixed.astype(bool)
    if not kept.any():
        return list(range(model.block_count))
    size = float((high[kept].max(axis=0) - low[kept].min(axis=0)).max())
    reach, before = FAR * size, 0  # what touches one that is near is near, as parts of a floor
    kept[model.bolts.block] = True
    while np.count_nonzero(kept) > before:
        before = int(np.count_nonzero(kept))
        first, last = low[kept].min(axis=0) - reach, high[kept].max(axis=0) + reach
        kept |= ((low <= last) & (high >= first)).all(axis=1)
        reach = TOUCH * size
    return np.flatnonzero(kept).tolist()


def _loads(model: Model) -> tuple[Floats, Floats]:
    """Return places and forces of all loads; line loads and pressures act in three places each."""
    points, lines, loads = model.point_loads, model.line_loads, model.pressures
    thirds = (1 / 6, 1 / 2, 5 / 6)
    at = [points.at, *(lines.start + share * (lines.end - lines.start) for share in thirds)]
    pushes = [points.force, *3 * [lines.traction]]
    after = loads.edge + 1
    after = np.where(
        after < model.block_start[loads.block + 1], after, model.block_start[loads.block]
    )
    first, along = model.vertices[loads.edge], model.vertices[after] - model.vertices[loads.edge]
    inwards = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    for place in thirds:
        share = (1.0 - place) * loads.share[:, 0] + place * loads.share[:, 1]
        pressure = (1.0 - place) * loads.pressure[:, 0] + place * loads.pressure[:, 1]
        at.append(first + share[:, None] * along)
        pushes.append(pressure[:, None] * inwards)
    return np.concatenate(at) + model.origin, np.concatenate(pushes)


def _draw_spins(axes: Axes, model: Model) -> None:
    """Draw a bent arrow in every block that only turns at the start."""
    still = np.hypot(*model.velocity[:, :2].T) == 0.0
    for block in np.flatnonzero(still & (model.velocity[:, 2] != 0.0)):
        centre = model.polygon(int(block)).mean(axis=0)
        arm = 0.2 * np.sqrt(model.area[block])
        bend = np.sign(model.velocity[block, 2])
        axes.annotate(
            "",
            (centre[0] - arm, centre[1]),
            (centre[0] + arm, centre[1]),
            arrowprops={
                "arrowstyle": "-|>",
                "color": ARROW,
                "lw": 1.4,
                "connectionstyle": f"arc3,rad={0.9 * bend}",
            },
        )


def _draw_ground_motion(axes: Axes, model: Model, size: float) -> None:
    """Draw a double arrow below the blocks where the ground moves."""
    if isinstance(model.ground_motion, Still):
        return
    corners = model.vertices + model.origin
    middle = 0.5 * (corners[:, 0].min() + corners[:, 0].max())
    below = corners[:, 1].min() - 0.1 * size
    half = 0.15 * size
    axes.annotate(
        "",
        (middle + half, below),
        (middle - half, below),
        arrowprops={"arrowstyle": "<|-|>", "color": ARROW, "lw": 1.4},
    )
    axes.plot((middle - half, middle + half), 2 * [below], color=ARROW, lw=0.5)


def _draw_arrows(axes: Axes, at: Floats, vectors: Floats, length: float) -> None:
    """Draw vectors (k, 2) at (k, 2), the longest with a length; of many those that have room."""
    largest = np.hypot(*vectors.T).max(initial=0.0)
    if largest == 0.0:
        return
    if len(at) > CROWD:
        kept = keep_apart(at, np.hypot(*vectors.T), ROOM / LONGEST * length)
        if len(kept) < LEAST:  # all about one place, as in a small hole
            return
        at, vectors = at[kept], vectors[kept]
    # an arrow that would run into the picture ends at its place instead of starting there
    arrows = vectors * length / largest
    middle = at.mean(axis=0)
    inwards = np.sum((middle - at) * arrows, axis=1) > 1e-9 * length**2
    for (x, y), (dx, dy) in zip(at - inwards[:, None] * arrows, arrows, strict=True):
        axes.annotate(
            "",
            (x + dx, y + dy),
            (x, y),
            arrowprops={"arrowstyle": "-|>", "color": ARROW, "lw": 1.0, "mutation_scale": 7.0},
        )
        # both ends count for the limits of the axes
        axes.plot((x, x + dx), (y, y + dy), color=ARROW, lw=0.5)
