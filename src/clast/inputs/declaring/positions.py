"""Where the values, tables and keys of a TOML text stand in it, so that each changes alone.

Libraries that write TOML anew move comments and tables: a value is replaced in the text instead,
between the two positions that are found here.  The text must be TOML: that is ``tomllib``'s to say.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from clast.errors import Place
from clast.inputs.declaring.text import BYTE_ORDER_MARK

BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*+)*+")
"""White space, ends of lines and comments."""
SPACE, REST = re.compile(r"[ \t]*"), re.compile(r"[^\n]*\n?")
"""White space within a line; the rest of a line, with its end."""
DOT, EQUALS = re.compile(r"[ \t]*\.[ \t]*"), re.compile(r"[ \t]*=[ \t]*")
KEY = re.compile(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'|[^\s.=\]]+')
SINGLE = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2})|"(?:\\.|[^"\\])*"'
    r"|'''.*?'''(?:'{0,2})|'[^']*'"
    r"|\d{4}-\d\d-\d\d (?=\d\d:)[^\s,\]}#]*|[^\s,\]}#]+",
    re.DOTALL,
)
"""A text, a date with a time behind a space, or a number, date or truth value."""


@dataclass(frozen=True)
class Written:
    """A value in the text; ``first`` to ``last`` is it with its key, and as a line all of that."""

    start: int
    end: int
    first: int
    last: int
    is_line: bool = False
    """Whether it is a line ``key = value`` of its own, not an item of an array or a table in {}."""


@dataclass(frozen=True)
class Section:
    """A table with a head, or the beginning of the text, which has none."""

    place: Place
    start: int
    """Its head."""
    lead: int
    """Where it begins: at the comments right above its head."""
    after: int
    """Where its next line belongs: behind its last value, or its head."""
    end: int
    """Where the next one begins."""
    indent: str = ""
    """White space before its last value."""


@dataclass(frozen=True)
class Places:
    """Positions of all parts of a TOML text; they count characters from 0."""

    text: str
    values: dict[Place, Written]
    """Every value, those within arrays and tables in {} too."""
    sections: list[Section]
    names: list[tuple[Place, int, int]]
    """Every part of a key: the place that it names, its first and last position."""

    def line(self, place: Place) -> int | None:
        """Return the line, from 1, of the value or table at a place, or of the table around it."""
        for length in range(len(place), 0, -1):
            at = self._start(place[:length])
            if at is not None:
                return self.text.count("\n", 0, at) + 1
        return None

    def spans(self) -> Iterator[tuple[Place, int, int]]:
        """Give tables with a head and lines ``key = value``, with first and last line, from 1."""
        ends = [found.start() for found in re.finditer("\n", self.text)]
        heads = [(one.place, one.start, one.after) for one in self.sections if one.place]
        lines = [(at, one.first, one.last) for at, one in self.values.items() if one.is_line]
        for place, first, past in (*heads, *lines):
            yield place, bisect_left(ends, first) + 1, bisect_left(ends, past - 1) + 1

    def _start(self, place: Place) -> int | None:
        if place in self.values:
            return self.values[place].start
        heads = [one.start for one in self.sections if one.place == place and place]
        return min([*heads, *(at for named, at, _ in self.names if named == place)], default=None)

    def under(self, place: Place) -> list[Section]:
        """Return the tables with a head at a place or below it."""
        return [one for one in self.sections if one.place[: len(place)] == place]

    def lines_under(self, place: Place) -> list[Written]:
        """Return the lines ``key = value`` at a place or below it."""
        size = len(place)
        return [one for at, one in self.values.items() if one.is_line and at[:size] == place]

    def inside(self, place: Place) -> list[Written]:
        """Return the items of an array or of a table in {}, in their order."""
        size = len(place)
        return [one for at, one in self.values.items() if at[:-1] == place and len(at) > size]

    def has(self, place: Place) -> bool:
        """Return whether there is a value, a table or a part of a key at a place."""
        return bool(self.under(place) or self.lines_under(place) or place in self.values)


def places_of(text: str) -> Places:
    """Return where the values and tables of a TOML text stand."""
    begin = len(text) - len(text.removeprefix(BYTE_ORDER_MARK))
    return _Reader(text, begin, head=Section((), begin, begin, begin, begin), after=begin).read()


@dataclass
class _Reader:
    """Reads a text once from its beginning to its end."""

    text: str
    at: int
    head: Section
    """The table that lines belong to."""
    after: int
    values: dict[Place, Written] = field(default_factory=dict)
    names: list[tuple[Place, int, int]] = field(default_factory=list)
    sections: list[Section] = field(default_factory=list)
    counts: Counter[Place] = field(default_factory=Counter)
    """Entries of lists of tables so far."""

    def read(self) -> Places:
        """Return the positions of all parts."""
        lead: int | None = None
        while self.at < len(self.text):
            line = self.at
            self._pass(SPACE)
            mark = self.text[self.at : self.at + 1]
            if mark == "#":
                lead = line if lead is None else lead
                self._pass(REST)
                continue
            if mark == "[":
                self._head(line if lead is None else lead)
            elif mark not in ("", "\r", "\n"):
                self._line(line)
            else:
                self._pass(REST)
            lead = None
        self._close(len(self.text))
        return Places(self.text, self.values, self.sections, self.names)

    def _close(self, end: int) -> None:
        self.sections.append(replace(self.head, after=self.after, end=end))

    def _head(self, lead: int) -> None:
        """Read the head of a table or of an entry of a list of tables."""
        self._close(lead)
        start, is_entry = self.at, self.text.startswith("[[", self.at)
        self.at += 1 + is_entry
        self._pass(SPACE)
        place = self._key(())
        if is_entry:
            self.counts[place] += 1
            place = (*place, self.counts[place] - 1)
        self._pass(REST)
        self.head, self.after = Section(place, start, lead, self.at, self.at), self.at

    def _key(self, place: Place) -> Place:
        """Read a key with its dots; return the place that it names below a place."""
        while True:
            if place in self.counts:
                place = (*place, self.counts[place] - 1)
            found = KEY.match(self.text, self.at)
            assert found is not None, "the text is not TOML"
            raw = found[0]
            name = next(iter(tomllib.loads(f"{raw} = 0"))) if raw[0] in "\"'" else raw
            place = (*place, name)
            self.names.append((place, found.start(), found.end()))
            dot = DOT.match(self.text, found.end())
            self.at = dot.end() if dot else found.end()
            if not dot:
                return place

    def _line(self, line: int) -> None:
        """Read a line ``key = value``, which has several where its value has."""
        self.head = replace(self.head, indent=self.text[line : self.at])
        place = self._key(self.head.place)
        self._pass(EQUALS)
        self._value(place, line)
        self._pass(REST)
        self.values[place] = replace(self.values[place], last=self.at, is_line=True)
        self.after = self.at

    def _value(self, place: Place, first: int) -> None:
        """Read a value, whose key begins at ``first``, and the values in it."""
        start = self.at
        mark = self.text[start]
        # the order of values is that of the text, what holds others first
        self.values[place] = Written(start, start, first, start)
        if mark in "[{":
            self.at += 1
            self._items(place, mark)
        else:
            self._pass(SINGLE)
        self.values[place] = Written(start, self.at, first, self.at)

    def _items(self, place: Place, mark: str) -> None:
        number = 0
        while True:
            self._pass(BLANK)
            if self.text[self.at] in "]}":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
                continue
            first, inner = self.at, (*place, number)
            if mark == "{":
                inner = self._key(place)
                self._pass(EQUALS)
            self._value(inner, first)
            number += 1

    def _pass(self, what: re.Pattern[str]) -> None:
        found = what.match(self.text, self.at)
        assert found is not None, "the text is not TOML"
        self.at = found.end()
