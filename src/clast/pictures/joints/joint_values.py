"""Numbers of joints on a picture: faces as lines, as wide as slip or opening is large.

Slip is that of the contacts: a face is a line between its outermost ones, with their mean, and
blocks that touch in one contact have a dot there.  Opening is that of edges that ran along each
other at the start, whether they touch or not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures.draw_blocks import paint
from clast.pictures.scale import ColourScale, scale_of
from clast.pictures.strokes import following, partners
from clast.results import Recording
from clast.results.frames import gone_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection


STRAIGHT = 12
"""Directions in half a turn that are told apart: faces of two blocks at a corner are two."""
APART = 0.5
"""Distance of two edges, as a share of their length, up to which they are still a joint."""
THIN, THICK = 0.7, 4.0
"""Widths of lines whose value is 0, and the largest, points."""


@dataclass(frozen=True, kw_only=True)
class Faces:
    """Faces of blocks with one number each; k faces."""

    ends: Floats
    """Their ends, m, shape (k, 2, 2); equal where there is one contact."""
    value: Floats
    """Mean of the contacts of each, shape (k,)."""
    edge: Ints
    """The vertex that an edge along it begins with, the same in all frames, shape (k,)."""

    @property
    def length(self) -> Floats:
        """Their lengths, m, shape (k,)."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    def within(self, low: Floats, high: Floats) -> Bools:
        """Return which may be seen in a part (low, high), m, shape (k,)."""
        seen: Bools = ((self.ends.max(axis=1) >= low) & (self.ends.min(axis=1) <= high)).all(axis=1)
        return seen


def faces_opened(results: Recording, frame: int) -> Faces:
    """Return the edges that ran along each other at the start, and how far they are apart, m.

    Blocks that are further from each other than APART of the edge are neighbours no more.
    """
    here, start = results.vertices(frame), results.vertices(0)
    after = following(results.block_start)
    other = partners(start, after)
    gone = np.repeat(gone_in_frame(results, frame), np.diff(results.block_start))
    own = np.flatnonzero((other > np.arange(len(other))) & ~gone & ~gone[other])
    mine = np.stack([here[own], here[after[own]]], axis=1)
    theirs = np.stack([here[after[other[own]]], here[other[own]]], axis=1)
    along = mine[:, 1] - mine[:, 0]
    length = np.maximum(np.hypot(*along.T), 1e-300)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    apart = np.einsum("kex,kx->ke", theirs - mine, out).mean(axis=1)
    near = np.hypot(*(theirs - mine).mean(axis=1).T) <= APART * length
    # what is pressed together is closed
    return Faces(
        ends=0.5 * (mine + theirs)[near], value=np.maximum(0.0, apart[near]), edge=own[near]
    )


def faces_slipped(results: Recording, frame: int) -> Faces:
    """Return the faces of a frame with the mean slip of their contacts, m.

    Raises CaseError where an earlier clast recorded the contacts, which did not keep it.
    """
    contacts = results.contacts(frame)
    values = contacts.slip
    if not len(values):
        return Faces(ends=np.zeros((0, 2, 2)), value=np.zeros(0), edge=np.zeros(0, np.int64))
    blocks = np.sort(np.stack([contacts.vertex_block, contacts.edge_block]), axis=0)
    along = np.stack([-contacts.normal[:, 1], contacts.normal[:, 0]], axis=1)
    angle = np.arctan2(along[:, 1], along[:, 0]) * STRAIGHT / np.pi
    direction = np.round(angle).astype(np.int64) % STRAIGHT
    key = np.stack([*blocks, direction], axis=1)
    _, first, face = np.unique(key, axis=0, return_index=True, return_inverse=True)
    face = face.ravel()
    place = np.einsum("mx,mx->m", contacts.position, along[first][face])
    order = np.lexsort((place, face))
    starts = np.flatnonzero(np.r_[True, np.diff(face[order]) != 0])
    last = np.r_[starts[1:], len(order)] - 1
    ends = np.stack([contacts.position[order[starts]], contacts.position[order[last]]], axis=1)
    count = last - starts + 1
    mean = np.add.reduceat(values[order], starts) / count
    return Faces(ends=ends, value=mean, edge=contacts.edge[order[starts]])


def together(some: Sequence[Faces]) -> Faces:
    """Return the faces of some frames as one."""
    return Faces(
        ends=np.concatenate([one.ends for one in some]),
        value=np.concatenate([one.value for one in some]),
        edge=np.concatenate([one.edge for one in some]),
    )


@dataclass(frozen=True)
class JointField:
    """A number of joints."""

    label: str
    """Its name on the picture."""
    unit: str
    """Its unit; the picture may put a prefix before it."""
    faces: Callable[[Recording, int], Faces]
    """Gives the faces of a frame with their numbers."""


JOINT_FIELDS = {
    "slip": JointField("Slip of joints", "m", faces_slipped),
    "opening": JointField("Opening of joints", "m", faces_opened),
}
"""Fields that colour joints, and not blocks."""


def scale_of_faces(faces: Faces, shown: Bools, limits: tuple[float, float] | None) -> ColourScale:
    """Return one scale for the faces that are ``shown`` (k,), weighted by their lengths."""
    counted = shown if shown.any() else np.ones(len(shown), np.bool_)
    length = faces.length[counted]
    weight = np.maximum(length, 0.1 * length.max(initial=0.0) + 1e-12)
    return scale_of(faces.value[counted], weight, limits)


def draw_faces(
    axes: Axes, faces: Faces, scale: ColourScale, field: str
) -> tuple[LineCollection, str]:
    """Draw faces on a scale; return them, and the unit with its prefix."""
    from matplotlib.collections import LineCollection

    largest = max(abs(scale.low), abs(scale.high))
    share = np.minimum(1.0, np.abs(faces.value) / largest) if largest > 0.0 else 0.0 * faces.value
    lines = LineCollection(
        list(faces.ends),
        linewidths=THIN + (THICK - THIN) * share,
        capstyle="round",
        zorder=4.5,
    )
    unit = paint(lines, faces.value, scale, JOINT_FIELDS[field].unit)
    axes.add_collection(lines)
    return lines, unit
