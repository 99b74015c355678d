"""The first-order displacement function T(x, y) of a block (Shi 1988), and its derivatives.

A point at the offset (x, y) = (X - Xc, Y - Yc) from the centroid of its block is displaced by
(u, v) = T(x, y) d, with the six unknowns d = (u0, v0, r0, ex, ey, gxy) of the block and

    T(x, y) = | 1 0 -y  x  0  y/2 |
              | 0 1  x  0  y  x/2 |

Kernels of every chapter get T d, T^T f, T^T (u; v) and sums of T^T C T from here.
"""

from __future__ import annotations

import numpy as np

from clast.block.rotation import RotationRule
from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, CONTACTS, shared
from clast.compute.vec6 import numbers, plus, plus_scaled, put_line, row, six
from clast.model.model import Floats, Ints


@kernel(forceinline=True)
def displacement_at(x, y, d):
    """Return T(x, y) d, m, as u and v, for the six unknowns d of a block (vec6)."""
    u0, v0, r0, ex, ey, gxy = numbers(d)
    return u0 - y * r0 + x * ex + 0.5 * y * gxy, v0 + x * r0 + y * ey + 0.5 * x * gxy


@kernel(forceinline=True)
def force_at(x, y, fx, fy):
    """Return T(x, y)^T f, the generalised force (vec6) of a force f, N/m, at an offset, m."""
    return six(fx, fy, x * fy - y * fx, x * fx, y * fy, 0.5 * (y * fx + x * fy))


@kernel(forceinline=True)
def plus_transposed(k, x, y, u, v):
    """Return the six lines of K + T(x, y)^T (u; v) for six lines of K and u, v (vec6 each)."""
    k0, k1, k2, k3, k4, k5 = k
    k2 = plus_scaled(plus_scaled(k2, -y, u), x, v)
    k3, k4 = plus_scaled(k3, x, u), plus_scaled(k4, y, v)
    k5 = plus_scaled(plus_scaled(k5, 0.5 * y, u), 0.5 * x, v)
    return plus(k0, u), plus(k1, v), k2, k3, k4, k5


@kernel(forceinline=True)
def powers_at(x, y):
    """Return (1, x, y, x^2, xy, y^2) as vec6: the terms of T^T C T at an offset, m."""
    return six(1.0, x, y, x * x, x * y, y * y)


@kernel(forceinline=True)
def weighted_squares(xx, xy, yy):
    """Return the six lines (vec6) of sum T^T C T, from the moments of symmetric matrices C (2, 2).

    ``xx``, ``xy`` and ``yy`` are the sums of the components of C times ``powers_at`` (vec6).
    With C = I dm this is the mass matrix, with C the stiffness of a contact its share of K_ii.
    """
    a1, ax, ay, axx, axy, ayy = numbers(xx)
    b1, bx, by, bxx, bxy, byy = numbers(xy)
    c1, cx, cy, cxx, cxy, cyy = numbers(yy)
    ur, us, vr, vs = bx - ay, 0.5 * (ay + bx), cx - by, 0.5 * (by + cx)
    re, rf, rs = bxx - axy, cxy - byy, 0.5 * (cxx - ayy)
    es, fs = 0.5 * (axy + bxx), 0.5 * (byy + cxy)
    rr, ss = ayy - 2.0 * bxy + cxx, 0.25 * (ayy + 2.0 * bxy + cxx)
    return (
        six(a1, b1, ur, ax, by, us),
        six(b1, c1, vr, bx, cy, vs),
        six(ur, vr, rr, re, rf, rs),
        six(ax, bx, re, axx, bxy, es),
        six(by, cy, rf, bxy, cyy, fs),
        six(us, vs, rs, es, fs, ss),
    )


@shared(CONTACTS)
def _basis(first, last, offset, result):
    """Write T at points ``first`` to ``last`` - 1, line by line: T^T of a unit force along x, y."""
    for k in range(first, last):
        x, y = offset[k, 0], offset[k, 1]
        put_line(result, k, 0, force_at(x, y, 1.0, 0.0))
        put_line(result, k, 1, force_at(x, y, 0.0, 1.0))


def basis(offset: Floats) -> Floats:
    """Return T (k, 2, 6) at offsets (k, 2) from the centroids, m."""
    result = np.empty((len(offset), 2, 6))
    _basis(len(offset), np.ascontiguousarray(offset), result)
    return result


