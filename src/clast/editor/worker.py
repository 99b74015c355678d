"""A process that cuts and checks the text of a case, while windows are answered by another.

``python -m clast.editor.worker CASE.toml KEY=VALUE ...`` reads texts, a line of JSON each, and
answers each with two lines or four: findings and section, first with the blocks, then with all
that `clast check` says of them.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from threading import Condition
from typing import IO, Any

from clast.case.checking import checking, stamp_of
from clast.run.progress import compilation_told

LIVE_MOST = 10_000
"""Most blocks that are cut again whenever the text changes; more are when they are asked for."""


class Worker:
    """Has texts checked one after the other; ``changed`` guards it, ``tell`` tells windows."""

    def __init__(
        self, file: str, changed: Condition, tell: Callable[[], None], settings: Sequence[str] = ()
    ) -> None:
        self.text, self.told = "", dict[str, Any]()
        """The text that was checked last, and the findings about it, of ``Checked.as_dict``."""
        self.section, self.sections = b"null", 0
        """The section of that text, JSON, and how many there were."""
        self.is_busy = False
        self.seconds = 0.0
        """How long the last check took until there were blocks."""
        self.off = ""
        """Why texts are not cut as they change, "" where they are."""
        self.settings = settings
        self._changed, self._tell = changed, tell
        self._command = [sys.executable, "-m", "clast.editor.worker", file, *settings]
        self._given: str | None = None
        self._is_asked = self._is_stopped = self._is_over = False
        self._process = _begun(self._command)

    def wants(self, text: str) -> bool:
        """Return whether a text is to be checked."""
        return self._is_asked or (not self.off and text != self._given)

    def ask(self) -> None:
        """Check the next text in any case."""
        self._is_asked = True

    def look(self) -> None:
        """Check the text again where files that it names have changed."""
        named = self.told.get("named", {})
        now = {name: stamp_of(Path(name)) for name in named}
        if not self.is_busy and as_json(now) != as_json(named):
            self._given = None

    def stop(self) -> None:
        """End the check that goes on."""
        if self.is_busy:
            self._is_stopped = True
            self._process.kill()

    def check(self, text: str) -> None:
        """Check a text, and keep what is found; a process that has ended is begun again."""
        with self._changed:
            self._given, self._is_asked, self._is_stopped = text, False, False
            self.is_busy = True
            self._tell()
        begun = time.monotonic()
        try:
            for told, section in _answers(self._process, text):
                with self._changed:
                    self.text, self.told = text, told
                    if section:
                        self.section, self.sections = section, self.sections + 1
                        self.seconds = time.monotonic() - begun
                    if (blocks := told["blocks"]) is not None:
                        many = f"{blocks} blocks are not cut at every change"
                        self.off = many if blocks > LIVE_MOST else ""
                    self._tell()
        except (OSError, EOFError, ValueError):  # its pipes end, or were closed
            self._begin_again()
        with self._changed:
            self.is_busy = False
            self._tell()

    def close(self) -> None:
        """End the process, whatever it does."""
        with self._changed:
            self._is_over = True
            _end(self._process)

    def _begin_again(self) -> None:
        with self._changed:
            if self._is_over:
                return
            ended = _end(self._process)
            self.off = "the cut was stopped"
            if not self._is_stopped:
                self.off = f"the process that cuts has ended ({ended}), perhaps for want of memory"
            self._process = _begun(self._command)


def _begun(command: list[str]) -> subprocess.Popen[bytes]:
    pipe = subprocess.PIPE
    # Ctrl-C is for the window: where its input ends this process ends as well
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, start_new_session=True)


def _end(process: subprocess.Popen[bytes]) -> int:
    """End a process; return the status with which it ended."""
    process.kill()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            pipe.close()
    return process.wait()


def _answers(process: subprocess.Popen[bytes], text: str) -> Iterator[tuple[dict[str, Any], bytes]]:
    """Give findings and section of a text as they come; raises OSError, EOFError at the end."""
    given, answered = process.stdin, process.stdout
    assert given is not None and answered is not None
    given.write(json.dumps(text).encode() + b"\n")
    given.flush()
    while True:
        told, section = answered.readline(), answered.readline()
        if not section.endswith(b"\n"):
            raise EOFError
        found = json.loads(told)
        yield found, section.strip()
        if found["checked"]:
            return


def main(file: str, settings: Sequence[str], texts: IO[bytes], answers: IO[bytes]) -> None:
    """Check texts until there are no more."""
    from clast.editor.section import section_of

    last = None
    for line in texts:
        drawn = None
        for found in checking(json.loads(line), file, settings, last):
            told = {**found.as_dict(), "checked": found.is_whole, "named": found.files}
            # the same blocks are not drawn a second time
            section = "" if drawn and drawn is found.model else as_json(section_of(found))
            last, drawn = found, found.model
            answers.write(f"{as_json(told)}\n{section}\n".encode())
            answers.flush()


def as_json(content: Any) -> str:
    """Return a content as JSON, in one line."""
    return json.dumps(content, allow_nan=False, separators=(",", ":"))


if __name__ == "__main__":
    with suppress(BrokenPipeError), compilation_told(partial(print, file=sys.stderr)):
        main(sys.argv[1], sys.argv[2:], sys.stdin.buffer, sys.stdout.buffer)
