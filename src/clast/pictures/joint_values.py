"""Numbers of joints on a picture: faces as lines, as wide as slip or opening is large.

Slip is that of the contacts: a face is a line between its outermost ones, with their mean, and
blocks that touch in one contact have a dot there; so are mobilised friction and the share that
slides.  Opening is that of edges that ran along each other at the start, whether they touch or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from clast.contact.contacts import SLIDE
from clast.model.model import Bools, Floats, Ints
from clast.pictures.faces import Faces
from clast.pictures.fields import ColourScale, Field, scale_of
from clast.pictures.flow_values import FLOW_FIELDS
from clast.pictures.magnified import as_it_was
from clast.pictures.strokes import following, partners
from clast.results import FrameContacts, Recording
from clast.results.frames import absent_in_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection

DIRECTIONS = 12
"""Directions in half a turn that are told apart: faces of two blocks at a corner are two."""
THIN, THICK = 0.7, 4.0
"""Widths of lines whose value is 0, and the largest, points."""


def faces_opened(results: Recording, frame: int) -> Faces:
    """Return the edges that ran along each other at the start, and how far they are apart, m."""
    here, start = as_it_was(results).vertices(frame), results.vertices(0)
    after = following(results.block_start)
    other = partners(start, after)
    absent = np.repeat(absent_in_frame(results, frame), np.diff(results.block_start))
    edge = np.flatnonzero((other > np.arange(len(other))) & ~absent & ~absent[other])
    mine = np.stack([here[edge], here[after[edge]]], axis=1)
    theirs = np.stack([here[after[other[edge]]], here[other[edge]]], axis=1)
    along = mine[:, 1] - mine[:, 0]
    length = np.maximum(np.hypot(*along.T), 1e-300)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    apart = np.einsum("kex,kx->ke", theirs - mine, out).mean(axis=1)
    near = np.hypot(*(theirs - mine).mean(axis=1).T) <= 0.5 * length
    # further apart they are no neighbours; what is pressed together is closed
    drawn, (edge, value) = results.vertices(frame), (edge[near], np.maximum(0.0, apart[near]))
    mine = np.stack([drawn[edge], drawn[after[edge]]], axis=1)
    theirs = np.stack([drawn[after[other[edge]]], drawn[other[edge]]], axis=1)
    return Faces(ends=0.5 * (mine + theirs), value=value, edge=edge)


def _from_sums(
    columns: Callable[[FrameContacts], tuple[Floats, Floats]],
    value: Callable[[Floats, Floats], Floats],
) -> Callable[[Recording, int], Faces]:
    """Return the function that gives each face of a frame a value of two sums over its contacts."""

    def values(results: Recording, frame: int) -> Faces:
        contacts = results.contacts(frame)
        faces, sums = _faces_of(contacts, *columns(contacts))
        return replace(faces, value=value(*sums))

    return values


def _percent(part: Floats, whole: Floats) -> Floats:
    return np.asarray(100.0 * np.abs(part) / np.maximum(whole, 1e-300))


def _friction_angle(shear: Floats, normal: Floats) -> Floats:
    """Return atan of shear over normal, degrees; 90 where cohesion holds without pressure."""
    return np.degrees(np.arctan2(np.abs(shear), np.maximum(0.0, normal)))


def _sliding(contacts: FrameContacts) -> tuple[Floats, Floats]:
    pressure = np.maximum(0.0, contacts.normal_force)
    return pressure * (contacts.mode == SLIDE), pressure


def _stress(results: Recording, frame: int, force: str) -> Faces:
    """Return the faces of a frame with a force over their length, Pa; corners have no length."""
    contacts = results.contacts(frame)
    faces, sums = _faces_of(contacts, contacts[force])
    first, _ = _divided(contacts)
    x, y = results.vertices(0).T
    after = following(results.block_start)
    area = 0.5 * np.add.reduceat(x * y[after] - x[after] * y, results.block_start[:-1])
    smaller = area[np.stack([contacts.vertex_block[first], contacts.edge_block[first]])].min(axis=0)
    # of contacts that are nearly in one place there is no face
    long = np.flatnonzero(faces.length > 0.01 * np.sqrt(smaller))
    value = sums[0][long] / faces.length[long]
    return Faces(
        ends=faces.ends[long],
        value=np.abs(value) if force == "shear_force" else value,
        edge=faces.edge[long],
    )


def _faces_of(contacts: FrameContacts, *values: Floats) -> tuple[Faces, list[Floats]]:
    """Return the faces that contacts lie along, without values, and sums of ``values`` (m,)."""
    if not len(contacts):
        nothing = np.zeros(0)
        faces = Faces(ends=np.zeros((0, 2, 2)), value=nothing, edge=np.zeros(0, np.int64))
        return faces, [nothing for _ in values]
    along = np.stack([-contacts.normal[:, 1], contacts.normal[:, 0]], axis=1)
    first, face = _divided(contacts)
    place = np.einsum("mx,mx->m", contacts.position, along[first][face])
    order = np.lexsort((place, face))
    starts = np.flatnonzero(np.r_[True, np.diff(face[order]) != 0])
    last = np.r_[starts[1:], len(order)] - 1
    ends = np.stack([contacts.position[order[starts]], contacts.position[order[last]]], axis=1)
    faces = Faces(ends=ends, value=np.zeros(len(starts)), edge=contacts.edge[order[starts]])
    return faces, [np.add.reduceat(one[order], starts) for one in values]


def _divided(contacts: FrameContacts) -> tuple[Ints, Ints]:
    """Return the first contact of each face (k,), and the face of each contact (m,)."""
    blocks = np.sort(np.stack([contacts.vertex_block, contacts.edge_block]), axis=0)
    angle = np.arctan2(contacts.normal[:, 0], -contacts.normal[:, 1]) * DIRECTIONS / np.pi
    key = np.stack([*blocks, np.round(angle).astype(np.int64) % DIRECTIONS], axis=1)
    _, first, face = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return first, face.ravel()


@dataclass(frozen=True, kw_only=True)
class Resultants:
    """The resultant force of each face; k faces."""

    at: Floats
    """Centre of its contacts, weighted by their forces, m, shape (k, 2)."""
    size: Floats
    """Its size, N/m, shape (k,)."""
    block: Ints
    """The blocks on either side, shape (k, 2)."""


def resultants_of(contacts: FrameContacts) -> Resultants:
    """Return the resultant forces of the faces that contacts lie along."""
    first, face = _divided(contacts)
    force = contacts.force
    # on the block with the lower number, whichever has the vertex
    force[contacts.vertex_block > contacts.edge_block] *= -1.0
    weight = np.hypot(*force.T)

    def summed(values: Floats) -> Floats:
        return np.bincount(face, values, len(first)).astype(np.float64)

    total = np.maximum(summed(weight), 1e-300)
    at = np.stack([summed(weight * x) / total for x in contacts.position.T], axis=1)
    blocks = np.stack([contacts.vertex_block[first], contacts.edge_block[first]], axis=1)
    return Resultants(at=at, size=np.hypot(*map(summed, force.T)), block=blocks)


JOINT_FIELDS = {
    "slip": Field(
        "Slip of joints", "m", _from_sums(lambda one: (one.slip, np.ones(len(one))), np.divide)
    ),
    "opening": Field("Opening of joints", "m", faces_opened),
    "mobilised": Field(
        "Mobilised friction of joints",
        "°",
        _from_sums(lambda one: (one.shear_force, one.normal_force), _friction_angle),
    ),
    "sliding": Field("Share of joints that slides", "%", _from_sums(_sliding, _percent)),
    "utilisation": Field(
        "Shear over strength of joints",
        "%",
        _from_sums(lambda one: (one.shear_force, one.strength), _percent),
    ),
    "normal_stress": Field(
        "Normal stress of joints, compression positive",
        "Pa",
        partial(_stress, force="normal_force"),
    ),
    "shear_stress": Field("Shear stress of joints", "Pa", partial(_stress, force="shear_force")),
    "worn": Field(
        "Strength lost by joints",
        "%",
        _from_sums(lambda one: (one.worn, np.ones(len(one))), _percent),
    ),
    **FLOW_FIELDS,
}
"""Fields that colour joints, and not blocks."""


def scale_of_faces(faces: Faces, shown: Bools, limits: tuple[float, float] | None) -> ColourScale:
    """Return one scale for the faces that are ``shown`` (k,), weighted by their lengths."""
    counted = shown if shown.any() else np.ones(len(shown), np.bool_)
    length = faces.length[counted]
    weight = np.maximum(length, 0.1 * length.max(initial=0.0) + 1e-12)
    return scale_of(faces.value[counted], weight, limits)


def draw_faces(axes: Axes, faces: Faces, scale: ColourScale) -> LineCollection:
    """Draw faces as lines as wide as their values are large on a scale; return them."""
    from matplotlib.collections import LineCollection

    largest = max(abs(scale.low), abs(scale.high))
    share = faces.width
    if share is None:
        share = np.minimum(1.0, np.abs(faces.value) / (largest or np.inf))
    lines = LineCollection(
        list(faces.ends), linewidths=THIN + (THICK - THIN) * share, capstyle="round", zorder=4.5
    )
    axes.add_collection(lines)
    return lines
