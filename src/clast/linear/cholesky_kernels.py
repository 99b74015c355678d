"""Multifrontal Cholesky factorisation of a symmetric matrix of 6 x 6 blocks.

Everything that depends on the pattern alone is done once (:func:`analyse`); the numbers then go
through dense fronts (Duff and Reid 1983), which are kept in upper triangular rows so that every
inner loop runs along memory.  The order of all sums is fixed: the answer repeats bit for bit.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.linear.ordering import nested_dissection

WIDTH = 6
"""Unknowns of a block."""
PANEL = 24
"""Rows that are eliminated together in a front."""


@kernel()
def tree(start, neighbour, place, order):
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
def _postorder(parent):
    """Return the columns so that every subtree stands together, children first."""
    count = len(parent)
    first_child = np.full(count, -1, np.int64)
    sibling = np.full(count, -1, np.int64)
    for column in range(count - 1, -1, -1):
        above = parent[column]
        if above >= 0:
            sibling[column] = first_child[above]
            first_child[above] = column
    result = np.empty(count, np.int64)
    stack = np.empty(count, np.int64)
    found = 0
    for root in range(count):
        if parent[root] >= 0:
            continue
        stack[0], depth = root, 1
        while depth > 0:
            column = stack[depth - 1]
            child = first_child[column]
            if child >= 0:
                first_child[column] = sibling[child]
                stack[depth] = child
                depth += 1
            else:
                result[found] = column
                found += 1
                depth -= 1
    return result


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
def structures(start, neighbour, place, order, parent):
    """Return row starts (n + 1,) and rows below the diagonal of every column of the factor."""
    count = len(order)
    row_start = np.zeros(count + 1, np.int64)
    rows = np.empty(max(16, 8 * len(neighbour)), np.int64)
    mark = np.full(count, -1, np.int64)
    child = np.full(count, -1, np.int64)
    sibling = np.full(count, -1, np.int64)
    for column in range(count):
        found = row_start[column]
        mark[column] = column
        node = order[column]
        room = start[node + 1] - start[node]
        one = child[column]
        while one >= 0:
            room += row_start[one + 1] - row_start[one]
            one = sibling[one]
        if found + room > len(rows):
            larger = np.empty(2 * len(rows) + room, np.int64)
            for at in range(found):
                larger[at] = rows[at]
            rows = larger
        for at in range(start[node], start[node + 1]):
            row = place[neighbour[at]]
            if row > column and mark[row] != column:
                mark[row] = column
                rows[found] = row
                found += 1
        one = child[column]
        while one >= 0:
            for at in range(row_start[one], row_start[one + 1]):
                row = rows[at]
                if row > column and mark[row] != column:
                    mark[row] = column
                    rows[found] = row
                    found += 1
            one = sibling[one]
        _sort(rows, row_start[column], found)
        row_start[column + 1] = found
        above = parent[column]
        if above >= 0:
            sibling[column] = child[above]
            child[above] = column
    return row_start, rows


@kernel()
def _fronts(parent, row_start):
    """Return the first column of each front (s + 1,): runs of columns with almost the same rows.

    A column joins the front before it where few zeros are stored by that: a small front may hold
    more of them, because what it costs is hardly arithmetic.
    """
    count = len(parent)
    first = np.zeros(count + 1, np.int64)
    fronts, zeros = 0, 0
    for column in range(count):
        if column > 0 and parent[column - 1] == column:
            begin = first[fronts - 1]
            own = row_start[column + 1] - row_start[column]
            before = row_start[column] - row_start[column - 1]
            width = column - begin
            more = width * (own + 1 - before)
            size = (width + 1) * (own + 1 + width)
            if zeros + more <= (0.4 if width < 4 else 0.15 if width < 16 else 0.05) * size:
                zeros += more
                continue
        first[fronts] = column
        fronts += 1
        zeros = 0
    first[fronts] = count
    return first[: fronts + 1]


@kernel()
def _front_rows(first, row_start, rows):
    """Return starts (s + 1,) and rows of every front: its own columns, then those below."""
    fronts = len(first) - 1
    start = np.zeros(fronts + 1, np.int64)
    for f in range(fronts):
        last = first[f + 1] - 1
        start[f + 1] = start[f] + (last + 1 - first[f]) + (row_start[last + 1] - row_start[last])
    front_rows = np.empty(start[fronts], np.int64)
    for f in range(fronts):
        at = start[f]
        for column in range(first[f], first[f + 1]):
            front_rows[at] = column
            at += 1
        last = first[f + 1] - 1
        for k in range(row_start[last], row_start[last + 1]):
            front_rows[at] = rows[k]
            at += 1
    return start, front_rows


@kernel()
def _relations(first, start, front_rows, count):
    """Return the parent front of each front (-1: root) and where its lower rows stand in it."""
    fronts = len(first) - 1
    front_of = np.empty(count, np.int64)
    for f in range(fronts):
        for column in range(first[f], first[f + 1]):
            front_of[column] = f
    above = np.full(fronts, -1, np.int64)
    relative = np.zeros(len(front_rows), np.int64)
    position = np.zeros(count, np.int64)
    for f in range(fronts):
        low = start[f] + first[f + 1] - first[f]
        if low == start[f + 1]:
            continue
        g = front_of[front_rows[low]]
        above[f] = g
        for k in range(start[g], start[g + 1]):
            position[front_rows[k]] = k - start[g]
        for k in range(low, start[f + 1]):
            relative[k] = position[front_rows[k]]
    return above, relative, front_of


@kernel()
def _entries(pairs, coupled, place, front_of, first, start, front_rows):
    """Return where each pair's block goes: front, row and column in it, and if it is turned."""
    where = np.full((len(pairs), 3), -1, np.int64)
    for q in range(len(pairs)):
        if not coupled[q]:
            continue
        a, b = place[pairs[q, 0]], place[pairs[q, 1]]
        low, high = min(a, b), max(a, b)
        f = front_of[low]
        at, behind = start[f], start[f + 1]
        while at < behind:
            middle = (at + behind) // 2
            if front_rows[middle] < high:
                at = middle + 1
            else:
                behind = middle
        where[q, 0] = low - first[f]
        where[q, 1] = at - start[f]
        where[q, 2] = 1 if a > b else 0
    return where


