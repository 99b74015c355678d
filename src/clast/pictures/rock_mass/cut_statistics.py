"""The statistics of a cut on one sheet: directions of joints, areas of blocks, lengths of edges."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE, TEXT
from clast.pictures.fields import round_below
from clast.pictures.rock_mass.section import counted, edges_of_cut
from clast.pictures.strokes import DASHES, EdgeGroup, following
from clast.rockmass import Cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

SECTOR = 5.0
"""Width of the sectors of the rose, degrees; they are centred on its multiples."""
PANEL = (4.1, 3.2)
"""Width and height of a panel, inches."""
HATCHES = (None, "////", "....")
"""Hatching of joints that are drawn as DASHES says."""
BAR = "#9db7c9"
"""Colour of the bars of histograms."""
LIMIT = "#b3261e"
"""Colour of the limits below which edges are collapsed and blocks merged."""


def plot_cut_statistics(cut: Cut, path: Path | str, *, title: str = "") -> Path:
    """Draw a rose of directions and histograms of areas and lengths; return the picture's path.

    The rose has the directions of the joints between blocks, weighted by length, by set;
    directions are degrees counter-clockwise from +x, and a line points both ways.  Lengths are
    those of the edges of all blocks, so that those inside count twice, as in the report.
    CaseError where the picture cannot be written.
    """
    return canvas.save(statistics_figure(cut, title=title), Path(path))


def statistics_figure(cut: Cut, *, title: str) -> Figure:
    """Return the picture of ``plot_cut_statistics``."""
    joints = edges_of_cut(cut, "set").joints
    report = cut.report
    handles = _handles(joints, (report.smallest_block, report.smallest_edge))
    count = counted(cut)
    about = (
        f"{report.area:.6g} m²; {report.merged.count:,} blocks merged, "
        f"{report.collapsed.count:,} edges collapsed"
    )
    head, below = (title, f"{count}, {about}") if title else (count, about)
    width = 3 * PANEL[0]
    keys = canvas.Keys(handles, width - 2 * canvas.LEFT)
    sheet = canvas.sheet_for((width - canvas.LEFT - canvas.RIGHT, PANEL[1]), head, keys.lines, 0)
    figure = canvas.new_figure(sheet.size, 160)
    canvas.head(figure, sheet.axes[0], sheet.title, below)
    bottom, across = sheet.axes[1], PANEL[0]
    rose: Any = figure.add_axes(
        sheet.parts((0.35, bottom - 0.1, across - 0.7, PANEL[1] - 0.4)), projection="polar"
    )
    _draw_rose(rose, joints)
    areas = draw_blocks.areas_of(cut, cut.vertices)
    lengths = np.hypot(*(cut.vertices[following(cut.block_start)] - cut.vertices).T)
    panels = (
        (areas, "Area of block", "Blocks", report.smallest_block, "m²"),
        (lengths, "Length of edge", "Edges of blocks", report.smallest_edge, "m"),
    )
    for number, (values, label, counted_things, limit, unit) in enumerate(panels, 1):
        box = (number * across + canvas.LEFT, bottom, across - canvas.LEFT - 0.2, PANEL[1] - 0.3)
        axes = figure.add_axes(sheet.parts(box))
        _draw_histogram(axes, values, limit, unit)
        axes.set_xlabel(f"{label} ({unit})", **TEXT)
        axes.set_ylabel(counted_things, **TEXT)
    keys.draw(figure, sheet)
    return figure


def _handles(joints: Sequence[EdgeGroup], limits: Sequence[float]) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(fc=one.stroke.colour, ec="white", hatch=_hatch(one), label=one.stroke.label)
        for one in joints
    ]
    if max(limits) > 0.0:
        line = Line2D([], [], color=LIMIT, ls="--", lw=1.2, label="limit: smaller ones go")
        handles.append(line)
    return handles


def _hatch(one: EdgeGroup) -> str | None:
    """Return the hatching of a joint whose colour another one has, too."""
    return HATCHES[DASHES.index(one.stroke.dashes)]


def sectors(joints: Sequence[EdgeGroup]) -> Floats:
    """Return the length of each joint by direction, m, shape (joints, 180/SECTOR).

    Directions go from 0 to 180 degrees, counter-clockwise from +x; the first sector is about 0.
    """
    count = round(180.0 / SECTOR)
    lengths = np.zeros((len(joints), count))
    for row, one in zip(lengths, joints, strict=True):
        along = one.ends[:, 1] - one.ends[:, 0]
        angle = np.degrees(np.arctan2(along[:, 1], along[:, 0]))
        sector = np.round(angle / SECTOR).astype(np.int64) % count
        np.add.at(row, sector, one.lengths)
    return lengths


def _draw_rose(axes: PolarAxes, joints: Sequence[EdgeGroup]) -> None:
    """Draw the share of the length in each direction, one joint upon the other."""
    # areas are as the lengths, not radii, or the largest set would hide the others
    length = sectors(joints)
    share = 100.0 * length / max(float(length.sum()), 1e-300)
    middle = np.radians(SECTOR * np.arange(share.shape[1]))
    outer = np.cumsum(share, axis=0)
    for one, low, high in zip(joints, np.sqrt(outer - share), np.sqrt(outer), strict=True):
        axes.bar(
            np.concatenate([middle, middle + np.pi]),
            np.tile(high - low, 2),
            width=np.radians(SECTOR),
            bottom=np.tile(low, 2),
            color=one.stroke.colour,
            edgecolor="white",
            linewidth=0.0,
            hatch=_hatch(one),
            label=one.stroke.label,
            zorder=3,
        )
    whole = share.sum(axis=0)
    top = max(float(whole.max(initial=0.0)), 1.0)
    upper = round_below(top)
    rings = np.array([upper / 5.0, upper])[: 2 * len(joints)]
    # numbers stand where there is the least around
    near = sum(np.roll(whole, k) / (1.0 + abs(k)) for k in range(-3, 4))
    emptiest = np.radians(SECTOR * float(np.argmin(near)))
    axes.set_ylim(0.0, 1.05 * np.sqrt(top))
    axes.set_yticks(np.sqrt(rings), ["" for _ in rings])
    for ring in rings:
        canvas.write(axes, f"{ring:g} %", (emptiest, np.sqrt(ring)), 5)
    axes.set_thetagrids(range(0, 360, 30), [f"{angle % 180}°" for angle in range(0, 360, 30)])
    axes.tick_params(labelsize=SMALL_SIZE, labelcolor=INK, pad=1)
    axes.grid(color="#d9d9d9", lw=0.5)
    axes.spines["polar"].set_color(FAINT)
    axes.spines["polar"].set_linewidth(0.6)
    axes.set_axisbelow(True)
    title = "Length of joints by direction, %" if joints else "No joints between blocks"
    axes.set_title(title, pad=10, **TEXT)


def _draw_histogram(axes: Axes, values: Floats, limit: float, unit: str) -> None:
    """Draw how often sizes (n,) > 0 occur, with the limit below which there should be none."""
    low, high = float(values.min()), float(values.max())
    if high > 30.0 * low:
        axes.set_xscale("log")
        bins = np.geomspace(low, high * (1 + 1e-9), 25)
    else:
        bins = np.linspace(0.0, 1.03 * high, 25)
    axes.hist(values, bins=bins.tolist(), color=BAR, edgecolor="white", linewidth=0.4, zorder=2)
    median = float(np.median(values))
    axes.axvline(median, color=INK, lw=1.0, zorder=3)
    if limit > 0.0:
        axes.axvline(limit, color=LIMIT, lw=1.2, ls="--", zorder=3, label="limit")
        _name(axes, limit, f"limit {limit:.3g} {unit}", LIMIT, 0.92)
    _name(axes, median, f"median {median:.3g} {unit}", INK, 0.99)
    axes.set_ylim(0.0, 1.2 * axes.get_ylim()[1])
    axes.locator_params(axis="y", integer=True)
    axes.grid(axis="y", color="#e2e2e2", lw=0.5)
    canvas.label_logarithms(axes)
    canvas.style(axes)


def _name(axes: Axes, at: float, text: str, colour: str, height: float) -> None:
    """Write a label beside an upright line, on the side where there is room."""
    share = axes.transAxes.inverted().transform(axes.transData.transform((at, 0.0)))[0]
    side = 1 if share < 0.55 else -1
    axes.annotate(
        text,
        (at, height),
        xycoords=axes.get_xaxis_transform(),
        xytext=(3 * side, 0),
        textcoords="offset points",
        fontsize=SMALL_SIZE,
        color=colour,
        ha={1: "left", -1: "right"}[side],
        va="top",
        zorder=4,
    )
