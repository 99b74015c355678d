"""Incomplete block Cholesky without fill, K ~ L D L^T, as a preconditioner.

Blocks are eliminated in the order of linear/parts.py: strips, which threads share, and the seam
between them.  What would fall on a pair of blocks that share no contact is left out (Meijerink and
van der Vorst 1977).  For want of that a pivot may be next to singular, and a few of those among
100,000 have cost hundreds of iterations: what is eliminated is K with slightly larger blocks on its
diagonal (Manteuffel 1980).  Where a pivot still is not positive definite the diagonal block of K
takes its place, so that the product is positive definite in any case.

A factor is (order, begin, pairs, right, left, listed, inverse, scaled): the order and where its
strips and then the segments of the seam begin, the coupled pairs by their places in it and the rows
of these (linear/block_matrix.py), D^-1 (n, 6, 6) and L^T above its diagonal (q, 6, 6).  L is in
single precision, or short where K is in single precision (compute/vec6.py): enough for what is an
approximation anyway, and half as much to read in every iteration.  D^-1 is single only where K may
be, for rounding must not leave it indefinite.

With it comes K itself, its blocks in the same order and without those that are zero, which is what
an iteration multiplies with: it is read from one end to the other as the factor is.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import invert
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import line, plus_scaled, put_line, zeros
from clast.linear.block_products import multiply_into, subtract_product
from clast.linear.coupling_kernels import put_coupling
from clast.linear.parts import ordering, renumbered


@kernel()
def _pass_on(i, low, high, diagonal, upper, scaled, first, pairs, right):
    """Take row i's part out of the rows ``low`` to ``high`` - 1, in place.

    ``scaled`` holds its blocks of L^T, the first of them that of pair ``first``.
    """
    for q in range(right[i], right[i + 1]):
        j = pairs[q, 1]
        if j < low:
            continue
        if j >= high:
            break
        subtract_product(scaled, q - first, upper, q, diagonal, j)
        at = right[j]
        for following in range(q + 1, right[i + 1]):
            k = pairs[following, 1]
            while at < right[j + 1] and pairs[at, 1] < k:
                at += 1
            if at < right[j + 1] and pairs[at, 1] == k:
                subtract_product(scaled, q - first, upper, following, upper, at)


@kernel()
def _widest(low, high, right):
    """Return the most pairs that a row of ``low`` to ``high`` - 1 begins."""
    most = 0
    for i in range(low, high):
        most = max(most, right[i + 1] - right[i])
    return most


@kernel()
def eliminate(low, high, own, order, diagonal, upper, pairs, right, inverse, scaled):
    """Eliminate rows ``low`` to ``high`` - 1; return the first block without a pivot, or -1.

    ``diagonal`` and ``upper`` are worked on in place, ``own`` are the diagonal blocks of K.
    """
    of_row, pivot = np.empty((_widest(low, high, right), 6, 6)), np.empty((1, 6, 6))
    for i in range(low, high):
        if not invert(diagonal[i], pivot[0]) and not invert(own[order[i]], pivot[0]):
            return order[i]
        for a in range(6):
            put_line(inverse, i, a, line(pivot, 0, a))
        first = right[i]
        for q in range(first, right[i + 1]):
            multiply_into(pivot, 0, upper, q, of_row, q - first)
            for a in range(6):
                put_line(scaled, q, a, line(of_row, q - first, a))
        _pass_on(i, low, high, diagonal, upper, of_row, first, pairs, right)
    return -1


@kernel()
def _take(low, high, own, couplings, new, work, matrix):
    """Write the blocks of rows ``low`` to ``high`` - 1 in their new order, twice.

    In what is to be eliminated those on the diagonal are ``larger``.
    """
    order, source, _, right = new
    diagonal, upper, larger = work
    kept_own, kept = matrix
    for i in range(low, high):
        for a in range(6):
            of_block = line(own, order[i], a)
            put_line(diagonal, i, a, plus_scaled(zeros(), larger, of_block))
            put_line(kept_own, i, a, of_block)
        for q in range(right[i], right[i + 1]):
            put_coupling(couplings, source[q], order[i], upper, q)
            for a in range(6):
                put_line(kept, q, a, line(upper, q, a))


@kernel()
def _find_leaders(low, high, seam, pairs, right, leaders):
    """Write the rows from ``low`` to ``high`` - 1 that are coupled to the seam; return how many."""
    number = 0
    for i in range(low, high):
        if right[i + 1] > right[i] and pairs[right[i + 1] - 1, 1] >= seam:
            leaders[low + number] = i
            number += 1
    return number


@kernel()
def _eliminate_strip(low, high, seam, own, couplings, new, work, found, matrix, leaders):
    """Copy and eliminate a strip; return how many rows lead to the seam, and what is singular."""
    order, _, pairs, right = new
    diagonal, upper, _ = work
    inverse, scaled = found
    _take(low, high, own, couplings, new, work, matrix)
    bad = eliminate(low, high, own, order, diagonal, upper, pairs, right, inverse, scaled)
    return _find_leaders(low, high, seam, pairs, right, leaders), bad


@kernel(parallel=True)
def _eliminate_strips(begin, own, couplings, new, work, found, matrix, leaders, number, bad):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(bad)):
            low, high = begin[c], begin[c + 1]
            number[c], bad[c] = _eliminate_strip(
                low, high, begin[len(bad)], own, couplings, new, work, found, matrix, leaders
            )


@kernel()
def _leave(i, low, high, inverse, diagonal, upper, pairs, right):
    """Take row i's part out of the rows ``low`` to ``high`` - 1, in place, if it has any.

    Its row of L^T is found again: as it is kept it is rounded.
    """
    first, last = right[i], right[i + 1]
    if pairs[last - 1, 1] < low:
        return
    of_row = np.empty((last - first, 6, 6))
    for q in range(first, last):
        multiply_into(inverse, i, upper, q, of_row, q - first)
    _pass_on(i, low, high, diagonal, upper, of_row, first, pairs, right)


@kernel()
def _take_segment(low, high, begin, own, couplings, new, work, inverse, matrix, leading):
    """Copy a segment of the seam and take out of it what the strips leave for it, in their order.

    A strip may be coupled to any segment, and a row to several.
    """
    _, _, pairs, right = new
    diagonal, upper, _ = work
    leaders, number = leading
    _take(low, high, own, couplings, new, work, matrix)
    for c in range(len(number)):
        for at in range(begin[c], begin[c] + number[c]):
            _leave(leaders[at], low, high, inverse, diagonal, upper, pairs, right)


@kernel(parallel=True)
def _take_seam(begin, own, couplings, new, work, inverse, matrix, leading):
    strips = len(begin) // 2
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, strips):
            low, high = begin[strips + c], begin[strips + c + 1]
            _take_segment(low, high, begin, own, couplings, new, work, inverse, matrix, leading)


@kernel()
def is_parted(begin, pairs, right):
    """Return whether no segment of the seam is coupled to another one."""
    strips = len(begin) // 2
    for c in range(strips, 2 * strips):
        for i in range(begin[c], begin[c + 1]):
            if right[i + 1] > right[i] and pairs[right[i + 1] - 1, 1] >= begin[c + 1]:
                return False
    return True


@kernel(parallel=True)
def _eliminate_segments(begin, own, new, work, found, bad):
    order, _, pairs, right = new
    diagonal, upper, _ = work
    inverse, scaled = found
    strips = len(bad)
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(bad)):
            low, high = begin[strips + c], begin[strips + c + 1]
            bad[c] = eliminate(
                low, high, own, order, diagonal, upper, pairs, right, inverse, scaled
            )


@kernel()
def _eliminate_seam(begin, own, couplings, new, work, found, matrix, leading, bad):
    """Eliminate the seam by segments, which become one where they are coupled (strips are thin)."""
    _, _, pairs, right = new
    inverse, _ = found
    _take_seam(begin, own, couplings, new, work, inverse, matrix, leading)
    if not is_parted(begin, pairs, right):
        begin[len(bad) + 1 :] = begin[-1]
    _eliminate_segments(begin, own, new, work, found, bad)


@kernel()
def factor(own, couplings, coupled, pairs, rows, centroid, shift, precision, brevity):
    """Return the factor of K, K in its order, and the first block without a pivot, or -1.

    ``own`` (n, 6, 6) are the diagonal blocks of K and ``couplings`` (linear/coupling_kernels.py)
    what
    couples ``pairs`` (q, 2), whose right, left and listed are ``rows``; ``coupled`` (q,) says which
    of them are coupled at all, ``centroid`` (n, 2) where the blocks are.  What is eliminated has
    diagonal blocks larger by ``shift``, unless there are too few pairs for anything to be left out:
    chains and trees are factorised as they are.  K in the order of the factor is its diagonal
    blocks (n, 6, 6) and those of the coupled pairs, both in the precision of the array
    ``precision``, as D^-1 is and what is being eliminated, pivots excepted; L is kept as the array
    ``brevity`` is.
    """
    order, begin = ordering(centroid, pairs, coupled)
    pairs, source, (right, left, listed) = renumbered(order, pairs, rows, coupled)
    kind = precision.dtype
    inverse, diagonal = np.empty(own.shape, kind), np.empty_like(own)
    scaled = np.empty((len(pairs), 6, 6), brevity.dtype)
    upper = np.empty((len(pairs), 6, 6), kind)
    bad = np.full(len(begin) // 2, -1)
    larger = 1.0 + shift if len(pairs) >= len(own) else 1.0
    new, work = (order, source, pairs, right), (diagonal, upper, larger)
    matrix = (np.empty(own.shape, kind), np.empty((len(pairs), 6, 6), kind))
    leading = np.empty(len(own), np.int64), np.zeros(len(bad), np.int64)
    if len(bad) > 1:
        done = inverse, scaled
        _eliminate_strips(begin, own, couplings, new, work, done, matrix, *leading, bad)
        if bad.max() < 0:
            _eliminate_seam(begin, own, couplings, new, work, done, matrix, leading, bad)
    else:
        _take(0, len(own), own, couplings, new, work, matrix)
        bad[0] = eliminate(0, len(own), own, order, diagonal, upper, pairs, right, inverse, scaled)
    return (order, begin, pairs, right, left, listed, inverse, scaled), matrix, bad.max()
