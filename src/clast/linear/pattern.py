"""Patterns of a factor: which blocks it has, in which order, without fill or with all of it.

A pattern is (order, begin, pairs, right, left, listed, source): the blocks in the order of their
elimination (n,); where its strips begin and then the segments of the seam (2 strips + 1,)
(linear/ordering.py); the pairs of the factor (p, 2) by places in that order, i < j, sorted, and
their rows (linear/block_matrix.py), which are short integers, to be read over and over; and from
which pair of K each one comes (p,): its number, minus that minus one where its blocks have changed
sides, FILL where K has none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, shared
from clast.linear import ordering
from clast.linear.system import BlockSystem
from clast.model.model import Bools, Ints

Found = TypeVar("Found")
FILL = np.iinfo(np.int64).min
"""Source of a pair that K does not have."""


@kernel()
def inverse_of(order):
    """Return the place of each block in the order."""
    place = np.empty(len(order), np.int64)
    for column in range(len(order)):
        place[order[column]] = column
    return place


# Without fill ------------------------------------------------------------------------------------


@shared(BLOCKS)
def _count_rows(low, high, places, pairs, rows, coupled, right, left):
    """Write how many coupled pairs begin and end with each place."""
    order, place = places
    first, last, listed = rows
    for k in range(low, high):
        i, after, before = order[k], 0, 0
        for q in range(first[i], first[i + 1]):
            if coupled[q]:
                later = place[pairs[q, 1]] > k
                after, before = after + later, before + (not later)
        for at in range(last[i], last[i + 1]):
            if coupled[listed[at]]:
                later = place[pairs[listed[at], 0]] > k
                after, before = after + later, before + (not later)
        right[k + 1], left[k + 1] = after, before


@kernel()
def _insert(first, at, high, number, new, source):
    """Insert the pair that ends with ``high`` into those from ``first`` to ``at`` - 1, ascending.

    They all begin with the same block.
    """
    low = new[at, 0]
    while at > first and new[at - 1, 1] > high:
        new[at, 1], source[at] = new[at - 1, 1], source[at - 1]
        at -= 1
    new[at, 0], new[at, 1], source[at] = low, high, number


@shared(BLOCKS)
def _fill_rows(low, high, order, place, pairs, rows, coupled, filled):
    """Write the coupled pairs that begin with each place, sorted."""
    right, left, listed = rows
    start, new, source = filled
    for k in range(low, high):
        i, at = order[k], start[k]
        for q in range(right[i], right[i + 1]):
            other = place[pairs[q, 1]]
            if coupled[q] and other > k:
                new[at, 0] = k
                _insert(start[k], at, other, q, new, source)
                at += 1
        for e in range(left[i], left[i + 1]):
            q = listed[e]
            other = place[pairs[q, 0]]
            if coupled[q] and other > k:
                new[at, 0] = k
                _insert(start[k], at, other, -1 - q, new, source)
                at += 1


@kernel()
def _listed(pairs, left):
    """Return the pairs (., k) of each place, in ascending order."""
    at = left[:-1].copy()
    listed = np.empty(len(pairs), np.int32)
    for q in range(len(pairs)):
        k = pairs[q, 1]
        listed[at[k]] = q
        at[k] += 1
    return listed


@kernel()
def without_fill(order, begin, pairs, rows, coupled):
    """Return the pattern of the ``coupled`` (q,) of ``pairs`` (q, 2) in an order, without fill.

    ``rows`` are right, left and listed of the pairs (linear/block_matrix.py).
    """
    count, place = len(order), inverse_of(order)
    right, left = np.zeros(count + 1, np.int32), np.zeros(count + 1, np.int32)
    _count_rows(count, (order, place), pairs, rows, coupled, right, left)
    for k in range(count):
        right[k + 1] += right[k]
        left[k + 1] += left[k]
    new, source = np.empty((right[-1], 2), np.int32), np.empty(right[-1], np.int64)
    _fill_rows(count, order, place, pairs, rows, coupled, (right, new, source))
    return order, begin, new, right, left, _listed(new, left), source


# With all fill -----------------------------------------------------------------------------------


@kernel()
def _tree(start, neighbour, place, order):
    """Return the parent of each column in the elimination tree (Liu 1990), -1 for roots."""
    count = len(order)
    parent = np.full(count, -1, np.int64)
    ancestor = np.full(count, -1, np.int64)
    for column in range(count):
        node = order[column]
        for at in range(start[node], start[node + 1]):
            row = place[neighbour[at]]
            while row != -1 and row < column:
                following = ancestor[row]
                ancestor[row] = column
                if following == -1:
                    parent[row] = column
                row = following
    return parent


@kernel()
def _sort(rows, low, high):
    """Sort a short piece of rows in place."""
    for k in range(low + 1, high):
        row, at = rows[k], k
        while at > low and rows[at - 1] > row:
            rows[at] = rows[at - 1]
            at -= 1
        rows[at] = row


@kernel()
def _structures(start, neighbour, place, order, parent):
    """Return row starts (n + 1,) and rows below the diagonal of every column of the factor.

    A column has the rows of K and those of its children in the elimination tree (George and Liu
    1981).
    """
    count = len(order)
    row_start = np.zeros(count + 1, np.int32)
    rows = np.empty(max(16, 8 * len(neighbour)), np.int32)
    mark = np.full(count, -1, np.int64)
    child = np.full(count, -1, np.int64)
    sibling = np.full(count, -1, np.int64)
    for column in range(count):
        end = row_start[column]
        mark[column] = column
        node = order[column]
        room = start[node + 1] - start[node]
        one = child[column]
        while one >= 0:
            room += row_start[one + 1] - row_start[one]
            one = sibling[one]
        if end + room > len(rows):
            larger = np.empty(2 * len(rows) + room, np.int32)
            for at in range(end):
                larger[at] = rows[at]
            rows = larger
        for at in range(start[node], start[node + 1]):
            row = place[neighbour[at]]
            if row > column and mark[row] != column:
                mark[row] = column
                rows[end] = row
                end += 1
        one = child[column]
        while one >= 0:
            for at in range(row_start[one], row_start[one + 1]):
                row = rows[at]
                if row > column and mark[row] != column:
                    mark[row] = column
                    rows[end] = row
                    end += 1
            one = sibling[one]
        _sort(rows, row_start[column], end)
        row_start[column + 1] = end
        above = parent[column]
        if above >= 0:
            sibling[column] = child[above]
            child[above] = column
    return row_start, rows


@kernel()
def _place_of(row, low, high, pairs):
    """Return which of the pairs ``low`` to ``high`` - 1 ends with ``row``."""
    while low < high:
        middle = (low + high) // 2
        if pairs[middle, 1] < row:
            low = middle + 1
        else:
            high = middle
    return low


@kernel()
def with_fill(count, pairs, coupled):
    """Return the pattern of the ``coupled`` (q,) of ``pairs`` (q, 2) with all fill, in one strip.

    In the order of nested dissection (linear/ordering.py).
    """
    start, neighbour, order = ordering.nested_dissection(count, pairs, coupled)
    place = inverse_of(order)
    parent = _tree(start, neighbour, place, order)
    right, rows = _structures(start, neighbour, place, order, parent)
    new, source = np.empty((right[-1], 2), np.int32), np.full(right[-1], FILL, np.int64)
    for column in range(count):
        for at in range(right[column], right[column + 1]):
            new[at, 0], new[at, 1] = column, rows[at]
    for q in range(len(pairs)):
        if coupled[q]:
            a, b = place[pairs[q, 0]], place[pairs[q, 1]]
            low, high = min(a, b), max(a, b)
            at = _place_of(high, right[low], right[low + 1], new)
            source[at] = q if a < b else -1 - q
    left = np.zeros(count + 1, np.int32)
    for at in range(len(new)):
        left[new[at, 1] + 1] += 1
    for column in range(count):
        left[column + 1] += left[column]
    return order, np.array([0, count, count]), new, right, left, _listed(new, left), source


# What is kept of them ----------------------------------------------------------------------------


def may_be_coupled(system: BlockSystem) -> Bools:
    """Return which pairs (q,) have no fixed block: those of which K may have something."""
    free = ~system.fixed
    return np.asarray(free[system.pairs[:, 0]] & free[system.pairs[:, 1]])


def exact_pattern(system: BlockSystem) -> tuple[Any, ...]:
    """Return the pattern with all fill of every pair that may be coupled."""
    pattern: tuple[Any, ...] = with_fill(len(system.diagonal), system.pairs, may_be_coupled(system))
    return pattern


def strips_of(system: BlockSystem) -> tuple[Ints, Ints]:
    """Return the blocks strip by strip (n,) and where the strips begin (linear/ordering.py)."""
    return ordering.strips(system.centroid, system.pairs, may_be_coupled(system))


class Patterns:
    """Data that depend on the pairs and the places of the blocks alone, of the last few systems.

    The matrices of a step share it; whoever owns a step or a run owns one of these, and may throw
    it away at any time.
    """

    def __init__(self, kept: int = 4) -> None:
        self._kept = kept
        self._known: list[tuple[tuple[Any, ...], dict[Callable[..., Any], Any]]] = []

    def of(self, system: BlockSystem, analysis: Callable[[BlockSystem], Found]) -> Found:
        """Return the result of an analysis, or the earlier one for the same pairs and places."""
        results = self._results_for((system.pairs, system.centroid, system.fixed))
        if analysis not in results:
            results[analysis] = analysis(system)
        known: Found = results[analysis]
        return known

    def _results_for(self, key: tuple[Any, ...]) -> dict[Callable[..., Any], Any]:
        """Return the results for these arrays, which nobody changes, to be added to."""
        for other, results in self._known:
            if all(
                one is its or np.array_equal(one, its) for one, its in zip(key, other, strict=True)
            ):
                return results
        self._known = [(key, {}), *self._known[: self._kept - 1]]
        return self._known[0][1]
