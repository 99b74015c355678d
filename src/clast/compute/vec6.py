"""The six numbers of a block at once, in the processor's registers for several numbers.

A block has six unknowns and its equations are 6 x 6 blocks: nearly all arithmetic of a step is on
six numbers in a row.  numba makes six instructions of a loop over them.  A value of type Six is
four numbers in one register and two in another, which every processor that numba knows has or
imitates; a line of a block times a number is then two instructions.

Arrays may hold numbers of single precision, which become double ones as they are read.

Products are added without rounding in between where the processor can do so; sums keep the order
in which they are written.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types

NUMBER = ir.DoubleType()
FOUR, TWO = ir.VectorType(NUMBER, 4), ir.VectorType(NUMBER, 2)
BOTH = ir.LiteralStructType([FOUR, TWO])
SINGLE_FOUR, SINGLE_TWO = (ir.VectorType(ir.FloatType(), k) for k in (4, 2))
INDEX = ir.IntType(32)
KEPT = {
    types.float64: (FOUR, TWO),
    types.float32: (SINGLE_FOUR, SINGLE_TWO),
}
"""How six numbers lie in an array of each kind."""
UNALIGNED = 4
"""Bytes to which six numbers are aligned in memory at least."""
operation: Any = extending.intrinsic
"""Makes of a function's own account of its type and its instructions one that kernels can call."""


class Six(types.Type):
    """The type of six numbers at once."""

    def __init__(self) -> None:
        super().__init__(name="Six")


SIX = Six()


@extending.register_model(Six)
class _SixModel(extending.models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, BOTH)


def _join(builder, four, two):
    value = builder.insert_value(ir.Constant(BOTH, ir.Undefined), four, 0)
    return builder.insert_value(value, two, 1)


def _part(builder, value):
    return builder.extract_value(value, 0), builder.extract_value(value, 1)


def _places(context, builder, signature, arguments, indices):
    """Return pointers to the first four and the last two of the numbers at ``indices``."""
    array_type = signature.args[0]
    four_of, two_of = KEPT[array_type.dtype]
    array = context.make_array(array_type)(context, builder, arguments[0])
    at = [
        context.cast(builder, arguments[k], signature.args[k], types.intp)
        for k in range(1, 1 + indices)
    ]
    at.append(context.get_constant(types.intp, 0))
    first = cgutils.get_item_pointer(context, builder, array_type, array, at, wraparound=False)
    return (
        builder.bitcast(first, four_of.as_pointer()),
        builder.bitcast(builder.gep(first, [INDEX(4)]), two_of.as_pointer()),
    )


def _load(context, builder, signature, arguments):
    places = _places(context, builder, signature, arguments, len(signature.args) - 1)
    found, kind = [builder.load(place, align=UNALIGNED) for place in places], signature.args[0]
    if kind.dtype != types.float64:
        found = [builder.fpext(*pair) for pair in zip(found, (FOUR, TWO), strict=True)]
    return _join(builder, *found)


def _store(context, builder, signature, arguments):
    places = _places(context, builder, signature, arguments, len(signature.args) - 2)
    found, kind = _part(builder, arguments[-1]), signature.args[0]
    if kind.dtype != types.float64:
        singles = (SINGLE_FOUR, SINGLE_TWO)
        found = [builder.fptrunc(*pair) for pair in zip(found, singles, strict=True)]
    for part, place in zip(found, places, strict=True):
        builder.store(part, place, align=UNALIGNED)
    return context.get_dummy_value()


def _spread(builder, number, kind):
    """Return a register filled with one number."""
    value = builder.insert_element(ir.Constant(kind, ir.Undefined), number, INDEX(0))
    return shuffle(builder, value, value, [0] * kind.count)


def shuffle(builder, one, other, chosen):
    """Return the ``chosen`` of the numbers of two registers, counted on from one to the other."""
    mask = ir.Constant(ir.VectorType(INDEX, len(chosen)), chosen)
    return builder.shuffle_vector(one, other, mask)


def _add_products(builder, y, u, v):
    """Return y + u v, part by part."""
    result = []
    for kind, of_y, of_u, of_v in zip((FOUR, TWO), y, u, v, strict=True):
        name = f"llvm.fmuladd.v{kind.count}f64"
        form = ir.FunctionType(kind, [kind, kind, kind])
        call = cgutils.get_or_insert_function(builder.module, form, name)
        result.append(builder.call(call, [of_u, of_v, of_y]))
    return _join(builder, *result)


def _halved(builder, value):
    """Return two sums of three of the six numbers each."""
    four, two = _part(builder, value)
    low, high = shuffle(builder, four, four, [0, 1]), shuffle(builder, four, four, [2, 3])
    return builder.fadd(builder.fadd(low, high), two)


