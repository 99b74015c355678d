"""The exact line search of each region by itself, for springs with bounds, and where it leads.

The potential is a sum over regions (connected.py), and along a direction each has a minimum
of its own: the root of a slope that rises and is piecewise linear.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, PART, bounds, in_part, only_region, parts, sum_of
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do

TOLERANCE = 1e-9
"""The line's minimum is found where the slope has fallen to this share of its start."""
LIMIT = 40
"""Evaluations along a line at most."""
NOTHING = 1e-14
"""Slope that does not count, as a share of the sum of all slopes."""


@kernel(forceinline=True)
def _normal(gap, multiplier, p, tension):
    """Return the normal force and its stiffness."""
    force = multiplier - p * gap
    bears = force >= -tension
    return force if bears else -tension, p if bears else 0.0


@kernel(forceinline=True)
def _shear(slip, shear_force, k, bound):
    """Return the shear force and its stiffness."""
    force = shear_force - k * slip
    within = min(max(force, -bound), bound)
    return within, k if (force == within) & (bound > 0.0) else 0.0


@kernel()
def _only_regions(region):
    """Return the region that all contacts of each part are in, or -1."""
    only = np.empty(parts(len(region)), np.int64)
    for part in range(len(only)):
        first, last = bounds(part, len(region))
        only[part] = only_region(region[first:last])
    return only


@kernel()
def _lengths(length, region, only):
    """Return the length of each contact's region (m,), which is ``only`` that or -1."""
    at = np.empty(len(region))
    if only >= 0:
        at[:] = length[only]
    else:
        for c in range(len(region)):
            at[c] = length[region[c]]
    return at


@kernel()
def _work(first, last, at, line, springs, works, bends):
    """Write what the forces of each contact do along the line, and how that bends."""
    multiplier, shear_force, p, k, tension, strength = springs
    gap, d_gap = in_part((line[0], line[1]), first, last)
    slip, d_slip = in_part((line[2], line[3]), first, last)
    multiplier, shear_force = in_part((multiplier, shear_force), first, last)
    tension, strength = in_part((tension, strength), first, last)
    for c in range(len(gap)):
        opening, sliding = d_gap[c], d_slip[c]
        n, kn = _normal(gap[c] + at[c] * opening, multiplier[c], p, tension[c])
        t, ks = _shear(slip[c] + at[c] * sliding, shear_force[c], k, strength[c])
        works[c] = n * opening + t * sliding
        bends[c] = kn * opening * opening + ks * sliding * sliding


@kernel()
def _add_up(region, done, works, bends, of_run):
    """Add up the terms of contacts (m,) that follow each other in a region, in their place.

    Return how many such runs there are; regions that are done have none.
    """
    c, runs = 0, 0
    while c < len(region):
        r, here, how = region[c], 0.0, 0.0
        while c < len(region) and region[c] == r:
            here += works[c]
            how += bends[c]
            c += 1
        if not done[r]:
            works[runs], bends[runs], of_run[runs] = here, how, r
            runs += 1
    return runs


@kernel()
def _work_of_part(part, length, done, only, region, line, springs, terms, of_run, runs):
    """Write the sums of the terms of a part's contacts, run by run."""
    first, last = bounds(part, len(region))
    works, bends = in_part((terms[0], terms[1]), first, last)
    r, runs[part] = only[part], 0
    if r < 0 or not done[r]:
        at = _lengths(length, region[first:last], r)
        _work(first, last, at, line, springs, works, bends)
        if r >= 0:
            works[0], bends[0], of_run[first], runs[part] = sum_of(works), sum_of(bends), r, 1
        else:
            runs[part] = _add_up(region[first:last], done, works, bends, of_run[first:last])


@kernel(parallel=True)
def _work_of_parts(length, done, only, region, line, springs, terms, of_run, runs):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(only)):
            _work_of_part(part, length, done, only, region, line, springs, terms, of_run, runs)


@kernel()
def _works_along(length, done, only, region, line, springs, room):
    """Return the work of all contacts in each region (r,) along the line, and how it bends."""
    terms, of_run, runs = room
    if len(region) >= MANY:
        _work_of_parts(length, done, only, region, line, springs, terms, of_run, runs)
    else:
        for part in range(len(only)):
            _work_of_part(part, length, done, only, region, line, springs, terms, of_run, runs)
    work, bend = np.zeros(len(length)), np.zeros(len(length))
    for part in range(len(only)):
        for at in range(part * PART, part * PART + runs[part]):
            work[of_run[at]] += terms[0, at]
            bend[of_run[at]] += terms[1, at]
    return work, bend


