"""Edges in the colours of their joints: how they look, which are drawn once, how they are drawn."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GROUND = "#f3efe6"
"""Fill of blocks where their edges have the colours."""
JOINT_COLOURS = ("#d55e00", "#009e73", "#aa4499", "#e69f00", "#882255", "#7a6a00", "#d6708b")
"""Colours of joints, told apart by most eyes (after Okabe and Ito, and Tol); water is blue."""
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1.5, 1)))
"""Lines of the first seven joints, of the next seven, and of all others."""
NAME_LETTERS_MAX = 40
"""Letters of a name in a legend."""
THINNEST, THICKEST, THINNEST_ABOVE = 0.15, 1.3, 0.5
"""Widths of edges, and of lines above the joints at least, points."""


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """How a group of edges is drawn."""

    label: str
    """Its text in the legend."""
    colour: str
    dashes: Any = "-"
    """Line style, as matplotlib has it."""
    width: float = 1.0
    """Width as a share of that of joints."""
    above: int = 0
    """Place in the order of drawing: higher ones lie above."""


@dataclass(frozen=True, kw_only=True)
class EdgeGroup:
    """Edges that are drawn alike."""

    ends: Floats
    """Their ends, m, shape (n, 2, 2)."""
    stroke: Stroke
    """How they are drawn."""

    @property
    def lengths(self) -> Floats:
        """Their lengths, m, shape (n,)."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))


UNNAMED = Stroke(label="no joint named", colour="#6b6b6b", width=0.8)
CONSTRUCTED = Stroke(
    label="construction joint", colour=INK, dashes=(0, (2.2, 1.0)), width=1.8, above=2
)
WELD = Stroke(label="welded: no joint", colour=FAINT, dashes=(0, (1, 1.5)), width=0.8, above=1)


def strokes_of(names: Mapping[int, str]) -> dict[int, Stroke]:
    """Return how the edges of each joint are drawn, by its number, and under -1 those of none."""
    from clast.rockmass import CONSTRUCTION, WELDED  # slow to import: only who draws joints waits

    welds = {
        number: CONSTRUCTED if name.startswith(CONSTRUCTION) else WELD
        for number, name in names.items()
        if name.startswith(CONSTRUCTION) or name == WELDED
    }
    joints = [number for number in names if number not in welds]
    strokes = {}
    for place, number in enumerate(joints):
        row, column = divmod(place, len(JOINT_COLOURS))
        dashes = DASHES[min(row, len(DASHES) - 1)]
        name, colour = label(names[number]), JOINT_COLOURS[column]
        strokes[number] = Stroke(label=name, colour=colour, dashes=dashes)
    return {**strokes, -1: UNNAMED, **welds}


def label(name: str) -> str:
    """Return a name of the user's as a legend has it: short, and no formula."""
    whole = " ".join(name.split())
    return canvas.literal(
        whole
        if len(whole) <= NAME_LETTERS_MAX
        else textwrap.wrap(whole, NAME_LETTERS_MAX - 1)[0] + "…"
    )


def groups(strokes: Mapping[int, Stroke], number: Ints, ends: Floats) -> tuple[EdgeGroup, ...]:
    """Return the edges of each stroke that has some, from their numbers (n,) and ends (n, 2, 2)."""
    edges = []
    for stroke in dict.fromkeys(strokes.values()):
        alike = np.isin(number, [k for k, one in strokes.items() if one is stroke])
        if alike.any():
            edges.append(EdgeGroup(ends=ends[alike], stroke=stroke))
    return tuple(edges)


# Which edges there are ----------------------------------------------------------------------------


def following(start: Ints) -> Ints:
    """Return the index of the vertex after each one in its block, shape (nv,)."""
    after = np.arange(1, start[-1] + 1)
    after[start[1:] - 1] = start[:-1]
    return after


