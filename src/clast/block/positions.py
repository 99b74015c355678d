"""Where points of blocks come to, from where they are."""

from __future__ import annotations

import numpy as np

from clast.block.displacement import displacement_at
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.compute.vec6 import row


@shared(CONTACTS)
def _moved_to(first, last, positions, block, centroid, unknowns, gradient, result):
    """Write where points ``first`` to ``last`` - 1 are after (u0, v0) + G x."""
    for k in range(first, last):
        b = block[k]
        x, y = positions[k, 0] - centroid[b, 0], positions[k, 1] - centroid[b, 1]
        u = unknowns[b, 0] + (gradient[b, 0, 0] * x + gradient[b, 0, 1] * y)
        v = unknowns[b, 1] + (gradient[b, 1, 0] * x + gradient[b, 1, 1] * y)
        result[k, 0], result[k, 1] = positions[k, 0] + u, positions[k, 1] + v


@kernel()
def moved_to(positions, block, centroid, unknowns, gradient):
    """Return where points at ``positions`` (k, 2), m, of blocks (k,) come to by d (n, 6), (k, 2).

    As ``movements`` has it, with the ``gradient`` G (n, 2, 2) of the rotation rule and the
    centroids (n, 2), m.
    """
    result = np.empty_like(positions)
    _moved_to(len(positions), positions, block, centroid, unknowns, gradient, result)
    return result


@shared(CONTACTS)
def _displaced(first, last, positions, block, centroid, unknowns, result):
    """Write T d at points ``first`` to ``last`` - 1 by where they are."""
    for k in range(first, last):
        b = block[k]
        x, y = positions[k, 0] - centroid[b, 0], positions[k, 1] - centroid[b, 1]
        result[k, 0], result[k, 1] = displacement_at(x, y, row(unknowns, b))


@kernel()
def displacements_of(positions, block, centroid, unknowns):
    """Return T d (k, 2), m, of points at ``positions`` (k, 2), m, in blocks (k,): to first order.

    From d (n, 6) and the centroids (n, 2), m.
    """
    result = np.empty_like(positions)
    _displaced(len(positions), positions, block, centroid, unknowns, result)
    return result
