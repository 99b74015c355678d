"""Still pictures of results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Bools, Floats
from clast.model.stages.records import counted_from
from clast.model.water.water import Water
from clast.pictures import canvas, draw_blocks, draw_bolts
from clast.pictures.canvas import FAINT, INK, NAME_BOX, SMALL_SIZE
from clast.pictures.draw_water import (
    draw_water,
    handles_of_water,
    pressures_of,
    waters_of,
    with_levels,
)
from clast.pictures.fields import KINDS, SCALARS, check_field
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.forces import HEAD, Arrows, arrows_of, draw_arrows
from clast.pictures.history import plot_bolt_history, plot_history
from clast.pictures.joints.joint_edges import edges_by_joint
from clast.pictures.joints.joint_values import JOINT_FIELDS, Faces, draw_faces, scale_of_faces
from clast.pictures.layers.frame_marks import draw_gravity, draw_scale_bar
from clast.pictures.layers.still_layers import LAYERS, draw_layers, layer_handles
from clast.pictures.strokes import GROUND, EdgeGroup, draw_edges, handles_of
from clast.pictures.supports.draw_links import draw_links, handles_of_links
from clast.pictures.supports.draw_reactions import ReactionArrow, draw_reactions, reaction_arrows
from clast.results import Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Look", "plot_bolt_history", "plot_history", "plot_results"]

FEW_BLOCKS = 500
"""Blocks up to which a picture needs no finer dots."""

TOGETHER = 1e-3
"""Edges of two blocks are drawn as one up to this distance, as a share of the picture."""

MOST_NAMES = 12
"""Measured points drawn at most with their names."""


def plot_results(
    results: Recording,
    path: Path | str,
    *,
    frame: int = -1,
    field: str = "displacement",
    contacts: bool = True,
    reactions: bool = False,
    look: Look = DEFAULT,
) -> Path:
    """Draw the blocks of a frame coloured by ``field``, their edges by "joint"; return the path.

    ``results`` are a run, or the content of a result file:  ``clast.plot_results(run, "run.png")``.
    The start is outlined behind; ``contacts`` draws the contact forces as arrows, on both blocks of
    each contact, the largest in each place where they are many; ``reactions`` the reactions of
    supports. "slip" and "opening" colour the
    joints between blocks.  Water is drawn with its level and its pressures: outside faces, and
    across joints.  ``look`` has limits of the colours, size, resolution and the part that is shown.
    The format follows from the ending of ``path``.  Raises CaseError for results that are not
    there, or that cannot be drawn or written.
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
    contacts: bool,
    look: Look,
    reactions: bool = False,
) -> Figure:
    """Return the picture that ``plot_results`` writes."""
    canvas.check_installed()
    check_field(field, JOINT_FIELDS)
    number = results.frame(frame).number
    here, start = results.vertices(number), results.vertices(0)
    waters = waters_of(results, number)
    part = _part(results, here, start, look, waters)
    bars = int(field in SCALARS or field in JOINT_FIELDS)
    title = results.title or results.name
    absent = absent_in_frame(results, number)
    edges = edges_of(results, field, here, start, part, absent)
    water = pressures_of(results, waters, number, here)
    above = tuple(name for name in look.layers if name in LAYERS)
    handles = [
        *legend_handles(results, field, number),
        *handles_of(edges, part),
        *handles_of_water(waters, water),
        *draw_bolts.handles_of(results.bolts(number)),
        *handles_of_links(results, number),
        *layer_handles(above, results, number),
    ]
    size, keys, narrowest = canvas.sizes(part, look, title, handles, bars, 1)
    arrows, zoomed = None, look.zoom is not None
    pushes: list[ReactionArrow] = []
    if contacts:
        arrows, part = _contact_arrows(results, number, part, size, zoomed)
    whole = canvas.seen(*part, size)
    if reactions:
        pushes, whole = _reactions(results, number, part, size, zoomed)
    sheet = canvas.sheet_for(size, title, keys.lines + 1, bars, narrowest)
    figure, axes = _empty_figure(results, sheet, whole, size, look)
    canvas.head(figure, sheet.axes[0], sheet.title, _below(results, number, field, sheet))
    outlined = 0.0 if edges else 1.0
    shown = _draw_blocks(sheet, axes, results, number, field, whole, look, outlined)
    draw_water(axes, results, waters, number, whole)
    draw_edges(axes, edges, whole, size[0], int(shown.sum()))
    draw_bolts.draw_bolts(axes, results.bolts(number))
    draw_layers(above, axes, results, number)
    draw_links(axes, results, number)
    draw_reactions(axes, pushes)
    if arrows is not None:
        draw_arrows(figure, sheet, axes, arrows)
    if field == "block":
        draw_blocks.draw_names(axes, results, here, absent)
    draw_points(axes, results.point_name, places_of_points(results, [number])[0])
    keys.draw(figure, sheet)
    # the scale is on the line of the arrows' key, where there are none
    scale_at = 0.2 if arrows is None else sheet.axes[1] - 0.42
    _draw_frame_marks(figure, sheet, results, whole, look, scale_at)
    return figure


