"""Conjugate gradients preconditioned by an incomplete Cholesky factorisation.

Where inertia holds its own against the contacts, p h2/m of a few units, one to ten iterations are
enough; each costs a product and as much again for the substitutions (linear/incomplete.py).
Where it does not, a coarse system is added, which costs a fifth more (linear/coarse_kernels.py).
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, SHARED, chunks
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus, plus_product, plus_scaled, put_row, row, total, zeros
from clast.compute.vec6_single import WIDTH
from clast.linear.aggregates import restrict, turn_with
from clast.linear.block_matrix import multiply
from clast.linear.substitution import substitute

LEAP, EXACT = 1e-2, 1e-8
"""An iteration that leaves less than LEAP is followed by another, until EXACT is left: where the
factor is nearly exact, as for a column of blocks, that is cheaper than another matrix."""
SHORTEST = 0.01
"""Length of a step along a direction below which the preconditioner is none: it is 1 where B K is
one, and was 0.03 and more wherever B was sound.  Where pivots of the factor are next to singular it
was between 6e-3 and 1e-23, and what is left by the measure of r.B r tells nothing: 1e-6 after two
steps, with nothing solved."""
HOPE = 1.5
"""Iterations, as a share of the limit, that may seem needed then: the rate improves."""


@kernel()
def _add_rows(first, last, factor, from_vector, to_vector):
    """Add factor x from_vector to to_vector in rows ``first`` to ``last`` - 1."""
    for i in range(first, last):
        put_row(to_vector, i, plus_scaled(row(to_vector, i), factor, row(from_vector, i)))


@kernel()
def _turn_rows(first, last, z, beta, p):
    """Write z + beta p into p in rows ``first`` to ``last`` - 1."""
    for i in range(first, last):
        put_row(p, i, plus_scaled(row(z, i), beta, row(p, i)))


@kernel(parallel=True)
def _advance_shared(alpha, p, kp, x, r):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(p))):
            last = min((c + 1) * CHUNK, len(p))
            _add_rows(c * CHUNK, last, alpha, p, x)
            _add_rows(c * CHUNK, last, -alpha, kp, r)


@kernel()
def advance(alpha, p, kp, x, r):
    """Go alpha along p, in place: x += alpha p, r -= alpha K p."""
    if len(p) >= SHARED:
        _advance_shared(alpha, p, kp, x, r)
    else:
        _add_rows(0, len(p), alpha, p, x)
        _add_rows(0, len(p), -alpha, kp, r)


@kernel(parallel=True)
def _turn_shared(z, beta, p):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(p))):
            _turn_rows(c * CHUNK, min((c + 1) * CHUNK, len(p)), z, beta, p)


@kernel()
def turn(z, beta, p):
    """Turn the direction, in place: p = z + beta p."""
    if len(p) >= SHARED:
        _turn_shared(z, beta, p)
    else:
        _turn_rows(0, len(p), z, beta, p)


@kernel()
def vector(count, precision):
    """Return a vector of zeros as products in the precision of an array take it.

    Rows of eight have two numbers that stay zero: operations on six leave them as they are.
    """
    return np.zeros((count, 6 if precision.itemsize == 8 else WIDTH), precision.dtype)


@kernel()
def _empty(blocks):
    """Return a vector to be cleared, of as many rows as blocks and in their precision."""
    return np.empty((len(blocks), 6 if blocks.itemsize == 8 else WIDTH), blocks.dtype)


@kernel()
def _order_rows(first, last, order, given, ordered, cleared):
    """Write places ``first`` to ``last`` - 1 in the factor's order; return the sum of squares.

    Nothing ``given`` (0, 6) is zero.  Those of ``cleared`` become zero as well.
    """
    ordered[first:last] = 0.0
    cleared[first:last] = 0.0
    square = zeros()
    if len(given) > 0:
        for i in range(first, last):
            numbers = row(given, order[i])
            square = plus_product(square, numbers, numbers)
            put_row(ordered, i, numbers)
    return total(square)


@kernel(parallel=True)
def _in_order_shared(order, given, ordered, cleared, squares):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(squares)):
            last = min((c + 1) * CHUNK, len(order))
            squares[c] = _order_rows(c * CHUNK, last, order, given, ordered, cleared)


@kernel()
def _in_order(order, given, ordered, cleared):
    """Write the rows of a vector (n, 6) in the order of the factor; return if any is not zero."""
    if len(order) < SHARED:
        return _order_rows(0, len(order), order, given, ordered, cleared) > 0.0
    squares = np.empty(chunks(len(order)))
    _in_order_shared(order, given, ordered, cleared, squares)
    return squares.max() > 0.0


@kernel()
def _return_rows(first, last, order, guess, x, result):
    """Write ``guess`` plus x where places ``first`` to ``last`` - 1 belong."""
    for i in range(first, last):
        begun = row(guess, order[i]) if len(guess) > 0 else zeros()
        put_row(result, order[i], plus(begun, row(x, i)))


@kernel(parallel=True)
def _gone_shared(order, guess, x, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(order))):
            _return_rows(c * CHUNK, min((c + 1) * CHUNK, len(order)), order, guess, x, result)


@kernel()
def _gone(order, guess, x):
    """Return ``guess`` (n, 6) plus x, which is in the order of the factor."""
    result = np.empty((len(order), 6))
    if len(order) >= SHARED:
        _gone_shared(order, guess, x, result)
    else:
        _return_rows(0, len(order), order, guess, x, result)
    return result


@kernel()
def _precondition(incomplete, coarse, r, z, of_coarse):
    """Write the incomplete factor's part of B r into z; return r.B r.

    What the coarse system finds is the second of ``of_coarse``, two vectors of it.
    """
    product = substitute(incomplete, r, z)
    _, start, members, offset, factor = coarse
    if len(start) > 1:
        restrict(start, members, offset, r, of_coarse[0])
        product += substitute(factor, *of_coarse)
    return product


@kernel()
def _turn_to(coarse, z, of_coarse, beta, p):
    """Turn the direction, in place: p = B r + beta p, with what was found of B r."""
    aggregate, start, _, offset, _ = coarse
    if len(start) > 1:
        turn_with(aggregate, offset, of_coarse[1], z, beta, p)
    else:
        turn(z, beta, p)


@kernel()
def solve(incomplete, matrix, coarse, force, guess, tolerance, limit, trial):
    """Return d (n, 6) of K d = F, the iterations and the reduction of r.B r reached.

    Starts from ``guess`` (n, 6), or from zero where that is (0, 6), and stops where r.B r has
    fallen to tolerance^2 of its start and no longer falls by leaps, after ``limit`` iterations,
    where far more than that seem needed after the first ``trial``, or where B is no preconditioner,
    which is said by a reduction of infinity.  ``incomplete`` is the factor M and ``matrix`` is K in
    its order, as linear/incomplete.py returns them; ``coarse`` what linear/coarse_kernels.py
    does,
    without any aggregates where B is to be M^-1.  All but ``force``, ``guess`` and d has the
    precision of K.
    """
    order, _, pairs, right, left, listed, _, _ = incomplete
    own, couplings = matrix
    x, r, z, kp = _empty(own), _empty(own), _empty(own), _empty(own)
    number = len(coarse[1]) - 1
    of_coarse = vector(number, own), vector(number, own)
    _in_order(order, force, r, x)
    if _in_order(order, guess, z, kp):
        multiply(own, couplings, pairs, right, left, listed, z, kp)
        turn(r, -1.0, kp)
        r, kp = kp, r
    start = rz = _precondition(incomplete, coarse, r, z, of_coarse)
    if start == 0.0:
        return _gone(order, guess, x), 0, 0.0
    p = vector(len(own), own)
    _turn_to(coarse, z, of_coarse, 0.0, p)
    iterations, wanted = 0, tolerance**2 * start
    while iterations < limit and rz > wanted:
        curvature = multiply(own, couplings, pairs, right, left, listed, p, kp)
        if not (curvature > 0.0 and rz >= SHORTEST * curvature):
            return _gone(order, guess, x), iterations, np.inf
        advance(rz / curvature, p, kp, x, r)
        iterations += 1
        following = _precondition(incomplete, coarse, r, z, of_coarse)
        beta = following / rz
        leaps = following < LEAP**2 * rz
        wanted = min(tolerance, EXACT if leaps else tolerance) ** 2 * start
        rz = following
        if iterations == trial and rz > wanted:
            # needed / iterations = log(tolerance^2) / log(rz / start), for what is gained so far
            gained = np.log(start / rz)
            if -2.0 * np.log(tolerance) * iterations > HOPE * limit * gained:
                break
        _turn_to(coarse, z, of_coarse, beta, p)
    return _gone(order, guess, x), iterations, np.sqrt(rz / start)
