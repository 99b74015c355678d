"""The run's side of its live page: reports its progress, and obeys requests between steps.

The page has a process of its own (``clast.pictures.live``), which reads the result file as anybody
may.  The run writes lines into a pipe that is never waited for, and looks at a flag before each
step: a page that reads slowly, hangs or has closed costs it nothing.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from time import perf_counter
from typing import IO, TYPE_CHECKING, Any, cast

from clast.errors import CaseError
from clast.run.interrupts import EndedFromPage

if TYPE_CHECKING:
    from clast.run.run_state import Halt
    from clast.run.schedule import Progress

ORDERS = ("pause", "go", "step", "end", "checkpoint")
"""Requests of a page."""


class Led:
    """A run led by another program; it goes where ``progress`` of a run goes.

    ``said`` is the number of a file that gets a line of JSON a few times a second; ``at_end`` is
    the request taken where the program has gone.
    """

    def __init__(
        self, said: int, orders: IO[bytes], at_end: str, *, wants_line: bool = False
    ) -> None:
        self.wants_line = wants_line
        self.line: Callable[[Progress], None] | None = None
        self.has_ended = False
        """Whether the program has ended the run."""
        self._out, self._at_end = said, at_end
        self._orders: SimpleQueue[str] = SimpleQueue()
        self._news = threading.Event()
        self._asked = False
        self._begun = False
        self._paused = False
        self._steps = 0
        self._told = 0.0
        self._where: dict[str, Any] = {}
        self._said = ""
        self._last: Progress | None = None
        # what a program that hangs does not read is lost, and not waited for
        os.set_blocking(said, False)
        threading.Thread(target=self._hear, args=(orders,), daemon=True).start()

    # --- between steps -----------------------------------------------------------------------

    def __call__(self, progress: Progress) -> None:
        """Say where the run is, a few times a second."""
        if self.line is not None:
            self.line(progress)
        self._last = progress
        now = perf_counter()
        # Time between two lines about where the run is, s of wall time
        if now - self._told < 0.2 and not self._paused:
            return
        self._told = now
        self._where = _where(progress)
        self._tell()

    def lead(self, halt: Halt) -> None:
        """Obey a request of the page: wait, take one step, end, write a checkpoint."""
        if not self._begun:
            self._begun = True
            self._where = _where(halt.where())
            self._tell()
        if not self._asked:
            return
        self._obey(halt)
        if not self._paused:
            self._asked = not self._orders.empty()
            return
        halt.keep_frame()
        self._where = _where(halt.where())  # steps since it was told last are many
        self._tell()
        while self._paused and not self._steps:
            halt.let_go()
            # How long a run that is paused waits before it looks whether the key was pressed, s
            self._news.wait(0.1)
            self._obey(halt)
        self._steps = max(0, self._steps - 1)
        self._asked = self._paused or not self._orders.empty()

    def _obey(self, halt: Halt) -> None:
        """Take the requests since."""
        self._news.clear()
        while True:
            try:
                order = self._orders.get_nowait()
            except Empty:
                return
            if order == "end":
                self.has_ended = True
                raise EndedFromPage
            if order == "checkpoint":
                self._said = halt.checkpoint()
            else:
                self._steps += order == "step"
                self._paused = order != "go"
            self._tell()

    # --- the other program -------------------------------------------------------------------

    def _tell(self) -> None:
        """Write a line that nobody need read."""
        line = {**self._where, "paused": self._paused, "said": self._said}
        # raw: what finds no room in a buffer of Python's would be written later, in the way
        with suppress(OSError, ValueError):
            os.write(self._out, json.dumps(line).encode() + b"\n")

    def _hear(self, orders: IO[bytes]) -> None:
        """Take requests, until who makes them has gone."""
        for line in orders:
            self._order(line.decode().strip())
        self._order(self._at_end)

    def _order(self, order: str) -> None:
        if order in ORDERS:
            self._orders.put(order)
            self._asked = True
            self._news.set()

    def over(self) -> None:
        """Say that the run is over, and where."""
        if self._last is not None:
            self._where = _where(self._last)
            self._tell()


class LivePage(Led):
    """The page of a run that writes ``output``; it goes where ``progress`` of a run goes."""

    def __init__(
        self, output: Path | str, at: str = "127.0.0.1:0", *, wants_line: bool = False
    ) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "clast.pictures.live", str(Path(output).resolve()), at],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            # Ctrl-C is for the run
            start_new_session=True,
        )
        self._pipe = cast("IO[bytes]", self._process.stdin)
        heard = self._first_line()
        if "fault" in heard:
            self.close()
            raise CaseError(heard["fault"], where="--live", remedy=heard["remedy"])
        self.address: str = heard["address"]
        """Where the page is: whoever knows it may look on and lead the run."""
        # a run whose page has gone is not left waiting
        orders = cast("IO[bytes]", self._process.stdout)
        super().__init__(self._pipe.fileno(), orders, "go", wants_line=wants_line)

    def _first_line(self) -> dict[str, Any]:
        """Return the first message of the process of the page."""
        # How long the process of the page may take to begin, s
        guard = threading.Timer(60.0, self._process.kill)
        guard.start()
        line = cast("IO[bytes]", self._process.stdout).readline()
        guard.cancel()
        return json.loads(line) if line else {"fault": "the page did not begin", "remedy": ""}

    def over(self) -> None:
        """Say that the run is over, and where; the page stays as long as somebody looks at it."""
        super().over()
        with suppress(OSError):
            self._pipe.close()

    def is_watched(self) -> bool:
        """Return whether the page's process is still there for somebody."""
        return self._process.poll() is None

    def wait(self) -> None:
        """Wait until nobody looks at the page any more."""
        self._process.wait()

    def close(self) -> None:
        """End the page's process."""
        self._process.kill()
        self._process.wait()
        with suppress(OSError):
            self._pipe.close()


def _where(progress: Progress) -> dict[str, Any]:
    """Return the progress of a run as a page shows it."""
    names = ("time", "end", "step", "steps", "contacts", "stage")
    return {name: getattr(progress, name) for name in names}
