"""The unknowns of a block in single precision, in one register for eight.

The single precision form of compute/vec6.py: half of the bytes, and half of the instructions.  A
value of type Eight is six numbers and two that do not count; ``plus`` and ``minus`` are those of
vec6.  Vectors have rows of eight, (n, 8), whose last two numbers are zero; blocks are (n, 6, 6) as
everywhere.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types

from clast.compute.vec6 import (
    INDEX,
    SIX,
    UNALIGNED,
    UNKNOWNS,
    Vector,
    VectorModel,
    constant,
    operation,
)

WIDTH = 8
"""Numbers in a row of a vector."""
CACHE_LINE = 16
"""Numbers in a line of the cache."""


class Eight(Vector):
    """In single precision, with numbers that do not count."""

    registers = (ir.VectorType(ir.FloatType(), WIDTH),)


extending.register_model(Eight)(VectorModel)
EIGHT = Eight()
SINGLE = types.float32
LINES = types.UniTuple(EIGHT, UNKNOWNS)
ZEROS = constant(EIGHT, *[0.0] * WIDTH)
NOTHING = ir.Constant(EIGHT.registers[0], [0.0] * WIDTH)


def _load(to: Any, place: Any) -> Any:
    pointer = to.builder.bitcast(place, NOTHING.type.as_pointer())
    return to.builder.load(pointer, align=UNALIGNED)


@operation(EIGHT, of=SINGLE)
def row(to, x, i):
    """Return row i of x (n, 8)."""
    return to.join(_load(to, to.place(x, i)))


@operation(types.void, of=SINGLE)
def put_row(to, x, i, value):
    """Write six numbers and two zeros into row i of x (n, 8)."""
    (own,) = to.split(value)
    padded = to.shuffle(own, NOTHING, [*range(UNKNOWNS), *range(WIDTH, 2 * WIDTH - UNKNOWNS)])
    place = to.builder.bitcast(to.place(x, i), padded.type.as_pointer())
    to.builder.store(padded, place, align=UNALIGNED)


@operation(LINES, of=SINGLE)
def lines(to, blocks, q):
    """Return the lines of block q of (n, 6, 6).

    Eight numbers are read for each, the last two being the next line's; the last line is read from
    two numbers before it, and nothing behind the block.
    """
    first, spare, last = to.place(blocks, q), WIDTH - UNKNOWNS, UNKNOWNS * (UNKNOWNS - 1)
    starts = [*range(0, last, UNKNOWNS), last - spare]
    registers = [_load(to, to.builder.gep(first, [INDEX(at)])) for at in starts]
    registers[-1] = to.shuffle(registers[-1], registers[-1], [*range(spare, WIDTH), *range(spare)])
    return [to.join(register) for register in registers]


@operation(types.void, of=SINGLE)
def fetch(to, blocks, q, ahead):
    """Prefetch the memory of the block ``ahead`` blocks behind block q.

    It may lie behind the last block or before the first: asking for it does nothing then.
    """
    builder, first, byte = to.builder, to.place(blocks, q), ir.IntType(8).as_pointer()
    form = ir.FunctionType(ir.VoidType(), [byte, INDEX, INDEX, INDEX])
    call = cgutils.get_or_insert_function(builder.module, form, "llvm.prefetch.p0i8")
    integer = ir.IntType(64)
    ahead = builder.mul(ahead, integer(UNKNOWNS**2))
    for at in range(0, UNKNOWNS**2, CACHE_LINE):
        place = builder.gep(first, [builder.add(ahead, integer(at))])
        to_read, kept, data = INDEX(0), INDEX(3), INDEX(1)
        builder.call(call, [builder.bitcast(place, byte), to_read, kept, data])


@operation(EIGHT)
def zeros(to):
    """Return six zeros."""
    return ZEROS


@operation(LINES)
def zero_lines(to):
    """Return lines of zeros."""
    return [ZEROS] * UNKNOWNS


@operation(LINES)
def spread(to, u):
    """Return for each of six numbers a register filled with it."""
    (u,) = to.split(u)
    return [to.join(to.shuffle(u, u, [k] * WIDTH)) for k in range(UNKNOWNS)]


@operation()
def add_lines(to, sums, x, k):
    """Return two sums with x_a k_a, of ``spread`` numbers and lines, added.

    Even lines are added to the first and odd ones to the second: neither waits for the other.
    """
    for a in range(UNKNOWNS):
        sums[a % 2] = to.plus_product(sums[a % 2], x[a], k[a])
    return sums


@operation()
def add_products(to, sums, k, x):
    """Return sums t_a with k_a x, number by number, added."""
    return [to.plus_product(t, own, x) for t, own in zip(sums, k, strict=True)]


@operation(EIGHT)
def totals(to, values):
    """Return the sums of six times eight numbers."""

    def halved(one: Any, other: Any) -> Any:
        even = to.shuffle(one, other, [0, 2, 8, 10, 4, 6, 12, 14])
        odd = to.shuffle(one, other, [1, 3, 9, 11, 5, 7, 13, 15])
        return to.builder.fadd(even, odd)

    u = [to.split(one)[0] for one in values]
    pairs = [halved(*u[k : k + 2]) for k in range(0, UNKNOWNS, 2)]
    one, other = halved(pairs[0], pairs[1]), halved(pairs[2], NOTHING)
    low = to.shuffle(one, other, [0, 1, 2, 3, 8, 9, 10, 11])
    high = to.shuffle(one, other, [4, 5, 6, 7, 12, 13, 14, 15])
    return to.join(to.builder.fadd(low, high))


@operation(SIX)
def double(to, u):
    """Return the six numbers in double precision, as compute/vec6.py has them."""
    (u,), registers, at = to.split(u), [], 0
    for kind in SIX.registers:
        part = to.shuffle(u, u, range(at, at + kind.count))
        registers.append(to.builder.fpext(part, kind))
        at += kind.count
    return to.join(*registers)
