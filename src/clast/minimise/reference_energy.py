"""What a step's forces amount to, for tolerances and bounds to refer to."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, SHARED, chunks
from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus_product, plus_scaled, put_row, row, total, zeros


@kernel()
def _half_form(inverse, i, force):
    """Return 1/2 f.B_i^-1 f of the only row of ``force``."""
    return 0.5 * total(plus_product(zeros(), times(inverse, i, force, 0), row(force, 0)))


@kernel()
def _of_chunk(first, last, inverse, force, momentum, fixed, sums):
    at_rest, moving = np.empty((1, 6)), np.empty((1, 6))
    for i in range(first, last):
        if not fixed[i]:
            put_row(at_rest, 0, plus_scaled(row(force, i), -1.0, row(momentum, i)))
            put_row(moving, 0, row(momentum, i))
            sums[0] += _half_form(inverse, i, at_rest)
            sums[1] += _half_form(inverse, i, moving)
            sums[2] += np.hypot(force[i, 0], force[i, 1])


@kernel(parallel=True)
def _of_chunks(inverse, force, momentum, fixed, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(sums)):
            last = min((c + 1) * CHUNK, len(force))
            _of_chunk(c * CHUNK, last, inverse, force, momentum, fixed, sums[c])


@kernel()
def of_forces(inverse, force, momentum, fixed):
    """Return 1/2 f.B^-1 f of what is no momentum and of momentum, J/m, and the sum of forces, N/m.

    Of blocks that are not ``fixed`` (n,): ``force`` (n, 6) with ``momentum`` (n, 6), ``inverse``
    (n, 6, 6) being B^-1.
    """
    sums = np.zeros((chunks(len(force)), 3))
    if len(force) >= SHARED:
        _of_chunks(inverse, force, momentum, fixed, sums)
    else:
        for c in range(len(sums)):
            last = min((c + 1) * CHUNK, len(force))
            _of_chunk(c * CHUNK, last, inverse, force, momentum, fixed, sums[c])
    return sums[:, 0].sum(), sums[:, 1].sum(), sums[:, 2].sum()
