"""Limits of numbers, names and titles that no table has judged."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.model import Floats
from clast.model.ranges import check_names

TITLE_LENGTH_MAX = 1000
"""Most characters of a title."""
PLAIN = re.compile(r"[1-9][0-9]{0,8}")
"""A number of a block."""
ACTION = ("begin", "contribution", "finish")
"""Methods of an action."""


def check_actions(actions: Sequence[object]) -> None:
    """Refuse an object that lacks a method of an action."""
    for k, action in enumerate(actions, 1):
        lacking = [name for name in ACTION if not callable(getattr(action, name, None))]
        if isinstance(action, type) or lacking:
            raise ModelError(
                f"{action if isinstance(action, type) else type(action).__name__} is not an action"
                + (f": it has no {', '.join(lacking)}" if lacking else ", but a class"),
                where=f"actions, number {k}",
                remedy="give an object with the methods of clast.actions.action.Action",
            )


def check_numbers(
    values: Any, count: int, where: str, limits: ranges.AllowedRange = ranges.COORDINATE
) -> Floats:
    """Return ``count`` finite numbers as an array, shape (count,), or say which is none."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.zeros(0)
    if array.shape != (count,) or not np.isfinite(array).all():
        what = f"{shortened(repr(values))} is not a list of {count} finite numbers"
        raise ModelError(what, where=where, remedy=f"give {count} numbers in SI units")
    for value in array:
        ranges.check_size(float(value), limits, where, "give SI units")
    return array


def check_point_names(names: Sequence[str]) -> None:
    """Refuse names of measured points that cannot be those of tables in the result file."""
    check_names("measured point", names)
    for name in names:
        if name in (".", ".."):
            what = (
                "its history is kept in the result file under its name, which must not be . or .."
            )
            raise ModelError(what, where=f"measured point '{name}'", remedy="give it another name")


def number_of(name: str, number: dict[str, int], kind: str, where: str) -> int:
    """Return the index of a named thing, of a block also by its number, or suggest a name."""
    if not isinstance(name, str):
        what = f"{shortened(repr(name))} is not a valid {kind} name"
        raise ModelError(what, where=where, remedy=f'name the {kind} by its text, e.g. "1"')
    if name not in number:
        if kind == "block" and PLAIN.fullmatch(name) and int(name) <= len(number):
            return int(name) - 1  # messages call blocks by number and name
        what = f"there is no {kind} '{shortened(name)}'"
        raise ModelError(what, where=where, remedy=spelling.advice(name, number, kind=kind))
    return number[name]
