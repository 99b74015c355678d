"""Loops over blocks and contacts that threads share, from a body that says nothing of threads.

    @shared(BLOCKS)
    def add(first, last, a, b, total):
        for i in range(first, last):
            total[i] = a[i] + b[i]

    add(len(a), a, b, total)

The body does the pieces ``first`` to ``last`` - 1 of a loop, and writes to places of their own.
The result of ``shared`` takes the length of the loop first; ``summed`` makes a function that
returns the sum of the body's results for each part, in the order of the parts.  Parts do not depend
on the number of threads, and so neither does any digit.

Code for several threads takes longer to compile than all else.  A process that has one thread, as
all have that do not ask for more by NUMBA_NUM_THREADS, compiles and keeps a plain loop instead, and
the body within it: that takes a third of the time of body and loop by themselves.

Threads are never equally fast: one may have to share its core or its part of the cache.  Halves of
a loop would both wait for the slower thread; so each takes part after part of its own stretch, and
when that is done parts of the others'.  Its own comes first, for the code in its cache.
"""

from __future__ import annotations

import ctypes
import importlib
import inspect
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import extending
from numba import prange as prange
from numba.core import cgutils, types
from numba.core.imputils import RefType, impl_ret_borrowed, iternext_impl
from numba.np.ufunc.parallel import threading_layer

from clast.compute.jit import BY_THREADS, kernel, start_threads

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


@extending.intrinsic
def _taken(context, progress, at):
    """Return how many pieces have been taken at ``at``, and add one before anybody else asks."""

    def made(context, builder, signature, arguments):
        array = context.make_array(PROGRESS)(context, builder, arguments[0])
        place = cgutils.get_item_pointer(
            context, builder, PROGRESS, array, [arguments[1]], wraparound=False
        )
        return builder.atomic_rmw("add", place, ir.IntType(64)(1), "monotonic")

    return types.int64(PROGRESS, types.int64), made


def _next_piece(thread: int, progress: Any, pieces: int) -> int:
    """Return a piece that no thread has taken yet, of 0 to ``pieces`` - 1, or -1: none is left."""
    threads = len(progress) // LINE
    for k in range(threads):
        whose = (thread + k) % threads
        first, last = whose * pieces // threads, (whose + 1) * pieces // threads
        piece = first + _taken(progress, LINE * whose)
        if piece < last:
            return piece
    return -1


@extending.intrinsic
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


@extending.intrinsic
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


# Arrays without owners ---------------------------------------------------------------------------


