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
from dataclasses import replace
from pathlib import Path

from clast.errors import CaseError, shortened
from clast.rockmass.drawings.drawing import Analysis, Drawing, DrawnRock, LeftOut, PointForce
from clast.rockmass.drawings.drawing_files import number_of
from clast.rockmass.drawings.legacy_words import (
    LegacyGeometry,
    NumberRow,
    check_mass_unit,
    legacy_drawing,
    legacy_joint,
    legacy_rock,
    unit_notes,
)
from clast.rockmass.drawings.xml_tree import Element, tree_of

LISTED = {
    "jointlist": ("joint",),
    "boundlist": ("line",),
    "matlinelist": ("line",),
    "boltlist": ("bolt",),
    "fixedpointlist": ("point", "line"),
    "loadpointlist": ("point",),
    "measuredpointlist": ("point",),
    "holepointlist": ("point",),
}
"""Lists -> the elements with coordinates in them."""
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
PLANES = {
    **dict.fromkeys(("1", "true", "yes", "on"), "strain"),
    **dict.fromkeys(("0", "false", "no", "off"), "stress"),
}
REASONS = {
    "autopenalty": "clast picks the contact stiffness that suits its process",
    "boltproperties": "give [bolt_kind.NAME] stiffness and yield_force by hand",
}
"""Why elements that are known are not taken over."""


def read_dda_xml(path: str | Path, mass_unit: float = 1.0) -> Drawing:
    """Return the content of an XML file of DDA for Windows: geometry, analysis, or both.

    Lengths are metres; ``mass_unit`` is the kilograms in the unit of mass.  Raises CaseError with
    the line where it is no such file.
    """
    scale, file = check_mass_unit(mass_unit), str(path)
    root = tree_of(Path(path))
    if root.name != "dda":
        what = f"its root is {shortened(root.name)}, not DDA"
        remedy = "give the geometry or the analysis of DDA for Windows"
        raise CaseError(what, where=f"{file}: line {root.line}", remedy=remedy)
    analysis = _analysis(root, scale)
    left = tuple(_unknown(root))
    if not any(True for name in ("jointlist", "boundlist") for _ in root.all(name)):
        if not analysis.rocks and analysis.step is None:
            raise CaseError(
                "has no lines and no materials", where=file, remedy="check that it is complete"
            )
        return Drawing(file=file, analysis=analysis, left_out=left)
    drawing = legacy_drawing(_geometry(root, scale))
    return replace(drawing, analysis=analysis, left_out=(*drawing.left_out, *left))


def _geometry(root: Element, scale: float) -> LegacyGeometry:

    def rows(group: str, sizes: tuple[int, ...], typed: str = "") -> tuple[NumberRow, ...]:
        """Return the coordinates of the elements of a list, each of one of the sizes.

        The number of the type of those called ``typed`` follows their coordinates.
        """
        names = (typed,) if typed else LISTED[group]
        elements = [one for part in root.all(group) for one in part.children if one.name in names]
        values = [one.numbers(one.text) for one in elements]
        for one, numbers in zip(elements, values, strict=True):
            if len(numbers) not in sizes:
                what = f"has {len(numbers)} numbers instead of {' or '.join(map(str, sizes))}"
                raise one.fault(what, "give x y for a point, and x1 y1 x2 y2 for a line")
        if typed:
            kinds = [one.number(one.attributes.get("type", ""), "a type") for one in elements]
            values = [(*row, kind) for row, kind in zip(values, kinds, strict=True)]
        return tuple(
            NumberRow(values=row, place=one.place)
            for row, one in zip(values, elements, strict=True)
        )

    return LegacyGeometry(
        file=root.file,
        node_distance=_setting(root, "edgenodedist"),
        boundary=rows("boundlist", (4,)),
        joints=rows("jointlist", (4,), "joint"),
        material_lines=rows("matlinelist", (4,), "line"),
        bolts=rows("boltlist", (4, 7)),
        fixed=tuple(
            NumberRow(values=(*one.values, *one.values)[:4], place=one.place)
            for one in rows("fixedpointlist", (2, 4))
        ),
        load_points=rows("loadpointlist", (2,)),
        measured_points=rows("measuredpointlist", (2,)),
        hole_points=rows("holepointlist", (2,)),
        mass_unit=scale,
    )


