"""Orders of elimination: by nested dissection with all fill, row by row in strips without any.

Nested dissection (George 1973) is that of the graph of coupled blocks.  Blocks with one neighbour
come first, again and again, so that chains and trees have no fill at all.  A part is cut across its
long direction.  The graph has no coordinates, but the distances from four blocks far apart serve as
such: their principal component runs along the part (compare landmark multidimensional scaling, de
Silva and Tenenbaum 2004), and its quantiles are straight cuts.  Only the pattern is used, so the
same pattern always gives the same order.

Without fill it matters that blocks near each other have places near each other, for strength as for
memory: blocks are ordered row by row along the shorter side of their common box.  As many blocks
each make a strip.  Those coupled to an earlier strip form the seam, which comes last, so that of
the rest no strip is coupled to another one: threads share the strips (one level of nested
dissection).  The seam keeps the order of the strips that its blocks were in: these are its
segments.  The number of strips depends on that of the blocks alone, and with it every sum.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.model.model import Bools, Floats, Ints

LEAST, MOST = 800, 16
"""Blocks from which there are two strips, four times as many having twice as many strips, for the
seam's share to be the same, and number of strips at most."""
LEAF = 4
"""Parts of at most this many blocks are not dissected further."""
LANDMARKS = 4
"""Blocks from which distances are measured."""
CUTS = 5
"""Places tried for the cut, from 0.42 to 0.58 of a part's blocks."""
HUB = 32
"""Blocks with more neighbours than this, and than six times the mean, are ordered last."""


@kernel()
def neighbours_of(count, pairs, coupled):
    """Return starts (n + 1,) and neighbours of every block."""
    start = np.zeros(count + 1, np.int64)
    for q in range(len(pairs)):
        if coupled[q]:
            start[pairs[q, 0] + 1] += 1
            start[pairs[q, 1] + 1] += 1
    for b in range(count):
        start[b + 1] += start[b]
    fill = np.empty(count, np.int64)
    for b in range(count):
        fill[b] = start[b]
    neighbour = np.empty(start[count], np.int64)
    for q in range(len(pairs)):
        if coupled[q]:
            i, j = pairs[q, 0], pairs[q, 1]
            neighbour[fill[i]] = j
            neighbour[fill[j]] = i
            fill[i] += 1
            fill[j] += 1
    return start, neighbour


@kernel()
def _distances(root, label, graph, room, stamp):
    """Fill ``queue`` with the blocks of part ``label`` by distance from ``root``; return how many.

    ``graph`` is the part of each block and the starts and neighbours of all; ``room`` the queue,
    ``level``, which holds their distance, and ``seen``, which marks them with ``stamp``.
    """
    part, start, neighbour = graph
    queue, level, seen = room
    queue[0] = root
    seen[root] = stamp
    level[root] = 0
    head, tail = 0, 1
    while head < tail:
        node = queue[head]
        head += 1
        for at in range(start[node], start[node + 1]):
            other = neighbour[at]
            if part[other] == label and seen[other] != stamp:
                seen[other] = stamp
                level[other] = level[node] + 1
                queue[tail] = other
                tail += 1
    return tail


@kernel()
def _coordinates(number, label, graph, room, stamp, distance):
    """Fill ``distance`` (k, number) with the distances of the queue's blocks from the landmarks.

    The queue holds a connected part as it was reached from its first block; its order stays.
    """
    queue, level, _ = room
    members = np.empty(number, np.int64)
    nearest = np.empty(number, np.int64)
    for m in range(number):
        members[m] = queue[m]
        nearest[m] = number + 1
    root = members[number - 1]
    for k in range(LANDMARKS):
        _distances(root, label, graph, room, stamp + k)
        far, best = 0, -1
        for m in range(number):
            distance[k, m] = level[members[m]]
            nearest[m] = min(nearest[m], level[members[m]])
            if nearest[m] > best:
                far, best = m, nearest[m]
        root = members[far]
    for m in range(number):
        queue[m] = members[m]
    return stamp + LANDMARKS


@kernel()
def _along(distance, number):
    """Return the first principal component of the distances from the landmarks, shape (number,)."""
    mean = np.zeros(LANDMARKS)
    for k in range(LANDMARKS):
        for m in range(number):
            mean[k] += distance[k, m]
        mean[k] /= number
    spread = np.zeros((LANDMARKS, LANDMARKS))
    for k in range(LANDMARKS):
        for other in range(k + 1):
            total = 0.0
            for m in range(number):
                total += (distance[k, m] - mean[k]) * (distance[other, m] - mean[other])
            spread[k, other] = spread[other, k] = total
    axis, following = np.empty(LANDMARKS), np.empty(LANDMARKS)
    for k in range(LANDMARKS):
        axis[k] = 1.0 if k == 0 else -0.25 * k
    for _ in range(60):
        size = 0.0
        for k in range(LANDMARKS):
            following[k] = 0.0
            for other in range(LANDMARKS):
                following[k] += spread[k, other] * axis[other]
            size += following[k] * following[k]
        if size == 0.0:
            break
        for k in range(LANDMARKS):
            axis[k] = following[k] / np.sqrt(size)
    value = np.zeros(number)
    for m in range(number):
        for k in range(LANDMARKS):
            value[m] += axis[k] * (distance[k, m] - mean[k])
    return value


