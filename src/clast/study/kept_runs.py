"""Result files of the worst runs of a study: made again when all is known, the same as they were.

Which runs are the worst is known at the end only, and a run follows from the study and its number:
so no disk is filled meanwhile, and workers need not know of each other.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path

from clast.errors import CaseError, ResultsLost
from clast.results import Run
from clast.results.checkpoints.fingerprints import content_of as content_of_file
from clast.study import probabilities
from clast.study.description import WORST
from clast.study.folder import LARGEST_RESULT, RUN_FILE, StudyFolder, write_whole
from clast.study.probabilities import StudyResults
from clast.study.trial_cases import changed, content_of
from clast.study.variables.parameters import ParameterPlaces

KEPT = "worst.txt"
"""Numbers of the worst runs, the worst first."""
NUMBER = re.compile(rb"[0-9]{1,9}")
"""Number of a run in that file."""


def keep_worst(folder: StudyFolder, columns: StudyResults) -> list[int]:
    """Return the worst runs of a study that keeps some, with their result files in place."""
    if not WORST.fullmatch(folder.study.keep):
        return []
    wanted = probabilities.worst(columns, int(folder.study.keep.split()[1]))
    for number in wanted:
        file = folder.place(number) / RUN_FILE
        if not file.exists():
            part = file.with_name(f"part{os.getpid()}.vtkhdf")
            part.unlink(missing_ok=True)
            if made_again(folder, number, part) is not None:
                os.replace(part, file)
    listed, before = folder.path / KEPT, b""
    with suppress(OSError, CaseError):
        before = content_of_file(listed, LARGEST_RESULT)
    kept = {str(number).encode() for number in wanted}
    for number in map(int, filter(NUMBER.fullmatch, set(before.split()) - kept)):
        (folder.place(number) / RUN_FILE).unlink(missing_ok=True)
    write_whole(listed, "".join(f"{number}\n" for number in wanted).encode())
    return wanted


def made_again(folder: StudyFolder, number: int, output: Path | None = None) -> Run | None:
    """Return a run, made again; None where it cannot go on."""
    settings = ParameterPlaces.of(content_of(folder.base), folder.study.vary)
    case = changed(folder.base, settings.case(folder.values(number)))
    try:
        return case.run(output=output, warn=lambda _text: None)
    except ResultsLost:
        raise
    except CaseError:
        return None