def _analysis(root: Element, scale: float) -> Analysis:
    left: list[LeftOut] = []
    notes: list[str] = []
    rocks = tuple(_rock(k, one, scale, left) for k, one in enumerate(root.all("blockmaterial"), 1))
    joints = tuple(
        legacy_joint(k, one.row(STRENGTH), scale)
        for k, one in enumerate(root.all("jointproperties"), 1)
    )
    gravity = _setting(root, "gravaccel")
    if gravity is not None and gravity < 0.0:
        notes.append(f"Gravaccel {gravity:g} was taken as {-gravity:g} m/s2 downwards")
    steps, frames = _setting(root, "numtimesteps"), _setting(root, "saveinterval")
    for what, value in (("Numtimesteps", steps), ("Saveinterval", frames)):
        if value is not None and not (value == round(value) and value > 0):
            remedy = "give a whole number, 1 or more"
            raise CaseError(f"{what} is {value:g}", where=root.file, remedy=remedy)
    step, ratio = _setting(root, "maxtimestep"), _setting(root, "maxdisplacement")
    for what, value in (("Maxtimestep", step), ("Maxdisplacement", ratio)):
        if value is not None and value <= 0.0:
            raise CaseError(f"{what} is {value:g}", where=root.file, remedy="give a number above 0")
    return Analysis(
        rocks=rocks,
        joints=joints,
        dynamic_ratio=_type_of_analysis(root),
        steps=None if steps is None else int(steps),
        step=step,
        displacement_ratio=ratio,
        plane=_plane(root),
        gravity=None if gravity is None else abs(gravity),
        rotation=_rotation(root, left),
        frame_steps=None if frames is None else int(frames),
        forces=tuple(_forces(root, scale)),
        notes=(*notes, *unit_notes(rocks, scale)),
        left_out=tuple(left),
    )


def _rock(number: int, material: Element, scale: float, left: list[LeftOut]) -> DrawnRock:
    """Return a rock; numbers that clast has no use for are ``left`` out."""
    given = material.row(MATERIAL)
    parts = {}
    for name in ("istress", "ivelocity", "istrain"):
        element = material.first(name)
        parts[name] = (0.0, 0.0, 0.0) if element is None else element.numbers(element.written)
        if element is not None and len(parts[name]) != 3:
            remedy = "give the components 11 22 12, or u v omega"
            raise element.fault(f"has {len(parts[name])} numbers instead of 3", remedy)
    for name in ("istrain", "damping"):
        for one in material.all(name):
            if any(one.numbers(one.written)):
                reason = "clast has no such property of a rock"
                what = f"{name} {one.written} of block material {number}"
                left.append(LeftOut(what=what, place=one.place, reason=reason))
    values = (*given.values, *parts["istress"], *parts["ivelocity"])
    return legacy_rock(number, NumberRow(values=values, place=given.place), scale)


def _type_of_analysis(root: Element) -> float | None:
    element = root.first("analysistype")
    if element is None:
        return None
    word = element.value("type").casefold()
    value = {"static": 0.0, "dynamic": 1.0}.get(word, number_of(word))
    if value is None or not 0.0 <= value <= 1.0:
        what = f"'{shortened(word)}' is not a type of analysis"
        raise element.fault(what, "give static, dynamic, or 0 to 1")
    return value


def _plane(root: Element) -> str | None:
    element = root.first("planestrain")
    if element is None:
        return None
    word = element.value("flag").casefold()
    if word not in PLANES:
        what = f"'{shortened(word)}' is neither 1 nor 0"
        raise element.fault(what, "give 1 for plane strain, 0 for plane stress")
    return PLANES[word]


def _rotation(root: Element, left: list[LeftOut]) -> str | None:
    """Return the rotation where clast has it, else leave it out."""
    element = root.first("rotation")
    word = "" if element is None else element.value("type").casefold()
    if element is None or word in ("linear", "exact"):
        return word or None
    what = f"Rotation {shortened(word)}"
    left.append(LeftOut(what=what, place=element.place, reason="clast keeps its own rotation"))
    return None


def _forces(root: Element, scale: float) -> Iterator[PointForce]:
    """Yield the forces at load points: t fx fy, separated by semicolons."""
    remedy = "separate instants by semicolons: t fx fy; t fx fy"
    for number, element in enumerate(root.all("loadpoint"), 1):
        entries = [entry for entry in element.text.split(";") if entry.strip()]
        announced = element.attributes.get("numpoints", str(len(entries)))
        if number_of(announced) != len(entries):
            what = f"has {len(entries)} instants, but numpoints is {shortened(announced)}"
            raise element.fault(what, remedy)
        for entry in entries:
            values = element.numbers(entry)
            if len(values) != 3:
                raise element.fault(f"'{shortened(entry.strip())}' is not t fx fy", remedy)
            force = (values[1] * scale, values[2] * scale)
            yield PointForce(point=number, time=values[0], force=force, place=element.place)


def _unknown(root: Element) -> Iterator[LeftOut]:
    """Yield the elements with a content that is not read."""
    for child in root.children:
        if child.children:
            yield from _unknown(child)
        is_known = child.name in KNOWN or child.name in LISTED.get(root.name, ())
        content = " ".join([*(f"{k}={v}" for k, v in child.attributes.items()), child.text]).strip()
        if not is_known and content and not (child.children and not child.text):
            reason = REASONS.get(child.name, "the element is not read")
            what = f"{child.name} {shortened(content, 100)}"
            yield LeftOut(what=what, place=child.place, reason=reason)


def _setting(root: Element, name: str) -> float | None:
    """Return the number of an element below the root, None where there is no such element."""
    element = root.first(name)
    return None if element is None else element.number(element.value(SETTINGS[name]))
