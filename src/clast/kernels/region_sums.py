"""Sums over regions: of forms and products block by block, of works contact by contact.

Where there are few regions threads share the work, each chunk of blocks or part of the contacts
with sums of its own, which are added up in their order; where there are many, one thread goes
through all.
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
"""Regions up to which every chunk or part has sums of its own."""


@kernel()
def added(sums):
    """Return the sum over the first axis, in its order."""
    result = np.zeros(sums.shape[1])
    for part in sums:
        result += part
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
        for c in to_do(thread, progress, len(sums)):
            _add_forms(c * CHUNK, min((c + 1) * CHUNK, len(d)), blocks, d, region, sums[c])


@kernel()
def forms(blocks, d, region, count):
    """Return the sum of d_i.B_i d_i over each of ``count`` regions, B (n, 6, 6), d (n, 6)."""
    if len(d) < SHARED or count > FEW:
        result = np.zeros(count)
        _add_forms(0, len(d), blocks, d, region, result)
        return result
    sums = np.zeros((chunks(len(d)), count))
    _add_forms_shared(blocks, d, region, sums)
    return added(sums)


@kernel()
def _add_products(first, last, a, b, region, sums):
    """Add a_i.b_i of blocks ``first`` to ``last`` - 1 to the sums of their regions."""
    for i in range(first, last):
        sums[region[i]] += total(plus_product(zeros(), row(a, i), row(b, i)))


@kernel(parallel=True)
def _add_products_shared(a, b, region, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(sums)):
            _add_products(c * CHUNK, min((c + 1) * CHUNK, len(a)), a, b, region, sums[c])


@kernel()
def products(a, b, region, count):
    """Return a.b of two vectors (n, 6) over each of ``count`` regions."""
    if len(a) < SHARED or count > FEW:
        result = np.zeros(count)
        _add_products(0, len(a), a, b, region, result)
        return result
    sums = np.zeros((chunks(len(a)), count))
    _add_products_shared(a, b, region, sums)
    return added(sums)


@kernel()
def _add_works(first, last, normal, opening, shear, slip, region, sums):
    """Add N x opening + T x slip of contacts ``first`` to ``last`` - 1 to their regions' sums."""
    for c in range(first, last):
        sums[region[c]] += normal[c] * opening[c] + shear[c] * slip[c]


@kernel(parallel=True)
def _add_works_shared(normal, opening, shear, slip, region, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(sums)):
            last = min((part + 1) * PART, len(region))
            _add_works(part * PART, last, normal, opening, shear, slip, region, sums[part])


@kernel()
def works(normal, opening, shear, slip, region, count):
    """Return the work of contact forces N and T (m,) on motions (m,) in each region, (count,)."""
    if len(region) < MANY or count > FEW:
        result = np.zeros(count)
        _add_works(0, len(region), normal, opening, shear, slip, region, result)
        return result
    sums = np.zeros((parts(len(region)), count))
    _add_works_shared(normal, opening, shear, slip, region, sums)
    return added(sums)


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
