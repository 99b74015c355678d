"""Still pictures of results: one frame, or two beside each other."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas, draw_blocks
from clast.pictures.canvas import BAR, BAR_LABELS, LEFT, RIGHT, TEXT
from clast.pictures.fields import SCALARS
from clast.pictures.figure_options import CM, DEFAULT, SMALLEST, Look
from clast.pictures.flow_values import FLOW_FIELDS
from clast.pictures.forces import HEAD, Arrows, arrows_of, draw_arrows
from clast.pictures.frames import FrameDrawing
from clast.pictures.histories import plot_bolt_history, plot_history
from clast.pictures.layers import draw_gravity, draw_scale_bar
from clast.pictures.supports import ReactionArrow, draw_reactions, reaction_arrows
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Look", "plot_bolt_history", "plot_history", "plot_results", "plot_two_frames"]

BETWEEN = 0.55
"""Space between two frames, inches."""


def plot_results(
    results: Recording,
    path: Path | str,
    *,
    frame: int = -1,
    field: str = "displacement",
    contacts: bool | None = None,
    reactions: bool = False,
    look: Look = DEFAULT,
) -> Path:
    """Draw the blocks of a frame coloured by ``field``, their edges by "joint"; return the path.

    ``results`` are a run, or the content of a result file:  ``clast.plot_results(run, "run.png")``.
    The start is outlined behind; ``contacts`` draws the contact forces as arrows, on both blocks of
    each contact, the largest in each place where they are many; if None they are left out where
    water in joints has the colours.  ``reactions`` draws the reactions of supports.  "slip" and
    "opening" colour the joints between blocks.  Water is drawn with its level and its pressures.
    ``look`` has limits of the colours, size, resolution and the part that is shown.  The format
    follows from the ending of ``path``.  Raises CaseError for results that are not there, or that
    cannot be drawn or written.
    """
    figure = draw_results(
        results, frame=frame, field=field, contacts=contacts, reactions=reactions, look=look
    )
    return canvas.save(figure, Path(path))


def draw_results(
    results: Recording,
    *,
    frame: int,
    field: str,
    contacts: bool | None,
    look: Look,
    reactions: bool = False,
) -> Figure:
    """Return the picture that ``plot_results`` writes."""
    canvas.check_installed()
    number = results.frame(frame).number
    drawing = FrameDrawing(results, [number], field, look)
    part, bars, title = drawing.part, int(drawing.has_scale), results.title or results.name
    sheet, keys = canvas.lay_out(part, look, title, drawing.handles(number), bars, 1)
    size = sheet.room
    arrows, pushes = None, list[ReactionArrow]()
    results = drawing.results
    # arrows of forces could not be told from those of flow
    if field not in FLOW_FIELDS if contacts is None else contacts:
        arrows, part = _contact_arrows(results, number, part, size, look)
    seen = canvas.seen(*part, size)
    if reactions:
        pushes, seen = _reactions(results, number, part, size, look)
    figure = canvas.new_figure(sheet.size, look.dpi or canvas.dots_for(len(results.block_name)))
    axes = figure.add_axes(sheet.parts(sheet.axes))
    canvas.view(axes, *seen, size)
    canvas.head(figure, sheet.axes[0], sheet.title, _below(drawing, number, sheet))
    scale = drawing.scale([number], seen, look.limits)
    coloured, label = drawing.draw(axes, number, seen, scale)
    if scale is not None:
        if field in SCALARS and scale.beyond:
            label += ("\n" if sheet.upright else "; ") + scale.beyond_text(SCALARS[field].unit)
        draw_blocks.draw_colour_bar(figure, sheet, coloured, label, scale.extend)
    draw_reactions(axes, pushes)
    if arrows is not None:
        draw_arrows(figure, sheet, axes, arrows)
    keys.draw(figure, sheet)
    if "scale" in look.layers:
        # on the line of the arrows' key, where there are none
        draw_scale_bar(figure, sheet, seen, 0.2 if arrows is None else sheet.axes[1] - 0.42)
    if "gravity" in look.layers:
        draw_gravity(figure, sheet, results)
    return figure


def draw_on(axes: Axes, results: Recording, *, frame: int, field: str, look: Look) -> None:
    """Draw the blocks of a frame on axes of a figure of one's own, with the scale of the field."""
    canvas.check_installed()
    if not hasattr(axes, "add_collection"):
        what = f"a {type(axes).__name__} is not axes of matplotlib"
        raise CaseError(what, where="ax", remedy="give those of: figure, ax = plt.subplots()")
    number = results.frame(frame).number
    drawing = FrameDrawing(results, [number], field, look)
    box = axes.get_window_extent()
    dots = axes.figure.dpi
    size = max(box.width / dots, 0.1), max(box.height / dots, 0.1)
    seen = canvas.seen(*drawing.part, size)
    canvas.view(axes, *seen, size)
    scale = drawing.scale([number], seen, look.limits)
    coloured, label = drawing.draw(axes, number, seen, scale)
    if scale is not None:
        axes.figure.colorbar(coloured, ax=axes, label=label, extend=scale.extend)
    if drawing.magnification:
        axes.set_title(drawing.magnification, loc="right", **TEXT)