@kernel()
def inverse_of(order):
    """Return the place of each block in the order."""
    place = np.empty(len(order), np.int64)
    for column in range(len(order)):
        place[order[column]] = column
    return place


@kernel()
def _pairs_of_fronts(fronts, pairs, coupled, place, front_of):
    """Return the pairs by front: starts (s + 1,) and list."""
    pair_start = np.zeros(fronts + 1, np.int64)
    for q in range(len(pairs)):
        if coupled[q]:
            pair_start[front_of[min(place[pairs[q, 0]], place[pairs[q, 1]])] + 1] += 1
    for f in range(fronts):
        pair_start[f + 1] += pair_start[f]
    fill = np.empty(fronts, np.int64)
    for f in range(fronts):
        fill[f] = pair_start[f]
    listed = np.empty(pair_start[fronts], np.int64)
    for q in range(len(pairs)):
        if coupled[q]:
            f = front_of[min(place[pairs[q, 0]], place[pairs[q, 1]])]
            listed[fill[f]] = q
            fill[f] += 1
    return pair_start, listed


@kernel()
def sizes(first, front_start, above):
    """Return where each front's rows start in the factor (s + 1,), stack size, largest front."""
    fronts = len(first) - 1
    value_start = np.zeros(fronts + 1, np.int64)
    stack, highest, largest = 0, 0, 0
    waiting = np.zeros(fronts, np.int64)
    for f in range(fronts):
        size = WIDTH * (front_start[f + 1] - front_start[f])
        own = WIDTH * (first[f + 1] - first[f])
        value_start[f + 1] = value_start[f] + own * size
        stack -= waiting[f]
        left = (size - own) * (size - own)
        if above[f] >= 0:
            stack += left
            waiting[above[f]] += left
        highest = max(highest, stack)
        largest = max(largest, size)
    return value_start, highest, largest


@kernel()
def analyse(count, pairs, coupled):
    """Return all that the factorisation of a pattern needs; ``coupled`` (q,) pairs count.

    Order (n,) of the blocks, first column of each front, front row starts, front rows, parents,
    relative rows, entries of the pairs (q, 3), pairs by front (starts, list), and what
    :func:`sizes` returns.
    """
    start, neighbour, order = nested_dissection(count, pairs, coupled)
    parent = tree(start, neighbour, inverse_of(order), order)
    order = order[_postorder(parent)]
    place = inverse_of(order)
    parent = tree(start, neighbour, place, order)
    row_start, rows = structures(start, neighbour, place, order, parent)
    first = _fronts(parent, row_start)
    front_start, front_rows = _front_rows(first, row_start, rows)
    above, relative, front_of = _relations(first, front_start, front_rows, count)
    where = _entries(pairs, coupled, place, front_of, first, front_start, front_rows)
    pair_start, listed = _pairs_of_fronts(len(first) - 1, pairs, coupled, place, front_of)
    pattern = order, first, front_start, front_rows, above, relative, where, pair_start, listed
    return pattern, sizes(first, front_start, above)


