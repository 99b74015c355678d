"""Whether what a checkpoint says of a run's records can be so for the model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.checkpoints.cutting_back import rows_after
from clast.results.layout import CONTACT_ROW, ENERGY_ROW, FRAME_ROW, STEP_ROW, bolts_row
from clast.results.tables import points_row

MODES = 3
"""Modes of a contact: open, slide, lock."""


def wrong_record(recorded: Recorded, model: Model, time: float) -> str:
    """Return what is wrong with the records of a run until ``time``, s; "" for nothing."""
    return next((what for what in _faults(recorded, model, time)), "")


def _faults(recorded: Recorded, model: Model, time: float) -> Iterator[str]:
    if not is_file_name(recorded.file):
        yield "it names a result file that does not lie beside it"
    if not recorded.wall >= 0.0:
        yield "its wall time is negative"
    if not _fits(recorded.frame, FRAME_ROW, 1) or not _fits(recorded.energy, ENERGY_ROW, 1):
        yield "it has no last frame"
        return
    last = recorded.frame[0]
    ends = [int(last[name]) for name in ("steps", "instants", "contacts")]
    forward = 1 <= recorded.frames <= ends[1] == ends[0] + 1 and ends[2] >= 0
    if not forward or last["time"] > time or last["time"] != recorded.energy["time"][0]:
        yield "its last frame is none of a run"
    yield from _of_rows(recorded, model, time)
    contacts = recorded.contacts
    if not _fits(contacts, CONTACT_ROW):
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
    """Give what is wrong with the rows of tables since the last frame."""
    rows = {
        "energy": ENERGY_ROW,
        "steps": STEP_ROW,
        "history": points_row(len(model.measured_points.name)),
        "bolts": bolts_row(len(model.bolts)),
    }
    since = recorded.since
    if set(since) != set(rows):
        yield "its tables are not those of a run"
        return
    count = len(since["energy"]) if since["energy"].ndim == 1 else -1
    counts = {**dict.fromkeys(rows, count), "bolts": count if len(model.bolts) else 0}
    for name, row in rows.items():
        if not _fits(since[name], row, counts[name]):
            yield f"its table '{name}' does not fit to the run"
        elif counts[name] and not _goes_on(since[name]["time"], recorded.frame["time"][0], time):
            yield f"the times of its table '{name}' do not go on to {time:.6g} s"


def rows_in_all(recorded: Recorded) -> int:
    """Return how many steps a run has taken by what was recorded of it."""
    return rows_after(recorded.frame)["steps"] + len(recorded.since["steps"])


def _goes_on(times: NDArray[Any], after: float, until: float) -> bool:
    # time stands still while a static run comes to balance
    forward = (np.diff(times, prepend=after) >= 0.0).all()
    return bool(forward and times[-1] == until)


def _fits(rows: NDArray[Any], row: np.dtype[Any], count: int | None = None) -> bool:
    """Return whether rows are ``count`` finite ones of a table; of bolts some are not finite."""
    if rows.dtype != row or rows.ndim != 1 or (count is not None and len(rows) != count):
        return False
    names = [name for name in row.names or () if name != "elongation"]
    return all(np.isfinite(rows[name]).all() for name in names)


def is_file_name(file: str) -> bool:
    """Return whether a text is the name of a file, and no way to another folder."""
    return file not in ("", ".", "..") and not set(file) & set("/\\\0:")
