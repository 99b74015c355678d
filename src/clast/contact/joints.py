"""Which joint a contact lies along.

A pair of blocks that a joint names goes before what edges say for themselves, and that before a
pair of rocks and the default.  Two blocks can touch along several joints, at a step in a fault for
example: a pair cannot say that, their edges can.
"""

from __future__ import annotations

import numpy as np

from clast.block.polygon import vertex_before
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.model.model import Bools, Floats, Ints, JointTable, Model


def joints_of(
    model: Model, ends: tuple[Ints, Ints, Ints, Ints, Ints], pairs: Ints, direction: Floats
) -> Ints:
    """Return the joint of each contact, an index into those of the model, shape (m,).

    ``ends`` are vertex, edge, their blocks and pair of contacts (m,) each, ``pairs`` (q, 2) the
    blocks of pairs, ``direction`` (nv, 2) the unit vectors of edges.
    """
    table = model.joint_table
    of_pairs, named = _of_pairs(table, model.block_rock, pairs)
    joint = of_pairs[ends[4]]
    if model.edge_joint.max(initial=-1) >= 0:
        places = ends[0], ends[1], model.block_start[ends[2]], model.block_start[ends[2] + 1]
        _along_edges(len(joint), places, model.edge_joint, direction, named[ends[4]], joint)
    return joint


def _of_pairs(table: JointTable, block_rock: Ints, pairs: Ints) -> tuple[Ints, Bools]:
    """Return the joint of each pair of blocks (q,), and whether it names the blocks (q,)."""
    joint = table.rock_pair[block_rock[pairs[:, 0]], block_rock[pairs[:, 1]]]
    if len(table.block_pair) == 0:
        return joint, np.zeros(len(pairs), np.bool_)
    width = len(block_rock)
    own = table.block_pair[:, 0] * width + table.block_pair[:, 1]
    wanted = pairs[:, 0] * width + pairs[:, 1]
    at = np.minimum(np.searchsorted(own, wanted), len(own) - 1)
    named = own[at] == wanted
    return np.where(named, table.block_pair_joint[at], joint), named


@shared(CONTACTS)
def _along_edges(first, last, places, edge_joint, direction, named, joint):
    """Write the joints of contacts ``first`` to ``last`` - 1 that their edges name.

    That of the entrance edge, else that of the vertex's own edge more nearly parallel to it.
    """
    vertex, edge, block_first, block_last = places
    for c in range(first, last):
        if named[c]:
            continue
        p, e = vertex[c], edge[c]
        found = edge_joint[e]
        if found < 0:
            before = vertex_before(p, block_first[c], block_last[c])
            found = edge_joint[_more_parallel(before, p, e, direction)]
        if found >= 0:
            joint[c] = found


@kernel()
def _more_parallel(one, other, edge, direction):
    """Return which of two edges is more nearly parallel to another."""
    sine_one = direction[one, 0] * direction[edge, 1] - direction[one, 1] * direction[edge, 0]
    sine_other = direction[other, 0] * direction[edge, 1] - direction[other, 1] * direction[edge, 0]
    return one if abs(sine_one) < abs(sine_other) else other