def _empty_figure(
    results: Recording,
    sheet: canvas.Sheet,
    whole: canvas.Part,
    size: tuple[float, float],
    look: Look,
) -> tuple[Figure, Axes]:
    """Return the figure of a sheet, finer for many blocks, with axes that show ``whole``."""
    few = len(results.block_name) <= FEW_BLOCKS
    figure = canvas.new_figure(sheet.size, look.dpi or (160 if few else 220))
    axes = figure.add_axes(sheet.share(sheet.axes))
    canvas.view(axes, *whole, size)
    return figure, axes


def _draw_frame_marks(
    figure: Figure,
    sheet: canvas.Sheet,
    results: Recording,
    whole: canvas.Part,
    look: Look,
    scale_at: float,
) -> None:
    """Draw the scale bar, ``scale_at`` inches above the lower edge, and the arrow of gravity."""
    if "scale" in look.layers:
        draw_scale_bar(figure, sheet, whole, scale_at)
    if "gravity" in look.layers:
        draw_gravity(figure, sheet, results)


def _reactions(
    results: Recording, number: int, part: canvas.Part, size: tuple[float, float], zoomed: bool
) -> tuple[list[ReactionArrow], canvas.Part]:
    """Return the reactions of a frame, and what of the section is seen, with room for them."""
    whole = canvas.seen(*part, size)
    pushes = reaction_arrows(results, number, float(whole[1][0] - whole[0][0]))
    if pushes and not zoomed:
        tails = np.array([one.behind for one in pushes])
        whole = canvas.seen(*_with_ends(part, tails, 0.0), size)
    return pushes, whole


def _contact_arrows(
    results: Recording, number: int, part: canvas.Part, size: tuple[float, float], zoomed: bool
) -> tuple[Arrows, canvas.Part]:
    """Return the contact forces of a frame, and the part to show, with room for them."""
    low, high = canvas.seen(*part, size)
    per_inch = float(high[0] - low[0]) / size[0]
    arrows = arrows_of(results, number, low, high, per_inch, zoomed=zoomed)
    if zoomed or not len(arrows.at):
        return arrows, part
    return arrows, _with_ends(part, arrows.ends, per_inch)


