"""The exact line search of each island by itself, for clipped springs.

The potential is a sum over islands (islands.py), and along a search direction each has a minimum of
its own: the root of a slope that rises and is piecewise linear.  Newton's method on the slope, kept
inside a bracket, ends on it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import BLOCKS, CONTACTS, shared
from clast.compute.reductions import CHUNK, PART, in_part, sum_of
from clast.compute.vec6 import inner, plus_scaled, put_row, row
from clast.contact.clipped_spring import clipped, forces_at, in_piece

SLOPE_TOLERANCE = 1e-9
"""The line's minimum is found where the slope has fallen to this share of its start."""
EVALUATIONS_MAX = 40
"""Evaluations along a line at most."""
SLOPE_NOISE = 1e-14
"""Slope that does not count, as a share of the sum of all slopes."""


@kernel()
def _only(island):
    """Return the island that all terms are in (k,), or -1; of no terms -1, too."""
    same = len(island) > 0
    for k in range(len(island)):
        same &= island[k] == island[0]
    return island[0] if same else -1


@kernel()
def whole_pieces(island, size):
    """Return of each piece of ``size`` terms the island that all are in, or -1, (pieces,)."""
    only = np.empty((len(island) + size - 1) // size, np.int64)
    for piece in range(len(only)):
        only[piece] = _only(island[piece * size : (piece + 1) * size])
    return only


@kernel()
def sums(terms, island, only, size, count):
    """Return the sums of terms (k,) over ``count`` islands (count,), piece by piece.

    ``island`` (k,) is that of each term, ``only`` the ``whole_pieces`` of ``size`` terms.
    """
    result = np.zeros(count)
    for piece in range(len(only)):
        first, last = piece * size, min((piece + 1) * size, len(terms))
        if only[piece] >= 0:
            result[only[piece]] += sum_of(terms[first:last])
            continue
        current, added = island[first], 0.0
        for k in range(first, last):
            if island[k] != current:
                result[current] += added
                current, added = island[k], 0.0
            added += terms[k]
        result[current] += added
    return result


@kernel()
def island_sums(values, island, count):
    """Return the sums of values (k,) over ``count`` islands (count,)."""
    return sums(values, island, whole_pieces(island, PART), PART, count)


@shared(BLOCKS)
def _along(first, last, blocks, residual, direction, forms, products):
    for i in range(first, last):
        own = times(blocks, i, direction, i)
        forms[i] = inner(own, row(direction, i))
        products[i] = inner(row(residual, i), row(direction, i))


@shared(CONTACTS)
def _works(first, last, forces, motions, works):
    normal, shear = in_part(forces, first, last)
    opening, sliding = in_part(motions, first, last)
    works = works[first:last]
    for c in range(len(works)):
        works[c] = normal[c] * opening[c] + shear[c] * sliding[c]


@kernel()
def slopes(of_blocks, of_links, count, blocks, residual, direction, forces, motions):
    """Return along a direction (n, 6) the curvature of blocks, the slope, and that without springs.

    Of each of ``count`` islands, J/m; ``of_blocks`` (n,) and ``of_links`` (m,) are the islands,
    ``blocks`` K without springs (n, 6, 6), ``residual`` (n, 6) minus the gradient, ``forces`` N and
    T and ``motions`` the changes of gap and slip, (m,) each.
    """
    forms, products = np.empty(len(direction)), np.empty(len(direction))
    _along(len(direction), blocks, residual, direction, forms, products)
    works = np.empty(len(of_links))
    _works(len(works), forces, motions, works)
    only = whole_pieces(of_blocks, CHUNK)
    start = -sums(products, of_blocks, only, CHUNK, count)
    bend = sums(forms, of_blocks, only, CHUNK, count)
    return bend, start, start + island_sums(works, of_links, count)


@kernel()
def _lengths(length, island):
    """Return the length of each link's island (k,)."""
    at = np.empty(len(island))
    only = _only(island)
    if only >= 0:
        at[:] = length[only]
    else:
        for c in range(len(island)):
            at[c] = length[island[c]]
    return at


@shared(CONTACTS)
def _work(first, last, island, length, line, springs, works, bends):
    """Write the work of the forces of each link along the line, and its curvature."""
    at = _lengths(length, island[first:last])
    gap, d_gap = in_part((line[0], line[1]), first, last)
    slip, d_slip = in_part((line[2], line[3]), first, last)
    n0, kn, n_low, n_high = in_piece(springs, 0, first, last)
    t0, kt, t_low, t_high = in_piece(springs, 1, first, last)
    works, bends = in_part((works, bends), first, last)
    for c in range(len(gap)):
        opening, sliding = d_gap[c], d_slip[c]
        n, k = clipped(n0[c], kn[c], n_low[c], n_high[c], gap[c] + at[c] * opening)
        t, ks = clipped(t0[c], kt[c], t_low[c], t_high[c], slip[c] + at[c] * sliding)
        works[c] = n * opening + t * sliding
        bends[c] = k * opening * opening + ks * sliding * sliding


@kernel()
def _narrow(search, slope, bend, enough):
    """Judge the islands by their slopes (r,), and choose the next lengths; return how many go on.

    Newton's method, kept inside the bracket.
    """
    length, low, high, done = search
    left = 0
    for r in range(len(length)):
        if done[r]:
            continue
        if abs(slope[r]) <= enough[r]:
            done[r] = True
            continue
        left += 1
        if slope[r] < 0.0:
            low[r] = length[r]
        else:
            high[r] = length[r]
        trial = length[r] - slope[r] / bend[r]
        if low[r] < trial < high[r]:
            length[r] = trial
        else:
            length[r] = 0.5 * (low[r] + min(high[r], 2.0 * low[r] + 1.0))
    return left


@kernel()
def lengths_along(island, line, springs, smooth, curvature, start):
    """Return where the potential of each island (r,) is least along a line, and evaluations.

    ``line`` are gap, its change, slip and its change (m,) of the links, which are in ``island``
    (m,); ``springs`` are theirs (Springs.arrays).  ``smooth`` and ``curvature`` (r,) are the slope
    and the bend of all the rest at length 0, ``start`` (r,) is the whole slope there.  A length is
    found where the slope has fallen to SLOPE_TOLERANCE of its start, or to next to nothing beside
    those of all islands.
    """
    count, links = len(start), len(island)
    only = whole_pieces(island, PART)
    works, bends = np.empty(links), np.empty(links)
    enough = SLOPE_TOLERANCE * np.abs(start) + SLOPE_NOISE * np.abs(start).sum()
    done = start == 0.0
    length = np.ones(count)
    search = length, np.zeros(count), np.full(count, np.inf), done
    left, evaluations = count - int(done.sum()), 0
    while left > 0 and evaluations < EVALUATIONS_MAX:
        evaluations += 1
        _work(links, island, length, line, springs, works, bends)
        slope = smooth + length * curvature - sums(works, island, only, PART, count)
        left = _narrow(search, slope, curvature + sums(bends, island, only, PART, count), enough)
    return length, evaluations


@shared(CONTACTS)
def _advance(first, last, island, length, line, gap, slip):
    """Write gap and slip at the lengths of the links' islands."""
    at = _lengths(length, island[first:last])
    old_gap, d_gap = in_part((line[0], line[1]), first, last)
    old_slip, d_slip = in_part((line[2], line[3]), first, last)
    gap, slip = in_part((gap, slip), first, last)
    for c in range(len(at)):
        gap[c] = old_gap[c] + at[c] * d_gap[c]
        slip[c] = old_slip[c] + at[c] * d_slip[c]


@kernel()
def links_along(island, length, line, springs):
    """Return gap, slip, N, T and their stiffnesses (m,) at the lengths (r,) of the islands."""
    gap, slip = np.empty(len(island)), np.empty(len(island))
    _advance(len(island), island, length, line, gap, slip)
    return gap, slip, *forces_at(gap, slip, springs)


@shared(BLOCKS)
def _advance_blocks(first, last, unknowns, direction, length, island, result):
    for i in range(first, last):
        put_row(result, i, plus_scaled(row(unknowns, i), length[island[i]], row(direction, i)))


@kernel()
def blocks_along(unknowns, direction, length, island):
    """Return d + l dd, with the length l (r,) of each block's island (n,), of d and dd (n, 6)."""
    result = np.empty_like(unknowns)
    _advance_blocks(len(result), unknowns, direction, length, island, result)
    return result


@kernel()
def length_of_links(links, motions, springs, stretches, slope_without, bend, decrement):
    """Return where the potential of a single island is least along a line, and evaluations.

    ``links`` (k,) are its links and ``motions`` (k, 2) the changes of their gaps and slips; all
    links have ``springs`` (Springs.arrays) and ``stretches``, gaps and slips, m, (m,) each.
    ``slope_without`` and ``bend`` are those without springs, the whole slope is minus the
    ``decrement``, J/m.
    """
    (gap, slip), (n0, kn, n_low, n_high, t0, kt, t_low, t_high) = stretches, springs
    length, low, high = 1.0, 0.0, np.inf
    evaluations, enough = 0, (SLOPE_TOLERANCE + SLOPE_NOISE) * decrement
    while evaluations < EVALUATIONS_MAX:
        evaluations += 1
        slope, curvature = slope_without + length * bend, bend
        for k in range(len(links)):
            c, opening, sliding = links[k], motions[k, 0], motions[k, 1]
            n, stiff = clipped(n0[c], kn[c], n_low[c], n_high[c], gap[c] + length * opening)
            slope -= n * opening
            curvature += stiff * opening * opening
            t, stiff = clipped(t0[c], kt[c], t_low[c], t_high[c], slip[c] + length * sliding)
            slope -= t * sliding
            curvature += stiff * sliding * sliding
        if abs(slope) <= enough:
            break
        low, high = (length, high) if slope < 0.0 else (low, length)
        trial = length - slope / curvature
        length = trial if low < trial < high else 0.5 * (low + min(high, 2.0 * low + 1.0))
    return length, evaluations


@kernel()
def move_links(links, motions, length, springs, stretches, forces, stiffnesses):
    """Write gaps and slips, forces and stiffnesses of links (k,) at a length, all (m,) in pairs."""
    (gap, slip), (n0, kn, n_low, n_high, t0, kt, t_low, t_high) = stretches, springs
    (normal, shear), (stiff_n, stiff_t) = forces, stiffnesses
    for k in range(len(links)):
        c = links[k]
        gap[c] += length * motions[k, 0]
        slip[c] += length * motions[k, 1]
        normal[c], stiff_n[c] = clipped(n0[c], kn[c], n_low[c], n_high[c], gap[c])
        shear[c], stiff_t[c] = clipped(t0[c], kt[c], t_low[c], t_high[c], slip[c])


def common_length(along: Callable[[float], tuple[float, float]], start: float) -> tuple[float, int]:
    """Return one length for all islands, for springs of any law, and evaluations.

    ``along`` returns slope and bend at a length, J/m; ``start`` is the slope at 0.
    """
    low, high, length = 0.0, np.inf, 1.0
    for evaluations in range(1, EVALUATIONS_MAX + 1):
        slope, bend = along(length)
        if abs(slope) <= SLOPE_TOLERANCE * abs(start):
            return length, evaluations
        low, high = (length, high) if slope < 0.0 else (low, length)
        trial = length - slope / bend
        length = trial if low < trial < high else 0.5 * (low + min(high, 2.0 * low + 1.0))
    return length, EVALUATIONS_MAX
