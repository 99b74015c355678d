"""The coarse system of aggregates beside an incomplete factor: what moves many blocks together.

An incomplete factor settles what neighbours do to each other, and takes many iterations for what
moves many blocks at once.  That is left to a system of aggregates of blocks (linear/aggregates.py)
which is solved exactly, and the two are added (Nicolaides 1987; Bramble, Pasciak and Xu 1990):

    B = (L D L^T)^-1 + P (P^T K P)^-1 P^T

B is positive definite as both of its parts are, whatever has been rounded in them.

Which aggregates there are, and which of them are coupled, is known for a whole step.  They are
eliminated in the order of nested dissection, with all fill, so that a factor of theirs is one like
an incomplete factor, of which nothing is left out: it has one strip and no seam.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.vec6 import put_line, with_number, zeros
from clast.linear.aggregates import centres, coarse_matrix, coarse_pairs, members_of
from clast.linear.block_matrix import row_pointers
from clast.linear.cholesky_kernels import inverse_of, structures, tree
from clast.linear.incomplete import eliminate
from clast.linear.ordering import nested_dissection


@kernel()
def filled(count, pairs):
    """Return the order of elimination (count,) and the pairs of its factor (Q, 2), sorted.

    ``pairs`` (q, 2) are those that are coupled; the factor's are by places in the order.
    """
    start, neighbour, order = nested_dissection(count, pairs, np.ones(len(pairs), np.bool_))
    place = inverse_of(order)
    first, rows = structures(start, neighbour, place, order, tree(start, neighbour, place, order))
    found = np.empty((first[-1], 2), np.int32)
    for column in range(count):
        for at in range(first[column], first[column + 1]):
            found[at, 0], found[at, 1] = column, rows[at]
    return order, found


@kernel()
def arranged(centroid, aggregate, number, pairs, rows):
    """Return the aggregates in the order of their elimination, and their pairs.

    ``aggregate`` (n,) is that of each block, 0 to ``number`` - 1; ``pairs`` (q, 2) are all that may
    be coupled and ``rows`` their right, left and listed.  Returned are the place of each block's
    aggregate (n,), its centroid's offset (n, 2) from the aggregate's, m, the pairs of the
    aggregates' factor (Q, 2) and their right, left and listed.
    """
    start, members = members_of(aggregate, number)
    coupled = coarse_pairs(pairs, *rows, aggregate, start, members)
    order, found = filled(number, coupled)
    _, offset = centres(start, members, centroid)
    return inverse_of(order)[aggregate], offset, found, row_pointers(number, found)


@kernel()
def _placed(order, aggregate, offset, number, right, left):
    """Return aggregate (n,), first member (number + 1,), members and offset in another order.

    Blocks without pairs have no aggregate: -1.
    """
    parent, moved = np.empty(len(order), np.int64), np.empty_like(offset)
    for k in range(len(order)):
        alone = right[k] == right[k + 1] and left[k] == left[k + 1]
        parent[k] = -1 if alone else aggregate[order[k]]
        moved[k, 0], moved[k, 1] = offset[order[k], 0], offset[order[k], 1]
    start, members = members_of(parent, number)
    return parent, start, members, moved


@kernel()
def factor(incomplete, matrix, aggregates):
    """Return the coarse system made ready, and whether it is positive definite.

    ``incomplete`` and ``matrix`` are a factor and its K (linear/incomplete.py), ``aggregates`` is
    what :func:`arranged` returns.  Made ready, it is (aggregate, start, members, offset, factor),
    the first four in the order of the incomplete factor, L of the last in single precision.
    """
    order, _, of_blocks, right, left, listed, _, _ = incomplete
    aggregate, offset, pairs, rows = aggregates
    number = len(rows[0]) - 1
    parts = _placed(order, aggregate, offset, number, right, left)
    own, upper = coarse_matrix(*matrix, of_blocks, right, left, listed, *parts, pairs)
    _, start, _, _ = parts
    for k in range(number):
        if start[k] == start[k + 1]:
            for a in range(6):
                put_line(own, k, a, with_number(zeros(), a, 1.0))
    inverse = np.empty(own.shape, matrix[0].dtype)
    scaled = np.empty(upper.shape, np.float32)
    as_they_are = np.arange(number)
    bad = eliminate(0, number, own.copy(), as_they_are, own, upper, pairs, rows[0], inverse, scaled)
    begin = np.array([0, number, number])
    return (*parts, (as_they_are, begin, pairs, *rows, inverse, scaled)), bad < 0
