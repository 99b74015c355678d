"""Conjugate gradients preconditioned by a factor without fill and a coarse space (PCG).

Where inertia holds its own against the contacts, p h2/m of a few units, one to ten iterations are
enough; each costs a product and as much again for the substitutions.  Where it does not, a coarse
system is added, which costs a fifth more (linear/coarse_space.py).

All is in single precision.  Greater accuracy is reached by iterative refinement (Wilkinson 1963):
the residual of the solution is computed in double precision, and solved for again.

Products and substitutions of an iteration, in single precision (compute/vec6_single.py).

K and its factor without fill are read over and over, block by block, and each block is read once:
row i takes K_ij x_j from it and hands K_ij^T x_i on to row j.  It may do so within its stretch of
rows; where j lies in a later one, row j reads the block again, and no stretch writes to another
one.  So no digit depends on the number of threads.

The substitutions with a factor, (L D L^T)^-1 r, go strip by strip (linear/ordering.py).  Upwards,
L z = r, the seam comes last, and downwards, D L^T z = z, first.
"""

from __future__ import annotations

import numpy as np

from clast.compute import vec6_single as single
from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, EACH, shared, summed
from clast.compute.vec6 import minus, plus, plus_product, plus_scaled, put_row, row, total, zeros
from clast.compute.vec6_single import WIDTH
from clast.linear.coarse_space import restrict, turn_with

STRETCHES_MAX, ROWS_OF_STRETCH_MIN = 8, 256
"""Stretches of rows that threads share, and rows of one at least."""
AHEAD = 24
"""Blocks that are asked for before they are needed: memory is read page by page otherwise."""


@kernel(forceinline=True)
def _plus_lines(y, x, k):
    """Return y + sum of x_a k_a."""
    even, odd = single.add_lines((y, single.zeros()), x, k)
    return plus(even, odd)


@kernel(forceinline=True)
def times(blocks, i, x):
    """Return symmetric block i of (n, 6, 6) times six numbers."""
    return _plus_lines(single.zeros(), single.spread(x), single.lines(blocks, i))


@kernel(forceinline=True)
def _right_of(low, high, upper, pairs, x):
    """Return the sum of K_ij x_j over the pairs ``low`` to ``high`` - 1, those of a row i.

    Rows are taken from the last to the first.
    """
    sums = single.zero_lines()
    for q in range(low, high):
        single.fetch(upper, q, -AHEAD)
        sums = single.add_products(sums, single.lines(upper, q), single.row(x, pairs[q, 1]))
    return single.totals(sums)


@kernel(forceinline=True)
def _left_of(low, high, before, listed, upper, pairs, x):
    """Return the sum of K_ji^T x_j over the pairs listed ``low`` to ``high`` - 1 of a row i.

    Of those before pair ``before`` alone; they are listed in ascending order.
    """
    sums = single.zeros(), single.zeros()
    for at in range(low, high):
        q = listed[at]
        if q >= before:
            break
        other = single.spread(single.row(x, pairs[q, 0]))
        sums = single.add_lines(sums, other, single.lines(upper, q))
    even, odd = sums
    return plus(even, odd)


@kernel(forceinline=True)
def _both_sides(low, high, end, x_i, upper, pairs, x, y):
    """Return the sum of K_ij x_j over the pairs ``low`` to ``high`` - 1; add K_ij^T x_i to y_j.

    To rows j < end alone.
    """
    sums, own = single.zero_lines(), single.spread(x_i)
    for q in range(low, high):
        j = pairs[q, 1]
        single.fetch(upper, q, AHEAD)
        k = single.lines(upper, q)
        sums = single.add_products(sums, k, single.row(x, j))
        if j < end:
            single.put_row(y, j, _plus_lines(single.row(y, j), own, k))
    return single.totals(sums)


@kernel()
def _begin_stretch(first, last, upper, pattern, x, y):
    """Write into rows ``first`` to ``last`` - 1 of y the contribution of the pairs of earlier rows.

    By itself, for in one loop with the rest registers would not suffice.
    """
    _, _, pairs, right, left, listed, _ = pattern
    before = right[first]
    for i in range(first, last):
        if left[i] < left[i + 1] and listed[left[i]] < before:
            known = _left_of(left[i], left[i + 1], before, listed, upper, pairs, x)
            single.put_row(y, i, known)
        else:
            single.put_row(y, i, single.zeros())


@summed(EACH)
def _multiply_stretches(first, last, length, matrix, pattern, x, y):
    """Write stretches of K x, ``length`` rows each, into y; return their part of x.K x."""
    diagonal, upper = matrix
    _, _, pairs, right, _, _, _ = pattern
    product = zeros()
    for stretch in range(first, last):
        low, high = stretch * length, min((stretch + 1) * length, len(x))
        _begin_stretch(low, high, upper, pattern, x, y)
        for i in range(low, high):
            own = single.row(x, i)
            begun = plus(single.row(y, i), times(diagonal, i, own))
            behind = _both_sides(right[i], right[i + 1], high, own, upper, pairs, x, y)
            y_i = plus(begun, behind)
            single.put_row(y, i, y_i)
            product = plus_product(product, single.double(own), single.double(y_i))
    return total(product)


