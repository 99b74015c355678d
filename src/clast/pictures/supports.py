"""Bolts, links and reactions on a picture.

Bolts are lines as wide as their force is large.  Circles are hinges, filled where a spring or a
clamp holds their rotation; squares hold rotation alone; a bar lies along the one direction that a
link holds, in zigzag where it is a spring.  A reaction is an arrow where its line of action passes
the contacts of the support: at the point of the line nearest to their middle, in which each contact
counts by its force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.model.model import Floats, Ints
from clast.model.supports import FREE, GROUND, RIGID, LinkLines
from clast.pictures import canvas
from clast.pictures.fields import prefixed
from clast.results import FrameBolts, FrameContacts, Recording
from clast.results.schema import BOLT_STATES, LINK_STATES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BOLT_LOOKS: tuple[tuple[str, str, Any], ...] = (
    ("bolt, not installed", "#8a8a8a", (0, (1, 1.5))),
    ("bolt", "#0b6b50", "-"),
    ("bolt, yielded", "#8e24aa", "-"),
    ("bolt, broken", "#c0143c", (0, (3, 1.5))),
)
"""Label, colour and line of a bolt by its state; those that are lost are not drawn."""
BOLT_BROKEN = BOLT_STATES.index("broken")
BOLT_THIN, BOLT_THICK = 1.3, 3.6
"""Widths of a bolt without a force, and with the largest, points."""


def handles_of_bolts(bolts: FrameBolts) -> list[Any]:
    """Return the legend of the bolts: states, and the largest force."""
    from matplotlib.lines import Line2D

    handles = []
    for state, (label, colour, line) in enumerate(BOLT_LOOKS):
        forces = bolts.force[bolts.state == state]
        if not len(forces):
            continue
        largest = float(np.abs(forces).max())
        if largest > 0.0:
            factor, unit = prefixed(float(np.abs(bolts.force).max()), "N/m")
            label = f"{label}, up to {factor * largest:.3g} {unit}"
        looks: dict[str, Any] = {
            "lw": _width(largest, bolts.force),
            "marker": "x" if state == BOLT_BROKEN else "",
        }
        handles.append(Line2D([], [], color=colour, ls=line, ms=4.5, label=label, **looks))
    return handles


def draw_bolts(axes: Axes, bolts: FrameBolts) -> None:
    """Draw the bolts of a frame, heads as dots, broken ones crossed out in their middle."""
    for k in np.flatnonzero(bolts.state < len(BOLT_LOOKS)):
        points = bolts.points[bolts.bolt == k]
        state = int(bolts.state[k])
        _, colour, line = BOLT_LOOKS[state]
        width = _width(float(bolts.force[k]), bolts.force)
        axes.plot(*points.T, "-", color="white", lw=width + 1.8, zorder=5.2)
        axes.plot(*points.T, ls=line, color=colour, lw=width, zorder=5.3)
        axes.plot(*points[0], "o", color=colour, ms=width + 1.6, mec="white", mew=0.4, zorder=5.4)
        if state == BOLT_BROKEN:
            middle = 0.5 * (points[0] + points[-1])
            axes.plot(*middle, "x", color=colour, ms=5.0, mew=1.4, zorder=5.4)


def _width(force: float, forces: Floats) -> float:
    """Return the width of a bolt with a force, among all forces, points."""
    largest = float(np.abs(forces).max())
    share = abs(force) / largest if largest > 0.0 else 0.0
    return BOLT_THIN + (BOLT_THICK - BOLT_THIN) * share


LINK_COLOURS = dict(zip(LINK_STATES, ("#8a8a8a", "#0b6b50", "#8e24aa", "#c0143c"), strict=True))
"""Colour of a link by its state."""
LINK_BROKEN = LINK_STATES.index("broken")
LINK_SIZE, LINK_EDGE = 6.0, 1.4
"""Size of circles and squares, and width of their edges, points."""


def states_of(results: Recording, frame: int) -> Ints:
    """Return the states of the links with a place in a frame, by their numbers, shape (k,)."""
    links = map(results.link, results.link_lines.name)
    states = [rows["state"][int(results.rows_at(rows["time"], frame))] for rows in links]
    return np.array(states, np.int64)


def places_of(results: Recording, frame: int) -> Floats:
    """Return where both blocks of each link carry its point, m, shape (k, 2, 2)."""
    links, start = results.link_lines, results.block_start
    before, now = results.vertices(0), results.vertices(frame)
    places = np.zeros((len(links.at), 2, 2))
    for link, (blocks, at) in enumerate(zip(links.block, links.at, strict=True)):
        for end, block in enumerate(blocks):
            if block == GROUND:
                places[link, end] = at
                continue
            corners = slice(start[block], start[block + 1])
            middle = before[corners].mean(axis=0)
            # a block moves as x -> a + B x, all of its vertices and the point alike
            ones = np.ones((start[block + 1] - start[block], 1))
            known = np.hstack([before[corners] - middle, ones])
            moves, *_ = np.linalg.lstsq(known, now[corners], rcond=None)
            places[link, end] = np.append(at - middle, 1.0) @ moves
    return places


def directions_of(results: Recording, frame: int) -> Floats:
    """Return the one direction that each link holds in a frame, (k, 2), or (0, 0)."""
    # a link turns with the first edge of its first block; on the ground it stays
    links = results.link_lines
    if not links.name:
        return np.zeros((0, 2))
    first = results.block_start[links.block[:, 0]]
    before, now = (
        (results.vertices(k)[first + 1] - results.vertices(k)[first]) @ [1.0, 1.0j]
        for k in (0, frame)
    )
    turn = np.where(links.block[:, 1] == GROUND, 1.0, now / before)
    direction = links.along @ np.array([1.0, 1.0j]) * turn / np.abs(turn)
    direction = np.where(links.holds[:, 0] > 0, direction, 1.0j * direction)
    bar = np.count_nonzero(links.holds[:, :2], axis=1) == 1
    return np.stack([direction.real, direction.imag], axis=1) * bar[:, None]


def handles_of_links(results: Recording, frame: int) -> list[Any]:
    """Return the legend of the links: an entry for each state."""
    from matplotlib.lines import Line2D

    handles = []
    looks: dict[str, Any] = {"ls": "", "ms": LINK_SIZE, "mfc": "white", "mew": LINK_EDGE}
    for state in np.unique(states_of(results, frame)).tolist():
        name = LINK_STATES[state]
        mark, label = "x" if state == LINK_BROKEN else "o", link_label(name)
        handles.append(Line2D([], [], marker=mark, mec=LINK_COLOURS[name], label=label, **looks))
    return handles


def link_label(state: str) -> str:
    """Return the entry of a legend for links in a state."""
    return "link" if state == "intact" else f"link, {state}"


def draw_links(axes: Axes, results: Recording, frame: int) -> None:
    """Draw the links of a frame; a line joins the two points of one that is drawn apart."""
    links = results.link_lines
    if not links.name:
        return
    wide = float(np.ptp(axes.get_xlim()))
    states, places = states_of(results, frame), places_of(results, frame)
    directions = directions_of(results, frame)
    for state, ends, direction, holds in zip(states, places, directions, links.holds, strict=True):
        colour, middle = LINK_COLOURS[LINK_STATES[state]], ends.mean(axis=0)
        axes.plot(*ends.T, "-", color=colour, lw=LINK_EDGE, zorder=5.5)
        draw_link(axes, middle, direction * 0.018 * wide, holds, colour)
        if state == LINK_BROKEN:
            axes.plot(*middle, "x", color=colour, ms=1.5 * LINK_SIZE, mew=LINK_EDGE, zorder=5.7)


def draw_links_at_start(axes: Axes, links: LinkLines, reach: float) -> None:
    """Draw links where they are at the start, with bars of half this length, m."""
    across = np.stack([-links.along[:, 1], links.along[:, 0]], axis=1)
    direction = np.where(links.holds[:, :1] > 0, links.along, across)
    bar = np.count_nonzero(links.holds[:, :2], axis=1) == 1
    halves = reach * direction * bar[:, None]
    for at, half, holds in zip(links.at, halves, links.holds, strict=True):
        draw_link(axes, at, half, holds, LINK_COLOURS["intact"])


def draw_link(axes: Axes, at: Floats, half: Floats, holds: Ints, colour: str) -> None:
    """Draw a link at a point (2,), m: half of its bar (2,), m, or (0, 0), and its mark."""
    if half.any():
        bar = _bar(at, half, int(holds[:2].max()))
        axes.plot(*bar.T, "-", color=colour, lw=LINK_EDGE, zorder=5.5)
    if holds[:2].all() or holds[2]:
        looks: dict[str, Any] = {"ms": LINK_SIZE, "mew": LINK_EDGE, "mec": colour, "zorder": 5.6}
        mark, fill = "o" if holds[:2].any() else "s", colour if holds[2] else "white"
        axes.plot(*at, mark, mfc=fill, **looks)


def _bar(middle: Floats, half: Floats, holds: int) -> Floats:
    """Return the line of a link that holds one direction, m, shape (p, 2)."""
    if holds in (FREE, RIGID):
        return np.stack([middle - half, middle + half])
    across = np.array([-half[1], half[0]])
    place = np.linspace(-1.0, 1.0, 8)
    swing = 0.35 * np.where(np.arange(8) % 2, 1.0, -1.0)
    swing[[0, -1]] = 0.0
    return np.asarray(middle + place[:, None] * half + swing[:, None] * across)


REACTION_COLOUR = "#7a3b00"
LONGEST, SHORTEST, LABEL_ROOM = 0.16, 0.05, 0.03
"""Lengths of the arrows of the largest force and of small ones, and room for a label behind the
tail of its arrow, in widths of the picture."""


@dataclass(frozen=True)
class ReactionArrow:
    """The arrow of a reaction."""

    label: str
    """Name and size."""
    tip: Floats
    """Where the reaction acts, m, shape (2,)."""
    tail: Floats
    """Where the arrow begins, m, shape (2,)."""
    behind: Floats
    """Point behind its tail up to where its label is, m, shape (2,)."""


def reaction_arrows(results: Recording, frame: int, wide: float) -> list[ReactionArrow]:
    """Return the arrows of the step before a frame, in a picture ``wide`` m wide."""
    reactions = forces_in(results, frame)
    sizes = np.array([np.hypot(*force) for _, _, force in reactions])
    largest = float(sizes.max(initial=0.0))
    arrows = []
    for (name, at, force), size in zip(reactions, sizes, strict=True):
        if not size > 1e-6 * largest:
            continue
        length = wide * max(SHORTEST, LONGEST * size / largest)
        factor, unit = prefixed(largest, "N/m")
        back = -force / size
        arrows.append(
            ReactionArrow(
                label=f"{name}: {factor * size:.3g} {unit}",
                tip=at,
                tail=at + length * back,
                behind=at + (length + LABEL_ROOM * wide) * back,
            )
        )
    return arrows


def draw_reactions(axes: Axes, arrows: list[ReactionArrow]) -> None:
    """Draw the arrows, each with its label at its tail, away from the nearer side."""
    low, high = axes.get_xlim()
    for one in arrows:
        arrow: Any = {"arrowstyle": "-|>", "color": REACTION_COLOUR, "lw": 1.8}
        arrow |= {"shrinkA": 0, "shrinkB": 0}
        axes.annotate("", tuple(one.tip), xytext=tuple(one.tail), arrowprops=arrow, zorder=8)
        right = one.tail[0] > 0.5 * (low + high)
        away = (-4 if right else 4, -9 if one.tail[1] < one.tip[1] else 4)
        beside: dict[str, Any] = {
            "ha": "right" if right else "left",
            "va": "baseline",
            "textcoords": "offset points",
        }
        looks: dict[str, Any] = {
            "color": REACTION_COLOUR,
            "bbox": {**canvas.NAME_BOX, "alpha": 0.8},
        }
        canvas.write(axes, canvas.literal(one.label), one.tail, 9, xytext=away, **beside, **looks)


def forces_in(results: Recording, frame: int) -> list[tuple[str, Floats, Floats]]:
    """Return name, point of application (2,), m, and force (2,), N/m, of reactions in a frame."""
    # of those that are one and the same, a total and its only part, the last
    reactions: dict[tuple[float, ...], tuple[str, Floats, Floats]] = {}
    contacts, of_block = results.contacts(frame), results.reaction_of_block
    for number, name in enumerate(results.reaction_name):
        rows = results.reaction(name)
        row = int(results.rows_at(rows.time, frame))
        if np.isfinite(rows.position[row]).all():
            at, force = rows.position[row], rows.force[row]
            blocks = of_block[of_block[:, 0] == number, 1]
            place = _beside_contacts(at, force, contacts, blocks)
            reactions[tuple(np.round([*at, *force], 6).tolist())] = name, place, force
    return list(reactions.values())


def _beside_contacts(at: Floats, force: Floats, contacts: FrameContacts, blocks: Ints) -> Floats:
    """Return the point of a line of action, through ``at``, nearest to the contacts of blocks."""
    mine = np.isin(contacts.vertex_block, blocks) != np.isin(contacts.edge_block, blocks)
    weight = np.hypot(*contacts.force[mine].T)
    if not weight.sum() > 0.0:
        return at
    middle = weight @ contacts.position[mine] / weight.sum()
    return np.asarray(at + force * ((middle - at) @ force) / (force @ force))
