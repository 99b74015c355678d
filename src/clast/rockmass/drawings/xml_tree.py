"""Trees of XML files, with the line of each element for messages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from clast.errors import CaseError, mistyped, shortened
from clast.rockmass.drawings.drawing_files import checked_file, number_of
from clast.rockmass.drawings.legacy_words import NumberRow


@dataclass(frozen=True, kw_only=True)
class Element:
    """An element; names are local and in small letters."""

    file: str
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
        """Return its text without that of elements in it."""
        return " ".join("".join(self.texts).split())

    @property
    def written(self) -> str:
        """Return its text or, where it has none, its first attribute."""
        return self.text or next(iter(self.attributes.values()), "")

    def fault(self, what: str, remedy: str) -> CaseError:
        """Return the error of a fault in it."""
        return CaseError(what, where=f"{self.file}: {self.place}", remedy=remedy)

    def all(self, name: str) -> Iterator[Element]:
        """Yield the elements with that name below this one, in their order."""
        for child in self.children:
            if child.name == name:
                yield child
            yield from child.all(name)

    def first(self, name: str) -> Element | None:
        """Return the first element with that name below this one."""
        return next(self.all(name), None)

    def value(self, attribute: str) -> str:
        """Return an attribute or, where it is missing, the element's text."""
        return self.attributes.get(attribute, self.text).strip()

    def numbers(self, written: str) -> tuple[float, ...]:
        """Return numbers of it separated by spaces or commas; CaseError for other words."""
        values = []
        for word in written.replace(",", " ").split():
            value = number_of(word)
            if value is None:
                remedy = "write numbers such as 12.5, separated by spaces"
                raise self.fault(f"{mistyped(word)} is not a number", remedy)
            values.append(value)
        return tuple(values)

    def number(self, written: str, what: str = "it") -> float:
        """Return the one number that is written in it; CaseError where there are others."""
        values = self.numbers(written)
        if len(values) != 1:
            raise self.fault(
                f"has {len(values)} numbers instead of one", f"give {what} as one number"
            )
        return values[0]

    def row(self, names: tuple[str, ...]) -> NumberRow:
        """Return one number for each name of an element below it."""
        values = []
        for name in names:
            element = self.first(name)
            if element is None:
                have = ", ".join(child.name for child in self.children) or "nothing"
                raise self.fault(f"has no {name}", f"it has {have}")
            values.append(element.number(element.written))
        return NumberRow(values=tuple(values), place=self.place)


def tree_of(path: Path) -> Element:
    """Return the root element of an XML file.

    Document types are refused: they can make a small file grow without bound or read other files.
    """
    file, parser = str(path), expat.ParserCreate(namespace_separator=" ")
    above: list[Element] = [Element(file=file, name="", attributes={}, line=0)]
    document = above[0]

    def refuse(*_: Any) -> None:
        what = "declares a document type or an entity, which are not read"
        remedy = "remove <!DOCTYPE ...> and replace entities by their text"
        raise CaseError(what, where=f"{file}: line {parser.CurrentLineNumber}", remedy=remedy)

    def start(name: str, attributes: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        if len(above) > 100:
            raise CaseError("is nested too deeply", where=f"{file}: line {line}")
        local = {_local(key): value for key, value in attributes.items()}
        element = Element(file=file, name=_local(name), attributes=local, line=line)
        above[-1].children.append(element)
        above.append(element)

    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: above.pop()
    parser.CharacterDataHandler = lambda text: above[-1].texts.append(text)
    try:
        parser.Parse(checked_file(path).read_bytes(), True)
    except expat.ExpatError as error:
        raise CaseError(
            f"is not XML: {expat.ErrorString(error.code)}",
            where=f"{path}: line {error.lineno}, column {error.offset + 1}",
            remedy="check that the file is complete",
        ) from None
    except (ValueError, LookupError) as error:  # an encoding that nobody knows
        raise CaseError(f"is not XML: {shortened(str(error), 100)}", where=file) from None
    return document.children[0]


def _local(name: str) -> str:
    """Return a name without its namespace, in small letters."""
    return name.rpartition(" ")[2].rpartition(":")[2].casefold()
