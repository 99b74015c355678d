"""Islands: blocks that springs connect, and Newton's method on a small one by itself.

Blocks of two islands share no spring; blocks that stand still belong to none and connect nothing.
Each island has a minimum, a system and iterations of its own.  The data of a small one are copied
together and stay in the processor's cache from the first iteration to the last; threads take
islands one by one.

A problem is (system, links): B, B^-1 (n, 6, 6), the load (n, 6) and which blocks stand still (n,);
the pairs of blocks (q, 2), their graph (linear/assembly.py), vertex_block, edge_block (m,) and
arms of the springs, and these (Springs.arrays).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import EACH, borrowed, shared
from clast.compute.reductions import MANY, SHARED, sum_of
from clast.compute.vec6 import line, plus_scaled, put_line, put_row, row, zeros
from clast.contact.clipped_spring import Springs
from clast.contact.jacobian import relative_motion
from clast.linear import ldlt
from clast.linear.assembly import assemble, balance_rows, form
from clast.linear.block_matrix import dot, row_pointers
from clast.linear.pattern import with_fill
from clast.minimise.line_search import length_of_links, move_links
from clast.model.model import Bools, Floats, Ints


class IslandPoint(NamedTuple):
    """A point of the minimisation: displacements, and the springs and forces there."""

    displacement: Floats
    """d, shape (n, 6)."""
    gap: Floats
    """Gaps of the springs, m, shape (m,)."""
    slip: Floats
    """Their slips, m, shape (m,)."""
    normal: Floats
    """Their normal forces N, N/m, shape (m,)."""
    shear: Floats
    """Their shear forces T, N/m, shape (m,)."""
    kn: Floats
    """Stiffnesses against gaps, N/m per m, shape (m,)."""
    ks: Floats
    """Stiffnesses against slips, N/m per m, shape (m,)."""
    residual: Floats
    """Residual r of each block, shape (n, 6)."""
    distance: Floats
    """r.B^-1 r of each block, J/m, shape (n,)."""


@dataclass(frozen=True, kw_only=True)
class Islands:
    """Blocks that springs connect: the potential is a sum over islands."""

    count: int
    """Number of islands; the last holds the blocks that stand still."""
    of_blocks: Ints
    """Island of each block, shape (n,)."""
    of_links: Ints
    """Island of each link between blocks, shape (m,)."""

    @cached_property
    def listing(self) -> tuple[Ints, Ints, Ints]:
        """Where the blocks of each island begin (count + 1,), these, and their places (n,)."""
        start, blocks, place = listed(self.of_blocks, self.count)
        return start, blocks, place


def islands_of(springs: Springs, fixed: Bools) -> Islands:
    """Return the islands of blocks of which some are ``fixed`` (n,)."""
    of_blocks, count = connected(springs.pairs, fixed)
    ends = springs.vertex_block, springs.edge_block
    return Islands(
        count=count, of_blocks=of_blocks, of_links=islands_of_links(of_blocks, count, *ends)
    )


@kernel()
def _root(parent, i):
    """Return the first block of the tree that i is in, and shorten the path to it."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel()
def connected(pairs, fixed):
    """Return the island of each block, shape (n,), and their number; fixed blocks are in the last.

    ``pairs`` (q, 2) are the blocks that share springs.  Islands are numbered by their first block.
    """
    count = len(fixed)
    parent = np.arange(count)
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        if fixed[i] or fixed[j]:
            continue
        a, b = _root(parent, i), _root(parent, j)
        if a != b:
            parent[max(a, b)] = min(a, b)
    island = np.empty(count, np.int64)
    number = 0
    for i in range(count):
        if not fixed[i]:
            first = _root(parent, i)
            if first == i:
                island[i] = number
                number += 1
            else:
                island[i] = island[first]
    for i in range(count):
        if fixed[i]:
            island[i] = number
    return island, number + 1


@kernel()
def islands_of_links(island, count, vertex_block, edge_block):
    """Return the island of each link, shape (m,): of the one of its blocks that is not fixed.

    ``count`` is the number of islands; fixed blocks have the last.
    """
    result = np.empty(len(vertex_block), np.int64)
    for c in range(len(result)):
        own = island[vertex_block[c]]
        result[c] = own if own != count - 1 else island[edge_block[c]]
    return result