@kernel()
def _ranks(value, number):
    """Return the place (number,) of each value in their order, to within a fine grid of values."""
    low, high = value[0], value[0]
    for m in range(number):
        low, high = min(low, value[m]), max(high, value[m])
    buckets = 4 * number
    scale = (buckets - 1) / (high - low) if high > low else 0.0
    first = np.zeros(buckets + 1, np.int64)
    for m in range(number):
        first[int((value[m] - low) * scale) + 1] += 1
    for k in range(buckets):
        first[k + 1] += first[k]
    rank = np.empty(number, np.int64)
    for m in range(number):
        bucket = int((value[m] - low) * scale)
        rank[m] = first[bucket]
        first[bucket] += 1
    return rank


@kernel()
def _rim(queue, rank, cut, number, label, graph, position):
    """Return how many blocks have a neighbour across the cut, before it and behind it."""
    part, start, neighbour = graph
    before, behind = 0, 0
    for m in range(number):
        node = queue[m]
        first = rank[m] < cut
        for at in range(start[node], start[node + 1]):
            other = neighbour[at]
            if part[other] == label and (rank[position[other]] < cut) != first:
                if first:
                    before += 1
                else:
                    behind += 1
                break
    return before, behind


@kernel()
def _split(number, label, graph, queue, position, distance, kind):
    """Say for each block of the queue if it is in one half (0), the other (1) or between (2)."""
    part, start, neighbour = graph
    rank = _ranks(_along(distance, number), number)
    for m in range(number):
        position[queue[m]] = m
    best, cut, rim = np.inf, number // 2, 0
    for one in range(CUTS):
        share = 0.42 + 0.16 * one / (CUTS - 1)
        place = int(share * number)
        before, behind = _rim(queue, rank, place, number, label, graph, position)
        cost = min(before, behind) * (1.0 + 2.0 * abs(share - 0.5))
        if cost < best:
            best, cut, rim = cost, place, 0 if before <= behind else 1
    for m in range(number):
        side = 0 if rank[m] < cut else 1
        kind[m] = side
        if side != rim:
            continue
        node = queue[m]
        for at in range(start[node], start[node + 1]):
            other = neighbour[at]
            if part[other] == label and (rank[position[other]] < cut) != (side == 0):
                kind[m] = 2
                break


@kernel()
def _leaves_first(count, start, neighbour, order, part):
    """Put blocks with one neighbour or none first, again and again; return how many those are."""
    degree = np.empty(count, np.int64)
    leaves = 0
    for b in range(count):
        degree[b] = start[b + 1] - start[b]
        if degree[b] <= 1:
            order[leaves], part[b] = b, -1
            leaves += 1
    done = 0
    while done < leaves:
        leaf = order[done]
        done += 1
        for at in range(start[leaf], start[leaf + 1]):
            other = neighbour[at]
            degree[other] -= 1
            if part[other] == 0 and degree[other] <= 1:
                order[leaves], part[other] = other, -1
                leaves += 1
    return leaves


