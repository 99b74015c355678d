"""What can go wrong, said so that the reader can act on it."""

from __future__ import annotations

from enum import Enum

LONGEST_LINE = 400
"""Most characters of a line of a message: what is echoed from the input may be of any length."""


def shortened(text: str, most: int = 40) -> str:
    """Return a text of at most ``most`` characters: what is longer loses its middle."""
    if len(text) <= most:
        return text
    kept = most - 3
    return f"{text[: kept - kept // 3]}...{text[len(text) - kept // 3 :]}"


class ClastError(Exception):
    """Base of every error that clast raises on purpose; its text is meant for the user."""


class CaseError(ClastError):
    """A case file or command line that cannot be used: says where and what to do.

    ``where`` names file, table and key (or block and vertex), ``what`` the fault and ``remedy``
    the way out; the message is made of the three.
    """

    def __init__(self, what: str, *, where: str = "", remedy: str = "") -> None:
        self.what = what
        self.where = where
        self.remedy = remedy
        lines = [f"{where}: {what}" if where else what]
        if remedy:
            lines.append(f"  {remedy}")
        text = "\n".join(lines).split("\n")
        super().__init__("\n".join(shortened(line, LONGEST_LINE) for line in text))


class ModelError(CaseError):
    """A system of blocks that cannot be simulated: bad polygons, materials, supports or loads."""


class ResultsLost(CaseError):
    """A result file that cannot be written any further: what was written before is kept."""


class StepOutcome(Enum):
    """How a step ended; the value is the text that a user reads, with advice."""

    ACCEPTED = "the step was accepted"
    TRAVELLED_TOO_FAR = (
        "a vertex moved further than max_displacement; a smaller step is tried. If it persists, "
        "the system is flying apart: lower normal_stiffness or time.step, or use passes >= 2"
    )
    TUNNELLED = (
        "a vertex jumped deeper into a block than the reach of contact detection; "
        "a smaller step is tried. If it persists, lower time.max_displacement"
    )
    ROTATED_TOO_FAR = (
        "a block turned further in one step than the linearised equations bear; "
        "a smaller step is tried. If it persists, lower time.max_displacement"
    )
    NOT_FINITE = (
        "the equations gave a displacement that is not a number; a smaller step is tried. "
        "If it persists, look for a block with zero mass or a stiffness that is far too large"
    )
    SINGULAR = (
        "the equations have no unique solution; a smaller step is tried. If it persists, a block "
        "is free to move without mass or support: set dynamic_ratio > 0 or fix it"
    )
    ENERGY_CREATED = (
        "the blocks hold more energy than gravity, loads and the start gave them, so the process "
        "is unstable here. Lower normal_stiffness or time.step, use passes >= 2 or integrator = "
        '"backward-euler"'
    )
    NOT_CONVERGED = (
        "the step did not meet its tolerance; a smaller step is tried. If it persists, lower "
        "normal_stiffness or time.step"
    )


class StepRejected(ClastError):
    """A step that must not be kept; the caller retries from the same state with ``cut`` of h."""

    def __init__(self, outcome: StepOutcome, detail: str = "", cut: float = 0.5) -> None:
        self.outcome = outcome
        self.detail = detail
        self.cut = cut
        super().__init__(f"{outcome.value} ({detail})" if detail else outcome.value)


class RunStopped(ClastError):
    """A run that could not go on; what it had computed until then is kept in ``run``."""

    def __init__(self, message: str, run: object) -> None:
        self.run = run
        super().__init__(message)
