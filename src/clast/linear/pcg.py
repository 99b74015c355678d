"""Conjugate gradients preconditioned by a factor without fill and a coarse space (PCG).

Where inertia holds its own against the contacts, p h2/m of a few units, one to ten iterations are
enough; each costs a product and as much again for the substitutions.  Where it does not, a coarse
system is added, which costs a fifth more (linear/coarse_space.py).

All is in single precision.  Greater accuracy is reached by iterative refinement (Wilkinson 1963):
the residual of the solution is computed in double precision, and solved for again.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import plus_scaled, put_row, row
from clast.compute.vec6_single import WIDTH
from clast.linear.coarse_space import restrict, turn_with
from clast.linear.single_precision import multiply, substitute

SHORTEST = 0.01
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
def _from_order(first, last, order, ordered, found):
    """Write a vector in the order of the factor where its rows belong (n, 6)."""
    for i in range(first, last):
        put_row(found, order[i], row(ordered, i))


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
        if not (curvature > 0.0 and rz >= SHORTEST * curvature):
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
    found = np.zeros((count, 6))
    _to_order(count, order, force, r)
    start = _precondition(factor, coarse, r, z, of_coarse)
    wanted = max(goal, tolerance * np.sqrt(start)) ** 2
    if not start > wanted:
        return found, 0, np.sqrt(start), np.sqrt(start)
    _turn_to(coarse, z, of_coarse, 0.0, p)
    limits = limit, trial, start
    iterations, rz = _iterate(ready, (x, r, z, p, kp), of_coarse, wanted, limits)
    _from_order(count, order, x, found)
    return found, iterations, np.sqrt(start), np.sqrt(rz)
