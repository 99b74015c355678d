"""Blocks of the equations: as many lines of as many numbers as a block has unknowns.

``lines`` are those of a block in registers, a vector each (compute/vec6.py), for what would else
read them again and again.  Operations on them are written out line by line.
"""

from __future__ import annotations

from typing import Any

from numba.core import types

from clast.compute.jit import kernel
from clast.compute.vec6 import (
    SIX,
    UNKNOWNS,
    ZEROS,
    constant,
    operation,
    plus_scaled,
    put_row,
    row,
    with_number,
    zeros,
)

LINES = types.UniTuple(SIX, UNKNOWNS)
ENTRIES = types.UniTuple(types.float64, UNKNOWNS)


@operation(LINES)
def lines(to, blocks, q):
    """Return the lines of block q of (n, 6, 6)."""
    return [to.load(to.place(blocks, q, a)) for a in range(UNKNOWNS)]


@operation(types.void)
def put_lines(to, blocks, q, k):
    """Write lines into block q."""
    for a, own in enumerate(k):
        to.store(to.place(blocks, q, a), own)


@operation(LINES)
def plus_each(to, k, other):
    """Return the sums of the lines of two blocks."""
    return [to.each(to.builder.fadd, *pair) for pair in zip(k, other, strict=True)]


@operation(LINES)
def unit_lines(to):
    """Return the lines of the unit matrix."""
    places = range(UNKNOWNS)
    return [constant(SIX, *(float(a == b) for b in places)) for a in places]


@operation(ENTRIES)
def entries(to, x, i):
    """Return the numbers of row i of x (n, 6) one by one, each to fill a register."""
    return [to.number(x, i, a) for a in range(UNKNOWNS)]


@operation(ENTRIES)
def minus_column(to, blocks, q, a):
    """Return the numbers of column a of block q one by one, with the other sign."""
    return [to.builder.fneg(to.number(blocks, q, b, a)) for b in range(UNKNOWNS)]


@operation(SIX)
def plus_lines(to, y, x, k):
    """Return y + sum of x_a k_a for numbers x: even and odd lines by themselves, for speed."""
    sums = [y, ZEROS]
    for a in range(UNKNOWNS):
        sums[a % 2] = to.plus_product(sums[a % 2], to.spread(x[a]), k[a])
    return to.each(to.builder.fadd, *sums)


@operation(SIX)
def lines_times(to, k, x):
    """Return k_a.x of each line: a block times a vector."""
    products = [to.pair_sums(to.plus_product(ZEROS, own, x)) for own in k]
    sums, registers = [], []
    for one, other in zip(products[::2], products[1::2], strict=True):
        even, odd = (to.shuffle(one, other, [a, 2 + a]) for a in range(2))
        sums.append(to.builder.fadd(even, odd))
    for register in SIX.registers:
        two = [sums.pop(0) for _ in range(register.count // 2)]
        registers.append(to.shuffle(*two, range(4)) if len(two) > 1 else two[0])
    return to.join(*registers)


def _minus_products(to: Any, rest: Any, factors: list[Any], solved: list[Any]) -> Any:
    for factor, known in zip(factors, solved, strict=True):
        rest = to.plus_product(rest, to.spread(to.builder.fneg(factor)), known)
    return rest


@operation(LINES)
def forward(to, c, i, k):
    """Return the lines of C^-1 K; C is the lower part of block i of c, its diagonal inverted."""
    solved: list[Any] = []
    for a in range(UNKNOWNS):
        rest = _minus_products(to, k[a], [to.number(c, i, a, b) for b in range(a)], solved)
        solved.append(to.plus_product(ZEROS, to.spread(to.number(c, i, a, a)), rest))
    return solved


@operation(LINES)
def backward(to, c, i, k):
    """Return the lines of C^-T K, of the same C."""
    solved: list[Any] = []
    for a in reversed(range(UNKNOWNS)):
        below = [to.number(c, i, b, a) for b in reversed(range(a + 1, UNKNOWNS))]
        rest = _minus_products(to, k[a], below, solved)
        solved.append(to.plus_product(ZEROS, to.spread(to.number(c, i, a, a)), rest))
    return solved[::-1]


@kernel(forceinline=True)
def times(blocks, i, r, k):
    """Return symmetric block i of (n, 6, 6) times row k of r (., 6)."""
    return plus_lines(zeros(), entries(r, k), lines(blocks, i))


@kernel()
def invert(block, inverse):
    """Write the inverse of a symmetric block and return True, or False where it is not definite.

    Gauss-Jordan without pivoting; the pivots of a positive definite block are positive.
    """
    for a in range(UNKNOWNS):
        put_row(inverse, a, row(block, a))
    for k in range(UNKNOWNS):
        pivot = inverse[k, k]
        if not pivot > 0.0:
            return False
        of_k = plus_scaled(zeros(), 1.0 / pivot, with_number(row(inverse, k), k, 1.0))
        for a in range(UNKNOWNS):
            factor = inverse[a, k]
            if a == k:
                put_row(inverse, a, of_k)
            else:
                rest = with_number(row(inverse, a), k, 0.0)
                put_row(inverse, a, plus_scaled(rest, -factor, of_k))
    return True
