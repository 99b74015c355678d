"""The section: blocks by their rocks, edges by their joints, openings and voids hatched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Bools, Floats
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import FAINT, INK
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.strokes import (
    CONSTRUCTED,
    GROUND,
    WELD,
    EdgeGroup,
    Stroke,
    draw_edges,
    following,
    groups,
    handles_of,
    label,
    partners,
    strokes_of,
)
from clast.rockmass import Cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PLAIN = Stroke(label="joints", colour=INK, width=0.7)
RIM = Stroke(label="boundary", colour=INK, width=1.5, above=3)


@dataclass(frozen=True, kw_only=True)
class CutEdges:
    """All edges of a cut, each once."""

    joints: tuple[EdgeGroup, ...]
    """Those of each set or joint that has some, then those along which no joint is named."""
    others: tuple[EdgeGroup, ...]
    """Welds, construction joints, and the rim where only one block is."""

    @property
    def rim(self) -> Floats:
        """Edges with rock on their left only, m, shape (n, 2, 2)."""
        return next((one.ends for one in self.others if one.stroke is RIM), np.zeros((0, 2, 2)))


def edges_of_cut(cut: Cut, by: str = "joint") -> CutEdges:
    """Return the edges of a cut, those inside once, by "joint" or by "set"."""
    after = following(cut.block_start)
    ends = np.stack([cut.vertices, cut.vertices[after]], axis=1)
    partner = partners(cut.vertices, after)
    once = (partner < 0) | (np.arange(len(partner)) < partner)
    strokes = strokes_of(dict(enumerate(cut.joint_names)))
    others, number = (CONSTRUCTED, WELD), cut.edge_joint
    if by == "set":
        # welds and construction joints are of no set
        welds = {k: stroke for k, stroke in strokes.items() if stroke in others}
        count = len(cut.joint_names)
        number = np.where(np.isin(number, [*welds]), number, count + cut.edge_set)
        sets = {count + k: name for k, name in enumerate(cut.set_names)}
        strokes = {**strokes_of(sets), **welds}
    rim = max(strokes, default=0) + 1
    edges = groups({**strokes, rim: RIM}, np.where(partner < 0, rim, number)[once], ends[once])
    return CutEdges(
        joints=tuple(one for one in edges if one.stroke not in (*others, RIM)),
        others=tuple(one for one in edges if one.stroke in (*others, RIM)),
    )


OPENING_HATCH, VOID_HATCH = "....", "\\\\\\\\"
"""Hatching of rock that a stage excavates, and of voids."""
BY = {"set": "edges by joint set", "joint": "edges by joint", "rock": "blocks by rock"}
"""The meanings of the colours, and their captions."""


def plot_cut(
    cut: Cut, path: Path | str, *, by: str = "set", title: str = "", look: Look = DEFAULT
) -> Path:
    """Draw the blocks of a cut coloured by ``by`` and return the picture's path.

    ``by`` is "set" (edges in the colours of the sets and traces that cut them), "joint" (in those
    of their joints) or "rock" (blocks in those of their rocks).  Construction joints are dashed,
    welds dotted, rock of openings and voids hatched.  ``look`` has size, resolution and the part
    that is shown.  The format follows from the ending of ``path``.  Raises CaseError for a cut that
    is not there, or that cannot be drawn or written.
    """
    return canvas.save(cut_figure(cut, by=by, title=title, look=look), Path(path))


def cut_figure(cut: Cut, *, by: str, title: str, look: Look) -> Figure:
    """Return the picture of ``plot_cut``."""
    canvas.check_installed()
    if by not in BY:
        raise CaseError(
            f"there is no picture of a cut by '{by}'",
            where="by",
            remedy=spelling.advice(by, BY, kind="choice"),
        )
    if look.limits is not None:
        raise CaseError(
            "the colours of a cut are names, so limits do not apply",
            where="limits",
            remedy="leave them out",
        )
    edges = edges_of_cut(cut, by)
    joints, fills = edges.joints, [GROUND] * len(cut.rock_names)
    if by == "rock":
        ends = [one.ends for one in joints]
        joints = (EdgeGroup(ends=np.concatenate(ends), stroke=PLAIN),) if ends else ()
        fills = [draw_blocks.kind_colour(k) for k in range(len(cut.rock_names))]
    strokes = (*joints, *edges.others)
    part = _part(cut, look)
    shown = draw_blocks.within(cut, cut.vertices, *part)
    # The voids that the rim (n, 2, 2) encloses; rock lies on its left.
    rock = {(*first, *last) for first, last in edges.rim.tolist()}
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(edges.rim)))
    voids = []
    for face in faces:
        corners = shapely.get_coordinates(shapely.orient_polygons(face).exterior)
        if (*corners[0], *corners[1]) not in rock:
            voids.append(face)
    count = counted(cut)
    head, below = (title, f"{count}, {BY[by]}") if title else (count, BY[by])
    rocks, hatched = _handles(cut, fills, shown, part, voids)
    handles = [*(rocks if by == "rock" else ()), *handles_of(strokes, part), *hatched]
    sheet, keys = canvas.lay_out(part, look, head, handles, 0)
    part = canvas.seen(*part, sheet.room)
    number = int(shown.sum())
    figure = canvas.new_figure(sheet.size, look.dpi or canvas.dots_for(number))
    axes = figure.add_axes(sheet.parts(sheet.axes))
    canvas.view(axes, *part, sheet.room)
    canvas.head(figure, sheet.axes[0], sheet.title, below)
    _draw_blocks(axes, cut, fills, draw_blocks.within(cut, cut.vertices, *part))
    for void in voids:
        _hatch(axes, void, VOID_HATCH, zorder=1, label="void")
    draw_edges(axes, strokes, part, number)
    _draw_names(axes, cut, part)
    keys.draw(figure, sheet)
    return figure


def counted(cut: Cut) -> str:
    """Return how many blocks there are, in words."""
    return f"{cut.block_count:,} block{'s' if cut.block_count > 1 else ''}"


def _part(cut: Cut, look: Look) -> canvas.Part:
    """Return the part to show: all blocks, or the given part."""
    low, high = cut.vertices.min(axis=0), cut.vertices.max(axis=0)
    if look.zoom is None:
        return low, high
    part = np.array(look.zoom[:2]), np.array(look.zoom[2:])
    if not draw_blocks.within(cut, cut.vertices, *part).any():
        raise canvas.empty_part(low, high)
    return part


def _handles(
    cut: Cut, fills: Sequence[str], shown: Bools, part: canvas.Part, voids: Sequence[Any]
) -> tuple[list[Any], list[Any]]:
    """Return the legend of rocks, and that of openings and voids."""
    from matplotlib.patches import Patch

    rocks = [
        Patch(fc=fills[rock], ec=INK, lw=0.5, label=label(cut.rock_names[rock]))
        for rock in np.unique(cut.rock[shown])
    ]
    handles = []
    if (cut.opening[shown] >= 0).any():
        name = "opening, not excavated yet"
        handles.append(Patch(fc="none", ec=FAINT, hatch=OPENING_HATCH, lw=0.5, label=name))
    if any(shapely.box(*part[0], *part[1]).intersects(one) for one in voids):
        handles.append(Patch(fc="white", ec=FAINT, hatch=VOID_HATCH, lw=0.5, label="void"))
    return rocks, handles


def _draw_blocks(axes: Axes, cut: Cut, fills: Sequence[str], shown: Bools) -> None:
    """Fill the rocks and hatch the openings, each as one area: blocks one by one take long."""
    for rock in np.unique(cut.rock[shown]):
        area = _area(cut, shown & (cut.rock == rock))
        name = f"rock: {cut.rock_names[rock]}"
        _fill(axes, area, facecolor=fills[rock], linewidth=0.0, zorder=2, label=name)
    for opening in np.unique(cut.opening[shown & (cut.opening >= 0)]):
        area = _area(cut, shown & (cut.opening == opening))
        name = f"opening: {cut.opening_names[opening]}"
        _hatch(axes, area, OPENING_HATCH, zorder=3, label=name)


def _area(cut: Cut, some: Bools) -> Any:
    """Return the union of blocks: they share their nodes to the last digit."""
    owner = np.repeat(np.arange(cut.block_count), np.diff(cut.block_start))
    inside = some[owner]
    number = np.cumsum(some) - 1
    rings = shapely.linearrings(cut.vertices[inside], indices=number[owner[inside]])
    return shapely.coverage_union_all(shapely.polygons(rings))


def _hatch(axes: Axes, area: Any, hatch: str, **words: Any) -> None:
    _fill(axes, area, facecolor="none", edgecolor=FAINT, hatch=hatch, linewidth=0.0, **words)


def _fill(axes: Axes, area: Any, **words: Any) -> None:
    """Draw a polygon or several, with their holes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    rings = shapely.get_rings(shapely.orient_polygons(shapely.get_parts(area)))
    outlines = [Outline(shapely.get_coordinates(ring), closed=True) for ring in rings]
    axes.add_patch(PathPatch(Outline.make_compound_path(*outlines), **words))


def _draw_names(axes: Axes, cut: Cut, part: canvas.Part) -> None:
    """Write the names of openings into their rock, where they are few."""
    owner = np.repeat(cut.opening, np.diff(cut.block_start))
    some = np.unique(cut.opening[cut.opening >= 0])
    # Openings that get their names written into them
    for opening in some if len(some) <= 12 else ():
        corners = cut.vertices[owner == opening]
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        if ((middle >= part[0]) & (middle <= part[1])).all():
            canvas.write(axes, label(cut.opening_names[opening]), middle, 9)
