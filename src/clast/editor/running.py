"""Runs and studies of a case that is edited, each a process of its own on a copy of the text.

    slope.runs/3/slope.toml     the case that ran, with the files that it names
    slope.runs/3/slope.vtkhdf   what came of it, with its checkpoint; of a study the folder study
    slope.runs/3/log.txt        the command, and its messages

A process ends with the editor, however that ends: a run keeps its results and a checkpoint then, a
study the runs that are finished.
"""

from __future__ import annotations

import hmac
import json
import os
import re
import secrets
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.pictures.live.feed import Feed
from clast.study.folder import StudyFolder
from clast.study.trial_table import columns, row

LOOK_EVERY = 0.1
"""Time between two looks at a process, its messages and results, s."""
END_WITHIN = 20.0
"""Time that a process gets to end when the editor does, s."""
LOG, LOG_MOST = "log.txt", 8_000
"""File of the messages, and how many of their characters a window shows."""
ENDS = {2: "was refused", 3: "could not go on", 130: "was ended"}
"""Exit codes of commands that have not said what they have found."""
STUDIES = {
    "fos": ("by", "tolerance"),
    "sweep": ("vary", "measure", "fail"),
    "montecarlo": ("vary", "measure", "fail", "runs"),
}
"""Kinds of studies -> the options that a window gives."""
SENTENCE = re.compile(r"(?!report: |barriers|table: |page: |warning: )\w")
"""Beginning of a line of a study that says what it has found."""
ROWS_MOST = 2_000
"""Rows of the table of a study in a window."""


class StudyAsked(BaseModel):
    """A study that a window asks for: its kind, and texts of options."""

    model_config = ConfigDict(extra="forbid", strict=True)

    kind: Literal["fos", "sweep", "montecarlo"]
    options: dict[str, list[str]] = {}

    def words(self) -> list[str]:
        """Return the words of its command."""
        texts = ((name, self.options.get(name, ())) for name in STUDIES[self.kind])
        options = [f"--{name}={text}" for name, some in texts for text in some if text.strip()]
        return ["study", self.kind, *options]


class Child:
    """A command of clast on a case of its own, going on or over."""

    def __init__(self, folder: Path, case: Path) -> None:
        self.folder, self.case = folder, case
        self.number = int(folder.name)
        self.feed, self.study = Feed(case.with_suffix(".vtkhdf")), case.with_name("study")
        self.process: subprocess.Popen[bytes] | None = None
        self.asked_to_end = False
        self.table: dict[str, Any] | None = None
        """The results of a study as they come: heads and rows."""
        self.begun = time.monotonic()
        self.seconds = 0.0

    @property
    def text(self) -> str:
        """The text that ran; "" where it is gone."""
        return _read(self.case)

    @property
    def command(self) -> str:
        """The command as one would type it, and its messages."""
        return _read(self.folder / LOG)

    @property
    def kind(self) -> str:
        """The first word of the command: run, study or rockfall."""
        return (self.command.split(maxsplit=3) or ["", "", "run"])[2]

    @property
    def report(self) -> Path | None:
        """The page of a study that is over."""
        pages = (self.study / name for name in ("paths.html", "report.html"))
        return next((page for page in pages if page.exists()), None)

    @property
    def is_over(self) -> bool:
        """Whether it has ended, and what it has left is taken up."""
        return self.process is None or (self.process.poll() is not None and self.feed.is_over)

    def start(self, words: Sequence[str]) -> None:
        """Start the command."""
        is_run = words[0] == "run"
        more = ["--live-at", "-", "--quiet"] if is_run else []
        module = "clast" if is_run else "clast.editor.bound"
        with (self.folder / LOG).open("wb") as log:
            log.write(f"$ clast {subprocess.list2cmdline(words)}\n".encode())
            log.flush()
            self.process = subprocess.Popen(
                [sys.executable, "-m", module, *words, *more],
                cwd=self.case.parent,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE if is_run else log,
                stderr=log,
                start_new_session=True,  # the interrupt key is for the editor
            )

    def order(self, order: str) -> None:
        """Hand on a request, as the buttons of its page make them."""
        self.asked_to_end |= order == "end"
        if self.process is not None and self.process.stdin is not None:
            with suppress(OSError, ValueError):
                os.write(self.process.stdin.fileno(), f"{order}\n".encode())

    def kill(self) -> None:
        """End it at once."""
        if self.process is not None:
            self.process.kill()

    def follow(self, changed: Callable[[], None]) -> None:
        """Follow it to its end, for which ``changed`` is called when there is something new."""
        process, seen, rest = self.process, (-1, -1, -1), 0.0
        if process is None:
            return
        if process.stdout is not None:
            threading.Thread(target=self._hear, args=(process.stdout,), daemon=True).start()
        while process.poll() is None:
            self.seconds = time.monotonic() - self.begun
            self.feed.look()
            if time.monotonic() > rest:
                rest = time.monotonic() + self.tell_table()
            now = self.feed.version, len(self.command), int(self.seconds)
            if now != seen:
                seen = now
                changed()
            time.sleep(LOOK_EVERY)
        if process.stdin is not None:
            process.stdin.close()
        self.tell_table()
        self.feed.end()
        changed()

    def tell_table(self) -> float:
        """Read what a study has found; return how long not to look again, s."""
        begun = time.monotonic()
        with suppress(CaseError, OSError):
            self.table = table_of(StudyFolder.opened(self.study))
        return 1.0 + 20.0 * (time.monotonic() - begun)

    def _hear(self, said: Any) -> None:
        for line in said:
            with suppress(ValueError):
                self.feed.say(json.loads(line))

    @property
    def outcome(self) -> str:
        """How it ended, in words; "" while it goes on."""
        if not self.is_over:
            return ""
        if self.feed.report is not None:
            return self.feed.report.outcome
        code = self.process.returncode if self.process is not None else 0
        if code < 0:
            return f"was killed by {signal.Signals(-code).name}: it ended without a report"
        if code > 1:
            return ENDS.get(code, f"ended with exit code {code}")
        told = [one.strip() for one in self.command.splitlines() if SENTENCE.match(one)]
        return told[-1] if told else "is over"

    def as_dict(self) -> dict[str, Any]:
        """Return it for a window."""
        status = {key: value for key, value in self.feed.status.items() if key != "over"}
        return {
            "number": self.number,
            "kind": self.kind,
            "table": self.table,
            "report": self.is_over and self.report is not None,
            "folder": f"{self.folder.parent.name}/{self.number}",
            "log": self.command[-LOG_MOST:],
            "over": self.is_over,
            "ending": self.asked_to_end and not self.is_over,
            "where": status,
            "frames": self.feed.frames,
            "outcome": self.outcome,
            "seconds": round(self.seconds),
            "pace": self.feed.pace,
        }


