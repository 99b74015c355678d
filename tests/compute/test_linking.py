"""Kernels that are linked into those that call them: the same answers, fresh and from disk."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import INCLINE, TEMPLATES
from clast.compute.jit import kernel
from clast.compute.linking import Kernel
from scenes.systems import by_convex, heap, march

SCRIPT = '''
import numpy as np
from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, shared, summed


@kernel()
def squares(values):
    """Return new numbers (k,)."""
    return values * values


@shared(BLOCKS)
def add(first, last, one, other, found):
    for i in range(first, last):
        found[i] = one[i] + other[i]


@summed(BLOCKS)
def total(first, last, values):
    return values[first:last].sum()


@kernel()
def sum_of_squares(values):
    """Return the sum of twice the squares, by kernels of every kind."""
    found = np.empty(len(values))
    add(len(values), squares(values), squares(values), found)
    return total(len(values), found)


print(sum_of_squares(np.arange(2000.0)))
'''


@kernel()
def root_of(x):
    """Return the root of a number that is not negative."""
    if x < 0.0:
        raise ValueError("a root of a negative number")
    return np.sqrt(x)


@kernel()
def sum_of_roots(values):
    """Return the sum of the roots of numbers (k,)."""
    total = 0.0
    for x in values:
        total += root_of(x)
    return total


def files_in(folder: Path) -> list[str]:
    """Return the names of the functions that are kept."""
    return sorted(file.name.split(".")[1].split("-")[0] for file in folder.rglob("*.nbi"))


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.one_in(2)
def test_what_kernels_call_is_kept_within_them(threads: int, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    kept = tmp_path / "kept"
    environment = {
        **os.environ,
        "NUMBA_NUM_THREADS": str(threads),
        "NUMBA_CACHE_DIR": str(kept),
    }
    answers = [
        subprocess.run(
            [sys.executable, str(script)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for _ in range(2)
    ]
    expected = 2.0 * float((np.arange(2000.0) ** 2).sum())
    assert [float(answer) for answer in answers] == [expected, expected]
    assert files_in(kept) == ["sum_of_squares"]


def test_a_kernel_may_be_called_by_python_and_by_kernels() -> None:
    values = np.array([1.0, 4.0, 9.0])
    assert sum_of_roots(values) == 6.0
    assert root_of(16.0) == 4.0
    assert sum_of_roots(values) == 6.0


def test_errors_of_linked_kernels_reach_python() -> None:
    with pytest.raises(ValueError, match="a root of a negative number"):
        sum_of_roots(np.array([1.0, -1.0]))


LOADING = """
import sys
from clast.compute.roots import listed
for root in {root for part in listed().values() for root in part}:
    root.compile()
print([name for name in ("scipy.linalg", "numba.np.polynomial") if name in sys.modules])
"""


@pytest.mark.slow
def test_kernels_are_loaded_from_disk_without_what_compiles_them() -> None:
    """All that are listed, in a process that finds them there."""
    done = [
        subprocess.run([sys.executable, "-c", LOADING], capture_output=True, text=True)
        for _ in range(2)
    ]
    assert [one.returncode for one in done] == [0, 0], done[0].stderr
    assert done[1].stdout == "[]\n"


@kernel()
def as_given(values):
    """Return numbers (k,) as they are."""
    return values


def test_an_array_that_is_returned_as_it_was_given_is_the_same_and_nobody_else_keeps_it():
    one = np.arange(3.0)
    before = sys.getrefcount(one)
    assert as_given(one) is one
    assert sys.getrefcount(one) == before


def arrays_in(thing):
    """Yield the arrays of what a kernel returns."""
    if isinstance(thing, tuple):
        for part in thing:
            yield from arrays_in(part)
    elif isinstance(thing, np.ndarray):
        yield thing


def test_what_kernels_return_has_an_owner(monkeypatch):
    """A part of an array that Python has given would have none: it might be gone any time."""
    ownerless, returned = set(), 0
    usual = Kernel.__call__

    def call(self, *given):
        nonlocal returned
        found = usual(self, *given)
        for one in arrays_in(found):
            returned += 1
            if one.size and one.base is None and not one.flags.owndata:
                ownerless.add(self.py_func.__name__)
        return found

    monkeypatch.setattr(Kernel, "__call__", call)
    Case.from_toml(INCLINE, ["time.end=0.01"]).run()
    march(heap(30, 10), by_convex(5e8, max_displacement=0.05), 5e-3, 0.2)
    Case.from_toml(TEMPLATES["rockfall"]).campaign().follow(1)
    assert returned > 1000
    assert not ownerless
