"""The edges of a cut, each once, in groups that look alike: one for each joint, and a few more."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import FAINT, INK
from clast.rockmass import CONSTRUCTION, WELDED, Cut

JOINT_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#aa4499", "#e69f00", "#56b4e9", "#882255")
"""Colours of joints, told apart by most eyes (after Okabe and Ito, and Tol)."""
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1.5, 1)))
"""Lines of the first seven joints, of the next seven, and of all others."""
LONGEST = 40
"""Letters of a name in a legend, at most."""


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """How a group of edges is drawn."""

    label: str
    """What the legend says."""
    colour: str
    """Colour."""
    dashes: Any = "-"
    """Line style, as matplotlib has it."""
    width: float = 1.0
    """Width as a share of that of joints."""
    above: int = 0
    """Place in the order of drawing: higher ones lie above."""


@dataclass(frozen=True, kw_only=True)
class Edges:
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
PLAIN = Stroke(label="joints", colour=INK, width=0.7)
CONSTRUCTED = Stroke(
    label="construction joint", colour=INK, dashes=(0, (2.2, 1.0)), width=1.8, above=2
)
WELD = Stroke(label="welded: no joint", colour=FAINT, dashes=(0, (1, 1.5)), width=0.8, above=1)
RIM = Stroke(label="boundary", colour=INK, width=1.5, above=3)


@dataclass(frozen=True, kw_only=True)
class Sorted:
    """All edges of a cut, each once."""

    joints: tuple[Edges, ...]
    """Those of each joint that has some, then those along which no joint is named."""
    others: tuple[Edges, ...]
    """Welds, construction joints, and the rim where only one block is."""

    @property
    def rim(self) -> Floats:
        """Edges with rock on their left only, m, shape (n, 2, 2)."""
        found = [one.ends for one in self.others if one.stroke is RIM]
        return found[0] if found else np.zeros((0, 2, 2))

    @property
    def plain(self) -> tuple[Edges, ...]:
        """The joints all alike."""
        ends = [one.ends for one in self.joints]
        return (Edges(ends=np.concatenate(ends), stroke=PLAIN),) if ends else ()


def edges_of(cut: Cut) -> Sorted:
    """Return the edges of a cut by what they are, those inside once."""
    after = following(cut.block_start)
    ends = np.stack([cut.vertices, cut.vertices[after]], axis=1)
    rim, once = _sides(cut.vertices, after)
    number = np.where(rim, len(cut.joint_names), cut.edge_joint)
    special = {
        k: CONSTRUCTED for k, one in enumerate(cut.joint_names) if one.startswith(CONSTRUCTION)
    }
    special |= {cut.joint_names.index(WELDED): WELD, len(cut.joint_names): RIM}
    named = [k for k in range(len(cut.joint_names)) if k not in special]
    strokes = {k: _stroke(place, cut.joint_names[k]) for place, k in enumerate(named)}
    strokes[-1] = UNNAMED
    return Sorted(
        joints=_groups(strokes, number, ends, once), others=_groups(special, number, ends, once)
    )


def _groups(
    strokes: dict[int, Stroke], number: Ints, ends: Floats, once: Bools
) -> tuple[Edges, ...]:
    """Return the edges of each stroke that has some."""
    found = []
    for stroke in dict.fromkeys(strokes.values()):
        numbers = [k for k, one in strokes.items() if one is stroke]
        own = once & np.isin(number, numbers)
        if own.any():
            found.append(Edges(ends=ends[own], stroke=stroke))
    return tuple(found)


def _stroke(place: int, name: str) -> Stroke:
    row = min(place // len(JOINT_COLOURS), len(DASHES) - 1)
    return Stroke(
        label=label(name), colour=JOINT_COLOURS[place % len(JOINT_COLOURS)], dashes=DASHES[row]
    )


def label(name: str) -> str:
    """Return a name of the user's as a legend has it: short, and no formula."""
    whole = " ".join(name.split())
    return canvas.literal(
        whole if len(whole) <= LONGEST else textwrap.wrap(whole, LONGEST - 1)[0] + "…"
    )


def following(start: Ints) -> Ints:
    """Return the index of the vertex after each one in its block, shape (nv,)."""
    after = np.arange(1, start[-1] + 1)
    after[start[1:] - 1] = start[:-1]
    return after


def _sides(vertices: Floats, after: Ints) -> tuple[Bools, Bools]:
    """Return which edges have one block only, and which stand for their pair, shape (nv,) each.

    Neighbours share their nodes to the last digit, as ``cut`` makes them.
    """
    node = np.unique(vertices[:, 0] + 1j * vertices[:, 1], return_inverse=True)[1]
    here, there = node.astype(np.int64), node[after].astype(np.int64)
    count = np.int64(len(vertices))
    rim = ~np.isin(here * count + there, there * count + here)
    return rim, rim | (here < there)
