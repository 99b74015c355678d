"""Matrices of six rows and columns, as blocks of the equations are."""

from __future__ import annotations

from clast.compute.jit import kernel
from clast.compute.vec6 import line, plus, plus_scaled, put_line, put_row, row, with_number, zeros


@kernel(forceinline=True)
def lines(blocks, q):
    """Return the six lines of block q, for a loop that would else read them again and again."""
    return (
        line(blocks, q, 0),
        line(blocks, q, 1),
        line(blocks, q, 2),
        line(blocks, q, 3),
        line(blocks, q, 4),
        line(blocks, q, 5),
    )


@kernel(forceinline=True)
def put_lines(blocks, q, k0, k1, k2, k3, k4, k5):
    """Write six lines into block q."""
    put_line(blocks, q, 0, k0)
    put_line(blocks, q, 1, k1)
    put_line(blocks, q, 2, k2)
    put_line(blocks, q, 3, k3)
    put_line(blocks, q, 4, k4)
    put_line(blocks, q, 5, k5)


@kernel(forceinline=True)
def times(blocks, i, r, k):
    """Return symmetric block i of (n, 6, 6) times row k of r (., 6)."""
    s0 = plus_scaled(zeros(), r[k, 0], line(blocks, i, 0))
    s1 = plus_scaled(zeros(), r[k, 1], line(blocks, i, 1))
    s0 = plus_scaled(s0, r[k, 2], line(blocks, i, 2))
    s1 = plus_scaled(s1, r[k, 3], line(blocks, i, 3))
    s0 = plus_scaled(s0, r[k, 4], line(blocks, i, 4))
    s1 = plus_scaled(s1, r[k, 5], line(blocks, i, 5))
    return plus(s0, s1)


@kernel()
def invert(block, inverse):
    """Write the inverse of a symmetric block and return True, or False where it is not definite.

    Gauss-Jordan without pivoting; the pivots of a positive definite block are positive.
    """
    for a in range(6):
        put_row(inverse, a, row(block, a))
    for k in range(6):
        pivot = inverse[k, k]
        if not pivot > 0.0:
            return False
        of_k = plus_scaled(zeros(), 1.0 / pivot, with_number(row(inverse, k), k, 1.0))
        for a in range(6):
            factor = inverse[a, k]
            if a == k:
                put_row(inverse, a, of_k)
            else:
                rest = with_number(row(inverse, a), k, 0.0)
                put_row(inverse, a, plus_scaled(rest, -factor, of_k))
    return True