class Runs:
    """The runs and studies of a case, one at a time; ``changed`` is told of all that is new."""

    def __init__(self, path: Path, changed: Callable[[], None]) -> None:
        self.path, self.changed = path, changed
        self.folder = path.with_name(f"{path.stem}.runs")
        self.shown: Child | None = None
        """The one that windows show."""
        self._following: threading.Thread | None = None
        self._secret = secrets.token_urlsafe(24)

    def knows(self, secret: str) -> bool:
        """Return whether a text is what the address of a report ends with."""
        return hmac.compare_digest(secret.encode(), self._secret.encode())

    @property
    def feed(self) -> Feed:
        """The frames of the run that is shown."""
        return self.shown.feed if self.shown is not None else Feed(self.folder / "none")

    @property
    def numbers(self) -> list[int]:
        """The numbers of all that there are, the oldest first."""
        names = (one.name for one in self.folder.glob("[0-9]*") if one.is_dir())
        return sorted(int(name) for name in names if name.isdecimal())

    def start(self, text: str, words: Sequence[str] = ()) -> None:
        """Start a command on a copy of a text, ``words`` before the name of the case.

        Without them it is that which the case is for.  Raises CaseError where one is going on, and
        where the text is no case.
        """
        self._check_over()
        case = Case.from_text(text, str(self.path))
        child = self._copied(case, text)
        words = words or ["run" if case.rockfall is None else "rockfall"]
        results = child.feed.path if words[0] == "run" else child.study
        child.start([*words, child.case.name, "-o", results.name])
        self.shown = child
        self._following = threading.Thread(target=child.follow, args=(self.changed,))
        self._following.start()

    def _check_over(self) -> None:
        if self.shown is not None and not self.shown.is_over:
            where, remedy = f"run {self.shown.number}", "end it, or wait for it"
            raise CaseError("is going on", where=where, remedy=remedy)

    def _copied(self, case: Case, text: str) -> Child:
        """Return the place of a run, with the case and the files that it names in it."""
        folder = self.folder / str(max(self.numbers, default=0) + 1)
        names = [
            os.path.normpath(name) for name in case.named_files() if not Path(name).is_absolute()
        ]
        # files above the case stay above it
        depth = max((Path(name).parts.count("..") for name in names), default=0)
        file = folder.joinpath(*["case"] * depth, self.path.name)
        try:
            file.parent.mkdir(parents=True)
            for name in filter(lambda one: (self.path.parent / one).is_file(), names):
                there = file.parent / name
                there.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.path.parent / name, there)
            file.write_bytes(text.encode("utf-8"))
        except OSError as error:
            what = f"cannot be made: {error.strerror}"
            raise CaseError(what, where=str(folder), remedy="see to its folder") from None
        return Child(folder, file)

    def show(self, number: int) -> None:
        """Show an earlier one; raises CaseError where there is none, and while one is going on."""
        self._check_over()
        folder = self.folder / str(number)
        cases = sorted(folder.glob(f"**/{self.path.name}"))
        if not cases:
            raise CaseError("is not there", where=str(folder), remedy="choose another")
        self.shown = Child(folder, cases[0])
        self.shown.feed.say({"paused": False})
        self.shown.feed.end()
        self.shown.tell_table()

    def order(self, order: str) -> None:
        """Hand a request on to the one that goes on; to end asked for twice kills it."""
        child = self.shown
        if child is None or child.is_over:
            return
        if order == "end" and child.asked_to_end:
            child.kill()
        else:
            child.order(order)

    def close(self) -> None:
        """End the one that goes on, and wait for it and for who reads its results."""
        if (child := self.shown) is None:
            return
        child.order("end")
        if child.process is not None:
            with suppress(subprocess.TimeoutExpired):
                child.process.wait(END_WITHIN)
        child.kill()
        if self._following is not None:
            self._following.join()
        child.feed.close()

    def as_dict(self) -> dict[str, Any]:
        """Return them for a window."""
        return {
            "numbers": self.numbers,
            "secret": self._secret,
            "shown": None if self.shown is None else self.shown.as_dict(),
        }


def table_of(there: StudyFolder) -> dict[str, Any]:
    """Return heads and rows of the results of a study, of which there may be more to come."""
    rows = [row(there.study, one) for one in islice(there.results(), ROWS_MOST)]
    # JSON knows no numbers without end
    known = json.loads(json.dumps(rows), parse_constant=lambda _: None)
    return {"heads": columns(there.study), "rows": known}


def _read(path: Path) -> str:
    """Return the text of a file, "" where it cannot be read."""
    with suppress(OSError):
        return path.read_bytes().decode("utf-8", "replace")
    return ""
