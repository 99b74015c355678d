"""A text of numbers alone, as the files of Shi's programs are, read one after the other."""

from __future__ import annotations

from pathlib import Path

from clast.errors import CaseError, mistyped, shortened
from clast.rockmass.drawings.drawing_files import text_of
from clast.rockmass.drawings.numbers import number_of
from clast.rockmass.legacy.words import NumberRow


class NumberText:
    """The numbers of a file in their order, separated by spaces and ends of lines."""

    def __init__(self, path: Path) -> None:
        self.file = str(path)
        lines = text_of(path).split("\n")
        self._words = [(word, k) for k, line in enumerate(lines, 1) for word in line.split()]
        self._next = 0

    def number(self, what: str) -> float:
        """Return the next number, or say where ``what`` is missing or is not a number."""
        if self._next == len(self._words):
            line = f"line {self._words[-1][1]}" if self._words else "line 1"
            raise CaseError(
                f"ends before {what}",
                where=f"{self.file}: {line}",
                remedy="check that the file is complete and its counts are right",
            )
        word, line_number = self._words[self._next]
        self._next += 1
        value = number_of(word)
        if value is None:
            raise CaseError(
                f"{mistyped(word)} is not a number, or far too large: {what} is expected here",
                where=f"{self.file}: line {line_number}",
                remedy="check that it is the right kind of file and that its counts are right",
            )
        return value

    def count(self, what: str, width: int = 0) -> int:
        """Return the next number as a count of things that have ``width`` numbers each."""
        value = self.number(f"the number of {what}")
        line = self._words[self._next - 1][1]
        left = len(self._words) - self._next
        if value != round(value) or value < 0:
            raise CaseError(
                f"{value:g} is not a valid number of {what}",
                where=f"{self.file}: line {line}",
                remedy="give a whole number, 0 or more",
            )
        if value * width > left:
            raise CaseError(
                f"{value:.0f} {what} are announced, but only {left} numbers follow",
                where=f"{self.file}: line {line}",
                remedy="check that the file is complete and its counts are right",
            )
        return int(value)

    def row(self, width: int, what: str) -> NumberRow:
        """Return the next ``width`` numbers."""
        first = self._words[min(self._next, len(self._words) - 1)][1] if self._words else 1
        values = tuple(self.number(what) for _ in range(width))
        return NumberRow(values=values, place=f"line {first}")

    def rows(self, count: int, width: int, what: str) -> tuple[NumberRow, ...]:
        """Return the next ``count`` rows of ``width`` numbers."""
        return tuple(self.row(width, f"{what} {k}") for k in range(1, count + 1))

    def rest(self) -> tuple[str, str]:
        """Return the words that were not read, shortened, and where they begin; empty if none."""
        words = self._words[self._next :]
        if not words:
            return "", ""
        text = " ".join(word for word, _ in words[:12])
        more = f" ... ({len(words)} words)" if len(words) > 12 else ""
        return shortened(text, 120) + more, f"line {words[0][1]}"
