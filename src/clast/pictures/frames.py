"""A frame of a run on axes, drawn alike in still pictures, pairs of frames and films."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats, Ints
from clast.model.stage_records import counted_from
from clast.model.water import Water
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import FAINT, INK, SMALL_SIZE
from clast.pictures.draw_flow import draw_flow, draw_water_tables, handles_of_flow, with_heads
from clast.pictures.draw_surcharge import (
    draw_surcharge,
    handles_of_surcharge,
    surcharge_of,
    with_surcharge,
)
from clast.pictures.draw_water import (
    draw_water,
    handles_of_water,
    pressures_of,
    waters_of,
    with_levels,
)
from clast.pictures.faces import together
from clast.pictures.fields import KINDS, SCALARS, ColourScale, check_field, prefixed, scale_of
from clast.pictures.figure_options import Look
from clast.pictures.flow_values import FLOW_FIELDS, largest_flow, with_widest
from clast.pictures.joint_values import JOINT_FIELDS, draw_faces, scale_of_faces
from clast.pictures.layers import LAYERS
from clast.pictures.magnified import as_it_was, factor_to_be_seen, magnified
from clast.pictures.strokes import GROUND, EdgeGroup, draw_edges, edges_by_joint, handles_of
from clast.pictures.supports import draw_bolts, draw_links, handles_of_bolts, handles_of_links
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POINT_NAMES_MAX = 12
"""Measured points drawn with their names."""


class FrameDrawing:
    """Draws frames of a run with one field, in one part.

    ``part`` has the corners (2,), m, of the area shown: all blocks in the frames and at the start,
    or the zoom of ``look``.  Raises CaseError for a field that is not known and for a part without
    blocks.
    """

    def __init__(
        self,
        results: Recording,
        frames: Sequence[int],
        field: str,
        look: Look,
    ) -> None:
        check_field(field, JOINT_FIELDS)
        factor = look.magnify
        self.factor = factor_to_be_seen(results, frames) if factor == "auto" else factor
        self.results = results = magnified(results, self.factor)
        self.field = field
        self.layers = [LAYERS[name] for name in look.layers if name in LAYERS]
        self.start = results.vertices(0)
        self._water = look.water
        self.part = _part(results, frames, look.zoom)
        if look.water and look.zoom is None:
            self.part = with_levels(as_it_was(results), self._waters(frames[-1]), self.part)
            self.part = with_heads(results, frames[-1], self.part)
        self._widest = 0.0
        if field in FLOW_FIELDS:  # lines of all frames compare
            self._widest = max(largest_flow(results, frame) for frame in frames)
        self.has_scale = field in SCALARS or field in JOINT_FIELDS
        start, places = results.point_start, places_of_points(results, frames)
        self._points = dict(zip(frames, start + self.factor * (places - start), strict=True))

    def _waters(self, frame: int) -> tuple[Water, ...]:
        return waters_of(self.results, frame) if self._water else ()

    @property
    def label(self) -> str:
        """The name of the field on a picture."""
        if self.field in KINDS:
            return KINDS[self.field]
        return (JOINT_FIELDS if self.field in JOINT_FIELDS else SCALARS)[self.field].label

    def scale(
        self, frames: Sequence[int], seen: canvas.Part, limits: tuple[float, float] | None
    ) -> ColourScale | None:
        """Return one scale for the free blocks or joints seen in some frames; None without any."""
        results, field = self.results, self.field
        if field in JOINT_FIELDS:
            faces = together([JOINT_FIELDS[field].values(results, frame) for frame in frames])
            if not JOINT_FIELDS[field].from_zero and len(faces.value):
                limits = limits or (float(faces.value.min()), float(faces.value.max()))
            return scale_of_faces(faces, faces.within(*seen), limits)
        if field not in SCALARS:
            return None
        values, areas = [], []
        for frame in frames:
            here = results.vertices(frame)
            free = ~(results.fixed | absent_in_frame(results, frame))
            inside = free & draw_blocks.within(results, here, *seen)
            counted = inside if inside.any() else free
            values.append(SCALARS[field].values(results, frame)[counted])
            areas.append(draw_blocks.areas_of(results, here)[counted])
        every = np.concatenate(values)
        return scale_of(every, np.concatenate(areas), limits) if len(every) else None

    def paint(self, artist: Any, values: Floats, scale: ColourScale) -> str:
        """Colour an artist by values (k,) of the field; return label and unit for a colour bar."""
        unit = (JOINT_FIELDS if self.field in JOINT_FIELDS else SCALARS)[self.field].unit
        return f"{self.label} ({draw_blocks.paint(artist, values, scale, unit)})"

    def handles(self, frame: int) -> list[Any]:
        """Return the legend of a frame."""
        results, waters = self.results, self._waters(frame)
        pressures = pressures_of(results, waters, frame, as_it_was(results).vertices(frame))
        return [
            *_block_handles(results, self.field, frame),
            *self._magnification(),
            *handles_of(self._edges(frame), self.part),
            *handles_of_water(waters, pressures),
            *(handles_of_flow(results, frame, self.field, self._widest) if self._water else ()),
            *handles_of_surcharge(surcharge_of(results, frame)),
            *handles_of_bolts(results.bolts(frame)),
            *handles_of_links(results, frame),
            *(handle for layer in self.layers for handle in layer(results, frame)[0]),
        ]

    def draw(
        self, axes: Axes, frame: int, seen: canvas.Part, scale: ColourScale | None
    ) -> tuple[Any, str]:
        """Draw a frame on axes that show ``seen``; return the coloured artist and its label."""
        results, field = self.results, self.field
        here, absent = results.vertices(frame), absent_in_frame(results, frame)
        edges, label = self._edges(frame), ""
        draw_blocks.draw_start(axes, results, self.start, absent)
        outlines = 0.0 if edges else 1.0
        coloured: Any = draw_blocks.draw_blocks(
            axes, results, here, outlines, absent, results.awaited(frame)
        )
        drawn = ~(results.fixed | absent)
        if field in JOINT_FIELDS:
            coloured.set_facecolor(GROUND)
            if scale is not None:
                faces = JOINT_FIELDS[field].values(results, frame)
                if field in FLOW_FIELDS:
                    faces = with_widest(faces, largest_flow(results, frame), self._widest)
                coloured = draw_faces(axes, faces, scale)
                label = self.paint(coloured, faces.value, scale)
        elif scale is None:
            if field in ("joint", "none"):
                coloured.set_facecolor(GROUND)
            else:
                kinds = results.field(field, frame)[drawn]
                coloured.set_facecolor([*map(draw_blocks.kind_colour, kinds)])
        else:
            label = self.paint(coloured, SCALARS[field].values(results, frame)[drawn], scale)
        draw_surcharge(axes, surcharge_of(results, frame))
        draw_water(axes, results, self._waters(frame), frame, seen)
        if self._water:
            draw_water_tables(axes, results, frame, seen)
        if field in FLOW_FIELDS:
            draw_flow(axes, results, frame, seen, self._widest)
        draw_edges(axes, edges, seen, int(draw_blocks.within(results, here, *seen).sum()))
        draw_bolts(axes, results.bolts(frame))
        for layer in self.layers:
            layer(results, frame)[1](axes)
        draw_links(axes, results, frame)
        if field == "block":
            draw_blocks.draw_names(axes, results, here, absent)
        _draw_convergences(axes, results, self._points[frame], frame)
        _draw_points(axes, results.point_name, self._points[frame])
        return coloured, label

    def _magnification(self) -> list[Any]:
        """Return the entry of the legend that says how much displacements are magnified."""
        from matplotlib.lines import Line2D

        return [Line2D([], [], ls="", label=self.magnification)] if self.magnification else []

    @property
    def magnification(self) -> str:
        """How much displacements are magnified, in words; nothing where they are not."""
        return "" if self.factor == 1.0 else f"displacements × {self.factor:,.6g}"

    def _edges(self, frame: int) -> Sequence[EdgeGroup]:
        """Return the edges in the colours of their joints, if they are asked for."""
        if self.field != "joint":
            return ()
        # edges of two blocks are one up to a thousandth of the picture
        apart = 1e-3 * float((self.part[1] - self.part[0]).max())
        return edges_by_joint(self.results, frame, apart)


def _part(
    results: Recording, frames: Sequence[int], zoom: tuple[float, float, float, float] | None
) -> canvas.Part:
    """Return the part to show: where blocks are in some frames, or the given part."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    passed = False
    part = None if zoom is None else (np.array(zoom[:2]), np.array(zoom[2:]))
    for frame in dict.fromkeys((0, *frames)):
        here = results.vertices(frame)
        low, high = np.minimum(low, here.min(axis=0)), np.maximum(high, here.max(axis=0))
        if part is not None and frame in frames:
            passed = passed or bool(draw_blocks.within(results, here, *part).any())
    if part is None:
        low, high = with_surcharge(surcharge_of(results, frames[-1]), (low, high))
        return low, high
    if not passed:
        raise canvas.empty_part(low, high)
    return part


