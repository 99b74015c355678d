"""The feed of a live page: frames of a result file as a run writes them, and its messages."""

from __future__ import annotations

import json
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.pictures.page.document import BUDGET, page_text
from clast.pictures.page.frame_data import moving
from clast.pictures.page.scene import scene_of, words_of
from clast.results import Report, Results, read_results

READ_INTERVAL_MIN, READ_PAUSE_RATIO = 0.25, 20.0
"""Time between two looks at the file at least, s, and in durations of the last look: a run that
writes waits for it."""


@dataclass
class Feed:
    """Reads the result file of a run for all who look on."""

    path: Path
    budget: float = BUDGET
    status: dict[str, Any] = field(default_factory=dict)
    """The last message of the run."""
    version: int = 0
    """Counts news."""
    _results: Results | None = None
    _seen: tuple[int, int] = (0, 0)
    _parts: dict[tuple[int, int], str] = field(default_factory=dict)
    _curves: tuple[int, str] = (-1, "")
    _rest: float = 0.0
    _looked: float = 0.0
    _closed: bool = False

    def __post_init__(self) -> None:
        self.changed = threading.Condition()
        """Told when there is something new."""
        self._reading = threading.Lock()

    @property
    def frames(self) -> int:
        """Frames that are there."""
        return 0 if self._results is None else len(self._results.times)

    @property
    def report(self) -> Report | None:
        """How the run went; None where it has no report yet, or never."""
        return None if self._results is None else self._results.report

    @property
    def pace(self) -> float | None:
        """Wall time for a block and step of a run that is over, s."""
        run, report = self._results, self.report
        if run is None or report is None or not report.steps:
            return None
        return report.wall_seconds / (report.steps * len(run.block_name))

    @property
    def is_over(self) -> bool:
        """Whether the run has ended."""
        return bool(self.status.get("over"))

    def say(self, status: dict[str, Any]) -> None:
        """Take a message of the run."""
        with self.changed:
            self.status = {**self.status, **status}
            self.version += 1
            self.changed.notify_all()

    def look(self) -> None:
        """Look whether the file has new frames, if it is time to; not before the run has begun."""
        now = time.monotonic()
        rest = (
            READ_INTERVAL_MIN if self.status.get("paused") else max(READ_INTERVAL_MIN, self._rest)
        )
        if not self.status or now - self._looked < rest:
            return
        self._looked = now
        with suppress(OSError):
            file = self.path.stat()
            seen = file.st_mtime_ns, file.st_size
            changed, self._seen = seen != self._seen, seen
            if changed:
                self._open()

    def end(self) -> None:
        """Take all that a run has left, and say that it is over; without a report it was killed."""
        if self.status:
            self._open()
        killed = self._results is None or self._results.report is None
        self.say({"over": True, "paused": False, "killed": killed})

    def close(self) -> None:
        """Wait for who reads, and let nobody read any more.

        A thread that a process ends while it reads holds the lock of HDF5, for which that waits.
        """
        if not self._closed:
            self._closed = self._reading.acquire()

    def _open(self) -> None:
        start = time.monotonic()
        try:
            with self._reading:
                self._results = read_results(self.path, whole=0)
        except CaseError:
            return  # later
        self.say({})
        self._rest = READ_PAUSE_RATIO * (time.monotonic() - start)

    def scene(self) -> str:
        """Return all that there is, as JSON: "null" before the first frame."""
        with self._reading:
            if self._results is None and not self.is_over:
                return "null"
            results = self._read()
            scene = scene_of(results, self.budget)
        return json.dumps({**scene, "next": len(results.times), "status": self.status})

    def part(self, first: int) -> tuple[str, int]:
        """Return the frames from ``first`` on as JSON, and how many frames there are then."""
        start = time.monotonic()
        with self._reading:
            results = self._read()
            count = len(results.times)
            key = first, count
            if key not in self._parts:
                # Frames that the budget of contacts is divided among while a run goes on
                share = self.budget * (count - first) / max(200, count)
                part = moving(results, np.arange(first, count), share)
                self._parts = {key: json.dumps({**part, "next": count})}
                self._rest = READ_PAUSE_RATIO * (time.monotonic() - start)
            return self._parts[key], count

    def words(self) -> tuple[int, str]:
        """Return curves and report as JSON, with the number of frames that they go to."""
        start = time.monotonic()
        with self._reading:
            results = self._read()
            count = len(results.times) + (results.report is not None)
            if count != self._curves[0]:
                self._curves = count, json.dumps(words_of(results))
                self._rest = READ_PAUSE_RATIO * (time.monotonic() - start)
            return self._curves

    def page(self) -> str:
        """Return the text of the page as ``clast page`` writes it."""
        with self._reading:
            return page_text(scene_of(self._read(), self.budget))

    def _read(self) -> Results:
        if self._results is None:
            if self.is_over:
                raise CaseError("the run was killed before its first frame")
            raise CaseError("the run has not started", remedy="wait for the first frame")
        return self._results