@kernel()
def _hubs_last(count, start, neighbour, order, part):
    """Put blocks with very many neighbours last; return the place of the first of them."""
    busy = max(HUB, 6 * len(neighbour) // max(1, count))
    last = count
    for b in range(count - 1, -1, -1):
        if part[b] == 0 and start[b + 1] - start[b] > busy:
            last -= 1
            order[last] = b
            part[b] = -1
    return last


@kernel()
def nested_dissection(count, pairs, coupled):
    """Return the graph (starts, neighbours) and the blocks in the order of elimination (n,).

    Leaves of the graph come first.  Each part of the others is parted in two halves and the blocks
    between them, which come after both.  Blocks with very many neighbours come last of all.
    """
    start, neighbour = neighbours_of(count, pairs, coupled)
    order, part = np.empty(count, np.int64), np.zeros(count, np.int64)
    leaves = _leaves_first(count, start, neighbour, order, part)
    if leaves == count:
        return start, neighbour, order
    last = _hubs_last(count, start, neighbour, order, part)
    nodes, at = np.empty(count, np.int64), leaves
    for b in range(count):
        if part[b] == 0:
            nodes[at] = b
            at += 1
    _dissect(leaves, last, start, neighbour, nodes, part, order)
    return start, neighbour, order


@kernel()
def _dissect(leaves, last, start, neighbour, nodes, part, order):
    """Write ``nodes[leaves:last]``, all of part 0, in the order of nested dissection."""
    count = len(nodes)
    queue, level = np.empty(count, np.int64), np.zeros(count, np.int64)
    seen, position = np.full(count, -1, np.int64), np.zeros(count, np.int64)
    distance = np.empty((LANDMARKS, count))
    kind = np.empty(count, np.int64)
    stack = np.empty((64 + 2 * count, 3), np.int64)  # first, last, label
    graph, room = (part, start, neighbour), (queue, level, seen)
    stack[0, 0], stack[0, 1], stack[0, 2] = leaves, last, 0
    depth, labels, stamp = 1, 1, 0
    while depth > 0:
        depth -= 1
        low, high, label = stack[depth, 0], stack[depth, 1], stack[depth, 2]
        if high - low <= LEAF:
            for k in range(low, high):
                order[k] = nodes[k]
            continue
        number = _distances(nodes[low], label, graph, room, stamp)
        stamp += 1
        if number == high - low:
            stamp = _coordinates(number, label, graph, room, stamp, distance)
            _split(number, label, graph, queue, position, distance, kind)
            for k in range(number):
                nodes[low + k] = queue[k]
        else:  # several pieces: the one just reached, and the rest
            for k in range(low, high):
                kind[k - low] = 0 if seen[nodes[k]] == stamp - 1 else 1
        middle, end = _sorted_by_kind(nodes, low, high, kind)
        for k in range(low, high):
            if k < end:
                part[nodes[k]] = labels if k < middle else labels + 1
            else:
                part[nodes[k]] = -2
                order[k] = nodes[k]
        stack[depth, 0], stack[depth, 1], stack[depth, 2] = low, middle, labels
        stack[depth + 1, 0], stack[depth + 1, 1] = middle, end
        stack[depth + 1, 2] = labels + 1
        labels += 2
        depth += 2


@kernel()
def _sorted_by_kind(nodes, low, high, kind):
    """Sort ``nodes[low:high]`` by kind, keeping their order; return where kinds 1 and 2 begin."""
    at = np.zeros(3, np.int64)
    unsorted = np.empty(high - low, np.int64)
    for k in range(high - low):
        unsorted[k] = nodes[low + k]
        if kind[k] < 2:
            at[kind[k] + 1] += 1
    at[0] = low
    at[1] += at[0]
    at[2] += at[1]
    middle, end = at[1], at[2]
    for k in range(high - low):
        nodes[at[kind[k]]] = unsorted[k]
        at[kind[k]] += 1
    return middle, end


def by_rows(centroid: Floats) -> Ints:
    """Return blocks at ``centroid`` (n, 2), m, row by row along the shorter side, shape (n,)."""
    low = centroid.min(axis=0)
    extent = centroid.max(axis=0) - low
    along = int(np.argmin(extent))
    height = np.sqrt(extent.prod() / len(centroid))
    if height == 0.0:  # all in one line
        return np.argsort(centroid[:, 1 - along], kind="stable")
    row = np.floor((centroid[:, 1 - along] - low[1 - along]) / height)
    return np.lexsort((centroid[:, along], row))


def number_of_strips(count: int) -> int:
    """Return the number of strips of ``count`` blocks."""
    number, enough = 1, LEAST
    while count >= enough and number < MOST:
        number, enough = 2 * number, 4 * enough
    return number


def strips(centroid: Floats, pairs: Ints, free: Bools) -> tuple[Ints, Ints]:
    """Return the blocks strip by strip and the seam last (n,), and where all begins.

    First the strips and then the segments of the seam, as many, (2 strips + 1,); the last is n.
    ``centroid`` (n, 2), m, says where the blocks are, ``free`` (q,) which of the ``pairs`` (q, 2)
    may be coupled.
    """
    count, order = len(centroid), by_rows(centroid)
    number = number_of_strips(count)
    if number == 1:
        return order, np.array([0, count, count])
    strip = np.empty(count, np.int64)
    strip[order] = np.arange(count) * number // count
    first, second = pairs[free].T
    across = strip[first] != strip[second]
    first, second = first[across], second[across]
    part = strip.copy()
    later = np.where(strip[first] > strip[second], first, second)
    part[later] = number + strip[later]
    sizes = np.bincount(part, minlength=2 * number)
    return order[np.argsort(part[order], kind="stable")], np.concatenate([[0], np.cumsum(sizes)])
