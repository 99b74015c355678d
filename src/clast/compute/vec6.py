"""The unknowns of a block at once, in the processor's registers for several numbers.

A block has UNKNOWNS = 6 unknowns and its equations are 6 x 6 blocks: nearly all arithmetic of a
step is on six numbers in a row.  numba makes six instructions of a loop over them.  A value of type
Six is four numbers in one register and two in another, which every processor that numba knows has
or imitates; a line of a block times a number is then two instructions.

Arrays may hold numbers of single precision, which become double ones as they are read.

Products are added without rounding in between where the processor can do so; sums keep the order
in which they are written.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import update_wrapper
from typing import Any, ClassVar

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types

UNKNOWNS = 6
"""Unknowns of a block: registers, rows and blocks follow from it."""
REGISTER_WIDTH = 4
"""Numbers in double precision that a register holds at most."""
UNALIGNED = 4
"""Bytes to which the numbers of a row are aligned in memory at least."""
INDEX = ir.IntType(32)


class Vector(types.Type):
    """The type of the unknowns of a block at once, in registers of given types."""

    registers: ClassVar[tuple[Any, ...]]

    def __init__(self) -> None:
        super().__init__(name=type(self).__name__)


class Six(Vector):
    """In double precision."""

    registers = tuple(
        ir.VectorType(ir.DoubleType(), min(REGISTER_WIDTH, UNKNOWNS - k))
        for k in range(0, UNKNOWNS, REGISTER_WIDTH)
    )


@extending.register_model(Six)
class VectorModel(extending.models.PrimitiveModel):
    """How such a value is kept: a register each."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.LiteralStructType(kind.registers))


SIX = Six()


class Instructions:
    """Writes the instructions of an operation; ``kinds`` are the types of its arguments."""

    def __init__(self, context: Any, builder: Any, kinds: Sequence[Any]) -> None:
        self.context, self.builder, self.kinds = context, builder, kinds

    def split(self, value: Any) -> list[Any]:
        """Return the registers of a value."""
        return [self.builder.extract_value(value, k) for k in range(len(value.type.elements))]

    def join(self, *registers: Any) -> Any:
        """Return the value that has these registers."""
        value = ir.Constant(ir.LiteralStructType([one.type for one in registers]), ir.Undefined)
        for k, register in enumerate(registers):
            value = self.builder.insert_value(value, register, k)
        return value

    def each(self, work: Callable[..., Any], *values: Any) -> Any:
        """Return the value of ``work`` done register by register."""
        split = [self.split(value) for value in values]
        return self.join(*(work(*registers) for registers in zip(*split, strict=True)))

    def plus_product(self, y: Any, u: Any, v: Any) -> Any:
        """Return y + u v."""

        def added(of_y: Any, of_u: Any, of_v: Any) -> Any:
            kind = of_y.type
            name = f"llvm.fmuladd.v{kind.count}f{64 if kind.element == ir.DoubleType() else 32}"
            form = ir.FunctionType(kind, [kind, kind, kind])
            call = cgutils.get_or_insert_function(self.builder.module, form, name)
            return self.builder.call(call, [of_u, of_v, of_y])

        return self.each(added, y, u, v)

    def shuffle(self, one: Any, other: Any, chosen: Sequence[int]) -> Any:
        """Return ``chosen`` numbers of two registers, counted on from one to the other."""
        mask = ir.Constant(ir.VectorType(INDEX, len(chosen)), list(chosen))
        return self.builder.shuffle_vector(one, other, mask)

    def fill(self, number: Any, register: Any) -> Any:
        """Return a register of a type filled with one number."""
        undefined = ir.Constant(register, ir.Undefined)
        value = self.builder.insert_element(undefined, number, INDEX(0))
        return self.shuffle(value, value, [0] * register.count)

    def spread(self, number: Any) -> Any:
        """Return a value filled with one number."""
        return self.join(*(self.fill(number, register) for register in SIX.registers))

    def pair_sums(self, value: Any) -> Any:
        """Return two sums: of the numbers in even and in odd places."""
        pairs = [
            self.shuffle(one, one, [k, k + 1]) if one.type.count > 2 else one
            for one in self.split(value)
            for k in range(0, one.type.count, 2)
        ]
        summed = pairs[0]
        for pair in pairs[1:]:
            summed = self.builder.fadd(summed, pair)
        return summed

    def place(self, array: Any, *indices: Any) -> Any:
        """Return a pointer into the first argument, an array: the rest of its indices are 0."""
        kind, integer = self.kinds[0], ir.IntType(64)
        at = [integer(one) if isinstance(one, int) else one for one in indices]
        at += [integer(0)] * (kind.ndim - len(at))
        made = self.context.make_array(kind)(self.context, self.builder, array)
        return cgutils.get_item_pointer(
            self.context, self.builder, kind, made, at, wraparound=False
        )

    def number(self, array: Any, *indices: Any) -> Any:
        """Return a number of the first argument, in double precision."""
        number = self.builder.load(self.place(array, *indices))
        double = ir.DoubleType()
        return number if number.type == double else self.builder.fpext(number, double)

    def load(self, first: Any) -> Any:
        """Return the row whose first number is at a place."""
        registers = [
            self.builder.load(one, align=UNALIGNED) for one in self._places_of_registers(first)
        ]
        if first.type.pointee != ir.DoubleType():
            pairs = zip(registers, SIX.registers, strict=True)
            registers = [self.builder.fpext(*pair) for pair in pairs]
        return self.join(*registers)

    def store(self, first: Any, value: Any) -> None:
        """Write a row whose first number is at a place."""
        places = self._places_of_registers(first)
        for register, place in zip(self.split(value), places, strict=True):
            if place.type.pointee != register.type:
                register = self.builder.fptrunc(register, place.type.pointee)
            self.builder.store(register, place, align=UNALIGNED)

    def _places_of_registers(self, first: Any) -> list[Any]:
        places, at = [], 0
        for register in SIX.registers:
            kept = ir.VectorType(first.type.pointee, register.count).as_pointer()
            places.append(self.builder.bitcast(self.builder.gep(first, [INDEX(at)]), kept))
            at += register.count
        return places


