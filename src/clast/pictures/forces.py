"""Contact forces on a picture: as many arrows as can be told apart, none cut off."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.model.model import Floats, Ints
from clast.pictures.canvas import INK, SMALL, SMALL_SIZE, Sheet, letters_in
from clast.pictures.draw_blocks import outlines_of
from clast.pictures.fields import largest_but_few, prefixed, round_below
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NEAR_CONTACTS_MAX, APART, FARTHER = 400, 0.06, 0.2
"""Distance of arrows of up to so many contacts, and of more, inches: of nearer ones the largest
alone is drawn."""
HEAD = 0.02
"""Length of the head of the shortest arrow beyond its end, inches."""
ARROW = "#111111"


@dataclass(frozen=True)
class Arrows:
    """Contact forces to be drawn, a pair of arrows each; k pairs."""

    at: Floats
    """Where they act, m, shape (k, 2)."""
    vector: Floats
    """Arrow of the force on the invading vertex's block, m, shape (k, 2)."""
    longest: float
    """Length that stands for ``largest``, m."""
    largest: float
    """Force that the longest arrow stands for, N/m."""
    cut: int
    """Arrows that are drawn as long as the longest though their force is larger."""
    contacts: int
    """Contacts in the part that is shown."""
    thinned: bool
    """True where only the largest of each place are drawn."""

    @property
    def ends(self) -> Floats:
        """Where all arrows end, m, shape (2 k, 2)."""
        return np.concatenate([self.at + self.vector, self.at - self.vector])


def arrows_of(
    results: Recording, frame: int, low: Floats, high: Floats, per_inch: float, *, zoomed: bool
) -> Arrows:
    """Return the arrows in a part of a frame; those of a ``zoomed`` one do not leave it."""
    contacts = results.contacts(frame)
    at, force = contacts.position, contacts.force
    size = np.hypot(*force.T)
    shown = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1) & (size > 0.0))
    count = len(shown)
    apart = (APART if count <= NEAR_CONTACTS_MAX else FARTHER) * per_inch
    shown = shown[keep_apart(at[shown], size[shown], apart)]
    thinned = len(shown) < count
    size = size[shown]
    largest = largest_but_few(size, np.ones(len(size)), 0.05)
    longest = max(length_of_longest(results, low, high), 0.5 * apart)
    length = longest * np.minimum(1.0, size / largest) if len(size) else size
    vector = force[shown] * (length / size)[:, None]
    at = at[shown]
    if zoomed:
        slack = HEAD * per_inch
        ends = np.stack([at + vector, at - vector])
        inside = ((ends >= low + slack) & (ends <= high - slack)).all(axis=(0, 2))
        at, vector, size = at[inside], vector[inside], size[inside]
    return Arrows(at, vector, longest, largest, int(np.sum(size > largest)), count, thinned)


def keep_apart(at: Floats, size: Floats, distance: float) -> Ints:
    """Return which points (k, 2) are kept so that none is within ``distance`` of a larger one."""
    from scipy.spatial import KDTree  # slow to load

    if not len(at):
        return np.zeros(0, np.int64)
    near = KDTree(at)
    left, kept = np.ones(len(at), np.bool_), []
    for point in np.argsort(-size, kind="stable"):
        if left[point]:
            kept.append(point)
            left[near.query_ball_point(at[point], distance)] = False
    return np.sort(np.array(kept, np.int64))


def draw_arrows(figure: Figure, sheet: Sheet, axes: Axes, arrows: Arrows) -> None:
    """Draw the arrows and explain their length below, and which are drawn."""
    width, height = sheet.size
    if not len(arrows.at):
        text = "no contact carries a force" if not arrows.contacts else "no arrow fits in here"
        figure.text(sheet.axes[0] / width, 0.2 / height, text, va="center", **SMALL)
        return
    inches = arrows.longest * sheet.axes[2] / float(np.ptp(axes.get_xlim()))
    drawn = axes.quiver(
        *np.concatenate([arrows.at, arrows.at]).T,
        *np.concatenate([arrows.vector, -arrows.vector]).T,
        color=ARROW,
        edgecolor="white",
        linewidth=0.3 if inches > 0.2 else 0.0,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=float(np.clip(0.08 * inches, 0.005, 0.022)),
        minlength=0.0,
        zorder=5,
    )
    shown = round_below(arrows.largest)
    after = sheet.axes[0] + inches * shown / arrows.largest
    texts = _words(arrows, shown)
    letters = letters_in(width - after - 0.2, SMALL_SIZE)
    axes.quiverkey(
        drawn,
        after / width,
        0.2 / height,
        arrows.longest * shown / arrows.largest,
        next((text for text in texts if len(text) <= letters), texts[-1]),
        coordinates="figure",
        labelpos="E",
        labelsep=0.15,
        fontproperties={"size": SMALL_SIZE},
        labelcolor=INK,
    )


def _words(arrows: Arrows, shown: float) -> list[str]:
    """Return the texts for the arrows: the force ``shown``, N/m, and which; shorter and shorter."""
    factor, unit = prefixed(shown, "N/m")
    force = f"contact force, {shown * factor:g} {unit}"
    which = "the largest of each place: " if arrows.thinned else ""
    factor, unit = prefixed(arrows.largest, "N/m")
    most = f"; {arrows.cut} above {arrows.largest * factor:.3g} {unit} drawn as long as that"
    cut = most if arrows.cut else ""
    if len(arrows.at) == arrows.contacts:
        return [force + cut, force]
    counted = f"{len(arrows.at):,} of {arrows.contacts:,}"
    return [f"{force} ({which}{counted}){cut}", f"{force} ({counted}){cut}", f"{force} ({counted})"]


def length_of_longest(results: Recording, low: Floats, high: Floats) -> float:
    """Return the length of the longest arrow, m: about a block, but seen in the picture."""
    shown = float(np.hypot(*(high - low)))
    outlines = outlines_of(results, results.vertices(0))
    block = float(np.median([np.ptp(outline, axis=0).min() for outline in outlines]))
    # about half a block to each side: arrows of a row of blocks hardly run into each other
    return float(np.clip(0.6 * block, 0.012 * shown, 0.09 * shown))
