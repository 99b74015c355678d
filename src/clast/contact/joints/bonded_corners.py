"""Corners that meet in a point of bonded rock.

Around a point where several blocks meet, as in a mesh of triangles, there are blocks that share no
face, only this point.  Where bonded faces join one to the next round the point, they hold these two
together, or apart, as well.  A contact of the two would add nothing but impacts and friction at a
place where the rock is whole: it would take the energy of waves.  It comes up when a bond breaks.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from clast.compute.jit import kernel
from clast.contact.joints.faces import Places
from clast.model.model import Bools, Floats

NEAR = 0.1
"""Distance between corners that are one point, in units of critdis; a face is longer."""
MOST = 64
"""Blocks around a point, at most."""


def without_points_in_bonds(
    corners: Places, bonded: Bools, vertices: Floats, critdis: float
) -> Places:
    """Return the contacts of vertices without those of blocks that bonds join round the point.

    ``bonded`` (m,) are those with a bond, ``vertices`` (nv, 2) those of the blocks, m; corners
    within a tenth of ``critdis``, m, of each other are one point.
    """
    near = NEAR * critdis
    # bonds that give way let blocks overlap along such a point by as much
    of_faces = corners.length > near
    points, faces = np.flatnonzero(~of_faces), np.flatnonzero(of_faces & bonded)
    if not (len(points) and len(faces)):
        return corners
    ends = corners.vertex, corners.vertex_block, corners.edge_block
    joined = _are_joined(points, faces, ends, vertices, near)
    if not joined.any():
        return corners
    return Places(**{one.name: getattr(corners, one.name)[~joined] for one in fields(Places)})


@kernel()
def _are_joined(points, faces, contacts, vertices, near):
    """Return which contacts (m,) are among ``points`` and of blocks that ``faces`` join round them.

    ``points`` and ``faces`` are numbers of contacts, these by vertex and the two blocks (m,) each.
    """
    vertex, vertex_block, edge_block = contacts
    joined = np.zeros(len(vertex), np.bool_)
    count = max(vertex_block.max(), edge_block.max()) + 1
    start = np.zeros(count + 1, np.int64)
    for f in faces:
        start[vertex_block[f] + 1] += 1
        start[edge_block[f] + 1] += 1
    for b in range(count):
        start[b + 1] += start[b]
    of_block, filled = np.empty(start[-1], np.int64), start[:-1].copy()
    for f in faces:
        for b in (vertex_block[f], edge_block[f]):
            of_block[filled[b]] = f
            filled[b] += 1
    met = np.empty(MOST, np.int64)
    for c in points:
        x, y = vertices[vertex[c], 0], vertices[vertex[c], 1]
        met[0], known, at = vertex_block[c], 1, 0
        while at < known and not joined[c]:
            b, at = met[at], at + 1
            for k in range(start[b], start[b + 1]):
                f = of_block[k]
                p = vertex[f]
                if abs(vertices[p, 0] - x) > near or abs(vertices[p, 1] - y) > near:
                    continue
                other = edge_block[f] if vertex_block[f] == b else vertex_block[f]
                if other == edge_block[c]:
                    joined[c] = True
                    break
                if known < MOST and not _is_among(other, met, known):
                    met[known] = other
                    known += 1
    return joined


@kernel()
def _is_among(one, some, count):
    """Return whether a number is one of the first ``count`` of some."""
    for k in range(count):
        if some[k] == one:
            return True
    return False
