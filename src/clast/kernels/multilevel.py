"""Conjugate gradients preconditioned by a cycle over levels of larger and larger blocks.

Level k + 1 is the system of the aggregates of level k (kernels/aggregates.py).  On each level one
damped Jacobi step goes before and one after the correction by the next level, which is found by one
or two cycles there, combined so that the error's energy is least (K-cycle, Notay and Vassilevski
2008).  The last level is solved by its inverse.

The cycle is positive definite whatever the contacts: each adds k m m^T to K, and with the sign of
one block's half of m changed it still adds something positive, so that K <= 2 D.

A level is (diagonal, inverse, upper, pairs, right, left, listed, parent, start, members, offset):
its blocks, the inverses of the diagonal ones, its rows (kernels/block_rows.py) and its aggregates.
``levels`` holds one tuple of arrays, over the levels, for each of these, and ``work`` one for each
of eight vectors.  A cycle may be in single precision throughout: it is an approximation anyway, and
reads the blocks of its first level twice for each time that they are multiplied with exactly.
"""

from __future__ import annotations

import numpy as np

from clast.kernels.aggregates import prolong, restrict
from clast.kernels.block_rows import dot, jacobi, multiply, relax
from clast.kernels.compiled import kernel
from clast.kernels.conjugate import advance, turn, vector
from clast.kernels.dense import multiply_dense
from clast.kernels.six import plus, plus_product, plus_scaled, put_row, row, total, zeros

LEVELS = 8
"""Levels at most: each has about a seventh of the blocks of the one before."""
GOOD = 0.25
"""A first cycle that leaves less than this share of the residual needs no second."""
DAMPING = 0.8
"""Share of a Jacobi step; of 0.6 to 1 the fewest iterations, and below 1 the cycle is definite."""


@kernel()
def _multiply(k, levels, x, y):
    """Write K x of level k into y and return x.K x."""
    return multiply(
        levels[0][k],
        levels[2][k],
        levels[3][k],
        levels[4][k],
        levels[5][k],
        levels[6][k],
        x,
        y,
    )


@kernel()
def _smooth_before(k, levels, b, x, rest):
    """Take a Jacobi step from zero into x; write what is left of b into ``rest``."""
    jacobi(DAMPING, levels[1][k], b, x)
    _multiply(k, levels, x, rest)
    turn(b, -1.0, rest)


@kernel()
def _smooth_after(k, levels, b, product, x):
    """Take a Jacobi step from x; ``product`` is overwritten."""
    _multiply(k, levels, x, product)
    relax(DAMPING, levels[1][k], b, product, x)


@kernel()
def _combine(b, c, v, d, w, e):
    """Write into e the best correction from cycles c and d, given v = K c and w = K d."""
    rho, alpha = dot(c, v), dot(c, b)
    gamma, beta = dot(d, v), dot(d, w)
    second = beta - gamma * gamma / rho
    of_d = (dot(d, b) - gamma * alpha / rho) / second if second > 0.0 else 0.0
    of_c = (alpha - gamma * of_d) / rho
    for i in range(len(e)):
        put_row(e, i, plus_scaled(plus_scaled(zeros(), of_c, row(c, i)), of_d, row(d, i)))


@kernel()
def _solve_last(k, levels, inverse, work):
    """Solve the last level: by its inverse, or roughly by two Jacobi steps where it has none."""
    rhs, result, rest = work[0][k], work[1][k], work[3][k]
    if len(inverse) > 0:
        multiply_dense(inverse, rhs, result)
        return
    _smooth_before(k, levels, rhs, result, rest)
    _smooth_after(k, levels, rhs, rest, result)


@kernel()
def _go_down(k, second, levels, work):
    """Smooth level k and hand what is left to the next level as its right-hand side."""
    b = work[5][k] if second else work[0][k]
    x = work[1][k] if k == 0 else work[7][k] if second else work[4][k]
    _smooth_before(k, levels, b, x, work[3][k])
    restrict(levels[8][k], levels[9][k], levels[10][k], work[3][k], work[0][k + 1])


