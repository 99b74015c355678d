"""Small changes of a TOML text at a place: everything else in it stays as it is, to the byte."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from clast.errors import CaseError, Place
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.positions import BLANK, SPACE, Places, Section, Written, places_of

COMMA = re.compile(BLANK.pattern + ",")
COMMENT = re.compile(r"[ \t]*(?:#[^\n]*)?(?=\r?\n|$)")
"""Space and comment between the last item in a line and the end of the line."""


@dataclass(frozen=True)
class Edit:
    """One change of a case file at a place, with a value written as in TOML.

    ``set`` gives a value, which need not be there yet; ``insert`` puts an item before that at the
    place, or after the last; an entry of a list of tables is written ``{name = "A", ...}``;
    ``remove`` takes a value, an item, a table or all its entries away; ``rename`` gives another
    key, ``toml``, to all that stands below the place; ``swap`` puts an entry of a list behind the
    next one.
    """

    do: Literal["set", "insert", "remove", "rename", "swap"]
    place: Place
    toml: str = ""


def edited(text: str, edit: Edit, file: str = "case", places: Places | None = None) -> str:
    """Return a text with one change; raises CaseError where it is none that can be made there.

    ``places`` are those of the text, where they are known.
    """
    if places is None:
        case_text.parse(text, file)
        places = places_of(text)
    if not edit.place:
        raise CaseError("names no place", where=file, remedy="name a table or a key")
    changed = _WAYS[edit.do](places, edit.place, edit.toml)
    case_text.parse(changed, file)
    return changed


def _set(at: Places, place: Place, toml: str) -> str:
    toml, value = _literal(place, toml), at.values.get(place)
    if value is not None:
        return _spliced(at.text, value.start, value.end, toml)
    if at.has(place):
        at = places_of(_remove(at, place, ""))
    return _added(at, place, toml)


def _insert(at: Places, place: Place, toml: str) -> str:
    toml, (*above, number) = _literal(place, toml), place
    if not isinstance(number, int):
        raise CaseError("is no item of a list", where=_words(place), remedy="set it")
    if not at.has(tuple(above)) and not toml.startswith("{"):
        return _added(at, tuple(above), f"[{toml}]")
    return _added(at, place, toml)


def _added(at: Places, place: Place, toml: str) -> str:
    """Return the text with a value at a place that has none, or with an item before it."""
    above, key = place[:-1], place[-1]
    if above in at.values:
        return _into(at, above, key, toml)
    if isinstance(key, int):
        return _new_table(at, place, _lines_of(toml))
    # only a table with a head; the beginning of the text needs none
    section = next((one for one in at.sections if one.place == above), None)
    if toml.startswith("{") and (not above or section is None):
        return _new_table(at, place, _lines_of(toml))
    if section is not None:
        return _new_line(at, section, section.after, f"{_key(key)} = {toml}")
    dotted = at.lines_under(above)
    if dotted and not at.under(above):
        # of output.interval = 1 the neighbours are written so as well
        head = next(one for one in at.sections if dotted[-1].last <= one.end)
        keys = ".".join(_key(part) for part in place[len(head.place) :])
        return _new_line(at, head, dotted[-1].last, f"{keys} = {toml}")
    if above[:-1] in at.values:
        return _added(at, above, f"{{{_key(key)} = {toml}}}")
    return _new_table(at, above, [f"{_key(key)} = {toml}"])


def _new_line(at: Places, section: Section, after: int, line: str) -> str:
    text, newline = at.text, _newline(at.text)
    if not section.place and section.after == section.start:
        # no value before the first table: behind what the file says of itself
        after = section.end
        line += newline if after < len(text) else ""
    before = newline if after > section.start and not text[:after].endswith("\n") else ""
    return _spliced(text, after, after, f"{before}{section.indent}{line}{newline}")


def _new_table(at: Places, place: Place, lines: list[str]) -> str:
    """Return the text with a table at the end of its like, or before the entry at its place."""
    text, newline = at.text, _newline(at.text)
    there = at.under(place)
    number = place[-1]
    is_entry = isinstance(number, int)
    if isinstance(number, int) and number > len(
        {one.place[len(place) - 1] for one in at.under(place[:-1])}
    ):
        raise CaseError("is behind the end of its list", where=_words(place))
    if is_entry and there:
        start = min(one.lead for one in there)
    else:
        near = place[:-1]
        while not at.under(near):
            near = near[:-1]
        start = max(one.end for one in at.under(near))
    keys = ".".join(_key(part) for part in place if isinstance(part, str))
    head = f"[[{keys}]]" if is_entry else f"[{keys}]"
    block = newline.join([head, *lines]) + newline
    if start < len(text):
        block += newline
    ended = text[:start].removeprefix(case_text.BYTE_ORDER_MARK)
    if ended and not ended.endswith("\n"):
        block = newline + block
    if ended.strip() and not re.search(r"\n\r?\n$", ended):
        block = newline + block
    return _spliced(text, start, start, block)


def _lines_of(toml: str) -> list[str]:
    """Return the values of a table in {} as lines."""
    if not toml.startswith("{"):
        remedy = "write it in braces, as {name = 1}"
        raise CaseError("is a table, not a single value", where=toml, remedy=remedy)
    at = places_of(f"v = {toml}")
    return [at.text[one.first : one.end] for one in at.inside(("v",))]


def _into(at: Places, above: Place, key: str | int, toml: str) -> str:
    """Return the text with an item more in an array or in a table in {}."""
    text, held, items = at.text, at.values[above], at.inside(above)
    is_array = text[held.start] == "["
    if is_array != isinstance(key, int) or (isinstance(key, int) and key > len(items)):
        raise CaseError("is no place in what stands there", where=_words((*above, key)))
    if isinstance(key, str):
        toml = f"{_key(key)} = {toml}"
        if items and "=" in text and re.match(r"[^\s=]+=\S", text[items[0].first : items[0].end]):
            toml = toml.replace(" = ", "=", 1)
    if not items:
        return _spliced(text, held.start + 1, held.start + 1, toml)
    if isinstance(key, int) and key < len(items):
        begin = items[key].first
        indent = _own_line(text, begin)
        gap = " " if indent is None else _newline(text) + indent
        return _spliced(text, begin, begin, f"{toml},{gap}")
    last = items[-1]
    comma = COMMA.match(text, last.end)
    end = comma.end() if comma else last.end
    rest, indent = COMMENT.match(text, end), _own_line(text, last.first)
    if rest is None or indent is None or not is_array:
        return _spliced(text, last.end, last.end, f", {toml}")
    whole = text[last.end : end] if comma else ","
    more = f"{whole}{rest[0]}{_newline(text)}{indent}{toml}{',' if comma else ''}"
    return _spliced(text, last.end, rest.end(), more)


def _own_line(text: str, at: int) -> str | None:
    """Return the white space before a position where nothing else stands before it in its line."""
    before = text[text.rfind("\n", 0, at) + 1 : at]
    return before if not before.strip() else None


def _remove(at: Places, place: Place, _: str) -> str:
    held = at.values.get(place)
    if held is not None and not held.is_line:
        return _without_item(at, place, held)
    cuts = [(one.lead, one.end) for one in at.under(place)]
    cuts += [
        (one.first, one.last)
        for one in at.lines_under(place)
        if not any(begin <= one.first < end for begin, end in cuts)
    ]
    if not cuts:
        raise CaseError("there is no such value", where=_words(place))
    text = at.text
    for begin, end in sorted(cuts, reverse=True):
        if end == len(text):
            begin = len(text[:begin].rstrip("\r\n")) + len(_newline(text)) if begin else 0
        text = _spliced(text, min(begin, end), end, "")
    return text


def _without_item(at: Places, place: Place, held: Written) -> str:
    """Return the text without an item of an array or of a table in {}, and without its comma."""
    text, items = at.text, at.inside(place[:-1])
    number = items.index(held)
    comma = COMMA.match(text, held.end)
    end = comma.end() if comma else held.end
    rest, indent = COMMENT.match(text, end), _own_line(text, held.first)
    if rest is not None and indent is not None and rest.end() < len(text):
        ended = text.index("\n", rest.end()) + 1
        return _spliced(text, held.first - len(indent), ended, "")
    if comma:
        gap = SPACE.match(text, end)
        return _spliced(text, held.first, gap.end() if gap else end, "")
    begin = items[number - 1].end if number else held.first
    return _spliced(text, begin, held.end, "")


def _rename(at: Places, place: Place, name: str) -> str:
    found = [(begin, end) for named, begin, end in at.names if named == place]
    if not found:
        raise CaseError("there is no such name", where=_words(place))
    if place[-1] != name and at.has((*place[:-1], name)):
        raise CaseError(f"there is '{name}' already", where=_words(place))
    text = at.text
    for begin, end in reversed(found):
        text = _spliced(text, begin, end, _key(name))
    return text


def _swap(at: Places, place: Place, _: str) -> str:
    text, spans, (*above, number) = at.text, list[tuple[int, int]](), place
    if not isinstance(number, int):
        raise CaseError("is no item of a list", where=_words(place))
    for one in (place, (*above, number + 1)):
        held, there = at.values.get(one), at.under(one)
        if held is None and not there:
            raise CaseError("there is no such entry", where=_words(one))
        begin = min(part.lead for part in there) if held is None else held.first
        spans.append((begin, max(part.after for part in there) if held is None else held.end))
    (first, middle), (after, last) = spans
    ahead, behind = text[first:middle], text[after:last]
    if place not in at.values and not behind.endswith("\n"):
        behind += _newline(text)
    return _spliced(text, first, last, behind + text[middle:after] + ahead)


_WAYS: Mapping[str, Callable[[Places, Place, str], str]] = {
    "set": _set,
    "insert": _insert,
    "remove": _remove,
    "rename": _rename,
    "swap": _swap,
}


def _literal(place: Place, toml: str) -> str:
    """Return a value as it is written, or raise CaseError where it is not one value of TOML."""
    toml = toml.strip()
    content = case_text.parse(f"v = {toml}\n", _words(place))
    written = places_of(f"v = {toml}\n").values["v",]
    if list(content) != ["v"] or written.end != len(toml) + 4:
        raise CaseError("is not one value", where=_words(place), remedy="write a single value")
    return toml


def _key(name: str | int) -> str:
    return case_text.written_key(str(name))


def _words(place: Place) -> str:
    return ".".join(str(one + 1) if isinstance(one, int) else one for one in place)


def _newline(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _spliced(text: str, begin: int, end: int, new: str) -> str:
    return text[:begin] + new + text[end:]
