"""A result file that is to go on from a checkpoint: whether it fits, and cut back to it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.layout import FORMAT
from clast.results.opening import ask, check_ours

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
        same = held[recorded.frames - 1] == recorded.frame[0]
        if not same or file["energy"][at] != recorded.energy[0]:
            return "its frames are those of another run"
        return ""

    where = str(path)
    if not path.exists():
        raise CaseError(
            "the result file of the checkpoint is missing", where=where, remedy=ELSEWHERE
        )
    try:
        why = ask(path, misfit, whole=CHECKED_WHOLE)
    except CaseError as error:
        raise CaseError(error.what, where=error.where, remedy=ELSEWHERE) from error
    if why:
        raise CaseError(f"does not belong to the checkpoint: {why}", where=where, remedy=ELSEWHERE)


def cut_back(file: Any, frames: int, lengths: Mapping[str, int]) -> None:
    """Take all that came after its first ``frames`` frames out of an open result file.

    ``lengths`` are the rows that each dataset had then.
    """
    # In the order in which a frame is taken back: for a viewer it is gone first.
    file["VTKHDF/Steps"].attrs.modify("NSteps", np.int64(frames))
    for name, length in lengths.items():
        file[name].resize(min(length, len(file[name])), axis=0)
    if "report" in file:
        del file["report"]
