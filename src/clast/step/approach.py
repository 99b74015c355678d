"""How contacts are approached at the start of a step: which of them close, and which hold first."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel()
def closing(gap, moved, rate, threshold):
    """Return which contacts (m,) close faster than ``threshold``, m/s, and within the step.

    ``gap`` (m,), m, and its ``rate`` (m,), m/s, are those at the start; ``moved`` (m,), m, is what
    velocities would change of the gap in the step.
    """
    found = np.empty(len(gap), np.bool_)
    for c in range(len(gap)):
        found[c] = (rate[c] < -threshold) & (gap[c] + moved[c] < 0.0)
    return found


@kernel()
def first_bases(normal_force, gap, rates, slow, landing, step, begins, largest):
    """Return the normal forces (m,), N/m, that bound friction at first (step/convex.py).

    That of the last step where there was any; else ``largest`` where a contact lands without
    slipping or, where the run ``begins``, is without slipping; else none.  It slips at more than
    ``slow``, m/s, and lands where it closes faster than ``landing``, m/s, and within the step.
    """
    opening, slip = rates
    base = np.empty(len(gap))
    for c in range(len(gap)):
        lands = (opening[c] < -landing) & (gap[c] + step * opening[c] < 0.0)
        holds = (abs(slip[c]) <= slow) & (lands | begins)
        base[c] = normal_force[c] if normal_force[c] > 0.0 else largest if holds else 0.0
    return base
