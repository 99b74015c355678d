"""The content of a checkpoint, and how far a run was recorded when it was written.

Every run that begins a file, or goes on with one, has an identity, which stands in the file with
the number of the frames before it, and in the run's checkpoints.  A checkpoint belongs to a file
where its run has written there and no other has gone on from an earlier frame.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from uuid import uuid4

from numpy.typing import NDArray

Lineage = tuple[tuple[str, int], ...]
"""Identity of each run, and the number of the frames in the file that it went on from."""
LINEAGE = "runs"
"""Attribute of a result file that has its lineage."""
RUNS_MAX = 500
"""Runs that are kept: an attribute of HDF5 has little room."""
TEXT, SETTINGS, OBJECTS = "a case file", "the settings of a script", "objects of a script"
"""Contents of the text of a case: all of a run, all but its blocks, or neither."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """Where a run came from."""

    text: str
    gives: str = TEXT
    """The part of the run in the text: one of the texts above."""
    file: str = "case"
    """The case file, whose folder has the files that it names."""
    file_text: str = ""
    """Fingerprint of the text that the file had then, empty where the case is of no file."""
    files: Mapping[str, str] = field(default_factory=dict)
    """Fingerprints of these files by the names that the case gives them."""
    schedule: Any = None
    """When it simulates and keeps frames (``clast.run.schedule.Schedule``)."""
    fingerprints: Mapping[str, str] = field(default_factory=dict)
    """Fingerprints of the parts of its model and its method."""


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """How far a run was recorded."""

    file: str
    """Name of the result file, which lies beside the checkpoint."""
    lineage: Lineage
    """Which runs have written it; the last of them is that of the checkpoint."""
    frames: int
    frame: NDArray[Any]
    """Row of the last of them in its table of frames, shape (1,)."""
    energy: NDArray[Any]
    """Row of that instant in its table of energies, shape (1,)."""
    since: Mapping[str, NDArray[Any]]
    """Rows of each table that came after it."""
    contacts: NDArray[Any]
    """Contacts of the last step, a row for each that carries a force."""
    wall: float = 0.0
    """Time that the run has taken, s of wall clock, without time lost to a signal or a kill."""


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """All that a run needs to go on."""

    version: str
    time: float
    """Time that the run had come to, s."""
    outcome: str = ""
    finished: bool = False
    """True where the run had reached its end."""
    stage: str = ""
    """The stage that had just ended, where the checkpoint was written for that."""
    source: Source
    recorded: Recorded
    run: Any
    """Its data from step to step (``clast.run.run_state.RunState``)."""


def extended(lineage: Lineage, frames: int) -> Lineage:
    """Return the lineage of a file in which a new run goes on behind its first ``frames``."""
    kept = tuple(one for one in lineage if one[1] <= frames)
    return (*kept[1 - RUNS_MAX :], (uuid4().hex, frames))


def belongs(lineage: Lineage, frames: int, file: Lineage) -> bool:
    """Return whether the first ``frames`` of a file are those of the last run of a lineage."""
    identities = [identity for identity, _ in file]
    if not lineage or lineage[-1][0] not in identities:
        return False
    at = identities.index(lineage[-1][0])
    later = [first for _, first in file[at + 1 :]]
    return file[at][1] <= frames <= min(later, default=frames)


def read_lineage(file: Any) -> Lineage:
    """Return the lineage in an open result file, nothing where there is none."""
    try:
        return tuple((str(run), int(first)) for run, first in json.loads(file.attrs[LINEAGE]))
    except (KeyError, TypeError, ValueError, OSError, RecursionError):
        return ()


def write_lineage(file: Any, lineage: Lineage) -> None:
    """Write the lineage into an open result file."""
    file.attrs[LINEAGE] = json.dumps(lineage)
