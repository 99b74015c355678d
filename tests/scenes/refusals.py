"""What bad input is answered with, as a command prints it; without the command.

A message is made where the input is read.  The command line adds the word error, exit code and
stream: that is looked at for a few messages of each table, not for all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

import clast
from clast.case.case_file import Case


def some_of(names: Iterable[str], count: int) -> list[str]:
    """Return so many of the names, evenly spaced: those that go through the command line."""
    listed = list(names)
    return [listed[k * len(listed) // count] for k in range(count)]


def refusal(
    case: Path, look: Callable[[Case], object] = Case.examine, settings: tuple[str, ...] = ()
) -> str:
    """Return what a case that cannot be is answered with when it is read and looked at."""
    with pytest.raises(clast.ClastError) as refused:
        look(Case.from_toml(case, list(settings)))
    return f"error: {refused.value}\n"
