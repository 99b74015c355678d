"""Sums over regions: of forms and products block by block, of works contact by contact.

Threads share the work.  Where there are few regions each chunk of blocks or part of the contacts
has sums of its own, which are added up in their order; where there are many, every block or contact
has, and one thread adds them up.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.block_rows import CHUNK, SHARED, chunks, times
from clast.kernels.compiled import kernel
from clast.kernels.shared_loops import nothing_done, threads_of, to_do
from clast.kernels.shares import MANY, PART, parts
from clast.kernels.six import plus_product, plus_scaled, put_row, row, total, zeros

FEW = 64
"""Regions up to which every chunk or part has sums of all of them."""


@kernel()
def room_for(pieces, region, count):
    """Return in which sum every term (m,) belongs, and sums: of regions piece by piece, or of one.

    Pieces take one row of sums after the other, or all the only one.
    """
    if count <= FEW:
        return region, np.zeros((pieces, count))
    return np.arange(len(region)), np.zeros((1, len(region)))


@kernel()
def added(sums, region, count):
    """Return the sums of ``count`` regions, of what :func:`room_for` gave room for."""
    result = np.zeros(count)
    if count <= FEW:
        for part in sums:
            result += part
    else:
        for i in range(len(region)):
            result[region[i]] += sums[0, i]
    return result


@kernel()
def _add_forms(first, last, blocks, d, region, sums):
    """Add d_i.B_i d_i of blocks ``first`` to ``last`` - 1 to the sums of their regions."""
    for i in range(first, last):
        sums[region[i]] += total(plus_product(zeros(), times(blocks, i, d, i), row(d, i)))


@kernel(parallel=True)
def _add_forms_shared(blocks, d, region, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(d))):
            own, last = sums[c % len(sums)], min((c + 1) * CHUNK, len(d))
            _add_forms(c * CHUNK, last, blocks, d, region, own)


@kernel()
def forms(blocks, d, region, count):
    """Return the sum of d_i.B_i d_i over each of ``count`` regions, B (n, 6, 6), d (n, 6)."""
    if len(d) < SHARED:
        result = np.zeros(count)
        _add_forms(0, len(d), blocks, d, region, result)
        return result
    at, sums = room_for(chunks(len(d)), region, count)
    _add_forms_shared(blocks, d, at, sums)
    return added(sums, region, count)


@kernel()
def _add_products(first, last, a, b, region, sums):
    """Add a_i.b_i of blocks ``first`` to ``last`` - 1 to the sums of their regions."""
    for i in range(first, last):
        sums[region[i]] += total(plus_product(zeros(), row(a, i), row(b, i)))


@kernel(parallel=True)
def _add_products_shared(a, b, region, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(a))):
            own, last = sums[c % len(sums)], min((c + 1) * CHUNK, len(a))
            _add_products(c * CHUNK, last, a, b, region, own)


@kernel()
def products(a, b, region, count):
    """Return a.b of two vectors (n, 6) over each of ``count`` regions."""
    if len(a) < SHARED:
        result = np.zeros(count)
        _add_products(0, len(a), a, b, region, result)
        return result
    at, sums = room_for(chunks(len(a)), region, count)
    _add_products_shared(a, b, at, sums)
    return added(sums, region, count)


@kernel()
def _add_works(first, last, normal, opening, shear, slip, region, sums):
    """Add N x opening + T x slip of contacts ``first`` to ``last`` - 1 to their regions' sums."""
    for c in range(first, last):
        sums[region[c]] += normal[c] * opening[c] + shear[c] * slip[c]


@kernel(parallel=True)
def _add_works_shared(normal, opening, shear, slip, region, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(region))):
            own, last = sums[part % len(sums)], min((part + 1) * PART, len(region))
            _add_works(part * PART, last, normal, opening, shear, slip, region, own)


@kernel()
def works(normal, opening, shear, slip, region, count):
    """Return the work of contact forces N and T (m,) on motions (m,) in each region, (count,)."""
    if len(region) < MANY:
        result = np.zeros(count)
        _add_works(0, len(region), normal, opening, shear, slip, region, result)
        return result
    at, sums = room_for(parts(len(region)), region, count)
    _add_works_shared(normal, opening, shear, slip, at, sums)
    return added(sums, region, count)


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
