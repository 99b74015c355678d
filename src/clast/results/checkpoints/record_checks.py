"""Whether the records of a run in a checkpoint are possible for the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.schema import CONTACTS, ENERGY, FRAME_ROW, OVER_TIME

MODES = 3
"""Modes of a contact: open, slide, lock."""


def wrong_record(recorded: Recorded, model: Model, time: float) -> str:
    """Return the fault in the records of a run until ``time``, s; "" for none."""
    return next((what for what in _faults(recorded, model, time)), "")


def _faults(recorded: Recorded, model: Model, time: float) -> Iterator[str]:
    if not is_file_name(recorded.file):
        yield "it names a result file that does not lie beside it"
    if not recorded.wall >= 0.0:
        yield "its wall time is negative"
    if not _fits(recorded.frame, FRAME_ROW, 1) or not _fits(recorded.energy, ENERGY.row, 1):
        yield "it has no last frame"
        return
    last = recorded.frame[0]
    ends = [int(last[name]) for name in ("steps", "instants", "contacts")]
    forward = 1 <= recorded.frames <= ends[1] == ends[0] + 1 and ends[2] >= 0
    if not forward or last["time"] > time or last["time"] != recorded.energy["time"][0]:
        yield "its last frame is impossible"
    yield from _of_rows(recorded, model, time)
    contacts = recorded.contacts
    if not _fits(contacts, CONTACTS.row):
        yield "it has no contacts of the last step"
        return
    limits = {
        "vertex": len(model.vertices),
        "edge": len(model.vertices),
        "mode": MODES,
        "joint": len(model.joint_table.joints),
    }
    for name, limit in limits.items():
        if ((contacts[name] < 0) | (contacts[name] >= limit)).any():
            yield f"its contacts have a {name} that does not exist"


def _of_rows(recorded: Recorded, model: Model, time: float) -> Iterator[str]:
    since = recorded.since
    if set(since) != {one.name for one in OVER_TIME}:
        yield "its tables are not those of a run"
        return
    count = len(since["energy"]) if since["energy"].ndim == 1 else -1
    for one in OVER_TIME:
        rows, wanted = since[one.name], count if one.is_kept(model) else 0
        nan = [column.name for column in one.columns if column.may_be_nan]
        if not _fits(rows, one.rows(one.count(model)), wanted, nan):
            yield f"its table '{one.name}' does not match the run"
        elif wanted and not _goes_on(rows["time"], recorded.frame["time"][0], time):
            yield f"the times of its table '{one.name}' do not continue to {time:.6g} s"


def rows_in_all(recorded: Recorded) -> int:
    """Return how many steps a run has taken by its records."""
    return int(recorded.frame["steps"][0]) + len(recorded.since["steps"])


def _goes_on(times: NDArray[Any], after: float, until: float) -> bool:
    # time stands still while a static run comes to balance
    forward = (np.diff(times, prepend=after) >= 0.0).all()
    return bool(forward and times[-1] == until)


def _fits(
    rows: NDArray[Any], row: np.dtype[Any], count: int | None = None, nan: Sequence[str] = ()
) -> bool:
    """Return whether rows are ``count`` ones of a table, finite but in the columns ``nan``."""
    if rows.dtype != row or rows.ndim != 1 or (count is not None and len(rows) != count):
        return False
    names = [name for name in row.names or () if name not in nan]
    return all(np.isfinite(rows[name]).all() for name in names)


def is_file_name(file: str) -> bool:
    """Return whether a text is the name of a file, and no way to another folder."""
    return file not in ("", ".", "..") and not set(file) & set("/\\\0:")
