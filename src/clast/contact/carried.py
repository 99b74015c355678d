"""Memory of contacts from step to step, handed from that of a state to the contacts of a step."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.compute.parallel import CONTACTS, shared
from clast.contact.joints.faces import Places
from clast.contact.joints.flush import had_by_faces
from clast.model.model import Floats, Ints, Model
from clast.model.state import ContactMemory


def carried_by(
    row: Ints,
    memory: ContactMemory,
    turns: tuple[Ints, Floats],
) -> dict[str, Any]:
    """Return the memory of contacts, (m,) each by its name.

    ``row`` (m,) is the row of a contact in the memory or -1: then it carries nothing, and has
    no bond.  ``turns`` are the edge of each contact (m,) and the directions of all edges (nv, 2).
    """
    count = len(row)
    known, bonded, cohesive = np.empty((3, count), np.bool_)
    mode = np.empty(count, np.int64)
    shear, normal, multiplier, rest, friction_base = np.empty((5, count))
    ways = np.empty((5, count))
    friction_base.fill(np.nan)
    forces = memory.shear_force, memory.normal_force, memory.multiplier, memory.rest_force
    carried = known, bonded, cohesive, mode, shear, normal, multiplier, rest
    so_far = memory.slip, memory.slide_length, memory.slide, memory.slide_speed, memory.dilation
    before = memory.bonded, memory.cohesive, memory.mode, *forces
    _carry(count, row, before, carried)
    _carry_ways(count, row, so_far, tuple(ways))
    _turn_rest_forces(count, row, memory.edge, turns, (shear, normal, rest))
    return {
        "known": known,
        "bonded": bonded,
        "cohesive": cohesive,
        "shear_force": shear,
        "normal_force": normal,
        "multiplier": multiplier,
        "rest_force": rest,
        "slip": ways[0],
        "slide_length": ways[1],
        "slide": ways[2],
        "slide_speed": ways[3],
        "dilation": ways[4],
        "mode": mode,
        "friction_base": friction_base,
    }


@shared(CONTACTS)
def _carry(first, last, row, memory, carried):
    """Write the memory of contacts ``first`` to ``last`` - 1."""
    bonded, cohesive, mode, shear_force, normal_force, multiplier, rest_force = memory
    known, intact, holding, modes, shear, normal, multipliers, rests = carried
    for c in range(first, last):
        r = row[c]
        known[c] = r >= 0
        if known[c]:
            intact[c], holding[c], modes[c] = bonded[r], cohesive[r], mode[r]
            shear[c], normal[c], multipliers[c] = shear_force[r], normal_force[r], multiplier[r]
            rests[c] = rest_force[r]
        else:
            intact[c], holding[c], modes[c] = False, False, 0
            shear[c], normal[c], multipliers[c], rests[c] = 0.0, 0.0, 0.0, 0.0


@shared(CONTACTS)
def _carry_ways(first, last, row, so_far, carried):
    """Write how far contacts ``first`` to ``last`` - 1 have slipped, slid and opened so far."""
    slip, length, slide, speed, dilation = so_far
    slips, lengths, slides, speeds, dilations = carried
    for c in range(first, last):
        r = row[c]
        if r >= 0:
            slips[c], lengths[c], slides[c] = slip[r], length[r], slide[r]
            speeds[c], dilations[c] = speed[r], dilation[r]
        else:
            slips[c], lengths[c], slides[c], speeds[c], dilations[c] = 0.0, 0.0, 0.0, 0.0, 0.0


def taken_along(
    carried: dict[str, Any],
    speed: Floats,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> tuple[dict[str, Any], Floats]:
    """Return the memory of contacts, and speeds of sliding (m,), with those of new ones.

    Where a face slides on, a contact that comes up has slid, opens and slides as the face does.
    """
    new = np.flatnonzero(places.row < 0)
    if not len(new) or not len(memory):
        return carried, speed
    ends = places.vertex[new], places.edge[new]
    kept = memory.slide, memory.dilation, memory.slide_speed
    found = had_by_faces(kept, memory, ends, direction, model.block_start)
    taken = [one.copy() for one in (carried["slide"], carried["dilation"], speed)]
    for values, of_faces in zip(taken, found, strict=True):
        values[new] = np.nan_to_num(of_faces)
    return {**carried, "slide": taken[0], "dilation": taken[1]}, taken[2]


@shared(CONTACTS)
def _turn_rest_forces(first, last, row, before, ways, forces):
    """Keep the direction of rest forces of contacts ``first`` to ``last`` - 1, whatever the edge.

    A rest force belongs to the face that carried it before the run.  Where its vertex has passed to
    the next edge of the block, the same force has other shares along normal and edge.  ``before``
    are the edges in the memory.
    """
    edge, direction = ways
    shear, normal, rest = forces
    for c in range(first, last):
        if row[c] < 0 or rest[c] <= 0.0 or before[row[c]] == edge[c]:
            continue
        old, new = before[row[c]], edge[c]
        cosine = direction[old, 0] * direction[new, 0] + direction[old, 1] * direction[new, 1]
        sine = direction[old, 0] * direction[new, 1] - direction[old, 1] * direction[new, 0]
        along = shear[c]
        shear[c] = along * cosine - rest[c] * sine
        rest[c] = max(0.0, rest[c] * cosine + along * sine)
        normal[c] = max(0.0, normal[c] * cosine + along * sine)
