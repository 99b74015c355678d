"""Block LDL^T factorisation, K = L D L^T, of a symmetric matrix of 6 x 6 blocks.

One elimination for three patterns (linear/pattern.py): with all fill it is exact, without any it is
a preconditioner, and the coarse system of aggregates (linear/coarse_space.py) is exact again.

Without fill, entries that would fall on a pair of blocks that share no contact are left out
(Meijerink and van der Vorst 1977).  For want of that a pivot may be next to singular, and a few of
those among 100,000 have cost hundreds of iterations: the eliminated matrix is K with slightly
larger blocks on its diagonal (Manteuffel 1980).  Where a pivot still is not positive definite the
diagonal block of K takes its place, so that the product is positive definite in any case.

Pivots are D_i = C_i C_i^T, and rows are eliminated by W_ij = C_i^-1 K_ij: K_jk -= W_ij^T W_ik.  An
inverse of D_i in between would cost digits where springs are far stiffer than the rock.  An exact
factor is (pattern, C, W); an iteration, which has no digits to lose and reads it over and over, has
(pattern, D^-1, L^T), one product a block and in single precision.  C, W, D^-1 (n, 6, 6) and L^T
above its diagonal (p, 6, 6) are in the order of the pattern.  Strips are eliminated at the same
time, and then the segments of the seam.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import (
    backward,
    forward,
    lines,
    lines_times,
    minus_column,
    plus_lines,
    put_lines,
    unit_lines,
)
from clast.compute.parallel import BLOCKS, EACH, borrowed, shared
from clast.compute.vec6 import UNKNOWNS, line, plus_scaled, put_line, put_row, row, zeros
from clast.linear.block_matrix import transpose_times
from clast.linear.pattern import FILL


@kernel()
def _root(blocks, i):
    """Write C of block i = C C^T, its diagonal inverted; return whether the block is definite.

    The part above the diagonal has no meaning afterwards.
    """
    for a in range(UNKNOWNS):
        pivot = blocks[i, a, a]
        for b in range(a):
            pivot -= blocks[i, a, b] * blocks[i, a, b]
        if not pivot > 0.0:
            return False
        inverse = 1.0 / np.sqrt(pivot)
        blocks[i, a, a] = inverse
        for c in range(a + 1, UNKNOWNS):
            below = blocks[i, c, a]
            for b in range(a):
                below -= blocks[i, c, b] * blocks[i, a, b]
            blocks[i, c, a] = below * inverse
    return True


@kernel(forceinline=True)
def _subtract_product(blocks, q, f, target, t):
    """Subtract the product of the transpose of block q and block f from block t of ``target``."""
    other = lines(blocks, f)
    for a in range(UNKNOWNS):
        rest = plus_lines(line(target, t, a), minus_column(blocks, q, a), other)
        put_line(target, t, a, rest)


@kernel(forceinline=True)
def _pass_on(i, low, high, pattern, work):
    """Subtract row i from the rows ``low`` to ``high`` - 1:  K_jk -= W_ij^T W_ik.

    Places that the pattern lacks are left out.
    """
    _, _, pairs, right, _, _, _ = pattern
    diagonal, upper = work
    for q in range(right[i], right[i + 1]):
        j = pairs[q, 1]
        if j < low:
            continue
        if j >= high:
            break
        _subtract_product(upper, q, q, diagonal, j)
        at = right[j]
        for following in range(q + 1, right[i + 1]):
            k = pairs[following, 1]
            while at < right[j + 1] and pairs[at, 1] < k:
                at += 1
            if at < right[j + 1] and pairs[at, 1] == k:
                _subtract_product(upper, q, following, upper, at)


@kernel()
def _eliminate(low, high, pattern, own, work):
    """Eliminate rows ``low`` to ``high`` - 1 in place; return the first without a pivot, or -1.

    ``work`` are the diagonal blocks and those of the pairs: they become C_i, where the pivots are
    D_i = C_i C_i^T, and W_ij = C_i^-1 K_ij.  The blocks ``own`` of K take the place of pivots that
    are not positive definite; where there are none, (0, 6, 6), none does.
    """
    pattern, work = borrowed(pattern), borrowed(work)
    order, _, _, right, _, _, _ = pattern
    diagonal, upper = work
    for i in range(low, high):
        if not _root(diagonal, i):
            if len(own) == 0:
                return order[i]
            for a in range(UNKNOWNS):
                put_line(diagonal, i, a, line(own, order[i], a))
            if not _root(diagonal, i):
                return order[i]
        for q in range(right[i], right[i + 1]):
            put_lines(upper, q, forward(diagonal, i, lines(upper, q)))
        _pass_on(i, low, high, pattern, work)
    return -1


@shared(BLOCKS)
def _finish(first, last, pattern, work, inverse, scaled):
    """Write D_i^-1 = C_i^-T C_i^-1 and L_ji^T = D_i^-1 K_ij = C_i^-T W_ij."""
    right = pattern[3]
    diagonal, upper = work
    for i in range(first, last):
        put_lines(inverse, i, backward(diagonal, i, forward(diagonal, i, unit_lines())))
        for q in range(right[i], right[i + 1]):
            put_lines(scaled, q, backward(diagonal, i, lines(upper, q)))


@kernel()
def finished(pattern, work):
    """Return eliminated blocks in the form for an iteration: (pattern, D^-1, L^T), in single."""
    diagonal, upper = work
    inverse, scaled = np.empty(diagonal.shape, np.float32), np.empty(upper.shape, np.float32)
    _finish(len(diagonal), pattern, work, inverse, scaled)
    return pattern, inverse, scaled


@kernel()
def _take(low, high, pattern, own, given, larger, work):
    """Write the rows ``low`` to ``high`` - 1 of K in the order of the pattern, to be eliminated.

    ``own`` are the diagonal blocks of K, taken ``larger`` times, and ``given`` those of its pairs.
    """
    order, _, _, right, _, _, source = pattern
    diagonal, upper = work
    for i in range(low, high):
        for a in range(UNKNOWNS):
            put_line(diagonal, i, a, plus_scaled(zeros(), larger, line(own, order[i], a)))
        for q in range(right[i], right[i + 1]):
            s = source[q]
            if s >= 0:
                for a in range(UNKNOWNS):
                    put_line(upper, q, a, line(given, s, a))
            elif s == FILL:
                for a in range(UNKNOWNS):
                    put_line(upper, q, a, zeros())
            else:
                for a in range(UNKNOWNS):
                    for c in range(UNKNOWNS):
                        upper[q, c, a] = given[-1 - s, a, c]


# With all fill -----------------------------------------------------------------------------------


@kernel()
def exact(pattern, own, given):
    """Return the factor of K, and the first block without a positive definite pivot, or -1.

    ``pattern`` has all fill; ``own`` (n, 6, 6) are the diagonal blocks of K and ``given``
    (q, 6, 6) those of its pairs.
    """
    work = np.empty_like(own), np.empty((len(pattern[2]), 6, 6))
    _take(0, len(own), pattern, own, given, 1.0, work)
    bad = _eliminate(0, len(own), pattern, own[:0], work)
    return (pattern, *work), bad


@kernel()
def solve(factor, force):
    """Return d (n, 6) of K d = F by an exact factor: C z = F - W^T z, then C^T d = z - W d."""
    (order, _, pairs, right, _, _, _), c, upper = factor
    z, displacement = np.empty_like(force), np.empty_like(force)
    for i in range(len(order)):
        put_row(z, i, row(force, order[i]))
    for i in range(len(order)):
        for a in range(UNKNOWNS):
            for b in range(a):
                z[i, a] -= c[i, a, b] * z[i, b]
            z[i, a] *= c[i, a, a]
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            put_row(z, j, plus_scaled(row(z, j), -1.0, transpose_times(upper, q, z, i)))
    for i in range(len(order) - 1, -1, -1):
        s = row(z, i)
        for q in range(right[i], right[i + 1]):
            s = plus_scaled(s, -1.0, lines_times(lines(upper, q), row(z, pairs[q, 1])))
        put_row(z, i, s)
        for a in range(UNKNOWNS - 1, -1, -1):
            for b in range(a + 1, UNKNOWNS):
                z[i, a] -= c[i, b, a] * z[i, b]
            z[i, a] *= c[i, a, a]
        put_row(displacement, order[i], row(z, i))
    return displacement


# Without fill ------------------------------------------------------------------------------------


@kernel()
def _leaders(low, high, seam, pattern, leaders):
    """Write the rows from ``low`` to ``high`` - 1 that are coupled to the seam; return how many."""
    _, _, pairs, right, _, _, _ = pattern
    number = 0
    for i in range(low, high):
        if right[i + 1] > right[i] and pairs[right[i + 1] - 1, 1] >= seam:
            leaders[low + number] = i
            number += 1
    return number


@kernel()
def _begin(low, high, pattern, matrix, work, kept):
    """Write rows of K to be eliminated, and as they are into those ``kept``."""
    own, given, larger = matrix
    order, _, _, right, _, _, _ = pattern
    _take(low, high, pattern, own, given, larger, work)
    for i in range(low, high):
        for a in range(UNKNOWNS):
            put_line(kept[0], i, a, line(own, order[i], a))
    for q in range(right[low], right[high]):
        for a in range(UNKNOWNS):
            put_line(kept[1], q, a, line(work[1], q, a))


@shared(EACH)
def _eliminate_strips(first, last, pattern, matrix, work, kept, leading):
    """Copy and eliminate strips; write which rows lead to the seam, and which are singular."""
    begin = pattern[1]
    leaders, number, bad = leading
    for c in range(first, last):
        low, high = begin[c], begin[c + 1]
        _begin(low, high, pattern, matrix, work, kept)
        bad[c] = _eliminate(low, high, pattern, matrix[0], work)
        number[c] = _leaders(low, high, begin[len(bad)], pattern, leaders)


@shared(EACH)
def _begin_segments(first, last, pattern, matrix, work, kept, leading):
    """Copy segments of the seam and subtract the contributions of the strips, in their order.

    A strip may be coupled to any segment, and a row to several.
    """
    begin = pattern[1]
    leaders, number, _ = leading
    strips = len(number)
    for segment in range(strips + first, strips + last):
        low, high = begin[segment], begin[segment + 1]
        _begin(low, high, pattern, matrix, work, kept)
        for c in range(strips):
            for at in range(begin[c], begin[c] + number[c]):
                _pass_on(leaders[at], low, high, pattern, work)


@shared(EACH)
def _eliminate_segments(first, last, pattern, own, work, bad):
    """Eliminate segments of the seam, of which none is coupled to another one."""
    begin, strips = pattern[1], len(bad)
    for c in range(first, last):
        low, high = begin[strips + c], begin[strips + c + 1]
        bad[c] = _eliminate(low, high, pattern, own, work)


@kernel()
def is_parted(pattern):
    """Return whether no segment of the seam is coupled to another one."""
    _, begin, pairs, right, _, _, _ = pattern
    strips = len(begin) // 2
    for c in range(strips, 2 * strips):
        for i in range(begin[c], begin[c + 1]):
            if right[i + 1] > right[i] and pairs[right[i + 1] - 1, 1] >= begin[c + 1]:
                return False
    return True


@kernel()
def incomplete(pattern, own, given, shift):
    """Return the factor of K without fill, K in its order, and the first block without a pivot.

    That is -1 where all have one.  ``pattern`` has no fill, ``own`` (n, 6, 6) are the diagonal
    blocks of K and ``given`` (q, 6, 6) those of its pairs; the eliminated matrix has diagonal
    blocks larger by the share ``shift``.  The factor is (pattern, D^-1, L^T); it and K, its
    diagonal blocks (n, 6, 6) and those of the pattern's pairs (p, 6, 6), are in single precision,
    pivots and all arithmetic in double.
    """
    order, begin, pairs, right, left, listed, source = pattern
    strips, single = len(begin) // 2, np.float32
    kept = np.empty(own.shape, single), np.empty((len(pairs), 6, 6), single)
    work = np.empty_like(own), np.empty((len(pairs), 6, 6), single)
    matrix, bad = (own, given, 1.0 + shift), np.full(strips, -1)
    leading = np.empty(len(own), np.int64), np.zeros(strips, np.int64), bad
    _eliminate_strips(strips, pattern, matrix, work, kept, leading)
    if strips > 1 and bad.max() < 0:
        _begin_segments(strips, pattern, matrix, work, kept, leading)
        if not is_parted(pattern):  # they become one (strips are thin)
            begin = begin.copy()
            begin[strips + 1 :] = begin[-1]
            pattern = order, begin, pairs, right, left, listed, source
        _eliminate_segments(strips, pattern, own, work, bad)
    return finished(pattern, work), kept, bad.max()
