"""The theta family of implicit schemes, block by block.

    M (v+ - v) = h F,   d = h ((1 - theta) v + theta v+)

with F the forces at the end of the step.  theta = 1/2 is constant acceleration (Shi 1988), 1 is
backward Euler.  Eliminating v+ gives (M/(theta h2)) d = (M/(theta h)) v + F.  Every block receives
the impulse h F whatever its theta, so blocks with different theta still exchange momentum exactly.
"""

from __future__ import annotations

import numpy as np

from clast.kernels import block_terms
from clast.model import Floats


def inertia_factor(theta: Floats, step: float) -> Floats:
    """Return 1/(theta h2) of each block, 1/s2, shape (n,)."""
    return 1.0 / (theta * step**2)


def velocity_factor(theta: Floats, step: float) -> Floats:
    """Return 1/(theta h) of each block, 1/s, shape (n,)."""
    return 1.0 / (theta * step)


def end_velocity(theta: Floats, displacement: Floats, velocity: Floats, step: float) -> Floats:
    """Return v+ = (d/h - (1 - theta) v)/theta of each block, shape (n, 6)."""
    return np.asarray(block_terms.end_velocities(theta, displacement, velocity, step))
