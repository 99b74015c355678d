"""Newton's method on an island of a few blocks (islands.py): its system is one dense matrix.

Most islands of two blocks, of rocks that fall and of sliding wedges are such.  A factor that knows
of patterns takes far longer to compile than all else that these cases need, and to look for the
pattern of one block takes longer than to solve for it.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.vec6 import UNKNOWNS, put_row
from clast.contact.jacobian import force_on
from clast.minimise.line_search import length_of_links, move_links

FEW_BLOCKS = 4
"""Blocks up to which a dense factor takes less time than one that leaves out zeros."""


@kernel()
def _links_of(blocks, still, pairs, graph):
    """Return the links of blocks of one island."""
    start, right, left, listed = graph
    room = 0
    for i in blocks:
        room += right[i + 1] - right[i] + left[i + 1] - left[i]
    own, count, size = np.empty(room, np.int64), 0, 0
    for i in blocks:
        for q in range(right[i], right[i + 1]):
            own[count], count, size = q, count + 1, size + start[q + 1] - start[q]
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            if still[pairs[q, 0]]:  # else it is among those of that block
                own[count], count, size = q, count + 1, size + start[q + 1] - start[q]
    links, size = np.empty(size, np.int64), 0
    for q in own[:count]:
        for c in range(start[q], start[q + 1]):
            links[size], size = c, size + 1
    return links


@kernel()
def _describe(links, still, place, ends):
    """Return the place of the two blocks of each link, -1 if still, (m, 2), and its rows.

    Rows are n and t of either block, the change of gap and slip by its unknowns, (m, 2, 2, 6).
    """
    vertex_block, edge_block, arms = ends
    places = np.empty((len(links), 2), np.int64)
    rows = np.empty((len(links), 2, 2, UNKNOWNS))
    for k in range(len(links)):
        c = links[k]
        for side in range(2):
            i = vertex_block[c] if side == 0 else edge_block[c]
            places[k, side] = -1 if still[i] else place[i]
            put_row(rows[k, side], 0, force_on(arms, c, side == 0, 1.0, 0.0))
            put_row(rows[k, side], 1, force_on(arms, c, side == 0, 0.0, 1.0))
    return places, rows


@kernel()
def _balance(blocks, links, places, rows, system, point):
    """Write residual and distance of the blocks of a point; return the sum of these, J/m."""
    base, inverse, load, _ = system
    displacement, _, _, normal, shear, _, _, residual, distance = point
    for i in blocks:
        for a in range(UNKNOWNS):
            value = load[i, a]
            for b in range(UNKNOWNS):
                value -= base[i, a, b] * displacement[i, b]
            residual[i, a] = value
    for k in range(len(links)):
        n, t = normal[links[k]], shear[links[k]]
        for side in range(2):
            if places[k, side] >= 0:
                i = blocks[places[k, side]]
                for a in range(UNKNOWNS):
                    residual[i, a] += n * rows[k, side, 0, a] + t * rows[k, side, 1, a]
    left = 0.0
    for i in blocks:
        value = 0.0
        for a in range(UNKNOWNS):
            for b in range(UNKNOWNS):
                value += residual[i, a] * inverse[i, a, b] * residual[i, b]
        distance[i] = value
        left += value
    return left


@kernel()
def _factor(blocks, links, places, rows, base, point, low):
    """Write L of the Hessian L L^T (6k, 6k); return whether it is positive definite."""
    kn, ks = point[5], point[6]
    low[:] = 0.0
    for k in range(len(blocks)):
        for a in range(UNKNOWNS):
            for b in range(a + 1):
                low[UNKNOWNS * k + a, UNKNOWNS * k + b] = base[blocks[k], a, b]
    for k in range(len(links)):
        stiffness = kn[links[k]], ks[links[k]]
        for one in range(4):
            i, j = places[k, one // 2], places[k, one % 2]
            if i < j or i < 0 or j < 0:
                continue
            for way in range(2):
                for a in range(UNKNOWNS):
                    scale = stiffness[way] * rows[k, one // 2, way, a]
                    for b in range(UNKNOWNS):
                        more = scale * rows[k, one % 2, way, b]
                        low[UNKNOWNS * i + a, UNKNOWNS * j + b] += more
    for a in range(len(low)):
        for b in range(a + 1):
            value = low[a, b]
            for c in range(b):
                value -= low[a, c] * low[b, c]
            if a > b:
                low[a, b] = value / low[b, b]
            elif value > 0.0:
                low[a, a] = np.sqrt(value)
            else:
                return False
    return True


@kernel()
def _direction(blocks, low, residual, direction):
    """Write the Newton direction (6k,); return the decrement, J/m."""
    size = len(direction)
    for a in range(size):
        value = residual[blocks[a // UNKNOWNS], a % UNKNOWNS]
        for b in range(a):
            value -= low[a, b] * direction[b]
        direction[a] = value / low[a, a]
    decrement = 0.0
    for a in range(size - 1, -1, -1):
        value = direction[a]
        for b in range(a + 1, size):
            value -= low[b, a] * direction[b]
        direction[a] = value / low[a, a]
        decrement += direction[a] * residual[blocks[a // UNKNOWNS], a % UNKNOWNS]
    return decrement


@kernel()
def _motions(places, rows, direction):
    """Return the change of gap and slip of links (m, 2) along a direction (6k,)."""
    motions = np.zeros((len(places), 2))
    for k in range(len(places)):
        for side in range(2):
            first = UNKNOWNS * places[k, side]
            if first >= 0:
                for way in range(2):
                    for a in range(UNKNOWNS):
                        motions[k, way] += rows[k, side, way, a] * direction[first + a]
    return motions


@kernel()
def _search(blocks, links, motions, direction, decrement, base, springs, point):
    """Move displacements, links and forces to the least potential along a direction.

    Return the number of evaluations.
    """
    displacement, stretches, forces, stiffnesses = point[0], point[1:3], point[3:5], point[5:7]
    slope, bend = -decrement, 0.0
    for k in range(len(links)):
        slope += forces[0][links[k]] * motions[k, 0]
        slope += forces[1][links[k]] * motions[k, 1]
    for k in range(len(blocks)):
        first = UNKNOWNS * k
        for a in range(UNKNOWNS):
            for b in range(UNKNOWNS):
                bend += direction[first + a] * base[blocks[k], a, b] * direction[first + b]
    length, tries = length_of_links(links, motions, springs, stretches, slope, bend, decrement)
    for a in range(len(direction)):
        displacement[blocks[a // UNKNOWNS], a % UNKNOWNS] += length * direction[a]
    move_links(links, motions, length, springs, stretches, forces, stiffnesses)
    return tries


@kernel()
def _minimum(blocks, place, problem, point, tolerance, iterations):
    """Minimise an island in place; return its distance, J/m, iterations and evaluations."""
    system, (pairs, graph, ends, springs) = problem
    base, _, _, still = system
    links = _links_of(blocks, still, pairs, graph)
    places, rows = _describe(links, still, place, ends)
    size, left, evaluations = UNKNOWNS * len(blocks), 0.0, 0
    low, direction = np.empty((size, size)), np.empty(size)
    for i in blocks:
        left += point[8][i]
    for k in range(iterations):
        if left <= tolerance or not _factor(blocks, links, places, rows, base, point, low):
            return left, k, evaluations
        decrement = _direction(blocks, low, point[7], direction)
        if not 0.0 < decrement < np.inf:
            return left, k, evaluations
        motions = _motions(places, rows, direction)
        evaluations += _search(blocks, links, motions, direction, decrement, base, springs, point)
        left = _balance(blocks, links, places, rows, system, point)
        if decrement <= tolerance:
            return min(decrement, left), k + 1, evaluations
    return left, iterations, evaluations


@kernel()
def minimise_few(wanted, listing, problem, point, limits, left):
    """Minimise islands of a few blocks as ``minimise_each`` does (islands.py), one by one."""
    start, blocks, place = listing
    passes, evaluations = 0, 0
    for r in wanted:
        own = blocks[start[r] : start[r + 1]]
        left[r], taken, tries = _minimum(own, place, problem, point, limits[0], int(limits[1]))
        passes, evaluations = max(passes, taken), max(evaluations, tries)
    return passes, evaluations
