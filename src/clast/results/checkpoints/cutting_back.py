"""A result file that is to go on from a checkpoint: whether it fits, and cut back to it."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.checkpoints.lineage import belongs, read_lineage
from clast.results.opening import ask, check_ours
from clast.results.schema import (
    BOLT_POINTS,
    CHUNK_ROWS,
    FORMAT,
    FRAME_STAGE,
    MOVING_FIELDS,
    OFFSETS,
    OVER_TIME,
)

ELSEWHERE = "clast resume CHECKPOINT -o FILE writes a file of what comes from there on"
CHECKED_WHOLE = 2**28
"""Size of a file that is checked from end to end, bytes."""


def check_fit(path: Path, model: Model, recorded: Recorded) -> None:
    """Raise CaseError where a file does not hold the frames that a checkpoint goes on from."""

    def misfit(file: Any) -> str:
        if check_ours(file) != FORMAT:
            return "an earlier clast has written it"
        if not np.array_equal(file["model/block_start"][()], model.block_start):
            return "it has other blocks"
        held = file["frames"]
        if len(held) < recorded.frames:
            return f"it has {len(held)} frames, the checkpoint goes on from {recorded.frames}"
        at = int(recorded.frame["instants"][0]) - 1
        if not belongs(recorded.lineage, recorded.frames, read_lineage(file)):
            return "its frames are those of another run, which was begun later"
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
            "is no regular file: the results of a checkpoint lie beside it",
            where=where,
            remedy=ELSEWHERE,
        )
    try:
        why = ask(path, misfit, whole=CHECKED_WHOLE)
    except CaseError as error:
        raise CaseError(error.what, where=error.where, remedy=ELSEWHERE) from error
    if why:
        raise CaseError(f"does not belong to the checkpoint: {why}", where=where, remedy=ELSEWHERE)


def cut_back(file: Any, model: Model, frames: int, last: NDArray[Any]) -> None:
    """Take all that came after its first ``frames`` frames out of an open result file.

    ``last`` is the row of the last of them in its table of frames, shape (1,).
    """
    # In the order in which a frame is taken back: for a viewer it is gone first.
    file["VTKHDF/Steps"].attrs.modify("NSteps", np.int64(frames))
    for name, length in lengths_after(model, frames, last).items():
        if name in file:
            file[name].resize(min(length, len(file[name])), axis=0)
    if "report" in file:
        del file["report"]


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
        BOLT_POINTS: frames * len(model.bolts.block),
        **{
            place: counts[one.name]
            for one in OVER_TIME
            for place in one.places(one.of.names(model) if one.of else ())
        },
    }


def rows_after(last: NDArray[Any], model: Model) -> dict[str, int]:
    """Return the rows of each table of a run after the frame with this row, shape (1,)."""
    return {one.name: int(last[one.counter][0]) if one.is_kept(model) else 0 for one in OVER_TIME}