def _reactions(
    results: Recording, number: int, part: canvas.Part, size: tuple[float, float], look: Look
) -> tuple[list[ReactionArrow], canvas.Part]:
    """Return the reactions of a frame, and the part of the section seen with room for them."""
    seen = canvas.seen(*part, size)
    pushes = reaction_arrows(results, number, float(seen[1][0] - seen[0][0]))
    if pushes and look.zoom is None:
        tails = np.array([one.behind for one in pushes])
        seen = canvas.seen(*_with_ends(part, tails, 0.0), size)
    return pushes, seen


def _contact_arrows(
    results: Recording, number: int, part: canvas.Part, size: tuple[float, float], look: Look
) -> tuple[Arrows, canvas.Part]:
    """Return the contact forces of a frame, and the part to show, with room for them."""
    low, high = canvas.seen(*part, size)
    per_inch, zoomed = float(high[0] - low[0]) / size[0], look.zoom is not None
    arrows = arrows_of(results, number, low, high, per_inch, zoomed=zoomed)
    if zoomed or not len(arrows.at):
        return arrows, part
    return arrows, _with_ends(part, arrows.ends, per_inch)


def _with_ends(part: canvas.Part, ends: Floats, per_inch: float) -> canvas.Part:
    """Return the part to show, made so large that no arrow is cut off."""
    slack = HEAD * per_inch
    low = np.minimum(part[0], ends.min(axis=0) - slack)
    return low, np.maximum(part[1], ends.max(axis=0) + slack)


def _below(drawing: FrameDrawing, number: int, sheet: canvas.Sheet) -> str:
    """Return the line below the title: field, time and stage, without the field if need be."""
    results = drawing.results
    time, stage = f"$t$ = {results.times[number]:.4g} s", results.frame(number).stage
    whole = f"{drawing.label} at {time}"
    if not stage:
        return whole
    letters = canvas.letters_in(sheet.size[0] - sheet.axes[0], canvas.TEXT_SIZE)
    for text in (f"{whole}, stage {stage}", f"Stage {stage}, {time}"):
        if len(text) <= letters + 2:  # the dollars are not seen
            return text.replace(stage, canvas.literal(stage))
    room = max(6, letters - len(time) - len("Stage , "))
    return f"Stage {canvas.literal(stage[: room - 1])}…, {time}"


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
    numbers = [results.frame(frame).number for frame in frames]
    drawing = FrameDrawing(results, numbers, field, look)
    title, bars = results.title or results.name, int(drawing.has_scale)
    handles, below = drawing.handles(numbers[-1]), int("scale" in look.layers)

    part, half = drawing.part, _half(look, bars)
    sheet, keys = canvas.lay_out(part, half, title, handles, bars, below)
    if not sheet.upright:  # the colour bar lies below both
        sheet, keys = canvas.lay_out(part, _half(look, 0), title, handles, bars, below)
    size = sheet.room
    shift = size[0] + BETWEEN
    wide = replace(
        sheet,
        size=(sheet.size[0] + shift, sheet.size[1]),
        bar=(sheet.bar[0] + (shift if sheet.upright else 0.5 * shift), *sheet.bar[1:]),
    )
    figure = canvas.new_figure(wide.size, look.dpi or 160)
    canvas.head(figure, wide.axes[0], wide.title, "")
    seen = canvas.seen(*part, size)
    scale = drawing.scale(numbers, seen, look.limits)
    for place, number in enumerate(numbers):
        axes = figure.add_axes(wide.parts((wide.axes[0] + place * shift, *wide.axes[1:])))
        canvas.view(axes, *seen, size)
        axes.set_title(_time(results, number), loc="left", **TEXT)
        coloured, label = drawing.draw(axes, number, seen, scale)
        if place:
            axes.set_ylabel("")
        if place and scale is not None:
            draw_blocks.draw_colour_bar(figure, wide, coloured, label, scale.extend)
    keys.draw(figure, wide)
    if "scale" in look.layers:
        draw_scale_bar(figure, wide, seen)
    if "gravity" in look.layers:
        draw_gravity(figure, wide, results)
    return canvas.save(figure, Path(path))


def _time(results: Recording, number: int) -> str:
    """Return the time of a frame, and its stage if there are stages."""
    stage = results.frame(number).stage
    return f"$t$ = {results.times[number]:.4g} s" + (f", {canvas.literal(stage)}" if stage else "")


def _half(look: Look, bars: int) -> Look:
    """Return the look of one of two beside so many colour bars, together as wide as asked for."""
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