def partners(vertices: Floats, after: Ints) -> Ints:
    """Return the edge that runs back along each one, -1 where there is none, (nv,)."""
    # neighbours share their nodes to the last digit, as ``rockmass.cut`` makes them
    node = np.unique(vertices[:, 0] + 1j * vertices[:, 1], return_inverse=True)[1]
    here, there = node.astype(np.int64), node[after].astype(np.int64)
    count = np.int64(len(vertices))
    key, wanted = here * count + there, there * count + here
    order = np.argsort(key)
    at = np.minimum(np.searchsorted(key, wanted, sorter=order), len(key) - 1)
    nearest = order[at]
    return np.where(key[nearest] == wanted, nearest, -1)


def visible(ends: Floats, part: canvas.Part) -> Bools:
    """Return which edges (n, 2, 2) may be seen, shape (n,)."""
    low, high = part
    return np.asarray(((ends.max(axis=1) >= low) & (ends.min(axis=1) <= high)).all(axis=1))


def edges_by_joint(results: Recording, frame: int, apart: float) -> tuple[EdgeGroup, ...]:
    """Return the edges of all blocks that are there in a frame, in groups by joint.

    Edges of two blocks that ran along each other at the start are one as long as they are no
    farther ``apart`` than that, m, and of one joint.
    """
    joint, after, here = results.edge_joint, following(results.block_start), results.vertices(frame)
    ends = np.stack([here, here[after]], axis=1)
    other = partners(results.vertices(0), after)
    opened = np.hypot(*(ends - ends[other, ::-1]).T).max(axis=0) > apart
    single = (other < 0) | opened | (joint != joint[other])
    out = np.repeat(absent_in_frame(results, frame), np.diff(results.block_start))
    once = ~out & (single | out[other] | (np.arange(len(other)) < other))
    # joints that edges have alone get a colour, so that it is the same in all frames
    names = {number: results.joint_name[number] for number in np.unique(joint[joint >= 0]).tolist()}
    return groups(strokes_of(names), joint[once], ends[once])


# Drawing ------------------------------------------------------------------------------------------


def handles_of(edges: Sequence[EdgeGroup], part: canvas.Part) -> list[Any]:
    """Return the legend of the edges in a part."""
    from matplotlib.lines import Line2D

    return [
        Line2D([], [], color=s.colour, ls=s.dashes, lw=1.3 * max(1.0, s.width), label=s.label)
        for s in (one.stroke for one in edges if visible(one.ends, part).any())
    ]


def draw_edges(axes: Axes, edges: Sequence[EdgeGroup], part: canvas.Part, blocks: int) -> None:
    """Draw the edges of each kind in a part as one collection."""
    from matplotlib.collections import LineCollection

    seen = [(one, one.ends[visible(one.ends, part)]) for one in edges]
    seen = [(one, ends) for one, ends in seen if len(ends)]
    if not seen:
        return  # a part inside one block
    every = np.concatenate([ends for _, ends in seen])
    figure = axes.get_figure(root=True)
    inches = axes.get_position().width * (figure.get_size_inches()[0] if figure else 1.0)
    points = 72.0 * float(inches) / float(part[1][0] - part[0][0])
    median = float(np.median(np.hypot(*(every[:, 1] - every[:, 0]).T)))
    width = float(np.clip(0.1 * points * median, THINNEST, THICKEST))
    for one, ends in seen:
        stroke = one.stroke
        # Blocks above which pdf and svg hold edges as dots: thousands of lines make viewers slow
        axes.add_collection(
            LineCollection(
                _lines(ends),
                colors=stroke.colour,
                linestyles=[stroke.dashes],
                linewidths=max(width, THINNEST_ABOVE * (stroke.above > 0)) * stroke.width,
                capstyle="round" if stroke.dashes == "-" else "butt",
                joinstyle="round",
                rasterized=blocks > 5000 and stroke.above == 0,
                zorder=4 + stroke.above,
                label=stroke.label,
            )
        )


def _lines(ends: Floats) -> list[Floats]:
    """Return edges (n, 2, 2) strung together, each line (k, 2): fewer lines, and dashes run on."""
    import shapely

    merged = shapely.line_merge(shapely.multilinestrings(shapely.linestrings(ends)))
    return [shapely.get_coordinates(one) for one in shapely.get_parts(merged)]
