"""Faces: contacts at points inside the length that two edges share.

Two corners alone carry the resultant of a face, but not its bending: springs of k L/2 at both ends
of a length L turn by 4 M/(k L^3), a face of stiffness k per area by 12 M/(k L^3).  So where a joint
has a stiffness per area, or a bond, which has a strength per area, the shared length of two faces
is integrated: its ends, which are vertices, and thirteen points between them stand for shares of
it.  These add up to 1 and their second moment about the middle is L^2/12, so that closure k L,
rotation k L^3/12 and opening at e = L/6 are exact.  Points are denser towards the ends, and places
and shares are those with which a face that has opened in part is nearest to its integral, too
(contact length 3 (L/2 - e), rotation within 4 % up to e = 0.465 L), under the condition that no
crack that has begun carries more than sigma_t L^2/6, the moment that began it (decision 82).

A point is kept by the two edges and its number.  It moves along with the shared length, whose ends
are vertices: as blocks slide, its place and its share are those of the moment.  Of edges that lie
flush the one of the block that comes first by size and place (``Model.rank``) has the point P, the
other one Q; of edges at an angle, up to 30 degrees, the one whose vertex goes in deepest has P
(decision 94).  Joints without
stiffness and bond keep their corners alone, about which blocks then tip exactly.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from clast.block.polygon import ROUND_OFF, SMALL_ANGLE, Polygons, cosine, sine
from clast.compute.jit import kernel
from clast.contact.contacts import Places
from clast.contact.joints.along_joint import edge_along, joints_of
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory, State, contact_keys

FACING = np.sin(np.radians(30.0))
"""Sine of the angle up to which edges face each other.

