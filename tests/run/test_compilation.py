"""What is compiled is said, counted, and no part of the time that a run is said to take."""

from __future__ import annotations

import time
from io import StringIO
from types import FunctionType

from numba import njit
from numba.extending import overload
from rich.console import Console
from rich.progress import Progress

from clast.compute.compilation import COMPILATION, Stages, working_time
from clast.run.progress import WAITING, ProgressLine, compilation_told


def kernel_of(module: str):
    """Return a kernel not compiled yet, as if ``module`` had it, which takes 0.05 s and more."""

    def slowly(x):
        return x

    @overload(slowly)
    def _slowly(x):
        time.sleep(0.05)  # runs while whoever calls it is compiled, the first time
        return lambda x: x

    def function(x):
        return slowly(x) + 1

    own = FunctionType(function.__code__, {}, closure=function.__closure__)
    own.__module__ = module
    return njit(own)


def test_time_of_compilation_is_not_time_of_work():
    kernel, stages = kernel_of("clast.contact.made_up"), Stages()
    compiled, begun = COMPILATION.seconds, working_time()
    with stages("contacts"):
        assert kernel(1) == 2
    worked = working_time() - begun
    assert COMPILATION.seconds - compiled >= 0.05
    assert stages.seconds["contacts"] <= worked < COMPILATION.seconds - compiled


def test_what_is_waited_for_is_told_once_and_kernels_are_counted():
    said: list[str] = []
    before = COMPILATION.kernels
    with compilation_told(said.append):
        for module in ("clast.contact.one", "clast.contact.two", "clast.linear.one", "elsewhere"):
            kernel_of(module)(1)
    assert COMPILATION.kernels == before + 3
    assert said[:-1] == [WAITING]
    assert WAITING.startswith("compiling") and "`clast warmup`" in WAITING
    assert said[-1].startswith("compiled 3 kernels in ")
    kernel_of("clast.contact.three")(1)
    assert len(said) == 2


def test_the_line_of_a_run_says_what_is_compiled():
    kernel = kernel_of("clast.contact.shown")
    with Progress(console=Console(file=StringIO(), force_terminal=True)) as bar:
        line = ProgressLine(bar)
        with COMPILATION.telling(line.compiling):
            kernel(1)
        assert "contact detection and friction" in bar.tasks[0].description


def test_nothing_is_said_where_nothing_is_compiled():
    kernel, said = kernel_of("clast.contact.known"), []
    kernel(1)
    with compilation_told(said.append):
        kernel(2)
    assert said == []