def _draw_blocks(
    sheet: canvas.Sheet,
    axes: Axes,
    results: Recording,
    number: int,
    field: str,
    whole: canvas.Part,
    look: Look,
    outlined: float,
) -> Bools:
    """Draw the blocks of a frame, or its joints, by ``field``; return which blocks are shown.

    ``outlined`` is the width of the outlines of blocks.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    here, absent = results.vertices(number), absent_in_frame(results, number)
    draw_blocks.draw_start(axes, results, results.vertices(0), absent)
    awaited = results.awaited(number)
    free = draw_blocks.draw_blocks(axes, results, here, outlined, absent, awaited)
    shown = draw_blocks.within(results, here, *whole)
    if field in JOINT_FIELDS:
        free.set_facecolor(GROUND)
        faces = JOINT_FIELDS[field].faces(results, number)
        _draw_joints(figure, sheet, axes, faces, field, whole, look)
    else:
        draw_blocks.colour(figure, sheet, free, results, field, number, shown, look.limits)
    return shown


def _part(
    results: Recording, here: Floats, start: Floats, look: Look, waters: Sequence[Water]
) -> canvas.Part:
    """Return the part to show: all blocks, now and at the start, or the given part."""
    low = np.minimum(here.min(axis=0), start.min(axis=0))
    high = np.maximum(here.max(axis=0), start.max(axis=0))
    if look.zoom is None:
        return with_levels(results, waters, (low, high))
    part = np.array(look.zoom[:2]), np.array(look.zoom[2:])
    if not draw_blocks.within(results, here, *part).any():
        raise canvas.empty_part(low, high)
    return part


def _draw_joints(
    figure: Figure,
    sheet: canvas.Sheet,
    axes: Axes,
    faces: Faces,
    field: str,
    whole: canvas.Part,
    look: Look,
) -> None:
    """Draw the joints with slip or opening, and explain their colours."""
    scale = scale_of_faces(faces, faces.within(*whole), look.limits)
    lines, unit = draw_faces(axes, faces, scale, field)
    label = f"{JOINT_FIELDS[field].label} ({unit})"
    draw_blocks.draw_colour_bar(figure, sheet, lines, label, scale.extend)


def edges_of(
    results: Recording,
    field: str,
    here: Floats,
    start: Floats,
    part: canvas.Part,
    absent: Bools,
) -> Sequence[EdgeGroup]:
    """Return the edges that are drawn in the colours of their joints, if they are asked for."""
    if field != "joint":
        return ()
    together = TOGETHER * float((part[1] - part[0]).max())
    return edges_by_joint(results, here, start, together, absent)


def _with_ends(part: canvas.Part, ends: Floats, per_inch: float) -> canvas.Part:
    """Return the part to show, made so large that no arrow is cut off."""
    slack = HEAD * per_inch
    low = np.minimum(part[0], ends.min(axis=0) - slack)
    return low, np.maximum(part[1], ends.max(axis=0) + slack)


def _below(results: Recording, number: int, field: str, sheet: canvas.Sheet) -> str:
    """Return the line below the title: field, time and stage, without the field if need be."""
    time, stage = f"$t$ = {results.times[number]:.4g} s", results.frame(number).stage
    whole = f"{_label(field)} at {time}"
    if not stage:
        return whole
    letters = canvas.letters_in(sheet.size[0] - sheet.axes[0], canvas.TEXT_SIZE)
    for text in (f"{whole}, stage {stage}", f"Stage {stage}, {time}"):
        if len(text) <= letters + 2:  # the dollars are not seen
            return text.replace(stage, canvas.literal(stage))
    room = max(6, letters - len(time) - len("Stage , "))
    return f"Stage {canvas.literal(stage[: room - 1])}…, {time}"


def _label(field: str) -> str:
    if field in JOINT_FIELDS:
        return JOINT_FIELDS[field].label
    return SCALARS[field].label if field in SCALARS else KINDS[field]


def places_of_points(results: Recording, frames: Sequence[int]) -> Floats:
    """Return where the measured points are in some frames, m, shape (frames, points, 2)."""
    places = np.zeros((len(frames), len(results.point_name), 2))
    for number, (name, start) in enumerate(
        zip(results.point_name, results.point_start, strict=True)
    ):
        history = results.history(name)
        for place, frame in enumerate(frames):
            row = int(results.rows_at(history.time, frame))
            before = counted_from(results.stages, number, float(history.time[row]))
            places[place, number] = start + before + history.displacement[row]
    return places


def draw_points(axes: Axes, names: Sequence[str], places: Floats) -> None:
    """Mark the measured points (k, 2) where they are, the first few with their names."""
    for name, at in list(zip(names, places, strict=True))[:MOST_NAMES]:
        axes.plot(*at, "o", ms=3.5, mfc="white", mec=INK, mew=0.9, zorder=6)
        text, side = _beside(axes, name, float(at[0]))
        axes.annotate(
            canvas.literal(text),
            at,
            xytext=(4, 4) if side == "left" else (-4, 4),
            textcoords="offset points",
            ha=side,
            fontsize=SMALL_SIZE,
            color=INK,
            bbox=NAME_BOX,
            zorder=7,
        )


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


def legend_handles(results: Recording, field: str, frame: int) -> list[Any]:
    """Return the legend: outlines, fixed and excavated blocks, rocks."""
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
