"""Aggregates: neighbouring blocks that move as one block, the coarse level of the solver.

A block whose centroid lies (x, y) off that of its aggregate takes part in the aggregate's
translation, rotation and strain exactly as a material point and a piece of one larger DDA block do:

    u = U - y R + x EX + y/2 G,    v = V + x R + y EY + x/2 G,    r = R,    strains = those of A

which is d_i = P_i d_A.  The coarse matrix P^T K P is that of a system of larger blocks, of the same
form as K, so that levels follow each other until few blocks are left.
"""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel

WEAK = 1e-3
"""Blocks coupled by less than this share of their own stiffness do not attract each other."""


@kernel()
def strong_pairs(diagonal, pairs, upper):
    """Return True for pairs whose coupling is not weak, shape (q,)."""
    own = np.empty(len(diagonal))
    for i in range(len(diagonal)):
        own[i] = diagonal[i, 0, 0] + diagonal[i, 1, 1]
    strong = np.empty(len(pairs), np.bool_)
    for q in range(len(pairs)):
        coupling = 0.0
        for a in range(2):
            for c in range(2):
                coupling = max(coupling, abs(upper[q, a, c]))
        strong[q] = coupling**2 > WEAK**2 * own[pairs[q, 0]] * own[pairs[q, 1]]
    return strong


@kernel()
def _neighbour(q, i, pairs):
    """Return the other block of a pair."""
    return pairs[q, 1] if pairs[q, 0] == i else pairs[q, 0]


@kernel()
def _around(i, right, left, listed, strong, of_pair):
    """Write the strong pairs of block i into ``of_pair`` and return their number."""
    found = 0
    for at in range(left[i], left[i + 1]):
        if strong[listed[at]]:
            of_pair[found] = listed[at]
            found += 1
    for q in range(right[i], right[i + 1]):
        if strong[q]:
            of_pair[found] = q
            found += 1
    return found


@kernel()
def aggregate(count, pairs, right, left, listed, strong):
    """Return the aggregate of each block (n,), -1 for those that stay alone, and their number.

    First every block all of whose neighbours are free gathers them around itself; those left join
    the aggregate of a neighbour (Vanek, Mandel and Brezina 1996).
    """
    most = 0
    for i in range(count):
        most = max(most, right[i + 1] - right[i] + left[i + 1] - left[i])
    near = np.empty(most, np.int64)
    parent = np.full(count, -2, np.int64)
    found = 0
    for i in range(count):
        number = _around(i, right, left, listed, strong, near)
        if number == 0:
            parent[i] = -1
        free = parent[i] == -2
        for k in range(number):
            free = free and parent[_neighbour(near[k], i, pairs)] < 0
        if free:
            parent[i] = found
            for k in range(number):
                parent[_neighbour(near[k], i, pairs)] = found
            found += 1
    seeded = parent.copy()
    for i in range(count):
        if parent[i] != -2:
            continue
        number = _around(i, right, left, listed, strong, near)
        for k in range(number):
            at = seeded[_neighbour(near[k], i, pairs)]
            if at >= 0:
                parent[i] = at
                break
    return parent, found


@kernel()
def members_of(parent, count):
    """Return the blocks of each aggregate: start (count + 1,) and blocks in ascending order."""
    start = np.zeros(count + 1, np.int64)
    for i in range(len(parent)):
        if parent[i] >= 0:
            start[parent[i] + 1] += 1
    for k in range(count):
        start[k + 1] += start[k]
    at = start[:-1].copy()
    members = np.empty(start[-1], np.int64)
    for i in range(len(parent)):
        if parent[i] >= 0:
            members[at[parent[i]]] = i
            at[parent[i]] += 1
    return start, members


@kernel()
def centres(start, members, centroid):
    """Return the mean centroid (count, 2) of the aggregates and the offset (n, 2) from it, m."""
    count = len(start) - 1
    centre = np.zeros((count, 2))
    offset = np.zeros_like(centroid)
    for k in range(count):
        size = start[k + 1] - start[k]
        for at in range(start[k], start[k + 1]):
            for c in range(2):
                centre[k, c] += centroid[members[at], c] / size
        for at in range(start[k], start[k + 1]):
            for c in range(2):
                offset[members[at], c] = centroid[members[at], c] - centre[k, c]
    return centre, offset


