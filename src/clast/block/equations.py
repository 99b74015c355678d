"""What each block contributes to K d = F by itself (step/start.py)."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, SHARED, chunks
from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import line, plus_scaled, put_line, put_row, row, zeros


@kernel()
def _inertia(b, mass_matrix, factor, matrix):
    """Write M/(theta h2) into block b of the matrix."""
    for a in range(6):
        put_line(matrix, b, a, plus_scaled(zeros(), factor, line(mass_matrix, b, a)))


@kernel()
def _elasticity(b, area, elasticity, matrix):
    """Add A E' on the strains to block b of the matrix."""
    for i in range(3):
        for j in range(3):
            matrix[b, 3 + i, 3 + j] += area[b] * elasticity[b, i, j]


@kernel()
def _stress(b, area, stress, force):
    """Add -A sigma to the strain rows of block b: initial stress and what has built up."""
    for i in range(3):
        force[b, 3 + i] -= area[b] * stress[b, i]


@kernel()
def _weight(b, mass, acceleration, force):
    """Add rho A g, at the centroid, to block b."""
    force[b, 0] += mass[b] * acceleration[0]
    force[b, 1] += mass[b] * acceleration[1]


@kernel()
def _of_blocks(first, last, inertia, elastic, stress, mass, acceleration, found):
    """Write the terms of blocks ``first`` to ``last`` - 1."""
    mass_matrix, factor, drift = inertia
    area, elasticity = elastic
    matrix, force, momentum = found
    for b in range(first, last):
        _inertia(b, mass_matrix, factor, matrix)
        _elasticity(b, area, elasticity, matrix)
        md = times(mass_matrix, b, drift, b)
        put_row(momentum, b, plus_scaled(zeros(), factor, md))
        put_row(force, b, row(momentum, b))
        _stress(b, area, stress, force)
        _weight(b, mass, acceleration, force)


@kernel(parallel=True)
def _of_blocks_shared(inertia, elastic, stress, mass, acceleration, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(mass))):
            last = min((c + 1) * CHUNK, len(mass))
            _of_blocks(c * CHUNK, last, inertia, elastic, stress, mass, acceleration, found)


@kernel()
def terms(inertia, elastic, stress, mass, acceleration):
    """Return K (n, 6, 6), F and its part that is momentum, M/(theta h2) drift, (n, 6) each.

    ``inertia``: mass matrix (n, 6, 6), 1/(theta h2) and the drift (n, 6), m.  ``elastic``: area
    (n,) and E' (n, 3, 3).  ``stress`` (n, 3) in Pa, ``acceleration`` (2,) of every mass, m/s2.
    """
    mass_matrix, _, drift = inertia
    found = np.empty_like(mass_matrix), np.empty_like(drift), np.empty_like(drift)
    if len(mass) >= SHARED:
        _of_blocks_shared(inertia, elastic, stress, mass, acceleration, found)
    else:
        _of_blocks(0, len(mass), inertia, elastic, stress, mass, acceleration, found)
    return found