@kernel()
def listed(island, count):
    """Return where the blocks of each island begin (count + 1,), these, and their places (n,).

    ``island`` (n,) is that of each block.
    """
    start = np.zeros(count + 1, np.int64)
    for r in island:
        start[r + 1] += 1
    for r in range(count):
        start[r + 1] += start[r]
    at = start[:-1].copy()
    blocks, place = np.empty(len(island), np.int64), np.empty(len(island), np.int64)
    for i in range(len(island)):
        r = island[i]
        blocks[at[r]], place[i] = i, at[r] - start[r]
        at[r] += 1
    return start, blocks, place


@kernel()
def are_small(island, count, pairs, first, fixed, few, like_trees):
    """Return which of ``count`` islands are small (count,); the last, of fixed blocks, is not.

    Those of up to ``few`` blocks are, and those of up to ``like_trees`` pairs for each block.
    ``island`` (n,) is that of each block, ``first`` (q + 1,) the first link of each pair.
    """
    blocks, joins, links = np.zeros((3, count), np.int64)
    for r in island:
        blocks[r] += 1
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        r = island[j] if fixed[i] else island[i]
        joins[r] += not (fixed[i] or fixed[j])
        links[r] += first[q + 1] - first[q]
    small = np.empty(count, np.bool_)
    for r in range(count):
        simple = blocks[r] <= few or joins[r] <= like_trees * blocks[r]
        # what is called below must not want to be shared: the thread is one of several already
        small[r] = simple and blocks[r] + 1 < SHARED and links[r] < MANY
    small[count - 1] = False
    return small


@kernel()
def _size(blocks, pairs, graph, still):
    """Return how many pairs and links some blocks have; those within count once."""
    start, right, left, listed = graph
    joins, links = 0, 0
    for i in blocks:
        joins += right[i + 1] - right[i]
        links += start[right[i + 1]] - start[right[i]]
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            if still[pairs[q, 0]]:
                joins += 1
                links += start[q + 1] - start[q]
    return joins, links


@kernel()
def _add_pair(q, k, other, start, at, own, first, source):
    """Write pair q as that of the blocks k and ``other``, and its links."""
    own[at, 0], own[at, 1] = k, other
    place = first[at]
    for c in range(start[q], start[q + 1]):
        source[place] = c
        place += 1
    first[at + 1] = place


@kernel()
def _pairs_of(blocks, place, still, pairs, graph):
    """Return the pairs (q, 2) of some blocks, the first link of each, and where its links are."""
    start, right, left, listed = graph
    count = len(blocks)
    joins, links = _size(blocks, pairs, graph, still)
    own, first = np.empty((joins, 2), np.int64), np.zeros(joins + 1, np.int64)
    source, at = np.empty(links, np.int64), 0
    for k in range(count):
        i = blocks[k]
        for q in range(right[i], right[i + 1]):
            if not still[pairs[q, 1]]:
                _add_pair(q, k, place[pairs[q, 1]], start, at, own, first, source)
                at += 1
        for e in range(left[i], left[i + 1]):
            if still[pairs[listed[e], 0]]:
                _add_pair(listed[e], k, count, start, at, own, first, source)
                at += 1
        for q in range(right[i], right[i + 1]):
            if still[pairs[q, 1]]:
                _add_pair(q, k, count, start, at, own, first, source)
                at += 1
    return own, first, source


@kernel()
def _taken(values, source):
    """Return of numbers (m,) those of the links ``source``."""
    taken = np.empty(len(source))
    for c in range(len(source)):
        taken[c] = values[source[c]]
    return taken


@kernel()
def _rows_of(values, blocks):
    """Return of rows (n, 6) those of ``blocks``, and one of zeros."""
    taken = np.empty((len(blocks) + 1, 6))
    for k in range(len(blocks)):
        put_row(taken, k, row(values, blocks[k]))
    put_row(taken, len(blocks), zeros())
    return taken