def places_of_points(results: Recording, frames: Sequence[int] | Ints) -> Floats:
    """Return where the measured points are in some frames, m, shape (frames, points, 2)."""
    places = np.zeros((len(frames), len(results.point_name), 2))
    for k, (name, start) in enumerate(zip(results.point_name, results.point_start, strict=True)):
        history = results.history(name)
        rows = results.rows_at(history.time, np.asarray(frames))
        before = [counted_from(results.stages, k, float(history.time[row])) for row in rows]
        places[:, k] = start + np.reshape(before, (-1, 2)) + history.displacement[rows]
    return places


def _draw_points(axes: Axes, names: Sequence[str], places: Floats) -> None:
    """Mark the measured points (k, 2) where they are, the first few with their names."""
    for name, at in list(zip(names, places, strict=True))[:POINT_NAMES_MAX]:
        axes.plot(*at, "o", ms=3.5, mfc="white", mec=INK, mew=0.9, zorder=6)
        text, side = _beside(axes, name, float(at[0]))
        beside: dict[str, Any] = {
            "xytext": (4, 4) if side == "left" else (-4, 4),
            "ha": side,
            "va": "baseline",
        }
        text = canvas.literal(text)
        canvas.write(axes, text, at, 7, textcoords="offset points", **beside)


def _draw_convergences(axes: Axes, results: Recording, places: Floats, frame: int) -> None:
    """Join the two points of each convergence by a dashed line, with its value in the frame."""
    names, pairs = results.convergence_name, results.convergence_points
    for name, pair in list(zip(names, pairs, strict=True))[:POINT_NAMES_MAX]:
        ends = places[pair]
        axes.plot(*ends.T, ls="--", lw=0.9, color=INK, zorder=5)
        rows = results.convergence(name)
        value = float(rows.convergence[results.rows_at(rows.time, frame)])
        factor, unit = prefixed(abs(value), "m")
        text = canvas.literal(f"{name} {factor * value:.3g} {unit}")
        canvas.write(axes, text, ends.mean(axis=0), 7, ha="center", va="center")


