"""Checks of a case file in one warm process, as `clast check` makes them, with little made anew.

The blocks of the text before stay where the rock mass, and the files that it names, are the same;
everything else of a check takes less time than they do.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clast.case.case_file import Case
from clast.errors import CaseError, Fault, Place, Points, Remark
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.positions import Places, places_of
from clast.inputs.declaring.validation_messages import place_text

if TYPE_CHECKING:
    from clast.model.model import Model
    from clast.run.preflight import CaseSummary

LOOK_EVERY = 0.1
"""Time between two looks at a file that is watched, s."""
Stamp = tuple[int, int, int] | None
"""Time of change, size and number of a file, None for one that is not there."""


@dataclass(frozen=True)
class Checked:
    """Findings about a text; without faults there is a model of blocks, or rocks that fall."""

    text: str
    file: str
    content: Mapping[str, Any] = field(default_factory=dict)
    """The values of the text, empty where it is not TOML."""
    faults: tuple[Fault, ...] = ()
    where: str = ""
    """Words for a place that is no key: the line of a text that is not TOML."""
    case: Case | None = None
    model: Model | None = None
    summary: CaseSummary | None = None
    files: Mapping[str, Stamp] = field(default_factory=dict)
    """Those that the case names, with their stamps."""

    @property
    def is_whole(self) -> bool:
        """Whether there is no more to find."""
        return self.model is None or self.summary is not None

    def as_dict(self, places: Places | None = None) -> dict[str, Any]:
        """Return it for JSON; ``place`` has keys and positions from 0, lines count from 1.

        ``places`` are those of the text, where they are known.
        """
        summary, model = self.summary, self.model
        warnings = summary.warnings if summary else ()
        notes = summary.notes if summary else ()
        if places is None and self.content and (self.faults or warnings or notes):
            places = places_of(self.text)
        told = [self._told(one, one.what, one.remedy, places) for one in self.faults]
        return {
            "file": self.file,
            "blocks": model.block_count if model else None,
            "steps": summary.steps if summary else None,
            "faults": told,
            "warnings": [self._told(one, str(one), "", places) for one in warnings],
            "notes": [self._told(one, str(one), "", places) for one in notes],
        }

    def _told(
        self, one: Fault | Remark | str, what: str, remedy: str, places: Places | None
    ) -> dict[str, Any]:
        place: Place = getattr(one, "place", ())
        at: Points = getattr(one, "at", ())
        line = re.search(r"\bline (\d+)", self.where)
        own = int(line[1]) if line else None
        return {
            "what": what,
            "remedy": remedy,
            "where": place_text(place, self.content) or self.where,
            "place": list(place),
            "line": places.line(place) if places and place else own,
            "at": [list(point) for point in at],
        }


def check(
    text: str, file: str, settings: Iterable[str] = (), before: Checked | None = None
) -> Checked:
    """Return the findings of `clast check` about a text as if it stood in ``file``."""
    *_, last = checking(text, file, settings, before)
    return last


def checking(
    text: str, file: str, settings: Iterable[str] = (), before: Checked | None = None
) -> Iterator[Checked]:
    """Give the findings of ``check``: first the blocks, where there are any, then all."""
    found = Checked(text=text, file=file)
    try:
        found = replace(found, content=case_text.parse(text, file))
        case = Case.from_text(text, file, settings)
        found = replace(found, case=case, files=stamps_of(case))
        if before is not None and before.case is not None and before.files == found.files:
            case.cut_as(before.case)
        if case.rockfall is not None:
            case.campaign()
        if case.has_blocks:
            found = replace(found, model=case.model())
            yield found
            found = replace(found, summary=case.examine(found.model))
        yield found
    except CaseError as error:
        where = error.where.removeprefix(f"{file}: ") if error.where != file else ""
        yield replace(found, model=None, faults=error.faults, where=where)


def stamps_of(case: Case) -> dict[str, Stamp]:
    """Return the files that a case names, with their stamps."""
    paths = [Path(case.file).parent / name for name in case.named_files()]
    return {str(path): stamp_of(path) for path in paths}


def checks(path: Path, settings: Iterable[str] = ()) -> Iterator[Checked | None]:
    """Give the findings about a file now and after each change of it or of files that it names.

    None is given at each look at which there is nothing new; the file is looked at ten times a
    second.
    """
    settings = list(settings)
    before, seen = None, None
    while True:
        files: dict[str, Stamp] = stamps_of(before.case) if before and before.case else {}
        now = stamp_of(path), files
        if before is None or now != seen:
            try:
                before = check(case_text.read_text(path), str(path), settings, before)
            except CaseError as error:  # it has gone, or is no text
                before = Checked(text="", file=str(path), faults=error.faults)
            seen = now[0], before.files
            yield before
        else:
            yield None
        time.sleep(LOOK_EVERY)


def stamp_of(path: Path) -> Stamp:
    """Return time of change, size and number of a file, None where there is none."""
    try:
        of = path.stat()
    except OSError:
        return None
    return of.st_mtime_ns, of.st_size, of.st_ino
