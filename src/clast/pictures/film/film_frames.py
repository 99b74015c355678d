"""The pictures of a film: axes, legend and colour bar are drawn once, blocks anew each time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from clast.errors import CaseError
from clast.model.model import Bools, Floats
from clast.pictures import canvas, draw_blocks, draw_bolts
from clast.pictures.draw_water import (
    draw_water,
    handles_of_water,
    pressures_of,
    waters_of,
    with_levels,
)
from clast.pictures.fields import SCALARS, check_field
from clast.pictures.figure_options import CM, Look
from clast.pictures.joints.joint_edges import edges_by_joint
from clast.pictures.joints.joint_values import JOINT_FIELDS, draw_faces, scale_of_faces, together
from clast.pictures.layers.frame_marks import draw_scale_bar
from clast.pictures.plot import TOGETHER, draw_points, legend_handles, places_of_points
from clast.pictures.scale import ColourScale, scale_of
from clast.pictures.strokes import GROUND, draw_edges, handles_of
from clast.pictures.supports.draw_links import draw_links, handles_of_links
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS = 100
"""Dots per inch: type of 9 points is 12.5 pixels high."""
STEEPEST = 0.75
"""Height over width of a film at most, where neither is asked for."""
LOOKED_AT = 60
"""Frames at most from which the ends of the colours follow."""
LEAST, MOST = 320, 3840
"""Width and height of a film, pixels."""

Pixels: TypeAlias = np.ndarray[Any, np.dtype[np.uint8]]
"""A picture: rows from above, pixels, red green blue alpha, shape (height, width, 4)."""


@dataclass(frozen=True, kw_only=True)
class FilmLook:
    """The part of a run that a film shows, its size and its colours."""

    field: str = "displacement"
    """The quantity that colours the blocks; "joint": their edges, "slip" and "opening": their
    joints."""
    size: tuple[float, ...] | None = None
    """Width and height, or the width alone, pixels."""
    zoom: tuple[float, float, float, float] | None = None
    """Part that is shown: xmin, ymin, xmax, ymax, m; None for all that blocks pass through."""
    limits: tuple[float, float] | None = None
    """Values at the ends of the colours, in m, m/s, degrees or Pa; None for those of all frames."""

    def __post_init__(self) -> None:
        check_field(self.field, JOINT_FIELDS)
        for length in self.size or ():
            if not LEAST <= length <= MOST:
                raise CaseError(
                    f"{length:g} pixels are too {'few' if length < LEAST else 'many'}",
                    where="size",
                    remedy=f"give width and height in pixels, {LEAST} to {MOST} each",
                )
        self.of_picture(LEAST)

    def of_picture(self, *pixels: float) -> Look:
        """Return the look of a picture of a width, or a width and a height, in pixels."""
        size = tuple(length / DOTS / CM for length in pixels)
        return Look(limits=self.limits, zoom=self.zoom, size=size, dpi=DOTS)


class FrameDrawer:
    """Draws frames of a run alike: part, colours and legend are those of the whole film."""

    def __init__(
        self, results: Recording, frames: Sequence[int], look: FilmLook, width: int
    ) -> None:
        """Lay out pictures of some frames, ``width`` pixels wide unless the look has a size."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        self._results, self._look = results, look
        self._start = results.vertices(0)
        self._places = dict(zip(frames, places_of_points(results, frames), strict=True))
        every = -(-len(frames) // LOOKED_AT)
        some = [*frames[:-1:every], frames[-1]]
        self._part = _part(results, frames, look)
        bars = int(look.field in SCALARS or look.field in JOINT_FIELDS)
        handles = self._handles(some)
        sheet, self._box, keys = self._sheet(handles, bars, width)
        self._seen = canvas.seen(*self._part, self._box)
        self._figure = canvas.new_figure(_even(sheet.size), DOTS)
        agg: Any = FigureCanvasAgg(self._figure)
        self._canvas = agg
        self._axes = self._figure.add_axes(sheet.share(sheet.axes))
        canvas.view(self._axes, *self._seen, self._box)
        canvas.head(self._figure, sheet.axes[0], sheet.title, "")
        keys.draw(self._figure, sheet)
        self._scale = _scale(results, some, self._seen, look) if bars else None
        if self._scale is not None:
            _explain(self._figure, sheet, self._scale, look.field)
        draw_scale_bar(self._figure, sheet, self._seen)
        self._clock = _clock(self._figure, sheet)
        self._canvas.draw()
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)
        self._standing = frozenset(self._axes.get_children())

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels; both are even, as films need it."""
        width, height = self._canvas.get_width_height()
        return int(width), int(height)

    def picture(self, frame: int) -> Pixels:
        """Return the picture of a frame."""
        self._canvas.restore_region(self._ground)
        self._draw(frame)
        moving = [artist for artist in self._axes.get_children() if artist not in self._standing]
        for artist in sorted(moving, key=lambda one: float(one.get_zorder())):
            self._axes.draw_artist(artist)
            artist.remove()
        self._clock.set_text(_time(self._results, frame))
        self._figure.draw_artist(self._clock)
        return np.array(self._canvas.buffer_rgba(), np.uint8)

    def _draw(self, frame: int) -> None:
        """Draw a frame on the axes, as a still picture does."""
        results, axes, field = self._results, self._axes, self._look.field
        here, absent = results.vertices(frame), absent_in_frame(results, frame)
        draw_blocks.draw_start(axes, results, self._start, absent)
        joints = field == "joint"
        outlined, awaited = 0.0 if joints else 1.0, results.awaited(frame)
        free = draw_blocks.draw_blocks(axes, results, here, outlined, absent, awaited)
        drawn = ~(results.fixed | absent)
        if field in JOINT_FIELDS:
            free.set_facecolor(GROUND)
            if self._scale is not None:
                faces = JOINT_FIELDS[field].faces(results, frame)
                draw_faces(axes, faces, self._scale, field)
        elif self._scale is None:
            draw_blocks.paint_kinds(free, results, field, frame, drawn)
        else:
            quantity = SCALARS[field]
            draw_blocks.paint(
                free, quantity.values(results, frame)[drawn], self._scale, quantity.unit
            )
        draw_water(axes, results, waters_of(results, frame), frame, self._seen)
        if joints:
            edges = edges_by_joint(results, here, self._start, self._together, absent)
            shown = draw_blocks.within(results, here, *self._seen)
            draw_edges(axes, edges, self._seen, self._box[0], int(shown.sum()))
        draw_bolts.draw_bolts(axes, results.bolts(frame))
        draw_links(axes, results, frame)
        if field == "block":
            draw_blocks.draw_names(axes, results, here, absent)
        draw_points(axes, results.point_name, self._places[frame])

    @property
    def _together(self) -> float:
        """Distance up to which edges of two blocks are drawn as one, m."""
        return TOGETHER * float((self._part[1] - self._part[0]).max())

    def _handles(self, frames: Sequence[int]) -> list[Any]:
        """Return the legend: everything there is at the end, and excavated blocks."""
        results, last = self._results, frames[-1]
        absent, here = absent_in_frame(results, last), results.vertices(last)
        waters = waters_of(results, last)
        edges: Sequence[Any] = ()
        if self._look.field == "joint":
            edges = edges_by_joint(results, here, self._start, self._together, absent)
        return [
            *legend_handles(results, self._look.field, last),
            *handles_of(edges, self._part),
            *handles_of_water(waters, pressures_of(results, waters, last, here)),
            *draw_bolts.handles_of(results.bolts(last)),
            *handles_of_links(results, last),
        ]

    def _sheet(
        self, handles: list[Any], bars: int, width: int
    ) -> tuple[canvas.Sheet, tuple[float, float], canvas.Keys]:
        """Return the sheet, the size of its axes, inches, and its legend."""
        title = self._results.title or self._results.name
        own = self._look.size

        def laid_out(*pixels: float) -> tuple[canvas.Sheet, tuple[float, float], canvas.Keys]:
            picture = self._look.of_picture(*pixels)
            box, keys, narrowest = canvas.sizes(self._part, picture, title, handles, bars, 1)
            sheet = canvas.sheet_for(box, title, keys.lines + 1, bars, narrowest)
            return sheet, box, keys

        found = laid_out(*(own or (width,)))
        high = found[0].size[1] > STEEPEST * found[0].size[0]
        return laid_out(width, round(STEEPEST * width)) if high and own is None else found


def _even(size: tuple[float, float]) -> tuple[float, float]:
    """Return a size in inches whose pixels are even numbers."""
    width, height = (2 * max(1, round(DOTS * length / 2)) / DOTS for length in size)
    return width, height


def _part(results: Recording, frames: Sequence[int], look: FilmLook) -> canvas.Part:
    """Return the part to show: where blocks are in some frames, or the given part."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    passed = False
    zoom = None if look.zoom is None else (np.array(look.zoom[:2]), np.array(look.zoom[2:]))
    for frame in (0, *frames):
        here = results.vertices(frame)
        low, high = np.minimum(low, here.min(axis=0)), np.maximum(high, here.max(axis=0))
        passed = passed or zoom is None or bool(draw_blocks.within(results, here, *zoom).any())
    if zoom is None:
        return with_levels(results, waters_of(results, frames[-1]), (low, high))
    if not passed:
        raise canvas.empty_part(low, high)
    return zoom


