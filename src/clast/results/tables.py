"""Tables that grow by a row per step, and what their columns are."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.state import Ledger

LEDGER_ENTRIES = tuple(entry.name for entry in dataclasses.fields(Ledger))

ENERGY_ROW = np.dtype([("time", "f8"), *((name, "f8") for name in LEDGER_ENTRIES)])
"""Time and every entry of the energy ledger."""

STEP_ROW = np.dtype(
    [
        ("time", "f8"),
        ("step", "f8"),
        ("passes", "i8"),
        ("contacts", "i8"),
        ("penetration", "f8"),
        ("travel", "f8"),
    ]
)
"""Time at the end of a step, its size, passes, contacts, penetration, largest vertex movement."""

POINT_ROW = np.dtype(
    [("time", "f8"), ("displacement", "f8", 2), ("velocity", "f8", 2), ("rotation", "f8")]
)
"""One measured point at one instant."""

CONTACT_ROW = np.dtype(
    [
        ("position", "f8", 2),
        ("normal", "f8", 2),
        ("normal_force", "f8"),
        ("shear_force", "f8"),
        ("vertex", "i8"),
        ("edge", "i8"),
        ("mode", "i8"),
    ]
)
"""One contact of one frame."""


def points_row(count: int) -> np.dtype[Any]:
    """Return the row that holds ``count`` measured points at one instant."""
    return np.dtype(
        [
            ("time", "f8"),
            ("displacement", "f8", (count, 2)),
            ("velocity", "f8", (count, 2)),
            ("rotation", "f8", (count,)),
        ]
    )


def rows_of_point(rows: NDArray[Any], point: int) -> NDArray[Any]:
    """Return the rows of one measured point, by its index, from the rows of all."""
    one = np.zeros(len(rows), POINT_ROW)
    one["time"] = rows["time"]
    for name in ("displacement", "velocity", "rotation"):
        one[name] = rows[name][:, point]
    return one


class Table:
    """Rows of one kind in a buffer that doubles when it is full, so that a row costs little."""

    def __init__(self, row: np.dtype[Any]) -> None:
        self._buffer = np.zeros(256, row)
        self._count = 0

    def append(self, row: tuple[Any, ...]) -> None:
        """Add one row, its entries in the order of the columns."""
        if self._count == len(self._buffer):
            self._buffer = np.concatenate([self._buffer, np.zeros_like(self._buffer)])
        self._buffer[self._count] = row
        self._count += 1

    @property
    def rows(self) -> NDArray[Any]:
        """All rows so far (a view), shape (t,)."""
        return self._buffer[: self._count]

    def __len__(self) -> int:
        return self._count


def no_contacts() -> NDArray[Any]:
    """Return the rows of a frame without contacts."""
    return np.zeros(0, CONTACT_ROW)
