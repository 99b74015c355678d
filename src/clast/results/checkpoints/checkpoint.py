"""The content of a checkpoint, and how far a run was recorded when it was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from clast.results.checkpoints.lineage import Lineage

TEXT, SETTINGS, OBJECTS = "a case file", "the settings of a script", "objects of a script"
"""Contents of the text of a case: all of a run, all but its blocks, or neither."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """Where a run came from."""

    text: str
    """The case as TOML."""
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
    """Frames in it."""
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
    """Version of clast."""
    time: float
    """Time that the run had come to, s."""
    outcome: str = ""
    """How the run ended, in words; empty where it went on."""
    finished: bool = False
    """True where the run had reached its end."""
    stage: str = ""
    """The stage that had just ended, where the checkpoint was written for that."""
    source: Source
    """Where the run came from."""
    recorded: Recorded
    """How far it was recorded."""
    run: Any
    """Its data from step to step (``clast.run.run_state.RunState``)."""
