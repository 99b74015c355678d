"""The coarse space of the preconditioner: aggregates of blocks that move as one block.

A factor without fill settles the exchange between neighbours, and takes many iterations for
movements of many blocks at once.  That is left to aggregates of neighbouring blocks, whose system
is solved exactly, and the two are added (Nicolaides 1987; Bramble, Pasciak and Xu 1990):

    B = (L D L^T)^-1 + P (P^T K P)^-1 P^T

B is positive definite as both of its parts are, whatever has been rounded in them.

A block whose centroid lies (x, y) off that of its aggregate takes part in the aggregate's
translation, rotation and strain exactly as a material point and a piece of one larger DDA block do:

    u = U - y R + x EX + y/2 G,    v = V + x R + y EY + x/2 G,    r = R,    strains = those of A

which is d_i = P_i d_A.  The coarse matrix P^T K P is that of a system of larger blocks, of the same
form as K.  Which aggregates there are, and which of them are coupled, is known for a whole step.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, Sharing, shared
from clast.compute.vec6 import (
    line,
    plus,
    plus_scaled,
    put_line,
    put_row,
    row,
    six,
    with_number,
    zeros,
)
from clast.linear import ldlt, pattern
from clast.linear.system import BlockSystem

AGGREGATES = Sharing(part=16, many=32)
"""Loops over aggregates: as much work as one over so many times as many blocks."""
THOUSAND, TENFOLD = 6.0, 2.4
"""Of 1,000 blocks 2^THOUSAND aggregates are made, of ten times as many 2^TENFOLD times as many:
more would need fewer iterations, and cost more to factorise than those."""


@kernel()
def _select(order, place, low, middle, high):
    """Sort order[low:high] so far that all before ``middle`` have no larger ``place``, in place.

    Hoare's selection: equal values may be on either side.
    """
    first, last = low, high - 1
    while first < last:
        pivot = place[order[middle]]
        i, j = first, last
        while i <= j:
            while place[order[i]] < pivot:
                i += 1
            while pivot < place[order[j]]:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i, j = i + 1, j - 1
        if j < middle:
            first = i
        if middle < i:
            last = j


@kernel()
def _longer_side(order, centroid, low, high):
    """Return 0 or 1: along x or y the blocks order[low:high] reach farther."""
    reach = np.zeros(2)
    for k in range(2):
        least = most = centroid[order[low], k]
        for at in range(low, high):
            least, most = min(least, centroid[order[at], k]), max(most, centroid[order[at], k])
        reach[k] = most - least
    return 0 if reach[0] >= reach[1] else 1


@kernel()
def bisected(centroid, number):
    """Return the aggregate (n,) of each block: 0 to ``number`` - 1, which is a power of two.

    Blocks are halved across the longer side of their common box, and halved again; ``centroid`` (n,
    2), m, says where they are.  There are at least as many blocks as aggregates.
    """
    count = len(centroid)
    along = centroid[:, 0].copy(), centroid[:, 1].copy()
    order = np.arange(count)
    parts = 1
    while parts < number:
        for k in range(parts):
            low, high = k * count // parts, (k + 1) * count // parts
            middle = (2 * k + 1) * count // (2 * parts)
            _select(order, along[_longer_side(order, centroid, low, high)], low, middle, high)
        parts *= 2
    aggregate = np.empty(count, np.int64)
    for k in range(number):
        for at in range(k * count // number, (k + 1) * count // number):
            aggregate[order[at]] = k
    return aggregate


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
def coarse_pairs(pairs, rows, parent, start, members):
    """Return the coupled pairs of aggregates, lower first, sorted, shape (Q, 2)."""
    right, left, listed = rows
    count = len(start) - 1
    seen = np.full(count, -1, np.int64)
    result = np.empty((len(pairs), 2), np.int64)
    filled = 0
    for k in range(count):
        first = filled
        for at in range(start[k], start[k + 1]):
            i = members[at]
            for side in range(2):
                low, high = (left[i], left[i + 1]) if side == 0 else (right[i], right[i + 1])
                for e in range(low, high):
                    q = listed[e] if side == 0 else e
                    other = parent[pairs[q, side]]
                    if other > k and seen[other] != k:
                        seen[other] = k
                        place = filled
                        while place > first and result[place - 1, 1] > other:
                            result[place, 1] = result[place - 1, 1]
                            place -= 1
                        result[place, 1] = other
                        filled += 1
        result[first:filled, 0] = k
    return result[:filled].copy()


@kernel(forceinline=True)
def _add_right(blocks, q, share, x, y, product):
    """Add share x B P to ``product`` (1, 6, 6), B being block q of ``blocks``.

    P is one but for two lines, (0, 0, -y, x, 0, y/2) and (0, 0, x, 0, y, x/2), which say how much
    of the aggregate's rotation and strains is translation of the block.
    """
    u, v = six(0.0, 0.0, -y, x, 0.0, 0.5 * y), six(0.0, 0.0, x, 0.0, y, 0.5 * x)
    for a in range(6):
        b = plus_scaled(plus_scaled(line(blocks, q, a), blocks[q, a, 0], u), blocks[q, a, 1], v)
        put_line(product, 0, a, plus_scaled(line(product, 0, a), share, b))


@kernel(forceinline=True)
def _add_left(product, x, y, target, t):
    """Add P^T ``product`` to block t of ``target``."""
    for a in range(6):
        put_line(target, t, a, plus(line(target, t, a), line(product, 0, a)))
    b, c = line(product, 0, 0), line(product, 0, 1)
    put_line(target, t, 2, plus_scaled(plus_scaled(line(target, t, 2), -y, b), x, c))
    put_line(target, t, 3, plus_scaled(line(target, t, 3), x, b))
    put_line(target, t, 4, plus_scaled(line(target, t, 4), y, c))
    put_line(target, t, 5, plus_scaled(plus_scaled(line(target, t, 5), 0.5 * y, b), 0.5 * x, c))


@kernel(forceinline=True)
def _turn_over(blocks, q, turned):
    """Write the transpose of block q of ``blocks`` into ``turned`` (1, 6, 6)."""
    for a in range(6):
        for c in range(6):
            turned[0, a, c] = blocks[q, c, a]


@kernel(forceinline=True)
def _add_coupling(blocks, q, offset, i, j, product, coupling, t):
    """Add P_i^T B P_j to block t of ``coupling``, B being block q of ``blocks``."""
    product[0] = 0.0
    _add_right(blocks, q, 1.0, offset[j, 0], offset[j, 1], product)
    _add_left(product, offset[i, 0], offset[i, 1], coupling, t)


@kernel()
def _add_both(half, target, t):
    """Add the block ``half`` (1, 6, 6) and its transpose to block t of ``target``."""
    for a in range(6):
        for c in range(6):
            target[t, a, c] += half[0, a, c] + half[0, c, a]


@kernel()
def _first_of(k, coarse):
    """Return the first of the sorted pairs ``coarse`` (Q, 2) that begins with k or more."""
    low, high = 0, len(coarse)
    while low < high:
        middle = (low + high) // 2
        if coarse[middle, 0] < k:
            low = middle + 1
        else:
            high = middle
    return low


@kernel()
def _find_pair(t, other, coarse):
    """Return the pair of ``coarse`` (Q, 2) from t on that ends with ``other``."""
    while coarse[t, 1] != other:
        t += 1
    return t


@shared(AGGREGATES)
def _coarse_rows(first, last, matrix, fine, aggregates, coarse, own, coupling):
    """Write the rows of aggregates ``first`` to ``last`` - 1 of P^T K P.

    Pairs within an aggregate are taken once, and half of the diagonal blocks: the other side adds
    the transpose.
    """
    diagonal, upper = matrix
    _, _, pairs, right, left, listed, _ = fine
    parent, start, members, offset = aggregates
    half, turned = np.empty((1, 6, 6)), np.empty((1, 6, 6))
    within, across = np.empty((1, 6, 6)), np.empty((1, 6, 6))
    behind = _first_of(first, coarse)
    for k in range(first, last):
        own[k], half[0] = 0.0, 0.0
        begin = behind
        while behind < len(coarse) and coarse[behind, 0] == k:
            coupling[behind] = 0.0
            behind += 1
        for at in range(start[k], start[k + 1]):
            i = members[at]
            within[0] = 0.0
            _add_right(diagonal, i, 0.5, offset[i, 0], offset[i, 1], within)
            for q in range(right[i], right[i + 1]):
                j = pairs[q, 1]
                if parent[j] == k:
                    _add_right(upper, q, 1.0, offset[j, 0], offset[j, 1], within)
                elif parent[j] > k:
                    t = _find_pair(begin, parent[j], coarse)
                    _add_coupling(upper, q, offset, i, j, across, coupling, t)
            for e in range(left[i], left[i + 1]):
                j = pairs[listed[e], 0]
                if parent[j] > k:
                    _turn_over(upper, listed[e], turned)
                    t = _find_pair(begin, parent[j], coarse)
                    _add_coupling(turned, 0, offset, i, j, across, coupling, t)
            _add_left(within, offset[i, 0], offset[i, 1], half, 0)
        _add_both(half, own, k)


@shared(AGGREGATES)
def restrict(first, last, start, members, offset, r, coarse):
    """Write P^T r into ``coarse``; each aggregate sums up its own blocks."""
    for k in range(first, last):
        s = zeros()
        for at in range(start[k], start[k + 1]):
            i = members[at]
            x, y = offset[i, 0], offset[i, 1]
            u, v = r[i, 0], r[i, 1]
            moved = six(0.0, 0.0, x * v - y * u, x * u, y * v, 0.5 * (y * u + x * v))
            s = plus(s, plus(row(r, i), moved))
        put_row(coarse, k, s)


@shared(BLOCKS)
def turn_with(first, last, parent, offset, coarse, z, beta, p):
    """Turn the direction, in place: p = z + P ``coarse`` + beta p."""
    for i in range(first, last):
        turned = plus_scaled(row(z, i), beta, row(p, i))
        k = parent[i]
        if k >= 0:
            dx, dy = offset[i, 0], offset[i, 1]
            turn, shear = coarse[k, 2], 0.5 * coarse[k, 5]
            u = -dy * turn + dx * coarse[k, 3] + dy * shear
            v = dx * turn + dy * coarse[k, 4] + dx * shear
            moved = plus(row(coarse, k), six(u, v, 0.0, 0.0, 0.0, 0.0))
            turned = plus(turned, moved)
        put_row(p, i, turned)


@kernel()
def _arranged(centroid, aggregate, number, pairs, rows):
    """Return the aggregates in the order of their elimination, and their pattern.

    ``aggregate`` (n,) is that of each block, 0 to ``number`` - 1; ``pairs`` (q, 2) are all that may
    be coupled and ``rows`` their right, left and listed.  Returned are the place of each block's
    aggregate (n,), its centroid's offset (n, 2) from the aggregate's, m, and the pattern of the
    aggregates' factor, with all fill, in the order in which they stand.
    """
    start, members = members_of(aggregate, number)
    _, offset = centres(start, members, centroid)
    coupled = coarse_pairs(pairs, rows, aggregate, start, members)
    order, begin, coupled_pairs, right, left, listed, _ = pattern.with_fill(
        number, coupled, np.ones(len(coupled), np.bool_)
    )
    as_they_are = (
        np.arange(number),
        begin,
        coupled_pairs,
        right,
        left,
        listed,
        np.arange(len(coupled_pairs)),
    )
    return pattern.inverse_of(order)[aggregate], offset, as_they_are


@kernel()
def _placed(fine, aggregate, offset, number):
    """Return aggregate (n,), first member (number + 1,), members and offset in another order.

    Blocks without pairs have no aggregate: -1.
    """
    order, _, _, right, left, _, _ = fine
    parent, moved = np.empty(len(order), np.int64), np.empty_like(offset)
    for k in range(len(order)):
        alone = right[k] == right[k + 1] and left[k] == left[k + 1]
        parent[k] = -1 if alone else aggregate[order[k]]
        moved[k, 0], moved[k, 1] = offset[order[k], 0], offset[order[k], 1]
    start, members = members_of(parent, number)
    return parent, start, members, moved


@kernel()
def factor(fine, matrix, aggregates):
    """Return the coarse system made ready, and whether it is positive definite.

    ``fine`` is the pattern of a factor without fill and ``matrix`` K in its order (linear/ldlt.py);
    ``aggregates`` is the result of ``aggregates_of``.  Made ready, it is (aggregate, start,
    members, offset, factor), the first four in the order of the pattern, the last one in single
    precision.
    """
    aggregate, offset, coarse = aggregates
    number, pairs = len(coarse[0]), coarse[2]
    parts = _placed(fine, aggregate, offset, number)
    own, coupling = np.empty((number, 6, 6)), np.empty((len(pairs), 6, 6))
    _coarse_rows(number, matrix, fine, parts, pairs, own, coupling)
    start = parts[1]
    for k in range(number):
        if start[k] == start[k + 1]:
            for a in range(6):
                put_line(own, k, a, with_number(zeros(), a, 1.0))
    (_, roots, rest), bad = ldlt.exact(coarse, own, coupling)
    return (*parts, ldlt.finished(coarse, (roots, rest))), bad < 0


def number_of_aggregates(blocks: int) -> int:
    """Return how many aggregates so many blocks are parted into, a power of two."""
    wanted = round(THOUSAND + TENFOLD * math.log10(max(blocks, 1) / 1000.0))
    return int(2 ** min(max(0, wanted), math.floor(math.log2(max(blocks, 1)))))


def aggregates_of(system: BlockSystem) -> tuple[Any, ...]:
    """Return the aggregates of neighbouring blocks, whatever their contacts carry.

    That of each block (n,), the blocks' offsets (n, 2), m, and the pattern of their factor.
    """
    number = number_of_aggregates(len(system.centroid))
    of_blocks = bisected(system.centroid, number)
    aggregates: tuple[Any, ...] = _arranged(
        system.centroid, of_blocks, number, system.pairs, system.rows
    )
    return aggregates


def no_aggregates() -> tuple[Any, ...]:
    """Return the argument of linear/pcg.py for no coarse system."""
    none, start = np.zeros(0, np.int64), np.zeros(1, np.int64)
    short, pairs = np.zeros(1, np.int32), np.zeros((0, 2), np.int32)
    nothing = none, np.zeros(3, np.int64), pairs, short, short, np.zeros(0, np.int32), none
    blocks = np.zeros((0, 6, 6), np.float32)
    return none, start, none, np.zeros((0, 2)), (nothing, blocks, blocks)