@kernel()
def multiply(matrix, pattern, x, y):
    """Write K x (n, 8) into y and return x.K x, all in the order of the ``pattern``.

    ``matrix`` are the diagonal blocks of K (n, 6, 6) and those of the pattern's pairs (p, 6, 6).
    The number of stretches is a power of two, for as many threads to have as much to do.
    """
    number = 1
    while number < STRETCHES_MAX and len(x) >= 2 * number * ROWS_OF_STRETCH_MIN:
        number *= 2
    return _multiply_stretches(number, (len(x) + number - 1) // number, matrix, pattern, x, y)


# Substitutions -----------------------------------------------------------------------------------


@kernel(forceinline=True)
def _pass_up(low, high, end, z_i, scaled, pairs, z):
    """Take K_ij^T z_i out of z_j for the pairs ``low`` to ``high`` - 1 with j < end."""
    taken = single.spread(minus(single.zeros(), z_i))
    for q in range(low, high):
        j = pairs[q, 1]
        if j >= end:
            break
        single.fetch(scaled, q, AHEAD)
        single.put_row(z, j, _plus_lines(single.row(z, j), taken, single.lines(scaled, q)))


@kernel()
def _go_up(low, high, before, factor, r, z):
    """Write L^-1 r into rows ``low`` to ``high`` - 1 of z, after those of the pairs before one."""
    (_, _, pairs, right, left, listed, _), _, scaled = factor
    z[low:high] = r[low:high]
    if before > 0:
        for i in range(low, high):
            known = _left_of(left[i], left[i + 1], before, listed, scaled, pairs, z)
            single.put_row(z, i, minus(single.row(z, i), known))
    for i in range(low, high):
        _pass_up(right[i], right[i + 1], high, single.row(z, i), scaled, pairs, z)


@kernel()
def _come_down(low, high, factor, r, z):
    """Turn L^-1 r into L^-T D^-1 L^-1 r, ``low`` to ``high`` - 1, in place; return r.z there."""
    (_, _, pairs, right, _, _, _), inverse, scaled = factor
    s = zeros()
    for i in range(high - 1, low - 1, -1):
        known = _right_of(right[i], right[i + 1], scaled, pairs, z)
        z_i = minus(times(inverse, i, single.row(z, i)), known)
        single.put_row(z, i, z_i)
        s = plus_product(s, single.double(single.row(r, i)), single.double(z_i))
    return total(s)


@shared(EACH)
def _up_strips(first, last, pattern, values, r, z):
    """Write L^-1 r into the rows of strips of z."""
    begin, factor = pattern[1], (pattern, *values)
    for c in range(first, last):
        _go_up(begin[c], begin[c + 1], 0, factor, r, z)


@summed(EACH)
def _round_segments(first, last, pattern, values, r, z):
    """Solve for segments of the seam, whose rows are coupled to those of the strips before."""
    begin, right, factor = pattern[1], pattern[3], (pattern, *values)
    strips, product = len(begin) // 2, 0.0
    for segment in range(strips + first, strips + last):
        low, high = begin[segment], begin[segment + 1]
        _go_up(low, high, right[begin[strips]], factor, r, z)
        product += _come_down(low, high, factor, r, z)
    return product


@summed(EACH)
def _down_strips(first, last, pattern, values, r, z):
    """Turn L^-1 r into the solution in strips of z, in place; return r.z there."""
    begin, factor, product = pattern[1], (pattern, *values), 0.0
    for c in range(first, last):
        product += _come_down(begin[c], begin[c + 1], factor, r, z)
    return product


@kernel()
def substitute(factor, r, z):
    """Write (L D L^T)^-1 r into z and return r.z, (n, 8) each, in the order of the factor."""
    pattern, values = factor[0], factor[1:]  # threads take no tuples of tuples
    strips = len(pattern[1]) // 2
    _up_strips(strips, pattern, values, r, z)
    if strips == 1:
        return _down_strips(1, pattern, values, r, z)
    round_ = _round_segments(strips, pattern, values, r, z)
    return round_ + _down_strips(strips, pattern, values, r, z)


STEP_LENGTH_MIN = 0.01
"""Length of a step along a direction below which the preconditioner is none: it is 1 where B K is
one, and was 0.03 and more wherever B was sound.  Where pivots of the factor are next to singular it
was between 6e-3 and 1e-23, and the residual by the measure of r.B r tells nothing: 1e-6 after two
steps, with nothing solved."""
HOPE = 1.5
"""Iterations, as a share of the limit, that may seem needed then: the rate improves."""


@shared(BLOCKS)
def _advance(first, last, alpha, p, kp, x, r):
    """Go alpha along p, in place: x += alpha p, r -= alpha K p."""
    for i in range(first, last):
        put_row(x, i, plus_scaled(row(x, i), alpha, row(p, i)))
        put_row(r, i, plus_scaled(row(r, i), -alpha, row(kp, i)))


@shared(BLOCKS)
def _turn(first, last, z, beta, p):
    """Turn the direction, in place: p = z + beta p."""
    for i in range(first, last):
        put_row(p, i, plus_scaled(row(z, i), beta, row(p, i)))


@kernel()
def vector(count):
    """Return a vector of zeros as the iteration has them (n, 8).

    Two numbers of a row stay zero: operations on six leave them as they are.
    """
    return np.zeros((count, WIDTH), np.float32)


@shared(BLOCKS)
def _to_order(first, last, order, force, ordered):
    """Write a vector (n, 6) in the order of the factor."""
    for i in range(first, last):
        put_row(ordered, i, row(force, order[i]))


@shared(BLOCKS)
def _from_order(first, last, order, ordered, result):
    """Write a vector in the order of the factor where its rows belong (n, 6)."""
    for i in range(first, last):
        put_row(result, order[i], row(ordered, i))


@kernel()
def _precondition(factor, coarse, r, z, of_coarse):
    """Write the incomplete factor's part of B r into z; return r.B r.

    The solution of the coarse system is the second of ``of_coarse``, two vectors of it.
    """
    product = substitute(factor, r, z)
    _, start, members, offset, of_aggregates = coarse
    if len(start) > 1:
        restrict(len(start) - 1, start, members, offset, r, of_coarse[0])
        product += substitute(of_aggregates, *of_coarse)
    return product


@kernel()
def _turn_to(coarse, z, of_coarse, beta, p):
    """Turn the direction, in place: p = B r + beta p, with the parts of B r."""
    aggregate, start, _, offset, _ = coarse
    if len(start) > 1:
        turn_with(len(p), aggregate, offset, of_coarse[1], z, beta, p)
    else:
        _turn(len(p), z, beta, p)


@kernel()
def _iterate(ready, vectors, of_coarse, wanted, limits):
    """Go on until r.B r is at most ``wanted``; return the iterations and r.B r, or infinity."""
    factor, matrix, coarse = ready
    x, r, z, p, kp = vectors
    limit, trial, start = limits
    rz, iterations = start, 0
    while iterations < limit and rz > wanted:
        curvature = multiply(matrix, factor[0], p, kp)
        if not (curvature > 0.0 and rz >= STEP_LENGTH_MIN * curvature):
            return iterations, np.inf
        _advance(len(p), rz / curvature, p, kp, x, r)
        iterations += 1
        following = _precondition(factor, coarse, r, z, of_coarse)
        beta, rz = following / rz, following
        if iterations == trial and rz > wanted:
            # needed / iterations = log(wanted / start) / log(rz / start), for what is gained so far
            if np.log(start / wanted) * iterations > HOPE * limit * np.log(start / rz):
                break
        _turn_to(coarse, z, of_coarse, beta, p)
    return iterations, rz


@kernel()
def solve(ready, force, goal, tolerance, limit, trial):
    """Return d (n, 6) of K d = F, the iterations, and sqrt(r.B r) at first and at last.

    Stops where sqrt(r.B r) is at most ``goal`` or ``tolerance`` of its first value; after ``limit``
    iterations; where far more than that seem needed after the first ``trial``; or where B is no
    preconditioner, which is said by infinity.  ``ready`` is the factor M, K in its order
    (linear/ldlt.py) and the coarse system (linear/coarse_space.py), which has no aggregates where B
    is to be M^-1.
    """
    factor, _, coarse = ready
    order = factor[0][0]
    count, number = len(order), len(coarse[1]) - 1
    x, r, z, p, kp = vector(count), vector(count), vector(count), vector(count), vector(count)
    of_coarse = vector(number), vector(number)
    displacement = np.zeros((count, 6))
    _to_order(count, order, force, r)
    start = _precondition(factor, coarse, r, z, of_coarse)
    wanted = max(goal, tolerance * np.sqrt(start)) ** 2
    if not start > wanted:
        return displacement, 0, np.sqrt(start), np.sqrt(start)
    _turn_to(coarse, z, of_coarse, 0.0, p)
    limits = limit, trial, start
    iterations, rz = _iterate(ready, (x, r, z, p, kp), of_coarse, wanted, limits)
    _from_order(count, order, x, displacement)
    return displacement, iterations, np.sqrt(start), np.sqrt(rz)