def _beside(axes: Axes, name: str, x: float) -> tuple[str, str]:
    """Return a name as it fits beside a point at ``x``, m, and which of its ends is there."""
    figure = axes.get_figure(root=True)
    low, high = axes.get_xlim()
    width = float(axes.get_position().width * (figure.get_size_inches()[0] if figure else 1.0))
    right = (high - x) / (high - low) * width + canvas.RIGHT
    left = (x - low) / (high - low) * width + canvas.LEFT
    if canvas.letters_in(right, SMALL_SIZE) > len(name) or right >= left:
        return canvas.cut_to(name, right, SMALL_SIZE), "left"
    return canvas.cut_to(name, left, SMALL_SIZE), "right"


def _block_handles(results: Recording, field: str, frame: int) -> list[Any]:
    """Return the legend of outlines, fixed and excavated blocks, and rocks."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Line2D([], [], color=FAINT, lw=0.8, label="start")]
    absent = absent_in_frame(results, frame)
    if (absent & ~results.awaited(frame)).any():
        dashed = Line2D([], [], color=FAINT, lw=0.6, ls=draw_blocks.EXCAVATED, label="excavated")
        handles.append(dashed)
    if (results.fixed & ~absent).any():
        handles.append(
            Patch(fc=draw_blocks.FIXED, ec=FAINT, hatch=draw_blocks.HATCH, lw=0.5, label="fixed")
        )
    if field == "rock":
        handles += [
            Patch(fc=draw_blocks.kind_colour(rock), ec=INK, lw=0.5, label=canvas.literal(name))
            for rock, name in enumerate(results.rock_name)
        ]
    return handles
