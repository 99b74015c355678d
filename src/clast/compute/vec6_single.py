"""Six numbers in single precision at once, in one register for eight.

The single precision form of compute/vec6.py: half of the bytes, and half of the instructions.  A
value of type Eight is six numbers and two that do not count.  Vectors have rows of eight, (n, 8),
whose last two numbers are zero; blocks are (n, 6, 6) as everywhere.

Products are added without rounding in between where the processor can do so; sums keep the order
in which they are written.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types

from clast.compute.vec6 import (
    BOTH,
    FOUR,
    INDEX,
    SIX,
    TWO,
    UNALIGNED,
    operation,
    shuffle,
)

WIDTH = 8
"""Numbers in a row of a vector."""
NUMBER = ir.FloatType()
REGISTER = ir.VectorType(NUMBER, WIDTH)
LINE = 64
"""Bytes in a line of the cache."""
NOTHING = ir.Constant(REGISTER, [0.0] * WIDTH)


class Eight(types.Type):
    """The type of six numbers in single precision at once."""

    def __init__(self) -> None:
        super().__init__(name="Eight")


EIGHT = Eight()


@extending.register_model(Eight)
class _EightModel(extending.models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, REGISTER)


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return a pointer to the first number of row or block i of an array."""
    kind = signature.args[0]
    array = context.make_array(kind)(context, builder, arguments[0])
    at = [context.cast(builder, arguments[1], signature.args[1], types.intp)]
    at += [context.get_constant(types.intp, 0)] * (kind.ndim - 1)
    return cgutils.get_item_pointer(context, builder, kind, array, at, wraparound=False)


def _is_single(array: Any) -> bool:
    """Return whether it holds numbers in single precision: others would be misread."""
    return array.dtype == types.float32


def _load(builder: Any, place: Any) -> Any:
    return builder.load(builder.bitcast(place, REGISTER.as_pointer()), align=UNALIGNED)


def _add_product(builder: Any, y: Any, u: Any, v: Any) -> Any:
    """Return y + u v."""
    form = ir.FunctionType(REGISTER, [REGISTER] * 3)
    call = cgutils.get_or_insert_function(builder.module, form, "llvm.fmuladd.v8f32")
    return builder.call(call, [u, v, y])


@operation
def row(context, x, i):
    """Return row i of x (n, 8)."""
    if not _is_single(x):
        return None

    def made(context, builder, signature, arguments):
        return _load(builder, _place(context, builder, signature, arguments))

    return EIGHT(x, i), made


@operation
def put_row(context, x, i, value):
    """Write six numbers and two zeros into row i of x (n, 8)."""
    if not _is_single(x):
        return None

    def made(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        six = shuffle(builder, arguments[2], NOTHING, [0, 1, 2, 3, 4, 5, 8, 9])
        builder.store(six, builder.bitcast(place, REGISTER.as_pointer()), align=UNALIGNED)
        return context.get_dummy_value()

    return types.void(x, i, value), made


@operation
def lines(context, blocks, q):
    """Return the six lines of block q of (n, 6, 6).

    Eight numbers are read for each, the last two being the next line's; the last line is read from
    two numbers before it, and nothing behind the block.
    """
    if not _is_single(blocks):
        return None

    def made(context, builder, signature, arguments):
        first = _place(context, builder, signature, arguments)
        found = [_load(builder, builder.gep(first, [INDEX(at)])) for at in (0, 6, 12, 18, 24, 28)]
        found[5] = shuffle(builder, found[5], found[5], [2, 3, 4, 5, 6, 7, 0, 1])
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(EIGHT, 6)(blocks, q), made


@operation
def fetch(context, blocks, q, ahead):
    """Prefetch the memory of the block ``ahead`` blocks behind block q.

    It may lie behind the last block or before the first: asking for it does nothing then.
    """
    if not _is_single(blocks):
        return None

    def made(context, builder, signature, arguments):
        first = _place(context, builder, signature, arguments)
        byte = ir.IntType(8).as_pointer()
        form = ir.FunctionType(ir.VoidType(), [byte, INDEX, INDEX, INDEX])
        call = cgutils.get_or_insert_function(builder.module, form, "llvm.prefetch.p0i8")
        numbers = context.cast(builder, arguments[2], signature.args[2], types.int64)
        numbers = builder.mul(numbers, ir.IntType(64)(36))
        for line in range(0, 36, LINE // (signature.args[0].dtype.bitwidth // 8)):
            place = builder.gep(first, [builder.add(numbers, ir.IntType(64)(line))])
            to_read, kept, data = INDEX(0), INDEX(3), INDEX(1)
            builder.call(call, [builder.bitcast(place, byte), to_read, kept, data])
        return context.get_dummy_value()

    return types.void(blocks, q, ahead), made


@operation
def zeros(context):
    """Return six zeros."""

    def made(context, builder, signature, arguments):
        return NOTHING

    return EIGHT(), made


@operation
def spread(context, u):
    """Return for each of six numbers a register filled with it."""

    def made(context, builder, signature, arguments):
        (u,) = arguments
        found = [shuffle(builder, u, u, [k] * WIDTH) for k in range(6)]
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(EIGHT, 6)(u), made


@operation
def plus(context, u, v):
    """Return u + v."""

    def made(context, builder, signature, arguments):
        return builder.fadd(*arguments)

    return EIGHT(u, v), made


@operation
def minus(context, u, v):
    """Return u - v."""

    def made(context, builder, signature, arguments):
        return builder.fsub(*arguments)

    return EIGHT(u, v), made


@operation
def plus_product(context, y, u, v):
    """Return y + u v, number by number."""

    def made(context, builder, signature, arguments):
        return _add_product(builder, *arguments)

    return EIGHT(y, u, v), made


@operation
def totals(context, u0, u1, u2, u3, u4, u5):
    """Return the sums of six times eight numbers."""

    def made(context, builder, signature, arguments):
        def halved(one, other):
            even = shuffle(builder, one, other, [0, 2, 8, 10, 4, 6, 12, 14])
            odd = shuffle(builder, one, other, [1, 3, 9, 11, 5, 7, 13, 15])
            return builder.fadd(even, odd)

        pairs = [halved(*arguments[k : k + 2]) for k in (0, 2, 4)]
        one, other = halved(pairs[0], pairs[1]), halved(pairs[2], NOTHING)
        low = shuffle(builder, one, other, [0, 1, 2, 3, 8, 9, 10, 11])
        high = shuffle(builder, one, other, [4, 5, 6, 7, 12, 13, 14, 15])
        return builder.fadd(low, high)

    return EIGHT(u0, u1, u2, u3, u4, u5), made


@operation
def double(context, u):
    """Return the six numbers in double precision, as compute/vec6.py has them."""

    def made(context, builder, signature, arguments):
        (u,) = arguments
        four = builder.fpext(shuffle(builder, u, u, [0, 1, 2, 3]), FOUR)
        two = builder.fpext(shuffle(builder, u, u, [4, 5]), TWO)
        value = builder.insert_value(ir.Constant(BOTH, ir.Undefined), four, 0)
        return builder.insert_value(value, two, 1)

    return SIX(u), made
