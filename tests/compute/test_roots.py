"""The list of kernels that are compiled ahead."""

from __future__ import annotations

import inspect
import subprocess
import sys
from typing import NamedTuple

import pytest
from numba.core import types

from clast.compute.roots import Root, listed, text_of, types_of
from clast.studies.warmup import share_out


class Pair(NamedTuple):
    """Arguments by name, as a kernel may take them."""

    first: int
    second: object


ROOTS = [root for roots in listed().values() for root in roots]
THERE = [root for root in ROOTS if root.is_there]


def fits(root: Root) -> bool:
    """Return whether a kernel is there, and takes as many arguments as are listed."""
    if not root.is_there:
        return False
    arguments = inspect.signature(root.kernel().py_func).parameters
    return len(types_of(root.types)) == len(arguments)


def test_what_is_listed_is_there_and_takes_as_many_arguments():
    """One in ten may have changed since: a kernel that the list lacks is compiled when needed."""
    wrong = [f"{one.module}.{one.name}" for one in ROOTS if not fits(one)]
    assert 10 * len(wrong) <= len(ROOTS), f"python -m tools.compile_cost --write: {wrong}"


LACKING = """
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.compute.roots import called, listed
for process in ("convex", "modified", "open-close"):
    Case.from_toml(INCLINE, ["time.end=0.003", f"method.process={process}"]).run()
known = {root for roots in listed().values() for root in roots}
print(*sorted({f"{one.module}.{one.name}" for one in set(called()) - known}))
"""


@pytest.mark.slow
def test_what_small_cases_call_is_listed():
    """In a process of its own: other tests call other kernels."""
    done = subprocess.run([sys.executable, "-c", LACKING], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [], "python -m tools.compile_cost --write"


@pytest.mark.parametrize(
    "given",
    [
        (types.int64, types.boolean, types.float32, types.none),
        (types.Array(types.float64, 2, "C"), types.Array(types.int64, 1, "A")),
        (types.Tuple((types.Array(types.boolean, 1, "C"), types.int64)), types.float64),
        (types.UniTuple(types.float64, 3),),
        (types.NamedTuple((types.int64, types.Array(types.boolean, 1, "C")), Pair),),
        (types.Tuple((types.Tuple((types.int64, types.float64)), types.float64)),),
    ],
)
def test_types_are_read_as_they_are_written(given):
    assert types_of(f"({text_of(given)})") == given


def test_work_is_shared_out_the_largest_first_and_nothing_is_lost():
    gone = Root("clast.block.polygon", "no_such_kernel", "(int64,)")
    jobs = share_out([*ROOTS, gone], workers=4)
    assert sorted(root.name for job in jobs for root in job.roots) == sorted(
        root.name for root in THERE
    )
    weights = [job.weight for job in jobs]
    assert weights == sorted(weights, reverse=True)
    assert all(len({root.module for root in job.roots}) == 1 for job in jobs)