def _disowned(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Return an array, or the arrays of a tuple, without its owner."""
    if isinstance(kind, types.Array):
        array = cgutils.create_struct_proxy(kind)(context, builder, value=value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        kinds: Any = kind
        parts = cgutils.unpack_tuple(builder, value, len(kinds))
        lent = [_disowned(context, builder, *one) for one in zip(kinds, parts, strict=True)]
        return context.make_tuple(builder, kind, lent)
    return value


@extending.intrinsic
def borrowed(context, value):
    """Return an array, a tuple of such, or a number, whose references are not counted.

    Who calls a loop keeps its arrays while it runs.  Counting references takes an atomic operation
    for each array that is taken out of a tuple, which in loops over vertices was half of the time;
    threads get their arrays without owners in any case.
    """

    def made(context, builder, signature, arguments):
        return _disowned(context, builder, value, arguments[0])

    return value(value), made


# Loops that threads share ------------------------------------------------------------------------


@dataclass(frozen=True)
class Sharing:
    """The length of a loop from which threads share it, and the size of their parts."""

    part: int
    """Length of the part of a thread at a time."""
    many: int
    """Length of a loop from which threads share it; below, starting them costs more."""


BLOCKS = Sharing(part=128, many=800)
"""Loops over blocks."""
CONTACTS = Sharing(part=1024, many=3000)
"""Loops over contacts, pairs and vertices, with each of which little is done."""
EACH = Sharing(part=1, many=2)
"""Loops over a few large pieces of work."""

# A 0 in a call would be a type of its own to numba, and have the body compiled a second time.
LOOP = """
def {name}(count, {names}):
    {lent} = {lending}
    at_once = max(count, 1) if count < {many} else {part}
    for begin in range(0, count, at_once):
        {body}(begin, min(begin + at_once, count), {passed})
"""
LOOP_BY_THREADS = """
def {name}(count, {names}):
    if count < {many}:
        {body}(min(count, 0), count, {names})
    else:
        progress = nothing_done()
        for thread in prange(threads_of(progress)):
            for part in to_do(thread, progress, (count + {part} - 1) // {part}):
                {body}(part * {part}, min((part + 1) * {part}, count), {names})
"""
SUM = """
def {name}(count, {names}):
    {lent} = {lending}
    at_once = max(count, 1) if count < {many} else {part}
    sums = np.empty((count + at_once - 1) // at_once)
    for piece in range(len(sums)):
        begin = piece * at_once
        sums[piece] = {body}(begin, min(begin + at_once, count), {passed})
    return sums.sum()
"""
SUM_BY_THREADS = """
def {name}(count, {names}):
    if count < {many}:
        return {body}(min(count, 0), count, {names})
    sums = np.empty((count + {part} - 1) // {part})
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(sums)):
            sums[part] = {body}(part * {part}, min((part + 1) * {part}, count), {names})
    total = 0.0
    for part in range(len(sums)):  # sums.sum() would be made by threads, in their order
        total += sums[part]
    return total
"""


def shared(sharing: Sharing, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator that makes a loop of a body ``(first, last, ...)``, which returns None.

    The loop is called with its length in place of ``first`` and ``last``; ``options`` are those of
    ``kernel`` for the body, which may be a kernel already.
    """
    return _loop(LOOP, LOOP_BY_THREADS, sharing, options)


def summed(sharing: Sharing, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator that makes a sum of a body ``(first, last, ...)``, which returns it."""
    return _loop(SUM, SUM_BY_THREADS, sharing, options)


def _loop(
    alone: str, by_threads: str, sharing: Sharing, options: dict[str, Any]
) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator that fills in one of the two texts."""

    def made(body: Any) -> Any:
        kept = options if BY_THREADS else {**options, "inline": "always"}
        compiled = body if hasattr(body, "py_func") else kernel(**kept)(body)
        function = compiled.py_func
        given = list(inspect.signature(function).parameters)[2:]
        name = f"{function.__name__}_loop"  # numba keeps it beside the body, under its name
        text = (by_threads if BY_THREADS else alone).format(
            name=name,
            names=", ".join(given),
            lent=", ".join(f"{one}_" for one in given) + ",",
            passed=", ".join(f"{one}_" for one in given),
            lending=", ".join(f"borrowed({one})" for one in given) + ",",
            body="_body",
            part=sharing.part,
            many=sharing.many,
        )
        known = {
            "_body": compiled,
            "np": np,
            "borrowed": borrowed,
            "prange": prange,
            "nothing_done": nothing_done,
            "threads_of": threads_of,
            "to_do": to_do,
            "__name__": function.__module__,
        }
        code = compile(text.lstrip(), function.__code__.co_filename, "exec")
        exec(code, known)
        loop: Any = known[name]
        loop.__module__, loop.__doc__ = function.__module__, function.__doc__
        loop.__code__ = loop.__code__.replace(co_firstlineno=function.__code__.co_firstlineno)
        return kernel(parallel=BY_THREADS, **options)(loop)

    return made


# How many threads take part ----------------------------------------------------------------------


@contextmanager
def threads_worth(blocks: int) -> Iterator[None]:
    """Let one thread work alone, as long as this lasts, where there are too few ``blocks``.

    Nothing that takes long is shared then, but calling the others for the rest costs time.
    """
    asked = numba.get_num_threads()
    if blocks < BLOCKS.many:
        numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(asked)


def work_alone() -> None:
    """Let one thread do all the work of this process, which was forked from one with more.

    GNU's OpenMP would wait for ever for its threads, which did not come along, and numba ends a
    process that calls it there.  By one thread it is sound; the results are the same.
    """
    numba.set_num_threads(1)
    if threading_layer() != "omp":
        return
    # numba refuses OpenMP to any other process than the one that last asked for its threads.  It
    # does not start them a second time.
    address = getattr(importlib.import_module("numba.np.ufunc.omppool"), "launch_threads", None)
    if address is not None:
        ctypes.CFUNCTYPE(None, ctypes.c_int)(address)(1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=work_alone)
