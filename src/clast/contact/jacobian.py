"""The contact Jacobian: how two blocks move a contact, and how the contact acts on them.

Vertex P of block i moves by u_i = T_i d_i, the point Q of block j that it touches by u_j; the
contact opens by n.(u_i - u_j) and slips by t.(u_i - u_j), t = (-ny, nx).  Forces act by T^T, and
springs stiffen by T^T (k_n n n^T + k_s t t^T) T (Shi 1988).

T follows from the offset of a point from the centroid of its block (block/displacement.py).  So a
contact is six numbers, its ``arms`` (nx, ny, x_i, y_i, x_j, y_j): the unit normal of the edge,
and the offsets of P and Q, m.  ``arms`` are those of all contacts, (m, 6).
"""

from __future__ import annotations

import numpy as np

from clast.block.displacement import (
    displacement_at,
    force_at,
    plus_transposed,
    powers_at,
)
from clast.compute.jit import kernel
from clast.compute.mat6 import lines, put_lines
from clast.compute.parallel import CONTACTS, shared
from clast.compute.vec6 import numbers, plus_scaled, put_line, row
from clast.model.model import Floats


@kernel(forceinline=True)
def relative_motion(arms, c, d, i, j):
    """Return n.d and t.d of contact c of vertex block i and edge block j, m, for d (n, 6)."""
    nx, ny, x_i, y_i, x_j, y_j = numbers(row(arms, c))
    u_i, v_i = displacement_at(x_i, y_i, row(d, i))
    u_j, v_j = displacement_at(x_j, y_j, row(d, j))
    u, v = u_i - u_j, v_i - v_j
    return nx * u + ny * v, nx * v - ny * u


@kernel(forceinline=True)
def force_on(arms, c, of_vertex, normal, shear):
    """Return the generalised force N n + T t (vec6) on the vertex's block or on the edge's."""
    nx, ny = arms[c, 0], arms[c, 1]
    fx, fy = normal * nx - shear * ny, normal * ny + shear * nx
    if of_vertex:
        return force_at(arms[c, 2], arms[c, 3], fx, fy)
    return force_at(arms[c, 4], arms[c, 5], -fx, -fy)


@kernel(forceinline=True)
def stiffness_of(arms, c, kn, ks):
    """Return xx, xy, yy of k_n n n^T + k_s t t^T of contact c, N/m per m; kn and ks (m,)."""
    nx, ny = arms[c, 0], arms[c, 1]
    return (
        kn[c] * nx * nx + ks[c] * ny * ny,
        (kn[c] - ks[c]) * nx * ny,
        kn[c] * ny * ny + ks[c] * nx * nx,
    )


@kernel(forceinline=True)
def plus_moments(moments, arms, i, first, last, vertex_block, kn, ks):
    """Return ``moments`` and those of the stiffness of contacts ``first`` to ``last`` - 1 of i.

    ``moments`` are three times six numbers, from which ``weighted_squares`` makes K_ii
    (block/displacement.py).
    """
    xx, xy, yy = moments
    for c in range(first, last):
        at = 2 if vertex_block[c] == i else 4
        powers = powers_at(arms[c, at], arms[c, at + 1])
        kxx, kxy, kyy = stiffness_of(arms, c, kn, ks)
        xx, xy = plus_scaled(xx, kxx, powers), plus_scaled(xy, kxy, powers)
        yy = plus_scaled(yy, kyy, powers)
    return xx, xy, yy


@kernel(forceinline=True)
def couple(arms, i, q, first, last, vertex_block, kn, ks, upper):
    """Add -T_i^T C T_j of contacts ``first`` to ``last`` - 1 to block q of ``upper``, in place.

    i is the block of the rows, j the other one; C = k_n n n^T + k_s t t^T.
    """
    k = lines(upper, q)
    for c in range(first, last):
        kxx, kxy, kyy = stiffness_of(arms, c, kn, ks)
        own, other = (2, 4) if vertex_block[c] == i else (4, 2)
        x, y = arms[c, other], arms[c, other + 1]
        u, v = force_at(x, y, -kxx, -kxy), force_at(x, y, -kxy, -kyy)  # the lines of -C T_j
        x, y = arms[c, own], arms[c, own + 1]
        k = plus_transposed(k, x, y, u, v)
    put_lines(upper, q, k)


@shared(CONTACTS)
def _rows(first, last, arms, rows):
    """Write the rows of contacts ``first`` to ``last`` - 1."""
    for c in range(first, last):
        put_line(rows, c, 0, force_on(arms, c, True, 1.0, 0.0))
        put_line(rows, c, 1, force_on(arms, c, False, 1.0, 0.0))
        put_line(rows, c, 2, force_on(arms, c, True, 0.0, 1.0))
        put_line(rows, c, 3, force_on(arms, c, False, 0.0, 1.0))


def rows_of(arms: Floats) -> Floats:
    """Return n_i, n_j, t_i, t_j = T_i^T n, -T_j^T n, T_i^T t, -T_j^T t of contacts, (m, 4, 6)."""
    rows = np.empty((len(arms), 4, 6))
    _rows(len(arms), arms, rows)
    return rows
