"""Common parts of the files of Shi's programs and of DDA for Windows, in clast's words.

Geometry.  A joint line of type N is a trace with the joint ``type-N``; a material line of material
N is a line of ``rock-N``, and blocks that no such line crosses are ``rock-1``.  Lines overshoot at
corners: the domain is the area that the boundary lines enclose or, where they alone enclose
nothing, the area that all lines enclose, without the ends that dangle.  Boundary lines inside of it
are traces like the others.  A hole point in a face of the boundary lines makes that face an
opening; any other stays a point, whose block is known only when blocks are cut.

A bolt has e0, t0 and f0: its force is e0 times its strain (Shi 1988), so that its spring between
the two ends has the stiffness e0 / length; t0 is the largest force (0: none), f0 the first one.

Node distance e00: nodes nearer than about 1.25 e00 w0 are one, w0 half the height of the domain.
clast has ``smallest_edge`` of [domain] for it, and keeps its own default: e00 stands as a comment.

Materials.  Mass of a volume is the density; its weight, downwards positive, over its mass is the
gravity; E and nu are Young's modulus and Poisson's ratio; s11, s22, s12 the initial stress, tension
positive.  Friction is in degrees.  Time step and number of steps make [time]; g2 w0 is
``max_displacement``; the analysis type, 0 static and 1 dynamic, is ``dynamic_ratio``.

Files are often written in t, kN and kPa.  ``mass_unit``, the kilograms in their unit of mass, is
all that is needed: metres and seconds stay, so forces, stresses and moduli have the same factor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from clast.errors import CaseError
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing import (
    Drawing,
    DrawnBoltKind,
    DrawnJoint,
    DrawnOutline,
    DrawnRock,
    LeftOut,
    Polyline,
    Segment,
    Spot,
)
from clast.rockmass.drawings.drawn_loops import cutting, lengthened, outline_of_lines, point


@dataclass(frozen=True, kw_only=True)
class NumberRow:
    """Numbers that stand together in a file."""

    values: tuple[float, ...]
    place: str

    def kind(self, position: int, what: str, file: str) -> int:
        """Return the number of a type or material, from 1, or raise CaseError."""
        value = self.values[position]
        if value != round(value) or not 1 <= value <= 10_000:
            what = f"{value:g} is not a valid {what} number"
            remedy = f"{what}s are numbered from 1"
            raise CaseError(what, where=f"{file}: {self.place}", remedy=remedy)
        return int(value)

    @property
    def ends(self) -> Floats:
        """Return the first four numbers as two points, shape (2, 2)."""
        return np.array(self.values[:4]).reshape(2, 2)

    @property
    def is_point(self) -> bool:
        """Return whether both ends are the same."""
        return self.values[:2] == self.values[2:4]

    def segment(self, name: str) -> Segment:
        """Return its ends as a line of that name."""
        return Segment(name=name, ends=self.ends, place=self.place)


@dataclass(frozen=True, kw_only=True)
class LegacyGeometry:
    """The lines and points of a file, as it has them."""

    file: str
    node_distance: float | None
    boundary: tuple[NumberRow, ...]
    """x1, y1, x2, y2 and a type where the file gives one."""
    joints: tuple[NumberRow, ...]
    """x1, y1, x2, y2, type; without the boundary lines."""
    material_lines: tuple[NumberRow, ...]
    bolts: tuple[NumberRow, ...]
    fixed: tuple[NumberRow, ...]
    """x1, y1, x2, y2."""
    load_points: tuple[NumberRow, ...]
    measured_points: tuple[NumberRow, ...]
    hole_points: tuple[NumberRow, ...]
    mass_unit: float = 1.0
    """Kilograms in the unit of mass of bolt strengths."""
    notes: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()


def legacy_drawing(given: LegacyGeometry) -> Drawing:
    """Return the drawing of a legacy geometry; CaseError where its lines enclose no area."""
    notes, left = list(given.notes), list(given.left_out)
    joints, short = _traces(given.joints, given.file)
    boundary, faces = _domain(given, [joint.points for joint in joints], notes)
    openings, holes = _openings(given.hole_points, faces)
    typed = [replace(one, values=(*one.values, 1.0)[:5]) for one in given.boundary]
    voids = [one.points for one in openings]
    inner, outer = cutting(_traces(typed, given.file)[0], boundary, voids)
    traces, outside = cutting(joints, boundary, voids)
    left += short
    for joint in outside:
        ends = f"from {point(joint.points[0])} to {point(joint.points[-1])}"
        reason = "no part of it lies inside of the domain"
        left.append(
            LeftOut(what=f"joint of {joint.joint} {ends}", place=joint.place, reason=reason)
        )
    if outer and len(given.boundary[0].values) > 4:
        listed = ", ".join(sorted({line.joint for line in outer}))
        what, reason = f"{listed} of {len(outer)} boundary lines", "nothing touches the outer edges"
        left.append(LeftOut(what=what, place=outer[0].place, reason=reason))
    kinds, bolts = _bolts(given, notes)
    return Drawing(
        file=given.file,
        boundary=boundary,
        boundary_rock="rock-1",
        traces=(*inner, *traces),
        openings=tuple(openings),
        bolts=tuple(bolts),
        bolt_kinds=tuple(kinds),
        fixed_points=_spots([one for one in given.fixed if one.is_point], "F"),
        fixed_lines=tuple(one.segment("") for one in given.fixed if not one.is_point),
        material_lines=tuple(
            one.segment(f"rock-{one.kind(4, 'material', given.file)}")
            for one in given.material_lines
        ),
        load_points=_spots(given.load_points, "L"),
        measured_points=_spots(given.measured_points, "M"),
        hole_points=_spots(holes, "H"),
        node_distance=given.node_distance,
        notes=tuple(notes),
        left_out=tuple(left),
    )


def _traces(joints: Sequence[NumberRow], file: str) -> tuple[list[Polyline], list[LeftOut]]:
    """Return joints of some length as traces, and the others."""
    traces, left = [], []
    for one in joints:
        joint = f"type-{one.kind(4, 'joint type', file)}"
        if one.is_point:
            what = f"joint of {joint} at {point(one.ends[0])}"
            left.append(LeftOut(what=what, place=one.place, reason="it has no length"))
        else:
            traces.append(Polyline(points=one.ends, joint=joint, place=one.place))
    return traces, left


def _domain(
    given: LegacyGeometry, traces: Sequence[Floats], notes: list[str]
) -> tuple[Floats, list[Floats]]:
    """Return the outline of the domain, and the faces of the boundary lines."""
    outer = [one.ends for one in given.boundary if not one.is_point]
    every = [*outer, *traces]
    height = float(np.ptp(np.vstack(every)[:, 1])) if every else 0.0
    reach = 1.25 * (given.node_distance or 0.0) * 0.5 * height
    alone = (
        f"the {len(outer)} boundary lines enclose nothing by themselves: the domain is the "
        "area that all lines together enclose"
    )
    for lines, further, changes in (
        (outer, 0.0, []),
        (outer, reach, [lengthened(reach)]),
        (every, 0.0, [alone]),
        (every, reach, [alone, lengthened(reach)]),
    ):
        outline = outline_of_lines(lines, further) if lines else None
        if outline is not None:
            notes += changes
            return outline[0], outline[1] if lines is outer else []
    raise CaseError(
        f"its {len(outer)} boundary lines and {len(traces)} joints enclose no area, or several "
        "that do not touch",
        where=given.file,
        remedy="let the boundary lines cross or meet at the corners of one domain",
    )


def _openings(
    holes: Sequence[NumberRow], faces: Sequence[Floats]
) -> tuple[list[DrawnOutline], list[NumberRow]]:
    """Return the faces with a hole point in them, and the hole points in none."""
    openings: dict[int, DrawnOutline] = {}
    left: list[NumberRow] = []
    for hole in holes:
        place = shapely.Point(hole.values[:2])
        face = next((k for k, f in enumerate(faces) if shapely.Polygon(f).contains(place)), None)
        if face is None:
            left.append(hole)
        elif face not in openings:
            name = f"opening-{len(openings) + 1}"
            openings[face] = DrawnOutline(name=name, points=faces[face], place=hole.place)
    return list(openings.values()), left


def _bolts(given: LegacyGeometry, notes: list[str]) -> tuple[list[DrawnBoltKind], list[Segment]]:
    kinds: dict[tuple[float, ...], DrawnBoltKind] = {}
    segments = []
    for one in given.bolts:
        length = float(np.hypot(*(one.ends[1] - one.ends[0])))
        e0, t0, f0 = (given.mass_unit * value for value in (*one.values[4:], 0.0, 0.0, 0.0)[:3])
        if length == 0.0 or e0 < 0.0 or t0 < 0.0:
            what = f"a bolt of length {length:g} m, e0 {e0:g}, t0 {t0:g}"
            remedy = "a bolt has two ends; its stiffness and strength are 0 or more"
            raise CaseError(what, where=f"{given.file}: {one.place}", remedy=remedy)
        key = (float(f"{e0 / length:.9g}"), t0, f0)
        kind = DrawnBoltKind(
            name=f"bolt-{len(kinds) + 1}",
            stiffness=key[0],
            yield_force=t0 if t0 > 0.0 else math.inf,
            pretension=f0,
        )
        kind = kinds.setdefault(key, kind)
        segments.append(one.segment(kind.name))
    if given.bolts:
        notes.append("stiffnesses of bolts are e0 / length, as e0 is force by strain (Shi 1988)")
    return list(kinds.values()), segments


def _spots(points: Sequence[NumberRow], letter: str) -> tuple[Spot, ...]:
    return tuple(
        Spot(name=f"{letter}{k}", at=np.array(one.values[:2]), place=one.place)
        for k, one in enumerate(points, 1)
    )


def legacy_rock(number: int, given: NumberRow, mass_unit: float) -> DrawnRock:
    """Return the rock of mass, weight, E, nu, three stresses; then velocities, if there are any."""
    mass, weight, young, poisson, *more = given.values
    s11, s22, s12, u, v, omega = (*more, *([0.0] * 6))[:6]
    k = mass_unit
    return DrawnRock(
        name=f"rock-{number}",
        density=mass * k,
        weight=weight * k,
        young=young * k,
        poisson=poisson,
        initial_stress=(s11 * k, s22 * k, s12 * k),
        velocity=(u, v, omega),
        place=given.place,
    )


def legacy_joint(number: int, given: NumberRow, mass_unit: float) -> DrawnJoint:
    """Return the joint of friction angle, cohesion and tensile strength."""
    friction, cohesion, tension = given.values
    return DrawnJoint(
        name=f"type-{number}",
        friction_angle=friction,
        cohesion=cohesion * mass_unit,
        tensile_strength=tension * mass_unit,
        place=given.place,
    )


def unit_notes(rocks: Sequence[DrawnRock], mass_unit: float) -> list[str]:
    """Return the unit of mass as a note, and whether it looks like another."""
    notes = []
    if mass_unit != 1.0:
        notes.append(f"the unit of mass is {mass_unit:g} kg, as given")
    # Such a density is not rock's in kg/m3, but looks like t/m3.
    light = [rock for rock in rocks if 0.0 < rock.density < 100.0]
    if light:
        notes.append(
            f"{light[0].name} has the density {light[0].density:g} kg/m3: a file in t, kN and kPa "
            "is read with mass_unit=1000"
        )
    return notes


def check_mass_unit(mass_unit: float) -> float:
    """Return a unit of mass in kg, or raise CaseError."""
    if not (isinstance(mass_unit, int | float) and 0.0 < mass_unit < math.inf):
        remedy = "give kg: 1, or 1000 for t and kN"
        raise CaseError(f"{mass_unit!r} is not a valid mass", where="mass_unit", remedy=remedy)
    return float(mass_unit)
