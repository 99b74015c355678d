"""Loops that threads share, each in its own stretch first and then wherever work is left.

Threads are never equally fast: one may have to share its core or its part of the cache.  Halves of
a loop would both wait for the slower thread; so each takes piece after piece of its own stretch,
and when that is done pieces of the others'.  Its own comes first, for what it has in its cache.
Which thread does a piece must be of no account: pieces write to places of their own, and sums are
made piece by piece.  So::

    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for piece in to_do(thread, progress, pieces):
            ...
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import extending
from numba import prange as prange
from numba.core import cgutils, types
from numba.core.imputils import RefType, impl_ret_borrowed, iternext_impl

from clast.compute.jit import kernel, start_threads
from clast.compute.vec6 import operation

start_threads()
LINE = 8
"""Numbers in a line of the cache, which two threads had better not write to both."""
PROGRESS = types.Array(types.int64, 1, "C")
"""The type of the numbers of pieces that have been taken, LINE for each thread."""


class ToDo(types.IteratorType):
    """The type of the pieces that are left for a thread."""

    yield_type = types.int64

    def __init__(self) -> None:
        super().__init__("ToDo")


TO_DO = ToDo()


@extending.register_model(ToDo)
class _ToDoModel(extending.models.StructModel):
    def __init__(self, manager, kind):
        members = [("thread", types.int64), ("progress", PROGRESS), ("pieces", types.int64)]
        super().__init__(manager, kind, members)


@operation
def _taken(context, progress, at):
    """Return how many pieces have been taken at ``at``, and add one before anybody else asks."""

    def made(context, builder, signature, arguments):
        array = context.make_array(PROGRESS)(context, builder, arguments[0])
        place = cgutils.get_item_pointer(
            context, builder, PROGRESS, array, [arguments[1]], wraparound=False
        )
        return builder.atomic_rmw("add", place, ir.IntType(64)(1), "monotonic")

    return types.int64(PROGRESS, types.int64), made


def _next_piece(thread, progress, pieces):
    """Return a piece that no thread has taken yet, of 0 to ``pieces`` - 1, or -1: none is left."""
    threads = len(progress) // LINE
    for k in range(threads):
        whose = (thread + k) % threads
        first, last = whose * pieces // threads, (whose + 1) * pieces // threads
        piece = first + _taken(progress, LINE * whose)
        if piece < last:
            return piece
    return -1


@operation
def _threads(context):
    """Return the number of threads; numba's own get_num_threads cannot be kept on disk."""

    def made(context, builder, signature, arguments):
        number = context.get_value_type(types.intp)  # an int: the lower half counts
        form = ir.FunctionType(number, [])
        asked = cgutils.get_or_insert_function(builder.module, form, "get_num_threads")
        return builder.sext(builder.trunc(builder.call(asked, []), ir.IntType(32)), number)

    return types.intp(), made


@kernel()
def nothing_done():
    """Return how many pieces of the stretch of each thread have been taken: none."""
    return np.zeros(LINE * _threads(), np.int64)


@kernel()
def threads_of(progress):
    """Return the number of threads."""
    return len(progress) // LINE


@operation
def to_do(context, thread, progress, pieces):
    """Return one after the other the pieces, 0 to ``pieces`` - 1, that no thread has taken yet."""

    def made(context, builder, signature, arguments):
        value = cgutils.create_struct_proxy(TO_DO)(context, builder)
        value.thread, value.progress, value.pieces = arguments
        return impl_ret_borrowed(context, builder, TO_DO, value._getvalue())

    return TO_DO(types.int64, PROGRESS, types.int64), made


@extending.lower_builtin("getiter", ToDo)
def _begin(context, builder, signature, arguments):
    return impl_ret_borrowed(context, builder, TO_DO, arguments[0])


@extending.lower_builtin("iternext", ToDo)
@iternext_impl(RefType.UNTRACKED)
def _continue(context, builder, signature, arguments, result):
    value = cgutils.create_struct_proxy(TO_DO)(context, builder, value=arguments[0])
    form = types.int64(types.int64, PROGRESS, types.int64)
    given = [value.thread, value.progress, value.pieces]
    piece = context.compile_internal(builder, _next_piece, form, given)
    any_left = builder.icmp_signed(">=", piece, ir.IntType(64)(0))
    result.set_valid(any_left)
    with builder.if_then(any_left):
        result.yield_(piece)
