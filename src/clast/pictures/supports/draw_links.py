"""Links on a picture: hinges, clamps, springs and struts, coloured by their state.

Circles are hinges, filled where a spring or a clamp holds their rotation; squares hold rotation
alone; a bar lies along the one direction that a link holds, in zigzag where it is a spring.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats, Ints
from clast.model.supports import FREE, GROUND, RIGID, LinkLines
from clast.results import Recording
from clast.results.schema import LINK_STATES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = dict(zip(LINK_STATES, ("#8a8a8a", "#0b6b50", "#8e24aa", "#c0143c"), strict=True))
"""Colour of a link by its state."""
BROKEN = LINK_STATES.index("broken")
REACH = 0.018
"""Half of the length of bars, in units of the picture's width."""
TEETH = 8
"""Corners of a zigzag."""
SIZE, EDGE = 6.0, 1.4
"""Size of circles and squares, and width of their edges, points."""


def states_of(results: Recording, frame: int) -> Ints:
    """Return the states of the links with a place in a frame, by their numbers, shape (k,)."""
    found = []
    for name in results.supported.links.name:
        rows = results.link(name)
        row = int(results.rows_at(rows["time"], frame))
        found.append(int(rows["state"][row]))
    return np.array(found, np.int64)


def places_of(results: Recording, frame: int) -> Floats:
    """Return where both blocks of each link carry its point, m, shape (k, 2, 2).

    That on the ground is drawn where it was at the start.
    """
    links, start = results.supported.links, results.block_start
    before, now = results.vertices(0), results.vertices(frame)
    found = np.zeros((len(links.at), 2, 2))
    for link, (blocks, at) in enumerate(zip(links.block, links.at, strict=True)):
        for end, block in enumerate(blocks):
            if block == GROUND:
                found[link, end] = at
                continue
            own = slice(start[block], start[block + 1])
            middle = before[own].mean(axis=0)
            # a block moves as x -> a + B x, all of its vertices and the point alike
            ones = np.ones((start[block + 1] - start[block], 1))
            known = np.hstack([before[own] - middle, ones])
            moves, *_ = np.linalg.lstsq(known, now[own], rcond=None)
            found[link, end] = np.append(at - middle, 1.0) @ moves
    return found


def ways_of(results: Recording, frame: int) -> Floats:
    """Return the direction of the bar of each link in a frame, (k, 2); (0, 0) where it has none.

    It is the one direction that such a link holds, turned as the first edge of its first block; on
    the ground it stays.
    """
    links = results.supported.links
    if not links.name:
        return np.zeros((0, 2))
    first = results.block_start[links.block[:, 0]]
    before, now = (_edge_after(results.vertices(k), first) for k in (0, frame))
    turn = np.where(links.block[:, 1] == GROUND, 1.0, now / before)
    way = links.along @ np.array([1.0, 1.0j]) * turn / np.abs(turn)
    way = np.where(links.holds[:, 0] > 0, way, 1.0j * way)
    bar = np.count_nonzero(links.holds[:, :2], axis=1) == 1
    return np.stack([way.real, way.imag], axis=1) * bar[:, None]


def _edge_after(vertices: Floats, first: Ints) -> NDArray[np.complex128]:
    """Return the edges that begin at some vertices, as complex numbers, m, (k,)."""
    return np.asarray((vertices[first + 1] - vertices[first]) @ np.array([1.0, 1.0j]))


def handles_of_links(results: Recording, frame: int) -> list[Any]:
    """Return the legend of the links: an entry for each state."""
    from matplotlib.lines import Line2D

    found = []
    for state in np.unique(states_of(results, frame)).tolist():
        said = LINK_STATES[state]
        found.append(
            Line2D(
                [],
                [],
                ls="",
                marker="x" if state == BROKEN else "o",
                ms=SIZE,
                mfc="white",
                mec=COLOURS[said],
                mew=EDGE,
                label="link" if said == "intact" else f"link, {said}",
            )
        )
    return found


def draw_links(axes: Axes, results: Recording, frame: int) -> None:
    """Draw the links of a frame; a line joins the two points of one that is drawn apart."""
    links = results.supported.links
    if not links.name:
        return
    wide = float(np.ptp(axes.get_xlim()))
    states, places = states_of(results, frame), places_of(results, frame)
    ways = ways_of(results, frame)
    for state, ends, way, holds in zip(states, places, ways, links.holds, strict=True):
        colour, middle = COLOURS[LINK_STATES[state]], ends.mean(axis=0)
        axes.plot(*ends.T, "-", color=colour, lw=EDGE, zorder=5.5)
        draw_link(axes, middle, way * REACH * wide, holds, colour)
        if state == BROKEN:
            axes.plot(*middle, "x", color=colour, ms=1.5 * SIZE, mew=EDGE, zorder=5.7)


def draw_links_at_start(axes: Axes, links: LinkLines, reach: float) -> None:
    """Draw links where they are at the start, with bars of half this length, m."""
    across = np.stack([-links.along[:, 1], links.along[:, 0]], axis=1)
    way = np.where(links.holds[:, :1] > 0, links.along, across)
    bar = np.count_nonzero(links.holds[:, :2], axis=1) == 1
    for at, half, holds in zip(links.at, reach * way * bar[:, None], links.holds, strict=True):
        draw_link(axes, at, half, holds, COLOURS["intact"])


def draw_link(axes: Axes, at: Floats, half: Floats, holds: Ints, colour: str) -> None:
    """Draw a link at a point (2,), m: half of its bar (2,), m, or (0, 0), and its mark."""
    if half.any():
        bar = _bar(at, half, int(holds[:2].max()))
        axes.plot(*bar.T, "-", color=colour, lw=EDGE, zorder=5.5)
    if holds[:2].all() or holds[2]:
        axes.plot(
            *at,
            "o" if holds[:2].any() else "s",
            ms=SIZE,
            mfc=colour if holds[2] else "white",
            mec=colour,
            mew=EDGE,
            zorder=5.6,
        )


def _bar(middle: Floats, half: Floats, holds: int) -> Floats:
    """Return the line of a link that holds one direction, m, shape (p, 2)."""
    if holds in (FREE, RIGID):
        return np.stack([middle - half, middle + half])
    across = np.array([-half[1], half[0]])
    place = np.linspace(-1.0, 1.0, TEETH)
    swing = 0.35 * np.where(np.arange(TEETH) % 2, 1.0, -1.0)
    swing[[0, -1]] = 0.0
    return np.asarray(middle + place[:, None] * half + swing[:, None] * across)
