"""Stress and strain rates of the blocks at the end of a step (stepping/advance.py)."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def strained(stress, elasticity, unknowns):
    """Return sigma + E' e, Pa, (n, 3), for the strains of d (n, 6); E' (n, 3, 3)."""
    result = np.empty_like(stress)
    for b in range(len(stress)):
        for i in range(3):
            gained = 0.0
            for j in range(3):
                gained += elasticity[b, i, j] * unknowns[b, 3 + j]
            result[b, i] = stress[b, i] + gained
    return result


@kernel()
def turned(tensor, first, angle, shear_factor):
    """Return a copy with columns ``first`` to first + 2, xx, yy and xy, turned by angles (n,), rad.

    The shear is xy times ``shear_factor``: 1 for stress, 2 for strain with engineering shear.
    """
    result = tensor.copy()
    for b in range(len(tensor)):
        cosine, sine = np.cos(angle[b]), np.sin(angle[b])
        xx, yy = tensor[b, first], tensor[b, first + 1]
        xy = tensor[b, first + 2] / shear_factor
        both = 2.0 * cosine * sine * xy
        result[b, first] = cosine**2 * xx + sine**2 * yy - both
        result[b, first + 1] = sine**2 * xx + cosine**2 * yy + both
        mixed = cosine * sine * (xx - yy) + (cosine**2 - sine**2) * xy
        result[b, first + 2] = shear_factor * mixed
    return result