A tip that presses is by then alone: its neighbour is open until the tip is 0.023 L deep.
"""
NEAR_ENDS: Floats = np.array([0.0469, 0.085, 0.1402, 0.1932, 0.2653, 0.3643])
"""Places of the inner points of one half, from its end on, as shares of the shared length, (6,)."""
SHARES_NEAR_ENDS: Floats = np.array([0.0238, 0.0274, 0.067, 0.045, 0.0623, 0.0848])
"""Shares of the length that the end and the inner points but for the last stand for, (6,)."""


def shares_of_half() -> tuple[Floats, float]:
    """Return the shares of the end and of all inner points of a half, (7,), and of the middle.

    The last two follow from the length and from its second moment.
    """
    beside = 0.5 - np.append(0.0, NEAR_ENDS)
    moment = 1.0 / 24.0 - SHARES_NEAR_ENDS @ beside[:-1] ** 2
    shares = np.append(SHARES_NEAR_ENDS, moment / beside[-1] ** 2)
    return shares, 1.0 - 2.0 * float(shares.sum())


_HALF, _MIDDLE = shares_of_half()
PLACES: Floats = np.concatenate([NEAR_ENDS, [0.5], 1.0 - NEAR_ENDS[::-1]])
"""Places of the inner points, as shares of the shared length, shape (13,)."""
SHARES: Floats = np.concatenate([_HALF[1:], [_MIDDLE], _HALF[:0:-1]])
"""Shares of the length that they stand for, shape (13,)."""
END = float(_HALF[0])
"""Share that each end stands for."""
OF_TWO_CORNERS = 2.0 * END
"""The same in units of the half that a corner stands for by itself."""


def with_faces(
    corners: Places, model: Model, state: State, centroid: Floats, polygons: tuple[Any, ...]
) -> Places:
    """Return the contacts of vertices with those inside the faces that are to be integrated.

    ``polygons`` are the arrays of ``Polygons``.
    """
    integrated = model.joint_table.integrated
    if not model.joint_table.integrates or not integrated[corners.joint].any():
        return corners
    share = np.where(integrated[corners.joint], OF_TWO_CORNERS, 1.0)
    length, spring_length = share * corners.length, share * corners.spring_length
    shared = _shared_edges(corners, integrated, model, polygons)
    inner = _inside(*shared, model, state, centroid, polygons[1:3])
    corners = replace(corners, length=length, spring_length=spring_length)
    if not len(inner.pair):
        return corners
    order = np.argsort(np.concatenate([corners.pair, inner.pair]), kind="stable")
    joined = {
        one.name: np.concatenate([getattr(corners, one.name), getattr(inner, one.name)])[order]
        for one in fields(Places)
    }
    return Places(**joined)


def _shared_edges(
    corners: Places, integrated: Bools, model: Model, polygons: tuple[Any, ...]
) -> tuple[Ints, Ints, Ints]:
    """Return edges that face each other: the one with the points P, the other, and the pair.

    Each pair of edges once (k,), though up to four vertices tell of it.
    """
    some = np.flatnonzero(integrated[corners.joint])
    own, other = np.full((2, 2 * len(some)), -1, np.int64)
    _edges_facing_each_other(corners.vertex[some], corners.edge[some], polygons, own, other)
    there = own >= 0
    own, other, which = own[there], other[there], np.repeat(some, 2)[there]
    # the vertex that goes in deepest tells first, where two do that of the block that comes first
    rank = model.rank
    deepest = np.lexsort((rank[corners.vertex_block[which]], corners.gap[which]))
    own, other, which = own[deepest], other[deepest], which[deepest]
    ahead = rank[corners.vertex_block[which]] < rank[corners.edge_block[which]]
    leading, following = np.where(ahead, own, other), np.where(ahead, other, own)
    _, at = np.unique(leading * len(model.vertex_block) + following, return_index=True)
    one, two = polygons[1][own[at]], polygons[1][other[at]]
    flush = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) <= SMALL_ANGLE
    first = np.where(flush, leading[at], own[at])
    second = np.where(flush, following[at], other[at])
    return first, second, corners.pair[which[at]]


@kernel()
def _edges_facing_each_other(vertex, edge, polygons, own, other):
    """Write the own edge of each vertex that faces its entrance edge, and that edge.

    Two places (2 m,) for the two own edges of each contact, -1 where they do not.
    """
    outlines = Polygons(*polygons)
    direction = outlines.direction
    for c in range(len(vertex)):
        p, e = vertex[c], edge[c]
        for side in range(2):
            before = outlines.before[p]
            a, w = (before, before) if side == 0 else (p, outlines.after[p])
            if abs(sine(a, e, direction)) <= FACING and cosine(a, e, direction) < 0.0:
                own[2 * c + side] = a
                other[2 * c + side] = edge_along(p, w, e, outlines, 0.0)


def _inside(
    own: Ints,
    edge: Ints,
    pair: Ints,
    model: Model,
    state: State,
    centroid: Floats,
    edges: tuple[Floats, Floats],
) -> Places:
    """Return the points P on edges ``own`` (k,) inside their common part with edges ``edge``."""
    vertices, (direction, length) = state.vertices, edges
    block = model.vertex_block
    end = model.vertex_after[own]
    tangent, start = direction[edge], vertices[edge]
    here = np.einsum("kx,kx->k", vertices[own] - start, tangent)
    there = np.einsum("kx,kx->k", vertices[end] - start, tangent)
    low = np.maximum(0.0, np.minimum(here, there))
    shared = np.minimum(length[edge], np.maximum(here, there)) - low
    # faces of blocks that meet in a point may share a length of round-off
    some = np.flatnonzero(shared > ROUND_OFF * np.minimum(length[own], length[edge]))
    own, edge, pair, shared = own[some], edge[some], pair[some], shared[some]
    ends = own, edge, block[own], block[edge], np.arange(len(own))
    joint = joints_of(model, ends, np.stack([block[own], block[edge]], axis=1), direction)
    lies = model.joint_table.integrated[joint]
    some, joint = some[lies], joint[lies]
    own, edge, pair, shared = own[lies], edge[lies], pair[lies], shared[lies]
    at = low[some, None] + shared[:, None] * PLACES
    along = ((at - here[some, None]) / (there - here)[some, None]).ravel()
    at = at.ravel()
    own, edge, pair, joint = (np.repeat(one, len(PLACES)) for one in (own, edge, pair, joint))
    i, j = block[own], block[edge]
    # from vertices on, not from the origin: what is far away loses no digits
    onwards = along[:, None] * (vertices[model.vertex_after[own]] - vertices[own])
    tangent, start = direction[edge], vertices[edge]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    gap = np.einsum("kx,kx->k", (vertices[own] - start) + onwards, normal)
    offset = (vertices[own] - centroid[i]) + onwards
    foot_offset = (start - centroid[j]) + at[:, None] * tangent
    stands_for = (shared[:, None] * SHARES).ravel()
    point = np.tile(np.arange(1, 1 + len(PLACES)), len(shared))
    return Places(
        vertex=own,
        edge=edge,
        vertex_block=i,
        edge_block=j,
        pair=pair,
        point=point,
        along=along,
        gap=gap,
        foot=start + at[:, None] * tangent,
        arms=np.concatenate([normal, offset, foot_offset], axis=1),
        joint=joint,
        length=stands_for,
        spring_length=stands_for,
        row=_rows(state.memory, own, edge, point, len(vertices)),
    )


def _rows(memory: ContactMemory, own: Ints, edge: Ints, point: Ints, count: int) -> Ints:
    """Return the rows of points inside faces in the memory, or -1, (k,)."""
    first = memory.corner_count
    keys = memory.keys(count)[first:]
    wanted = contact_keys(own, edge, point, count)
    if not len(keys):
        return np.full(len(wanted), -1, np.int64)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[at] == wanted, first + at, -1)
