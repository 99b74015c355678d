"""The file in which a run goes on: its own, a copy of it, or a new one."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from clast.errors import CaseError
from clast.model.model import Model
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.checkpoints.cutting_back import check_fit
from clast.results.output import check_output, claimed, hidden


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
    """Copy a result file; what is there stays until the copy is whole."""
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
