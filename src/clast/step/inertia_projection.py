"""Motions of blocks that contacts stop, and their treatment by the time scheme.

A block with a contact that closes is stopped by all that carry it.  The motions that a contact
stops on a block with mass matrix M are M^-1 n, and M^-1 t where it rubs; straining, M^-1 e, is
among them, too.  Free of all these are motions p without strains along which no such contact moves,
n.p = 0 and t.p = 0: two at most.  They are made orthonormal, p_a.M p_b = 1 or 0, so that
Q = 1 - sum p (M p)^T is the projection on stopped motions.

M is taken about the centroid: of motions without strains it is the diagonal (m, m, J).  With z the
components of p times the roots of these, and y those of a force over them, p.f is z.y, and the free
motions are orthogonal to the directions y.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import (
    inner,
    line,
    numbers,
    plus_scaled,
    put_line,
    put_row,
    row,
)
from clast.contact.jacobian import force_on
from clast.model.model import Bools, Floats, Ints

SAME_MOTION_SQUARE = 1e-10
"""Share of a direction's square beside others that does not count: it is one of theirs."""


@kernel()
def _add(force, roots, known, room):
    """Add the direction of a force to those ``known``, if it is none of them; return how many.

    ``room`` (4, 3) are these, and the new one.
    """
    y = room[3]
    y[0], y[1], y[2], _, _, _ = numbers(force)
    whole = 0.0
    for i in range(3):
        y[i] /= roots[i]
        whole += y[i] * y[i]
    for _ in range(2):  # once more for what round-off has left
        for a in range(known):
            share = room[a, 0] * y[0] + room[a, 1] * y[1] + room[a, 2] * y[2]
            for i in range(3):
                y[i] -= share * room[a, i]
    rest = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    if not rest > SAME_MOTION_SQUARE * whole:
        return known
    length = np.sqrt(rest)
    for i in range(3):
        room[known, i] = y[i] / length
    return known + 1


@kernel()
def _stop(b, first, last, contacts, stops, roots, known, room):
    """Add the directions in which contacts ``first`` to ``last`` - 1 stop block b."""
    (vertex_block, arms), (_, carries, sticks) = contacts, stops
    for c in range(first, last):
        if known < 3 and carries[c]:
            own = vertex_block[c] == b
            known = _add(force_on(arms, c, own, 1.0, 0.0), roots, known, room)
            if known < 3 and sticks[c]:
                known = _add(force_on(arms, c, own, 0.0, 1.0), roots, known, room)
    return known


@kernel()
def _across(room, a, other, at):
    """Write the direction across two others of ``room`` as a third."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        room[at, i] = room[a, j] * room[other, k] - room[a, k] * room[other, j]


@kernel()
def _leave(b, known, roots, room, stopped):
    """Write the motions of block b across the ``known`` directions of ``room``."""
    free, motions, momenta, mass_matrix = stopped
    free[b] = 3 - known
    if known == 1:  # that of a contact's normal, which is no mere turn
        size = np.hypot(room[0, 0], room[0, 1])
        room[1, 0], room[1, 1], room[1, 2] = -room[0, 1] / size, room[0, 0] / size, 0.0
    if known < 3:
        _across(room, 0, 1, 2)
    for a in range(3 - known):
        for i in range(3):
            motions[b, a, i] = room[known + a, i] / roots[i]
            momenta[b, a, i] = room[known + a, i] * roots[i]
            momenta[b, a, 3 + i] = mass_matrix[b, 3 + i, 2] * room[known + a, 2] / roots[2]


@kernel()
def _any(first, last, closes):
    one_closes = False
    for c in range(first, last):
        one_closes |= closes[c]
    return one_closes


@shared(BLOCKS)
def _of_blocks(low, high, fixed, graph, contacts, stops, stopped):
    """Write the free motions of blocks ``low`` to ``high`` - 1."""
    start, right, left, listed = graph
    free, _, _, mass_matrix = stopped
    roots, room = np.empty(3), np.empty((4, 3))
    for b in range(low, high):
        free[b] = -1
        if fixed[b]:
            continue
        own = start[right[b]], start[right[b + 1]]
        stops_any = _any(own[0], own[1], stops[0])
        for at in range(left[b], left[b + 1]):
            stops_any |= _any(start[listed[at]], start[listed[at] + 1], stops[0])
        if not stops_any:
            continue
        for i in range(3):
            roots[i] = np.sqrt(mass_matrix[b, i, i]) if mass_matrix[b, i, i] > 0.0 else 1.0
        known = _stop(b, own[0], own[1], contacts, stops, roots, 0, room)
        for at in range(left[b], left[b + 1]):
            q = listed[at]
            known = _stop(b, start[q], start[q + 1], contacts, stops, roots, known, room)
        _leave(b, known, roots, room, stopped)


Stopped = tuple[Ints, Floats, Floats, Floats]
"""Blocks with stopped motions as kernels take them: what ``stopped_blocks`` returns."""


def stopped_blocks(
    mass_matrix: Floats, fixed: Bools, graph: Any, contacts: Any, stops: Any
) -> Stopped:
    """Return how many motions contacts leave free on each block (n,), -1 where they stop none.

    And these p (n, 2, 3), of which rows from that number on are not written, M p (n, 2, 6) and M
    (n, 6, 6).  ``graph`` is that of the contacts (linear/assembly.py), ``contacts`` their
    vertex_block (m,) and arms, ``stops`` which of them close, which carry and which of these rub
    (m,).
    """
    count = len(fixed)
    free, motions, momenta = (
        np.empty(count, np.int64),
        np.empty((count, 2, 3)),
        np.empty((count, 2, 6)),
    )
    stopped = free, motions, momenta, mass_matrix
    _of_blocks(count, fixed, graph, contacts, stops, stopped)
    return stopped


@kernel()
def add_inertia(stopped, factor, drift, terms):
    """Add ``factor`` M Q to K (n, 6, 6), and that times ``drift`` (n, 6) to F and momentum (n, 6).

    In place.
    """
    free, _, momenta, mass_matrix = stopped
    matrix, force, momentum = terms
    for b in range(len(free)):
        if free[b] < 0:
            continue
        share = times(mass_matrix, b, drift, b)
        for i in range(6):
            put_line(matrix, b, i, plus_scaled(line(matrix, b, i), factor, line(mass_matrix, b, i)))
        for a in range(free[b]):
            own = line(momenta, b, a)
            share = plus_scaled(share, -inner(own, row(drift, b)), own)
            for i in range(6):
                scale = -factor * momenta[b, a, i]
                put_line(matrix, b, i, plus_scaled(line(matrix, b, i), scale, own))
        put_row(force, b, plus_scaled(row(force, b), factor, share))
        put_row(momentum, b, plus_scaled(row(momentum, b), factor, share))


@kernel()
def add_velocities(stopped, factor, change, velocity):
    """Add ``factor`` Q times a ``change`` (n, 6) to velocities (n, 6), in place."""
    free, motions, momenta, _ = stopped
    for b in range(len(free)):
        if free[b] < 0:
            continue
        put_row(velocity, b, plus_scaled(row(velocity, b), factor, row(change, b)))
        for a in range(free[b]):
            share = factor * inner(line(momenta, b, a), row(change, b))
            for i in range(3):
                velocity[b, i] -= share * motions[b, a, i]
