"""Reactions on a picture: arrows that push where supports push the blocks, with their forces.

A reaction is drawn where its line of action passes the contacts of the support: at the point of the
line nearest to their middle, in which each contact counts by its force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.model.model import Floats, Ints
from clast.pictures import canvas
from clast.pictures.canvas import SMALL_SIZE
from clast.pictures.fields import prefixed
from clast.results import FrameContacts, Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOUR = "#7a3b00"
LONGEST, SHORTEST = 0.16, 0.05
"""Lengths of the arrows of the largest force and of small ones, in units of the picture's width."""
LEAST = 1e-6
"""Force, in units of the largest, that is not drawn."""
ROOM = 0.03
"""Room for a label behind the tail of its arrow, in the same units."""


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
    found = forces_in(results, frame)
    sizes = np.array([np.hypot(*force) for _, _, force in found])
    largest = float(sizes.max(initial=0.0))
    arrows = []
    for (name, at, force), size in zip(found, sizes, strict=True):
        if not size > LEAST * largest:
            continue
        length = wide * max(SHORTEST, LONGEST * size / largest)
        factor, unit = prefixed(size, "N/m")
        back = -force / size
        arrows.append(
            ReactionArrow(
                label=f"{name}: {factor * size:.3g} {unit}",
                tip=at,
                tail=at + length * back,
                behind=at + (length + ROOM * wide) * back,
            )
        )
    return arrows


def draw_reactions(axes: Axes, arrows: list[ReactionArrow]) -> None:
    """Draw the arrows, each with its label at its tail, away from the nearer side."""
    low, high = axes.get_xlim()
    for one in arrows:
        axes.annotate(
            "",
            (float(one.tip[0]), float(one.tip[1])),
            xytext=(float(one.tail[0]), float(one.tail[1])),
            arrowprops={
                "arrowstyle": "-|>",
                "color": COLOUR,
                "lw": 1.8,
                "shrinkA": 0,
                "shrinkB": 0,
            },
            zorder=8,
        )
        right = one.tail[0] > 0.5 * (low + high)
        axes.annotate(
            canvas.literal(one.label),
            (float(one.tail[0]), float(one.tail[1])),
            xytext=(-4 if right else 4, -9 if one.tail[1] < one.tip[1] else 4),
            textcoords="offset points",
            ha="right" if right else "left",
            fontsize=SMALL_SIZE,
            color=COLOUR,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8},
            zorder=9,
        )


def forces_in(results: Recording, frame: int) -> list[tuple[str, Floats, Floats]]:
    """Return name, point of application (2,), m, and force (2,), N/m, of reactions in a frame.

    Of those that are one and the same, a total and its only part, the last.
    """
    found: dict[tuple[float, ...], tuple[str, Floats, Floats]] = {}
    contacts, of_block = results.contacts(frame), results.supported.of_block
    for number, name in enumerate(results.reaction_name):
        rows = results.reaction(name)
        row = int(results.rows_at(rows.time, frame))
        if np.isfinite(rows.position[row]).all():
            at, force = rows.position[row], rows.force[row]
            blocks = of_block[of_block[:, 0] == number, 1]
            found[tuple(np.round([*at, *force], 6).tolist())] = (
                name,
                _beside_contacts(at, force, contacts, blocks),
                force,
            )
    return list(found.values())


def _beside_contacts(at: Floats, force: Floats, contacts: FrameContacts, blocks: Ints) -> Floats:
    """Return the point of a line of action nearest to the middle of the contacts of blocks.

    It is ``at`` (2,) itself where they have none.
    """
    mine = np.isin(contacts.vertex_block, blocks) != np.isin(contacts.edge_block, blocks)
    weight = np.hypot(*contacts.force[mine].T)
    if not weight.sum() > 0.0:
        return at
    middle = weight @ contacts.position[mine] / weight.sum()
    return np.asarray(at + force * ((middle - at) @ force) / (force @ force))