@kernel()
def _eliminate(front, size, own):
    """Factorise the first ``own`` rows of an upper triangular front (size, size) in place.

    Returns False where the front is not positive definite.  What is left below is the update
    matrix of the front.
    """
    for begin in range(0, own, PANEL):
        end = min(begin + PANEL, own)
        for c in range(begin, end):
            pivot = front[c, c]
            if not pivot > 0.0:
                return False
            scale = 1.0 / np.sqrt(pivot)
            for j in range(c, size):
                front[c, j] *= scale
            for i in range(c + 1, end):
                factor = front[c, i]
                if factor != 0.0:
                    for j in range(i, size):
                        front[i, j] -= factor * front[c, j]
        _update(front, begin, end, size)
    return True


@kernel(fastmath={"contract"})
def _update(front, begin, end, size):
    """Take the rows ``begin`` to ``end`` off all rows after them, two rows at a time."""
    i = end
    while i + 2 <= size:
        k = begin
        while k + 4 <= end:
            a0, b0, c0, d0 = front[k, i], front[k + 1, i], front[k + 2, i], front[k + 3, i]
            a1, b1 = front[k, i + 1], front[k + 1, i + 1]
            c1, d1 = front[k + 2, i + 1], front[k + 3, i + 1]
            front[i, i] -= a0 * a0 + b0 * b0 + c0 * c0 + d0 * d0
            for j in range(i + 1, size):
                a, b, c, d = front[k, j], front[k + 1, j], front[k + 2, j], front[k + 3, j]
                front[i, j] -= a0 * a + b0 * b + c0 * c + d0 * d
                front[i + 1, j] -= a1 * a + b1 * b + c1 * c + d1 * d
            k += 4
        while k < end:
            a0, a1 = front[k, i], front[k, i + 1]
            front[i, i] -= a0 * a0
            for j in range(i + 1, size):
                front[i, j] -= a0 * front[k, j]
                front[i + 1, j] -= a1 * front[k, j]
            k += 1
        i += 2
    while i < size:
        for k in range(begin, end):
            a0 = front[k, i]
            for j in range(i, size):
                front[i, j] -= a0 * front[k, j]
        i += 1


@kernel()
def _gather(front, f, diagonal, upper, order, first, where, pair_start, listed):
    """Add the blocks of the matrix that belong to front f; upper triangle."""
    for column in range(first[f], first[f + 1]):
        base = WIDTH * (column - first[f])
        node = order[column]
        for a in range(WIDTH):
            for b in range(a, WIDTH):
                front[base + a, base + b] += diagonal[node, a, b]
    for at in range(pair_start[f], pair_start[f + 1]):
        q = listed[at]
        row, column = WIDTH * where[q, 0], WIDTH * where[q, 1]
        if where[q, 2] == 0:
            for a in range(WIDTH):
                for b in range(WIDTH):
                    front[row + a, column + b] += upper[q, a, b]
        else:
            for a in range(WIDTH):
                for b in range(WIDTH):
                    front[row + a, column + b] += upper[q, b, a]


@kernel()
def _extend(front, update, height, relative, low, blocks):
    """Add a child's update matrix, stacked from ``height`` on, to its parent's front."""
    size = WIDTH * blocks
    for p in range(blocks):
        row = WIDTH * relative[low + p]
        for a in range(WIDTH):
            line = height + (WIDTH * p + a) * size
            for b in range(a, WIDTH):
                front[row + a, row + b] += update[line + WIDTH * p + b]
            for q in range(p + 1, blocks):
                column = WIDTH * relative[low + q]
                for b in range(WIDTH):
                    front[row + a, column + b] += update[line + WIDTH * q + b]