@kernel()
def _come_up(k, second, levels, work):
    """Correct level k by the next one and smooth; return True if it is done, after 1 or 2 cycles.

    With c and d the results of the two cycles, the second is for what c leaves of the right-hand
    side, and the answer is the combination of c and d with the least error in energy.
    """
    rhs, result, rest = work[0][k], work[1][k], work[3][k]
    c, other, product, d = work[4][k], work[5][k], work[6][k], work[7][k]
    b = other if second else rhs
    x = result if k == 0 else d if second else c
    prolong(levels[7][k], levels[10][k], work[1][k + 1], x)
    _smooth_after(k, levels, b, rest, x)
    if k == 0:
        return True
    if second:
        _multiply(k, levels, d, rest)
        _combine(rhs, c, product, d, rest, result)
        return True
    alpha, rho = dot(c, rhs), _multiply(k, levels, c, product)
    share = alpha / rho if rho > 0.0 else 0.0
    left, whole = zeros(), zeros()
    for i in range(len(rhs)):
        wanted = row(rhs, i)
        rest_of = plus_scaled(wanted, -share, row(product, i))
        put_row(result, i, plus_scaled(zeros(), share, row(c, i)))
        put_row(other, i, rest_of)
        left, whole = plus_product(left, rest_of, rest_of), plus_product(whole, wanted, wanted)
    return total(left) <= GOOD**2 * total(whole)


@kernel()
def _cycle(last, levels, inverse, work):
    """Solve level 0 roughly: work[1][0] becomes about K^-1 work[0][0]."""
    second = np.zeros(LEVELS, np.bool_)
    k = 0
    while True:
        while k < last:
            _go_down(k, second[k], levels, work)
            k += 1
            second[k] = False
        _solve_last(k, levels, inverse, work)
        while True:
            if k == 0:
                return
            k -= 1
            if not _come_up(k, second[k], levels, work):
                second[k] = True
                break


@kernel()
def _copy(given, taken):
    """Write the rows of a vector into another one, whatever their precision."""
    for i in range(len(given)):
        put_row(taken, i, row(given, i))


@kernel()
def _gone(guess, x):
    """Return ``guess`` (n, 6) plus x."""
    result = np.empty_like(guess)
    for i in range(len(guess)):
        put_row(result, i, plus(row(guess, i), row(x, i)))
    return result


@kernel()
def solve(matrix, levels, last, inverse, work, force, guess, tolerance, limit):
    """Return d (n, 6) of K d = F, the iterations and the final reduction of r.B r.

    ``matrix`` is K: diagonal, upper, pairs, right, left and listed of kernels/block_rows.py.
    Starts from ``guess`` (n, 6).  B is the cycle.  Flexible conjugate gradients (the K-cycle is not
    quite linear) that stop where r.B r has fallen to tolerance^2 of its start, or after ``limit``
    iterations; inf where K or B is not positive definite.
    """
    diagonal, upper, pairs, right, left, listed = matrix
    number = len(force)
    x, r = vector(number, diagonal), vector(number, diagonal)
    kp, p = vector(number, diagonal), vector(number, diagonal)
    rhs, z = work[0][0], work[1][0]
    _copy(guess, p)
    multiply(diagonal, upper, pairs, right, left, listed, p, kp)
    _copy(force, r)
    r -= kp
    _copy(r, rhs)
    _cycle(last, levels, inverse, work)
    rz = dot(r, z)
    start = rz
    if start == 0.0:
        return guess.copy(), 0, 0.0
    _copy(z, p)
    count = 0
    while count < limit and rz > tolerance**2 * start:
        curvature = multiply(diagonal, upper, pairs, right, left, listed, p, kp)
        if not curvature > 0.0:
            return _gone(guess, x), count, np.inf
        alpha = rz / curvature
        advance(alpha, p, kp, x, r)
        count += 1
        _copy(r, rhs)
        _cycle(last, levels, inverse, work)
        following = dot(r, z)
        if not following >= 0.0:
            return _gone(guess, x), count, np.inf
        # z.(r - r_before), Polak and Ribiere's, for a preconditioner that is not quite linear
        beta = -alpha * dot(kp, z) / rz
        rz = following
        turn(z, beta, p)
    return _gone(guess, x), count, np.sqrt(rz / start)