def _scale(
    results: Recording, frames: Sequence[int], seen: canvas.Part, look: FilmLook
) -> ColourScale | None:
    """Return one scale for all frames, from the free blocks or joints seen in some of them."""
    if look.field in JOINT_FIELDS:
        faces = together([JOINT_FIELDS[look.field].faces(results, frame) for frame in frames])
        return scale_of_faces(faces, faces.within(*seen), look.limits)
    quantity = SCALARS[look.field]
    values, areas = [], []
    for frame in frames:
        here = results.vertices(frame)
        free: Bools = ~(results.fixed | absent_in_frame(results, frame))
        inside = free & draw_blocks.within(results, here, *seen)
        counted = inside if inside.any() else free
        values.append(quantity.values(results, frame)[counted])
        areas.append(draw_blocks.areas_of(results, here)[counted])
    every: Floats = np.concatenate(values)
    return scale_of(every, np.concatenate(areas), look.limits) if len(every) else None


def _explain(figure: Figure, sheet: canvas.Sheet, scale: ColourScale, field: str) -> None:
    """Draw the colour bar of a scale."""
    from matplotlib.collections import PolyCollection

    quantity = JOINT_FIELDS[field] if field in JOINT_FIELDS else SCALARS[field]
    sample = PolyCollection([])
    unit = draw_blocks.paint(sample, np.zeros(0), scale, quantity.unit)
    draw_blocks.draw_colour_bar(figure, sheet, sample, f"{quantity.label} ({unit})", scale.extend)


def _clock(figure: Figure, sheet: canvas.Sheet) -> Any:
    """Return the text below the title that says time and stage, drawn anew in each picture."""
    width, height = sheet.size
    up = height - 0.1 - canvas.LINE * (len(sheet.title) + 0.5)
    return figure.text(
        sheet.axes[0] / width,
        up / height,
        "",
        fontsize=canvas.TEXT_SIZE,
        color=canvas.INK,
        va="center",
        animated=True,
    )


def _time(results: Recording, frame: int) -> str:
    """Return the text of the clock: digits that do not jump about, and the stage."""
    stage = results.frame(frame).stage
    last = float(results.times[-1])
    digits = int(np.clip(3 - np.floor(np.log10(last)), 0, 6)) if last > 0.0 else 3
    text = f"t = {results.times[frame]:.{digits}f} s"
    return f"{text}, stage {canvas.literal(stage)}" if stage else text