@operation
def row(context, x, i):
    """Return row i of x (n, 6)."""
    return SIX(x, i), _load


@operation
def line(context, blocks, i, a):
    """Return line a of block i of (n, 6, 6)."""
    return SIX(blocks, i, a), _load


@operation
def put_row(context, x, i, value):
    """Write six numbers into row i of x (n, 6)."""
    return types.void(x, i, value), _store


@operation
def put_line(context, blocks, i, a, value):
    """Write six numbers into line a of block i of (n, 6, 6)."""
    return types.void(blocks, i, a, value), _store


@operation
def zeros(context):
    """Return six zeros."""

    def made(context, builder, signature, arguments):
        return ir.Constant(BOTH, [ir.Constant(FOUR, [0.0] * 4), ir.Constant(TWO, [0.0] * 2)])

    return SIX(), made


@operation
def plus(context, u, v):
    """Return u + v."""

    def made(context, builder, signature, arguments):
        one, other = _part(builder, arguments[0]), _part(builder, arguments[1])
        return _join(builder, builder.fadd(one[0], other[0]), builder.fadd(one[1], other[1]))

    return SIX(u, v), made


@operation
def plus_scaled(context, y, factor, v):
    """Return y + factor v for a number ``factor``."""

    def made(context, builder, signature, arguments):
        y, factor, v = arguments
        spread = _spread(builder, factor, FOUR), _spread(builder, factor, TWO)
        return _add_products(builder, _part(builder, y), spread, _part(builder, v))

    return SIX(y, types.float64, v), made


@operation
def plus_product(context, y, u, v):
    """Return y + u v, number by number."""

    def made(context, builder, signature, arguments):
        return _add_products(builder, *(_part(builder, value) for value in arguments))

    return SIX(y, u, v), made


@operation
def total(context, u):
    """Return the sum of six numbers."""

    def made(context, builder, signature, arguments):
        two = _halved(builder, arguments[0])
        one, other = (builder.extract_element(two, INDEX(k)) for k in range(2))
        return builder.fadd(one, other)

    return types.float64(u), made


@operation
def numbers(context, u):
    """Return the six numbers one by one.

    Loops in which six numbers are read at once stay as they are written: LLVM would work on eight
    contacts at a time and gather the numbers of their blocks one by one, which takes AMD's
    processors two to three times as long.
    """

    def made(context, builder, signature, arguments):
        parts = [
            (part, kind.count)
            for part, kind in zip(_part(builder, arguments[0]), (FOUR, TWO), strict=True)
        ]
        found = [
            builder.extract_element(part, INDEX(k)) for part, count in parts for k in range(count)
        ]
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(types.float64, 6)(u), made


@operation
def totals(context, u0, u1, u2, u3, u4, u5):
    """Return the sums of six times six numbers."""

    def made(context, builder, signature, arguments):
        halves = [_halved(builder, value) for value in arguments]
        sums = []
        for one, other in zip(halves[::2], halves[1::2], strict=True):
            even, odd = (shuffle(builder, one, other, [k, 2 + k]) for k in range(2))
            sums.append(builder.fadd(even, odd))
        return _join(builder, shuffle(builder, sums[0], sums[1], [0, 1, 2, 3]), sums[2])

    return SIX(u0, u1, u2, u3, u4, u5), made


@operation
def with_number(context, u, k, number):
    """Return the six numbers with ``number`` in place k."""

    def made(context, builder, signature, arguments):
        u, k, number = arguments
        place = context.cast(builder, k, signature.args[1], types.int64)
        result = []
        for kind, value, first in zip((FOUR, TWO), _part(builder, u), (0, 4), strict=True):
            whole = ir.VectorType(ir.IntType(64), kind.count)
            places = ir.Constant(whole, [first + c for c in range(kind.count)])
            wanted = builder.insert_element(ir.Constant(whole, ir.Undefined), place, INDEX(0))
            wanted = shuffle(builder, wanted, wanted, [0] * kind.count)
            chosen = builder.icmp_signed("==", places, wanted)
            result.append(builder.select(chosen, _spread(builder, number, kind), value))
        return _join(builder, *result)

    return SIX(u, k, types.float64), made


@operation
def six(context, a, b, c, d, e, f):
    """Return six numbers."""

    def made(context, builder, signature, arguments):
        four, two = ir.Constant(FOUR, ir.Undefined), ir.Constant(TWO, ir.Undefined)
        for k in range(4):
            four = builder.insert_element(four, arguments[k], INDEX(k))
        for k in range(2):
            two = builder.insert_element(two, arguments[4 + k], INDEX(k))
        return _join(builder, four, two)

    return SIX(*[types.float64] * 6), made
