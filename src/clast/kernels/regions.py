"""Regions: blocks that contacts connect, and the exact line search of each region by itself.

Blocks of two regions share no contact (fixed blocks belong to none and connect nothing), so that
the potential is a sum over regions, and along a direction each has a minimum of its own.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel
from clast.kernels.region_sums import FEW, added
from clast.kernels.shares import MANY, PART, parts

NOTHING = 1e-14
"""Slope that does not count, as a share of the sum of all slopes."""


@kernel()
def _root(parent, i):
    """Return the first block of the tree that i is in, and shorten the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel()
def regions(pairs, fixed):
    """Return the region of each block, shape (n,), and their number; fixed blocks are in the last.

    ``pairs`` (q, 2) are the blocks that share contacts.  Regions are numbered by their first block.
    """
    count = len(fixed)
    parent = np.arange(count)
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        if fixed[i] or fixed[j]:
            continue
        a, b = _root(parent, i), _root(parent, j)
        if a != b:
            parent[max(a, b)] = min(a, b)
    region = np.empty(count, np.int64)
    found = 0
    for i in range(count):
        if not fixed[i]:
            first = _root(parent, i)
            if first == i:
                region[i] = found
                found += 1
            else:
                region[i] = region[first]
    for i in range(count):
        if fixed[i]:
            region[i] = found
    return region, found + 1


@kernel()
def spread(pairs, fixed):
    """Return the mean difference of the numbers of the blocks of ``pairs`` (q, 2).

    Pairs with a block that is ``fixed`` (n,) do not count; 0 where there are no others.
    """
    total, counted = 0, 0
    for q in range(len(pairs)):
        if not (fixed[pairs[q, 0]] or fixed[pairs[q, 1]]):
            total += pairs[q, 1] - pairs[q, 0]
            counted += 1
    return total / counted if counted > 0 else 0.0


@kernel()
def region_of_contacts(region, count, vertex_block, edge_block):
    """Return the region of each contact, shape (m,): of the one of its blocks that is not fixed.

    ``count`` is the number of regions; fixed blocks have the last.
    """
    result = np.empty(len(vertex_block), np.int64)
    for c in range(len(result)):
        own = region[vertex_block[c]]
        result[c] = own if own != count - 1 else region[edge_block[c]]
    return result


@kernel()
def _add_slopes(first, last, length, done, region, line, springs, work, bend):
    """Add the part of contacts ``first`` to ``last`` - 1 in the regions that are not ``done``."""
    gap, d_gap, slip, d_slip = line
    multiplier, shear_force, p, k, tension, strength = springs
    for c in range(first, last):
        r = region[c]
        if done[r]:
            continue
        at = length[r]
        normal = multiplier[c] - p * (gap[c] + at * d_gap[c])
        if normal >= -tension[c]:
            work[r] += normal * d_gap[c]
            bend[r] += p * d_gap[c] * d_gap[c]
        else:
            work[r] -= tension[c] * d_gap[c]
        bound = strength[c]
        if bound > 0.0:
            shear = shear_force[c] - k * (slip[c] + at * d_slip[c])
            if shear > bound:
                work[r] += bound * d_slip[c]
            elif shear < -bound:
                work[r] -= bound * d_slip[c]
            else:
                work[r] += shear * d_slip[c]
                bend[r] += k * d_slip[c] * d_slip[c]


@kernel(parallel=True)
def _add_slopes_shared(length, done, region, line, springs, work, bends):
    count = len(region)
    for part in prange(len(work)):
        low, high = part * PART, min((part + 1) * PART, count)
        _add_slopes(low, high, length, done, region, line, springs, work[part], bends[part])


@kernel()
def _slopes(length, done, region, line, springs):
    """Return the contacts' part of slope and bend of the regions (r,) that are not ``done``."""
    count, number = len(length), len(region)
    if number < MANY or count > FEW:
        work, bend = np.zeros(count), np.zeros(count)
        _add_slopes(0, number, length, done, region, line, springs, work, bend)
        return work, bend
    of_parts, bends = np.zeros((parts(number), count)), np.zeros((parts(number), count))
    _add_slopes_shared(length, done, region, line, springs, of_parts, bends)
    return added(of_parts), added(bends)


@kernel()
def lengths_along(region, line, springs, smooth, curvature, start, tolerance, limit):
    """Return where the potential of each region (r,) is least along a line, and evaluations.

    ``line`` are gap, its change, slip and its change (m,) of the contacts, which are in ``region``
    (m,); their forces are N = max(-tension, multiplier - p gap) and T = shear_force - k slip within
    +-strength, given by ``springs``.  ``smooth`` and ``curvature`` (r,) are the slope and the bend
    of all the rest at length 0, ``start`` (r,) is the whole slope there.  Newton's method on the
    slope, which rises and is piecewise linear, kept inside a bracket, until it has fallen to
    ``tolerance`` of its start, or to next to nothing beside those of all regions.
    """
    count = len(start)
    nothing = NOTHING * np.abs(start).sum()
    length, low, high = np.ones(count), np.zeros(count), np.full(count, np.inf)
    done = start == 0.0
    left = count - int(done.sum())
    evaluations = 0
    while left > 0 and evaluations < limit:
        evaluations += 1
        work, bend = _slopes(length, done, region, line, springs)
        for r in range(count):
            if done[r]:
                continue
            slope = smooth[r] + length[r] * curvature[r] - work[r]
            if abs(slope) <= tolerance * abs(start[r]) + nothing:
                done[r] = True
                left -= 1
                continue
            if slope < 0.0:
                low[r] = length[r]
            else:
                high[r] = length[r]
            trial = length[r] - slope / (curvature[r] + bend[r])
            if low[r] < trial < high[r]:
                length[r] = trial
            else:
                length[r] = 0.5 * (low[r] + min(high[r], 2.0 * low[r] + 1.0))
    return length, evaluations
