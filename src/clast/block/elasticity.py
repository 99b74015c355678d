"""Stress and strain rates of the blocks at the end of a step."""

from __future__ import annotations

import numpy as np

from clast.compute.parallel import BLOCKS, shared
from clast.model.model import Floats


def strained(stress: Floats, elasticity: Floats, unknowns: Floats) -> Floats:
    """Return sigma + E' e, Pa, (n, 3), for the strains e of d (n, 6); E' (n, 3, 3) in Pa."""
    result = np.empty_like(stress)
    _strain(len(stress), stress, elasticity, unknowns, result)
    return result


@shared(BLOCKS)
def _strain(low, high, stress, elasticity, unknowns, result):
    """Write the stress of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        for i in range(3):
            gained = 0.0
            for j in range(3):
                gained += elasticity[b, i, j] * unknowns[b, 3 + j]
            result[b, i] = stress[b, i] + gained


def turned(tensor: Floats, first: int, angle: Floats, shear_factor: float) -> Floats:
    """Return a copy with columns ``first`` to first + 2, xx, yy and xy, turned by angles (n,), rad.

    The shear is xy times ``shear_factor``: 1 for stress, 2 for strain with engineering shear.
    """
    result = np.empty_like(tensor)
    _turn(len(tensor), tensor, first, angle, shear_factor, result)
    return result


@shared(BLOCKS)
def _turn(low, high, tensor, first, angle, shear_factor, result):
    """Write the turned tensors, R S R^T, of blocks ``low`` to ``high`` - 1."""
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
