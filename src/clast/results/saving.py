"""Writing a run that was made in memory to a result file."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

from clast.errors import CaseError
from clast.results.frame_samples import beside_of
from clast.results.output import check_output, hidden
from clast.results.result_tables import GrowingTable
from clast.results.result_writer import ResultFile
from clast.results.schema import OVER_TIME


def save_run(run: Any, path: Path) -> Path:
    """Write the frames of a ``Run`` as if it had named the file when it began; return the path."""
    frames = run.frames_made()
    if run.output is not None:
        target = check_output(path)
        if target != run.output.resolve():
            try:
                shutil.copyfile(run.output, hidden(target))
                os.replace(hidden(target), target)
            except OSError as error:
                hidden(target).unlink(missing_ok=True)
                what = f"cannot be written to: {error.strerror}"
                raise CaseError(what, where=str(path), remedy="choose another place") from error
        return path
    model = run.model
    file = ResultFile(path, model, run.case_text)
    file.about = run.about
    tables = {one.name: GrowingTable(one.rows(one.count(model))) for one in OVER_TIME}
    for state, contacts, fields, place in frames.kept:
        for name, table in tables.items():
            table.extend(run.tables[name][len(table) : place.counts[name]])
        file.stage = place.stage
        file.frame(state.time, fields.of(state), contacts, tables, beside_of(model, state))
    for name, table in tables.items():
        table.extend(run.tables[name][len(table) :])
    file.finish(run.report, tables)
    return path
