"""A picture of blocks with their numbers and names, by which a case refers to them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
import shapely

from clast.model.arrays import Floats, polygons_of
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import INK
from clast.pictures.draw_blocks import Divided
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.strokes import GROUND

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LETTER_SIZES = (1.0, 8.0)
"""Smallest and largest letters, points: smaller ones are read by zooming into a vector picture."""


class Corners(Divided, Protocol):
    """Blocks whose outlines are known: those of a drawing, of a cut."""

    @property
    def vertices(self) -> Floats:
        """Vertices of all blocks, m, shape (nv, 2)."""
        ...


def plot_block_names(
    blocks: Corners,
    path: Path | str,
    *,
    names: Sequence[str] = (),
    title: str = "",
    look: Look = DEFAULT,
) -> Path:
    """Draw blocks with their numbers from 1 and their names, and return the picture's path.

    ``names`` (nb,) are written behind the numbers where they differ from them.  The format follows
    from the ending of ``path``; in .svg and .pdf the letters of small blocks stay legible.  Raises
    CaseError where nothing can be drawn or written.
    """
    numbers = [str(k) for k in range(1, len(blocks.block_start))]
    labels = [
        number if name == number else f"{number} {name}"
        for number, name in zip(numbers, names or numbers, strict=True)
    ]
    return canvas.save(_figure(blocks, labels, title, look), Path(path))


def _figure(blocks: Corners, labels: Sequence[str], title: str, look: Look) -> Figure:
    """Return the picture of ``plot_block_names``."""
    canvas.check_installed()
    from matplotlib.collections import PolyCollection

    vertices = np.asarray(blocks.vertices)
    part = vertices.min(axis=0), vertices.max(axis=0)
    below = f"{len(labels):,} block{'s' * (len(labels) > 1)}: numbers and names"
    sheet, _ = canvas.lay_out(part, look, title or below, [], 0)
    part = canvas.seen(*part, sheet.room)
    figure = canvas.new_figure(sheet.size, look.dpi or max(canvas.dots_for(len(labels)), 200))
    axes = figure.add_axes(sheet.parts(sheet.axes))
    canvas.view(axes, *part, sheet.room)
    canvas.head(figure, sheet.axes[0], sheet.title, below if title else "")
    outlines = draw_blocks.outlines_of(blocks, vertices)
    axes.add_collection(PolyCollection(outlines, fc=GROUND, ec=INK, lw=0.4))
    points_per_metre = 72.0 * sheet.room[0] / float(part[1][0] - part[0][0])
    polygons = polygons_of(vertices, np.asarray(blocks.block_start))
    # the largest circle in each block: letters of its width stay inside
    spans = shapely.maximum_inscribed_circle(polygons)
    centroids = shapely.centroid(polygons)
    inside = shapely.covers(polygons, centroids)[:, None]
    circles = shapely.get_coordinates(spans).reshape(-1, 2, 2)[:, 0]
    middles = np.where(inside, shapely.get_coordinates(centroids), circles)
    for label, middle, radius in zip(labels, middles, shapely.length(spans), strict=True):
        room = 2.0 * float(radius) * points_per_metre
        # Width of a letter over its size
        size = float(np.clip(room / (0.6 * len(label)), *LETTER_SIZES))
        x, y = middle.tolist()
        one = axes.text(x, y, canvas.literal(label), ha="center", va="center", fontsize=size)
        one.set(color=INK, clip_on=True)
    return figure
