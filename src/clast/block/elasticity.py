"""Stress and strain rates of the blocks at the end of a step (step/motion.py)."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


@kernel()
def _strain(low, high, stress, elasticity, unknowns, result):
    for b in range(low, high):
        for i in range(3):
            gained = 0.0
            for j in range(3):
                gained += elasticity[b, i, j] * unknowns[b, 3 + j]
            result[b, i] = stress[b, i] + gained


@kernel(parallel=True)
def _strain_shared(stress, elasticity, unknowns, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(stress))):
            low, high = bounds(part, len(stress))
            _strain(low, high, stress, elasticity, unknowns, result)


@kernel()
def strained(stress, elasticity, unknowns):
    """Return sigma + E' e, Pa, (n, 3), for the strains of d (n, 6); E' (n, 3, 3)."""
    result = np.empty_like(stress)
    if len(stress) >= MANY:
        _strain_shared(stress, elasticity, unknowns, result)
    else:
        _strain(0, len(stress), stress, elasticity, unknowns, result)
    return result


@kernel()
def _turn(low, high, tensor, first, angle, shear_factor, result):
    for b in range(low, high):
        for k in range(tensor.shape[1]):
            result[b, k] = tensor[b, k]
        cosine, sine = np.cos(angle[b]), np.sin(angle[b])
        xx, yy = tensor[b, first], tensor[b, first + 1]
        xy = tensor[b, first + 2] / shear_factor
        both = 2.0 * cosine * sine * xy
        result[b, first] = cosine**2 * xx + sine**2 * yy - both
        result[b, first + 1] = sine**2 * xx + cosine**2 * yy + both
        mixed = cosine * sine * (xx - yy) + (cosine**2 - sine**2) * xy
        result[b, first + 2] = shear_factor * mixed


@kernel(parallel=True)
def _turn_shared(tensor, first, angle, shear_factor, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(tensor))):
            low, high = bounds(part, len(tensor))
            _turn(low, high, tensor, first, angle, shear_factor, result)


@kernel()
def turned(tensor, first, angle, shear_factor):
    """Return a copy with columns ``first`` to first + 2, xx, yy and xy, turned by angles (n,), rad.

    The shear is xy times ``shear_factor``: 1 for stress, 2 for strain with engineering shear.
    """
    result = np.empty_like(tensor)
    if len(tensor) >= MANY:
        _turn_shared(tensor, first, angle, shear_factor, result)
    else:
        _turn(0, len(tensor), tensor, first, angle, shear_factor, result)
    return result
