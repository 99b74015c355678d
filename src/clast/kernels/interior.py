"""The interior point method contact by contact (stepping/interior.py).

A state of the contacts is an array (7, m): normal force N, clearance w, shear force T, T + b,
b - T, and the slips w+ and w- beyond the lower and the upper bound of T.  All but T are positive.
A contact without shear strength, b = 0, has zeros in all that belongs to shear.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel
from clast.kernels.shares import MANY, PART, parts

NORMAL, CLEARANCE, SHEAR, ABOVE, BELOW, LOWER, UPPER = range(7)


@kernel()
def _linearise(first, last, state, gap, slip, springs, errors, stiffnesses):
    p, k, normal_at_zero, shear_at_zero, strength = springs
    normal_error, shear_error = errors
    kn, ks = stiffnesses
    for c in range(first, last):
        n, w, t = state[NORMAL, c], state[CLEARANCE, c], state[SHEAR, c]
        low, up = state[LOWER, c], state[UPPER, c]
        normal_error[c] = (n - normal_at_zero[c]) / p + gap[c] - w
        shear_error[c] = (t - shear_at_zero[c]) / k + slip[c] - low + up
        kn[c] = 1.0 / (1.0 / p + w / n)
        ks[c] = 0.0
        if strength[c] > 0.0:
            ks[c] = 1.0 / (1.0 / k + low / state[ABOVE, c] + up / state[BELOW, c])


@kernel(parallel=True)
def _linearise_shared(state, gap, slip, springs, errors, stiffnesses):
    for part in prange(parts(len(gap))):
        last = min((part + 1) * PART, len(gap))
        _linearise(part * PART, last, state, gap, slip, springs, errors, stiffnesses)


@kernel()
def linearised(state, gap, slip, springs):
    """Return by how much gap and slip miss the conditions, m, and the stiffnesses, (m,) each.

    ``springs`` are p, k, and the forces at gap and slip 0 and the shear strength (m,).
    """
    count = len(gap)
    errors = np.empty(count), np.empty(count)
    stiffnesses = np.empty(count), np.empty(count)
    if count >= MANY:
        _linearise_shared(state, gap, slip, springs, errors, stiffnesses)
    else:
        _linearise(0, count, state, gap, slip, springs, errors, stiffnesses)
    return errors, stiffnesses


@kernel()
def _aim(first, last, state, target, before, errors, stiffnesses, strength, wanted, free, loads):
    normal_error, shear_error = errors
    kn, ks = stiffnesses
    opening, sliding = free
    normal, shear = loads
    for c in range(first, last):
        change = target - state[NORMAL, c] * state[CLEARANCE, c]
        change -= before[NORMAL, c] * before[CLEARANCE, c]
        opening[c] = change / state[NORMAL, c] - normal_error[c]
        wanted[0, c] = wanted[1, c] = 0.0
        sliding[c] = -shear_error[c]
        if strength[c] > 0.0:
            above, below, t = state[ABOVE, c], state[BELOW, c], before[SHEAR, c]
            wanted[0, c] = target - above * state[LOWER, c] - t * before[LOWER, c]
            wanted[1, c] = target - below * state[UPPER, c] + t * before[UPPER, c]
            sliding[c] += wanted[0, c] / above - wanted[1, c] / below
        normal[c], shear[c] = kn[c] * opening[c], ks[c] * sliding[c]


@kernel(parallel=True)
def _aim_shared(state, target, before, errors, stiffnesses, strength, wanted, free, loads):
    for part in prange(parts(len(strength))):
        low, high = part * PART, min((part + 1) * PART, len(strength))
        _aim(low, high, state, target, before, errors, stiffnesses, strength, wanted, free, loads)


@kernel()
def aimed(state, target, before, errors, stiffnesses, strength):
    """Return what contacts contribute where all products are to be ``target``, J/m.

    The changes wanted of (T + b) w+ and (b - T) w-, J/m, (2, m); the gap and slip that contacts
    ask for, m; and the forces on blocks that do not move, N/m: two arrays (m,) each.  The way
    ``before`` (7, m) has shown the bend of the products.
    """
    count = len(strength)
    wanted = np.empty((2, count))
    free, loads = (np.empty(count), np.empty(count)), (np.empty(count), np.empty(count))
    if count >= MANY:
        _aim_shared(state, target, before, errors, stiffnesses, strength, wanted, free, loads)
    else:
        _aim(0, count, state, target, before, errors, stiffnesses, strength, wanted, free, loads)
    return wanted, free, loads


@kernel()
def _go(first, last, state, changes, wanted, free, errors, stiffnesses, p, strength, way):
    """Write the way and return how far it can be gone."""
    gap, slip = changes
    opening, sliding = free
    kn, ks = stiffnesses
    limit = np.inf
    for c in range(first, last):
        n = kn[c] * (opening[c] - gap[c])
        t = low = up = 0.0
        if strength[c] > 0.0:
            t = ks[c] * (sliding[c] - slip[c])
            low = (wanted[0, c] - state[LOWER, c] * t) / state[ABOVE, c]
            up = (wanted[1, c] + state[UPPER, c] * t) / state[BELOW, c]
        way[NORMAL, c], way[CLEARANCE, c] = n, n / p + gap[c] + errors[0][c]
        way[SHEAR, c], way[ABOVE, c], way[BELOW, c] = t, t, -t
        way[LOWER, c], way[UPPER, c] = low, up
        for q in (NORMAL, CLEARANCE, ABOVE, BELOW, LOWER, UPPER):
            if way[q, c] < 0.0:
                limit = min(limit, -state[q, c] / way[q, c])
    return limit


@kernel(parallel=True)
def _go_shared(state, changes, wanted, free, errors, stiffnesses, p, strength, way, limits):
    for part in prange(len(limits)):
        low, high = part * PART, min((part + 1) * PART, len(strength))
        limits[part] = _go(
            low, high, state, changes, wanted, free, errors, stiffnesses, p, strength, way
        )


@kernel()
def way_of(state, changes, wanted, free, errors, stiffnesses, p, strength):
    """Return the way of the state (7, m) while gap and slip change by ``changes``, (m,) each, m.

    And how far it can be gone before something that is positive becomes zero.  ``wanted`` and
    ``free`` are those of ``aimed``.
    """
    way = np.empty_like(state)
    count = len(strength)
    if count >= MANY:
        limits = np.empty(parts(count))
        _go_shared(state, changes, wanted, free, errors, stiffnesses, p, strength, way, limits)
        return way, limits.min()
    limit = _go(0, count, state, changes, wanted, free, errors, stiffnesses, p, strength, way)
    return way, limit


@kernel()
def _products(first, last, state, way, share, strength):
    total = 0.0
    for c in range(first, last):
        n = state[NORMAL, c] + share * way[NORMAL, c]
        total += n * (state[CLEARANCE, c] + share * way[CLEARANCE, c])
        if strength[c] > 0.0:
            above = state[ABOVE, c] + share * way[ABOVE, c]
            below = state[BELOW, c] + share * way[BELOW, c]
            total += above * (state[LOWER, c] + share * way[LOWER, c])
            total += below * (state[UPPER, c] + share * way[UPPER, c])
    return total


@kernel(parallel=True)
def _products_shared(state, way, share, strength, totals):
    for part in prange(len(totals)):
        low, high = part * PART, min((part + 1) * PART, len(strength))
        totals[part] = _products(low, high, state, way, share, strength)


@kernel()
def mean_product(state, way, share, strength):
    """Return the mean of all products ``share`` of the way on, J/m; without strength one of N w."""
    totals = np.empty(parts(len(strength)))
    if len(strength) >= MANY:
        _products_shared(state, way, share, strength, totals)
    else:
        for part in range(len(totals)):
            low, high = part * PART, min((part + 1) * PART, len(strength))
            totals[part] = _products(low, high, state, way, share, strength)
    count = len(strength) + 2 * (strength > 0.0).sum()
    return totals.sum() / count


@kernel(parallel=True)
def _moved_shared(state, way, share, result):
    for part in prange(parts(len(state))):
        for k in range(part * PART, min((part + 1) * PART, len(state))):
            result[k] = state[k] + share * way[k]


@kernel()
def moved(state, way, share):
    """Return ``state`` + share x ``way``, arrays of one shape."""
    result = np.empty_like(state)
    if state.size >= MANY:
        _moved_shared(state.ravel(), way.ravel(), share, result.ravel())
    else:
        result[:] = state + share * way
    return result