@shared(CONTACTS)
def _displacements(first, last, offset, unknowns, block, result):
    """Write T d at points ``first`` to ``last`` - 1."""
    for k in range(first, last):
        d = row(unknowns, block[k])
        result[k, 0], result[k, 1] = displacement_at(offset[k, 0], offset[k, 1], d)


def displacements(offset: Floats, unknowns: Floats, block: Ints) -> Floats:
    """Return T d (k, 2), m, at offsets (k, 2), m, in blocks (k,), from d (n, 6): to first order."""
    result = np.empty_like(offset)
    _displacements(len(offset), offset, unknowns, block, result)
    return result


@shared(BLOCKS)
def _farthest_moved(first, last, vertices, block_start, centroid, unknowns, result):
    """Write how far the vertices of blocks ``first`` to ``last`` - 1 move by T d at most."""
    for b in range(first, last):
        d, largest = row(unknowns, b), 0.0
        for k in range(block_start[b], block_start[b + 1]):
            x, y = vertices[k, 0] - centroid[b, 0], vertices[k, 1] - centroid[b, 1]
            dx, dy = displacement_at(x, y, d)
            largest = max(largest, dx * dx + dy * dy)
        result[b] = np.sqrt(largest)


@kernel()
def farthest_moved(vertices, block_start, centroid, unknowns):
    """Return the largest movement T d of a vertex of each block, m, shape (n,), from d (n, 6).

    ``vertices`` (nv, 2) and ``centroid`` (n, 2) in m, ``block_start`` (n + 1,) the first vertices.
    """
    result = np.empty(len(centroid))
    _farthest_moved(len(result), vertices, block_start, centroid, unknowns, result)
    return result


@shared(CONTACTS)
def _movements(first, last, offset, unknowns, gradient, block, result):
    """Write (u0, v0) + G x of points ``first`` to ``last`` - 1."""
    for k in range(first, last):
        x, y, b = offset[k, 0], offset[k, 1], block[k]
        result[k, 0] = unknowns[b, 0] + (gradient[b, 0, 0] * x + gradient[b, 0, 1] * y)
        result[k, 1] = unknowns[b, 1] + (gradient[b, 1, 0] * x + gradient[b, 1, 1] * y)


def movements(rotation: RotationRule, offset: Floats, unknowns: Floats, block: Ints) -> Floats:
    """Return how far d (n, 6) moves points at offsets (k, 2), m, of blocks (k,), m, (k, 2).

    Other than ``displacements`` not to first order: u(x) = (u0, v0) + G x, with the gradient G
    of the rotation rule.
    """
    result = np.empty_like(offset)
    _movements(len(offset), offset, unknowns, rotation.gradient(unknowns), block, result)
    return result


@shared(CONTACTS)
def _moved_to(first, last, positions, block, centroid, unknowns, gradient, result):
    """Write where points ``first`` to ``last`` - 1 are after (u0, v0) + G x."""
    for k in range(first, last):
        b = block[k]
        x, y = positions[k, 0] - centroid[b, 0], positions[k, 1] - centroid[b, 1]
        u = unknowns[b, 0] + (gradient[b, 0, 0] * x + gradient[b, 0, 1] * y)
        v = unknowns[b, 1] + (gradient[b, 1, 0] * x + gradient[b, 1, 1] * y)
        result[k, 0], result[k, 1] = positions[k, 0] + u, positions[k, 1] + v


@kernel()
def moved_to(positions, block, centroid, unknowns, gradient):
    """Return where points at ``positions`` (k, 2), m, of blocks (k,) come to by d (n, 6), (k, 2).

    As ``movements`` has it, with the ``gradient`` G (n, 2, 2) of the rotation rule and the
    centroids (n, 2), m.
    """
    result = np.empty_like(positions)
    _moved_to(len(positions), positions, block, centroid, unknowns, gradient, result)
    return result


@shared(CONTACTS)
def _displaced(first, last, positions, block, centroid, unknowns, result):
    """Write T d at points ``first`` to ``last`` - 1 by where they are."""
    for k in range(first, last):
        b = block[k]
        x, y = positions[k, 0] - centroid[b, 0], positions[k, 1] - centroid[b, 1]
        result[k, 0], result[k, 1] = displacement_at(x, y, row(unknowns, b))


@kernel()
def displacements_of(positions, block, centroid, unknowns):
    """Return T d (k, 2), m, of points at ``positions`` (k, 2), m, in blocks (k,): to first order.

    From d (n, 6) and the centroids (n, 2), m.
    """
    result = np.empty_like(positions)
    _displaced(len(positions), positions, block, centroid, unknowns, result)
    return result