@kernel()
def coarse_pairs(pairs, right, left, listed, parent, start, members):
    """Return the coupled pairs of aggregates, lower first, sorted, shape (Q, 2)."""
    count = len(start) - 1
    seen = np.full(count, -1, np.int64)
    result = np.empty((len(pairs), 2), np.int64)
    found = 0
    for k in range(count):
        first = found
        for at in range(start[k], start[k + 1]):
            i = members[at]
            for side in range(2):
                low, high = (left[i], left[i + 1]) if side == 0 else (right[i], right[i + 1])
                for e in range(low, high):
                    q = listed[e] if side == 0 else e
                    other = parent[pairs[q, side]]
                    if other > k and seen[other] != k:
                        seen[other] = k
                        place = found
                        while place > first and result[place - 1, 1] > other:
                            result[place, 1] = result[place - 1, 1]
                            place -= 1
                        result[place, 1] = other
                        found += 1
        result[first:found, 0] = k
    return result[:found].copy()


@kernel()
def _add_projected(block, transposed, xi, yi, xj, yj, work, target):
    """Add P_i^T B P_j to ``target`` (6, 6), B being ``block`` or its transpose."""
    for a in range(6):
        for c in range(6):
            work[a, c] = block[c, a] if transposed else block[a, c]
    for a in range(6):
        b0, b1 = work[a, 0], work[a, 1]
        work[a, 2] += xj * b1 - yj * b0
        work[a, 3] += xj * b0
        work[a, 4] += yj * b1
        work[a, 5] += 0.5 * (yj * b0 + xj * b1)
    for c in range(6):
        b0, b1 = work[0, c], work[1, c]
        target[0, c] += b0
        target[1, c] += b1
        target[2, c] += work[2, c] + xi * b1 - yi * b0
        target[3, c] += work[3, c] + xi * b0
        target[4, c] += work[4, c] + yi * b1
        target[5, c] += work[5, c] + 0.5 * (yi * b0 + xi * b1)


@kernel()
def coarse_matrix(
    diagonal, upper, pairs, right, left, listed, parent, start, members, offset, coarse
):
    """Return diagonal blocks (N, 6, 6) and upper blocks (Q, 6, 6) of P^T K P.

    ``coarse`` (Q, 2) are the coupled pairs of aggregates; each aggregate sums up its own rows.
    """
    count = len(start) - 1
    own = np.zeros((count, 6, 6))
    coupling = np.zeros((len(coarse), 6, 6))
    place = np.empty(count, np.int64)
    work = np.empty((6, 6))
    at_pair = 0
    for k in range(count):
        while at_pair < len(coarse) and coarse[at_pair, 0] == k:
            place[coarse[at_pair, 1]] = at_pair
            at_pair += 1
        for at in range(start[k], start[k + 1]):
            i = members[at]
            xi, yi = offset[i, 0], offset[i, 1]
            _add_projected(diagonal[i], False, xi, yi, xi, yi, work, own[k])
            for side in range(2):
                low, high = (left[i], left[i + 1]) if side == 0 else (right[i], right[i + 1])
                for e in range(low, high):
                    q = listed[e] if side == 0 else e
                    j = pairs[q, side]
                    other = parent[j]
                    if other == k:
                        target = own[k]
                    elif other > k:
                        target = coupling[place[other]]
                    else:
                        continue
                    xj, yj = offset[j, 0], offset[j, 1]
                    _add_projected(upper[q], side == 0, xi, yi, xj, yj, work, target)
    return own, coupling


@kernel()
def restrict(start, members, offset, r, coarse):
    """Write P^T r into ``coarse`` (N, 6); each aggregate sums up its own blocks."""
    for k in range(len(coarse)):
        s0 = s1 = s2 = s3 = s4 = s5 = 0.0
        for at in range(start[k], start[k + 1]):
            i = members[at]
            x, y = offset[i, 0], offset[i, 1]
            u, v = r[i, 0], r[i, 1]
            s0 += u
            s1 += v
            s2 += r[i, 2] + x * v - y * u
            s3 += r[i, 3] + x * u
            s4 += r[i, 4] + y * v
            s5 += r[i, 5] + 0.5 * (y * u + x * v)
        coarse[k, 0], coarse[k, 1], coarse[k, 2] = s0, s1, s2
        coarse[k, 3], coarse[k, 4], coarse[k, 5] = s3, s4, s5


@kernel()
def prolong(parent, offset, coarse, x):
    """Add P ``coarse`` to x (n, 6), in place."""
    for i in range(len(x)):
        k = parent[i]
        if k < 0:
            continue
        dx, dy = offset[i, 0], offset[i, 1]
        turn, shear = coarse[k, 2], 0.5 * coarse[k, 5]
        x[i, 0] += coarse[k, 0] - dy * turn + dx * coarse[k, 3] + dy * shear
        x[i, 1] += coarse[k, 1] + dx * turn + dy * coarse[k, 4] + dx * shear
        for a in range(2, 6):
            x[i, a] += coarse[k, a]
