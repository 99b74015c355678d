"""Motions of blocks that contacts stop, and their treatment by the time scheme.

A block with a contact that closes is stopped by all that carry it.  The motions that a contact
stops on a block with mass matrix M are M^-1 n, and M^-1 t where it rubs; straining is among them,
too.  They are made orthonormal, q_a.M q_b = 1 or 0, so that Q = sum q (M q)^T is the projection on
stopped motions, and the rest is free of them.

With L L^T = M a motion q is y = L^T q, and q_a.M q_b = y_a.y_b.  Strains come last among the
unknowns, so the motions M^-1 f of forces f that strain alone have y = (0, 0, 0, ., ., .), and those
of a contact count by the first three entries of theirs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import (
    inner,
    line,
    numbers,
    plus_scaled,
    put_line,
    row,
)
from clast.contact.jacobian import force_on
from clast.model.model import Bools, Floats, Ints

SAME_MOTION_SQUARE = 1e-10
"""Share of a motion's square beside others that does not count: it is one of theirs."""


@kernel()
def _factor(mass_matrix, b, low):
    """Write L with L L^T = M of block b into ``low`` (6, 6); 1 where an unknown has no mass."""
    for i in range(6):
        for j in range(i):
            value = mass_matrix[b, i, j]
            for k in range(j):
                value -= low[i, k] * low[j, k]
            low[i, j] = value / low[j, j]
        value = mass_matrix[b, i, i]
        for k in range(i):
            value -= low[i, k] * low[i, k]
        low[i, i] = np.sqrt(value) if value > 0.0 else 1.0


@kernel()
def _add_strains(b, low, stopped):
    """Add the three motions that forces bring which strain block b and do not move it."""
    count, motions, momenta = stopped
    for a in range(3):
        own = 3 + a
        for i in range(6):
            motions[b, a, i] = 1.0 / low[i, i] if i == own else 0.0
            momenta[b, a, i] = low[i, own] if i >= own else 0.0
        for i in range(own - 1, -1, -1):
            value = 0.0
            for k in range(i + 1, own + 1):
                value -= low[k, i] * motions[b, a, k]
            motions[b, a, i] = value / low[i, i]
    count[b] = 3


@kernel()
def _add(force, b, low, room, stopped):
    """Add the motion that a force on block b brings, if it is none of those that there are.

    ``room`` (4, 3) are the y of those added before, beyond strains, and that of this one.
    """
    count, motions, momenta = stopped
    known, y = count[b] - 3, room[3]
    y[0], y[1], y[2], _, _, _ = numbers(force)
    whole = 0.0
    for i in range(3):
        for k in range(i):
            y[i] -= low[i, k] * y[k]
        y[i] /= low[i, i]
        whole += y[i] * y[i]
    for _ in range(2):  # once more for what round-off has left
        for a in range(known):
            share = room[a, 0] * y[0] + room[a, 1] * y[1] + room[a, 2] * y[2]
            for i in range(3):
                y[i] -= share * room[a, i]
    rest = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    if known == 3 or not rest > SAME_MOTION_SQUARE * whole:
        return
    length, at = np.sqrt(rest), 3 + known
    for i in range(3):
        room[known, i] = y[i] / length
    for i in range(6):
        momenta[b, at, i] = motions[b, at, i] = 0.0
        for k in range(min(i + 1, 3)):
            momenta[b, at, i] += low[i, k] * room[known, k]
    for i in range(2, -1, -1):
        value = room[known, i]
        for k in range(i + 1, 3):
            value -= low[k, i] * motions[b, at, k]
        motions[b, at, i] = value / low[i, i]
    count[b] = at + 1


@kernel()
def _stop(b, first, last, contacts, stops, room, stopped):
    """Add the motions of block b that contacts ``first`` to ``last`` - 1 stop."""
    (vertex_block, arms), (_, carries, sticks), (low, free) = contacts, stops, room
    count = stopped[0]
    for c in range(first, last):
        if count[b] == 6:
            return
        if carries[c]:
            own = vertex_block[c] == b
            _add(force_on(arms, c, own, 1.0, 0.0), b, low, free, stopped)
            if sticks[c]:
                _add(force_on(arms, c, own, 0.0, 1.0), b, low, free, stopped)


@kernel()
def _any(first, last, closes):
    one_closes = False
    for c in range(first, last):
        one_closes |= closes[c]
    return one_closes


@shared(BLOCKS)
def _of_blocks(low, high, mass_matrix, fixed, graph, contacts, stops, stopped):
    """Write the stopped motions of blocks ``low`` to ``high`` - 1."""
    start, right, left, listed = graph
    closes, _, _ = stops
    count, _, _ = stopped
    factor, room = np.empty((6, 6)), np.empty((4, 3))
    for b in range(low, high):
        count[b] = 0
        if fixed[b]:
            continue
        own = start[right[b]], start[right[b + 1]]
        stops_any = _any(own[0], own[1], closes)
        for at in range(left[b], left[b + 1]):
            stops_any |= _any(start[listed[at]], start[listed[at] + 1], closes)
        if not stops_any:
            continue
        _factor(mass_matrix, b, factor)
        _add_strains(b, factor, stopped)
        _stop(b, own[0], own[1], contacts, stops, (factor, room), stopped)
        for at in range(left[b], left[b + 1]):
            q = listed[at]
            _stop(b, start[q], start[q + 1], contacts, stops, (factor, room), stopped)


def stopped_motions(
    mass_matrix: Floats, fixed: Bools, graph: Any, contacts: Any, stops: Any
) -> tuple[Ints, Floats, Floats]:
    """Return how many motions contacts stop on each block (n,), these q and M q (n, 6, 6) each.

    Rows from that number on are not written.  ``graph`` is that of the contacts
    (linear/assembly.py), ``contacts`` their vertex_block (m,) and arms, ``stops`` which of them
    close, which carry and which of these rub (m,).
    """
    count = len(fixed)
    stopped = np.empty(count, np.int64), np.empty((count, 6, 6)), np.empty((count, 6, 6))
    _of_blocks(count, mass_matrix, fixed, graph, contacts, stops, stopped)
    return stopped


@kernel()
def add_inertia(stopped, factor, drift, terms):
    """Add ``factor`` M Q to K (n, 6, 6), and that times ``drift`` (n, 6) to F and momentum (n, 6).

    In place.
    """
    count, _, momenta = stopped
    matrix, force, momentum = terms
    for b in range(len(count)):
        for a in range(count[b]):
            own = line(momenta, b, a)
            share = factor * inner(own, row(drift, b))
            for i in range(6):
                scale = factor * momenta[b, a, i]
                put_line(matrix, b, i, plus_scaled(line(matrix, b, i), scale, own))
                force[b, i] += share * momenta[b, a, i]
                momentum[b, i] += share * momenta[b, a, i]


@kernel()
def add_velocities(stopped, factor, change, velocity):
    """Add ``factor`` Q times a ``change`` (n, 6) to velocities (n, 6), in place."""
    count, motions, momenta = stopped
    for b in range(len(count)):
        for a in range(count[b]):
            own = line(momenta, b, a)
            share = factor * inner(own, row(change, b))
            for i in range(6):
                velocity[b, i] += share * motions[b, a, i]
