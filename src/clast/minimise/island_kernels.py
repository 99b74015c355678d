"""Small regions, each minimised by itself: Newton's method with exact line search.

Blocks of two regions share no contact: each region has a minimum, a system and iterations of its
own.  What one needs is copied together and stays in the processor's cache from the first iteration
to the last; threads take regions one by one.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, SHARED, sum_of
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus_scaled, put_row, row
from clast.linear import ldlt
from clast.linear.assembly import assemble, contact_motions, form
from clast.linear.block_matrix import dot
from clast.linear.pattern import with_fill
from clast.linear.residual import unbalanced
from clast.minimise.island_sums import works
from clast.minimise.line_search import answers, lengths_along
from clast.minimise.one_island import copied, put_back

FEW = 200
"""Blocks up to which any region is small."""
LIKE_TREES = 1.3
"""Pairs for each block up to which larger regions are small, too: eliminating them brings next to
no fill."""
WORTH = 50
"""Blocks of all small regions together from which threads share them: each has much to do."""


@kernel()
def listed(region, count):
    """Return where the blocks of each region begin (count + 1,), these, and their places (n,).

    ``region`` (n,) is that of each block.
    """
    start = np.zeros(count + 1, np.int64)
    for r in region:
        start[r + 1] += 1
    for r in range(count):
        start[r + 1] += start[r]
    at = start[:-1].copy()
    blocks, place = np.empty(len(region), np.int64), np.empty(len(region), np.int64)
    for i in range(len(region)):
        r = region[i]
        blocks[at[r]], place[i] = i, at[r] - start[r]
        at[r] += 1
    return start, blocks, place


@kernel()
def are_small(region, count, pairs, first, fixed):
    """Return which of ``count`` regions are small (count,); the last, of fixed blocks, is not.

    ``region`` (n,) is that of each block, ``first`` (q + 1,) the first contact of each pair.
    """
    blocks, links, contacts = np.zeros((3, count), np.int64)
    for r in region:
        blocks[r] += 1
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        r = region[j] if fixed[i] else region[i]
        links[r] += not (fixed[i] or fixed[j])
        contacts[r] += first[q + 1] - first[q]
    small = np.empty(count, np.bool_)
    for r in range(count):
        simple = blocks[r] <= FEW or links[r] <= LIKE_TREES * blocks[r]
        # what is called below must not want to be shared: the thread is one of several already
        small[r] = simple and blocks[r] + 1 < SHARED and contacts[r] < MANY
    small[count - 1] = False
    return small


@kernel()
def _pattern(problem):
    """Return the pattern of the exact factor of a region: that of all pairs of free blocks."""
    (_, _, _, fixed), pairs, _, _, _ = problem
    free = np.empty(len(pairs), np.bool_)
    for q in range(len(pairs)):
        free[q] = not (fixed[pairs[q, 0]] or fixed[pairs[q, 1]])
    return with_fill(len(fixed), pairs, free)


@kernel()
def _factor(problem, pattern, kn, ks):
    """Return the factor of a region's system, and the first block without a pivot or -1."""
    (base, _, _, fixed), pairs, graph, (vertex_block, _, levers), _ = problem
    own, upper = assemble(base, fixed, pairs, graph, (vertex_block, levers, kn, ks))
    return ldlt.exact(pattern, own, upper)


@kernel()
def _gone_on(problem, point, direction, decrement):
    """Return the point to which an exact line search leads, and evaluations."""
    system, _, graph, contacts, springs = problem
    vertex_block, edge_block, levers = contacts
    d, gap, slip, normal, shear, _, _, _, _ = point
    opening, sliding = contact_motions(vertex_block, edge_block, levers, direction)
    line = gap, opening, slip, sliding
    only, start = np.zeros(len(gap), np.int64), np.full(1, -decrement)
    smooth = start + works(normal, opening, shear, sliding, only, 1)
    bend = np.full(1, form(system[0], direction))
    length, evaluations = lengths_along(only, line, springs, smooth, bend, start)
    for i in range(len(d)):
        put_row(d, i, plus_scaled(row(d, i), length[0], row(direction, i)))
    gap, slip, normal, shear, kn, ks = answers(only, length, line, springs)
    residual, left = unbalanced(system, graph, (vertex_block, levers), d, normal, shear)
    return (d, gap, slip, normal, shear, kn, ks, residual, left), evaluations


@kernel()
def _minimum(problem, point, enough, iterations):
    """Return the point within ``enough`` of a region's minimum, what is left, and what it took.

    By as many ``iterations`` at most; or the point from which it does not go on, where there is no
    direction that is as good as exact.
    """
    pattern, evaluations = _pattern(problem), 0
    for k in range(iterations):
        left = sum_of(point[8])
        if left <= enough:
            return point, left, k, evaluations
        factor, bad = _factor(problem, pattern, point[5], point[6])
        if bad >= 0:
            return point, left, k, evaluations
        residual = point[7]
        direction = ldlt.solve(factor, residual)  # 0 for the fixed block
        decrement = dot(residual, direction)
        if not 0.0 < decrement < np.inf:
            return point, left, k, evaluations
        point, tries = _gone_on(problem, point, direction, decrement)
        evaluations += tries
        if decrement <= enough:
            return point, min(decrement, sum_of(point[8])), k + 1, evaluations
    return point, sum_of(point[8]), iterations, evaluations


@kernel()
def _minimise_one(blocks, place, problem, point, enough, most):
    """Minimise a region in place; return what is left, iterations and evaluations."""
    own_problem, own_point, source = copied(blocks, place, problem, point)
    found, left, iterations, evaluations = _minimum(own_problem, own_point, enough, most)
    put_back(blocks, source, found, point)
    return left, iterations, evaluations


@kernel(parallel=True)
def _minimise_shared(
    wanted, listing, system, pairs, graph, contacts, springs, point, enough, most, left, counts
):
    start, blocks, place = listing
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for k in to_do(thread, progress, len(wanted)):
            r = wanted[k]
            problem = system, pairs, graph, contacts, springs
            left[r], counts[k, 0], counts[k, 1] = _minimise_one(
                blocks[start[r] : start[r + 1]], place, problem, point, enough, most
            )


@kernel()
def minimise(wanted, listing, problem, point, enough, most, left):
    """Minimise the regions ``wanted`` (k,) in place; return iterations and evaluations (k, 2).

    ``listing`` is what :func:`listed` returns, ``problem`` and ``point`` are described in
    minimise/one_island.py.  What regions have ``left`` (r,), J/m, is written for those wanted: at
    most ``enough``, unless a region takes more than ``most`` iterations, or its system is singular.
    """
    start, blocks, place = listing
    counts, together = np.zeros((len(wanted), 2), np.int64), 0
    for r in wanted:
        together += start[r + 1] - start[r]
    if len(wanted) > 1 and together >= WORTH:
        _minimise_shared(wanted, listing, *problem, point, enough, most, left, counts)
        return counts
    for k in range(len(wanted)):
        r = wanted[k]
        left[r], counts[k, 0], counts[k, 1] = _minimise_one(
            blocks[start[r] : start[r + 1]], place, problem, point, enough, most
        )
    return counts
