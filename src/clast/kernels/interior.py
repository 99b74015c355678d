"""The interior point method contact by contact (stepping/interior.py).

A state of the contacts is an array (6, m): normal force N, clearance w, T + b and b - T of the
shear force T, and the slips w+ and w- beyond the lower and the upper bound of T.  All are positive.
A contact without shear strength, b = 0, has zeros in all that belongs to shear.

A way from there is an array (5, m): the changes of N, w, T, w+ and w-.  It is kept in single
precision: systems are solved to a tenth, and what a way leaves is part of the next one.

There are as many contacts as blocks and more, and every kernel waits for memory.  So what can be
found again from what is read anyway is not kept, and what belongs to one place is done in one go.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel
from clast.kernels.shares import MANY, bounds, parts

NORMAL, CLEARANCE, ABOVE, BELOW, LOWER, UPPER = range(6)
D_NORMAL, D_CLEARANCE, D_SHEAR, D_LOWER, D_UPPER = range(5)
NEARLY = 1.0 - 1e-9
"""Share of the shear strength that the first shear force may reach."""


@kernel(forceinline=True)
def _linearise(c, gap, slip, springs, at):
    """Write by how much gap and slip miss the conditions and the stiffnesses of contact c.

    ``at`` are the state, both errors and both stiffnesses.  Returned is the sum of its products.
    """
    p, k, normal_at_zero, shear_at_zero, _ = springs
    state, normal_error, shear_error, kn, ks = at
    n, w = state[NORMAL, c], state[CLEARANCE, c]
    above, below = state[ABOVE, c], state[BELOW, c]
    low, up = state[LOWER, c], state[UPPER, c]
    normal_error[c] = (n - normal_at_zero[c]) / p + gap - w
    shear_error[c] = (0.5 * (above - below) - shear_at_zero[c]) / k + slip - low + up
    kn[c] = 1.0 / (1.0 / p + w / n)
    ks[c] = 0.0
    if above > 0.0:
        ks[c] = 1.0 / (1.0 / k + low / above + up / below)
    return n * w + above * low + below * up


@kernel(forceinline=True)
def _empty(count):
    """Return a state, errors and stiffnesses of contacts to write to."""
    one, other, third, fourth = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    return np.empty((6, count)), one, other, third, fourth


@kernel()
def _centre(first, last, gap, slip, rounding, springs, at):
    p, k, normal_at_zero, shear_at_zero, strength = springs
    state = at[0]
    mu, total = rounding**2 / (4.0 * p), 0.0
    for c in range(first, last):
        trial = normal_at_zero[c] - p * gap[c]
        root = np.sqrt(trial**2 + rounding**2)
        n = 0.5 * (trial + root) if trial > 0.0 else 2.0 * mu * p / (root - trial)
        state[NORMAL, c], state[CLEARANCE, c] = n, mu / n
        above = below = low = up = 0.0
        b = strength[c]
        if b > 0.0:
            t = shear_at_zero[c] - k * slip[c]
            t = 0.5 * (np.hypot(t + b, rounding) - np.hypot(t - b, rounding))
            t = min(max(t, -NEARLY * b), NEARLY * b)
            above, below = b + t, b - t
            low, up = mu / above, mu / below
        state[ABOVE, c], state[BELOW, c] = above, below
        state[LOWER, c], state[UPPER, c] = low, up
        total += _linearise(c, gap[c], slip[c], springs, at)
    return total


@kernel(parallel=True)
def _centre_shared(gap, slip, rounding, springs, at, totals):
    for part in prange(len(totals)):
        first, last = bounds(part, len(gap))
        totals[part] = _centre(first, last, gap, slip, rounding, springs, at)


@kernel()
def centred(gap, slip, rounding, springs):
    """Return state, errors, stiffnesses and the sum of all products where normal ones are equal.

    They are mu = rounding^2/(4 p), ``rounding`` being a force, N/m; gap and slip (m,).  ``springs``
    are p, k, the forces at gap and slip 0, and the shear strength (m,).  Errors are what gap and
    slip miss the conditions by, m; stiffnesses N/m2; two arrays (m,) each.
    """
    at, totals = _empty(len(gap)), np.empty(parts(len(gap)))
    if len(gap) >= MANY:
        _centre_shared(gap, slip, rounding, springs, at, totals)
    else:
        for part in range(len(totals)):
            first, last = bounds(part, len(gap))
            totals[part] = _centre(first, last, gap, slip, rounding, springs, at)
    state, normal_error, shear_error, kn, ks = at
    return state, (normal_error, shear_error), (kn, ks), totals.sum()


@kernel(forceinline=True)
def _asked(c, state, target, before, errors):
    """Return gap and slip that contact c asks for, m, and what its shear products lack, J/m.

    ``before`` is a way that has shown the bend of the products, or None.
    """
    bent_n = bent_low = bent_up = 0.0
    if before is not None:
        bent_n = before[D_NORMAL, c] * before[D_CLEARANCE, c]
        bent_low = before[D_SHEAR, c] * before[D_LOWER, c]
        bent_up = -before[D_SHEAR, c] * before[D_UPPER, c]
    n, above, below = state[NORMAL, c], state[ABOVE, c], state[BELOW, c]
    opening = (target - n * state[CLEARANCE, c] - bent_n) / n - errors[0][c]
    sliding, low, up = -errors[1][c], 0.0, 0.0
    if above > 0.0:
        low = target - above * state[LOWER, c] - bent_low
        up = target - below * state[UPPER, c] - bent_up
        sliding += low / above - up / below
    return opening, sliding, low, up


@kernel()
def _aim(first, last, state, target, before, errors, stiffnesses, tension, forces):
    normal, shear = forces
    for c in range(first, last):
        opening, sliding, _, _ = _asked(c, state, target, before, errors)
        t = 0.5 * (state[ABOVE, c] - state[BELOW, c])
        normal[c] = state[NORMAL, c] - tension[c] + stiffnesses[0][c] * opening
        shear[c] = t + stiffnesses[1][c] * sliding


@kernel(parallel=True)
def _aim_shared(state, target, before, errors, stiffnesses, tension, forces):
    for part in prange(parts(len(tension))):
        first, last = bounds(part, len(tension))
        _aim(first, last, state, target, before, errors, stiffnesses, tension, forces)


@kernel()
def aimed(state, target, before, errors, stiffnesses, tension):
    """Return the forces on blocks that do not move where all products are to be ``target``, J/m.

    N and T, N/m, (m,) each; the ``tension`` (m,) that bonds bear has been taken from N.  The way
    ``before`` (5, m) has shown the bend of the products; None: nothing has.
    """
    count = len(tension)
    forces = np.empty(count), np.empty(count)
    if count >= MANY:
        _aim_shared(state, target, before, errors, stiffnesses, tension, forces)
    else:
        _aim(0, count, state, target, before, errors, stiffnesses, tension, forces)
    return forces


@kernel(forceinline=True)
def _sooner(limit, value, change):
    """Return how far a way can be gone before ``value`` is zero, or ``limit`` where that is less."""
    return min(limit, -value / change) if change < 0.0 else limit


@kernel()
def _go(first, last, state, target, before, errors, stiffnesses, changes, p, way):
    """Write the way; return how far it can be gone, and how the products change and bend."""
    limit, change, bend = np.inf, 0.0, 0.0
    for c in range(first, last):
        opening, sliding, low, up = _asked(c, state, target, before, errors)
        n = stiffnesses[0][c] * (opening - changes[0][c])
        w = n / p + changes[0][c] + errors[0][c]
        limit = _sooner(_sooner(limit, state[NORMAL, c], n), state[CLEARANCE, c], w)
        change += state[NORMAL, c] * w + state[CLEARANCE, c] * n
        bend += n * w
        t = 0.0
        above, below = state[ABOVE, c], state[BELOW, c]
        if above > 0.0:
            t = stiffnesses[1][c] * (sliding - changes[1][c])
            low = (low - state[LOWER, c] * t) / above
            up = (up + state[UPPER, c] * t) / below
            limit = _sooner(_sooner(limit, above, t), below, -t)
            limit = _sooner(_sooner(limit, state[LOWER, c], low), state[UPPER, c], up)
            change += above * low + below * up + (state[LOWER, c] - state[UPPER, c]) * t
            bend += t * (low - up)
        way[D_NORMAL, c], way[D_CLEARANCE, c], way[D_SHEAR, c] = n, w, t
        way[D_LOWER, c], way[D_UPPER, c] = low, up
    return limit, change, bend


@kernel(parallel=True)
def _go_shared(state, target, before, errors, stiffnesses, changes, p, way, found):
    for part in prange(len(found)):
        first, last = bounds(part, way.shape[1])
        found[part, 0], found[part, 1], found[part, 2] = _go(
            first, last, state, target, before, errors, stiffnesses, changes, p, way
        )


@kernel()
def way_of(state, target, before, errors, stiffnesses, changes, p):
    """Return the way (5, m) of the contacts, how far it can be gone, and two sums, J/m.

    ``changes`` are those of gap and slip, m, (m,) each, the others as in ``aimed``.  The share
    returned is where the first of what is positive becomes zero.  At a share s of the way the sum
    of all products has grown by s times the first sum and s^2 times the second.
    """
    count = state.shape[1]
    way, found = np.empty((5, count), np.float32), np.empty((parts(count), 3))
    if count >= MANY:
        _go_shared(state, target, before, errors, stiffnesses, changes, p, way, found)
    else:
        for part in range(len(found)):
            first, last = bounds(part, count)
            found[part, 0], found[part, 1], found[part, 2] = _go(
                first, last, state, target, before, errors, stiffnesses, changes, p, way
            )
    return way, found[:, 0].min(), found[:, 1].sum(), found[:, 2].sum()


@kernel()
def _advance(first, last, old, gaps, way, changes, share, springs, new, at):
    state, total = at[0], 0.0
    for c in range(first, last):
        state[NORMAL, c] = old[NORMAL, c] + share * way[D_NORMAL, c]
        state[CLEARANCE, c] = old[CLEARANCE, c] + share * way[D_CLEARANCE, c]
        state[LOWER, c] = old[LOWER, c] + share * way[D_LOWER, c]
        state[UPPER, c] = old[UPPER, c] + share * way[D_UPPER, c]
        t = share * way[D_SHEAR, c]
        state[ABOVE, c], state[BELOW, c] = old[ABOVE, c] + t, old[BELOW, c] - t
        gap, slip = gaps[0][c] + share * changes[0][c], gaps[1][c] + share * changes[1][c]
        new[0][c], new[1][c] = gap, slip
        total += _linearise(c, gap, slip, springs, at)
    return total


@kernel(parallel=True)
def _advance_shared(old, gaps, way, changes, share, springs, new, at, totals):
    for part in prange(len(totals)):
        first, last = bounds(part, old.shape[1])
        totals[part] = _advance(first, last, old, gaps, way, changes, share, springs, new, at)


@kernel()
def advanced(old, gaps, way, changes, share, springs):
    """Return gaps, state, errors, stiffnesses and the sum of all products ``share`` of a way on.

    ``old`` is the state, ``gaps`` are gap and slip there, m, (m,) each; see ``centred``.
    """
    count = old.shape[1]
    new = np.empty(count), np.empty(count)
    at, totals = _empty(count), np.empty(parts(count))
    if count >= MANY:
        _advance_shared(old, gaps, way, changes, share, springs, new, at, totals)
    else:
        for part in range(len(totals)):
            first, last = bounds(part, count)
            totals[part] = _advance(first, last, old, gaps, way, changes, share, springs, new, at)
    state, normal_error, shear_error, kn, ks = at
    return new, state, (normal_error, shear_error), (kn, ks), totals.sum()