@kernel()
def _narrow(search, slope, bend, enough):
    """Judge the regions by their slopes (r,), and choose the next lengths; return how many go on.

    Newton's method, kept inside the bracket.
    """
    length, low, high, done = search
    left = 0
    for r in range(len(length)):
        if done[r]:
            continue
        if abs(slope[r]) <= enough[r]:
            done[r] = True
            continue
        left += 1
        if slope[r] < 0.0:
            low[r] = length[r]
        else:
            high[r] = length[r]
        trial = length[r] - slope[r] / bend[r]
        if low[r] < trial < high[r]:
            length[r] = trial
        else:
            length[r] = 0.5 * (low[r] + min(high[r], 2.0 * low[r] + 1.0))
    return left


@kernel()
def lengths_along(region, line, springs, smooth, curvature, start):
    """Return where the potential of each region (r,) is least along a line, and evaluations.

    ``line`` are gap, its change, slip and its change (m,) of the contacts, which are in ``region``
    (m,); their forces are N = max(-tension, multiplier - p gap) and T = shear_force - k slip within
    +-strength, given by ``springs``.  ``smooth`` and ``curvature`` (r,) are the slope and the bend
    of all the rest at length 0, ``start`` (r,) is the whole slope there.  Newton's method on the
    slope, kept inside a bracket, until it has fallen to TOLERANCE of its start, or to next to
    nothing beside those of all regions.
    """
    count = len(start)
    only = _only_regions(region)
    room = np.empty((2, len(region))), np.empty(len(region), np.int64), np.empty_like(only)
    enough = TOLERANCE * np.abs(start) + NOTHING * np.abs(start).sum()
    done = start == 0.0
    length = np.ones(count)
    search = length, np.zeros(count), np.full(count, np.inf), done
    left, evaluations = count - int(done.sum()), 0
    while left > 0 and evaluations < LIMIT:
        evaluations += 1
        work, bend = _works_along(length, done, only, region, line, springs, room)
        left = _narrow(search, smooth + length * curvature - work, curvature + bend, enough)
    return length, evaluations


@kernel()
def _answer_normal(at, gap, d_gap, springs, found):
    multiplier, tension, p = springs
    new_gap, force, stiffness = found
    for c in range(len(at)):
        new_gap[c] = gap[c] + at[c] * d_gap[c]
        force[c], stiffness[c] = _normal(new_gap[c], multiplier[c], p, tension[c])


@kernel()
def _answer_shear(at, slip, d_slip, springs, found):
    shear_force, strength, k = springs
    new_slip, force, stiffness = found
    for c in range(len(at)):
        new_slip[c] = slip[c] + at[c] * d_slip[c]
        force[c], stiffness[c] = _shear(new_slip[c], shear_force[c], k, strength[c])


@kernel()
def _answer(first, last, region, length, line, springs, found):
    """Write what contacts ``first`` to ``last`` - 1 have come to and how they answer."""
    at = _lengths(length, region[first:last], -1)
    multiplier, shear_force, p, k, tension, strength = springs
    gap, slip, normal, shear, kn, ks = found
    of_normal = *in_part((multiplier, tension), first, last), p
    of_shear = *in_part((shear_force, strength), first, last), k
    normal_found = gap[first:last], normal[first:last], kn[first:last]
    shear_found = slip[first:last], shear[first:last], ks[first:last]
    _answer_normal(at, line[0][first:last], line[1][first:last], of_normal, normal_found)
    _answer_shear(at, line[2][first:last], line[3][first:last], of_shear, shear_found)


@kernel(parallel=True)
def _answer_parts(region, length, line, springs, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(region))):
            first, last = bounds(part, len(region))
            _answer(first, last, region, length, line, springs, found)


@kernel()
def answers(region, length, line, springs):
    """Return gap, slip, N, T and their stiffnesses (m,) at the lengths (r,) of the regions."""
    count = len(region)
    found = (
        np.empty(count),
        np.empty(count),
        np.empty(count),
        np.empty(count),
        np.empty(count),
        np.empty(count),
    )
    if count >= MANY:
        _answer_parts(region, length, line, springs, found)
    else:
        _answer(0, count, region, length, line, springs, found)
    return found
