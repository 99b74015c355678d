"""Two frames beside each other, with one part, one scale and one legend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas, draw_blocks, draw_bolts
from clast.pictures.canvas import BAR, BAR_LABELS, INK, LEFT, RIGHT, TEXT_SIZE, UPRIGHT
from clast.pictures.draw_water import draw_water, handles_of_water, pressures_of, waters_of
from clast.pictures.fields import SCALARS, check_field
from clast.pictures.figure_options import CM, DEFAULT, SMALLEST, Look
from clast.pictures.joints.joint_values import JOINT_FIELDS, draw_faces, scale_of_faces, together
from clast.pictures.layers.frame_marks import draw_gravity, draw_scale_bar
from clast.pictures.layers.still_layers import LAYERS, draw_layers, layer_handles
from clast.pictures.plot import draw_points, edges_of, legend_handles, places_of_points
from clast.pictures.scale import ColourScale, scale_of
from clast.pictures.strokes import GROUND, EdgeGroup, draw_edges, handles_of
from clast.pictures.supports.draw_links import draw_links, handles_of_links
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BETWEEN = 0.55
"""Space between the two, inches."""


def plot_two_frames(
    results: Recording,
    path: Path | str,
    frames: tuple[int, int],
    *,
    field: str = "displacement",
    look: Look = DEFAULT,
) -> Path:
    """Draw two frames side by side with one colour scale, that of both; return the path.

    ``look.size`` is that of the whole picture.  Raises CaseError as ``plot_results`` does.
    """
    check_field(field, JOINT_FIELDS)
    numbers = [results.frame(frame).number for frame in frames]
    part = _part(results, numbers, look)
    title = results.title or results.name
    above = tuple(name for name in look.layers if name in LAYERS)
    handles = _handles(results, numbers[-1], field, part, above)
    bars = int(field in SCALARS or field in JOINT_FIELDS)
    below = int("scale" in look.layers)
    size, keys, narrowest = canvas.sizes(part, _half(look, bars), title, handles, bars, below)
    if size[1] < UPRIGHT:  # the colour bar lies below both
        size, keys, narrowest = canvas.sizes(part, _half(look, 0), title, handles, bars, below)
    sheet = canvas.sheet_for(size, title, keys.lines + below, bars, narrowest)
    shift = size[0] + BETWEEN
    wide = replace(
        sheet,
        size=(sheet.size[0] + shift, sheet.size[1]),
        bar=(sheet.bar[0] + (shift if sheet.upright else 0.5 * shift), *sheet.bar[1:]),
    )
    figure = canvas.new_figure(wide.size, look.dpi or 160)
    canvas.head(figure, wide.axes[0], wide.title, "")
    seen = canvas.seen(*part, size)
    scale = _scale(results, numbers, field, seen, look)
    for place, number in enumerate(numbers):
        box = (wide.axes[0] + place * shift, *wide.axes[1:])
        axes = figure.add_axes(wide.share(box))
        canvas.view(axes, *seen, size)
        coloured, unit = _draw_frame(axes, results, number, field, scale, seen, above, size[0])
        if place:
            axes.set_ylabel("")
        if place and scale is not None:
            own = JOINT_FIELDS[field] if field in JOINT_FIELDS else SCALARS[field]
            label = f"{own.label} ({unit})"
            draw_blocks.draw_colour_bar(figure, wide, coloured, label, scale.extend)
    keys.draw(figure, wide)
    if "scale" in look.layers:
        draw_scale_bar(figure, wide, seen)
    if "gravity" in look.layers:
        draw_gravity(figure, wide, results)
    return canvas.save(figure, Path(path))


def _handles(
    results: Recording, number: int, field: str, part: canvas.Part, above: tuple[str, ...]
) -> list[Any]:
    """Return the legend of both, as the later frame needs it, with the layers ``above``."""
    edges = _edges(results, number, field, part)
    waters = waters_of(results, number)
    pressed = pressures_of(results, waters, number, results.vertices(number))
    return [
        *legend_handles(results, field, number),
        *handles_of(edges, part),
        *handles_of_water(waters, pressed),
        *draw_bolts.handles_of(results.bolts(number)),
        *handles_of_links(results, number),
        *layer_handles(above, results, number),
    ]


def _draw_frame(
    axes: Axes,
    results: Recording,
    number: int,
    field: str,
    scale: ColourScale | None,
    seen: canvas.Part,
    above: tuple[str, ...],
    width: float,
) -> tuple[Any, str]:
    """Draw one frame with the layers ``above``; return the coloured artist and its unit.

    ``width`` is that of the axes, inches.
    """
    axes.set_title(_time(results, number), fontsize=TEXT_SIZE, color=INK, loc="left")
    here, absent = results.vertices(number), absent_in_frame(results, number)
    draw_blocks.draw_start(axes, results, results.vertices(0), absent)
    edges = _edges(results, number, field, seen)
    outlined, awaited = 0.0 if edges else 1.0, results.awaited(number)
    free = draw_blocks.draw_blocks(axes, results, here, outlined, absent, awaited)
    drawn, unit = ~(results.fixed | absent), ""
    coloured: Any = free
    if scale is None:
        draw_blocks.paint_kinds(free, results, field, number, drawn)
    elif field in JOINT_FIELDS:
        free.set_facecolor(GROUND)
        faces = JOINT_FIELDS[field].faces(results, number)
        coloured, unit = draw_faces(axes, faces, scale, field)
    else:
        values = SCALARS[field].values(results, number)[drawn]
        unit = draw_blocks.paint(free, values, scale, SCALARS[field].unit)
    draw_water(axes, results, waters_of(results, number), number, seen)
    if edges:
        shown = draw_blocks.within(results, here, *seen)
        draw_edges(axes, edges, seen, width, int(shown.sum()))
    draw_bolts.draw_bolts(axes, results.bolts(number))
    draw_layers(above, axes, results, number)
    draw_links(axes, results, number)
    if field == "block":
        draw_blocks.draw_names(axes, results, here, absent)
    draw_points(axes, results.point_name, places_of_points(results, [number])[0])
    return coloured, unit


def _edges(results: Recording, number: int, field: str, part: canvas.Part) -> Sequence[EdgeGroup]:
    """Return the edges that are drawn in the colours of their joints, if they are asked for."""
    return edges_of(
        results,
        field,
        results.vertices(number),
        results.vertices(0),
        part,
        absent_in_frame(results, number),
    )


def _time(results: Recording, number: int) -> str:
    """Return the time of a frame, and its stage if there are stages."""
    stage = results.frame(number).stage
    return f"$t$ = {results.times[number]:.4g} s" + (f", {canvas.literal(stage)}" if stage else "")


def _half(look: Look, bars: int) -> Look:
    """Return the look of one of two, which together are as wide as asked for.

    ``bars`` is the number of colour bars that stand beside them.
    """
    if look.size is None:
        return look
    beside = LEFT + RIGHT + (BAR + BAR_LABELS) * bars
    width = 0.5 * (look.size[0] * CM + beside - BETWEEN)
    if width < SMALLEST * CM:
        least = (2.0 * SMALLEST * CM - LEFT - RIGHT + BETWEEN) / CM  # enough for either bar
        raise CaseError(
            f"{look.size[0]:g} cm is too narrow for two frames",
            where="size",
            remedy=f"give a width of {math.ceil(least)} cm or more",
        )
    return replace(look, size=(width / CM, *look.size[1:]))


def _part(results: Recording, numbers: list[int], look: Look) -> canvas.Part:
    """Return the part that both show: all blocks in both and at the start, or the given part."""
    every = np.concatenate([results.vertices(number) for number in (0, *numbers)])
    low, high = every.min(axis=0), every.max(axis=0)
    if look.zoom is None:
        return low, high
    part = np.array(look.zoom[:2]), np.array(look.zoom[2:])
    if not any(
        draw_blocks.within(results, results.vertices(number), *part).any() for number in numbers
    ):
        raise canvas.empty_part(low, high)
    return part


def _scale(
    results: Recording, numbers: list[int], field: str, seen: canvas.Part, look: Look
) -> ColourScale | None:
    """Return one scale for what is seen in both."""
    if field in JOINT_FIELDS:
        faces = together([JOINT_FIELDS[field].faces(results, number) for number in numbers])
        return scale_of_faces(faces, faces.within(*seen), look.limits)
    if field not in SCALARS:
        return None
    values: list[Floats] = []
    areas: list[Floats] = []
    for number in numbers:
        here = results.vertices(number)
        free = ~(results.fixed | absent_in_frame(results, number))
        inside = free & draw_blocks.within(results, here, *seen)
        counted = inside if inside.any() else free
        values.append(SCALARS[field].values(results, number)[counted])
        areas.append(draw_blocks.areas_of(results, here)[counted])
    return scale_of(np.concatenate(values), np.concatenate(areas), look.limits)