@kernel()
def factorise(
    diagonal,
    upper,
    order,
    first,
    front_start,
    above,
    relative,
    where,
    pair_start,
    listed,
    value_start,
    highest,
    largest,
):
    """Return the rows of U, K = U^T U, front by front; and False where K is not definite."""
    fronts = len(first) - 1
    values = np.empty(value_start[fronts])
    stack = np.empty(highest)
    height = np.empty(fronts, np.int64)
    store = np.empty(largest * largest)
    child = np.full(fronts, -1, np.int64)
    sibling = np.full(fronts, -1, np.int64)
    top = 0
    for f in range(fronts):
        blocks = front_start[f + 1] - front_start[f]
        size, own = WIDTH * blocks, WIDTH * (first[f + 1] - first[f])
        front = store[: size * size].reshape(size, size)
        for a in range(size):
            for b in range(a, size):
                front[a, b] = 0.0
        _gather(front, f, diagonal, upper, order, first, where, pair_start, listed)
        one = child[f]
        while one >= 0:
            low = front_start[one] + first[one + 1] - first[one]
            _extend(front, stack, height[one], relative, low, front_start[one + 1] - low)
            top = min(top, height[one])
            one = sibling[one]
        if not _eliminate(front, size, own):
            return values, False
        at = value_start[f]
        for a in range(own):
            for b in range(a, size):
                values[at + a * size + b] = front[a, b]
        if above[f] >= 0:
            height[f] = top
            left = size - own
            for a in range(left):
                line = top + a * left
                for b in range(a, left):
                    stack[line + b] = front[own + a, own + b]
            top += left * left
            sibling[f] = child[above[f]]
            child[above[f]] = f
    return values, True


@kernel(fastmath={"reassoc", "contract"})
def _dot(values, at, x, begin, end):
    """Return the product of a row of U from ``begin`` on with x."""
    total = 0.0
    for k in range(begin, end):
        total += values[at + k] * x[k]
    return total


@kernel()
def solve(values, order, first, front_start, front_rows, value_start, force):
    """Return d (n, 6) of U^T U d = F."""
    count, fronts = len(order), len(first) - 1
    x = np.empty((count, WIDTH))
    for column in range(count):
        for a in range(WIDTH):
            x[column, a] = force[order[column], a]
    widest = 0
    for f in range(fronts):
        widest = max(widest, front_start[f + 1] - front_start[f])
    local = np.empty(WIDTH * widest)
    for f in range(fronts):
        blocks = front_start[f + 1] - front_start[f]
        size, own = WIDTH * blocks, WIDTH * (first[f + 1] - first[f])
        for k in range(blocks):
            row = front_rows[front_start[f] + k]
            for a in range(WIDTH):
                local[WIDTH * k + a] = x[row, a]
        for c in range(own):
            at = value_start[f] + c * size
            local[c] /= values[at + c]
            known = local[c]
            for k in range(c + 1, size):
                local[k] -= known * values[at + k]
        for k in range(blocks):
            row = front_rows[front_start[f] + k]
            for a in range(WIDTH):
                x[row, a] = local[WIDTH * k + a]
    for f in range(fronts - 1, -1, -1):
        blocks = front_start[f + 1] - front_start[f]
        size, own = WIDTH * blocks, WIDTH * (first[f + 1] - first[f])
        for k in range(blocks):
            row = front_rows[front_start[f] + k]
            for a in range(WIDTH):
                local[WIDTH * k + a] = x[row, a]
        for c in range(own - 1, -1, -1):
            at = value_start[f] + c * size
            local[c] = (local[c] - _dot(values, at, local, c + 1, size)) / values[at + c]
        for k in range(own // WIDTH):
            row = front_rows[front_start[f] + k]
            for a in range(WIDTH):
                x[row, a] = local[WIDTH * k + a]
    result = np.empty((count, WIDTH))
    for column in range(count):
        for a in range(WIDTH):
            result[order[column], a] = x[column, a]
    return result


@kernel()
def coupled_pairs(diagonal, pairs):
    """Return False (q,) for pairs with a block that is held: its equations read s d = 0."""
    held = np.ones(len(diagonal), np.bool_)
    for b in range(len(diagonal)):
        for a in range(WIDTH):
            for c in range(WIDTH):
                wanted = diagonal[b, 0, 0] if a == c else 0.0
                if diagonal[b, a, c] != wanted:
                    held[b] = False
    result = np.empty(len(pairs), np.bool_)
    for q in range(len(pairs)):
        result[q] = not (held[pairs[q, 0]] or held[pairs[q, 1]])
    return result
