"""The first-order displacement function, all blocks or contacts at once (Shi 1988)."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


@kernel()
def _displace(first, last, offset, unknowns, block, result):
    for k in range(first, last):
        x, y, d = offset[k, 0], offset[k, 1], unknowns[block[k]]
        result[k, 0] = d[0] - y * d[2] + x * d[3] + 0.5 * y * d[5]
        result[k, 1] = d[1] + x * d[2] + y * d[4] + 0.5 * x * d[5]


@kernel(parallel=True)
def _displace_shared(offset, unknowns, block, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(offset))):
            first, last = bounds(part, len(offset))
            _displace(first, last, offset, unknowns, block, result)


@kernel()
def displacements(offset, unknowns, block):
    """Return T d, m, (k, 2) at offsets (k, 2), m, from d (n, 6) of their blocks (k,)."""
    result = np.empty_like(offset)
    if len(offset) >= MANY:
        _displace_shared(offset, unknowns, block, result)
    else:
        _displace(0, len(offset), offset, unknowns, block, result)
    return result


@kernel()
def movements(offset, unknowns, gradient, block):
    """Return (u0, v0) + G x, m, (k, 2), at offsets x (k, 2), m, in blocks (k,); G (n, 2, 2)."""
    result = np.empty_like(offset)
    for k in range(len(offset)):
        x, y, b = offset[k, 0], offset[k, 1], block[k]
        result[k, 0] = unknowns[b, 0] + (gradient[b, 0, 0] * x + gradient[b, 0, 1] * y)
        result[k, 1] = unknowns[b, 1] + (gradient[b, 1, 0] * x + gradient[b, 1, 1] * y)
    return result


@kernel()
def _row(x, y, ax, ay, row):
    """Write T(x, y)^T a into a row (6,)."""
    row[0] = ax
    row[1] = ay
    row[2] = ay * x - ax * y
    row[3] = ax * x
    row[4] = ay * y
    row[5] = ax * (0.5 * y) + ay * (0.5 * x)


@kernel()
def contact_rows(levers):
    """Return T_i^T n, -T_j^T n, T_i^T t and -T_j^T t of the contacts, shape (m, 4, 6).

    ``levers`` (m, 6) are nx, ny and the offsets of the vertex and of its foot from the centroids of
    their blocks, m; t = (-ny, nx) is the direction of the edge.
    """
    rows = np.empty((len(levers), 4, 6))
    for c in range(len(levers)):
        nx, ny, xi, yi, xj, yj = levers[c]
        _row(xi, yi, nx, ny, rows[c, 0])
        _row(xj, yj, -nx, -ny, rows[c, 1])
        _row(xi, yi, -ny, nx, rows[c, 2])
        _row(xj, yj, ny, -nx, rows[c, 3])
    return rows


@kernel()
def _mass_matrices(first, last, mass, moments, m):
    m[first:last] = 0.0
    for b in range(first, last):
        sxx, syy, sxy = moments[b, 0], moments[b, 1], moments[b, 2]
        m[b, 0, 0] = m[b, 1, 1] = mass[b]
        m[b, 2, 2] = sxx + syy
        m[b, 2, 3] = m[b, 3, 2] = -sxy
        m[b, 2, 4] = m[b, 4, 2] = sxy
        m[b, 2, 5] = m[b, 5, 2] = 0.5 * (sxx - syy)
        m[b, 3, 3] = sxx
        m[b, 3, 5] = m[b, 5, 3] = 0.5 * sxy
        m[b, 4, 4] = syy
        m[b, 4, 5] = m[b, 5, 4] = 0.5 * sxy
        m[b, 5, 5] = 0.25 * (sxx + syy)


@kernel(parallel=True)
def _mass_matrices_shared(mass, moments, m):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(mass))):
            first, last = bounds(part, len(mass))
            _mass_matrices(first, last, mass, moments, m)


@kernel()
def mass_matrices(mass, moments):
    """Return int T^T T dm (n, 6, 6) from mass (n,), kg/m, and moments (n, 3), kg m2/m."""
    m = np.empty((len(mass), 6, 6))
    if len(mass) >= MANY:
        _mass_matrices_shared(mass, moments, m)
    else:
        _mass_matrices(0, len(mass), mass, moments, m)
    return m
