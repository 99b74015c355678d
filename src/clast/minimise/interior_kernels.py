"""The interior point method contact by contact (minimise/interior_point.py).

A state of the contacts is an array (6, m): normal force N, clearance w, T + b and b - T of the
shear force T, and the slips w+ and w- beyond the lower and the upper bound of T.  All are positive.
A contact without shear strength, b = 0, has zeros in all that belongs to shear.

A way from there is an array (5, m): the changes of N, w, T, w+ and w-.  It is kept in single
precision: systems are solved to a tenth, and what a way leaves is part of the next one.

There are more contacts than blocks, and little is done with each: what belongs to one place is done
in one go, and what can be found again from what is read anyway is not kept.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, in_part, parts, sum_of
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do

NEARLY = 1.0 - 1e-9
"""Share of the shear strength that the first shear force may reach."""


@kernel()
def _state(state, first, last):
    """Return N, w, T + b, b - T, w+ and w- of the contacts ``first`` to ``last`` - 1."""
    normal, clearance = state[0, first:last], state[1, first:last]
    above, below = state[2, first:last], state[3, first:last]
    return normal, clearance, above, below, state[4, first:last], state[5, first:last]


@kernel()
def _way(way, first, last):
    """Return the changes of N, w, T, w+ and w- of the contacts ``first`` to ``last`` - 1."""
    normal, clearance, shear = way[0, first:last], way[1, first:last], way[2, first:last]
    return normal, clearance, shear, way[3, first:last], way[4, first:last]


@kernel(forceinline=True, error_model="numpy")
def _normal_conditions(n, w, gap, p, at_zero):
    """Return by how much a gap misses the conditions, m, and the stiffness against opening."""
    return (n - at_zero) / p + gap - w, 1.0 / (1.0 / p + w / n)


@kernel(forceinline=True, error_model="numpy")
def _shear_conditions(above, below, low, up, slip, k, at_zero):
    """Return by how much a slip misses the conditions, m, and the stiffness against it."""
    stiffness = 1.0 / (1.0 / k + low / above + up / below) if above > 0.0 else 0.0
    return (0.5 * (above - below) - at_zero) / k + slip - low + up, stiffness


@kernel()
def _linearise(first, last, gaps, springs, state, errors, stiffnesses):
    """Write errors and stiffnesses of contacts in a state; return the sum of their products."""
    p, k, normal_at_zero, shear_at_zero, _ = springs
    normal, clearance, above, below, lower, upper = _state(state, first, last)
    gap, slip = in_part(gaps, first, last)
    normal_error, shear_error = in_part(errors, first, last)
    kn, ks = in_part(stiffnesses, first, last)
    normal_at_zero, shear_at_zero = normal_at_zero[first:last], shear_at_zero[first:last]
    products = np.empty(last - first)
    for c in range(len(normal)):
        n, w = normal[c], clearance[c]
        normal_error[c], kn[c] = _normal_conditions(n, w, gap[c], p, normal_at_zero[c])
        products[c] = n * w
    for c in range(len(normal)):
        a, b, low, up = above[c], below[c], lower[c], upper[c]
        shear_error[c], ks[c] = _shear_conditions(a, b, low, up, slip[c], k, shear_at_zero[c])
        products[c] += a * low + b * up
    return sum_of(products)


@kernel(error_model="numpy")
def _centre(first, last, gaps, rounding, springs, state):
    """Write the state whose normal products are all the same."""
    p, k, normal_at_zero, shear_at_zero, strength = springs
    normal, clearance, above, below, lower, upper = _state(state, first, last)
    gap, slip = in_part(gaps, first, last)
    normal_at_zero, shear_at_zero = normal_at_zero[first:last], shear_at_zero[first:last]
    strength, mu, square = strength[first:last], rounding**2 / (4.0 * p), rounding**2
    for c in range(len(normal)):
        trial = normal_at_zero[c] - p * gap[c]
        root = np.sqrt(trial**2 + square)
        n = 0.5 * (trial + root) if trial > 0.0 else 2.0 * mu * p / (root - trial)
        normal[c], clearance[c] = n, mu / n
    for c in range(len(normal)):
        b, t = strength[c], shear_at_zero[c] - k * slip[c]
        t = 0.5 * (np.sqrt((t + b) ** 2 + square) - np.sqrt((t - b) ** 2 + square))
        t = min(max(t, -NEARLY * b), NEARLY * b)
        above[c], below[c] = b + t, b - t
        lower[c] = mu / (b + t) if b > 0.0 else 0.0
        upper[c] = mu / (b - t) if b > 0.0 else 0.0


@kernel(parallel=True)
def _centre_shared(gaps, rounding, springs, state, errors, stiffnesses, totals):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(totals)):
            first, last = bounds(part, state.shape[1])
            _centre(first, last, gaps, rounding, springs, state)
            totals[part] = _linearise(first, last, gaps, springs, state, errors, stiffnesses)


@kernel()
def _for_contacts(count):
    """Return a state, errors, stiffnesses and sums of parts to write to."""
    errors, stiffnesses = (np.empty(count), np.empty(count)), (np.empty(count), np.empty(count))
    return np.empty((6, count)), errors, stiffnesses, np.empty(parts(count))


@kernel()
def centred(gaps, rounding, springs):
    """Return state, errors, stiffnesses and the sum of all products where normal ones are equal.

    They are mu = rounding^2/(4 p), ``rounding`` being a force, N/m; ``gaps`` are gap and slip, m,
    (m,) each.  ``springs`` are p, k, the forces at gap and slip 0, and the shear strength (m,).
    Errors are what gap and slip miss the conditions by, m; stiffnesses N/m2; two arrays (m,) each.
    """
    count = len(gaps[0])
    state, errors, stiffnesses, totals = _for_contacts(count)
    if count >= MANY:
        _centre_shared(gaps, rounding, springs, state, errors, stiffnesses, totals)
    else:
        for part in range(len(totals)):
            first, last = bounds(part, count)
            _centre(first, last, gaps, rounding, springs, state)
            totals[part] = _linearise(first, last, gaps, springs, state, errors, stiffnesses)
    return state, errors, stiffnesses, totals.sum()


@kernel()
def _bent(before, first, last):
    """Return by how much the way ``before`` has bent the products of N, w+ and w-, J/m, (3, m)."""
    bent = np.zeros((3, last - first))
    if before is not None:
        normal, clearance, shear, lower, upper = _way(before, first, last)
        for c in range(len(normal)):
            t = np.float64(shear[c])
            bent[0, c] = np.float64(normal[c]) * clearance[c]
            bent[1, c], bent[2, c] = t * lower[c], -t * upper[c]
    return bent[0], bent[1], bent[2]


@kernel(forceinline=True, error_model="numpy")
def _slips(above, below, low, up, target, bent_low, bent_up):
    """Return what w+ and w- would change by, m, if T stayed."""
    on = above > 0.0
    below_it = (target - above * low - bent_low) / above if on else 0.0
    return below_it, (target - below * up - bent_up) / below if on else 0.0


@kernel(error_model="numpy")
def _aim(first, last, state, target, before, errors, stiffnesses, tension, forces):
    normal, clearance, above, below, lower, upper = _state(state, first, last)
    bent, bent_low, bent_up = _bent(before, first, last)
    normal_error, shear_error = in_part(errors, first, last)
    kn, ks = in_part(stiffnesses, first, last)
    normal_force, shear_force = in_part(forces, first, last)
    tension = tension[first:last]
    for c in range(len(normal)):
        n = normal[c]
        opening = (target - n * clearance[c] - bent[c]) / n - normal_error[c]
        normal_force[c] = n - tension[c] + kn[c] * opening
    for c in range(len(normal)):
        a, b = above[c], below[c]
        low, up = _slips(a, b, lower[c], upper[c], target, bent_low[c], bent_up[c])
        shear_force[c] = 0.5 * (a - b) + ks[c] * (low - up - shear_error[c])


@kernel(parallel=True)
def _aim_shared(state, target, before, errors, stiffnesses, tension, forces):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(tension))):
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
        for part in range(parts(count)):
            first, last = bounds(part, count)
            _aim(first, last, state, target, before, errors, stiffnesses, tension, forces)
    return forces


@kernel(error_model="numpy")
def _go_normal(first, last, state, target, bent, error, stiffness, opening, p, way, found):
    """Write the changes of N and w, and what ``_go`` sums up of each contact."""
    normal, clearance, _, _, _, _ = _state(state, first, last)
    d_normal, d_clearance, _, _, _ = _way(way, first, last)
    haste, growth, bend = found
    for c in range(len(normal)):
        n, w, e = normal[c], clearance[c], error[c]
        asked = (target - n * w - bent[c]) / n - e
        d_n = stiffness[c] * (asked - opening[c])
        d_w = d_n / p + opening[c] + e
        d_normal[c], d_clearance[c] = d_n, d_w
        haste[c] = max(-d_n / n, -d_w / w)
        growth[c], bend[c] = n * d_w + w * d_n, d_n * d_w


@kernel(error_model="numpy")
def _go_shear(first, last, state, target, bents, error, stiffness, sliding, way, found):
    """Write the changes of T, w+ and w-, and add to what ``_go`` sums up of each contact."""
    _, _, above, below, lower, upper = _state(state, first, last)
    _, _, d_shear, d_lower, d_upper = _way(way, first, last)
    bent_low, bent_up = bents
    haste, growth, bend = found
    for c in range(len(above)):
        a, b, low, up = above[c], below[c], lower[c], upper[c]
        on = a > 0.0
        d_low, d_up = _slips(a, b, low, up, target, bent_low[c], bent_up[c])
        t = stiffness[c] * (d_low - d_up - error[c] - sliding[c])
        t_a, t_b = (t / a if on else 0.0), (t / b if on else 0.0)
        d_low, d_up = d_low - low * t_a, d_up + up * t_b
        d_shear[c], d_lower[c], d_upper[c] = t, d_low, d_up
        of_slips = max(-d_low / low if on else 0.0, -d_up / up if on else 0.0)
        haste[c] = max(haste[c], max(max(-t_a, t_b), of_slips))
        growth[c] += a * d_low + b * d_up + (low - up) * t
        bend[c] += t * (d_low - d_up)


@kernel()
def _go(first, last, state, target, before, errors, stiffnesses, changes, p, way):
    """Write the way; return the greatest share that something loses, and how products grow."""
    bent, bent_low, bent_up = _bent(before, first, last)
    errors, stiffnesses = in_part(errors, first, last), in_part(stiffnesses, first, last)
    opening, sliding = in_part(changes, first, last)
    count = last - first
    found = np.empty(count), np.empty(count), np.empty(count)
    _go_normal(first, last, state, target, bent, errors[0], stiffnesses[0], opening, p, way, found)
    bents = bent_low, bent_up
    _go_shear(first, last, state, target, bents, errors[1], stiffnesses[1], sliding, way, found)
    return found[0].max(), sum_of(found[1]), sum_of(found[2])


@kernel(parallel=True)
def _go_shared(state, target, before, errors, stiffnesses, changes, p, way, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(found)):
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
    haste = found[:, 0].max()
    limit = 1.0 / haste if haste > 0.0 else np.inf
    return way, limit, found[:, 1].sum(), found[:, 2].sum()


@kernel()
def _move(values, change, share, moved):
    """Write the values ``share`` of a change on, (m,)."""
    for c in range(len(values)):
        moved[c] = values[c] + share * change[c]


@kernel()
def _advance(first, last, old, gaps, way, changes, share, new, state):
    normal, clearance, above, below, lower, upper = _state(old, first, last)
    new_normal, new_clearance, new_above, new_below, new_lower, new_upper = _state(
        state, first, last
    )
    d_normal, d_clearance, d_shear, d_lower, d_upper = _way(way, first, last)
    _move(normal, d_normal, share, new_normal)
    _move(clearance, d_clearance, share, new_clearance)
    _move(above, d_shear, share, new_above)
    _move(below, d_shear, -share, new_below)
    _move(lower, d_lower, share, new_lower)
    _move(upper, d_upper, share, new_upper)
    _move(gaps[0][first:last], changes[0][first:last], share, new[0][first:last])
    _move(gaps[1][first:last], changes[1][first:last], share, new[1][first:last])


@kernel(parallel=True)
def _advance_shared(
    old, gaps, way, changes, share, springs, new, state, errors, stiffnesses, totals
):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(totals)):
            first, last = bounds(part, old.shape[1])
            _advance(first, last, old, gaps, way, changes, share, new, state)
            totals[part] = _linearise(first, last, new, springs, state, errors, stiffnesses)


@kernel()
def advanced(old, gaps, way, changes, share, springs):
    """Return gaps, state, errors, stiffnesses and the sum of all products ``share`` of a way on.

    ``old`` is the state, ``gaps`` are gap and slip there, m, (m,) each; see ``centred``.
    """
    count = old.shape[1]
    new = np.empty(count), np.empty(count)
    state, errors, stiffnesses, totals = _for_contacts(count)
    if count >= MANY:
        _advance_shared(
            old, gaps, way, changes, share, springs, new, state, errors, stiffnesses, totals
        )
    else:
        for part in range(len(totals)):
            first, last = bounds(part, count)
            _advance(first, last, old, gaps, way, changes, share, new, state)
            totals[part] = _linearise(first, last, new, springs, state, errors, stiffnesses)
    return new, state, errors, stiffnesses, totals.sum()
