"""Errors, worded so that the reader can act on them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Self

Place = tuple[str | int, ...]
"""Keys and list positions (from 0) that lead to a value of a case file."""
Points = tuple[tuple[float, float], ...]
"""A point, or the points of a line, [x, y], m."""

FAULTS_LISTED_MAX = 10
"""Most faults that one message lists."""
LONGEST_LINE = 400
"""Most characters of a line of a message: text echoed from the input may be of any length."""


def shortened(text: str, most: int = 40) -> str:
    """Return a text of at most ``most`` characters: a longer one loses its middle."""
    if len(text) <= most:
        return text
    kept = most - 3
    return f"{text[: kept - kept // 3]}...{text[len(text) - kept // 3 :]}"


SLIP = re.compile(r"[^A-Za-z]*([A-Za-z][^A-Za-z]*){0,3}")
"""Letters that are mistyped for digits: three at most.  Other text of a file is not repeated."""


def mistyped(text: str) -> str:
    """Return in quotes the text in the place of a number, or a note that it is not shown.

    A path may name any file: of its text, messages repeat mistyped numbers alone.
    """
    if len(text) <= 40 and SLIP.fullmatch(text):
        return f"'{text}'"
    return "the text there"


class ClastError(Exception):
    """Base of every error that clast raises on purpose; its text is meant for the user."""


@dataclass(frozen=True)
class Fault:
    """One thing to put right."""

    what: str
    remedy: str = ""
    place: Place = ()
    """Where it stands in the case file; empty where that is not known."""
    at: Points = ()
    """Where it is in the section, m; empty where that is not known."""


class Remark(str):
    """A note or a warning, with its ``place`` in the case file and ``at``, its points, m."""

    place: Place
    at: Points

    def __new__(cls, text: str, place: Place = (), at: Points = ()) -> Self:
        """Make a remark of a text."""
        made = super().__new__(cls, text)
        made.place, made.at = place, at
        return made


class CaseError(ClastError):
    """A case file or command line that cannot be used: says where and how to correct it.

    ``where`` names file, table and key (or block and vertex), ``what`` is the fault and ``remedy``
    what to do; the message is made of the three.  ``faults`` has each fault of a case file by
    itself; ``place`` and ``at`` are those of the first.
    """

    def __init__(
        self, what: str, *, where: str = "", remedy: str = "", faults: tuple[Fault, ...] = ()
    ) -> None:
        self.what = what
        self.where = where
        self.remedy = remedy
        self.faults = faults or (Fault(what, remedy),)
        lines = [f"{where}: {what}" if where else what]
        if remedy:
            lines.append(f"  {remedy}")
        text = "\n".join(lines).split("\n")
        super().__init__("\n".join(shortened(line, LONGEST_LINE) for line in text))

    @property
    def place(self) -> Place:
        """Keys and list positions (from 0) of the first fault; empty where they are not known."""
        return self.faults[0].place

    @property
    def at(self) -> Points:
        """Point of the first fault in the section, or points of a line, m; empty where unknown."""
        return self.faults[0].at


class ModelError(CaseError):
    """A system of blocks that cannot be simulated: bad polygons, materials, supports or loads."""


def raise_all(errors: Sequence[ModelError]) -> None:
    """Raise the error that there is, or one that lists several, each with its remedy."""
    if len(errors) == 1:
        raise errors[0]
    if errors:
        lines = [f"{len(errors)} things to put right"]
        for one in errors[:FAULTS_LISTED_MAX]:
            lines += [f"  {one.where}: {one.what}", *([f"    {one.remedy}"] if one.remedy else [])]
        if len(errors) > FAULTS_LISTED_MAX:
            lines.append(f"  and {len(errors) - FAULTS_LISTED_MAX} more")
        raise ModelError("\n".join(lines))


class ResultsLost(CaseError):
    """A result file that cannot be written any further: all frames written before are kept."""


class ActionFault(CaseError):
    """An action of a script that edits its arguments, or returns something that no step can use."""


class RunWarning(UserWarning):
    """The category of a run's warnings to a script:  Python's ``warnings`` filter them by it."""


class StepOutcome(Enum):
    """How a step ended; the value is the text that a user reads."""

    ACCEPTED = "the step was accepted"
    TRAVELLED_TOO_FAR = "a vertex moved further than max_displacement"
    TUNNELLED = "a vertex entered a block without any contact detecting it"
    ROTATED_TOO_FAR = "a block turned further in one step than the linearised equations allow"
    NOT_FINITE = "the equations gave NaN displacements"
    SINGULAR = "the equations have no unique solution"
    ENERGY_CREATED = "the blocks hold more energy than gravity, loads and the start gave them"
    NOT_CONVERGED = "the step did not meet its tolerance"


class StepRejected(ClastError):
    """A step that must not be kept; the caller retries from the same state with ``cut`` of h.

    ``remedy`` is the advice where no retry is left; ``cuts`` is the number of retries.
    """

    def __init__(
        self, outcome: StepOutcome, detail: str = "", cut: float = 0.5, remedy: str = ""
    ) -> None:
        self.outcome = outcome
        self.detail = detail
        self.cut = cut
        self.cuts = 0
        what = f"{outcome.value} ({detail})" if detail else outcome.value
        super().__init__(f"{what}. {remedy}" if remedy else what)


class RunStopped(ClastError):
    """A run that could not go on; its results until then are kept in ``run``."""

    def __init__(self, message: str, run: object) -> None:
        self.run = run
        super().__init__(message)
