"""XML files of DDA for Windows in: geometry, analysis, or both in one file.

The root is ``DDA``; names are matched without namespace and capitals.  A number may be an attribute
of the name given here, or the element's text.

| element | in a case of clast |
| --- | --- |
| Edgenodedist distance | e00: a comment of [domain] |
| Jointlist/Joint type: x1 y1 x2 y2 | [[trace]], joint "type-N" |
| Boundlist/Line: x1 y1 x2 y2 | [domain] boundary |
| Matlinelist/Line type: x1 y1 x2 y2 | a comment: the rock of the blocks it crosses |
| Fixedpointlist: Point x y, Line x1 y1 x2 y2 | [[fixed_point]]; a comment for a line |
| Loadpointlist, Measuredpointlist, Holepointlist: Point x y | as in shi_geometry |
| Boltlist/Bolt: x1 y1 x2 y2 [e0 t0 f0] | a comment: [[bolt]] |
| Analysistype type | [time] dynamic_ratio: 0 static, 1 dynamic |
| Rotation type | [method] rotation, where clast has it |
| Gravaccel value | gravity, downwards |
| Planestrain flag | plane |
| Numtimesteps timesteps, Maxtimestep maxtimestep | [time] end and step |
| Maxdisplacement maxdisplacement | g2: [time] max_displacement = g2 w0 |
| Saveinterval step | [output] every = steps between frames x step |
| Autopenalty pfactor | not taken over: clast picks the stiffness that suits its process |
| Blockmaterial: Unitmass, Unitweight, Youngsmod, Poissonratio, Istress | [rock.rock-N] |
| Blockmaterial: Ivelocity | a comment where it is not 0 |
| Blockmaterial: Damping, Istrain | not taken over; said where they are not 0 |
| Jointproperties: Friction, Cohesion, Tensile | [joint.type-N] |
| Boltproperties | not taken over |
| Loadpoint: t fx fy; ... | [[point_load]] of the load point of that number, where it is constant |

``legacy`` explains the meaning of each, and the purpose of ``mass_unit``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from xml.parsers import expat

from clast.errors import CaseError, mistyped, shortened
from clast.rockmass.drawings.drawing import Analysis, Drawing, DrawnRock, LeftOut, PointForce
from clast.rockmass.drawings.drawing_files import checked_file, number_of
from clast.rockmass.drawings.legacy_words import (
    LegacyGeometry,
    NumberRow,
    check_mass_unit,
    legacy_drawing,
    legacy_joint,
    legacy_rock,
    unit_notes,
)

GEOMETRY = {
    "joint": "jointlist",
    "line": "boundlist matlinelist fixedpointlist",
    "point": "fixedpointlist loadpointlist measuredpointlist holepointlist",
    "bolt": "boltlist",
}
"""Elements with coordinates -> the lists that they stand in."""
MATERIAL = ("unitmass", "unitweight", "youngsmod", "poissonratio")
STRENGTH = ("friction", "cohesion", "tensile")
SETTINGS = {
    "edgenodedist": "distance",
    "analysistype": "type",
    "rotation": "type",
    "gravaccel": "value",
    "planestrain": "flag",
    "numtimesteps": "timesteps",
    "maxtimestep": "maxtimestep",
    "maxdisplacement": "maxdisplacement",
    "saveinterval": "step",
}
"""Elements of one value, and their attribute."""
KNOWN = {*SETTINGS, *MATERIAL, *STRENGTH, "istress", "ivelocity", "istrain", "damping", "loadpoint"}
WORDS = {"static": 0.0, "dynamic": 1.0}
"""Analysis types by name."""
FLAGS = {"1": "strain", "true": "strain", "yes": "strain", "on": "strain"}
FLAGS |= {"0": "stress", "false": "stress", "no": "stress", "off": "stress"}


def read_dda_xml(path: str | Path, mass_unit: float = 1.0) -> Drawing:
    """Return the content of an XML file of DDA for Windows: geometry, analysis, or both.

    Lengths are metres; ``mass_unit`` is the kilograms in the unit of mass.  Raises CaseError with
    the line where it is no such file.
    """
    scale, file = check_mass_unit(mass_unit), str(path)
    root = xml_tree(Path(path))
    if root.name != "dda":
        raise CaseError(
            f"its root is {shortened(root.name)}, not DDA",
            where=f"{file}: line {root.line}",
            remedy="give the geometry or the analysis of DDA for Windows",
        )
    analysis = _analysis(root, file, scale)
    left = tuple(_unknown(root))
    if not any(True for name in ("jointlist", "boundlist") for _ in root.all(name)):
        if not analysis.rocks and analysis.step is None:
            raise CaseError(
                "has no lines and no materials", where=file, remedy="check that it is complete"
            )
        return Drawing(file=file, analysis=analysis, left_out=left)
    drawing = legacy_drawing(_geometry(root, file, scale))
    return replace(drawing, analysis=analysis, left_out=(*drawing.left_out, *left))


def _geometry(root: Element, file: str, scale: float) -> LegacyGeometry:
    """Return the lines and points of the file."""
    fixed = _rows(root, "fixedpointlist", ("point", "line"), file, (2, 4))
    return LegacyGeometry(
        file=file,
        node_distance=_one(root, "edgenodedist", file),
        boundary=_rows(root, "boundlist", ("line",), file, (4, 4)),
        joints=_typed(root, "jointlist", "joint", file),
        material_lines=_typed(root, "matlinelist", "line", file),
        bolts=_rows(root, "boltlist", ("bolt",), file, (4, 7)),
        fixed=tuple(
            NumberRow(values=(*one.values, *one.values)[:4], place=one.place) for one in fixed
        ),
        load_points=_rows(root, "loadpointlist", ("point",), file, (2, 2)),
        measured_points=_rows(root, "measuredpointlist", ("point",), file, (2, 2)),
        hole_points=_rows(root, "holepointlist", ("point",), file, (2, 2)),
        mass_unit=scale,
    )


def _rows(
    root: Element, group: str, names: tuple[str, ...], file: str, sizes: tuple[int, ...]
) -> tuple[NumberRow, ...]:
    """Return the coordinates of the elements of a list, each of one of the sizes."""
    elements = [one for found in root.all(group) for one in found.children if one.name in names]
    rows = tuple(NumberRow(values=_numbers(e.text, e, file), place=e.place) for e in elements)
    wrong = next((row for row in rows if len(row.values) not in sizes), None)
    if wrong is not None:
        due = " or ".join(str(size) for size in sorted(set(sizes)))
        raise CaseError(
            f"has {len(wrong.values)} numbers instead of {due}",
            where=f"{file}: {wrong.place}",
            remedy="give x y for a point, and x1 y1 x2 y2 for a line",
        )
    return rows


def _typed(root: Element, group: str, name: str, file: str) -> tuple[NumberRow, ...]:
    """Return lines with the number of their type or material behind their coordinates."""
    rows = _rows(root, group, (name,), file, (4, 4))
    elements = [one for found in root.all(group) for one in found.children if one.name == name]
    return tuple(
        NumberRow(
            values=(*row.values, _single(one.attributes.get("type", ""), one, file, "a type")),
            place=row.place,
        )
        for row, one in zip(rows, elements, strict=True)
    )


def _analysis(root: Element, file: str, scale: float) -> Analysis:
    """Return materials, loads and times of the file."""
    left: list[LeftOut] = []
    notes: list[str] = []
    materials = list(root.all("blockmaterial"))
    rocks = tuple(_rock(k, one, file, scale, left) for k, one in enumerate(materials, 1))
    strengths = list(root.all("jointproperties"))
    joints = tuple(
        legacy_joint(k, _values(one, STRENGTH, file), scale) for k, one in enumerate(strengths, 1)
    )
    gravity = _one(root, "gravaccel", file)
    if gravity is not None and gravity < 0.0:
        notes.append(f"Gravaccel {gravity:g} was taken as {-gravity:g} m/s2 downwards")
    steps = _one(root, "numtimesteps", file)
    frames = _one(root, "saveinterval", file)
    for what, value in (("Numtimesteps", steps), ("Saveinterval", frames)):
        if value is not None and not (value == round(value) and value > 0):
            remedy = "give a whole number, 1 or more"
            raise CaseError(f"{what} is {value:g}", where=file, remedy=remedy)
    step, ratio = _one(root, "maxtimestep", file), _one(root, "maxdisplacement", file)
    for what, value in (("Maxtimestep", step), ("Maxdisplacement", ratio)):
        if value is not None and value <= 0.0:
            raise CaseError(f"{what} is {value:g}", where=file, remedy="give a number above 0")
    return Analysis(
        rocks=rocks,
        joints=joints,
        dynamic_ratio=_type_of_analysis(root, file),
        steps=None if steps is None else int(steps),
        step=step,
        displacement_ratio=ratio,
        plane=_plane(root, file),
        gravity=None if gravity is None else abs(gravity),
        rotation=_rotation(root, left),
        frame_steps=None if frames is None else int(frames),
        forces=tuple(_forces(root, file, scale)),
        notes=(*notes, *unit_notes(rocks, scale)),
        left_out=tuple(left),
    )


def _rock(
    number: int, material: Element, file: str, scale: float, left: list[LeftOut]
) -> DrawnRock:
    """Return a rock, and leave out the rest."""
    given = _values(material, MATERIAL, file)
    parts = {name: _several(material, name, file) for name in ("istress", "ivelocity", "istrain")}
    for name in ("istrain", "damping"):
        for one in material.all(name):
            if any(_numbers(_written(one), one, file)):
                reason = "clast has no such property of a rock"
                what = f"{name} {_written(one)} of block material {number}"
                left.append(LeftOut(what=what, place=one.place, reason=reason))
    values = (*given.values, *parts["istress"], *parts["ivelocity"])
    return legacy_rock(number, NumberRow(values=values, place=given.place), scale)


def _several(material: Element, name: str, file: str) -> tuple[float, ...]:
    """Return the three numbers of an element, zeros where there is none."""
    found = next(material.all(name), None)
    if found is None:
        return (0.0, 0.0, 0.0)
    values = _numbers(_written(found), found, file)
    if len(values) != 3:
        remedy = "give the components 11 22 12, or u v omega"
        raise CaseError(
            f"has {len(values)} numbers instead of 3",
            where=f"{file}: {found.place}",
            remedy=remedy,
        )
    return values


def _values(parent: Element, names: tuple[str, ...], file: str) -> NumberRow:
    """Return one number for each name among the children of an element."""
    values = []
    for name in names:
        found = next(parent.all(name), None)
        if found is None:
            have = ", ".join(child.name for child in parent.children) or "nothing"
            raise CaseError(
                f"has no {name}", where=f"{file}: {parent.place}", remedy=f"it has {have}"
            )
        values.append(_single(_written(found), found, file))
    return NumberRow(values=tuple(values), place=parent.place)


def _type_of_analysis(root: Element, file: str) -> float | None:
    found = next(root.all("analysistype"), None)
    if found is None:
        return None
    word = found.value("type").casefold()
    value = WORDS.get(word, number_of(word))
    if value is None or not 0.0 <= value <= 1.0:
        remedy = "give static, dynamic, or 0 to 1"
        raise CaseError(
            f"'{shortened(word)}' is not a type of analysis",
            where=f"{file}: {found.place}",
            remedy=remedy,
        )
    return value


def _plane(root: Element, file: str) -> str | None:
    found = next(root.all("planestrain"), None)
    if found is None:
        return None
    word = found.value("flag").casefold()
    if word not in FLAGS:
        raise CaseError(
            f"'{shortened(word)}' is neither 1 nor 0",
            where=f"{file}: {found.place}",
            remedy="give 1 for plane strain, 0 for plane stress",
        )
    return FLAGS[word]


def _rotation(root: Element, left: list[LeftOut]) -> str | None:
    """Return the rotation where clast has it, and leave it out where not."""
    found = next(root.all("rotation"), None)
    word = "" if found is None else found.value("type").casefold()
    if found is None or word in ("linear", "exact"):
        return word or None
    what = f"Rotation {shortened(word)}"
    left.append(LeftOut(what=what, place=found.place, reason="clast keeps its own rotation"))
    return None


def _forces(root: Element, file: str, scale: float) -> Iterator[PointForce]:
    """Yield the forces at load points: t fx fy, parted by semicolons."""
    for number, element in enumerate(root.all("loadpoint"), 1):
        entries = [entry for entry in element.text.split(";") if entry.strip()]
        due = number_of(element.attributes.get("numpoints", str(len(entries))))
        if due != len(entries):
            raise CaseError(
                f"has {len(entries)} instants, but numpoints is "
                f"{shortened(element.attributes.get('numpoints', ''))}",
                where=f"{file}: {element.place}",
                remedy="separate instants by semicolons: t fx fy; t fx fy",
            )
        for entry in entries:
            values = _numbers(entry, element, file)
            if len(values) != 3:
                raise CaseError(
                    f"'{shortened(entry.strip())}' is not t fx fy",
                    where=f"{file}: {element.place}",
                    remedy="separate instants by semicolons: t fx fy; t fx fy",
                )
            force = (values[1] * scale, values[2] * scale)
            yield PointForce(point=number, time=values[0], force=force, place=element.place)


def _one(root: Element, name: str, file: str) -> float | None:
    """Return the number of an element of the file, None where there is no such element."""
    found = next(root.all(name), None)
    return None if found is None else _single(found.value(SETTINGS[name]), found, file)


def _single(written: str, element: Element, file: str, what: str = "it") -> float:
    """Return the one number that is written, or say how many there are."""
    values = _numbers(written, element, file)
    if len(values) != 1:
        raise CaseError(
            f"has {len(values)} numbers instead of one",
            where=f"{file}: {element.place}",
            remedy=f"give {what} as one number",
        )
    return values[0]


def _written(element: Element) -> str:
    """Return the text of an element or, where it has none, its first attribute."""
    return element.text or next(iter(element.attributes.values()), "")


def _numbers(written: str, element: Element, file: str) -> tuple[float, ...]:
    """Return numbers separated by spaces or commas, or say which is none."""
    values = []
    for word in written.replace(",", " ").split():
        value = number_of(word)
        if value is None:
            raise CaseError(
                f"{mistyped(word)} is not a number",
                where=f"{file}: {element.place}",
                remedy="write numbers such as 12.5, separated by spaces",
            )
        values.append(value)
    return tuple(values)


def _unknown(root: Element) -> Iterator[LeftOut]:
    """Yield the elements that say something which is not read."""
    for child in root.children:
        if child.children:
            yield from _unknown(child)
        is_known = child.name in KNOWN or root.name in GEOMETRY.get(child.name, "").split()
        says = " ".join([*(f"{k}={v}" for k, v in child.attributes.items()), child.text]).strip()
        if not is_known and says and not (child.children and not child.text):
            reason = REASONS.get(child.name, "the element is not read")
            what = f"{child.name} {shortened(says, 100)}"
            yield LeftOut(what=what, place=child.place, reason=reason)


REASONS = {
    "autopenalty": "clast picks the contact stiffness that suits its process",
    "boltproperties": "give [bolt_kind.NAME] stiffness and yield_force by hand",
}
"""Why elements that are known are not taken over."""


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
