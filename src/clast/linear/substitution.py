"""Substitutions with an incomplete factor, (L D L^T)^-1 r, strip by strip.

Upwards, L z = r, the seam comes last, and downwards, D L^T z = z, first.  Strips are solved at the
same time, and so are the segments of the seam.  A factor is what linear/incomplete.py returns.
"""

from __future__ import annotations

import numpy as np

from clast.compute import vec6_single as single
from clast.compute.jit import kernel, overload, types
from clast.compute.mat6 import times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus_product, plus_scaled, put_row, row, total, zeros
from clast.linear import single_rows
from clast.linear.block_matrix import left_of, right_of


@kernel()
def _go_up(low, high, incomplete, r, z):
    """Write L^-1 r into rows ``low`` to ``high`` - 1 of z."""
    _, _, pairs, _, left, listed, _, scaled = incomplete
    for i in range(low, high):
        known = left_of(left[i], left[i + 1], listed, scaled, pairs, z)
        put_row(z, i, plus_scaled(row(r, i), -1.0, known))


@kernel()
def _come_down(low, high, incomplete, r, z):
    """Turn L^-1 r into L^-T D^-1 L^-1 r, ``low`` to ``high`` - 1, in place; return r.z there."""
    _, _, pairs, right, _, _, inverse, scaled = incomplete
    s = zeros()
    for i in range(high - 1, low - 1, -1):
        known = right_of(right[i], right[i + 1], scaled, pairs, z)
        z_i = plus_scaled(times(inverse, i, z, i), -1.0, known)
        put_row(z, i, z_i)
        s = plus_product(s, row(r, i), z_i)
    return total(s)


@kernel(parallel=True)
def _go_up_shared(incomplete, r, z):
    begin = incomplete[1]
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(begin) // 2):
            _go_up(begin[c], begin[c + 1], incomplete, r, z)


@kernel(parallel=True)
def _come_down_shared(incomplete, r, z, products):
    begin = incomplete[1]
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(begin) // 2):
            products[c] = _come_down(begin[c], begin[c + 1], incomplete, r, z)


@kernel(parallel=True)
def _turn_round_shared(incomplete, r, z, products):
    begin = incomplete[1]
    strips = len(products)
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, strips):
            low, high = begin[strips + c], begin[strips + c + 1]
            _go_up(low, high, incomplete, r, z)
            products[c] = _come_down(low, high, incomplete, r, z)


@kernel()
def _substitute_double(incomplete, r, z):
    begin = incomplete[1]
    strips = len(begin) // 2
    if strips == 1:
        _go_up(0, begin[1], incomplete, r, z)
        return _come_down(0, begin[1], incomplete, r, z)
    products = np.empty((2, strips))
    _go_up_shared(incomplete, r, z)
    _turn_round_shared(incomplete, r, z, products[0])
    _come_down_shared(incomplete, r, z, products[1])
    return products.sum()


@kernel(forceinline=True)
def _pass_up(low, high, end, z_i, scaled, pairs, z):
    """Take K_ij^T z_i out of z_j for the pairs ``low`` to ``high`` - 1 with j < end."""
    n0, n1, n2, n3, n4, n5 = single.spread(single.minus(single.zeros(), z_i))
    for q in range(low, high):
        j = pairs[q, 1]
        if j >= end:
            break
        single.fetch(scaled, q, single_rows.AHEAD)
        k0, k1, k2, k3, k4, k5 = single.lines(scaled, q)
        s0 = single.plus_product(single.row(z, j), n0, k0)
        s1 = single.plus_product(single.zeros(), n1, k1)
        s0 = single.plus_product(s0, n2, k2)
        s1 = single.plus_product(s1, n3, k3)
        s0 = single.plus_product(s0, n4, k4)
        s1 = single.plus_product(s1, n5, k5)
        single.put_row(z, j, single.plus(s0, s1))


@kernel()
def _go_up_single(low, high, before, incomplete, r, z):
    """Write L^-1 r into rows ``low`` to ``high`` - 1 of z, after those of the pairs before one."""
    _, _, pairs, right, left, listed, _, scaled = incomplete
    z[low:high] = r[low:high]
    if before > 0:
        for i in range(low, high):
            known = single_rows.left_of(left[i], left[i + 1], before, listed, scaled, pairs, z)
            single.put_row(z, i, single.minus(single.row(z, i), known))
    for i in range(low, high):
        _pass_up(right[i], right[i + 1], high, single.row(z, i), scaled, pairs, z)


@kernel()
def _come_down_single(low, high, incomplete, r, z):
    """Turn L^-1 r into L^-T D^-1 L^-1 r, ``low`` to ``high`` - 1, in place; return r.z there."""
    _, _, pairs, right, _, _, inverse, scaled = incomplete
    s = zeros()
    for i in range(high - 1, low - 1, -1):
        known = single_rows.right_of(right[i], right[i + 1], scaled, pairs, z)
        z_i = single.minus(single_rows.times(inverse, i, single.row(z, i)), known)
        single.put_row(z, i, z_i)
        s = plus_product(s, single.double(single.row(r, i)), single.double(z_i))
    return total(s)


@kernel(parallel=True)
def _go_up_single_shared(incomplete, r, z):
    begin = incomplete[1]
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(begin) // 2):
            _go_up_single(begin[c], begin[c + 1], 0, incomplete, r, z)


@kernel(parallel=True)
def _come_down_single_shared(incomplete, r, z, products):
    begin = incomplete[1]
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(begin) // 2):
            products[c] = _come_down_single(begin[c], begin[c + 1], incomplete, r, z)


@kernel(parallel=True)
def _turn_round_single_shared(incomplete, r, z, products):
    _, begin, _, right, _, _, _, _ = incomplete
    strips = len(products)
    before = right[begin[strips]]
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, strips):
            low, high = begin[strips + c], begin[strips + c + 1]
            _go_up_single(low, high, before, incomplete, r, z)
            products[c] = _come_down_single(low, high, incomplete, r, z)


@kernel()
def _substitute_single(incomplete, r, z):
    begin = incomplete[1]
    strips = len(begin) // 2
    if strips == 1:
        _go_up_single(0, begin[1], 0, incomplete, r, z)
        return _come_down_single(0, begin[1], incomplete, r, z)
    products = np.empty((2, strips))
    _go_up_single_shared(incomplete, r, z)
    _turn_round_single_shared(incomplete, r, z, products[0])
    _come_down_single_shared(incomplete, r, z, products[1])
    return products.sum()


def _substitute(incomplete, r, z):
    """Stand for the substitutions in the precision of z."""


@overload(_substitute)
def _substitute_of(incomplete, r, z):
    def in_single(incomplete, r, z):
        return _substitute_single(incomplete, r, z)

    def in_double(incomplete, r, z):
        return _substitute_double(incomplete, r, z)

    return in_single if z.dtype == types.float32 else in_double


@kernel()
def substitute(incomplete, r, z):
    """Write (L D L^T)^-1 r into z and return r.z, both in the order of the factor.

    r and z are (n, 6) in double precision, or (n, 8) in single (compute/vec6_single.py); the
    factor is that of a K in the same precision.
    """
    return _substitute(incomplete, r, z)