@kernel()
def _blocks_of(values, blocks):
    """Return of blocks (n, 6, 6) those of ``blocks``, and one more, as good as any."""
    count = len(blocks)
    taken = np.empty((count + 1, 6, 6))
    for k in range(count + 1):
        i = blocks[k] if k < count else 0
        for a in range(6):
            put_line(taken, k, a, line(values, i, a))
    return taken


@kernel()
def _arms_of(arms, source):
    """Return of arms (m, 6) those of the links ``source``."""
    taken = np.empty((len(source), 6))
    for c in range(len(source)):
        put_row(taken, c, row(arms, source[c]))
    return taken


@kernel()
def _ends_of(ends, source, place, still, last):
    """Return the numbers that the blocks of links ``source`` have among some blocks."""
    numbers = np.empty(len(source), np.int64)
    for c in range(len(source)):
        i = ends[source[c]]
        numbers[c] = last if still[i] else place[i]
    return numbers


@kernel()
def _springs_of(springs, source):
    """Return of springs (Springs.arrays) those of the links ``source``."""
    return (
        _taken(springs[0], source),
        _taken(springs[1], source),
        _taken(springs[2], source),
        _taken(springs[3], source),
        _taken(springs[4], source),
        _taken(springs[5], source),
        _taken(springs[6], source),
        _taken(springs[7], source),
    )


@kernel()
def _point_of(blocks, source, point):
    """Return the point of some blocks."""
    own_distance = np.zeros(len(blocks) + 1)
    for k in range(len(blocks)):
        own_distance[k] = point.distance[blocks[k]]
    return IslandPoint(
        _rows_of(point.displacement, blocks),
        _taken(point.gap, source),
        _taken(point.slip, source),
        _taken(point.normal, source),
        _taken(point.shear, source),
        _taken(point.kn, source),
        _taken(point.ks, source),
        _rows_of(point.residual, blocks),
        own_distance,
    )


@kernel()
def taken_out(blocks, place, still, problem, point):
    """Return the problem and the point of ``blocks`` (k,), and where their links are.

    ``place`` (n,) has their numbers among themselves, in their order.  All blocks that stand
    ``still`` (n,) are one, the last: it is wanted for nothing but that it does not move, for gaps
    and slips know where it is.
    """
    (base, inverse, load, _), (pairs, graph, ends, springs) = problem
    vertex_block, edge_block, arms = ends
    count = len(blocks)
    own_pairs, first, source = _pairs_of(blocks, place, still, pairs, graph)
    held = np.zeros(count + 1, np.bool_)
    held[count] = True
    system = _blocks_of(base, blocks), _blocks_of(inverse, blocks), _rows_of(load, blocks), held
    own_ends = (
        _ends_of(vertex_block, source, place, still, count),
        _ends_of(edge_block, source, place, still, count),
        _arms_of(arms, source),
    )
    own_springs = _springs_of(springs, source)
    links = own_pairs, (first, *row_pointers(count + 1, own_pairs)), own_ends, own_springs
    return (system, links), _point_of(blocks, source, IslandPoint(*point)), source


@kernel()
def put_back(blocks, source, moved, point):
    """Write the point ``moved`` of some blocks into that of all, both as plain tuples."""
    _write_point(blocks, source, IslandPoint(*moved), IslandPoint(*point))


@kernel()
def _write_point(blocks, source, moved, point):
    """Write the point of some blocks where it belongs."""
    for k in range(len(blocks)):
        put_row(point.displacement, blocks[k], row(moved.displacement, k))
        put_row(point.residual, blocks[k], row(moved.residual, k))
        point.distance[blocks[k]] = moved.distance[k]
    for k in range(len(source)):
        c = source[k]
        point.gap[c], point.slip[c] = moved.gap[k], moved.slip[k]
        point.normal[c], point.shear[c] = moved.normal[k], moved.shear[k]
        point.kn[c], point.ks[c] = moved.kn[k], moved.ks[k]


@kernel()
def _pattern(problem):
    """Return the pattern of the exact factor of an island: that of all pairs of free blocks."""
    (_, _, _, fixed), (pairs, _, _, _) = problem
    free = np.empty(len(pairs), np.bool_)
    for q in range(len(pairs)):
        free[q] = not (fixed[pairs[q, 0]] or fixed[pairs[q, 1]])
    return with_fill(len(fixed), pairs, free)