def constant(kind: Vector, *numbers: float) -> Any:
    """Return a value of given numbers."""
    left, registers = list(numbers), []
    for register in kind.registers:
        registers.append(ir.Constant(register, left[: register.count]))
        left = left[register.count :]
    return ir.Constant(ir.LiteralStructType(kind.registers), registers)


ZEROS = constant(SIX, *[0.0] * UNKNOWNS)


def operation(returned: Any = None, *, of: Any = None) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator that makes an operation of kernels from what writes its instructions.

    It is given Instructions and the arguments, tuples as lists; a list becomes a tuple.  The
    operation returns a value of type ``returned``, that of the first argument if None.  Where the
    first argument has to be an array of numbers ``of`` a type, it is refused for others.
    """

    def declared(kind: Any) -> Any:
        if isinstance(kind, types.Integer):
            return types.intp
        return types.float64 if isinstance(kind, types.Float) else kind

    def made(work: Callable[..., Any]) -> Any:
        def typed(context: Any, *given: Any) -> Any:
            if of is not None and given[0].dtype != of:
                return None
            kinds = [declared(one) for one in given]

            def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
                values = [
                    cgutils.unpack_tuple(builder, value)
                    if isinstance(kind, types.BaseTuple)
                    else value
                    for kind, value in zip(kinds, arguments, strict=True)
                ]
                result = work(Instructions(context, builder, kinds), *values)
                if isinstance(result, list):
                    return context.make_tuple(builder, signature.return_type, result)
                return context.get_dummy_value() if result is None else result

            return (kinds[0] if returned is None else returned)(*kinds), write

        return extending.intrinsic(update_wrapper(typed, work))

    return made


@operation(SIX)
def row(to, x, i):
    """Return row i of x (n, 6)."""
    return to.load(to.place(x, i))


@operation(SIX)
def line(to, blocks, i, a):
    """Return line a of block i of (n, 6, 6)."""
    return to.load(to.place(blocks, i, a))


@operation(types.void)
def put_row(to, x, i, value):
    """Write six numbers into row i of x (n, 6)."""
    to.store(to.place(x, i), value)


@operation(types.void)
def put_line(to, blocks, i, a, value):
    """Write six numbers into line a of block i of (n, 6, 6)."""
    to.store(to.place(blocks, i, a), value)


@operation(SIX)
def zeros(to):
    """Return six zeros."""
    return ZEROS


@operation()
def plus(to, u, v):
    """Return u + v."""
    return to.each(to.builder.fadd, u, v)


@operation()
def minus(to, u, v):
    """Return u - v."""
    return to.each(to.builder.fsub, u, v)


@operation(SIX)
def plus_scaled(to, y, factor, v):
    """Return y + factor v for a number ``factor``."""
    return to.plus_product(y, to.spread(factor), v)


@operation()
def plus_product(to, y, u, v):
    """Return y + u v, number by number."""
    return to.plus_product(y, u, v)


@operation(types.float64)
def total(to, u):
    """Return the sum of six numbers."""
    two = to.pair_sums(u)
    return to.builder.fadd(*(to.builder.extract_element(two, INDEX(k)) for k in range(2)))


@operation(types.float64)
def inner(to, u, v):
    """Return u.v."""
    two = to.pair_sums(to.plus_product(ZEROS, u, v))
    return to.builder.fadd(*(to.builder.extract_element(two, INDEX(k)) for k in range(2)))


@operation(types.UniTuple(types.float64, UNKNOWNS))
def numbers(to, u):
    """Return the six numbers one by one.

    Loops in which six numbers are read at once stay as they are written: LLVM would work on eight
    contacts at a time and gather the numbers of their blocks one by one, which takes AMD's
    processors two to three times as long.
    """
    return [
        to.builder.extract_element(register, INDEX(k))
        for register in to.split(u)
        for k in range(register.type.count)
    ]


@operation(SIX)
def with_number(to, u, k, number):
    """Return the six numbers with ``number`` in place k."""
    result, first = [], 0
    for register in to.split(u):
        count = register.type.count
        whole = ir.VectorType(ir.IntType(64), count)
        places = ir.Constant(whole, [first + c for c in range(count)])
        chosen = to.builder.icmp_signed("==", places, to.fill(k, whole))
        result.append(to.builder.select(chosen, to.fill(number, register.type), register))
        first += count
    return to.join(*result)


@operation(SIX)
def six(to, a, b, c, d, e, f):
    """Return six numbers, given one by one."""
    left, registers = [a, b, c, d, e, f], []
    for kind in SIX.registers:
        register = ir.Constant(kind, ir.Undefined)
        for k in range(kind.count):
            register = to.builder.insert_element(register, left.pop(0), INDEX(k))
        registers.append(register)
    return to.join(*registers)
