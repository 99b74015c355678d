"""Compiles the kernels of cases ahead of the first run, by as many processes as there are cores.

Kernels that Python calls are listed (compute/roots.py), and each kernel of the list can be compiled
by itself.  Those of one file use the same others and are compiled by one process, unless a file is
so large that the rest would wait for it.  The longest begin first.

The list is made of the kernels that a few runs call (tools/compile_cost.py): each process, law,
rule and solver once.

Python's own bytecode is written with it.  Where it is missing, and PYTHONDONTWRITEBYTECODE keeps
commands from writing it, each of them translates 200 files anew, for a third of a second.
"""

from __future__ import annotations

import compileall
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context

from clast.compute.jit import PACKAGE
from clast.compute.roots import Root, TypingError, listed

Watch = Callable[[str, int, int], None]
"""Called with the module compiled last, and how many tenths of seconds of how many are over."""


def warm_up(
    watch: Watch = lambda _text, _done, _of: None,
    *,
    workers: int | None = None,
    of: Sequence[str] = ("first", "others"),
) -> None:
    """Compile the kernels of cases, as far as they are not on disk, by so many ``workers``.

    One for each core if not given.  ``of`` are parts of the list: "first" has the kernels of the
    incline.
    """
    compileall.compile_dir(PACKAGE, quiet=2)  # where it may not write there is no bytecode
    roots = listed()
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:  # not everywhere
        cores = os.cpu_count() or 1
    jobs = share_out([root for part in of for root in roots[part]], workers or cores)
    whole, done = sum(job.weight for job in jobs), 0
    # a forked process would have the threads of this one, but not their locks
    with ProcessPoolExecutor(workers or cores, mp_context=get_context("spawn")) as pool:
        going_on = {pool.submit(job.compile): job for job in jobs}
        for ended in as_completed(going_on):
            ended.result()
            done += going_on[ended].weight
            module = going_on[ended].roots[0].module
            watch(module.removeprefix("clast.").replace(".", "/"), done, whole)


@dataclass(frozen=True)
class CompileJob:
    """Kernels that one process compiles."""

    roots: tuple[Root, ...]

    @property
    def weight(self) -> int:
        """Tenths of seconds that they take on the machine that made the list."""
        return round(10.0 * sum(root.seconds for root in self.roots))

    def compile(self) -> None:
        """Compile them; one that the list has wrong is compiled when it is first needed."""
        for root in self.roots:
            with suppress(LookupError, TypeError, TypingError):
                root.compile()


def share_out(roots: Iterable[Root], workers: int) -> list[CompileJob]:
    """Return the groups of kernels that are compiled together, the largest first.

    A file that has more than half of the work of a process is taken apart.
    """
    files: dict[str, list[Root]] = defaultdict(list)
    for root in roots:
        if root.is_there:
            files[root.module].append(root)
    whole = [CompileJob(tuple(file)) for file in files.values()]
    fair = sum(job.weight for job in whole) / (2 * workers)
    jobs = []
    for job in whole:
        parts = [CompileJob((one,)) for one in job.roots]
        jobs += parts if job.weight > fair else [job]
    return sorted(jobs, key=lambda job: -job.weight)