@kernel()
def _factor(problem, pattern, kn, ks):
    """Return the factor of an island's system, and the first block without a pivot or -1."""
    (base, _, _, fixed), (pairs, graph, (vertex_block, _, arms), _) = problem
    own, upper = assemble(base, fixed, pairs, graph, (vertex_block, arms, kn, ks))
    return ldlt.exact(pattern, own, upper)


@kernel()
def _search(problem, point, direction, decrement):
    """Move a point to where an exact line search leads; return evaluations."""
    system, (_, graph, (vertex_block, edge_block, arms), springs) = problem
    d, stretches = point.displacement, (point.gap, point.slip)
    forces, stiffnesses = (point.normal, point.shear), (point.kn, point.ks)
    links = np.arange(len(point.gap))
    motions, slope = np.empty((len(links), 2)), -decrement
    for c in links:
        opening, sliding = relative_motion(arms, c, direction, vertex_block[c], edge_block[c])
        motions[c, 0], motions[c, 1] = opening, sliding
        slope += point.normal[c] * opening + point.shear[c] * sliding
    bend = form(system[0], direction)
    length, evaluations = length_of_links(
        links, motions, springs, stretches, slope, bend, decrement
    )
    for i in range(len(d)):
        put_row(d, i, plus_scaled(row(d, i), length, row(direction, i)))
    move_links(links, motions, length, springs, stretches, forces, stiffnesses)
    balance = point.residual, point.distance
    balance_rows(len(d), system, graph, (vertex_block, arms), d, forces, balance)
    return evaluations


@kernel()
def _minimise_one(problem, point, pattern, tolerance, iterations):
    """Move a point near enough to an island's minimum; return distance, iterations, evaluations.

    To within ``tolerance``, J/m, by as many ``iterations`` at most; or to where there is no
    direction that is as good as exact.
    """
    problem, point, pattern = borrowed(problem), borrowed(point), borrowed(pattern)
    evaluations = 0
    for k in range(iterations):
        left = sum_of(point.distance)
        if left <= tolerance:
            return left, k, evaluations
        factor, bad = _factor(problem, pattern, point.kn, point.ks)
        if bad >= 0:
            return left, k, evaluations
        direction = ldlt.solve(factor, point.residual)  # 0 for the block that stands still
        decrement = dot(point.residual, direction)
        if not 0.0 < decrement < np.inf:
            return left, k, evaluations
        evaluations += _search(problem, point, direction, decrement)
        if decrement <= tolerance:
            return min(decrement, sum_of(point.distance)), k + 1, evaluations
    return sum_of(point.distance), iterations, evaluations


@shared(EACH)
def _minimise(first, last, which, problem, springs, point, limits, results):
    """Minimise islands; arrays that threads share are no tuples of tuples."""
    wanted, start, blocks, place = which
    links = problem[4], problem[5:9], problem[9:12], springs
    left, counts = results
    of_all = IslandPoint(*point)
    for k in range(first, last):
        r = wanted[k]
        own = blocks[start[r] : start[r + 1]]
        own_problem, own_point, source = taken_out(
            own, place, problem[3], (problem[:4], links), point
        )
        left[r], counts[k, 0], counts[k, 1] = _minimise_one(
            own_problem, own_point, _pattern(own_problem), limits[0], int(limits[1])
        )
        _write_point(own, source, own_point, of_all)


@kernel()
def minimise_each(wanted, listing, problem, point, limits, left):
    """Minimise the islands ``wanted`` (k,) in place; return the most iterations and evaluations.

    ``listing`` is that of ``Islands``, ``limits`` (2,) are the tolerance, J/m, of each island and
    the iterations that it may take.  The distance of islands from their minimum, ``left`` (r,),
    J/m, is written for those wanted: at most the tolerance, unless an island takes more iterations,
    or its system is singular.
    """
    counts = np.zeros((len(wanted), 2), np.int64)
    system, (pairs, graph, ends, springs) = problem
    flat = *system, pairs, *graph, *ends
    _minimise(len(wanted), (wanted, *listing), flat, springs, point, limits, (left, counts))
    return counts[:, 0].max(), counts[:, 1].max()
