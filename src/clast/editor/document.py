"""A case file while it is edited: its text, the steps back, and the file.

The window shows the text, which may have faults; the file gets it when the hand rests, and
only where clast takes it as a case, so that other programs never find half a number there.  Changes
of the file by other programs are told, never written over.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from os.path import commonprefix
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.editor.edits import Edit, edited
from clast.errors import CaseError
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.positions import Places, places_of
from clast.rockmass.drawings.drawing_files import replaced

STEPS_MAX = 1000
"""Steps that can be undone; older ones are forgotten."""


class OutOfStep(CaseError):
    """A change of a text that is no longer the newest: look again, then change that."""


@dataclass(frozen=True)
class Step:
    """One step of the hand, as the part of the text that it replaced."""

    at: int
    old: str
    new: str
    gesture: str = ""
    """Name of all changes by one field or slider without a pause, which are undone at once."""

    @classmethod
    def between(cls, before: str, after: str, gesture: str = "") -> Step:
        """Return the step from one text to another, without their common beginning and end."""
        at = len(commonprefix([before, after]))  # noqa: RUF071, these are no paths
        tail = len(commonprefix([before[at:][::-1], after[at:][::-1]]))  # noqa: RUF071
        return cls(at, before[at : len(before) - tail], after[at : len(after) - tail], gesture)

    def back(self) -> Step:
        """Return the step that takes this one back."""
        return Step(self.at, self.new, self.old)

    def taken(self, text: str) -> str:
        """Return the text after the step."""
        return text[: self.at] + self.new + text[self.at + len(self.old) :]


class Document:
    """The text of a case file with its steps; one thread at a time may use it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.filed = "" if begins(path) else case_text.read_exact(path)
        """Content of the file as far as is known."""
        self.text = self.filed
        self.version = 0
        """Counts up with each other text."""
        self.conflict: str | None = None
        """Content that another program gave the file while the text here was not in it."""
        self._done: list[Step] = []
        self._undone: list[Step] = []

    @cached_property
    def trouble(self) -> CaseError | None:
        """Why the text is no case; None where clast takes it."""
        try:
            Case.from_text(self.text, str(self.path))
        except CaseError as error:
            return error
        return None

    @cached_property
    def read(self) -> tuple[dict[str, Any], Places]:
        """The values of the text, and where they stand; raises CaseError where it is not TOML."""
        return case_text.parse(self.text, str(self.path)), places_of(self.text)

    @property
    def unsaved(self) -> bool:
        """Whether the file has another text."""
        return self.text != self.filed

    @property
    def steps(self) -> tuple[int, int]:
        """How many steps can be undone, and how many done again."""
        return len(self._done), len(self._undone)

    def edit(self, edits: Iterable[Edit], version: int, gesture: str = "") -> None:
        """Make changes as one step, all of them or none.

        Those of one ``gesture`` that follow each other are one step.  Raises OutOfStep where
        ``version`` is not the newest, CaseError where a change cannot be made.
        """
        self._check(version)
        text, places = self.text, self.read[1]
        for one in edits:
            text = edited(text, one, str(self.path), places if text == self.text else None)
        self._become(text, gesture)

    def replace(self, text: str, version: int, gesture: str = "") -> None:
        """Take a whole text, TOML or not, as one step; raises OutOfStep as ``edit`` does."""
        self._check(version)
        self._become(text, gesture)

    def undo(self, version: int) -> None:
        """Take the last step back, where there is one."""
        self._check(version)
        self._walk(self._done, self._undone)

    def redo(self, version: int) -> None:
        """Make the last step again that was taken back, where there is one."""
        self._check(version)
        self._walk(self._undone, self._done)

    def _check(self, version: int) -> None:
        if version != self.version:
            what = f"was changed meanwhile (version {self.version}, not {version})"
            raise OutOfStep(what, where=str(self.path), remedy="look at it again")

    def _become(self, text: str, gesture: str = "") -> None:
        if text == self.text:
            return
        before = self.text
        if gesture and self._done and self._done[-1].gesture == gesture and not self._undone:
            before = self._done.pop().back().taken(before)
        self._done.append(Step.between(before, text, gesture))
        del self._done[:-STEPS_MAX]
        self._undone.clear()
        self._show(text)

    def _walk(self, source: list[Step], target: list[Step]) -> None:
        if source:
            step = source.pop().back()
            target.append(step)
            self._show(step.taken(self.text))

    def _show(self, text: str) -> None:
        self.text = text
        self.version += 1
        for of_text in ("trouble", "read"):
            vars(self).pop(of_text, None)

    def look(self) -> None:
        """Take the file as another program left it, as one step, or tell of a conflict.

        Raises CaseError where the file cannot be read; the text stays then.
        """
        found = "" if not self.filed and begins(self.path) else case_text.read_exact(self.path)
        if found in (self.filed, self.text):
            self.filed, self.conflict = found, None
        elif self.unsaved:
            self.conflict = found
        else:
            self.filed = found
            self._become(found)

    def save(self) -> None:
        """Write the text into the file where clast takes it as a case; raises as ``write`` does."""
        if self.unsaved and self.conflict is None and self.trouble is None:
            self.write()

    def write(self) -> None:
        """Write the text as it is, on the user's word.

        The file is replaced at once, whole, with its permissions.  Raises CaseError where it cannot
        be written, and where somebody else has written into it.
        """
        if self.path.exists():
            self.look()
            if not os.access(self.path, os.W_OK):
                remedy = "change its permissions"
                raise CaseError("must not be written to", where=str(self.path), remedy=remedy)
        if self.conflict is not None:
            what, remedy = "was changed by somebody else", "choose one of the two texts"
            raise CaseError(what, where=str(self.path), remedy=remedy)
        with replaced(self.path) as file:
            file.write(self.text.encode("utf-8"))
        self.filed = self.text

    def keep_mine(self) -> None:
        """End a conflict with the text here, which the file gets next."""
        if self.conflict is not None:
            self.filed, self.conflict = self.conflict, None

    def keep_theirs(self) -> None:
        """End a conflict with the text of the file, as a step that can be undone."""
        if self.conflict is not None:
            self.filed, theirs, self.conflict = self.conflict, self.conflict, None
            self._become(theirs)


def begins(path: Path) -> bool:
    """Return whether a path names a case that is not there yet, but may be."""
    is_free = not path.exists() and not path.is_symlink()
    return is_free and path.suffix == ".toml" and path.absolute().parent.is_dir()
