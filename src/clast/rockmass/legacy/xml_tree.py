"""A small XML tree with line numbers; document types and entities are refused unread."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from clast.errors import CaseError, shortened
from clast.rockmass.drawings.drawing_files import checked_file

DEEPEST = 100
"""Most elements within elements."""


@dataclass(frozen=True, kw_only=True)
class Element:
    """An element; names are local and in small letters."""

    name: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    @property
    def place(self) -> str:
        """Return where it stands, for messages."""
        return f"line {self.line}, {self.name}"

    @property
    def text(self) -> str:
        """Return its own text."""
        return " ".join("".join(self.texts).split())

    def all(self, name: str) -> Iterator[Element]:
        """Yield the elements with that name below this one, in their order."""
        for child in self.children:
            if child.name == name:
                yield child
            yield from child.all(name)

    def value(self, attribute: str) -> str:
        """Return an attribute or, where it is missing, the element's text."""
        return self.attributes.get(attribute, self.text).strip()


def xml_tree(path: Path) -> Element:
    """Return the root element of an XML file.

    Raises CaseError with the line where it is not XML, and for document types, which can make a
    small file grow without bound or read other files.
    """
    content = checked_file(path).read_bytes()
    builder = _Builder(str(path))
    try:
        builder.parser.Parse(content, True)
    except expat.ExpatError as error:
        raise CaseError(
            f"is not XML: {expat.ErrorString(error.code)}",
            where=f"{path}: line {error.lineno}, column {error.offset + 1}",
            remedy="check that the file is complete",
        ) from None
    except (ValueError, LookupError) as error:  # an encoding that nobody knows
        raise CaseError(f"is not XML: {shortened(str(error), 100)}", where=str(path)) from None
    if builder.root is None:
        raise CaseError("has no element", where=str(path))
    return builder.root


class _Builder:
    """Puts the tree together while expat reads."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Element | None = None
        self._open: list[Element] = []
        self.parser: Any = expat.ParserCreate(namespace_separator=" ")
        self.parser.StartDoctypeDeclHandler = self._refuse
        self.parser.EntityDeclHandler = self._refuse
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text

    def _refuse(self, *_: Any) -> None:
        raise CaseError(
            "declares a document type or an entity, which are not read",
            where=f"{self.file}: line {self.parser.CurrentLineNumber}",
            remedy="remove <!DOCTYPE ...> and replace entities by their text",
        )

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        if len(self._open) >= DEEPEST:
            raise CaseError("is nested too deeply", where=f"{self.file}: line {line}")
        own = {_local(key): value for key, value in attributes.items()}
        element = Element(name=_local(name), attributes=own, line=line)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        if self._open:
            self._open[-1].texts.append(text)


def _local(name: str) -> str:
    """Return a name without its namespace, in small letters."""
    return name.rpartition(" ")[2].rpartition(":")[2].casefold()
