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
from numba import extending
from numba import prange as prange
from numba.core import cgutils, types
from numba.np.ufunc import parallel as numba_threads

from clast.compute.jit import BY_THREADS, kernel, start_threads

start_threads()


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
        for part in prange((count + {part} - 1) // {part}):
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
    for part in prange(len(sums)):
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
    # numba has one lock for a process and its forks, and a fork that is killed would keep it
    numba_threads._backend_init_process_lock = None
    numba.set_num_threads(1)
    if numba_threads.threading_layer() != "omp":
        return
    # numba refuses OpenMP to any other process than the one that last asked for its threads.  It
    # does not start them a second time.
    address = getattr(importlib.import_module("numba.np.ufunc.omppool"), "launch_threads", None)
    if address is not None:
        ctypes.CFUNCTYPE(None, ctypes.c_int)(address)(1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=work_alone)
