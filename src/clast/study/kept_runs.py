"""Result files of the worst runs of a study: made again when all is known, the same as they were.

Which runs are the worst is known at the end only, and a run follows from the study and its number:
so no disk is filled meanwhile, and workers need not know of each other.
"""

from __future__ import annotations

import os
from pathlib import Path

from clast.errors import CaseError
from clast.results import Run
from clast.study import probabilities
from clast.study.description import WORST
from clast.study.folder import RUN_FILE, StudyFolder
from clast.study.probabilities import StudyResults
from clast.study.trial_cases import changed, content_of
from clast.study.variables.parameters import ParameterPlaces

KEPT = "worst.txt"
"""Numbers of the worst runs, the worst first."""


def keep_worst(folder: StudyFolder, columns: StudyResults) -> list[int]:
    """Return the worst runs of a study that keeps some, with their result files in place."""
    if not WORST.fullmatch(folder.study.keep):
        return []
    wanted = probabilities.worst(columns, int(folder.study.keep.split()[1]))
    for number in wanted:
        file = folder.place(number) / RUN_FILE
        if not file.exists():
            part = file.with_name(f"part{os.getpid()}.vtkhdf")
            made_again(folder, number, part)
            os.replace(part, file)
    listed = folder.path / KEPT
    before = listed.read_text("utf-8").split() if listed.exists() else []
    for number in set(map(int, filter(str.isdecimal, before))) - set(wanted):
        (folder.place(number) / RUN_FILE).unlink(missing_ok=True)
    listed.write_text("".join(f"{number}\n" for number in wanted), "utf-8")
    return wanted


def made_again(folder: StudyFolder, number: int, output: Path | None = None) -> Run | None:
    """Return a run, made again; None where it cannot go on."""
    settings = ParameterPlaces.of(content_of(folder.base), folder.study.vary)
    case = changed(folder.base, settings.case(folder.values(number)))
    try:
        return case.run(output=output, warn=lambda _text: None)
    except CaseError:
        return None
