"""The exact line search of each region by itself, for springs with bounds, and where it leads.

The potential is a sum over regions (kernels/regions.py), and along a direction each has a minimum
of its own: the root of a slope that rises and is piecewise linear.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel
from clast.kernels.region_sums import FEW, added
from clast.kernels.shares import PART, parts

NOTHING = 1e-14
"""Slope that does not count, as a share of the sum of all slopes."""


@kernel(forceinline=True)
def _normal(c, at, line, springs):
    """Return the normal force at length ``at`` and its stiffness."""
    gap, d_gap, _, _ = line
    multiplier, _, p, _, tension, _ = springs
    force = multiplier[c] - p * (gap[c] + at * d_gap[c])
    bears = force >= -tension[c]
    return force if bears else -tension[c], p if bears else 0.0


@kernel(forceinline=True)
def _shear(c, at, line, springs):
    """Return the shear force at length ``at`` and its stiffness."""
    _, _, slip, d_slip = line
    _, shear_force, _, k, _, strength = springs
    bound = strength[c]
    force = shear_force[c] - k * (slip[c] + at * d_slip[c])
    within = min(max(force, -bound), bound)
    sticks = (force == within) & (bound > 0.0)
    return within, k if sticks else 0.0


@kernel()
def _add(first, last, length, done, region, line, springs, work, bend):
    """Add contacts ``first`` to ``last`` - 1 to work and bend of the regions not ``done``.

    Contacts of one region mostly follow each other: their sums stay in registers.
    """
    c = first
    while c < last:
        r = region[c]
        at, here, how = length[r], 0.0, 0.0
        if done[r]:
            while c < last and region[c] == r:
                c += 1
            continue
        while c < last and region[c] == r:
            opening, slip = line[1][c], line[3][c]
            normal, kn = _normal(c, at, line, springs)
            shear, ks = _shear(c, at, line, springs)
            here += normal * opening + shear * slip
            how += kn * opening * opening + ks * slip * slip
            c += 1
        work[r] += here
        bend[r] += how


@kernel(parallel=True)
def _add_parts(size, length, done, region, line, springs, works, bends):
    for part in prange(len(works)):
        low, high = part * size, min((part + 1) * size, len(region))
        _add(low, high, length, done, region, line, springs, works[part], bends[part])


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
def lengths_along(region, line, springs, smooth, curvature, start, tolerance, limit):
    """Return where the potential of each region (r,) is least along a line, and evaluations.

    ``line`` are gap, its change, slip and its change (m,) of the contacts, which are in ``region``
    (m,); their forces are N = max(-tension, multiplier - p gap) and T = shear_force - k slip within
    +-strength, given by ``springs``.  ``smooth`` and ``curvature`` (r,) are the slope and the bend
    of all the rest at length 0, ``start`` (r,) is the whole slope there.  Newton's method on the
    slope, kept inside a bracket, until it has fallen to ``tolerance`` of its start, or to next to
    nothing beside those of all regions.
    """
    count, number = len(start), len(region)
    size = PART if count <= FEW else max(number, 1)
    pieces = (number + size - 1) // size
    enough = tolerance * np.abs(start) + NOTHING * np.abs(start).sum()
    done = start == 0.0
    length = np.ones(count)
    search = length, np.zeros(count), np.full(count, np.inf), done
    works, bends = np.empty((pieces, count)), np.empty((pieces, count))
    left, evaluations = count - int(done.sum()), 0
    while left > 0 and evaluations < limit:
        evaluations += 1
        works[:] = 0.0
        bends[:] = 0.0
        _add_parts(size, length, done, region, line, springs, works, bends)
        slope = smooth + length * curvature - added(works)
        left = _narrow(search, slope, curvature + added(bends), enough)
    return length, evaluations


@kernel()
def _answer(first, last, region, length, line, springs, found):
    """Write what contacts ``first`` to ``last`` - 1 have come to and how they answer.

    Those of a region mostly follow each other: nothing then has to be fetched contact by contact.
    """
    gap, d_gap, slip, d_slip = line
    low = first
    while low < last:
        high = low + 1
        while high < last and region[high] == region[low]:
            high += 1
        at = length[region[low]]
        for c in range(low, high):
            found[0][c] = gap[c] + at * d_gap[c]
            found[1][c] = slip[c] + at * d_slip[c]
            found[2][c], found[4][c] = _normal(c, at, line, springs)
            found[3][c], found[5][c] = _shear(c, at, line, springs)
        low = high


@kernel(parallel=True)
def _answer_parts(region, length, line, springs, found):
    for part in prange(parts(len(region))):
        last = min((part + 1) * PART, len(region))
        _answer(part * PART, last, region, length, line, springs, found)


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
    _answer_parts(region, length, line, springs, found)
    return found
