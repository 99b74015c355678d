"""Sums over regions: of what blocks have, of forms and products, of works contact by contact.

Threads share the work.  Each chunk of blocks or part of the contacts adds up what follows each
other of the same region, a run, and one thread adds up the runs in their order.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import (
    CHUNK,
    MANY,
    PART,
    SHARED,
    bounds,
    chunks,
    only_region,
    parts,
    sum_of,
)
from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus_product, plus_scaled, put_row, row, total, zeros


@kernel()
def _room_for(pieces, count):
    """Return room for ``count`` terms, the regions of their runs, and the runs of each piece."""
    return np.empty(count), np.empty(count, np.int64), np.empty(pieces, np.int64)


@kernel()
def _add_up(piece, first, last, region, room):
    """Write the runs of the terms ``first`` to ``last`` - 1 in their place."""
    terms, of_run, runs = room
    only = only_region(region[first:last])
    if only >= 0:
        terms[first], of_run[first], runs[piece] = sum_of(terms[first:last]), only, 1
        return
    at, current, added = first, region[first], 0.0
    for i in range(first, last):
        if region[i] != current:
            terms[at], of_run[at] = added, current
            at, current, added = at + 1, region[i], 0.0
        added += terms[i]
    terms[at], of_run[at], runs[piece] = added, current, at + 1 - first


@kernel()
def _added(size, room, count):
    """Return the sums of ``count`` regions, of the runs of pieces of ``size`` terms."""
    terms, of_run, runs = room
    result = np.zeros(count)
    for piece in range(len(runs)):
        for at in range(piece * size, piece * size + runs[piece]):
            result[of_run[at]] += terms[at]
    return result


@kernel()
def _forms(first, last, blocks, d, terms):
    """Write d_i.B_i d_i of blocks ``first`` to ``last`` - 1."""
    for i in range(first, last):
        terms[i] = total(plus_product(zeros(), times(blocks, i, d, i), row(d, i)))


@kernel(parallel=True)
def _forms_shared(blocks, d, region, room):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(d))):
            first, last = c * CHUNK, min((c + 1) * CHUNK, len(d))
            _forms(first, last, blocks, d, room[0])
            _add_up(c, first, last, region, room)


@kernel()
def forms(blocks, d, region, count):
    """Return the sum of d_i.B_i d_i over each of ``count`` regions, B (n, 6, 6), d (n, 6)."""
    room = _room_for(chunks(len(d)), len(d))
    if len(d) >= SHARED:
        _forms_shared(blocks, d, region, room)
    else:
        for c in range(chunks(len(d))):
            first, last = c * CHUNK, min((c + 1) * CHUNK, len(d))
            _forms(first, last, blocks, d, room[0])
            _add_up(c, first, last, region, room)
    return _added(CHUNK, room, count)


@kernel()
def _products(first, last, a, b, terms):
    """Write a_i.b_i of blocks ``first`` to ``last`` - 1."""
    for i in range(first, last):
        terms[i] = total(plus_product(zeros(), row(a, i), row(b, i)))


@kernel(parallel=True)
def _products_shared(a, b, region, room):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(a))):
            first, last = c * CHUNK, min((c + 1) * CHUNK, len(a))
            _products(first, last, a, b, room[0])
            _add_up(c, first, last, region, room)


@kernel()
def products(a, b, region, count):
    """Return a.b of two vectors (n, 6) over each of ``count`` regions."""
    room = _room_for(chunks(len(a)), len(a))
    if len(a) >= SHARED:
        _products_shared(a, b, region, room)
    else:
        for c in range(chunks(len(a))):
            first, last = c * CHUNK, min((c + 1) * CHUNK, len(a))
            _products(first, last, a, b, room[0])
            _add_up(c, first, last, region, room)
    return _added(CHUNK, room, count)


@kernel()
def _take(first, last, values, terms):
    for i in range(first, last):
        terms[i] = values[i]


@kernel(parallel=True)
def _sums_shared(values, region, room):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(values))):
            first, last = bounds(part, len(values))
            _take(first, last, values, room[0])
            _add_up(part, first, last, region, room)


@kernel()
def sums(values, region, count):
    """Return the sum of values (m,) over each of ``count`` regions."""
    room = _room_for(parts(len(values)), len(values))
    if len(values) >= MANY:
        _sums_shared(values, region, room)
    else:
        for part in range(parts(len(values))):
            first, last = bounds(part, len(values))
            _take(first, last, values, room[0])
            _add_up(part, first, last, region, room)
    return _added(PART, room, count)


@kernel()
def _works(normal, opening, shear, slip, terms):
    for c in range(len(terms)):
        terms[c] = normal[c] * opening[c] + shear[c] * slip[c]


@kernel()
def _works_of_part(part, normal, opening, shear, slip, region, room):
    """Add up N x opening + T x slip of one part of the contacts."""
    first, last = bounds(part, len(region))
    _works(
        normal[first:last],
        opening[first:last],
        shear[first:last],
        slip[first:last],
        room[0][first:last],
    )
    _add_up(part, first, last, region, room)


@kernel(parallel=True)
def _works_shared(normal, opening, shear, slip, region, room):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(region))):
            _works_of_part(part, normal, opening, shear, slip, region, room)


@kernel()
def works(normal, opening, shear, slip, region, count):
    """Return the work of contact forces N and T (m,) on motions (m,) in each region, (count,)."""
    room = _room_for(parts(len(region)), len(region))
    if len(region) >= MANY:
        _works_shared(normal, opening, shear, slip, region, room)
    else:
        for part in range(parts(len(region))):
            _works_of_part(part, normal, opening, shear, slip, region, room)
    return _added(PART, room, count)


@kernel()
def _advance(first, last, unknowns, direction, length, region, result):
    for i in range(first, last):
        put_row(result, i, plus_scaled(row(unknowns, i), length[region[i]], row(direction, i)))


@kernel(parallel=True)
def _advance_shared(unknowns, direction, length, region, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(result))):
            last = min((c + 1) * CHUNK, len(result))
            _advance(c * CHUNK, last, unknowns, direction, length, region, result)


@kernel()
def advanced(unknowns, direction, length, region):
    """Return d + l dd, with the length l of each block's region, of d and dd (n, 6)."""
    result = np.empty_like(unknowns)
    if len(result) < SHARED:
        _advance(0, len(result), unknowns, direction, length, region, result)
    else:
        _advance_shared(unknowns, direction, length, region, result)
    return result
