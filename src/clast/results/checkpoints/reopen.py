"""Reopen a result file at a checkpoint: check that both fit, cut the file back, or copy it."""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded, belongs, read_lineage
from clast.results.open_file import QUICKLY_CHECKED, ask, check_ours
from clast.results.output import check_output, claimed, hidden
from clast.results.schema import (
    BESIDE,
    CHUNK_ROWS,
    CONTACTS,
    ENERGY,
    FRAME_ROW,
    FRAME_STAGE,
    MOVING_FIELDS,
    OFFSETS,
    OVER_TIME,
)

ELSEWHERE = "clast resume CHECKPOINT -o FILE writes a file from there on"


def check_fit(path: Path, model: Model, recorded: Recorded) -> None:
    """Raise CaseError where a file does not hold the frames that a checkpoint goes on from."""

    def misfit(file: Any) -> str:
        check_ours(file)
        if not np.array_equal(file["model/block_start"][()], model.block_start):
            return "it has other blocks"
        held = file["frames"]
        if len(held) < recorded.frames:
            return f"it has {len(held)} frames, the checkpoint continues from {recorded.frames}"
        at = int(recorded.frame["instants"][0]) - 1
        if not belongs(recorded.lineage, recorded.frames, read_lineage(file)):
            return "its frames are those of another, later run"
        same = held[recorded.frames - 1] == recorded.frame[0]
        if not same or at >= len(file["energy"]) or file["energy"][at] != recorded.energy[0]:
            return "its frames are those of another run"
        return ""

    where = str(path)
    try:
        status = path.lstat()
    except OSError:
        raise CaseError(
            "the result file of the checkpoint is missing", where=where, remedy=ELSEWHERE
        ) from None
    if not stat.S_ISREG(status.st_mode):
        raise CaseError(
            "is not a regular file: the results of a checkpoint lie beside it",
            where=where,
            remedy=ELSEWHERE,
        )
    try:
        why = ask(path, misfit, whole=QUICKLY_CHECKED)
    except CaseError as error:
        raise CaseError(error.what, where=error.where, remedy=ELSEWHERE) from error
    if why:
        raise CaseError(f"does not belong to the checkpoint: {why}", where=where, remedy=ELSEWHERE)


def lengths_after(model: Model, frames: int, last: NDArray[Any]) -> dict[str, int]:
    """Return the rows of each growing dataset of a file after so many frames."""
    counts, vertices = rows_after(last, model), len(model.vertices)
    whole_chunks = -(-frames // CHUNK_ROWS) * CHUNK_ROWS
    return {
        **{
            f"VTKHDF/{one.place}": frames * (model.block_count if one.of_blocks else vertices)
            for one in MOVING_FIELDS
        },
        **{f"VTKHDF/Steps/{name}": whole_chunks for name in OFFSETS},
        "VTKHDF/Steps/Values": frames,
        "frames": frames,
        FRAME_STAGE: frames,
        "contacts": int(last["contacts"][0]),
        **{name: frames * rows(model) for name, (_, rows) in BESIDE.items()},
        **{
            place: counts[one.name]
            for one in OVER_TIME
            for place in one.places(one.of.names(model) if one.of else ())
        },
    }


def rows_after(last: NDArray[Any], model: Model) -> dict[str, int]:
    """Return the rows of each table of a run after the frame with this row, shape (1,)."""
    return {one.name: int(last[one.counter][0]) if one.is_kept(model) else 0 for one in OVER_TIME}


def taken_over(
    checkpoint: Path,
    model: Model,
    recorded: Recorded,
    output: str | Path | None,
    warn: Callable[[str], None] | None,
) -> tuple[Path, Recorded | None]:
    """Return the file to go on in, and how far it is recorded there: None for a new file.

    Without ``output`` it is the result file beside the checkpoint.  Else it is a copy of that;
    where that is missing or does not fit, ``warn`` is told, and the file is a new one.
    """
    old = checkpoint.resolve().parent / recorded.file
    if output is None or (old.exists() and Path(output).resolve() == old.resolve()):
        return old, recorded
    target = Path(output)
    try:
        check_fit(old, model, recorded)
    except CaseError as error:
        if warn:
            what = " ".join(error.what.split())
            warn(f"{old}: {what}. {target} begins where the checkpoint was written")
        return target, None
    _copy(old, target)
    return target, recorded


def _copy(old: Path, target: Path) -> None:
    """Copy a result file; an existing file stays until the copy is whole."""
    path = check_output(target)
    part = hidden(path)
    with claimed(path) as new:
        try:
            with open(old, "rb") as source:
                shutil.copyfileobj(source, new)
            os.fsync(new.fileno())
            os.replace(part, path)
        except OSError as error:
            with suppress(OSError):
                part.unlink()
            raise CaseError(
                f"cannot be written: {os.strerror(error.errno or 0)}",
                where=str(target),
                remedy="make room, or choose another place",
            ) from error


def faults(recorded: Recorded, model: Model, time: float) -> Iterator[str]:
    """Yield the faults in the records of a run until ``time``, s."""
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
    limits = {name: len(model.vertices) for name in ("vertex", "edge")}
    limits |= {"mode": len(CONTACTS.words["mode"]), "joint": len(model.joint_table.joints)}
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
