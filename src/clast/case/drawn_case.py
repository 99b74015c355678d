"""The case file of a drawing: its content as tables, and the rest as comments with the reason.

A drawing has no moduli and no strengths.  Unknown values stand in the text as "to be given", so
that the case is refused, key by key, until a number is there: nothing is made up.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import ModelError
from clast.inputs.declaring.text import to_toml
from clast.inputs.placing.place_rock_mass import CutCase, RockMass
from clast.inputs.rock_mass import DomainTable, OpeningTable, RegionTable, TraceTable
from clast.model.arrays import Floats, following
from clast.model.checks import BlockOutlines, check_polygons
from clast.model.surroundings import Repair
from clast.rockmass import CONSTRUCTION, WELDED, repaired
from clast.rockmass.drawings.block_arrays import Blocks
from clast.rockmass.drawings.drawing import (
    DEFAULT_JOINT,
    Analysis,
    Drawing,
    DrawnRock,
    LeftOut,
    PointForce,
    Polyline,
    Segment,
)
from clast.rockmass.repair import repairs_of

TO_BE_GIVEN = "to be given"
"""Value of a key that a drawing does not know."""


def comment(text: str, indent: str = "") -> list[str]:
    """Return a text as lines of comments, broken between words."""
    words = spelling.visible(" ".join(text.split())).split(" ")
    lines, line = [], f"# {indent}{words[0]}"
    for word in words[1:]:
        # Most characters of a line of a comment, where words allow
        if len(line) + 1 + len(word) > 98:
            lines.append(line)
            line = f"# {' ' * len(indent)}{word}"
        else:
            line += f" {word}"
    return [*lines, line]


def listed(title: str, items: Iterable[str]) -> list[str]:
    """Return a title and items as comments; nothing where there are no items."""
    lines = [line for item in items for line in comment(item, "- ")]
    return ["#", f"# {title}", *lines] if lines else []


HELD = "each block that it crosses is held at one point: add [[fixed_point]] after cutting"
ROCK = "every block that it crosses has its rock: draw a [[region]] around them"
HOLE = "the block around this point is removed: draw an [[opening]] around it"


def case_text(drawing: Drawing) -> str:
    """Return the text of a case file (TOML) with the content of a drawing, in SI units.

    Changes to the drawing and omissions stand in comments.  Keys that a drawing cannot know have
    the value "to be given".
    """
    # The single values at the top of the file.
    gravity = _gravity(drawing.analysis)
    top: dict[str, Any] = {"schema": 1, "title": spelling.visible(Path(drawing.file).stem[:200])}
    if drawing.analysis.plane is not None:
        top["plane"] = drawing.analysis.plane
    if gravity is not None:
        top["gravity"] = [0.0, -gravity]
    parts = [
        _head(drawing),
        to_toml(top),
        *_settings(drawing),
        to_toml({"rock": _rocks(drawing)}),
        to_toml({"joint": joints}) if (joints := _joints(drawing)) else "",
        _domain(drawing),
        *_tables(drawing),
        *_points(drawing),
        _bolts(drawing),
    ]
    return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"


def cut_of(drawing: Drawing) -> CutCase:
    """Return the blocks of a drawing, which needs no moduli and no strengths for them."""
    tables = "".join([_domain(drawing), *_tables(drawing)])
    content = tomllib.loads(tables)
    if "domain" not in content:
        what = "has no outline of the domain, and so no blocks"
        remedy = "draw it, or write [domain] and [[joint_set]] into the case"
        raise ModelError(what, where=drawing.file, remedy=remedy)
    lists: dict[str, Any] = {
        "joint_sets": [],
        "traces": [TraceTable(**one) for one in content.get("trace", [])],
        "openings": [OpeningTable(**one) for one in content.get("opening", [])],
        "regions": [RegionTable(**one) for one in content.get("region", [])],
        "patterns": [],
    }
    return RockMass(
        domain=DomainTable(**content["domain"]),
        rocks=list(_rocks(drawing)),
        joints=_named_joints(drawing),
        **lists,
    ).cut(Path(drawing.file).parent)


def _head(drawing: Drawing) -> str:
    """Return the source of the case, the changes to it and the omissions."""
    analysis = drawing.analysis
    lines = [*comment(f"From {drawing.file}; {drawing.unit_source}. Lengths are metres.")]
    unknown = [TO_BE_GIVEN] if TO_BE_GIVEN in str((_rocks(drawing), _joints(drawing))) else []
    unknown += [TO_BE_GIVEN] if analysis.step is None else []
    if unknown:
        lines += comment(f'Keys with "{TO_BE_GIVEN}" need a number before the case can run.')
    lines += listed("Taken otherwise than given:", notes_of(drawing))
    left = left_out_of(drawing)
    return "\n".join([*lines, *listed("Not taken over:", [str(one) for one in left])])


def notes_of(drawing: Drawing) -> list[str]:
    """Return the notes on values that were changed."""
    return [*drawing.notes, *drawing.analysis.notes]


def left_out_of(drawing: Drawing) -> list[LeftOut]:
    """Return the omissions: values that no drawing has, and parts that no case file has."""
    return [*drawing.left_out, *drawing.analysis.left_out, *_unsaid(drawing)]


def _unsaid(drawing: Drawing) -> Iterator[LeftOut]:
    """Yield the parts of a drawing for which a case file has no table."""
    for line in drawing.fixed_lines:
        yield LeftOut(what=f"fixed line {_ends(line)}", place=line.place, reason=HELD)
    for line in drawing.material_lines:
        what = f"line of {line.name} {_ends(line)}"
        yield LeftOut(what=what, place=line.place, reason=ROCK)
    for spot in drawing.hole_points:
        yield LeftOut(what=f"hole point {_at(spot.at)}", place=spot.place, reason=HOLE)
    for joint in drawing.analysis.joints:
        if joint.name not in _named_joints(drawing):
            values = (joint.friction_angle, joint.cohesion, joint.tensile_strength)
            what = f"joint {joint.name}, {' '.join(f'{value:g}' for value in values)}"
            yield LeftOut(what=what, place=joint.place, reason="no trace has it")
    yield from _unsaid_loads(drawing)
    yield from _unsaid_of_rocks(drawing.analysis)
    if drawing.orientations is not None:
        what = f"{len(drawing.orientations.dip)} orientations in space"
        reason = "they are not lines: describe them by [[joint_set]] with dip and dip_direction"
        yield LeftOut(what=what, place=drawing.file, reason=reason)


def _unsaid_loads(drawing: Drawing) -> Iterator[LeftOut]:
    """Yield load points without a constant force, and forces without a load point."""
    for number, spot in enumerate(drawing.load_points, 1):
        forces = _forces(drawing.analysis, number)
        what, reason = f"load point {_at(spot.at)}", ""
        if not forces:
            reason = "no force is given: write [[point_load]] with at and force"
        elif len({force.force for force in forces}) > 1:
            values = "; ".join(f"{f.time:g} {f.force[0]:g} {f.force[1]:g}" for f in forces)
            reason = "it changes with time: write [[point_load]] with an [amplitude.NAME]"
            what = f"{what}, t fx fy {values}"
        if reason:
            yield LeftOut(what=what, place=spot.place, reason=reason)
    for force in drawing.analysis.forces:
        if force.point > len(drawing.load_points):
            what = f"force ({force.force[0]:g}, {force.force[1]:g}) N at {force.time:g} s"
            reason = f"there is no load point {force.point}"
            yield LeftOut(what=what, place=force.place, reason=reason)


def _unsaid_of_rocks(analysis: Analysis) -> Iterator[LeftOut]:
    """Yield velocities, and weights that are not those of the one gravity of a case."""
    gravity = _gravity(analysis)
    for rock in analysis.rocks:
        if any(rock.velocity):
            what = f"velocity {rock.velocity} of {rock.name}"
            reason = "velocities belong to blocks, which do not exist before cutting"
            yield LeftOut(what=what, place=rock.place, reason=reason)
        due = rock.density * (gravity if gravity is not None else 0.0)
        if gravity is not None and abs(rock.weight - due) > 1e-6 * max(abs(due), 1.0):
            what = f"weight {rock.weight:g} N/m3 of {rock.name}"
            reason = f"a case has one gravity, {gravity:g} m/s2, which makes it {due:g} N/m3"
            yield LeftOut(what=what, place=rock.place, reason=reason)
    if analysis.rotation == "linear":
        reason = "it makes blocks grow as they turn: add [method] rotation if you want it"
        yield LeftOut(what="linear rotation", place="Rotation", reason=reason)


def _gravity(analysis: Analysis) -> float | None:
    """Return gravity, m/s2 downwards: as given, or weight over density of the first rock."""
    if analysis.gravity is not None:
        return analysis.gravity
    first = next((rock for rock in analysis.rocks if rock.density > 0.0), None)
    return None if first is None else _short(first.weight / first.density)


def _settings(drawing: Drawing) -> Iterator[str]:
    """Yield [time], and [method] and [output] where the file says something of them."""
    given, half = drawing.analysis, drawing.half_height
    time: dict[str, Any] = {"step": TO_BE_GIVEN, "end": TO_BE_GIVEN}
    if given.step is not None:
        time["step"] = given.step
        if given.steps is not None:
            time["end"] = _short(given.steps * given.step)
    if given.dynamic_ratio is not None:
        time["dynamic_ratio"] = given.dynamic_ratio
    if given.displacement_ratio is not None and half is not None:
        time["max_displacement"] = _short(given.displacement_ratio * half)
    yield to_toml({"time": time})
    if given.rotation == "exact":
        yield to_toml({"method": {"rotation": given.rotation}})
    if given.frame_steps is not None and given.step is not None:
        yield to_toml({"output": {"every": _short(given.frame_steps * given.step)}})


def _rocks(drawing: Drawing) -> dict[str, Any]:
    """Return [rock.NAME] for every rock that the file describes or names."""
    described = {rock.name: _rock(rock) for rock in drawing.analysis.rocks}
    named = [
        *(region.name for region in drawing.regions),
        *(s.name for s in drawing.material_lines),
    ]
    unknown = dict.fromkeys(("young", "poisson", "density"), TO_BE_GIVEN)
    return {
        name: described.get(name, unknown)
        for name in dict.fromkeys([drawing.boundary_rock, *named, *described])
    }


def _rock(rock: DrawnRock) -> dict[str, Any]:
    table: dict[str, Any] = {
        "young": rock.young,
        "poisson": rock.poisson,
        "density": _short(rock.density),
    }
    if any(rock.initial_stress):
        table["initial_stress"] = list(rock.initial_stress)
    return table


def _joints(drawing: Drawing) -> dict[str, Any]:
    """Return [joint.NAME] for every joint that a trace has, and the default that faces need."""
    described = {
        joint.name: {
            "friction_angle": joint.friction_angle,
            "cohesion": joint.cohesion,
            "tensile_strength": joint.tensile_strength,
        }
        for joint in drawing.analysis.joints
    }
    unknown = {"friction_angle": TO_BE_GIVEN}
    default = [] if described else [DEFAULT_JOINT]
    names = dict.fromkeys([*default, *_named_joints(drawing)])
    return {name: described.get(name, unknown) for name in names}


def _named_joints(drawing: Drawing) -> list[str]:
    """Return the joints of the traces, sorted: a case refuses joints that no contact has."""
    return sorted({trace.joint for trace in drawing.traces})


def _domain(drawing: Drawing) -> str:
    """Return [domain], with the node distance of a legacy file as a comment."""
    if drawing.boundary is None:
        text = "The file has no outline of the domain: [domain] needs a boundary."
        return "\n".join(comment(text))
    text = to_toml({"domain": {"boundary": _list(drawing.boundary), "rock": drawing.boundary_rock}})
    half = drawing.half_height
    if drawing.node_distance is None or half is None:
        return text
    edge = 1.25 * drawing.node_distance * half
    about = f"# smallest_edge = {edge:.6g}  # m: 1.25 e00 w0, with e00 = {drawing.node_distance:g}"
    return f"{text}{about}\n"


def _tables(drawing: Drawing) -> Iterator[str]:
    """Yield [[region]], [[opening]] and [[trace]]."""
    yield _list_of(
        "region",
        (
            {"name": f"{one.name} {k}", "polygon": _list(one.points), "rock": one.name}
            for k, one in enumerate(drawing.regions, 1)
        ),
    )
    openings = _list_of(
        "opening",
        (
            {"name": o.name, "shape": "polygon", "points": _list(o.points), "excavated": True}
            for o in drawing.openings
        ),
    )
    if openings:
        yield "# excavated = false: rock until a stage excavates it\n" + openings.strip("\n")
    yield _list_of("trace", map(_trace, drawing.traces))


def _trace(one: Polyline) -> dict[str, Any]:
    table = {"points": _list(one.points), "joint": one.joint}
    return {**table, "set": one.joint_set} if one.joint_set else table


def _points(drawing: Drawing) -> Iterator[str]:
    """Yield [[fixed_point]], [[measured_point]] and [[point_load]]."""
    yield _list_of("fixed_point", ({"at": _pair(spot.at)} for spot in drawing.fixed_points))
    yield _list_of(
        "measured_point",
        ({"name": spot.name, "at": _pair(spot.at)} for spot in drawing.measured_points),
    )
    yield _list_of("point_load", _loads(drawing))


def _loads(drawing: Drawing) -> Iterator[dict[str, Any]]:
    """Yield the load points with a constant force."""
    for number, spot in enumerate(drawing.load_points, 1):
        forces = _forces(drawing.analysis, number)
        if len({force.force for force in forces}) == 1:
            yield {"at": _pair(spot.at), "force": [_short(value) for value in forces[0].force]}


def _forces(analysis: Analysis, point: int) -> list[PointForce]:
    return [force for force in analysis.forces if force.point == point]


def _bolts(drawing: Drawing) -> str:
    """Return bolts and their kinds as tables behind comment signs."""
    if not drawing.bolts:
        return ""
    known = {kind.name: kind for kind in drawing.bolt_kinds}
    kinds: dict[str, Any] = {}
    for name in dict.fromkeys(bolt.name for bolt in drawing.bolts):
        kind = known.get(name)
        table: dict[str, Any] = {"stiffness": kind.stiffness if kind else TO_BE_GIVEN}
        if kind and math.isfinite(kind.yield_force):
            table["yield_force"] = kind.yield_force
        if kind and kind.pretension:
            table["pretension"] = kind.pretension
        kinds[name] = table
    bolts = [
        {"kind": bolt.name, "start": _pair(bolt.ends[0]), "end": _pair(bolt.ends[1])}
        for bolt in drawing.bolts
    ]
    tables = to_toml({"bolt_kind": kinds, "bolt": bolts}).strip("\n").split("\n")
    title = comment("Bolts, which a case file does not hold yet:")
    return "\n".join([*title, *(f"# {line}".rstrip() for line in tables)])


def _list_of(name: str, tables: Iterable[Mapping[str, Any]]) -> str:
    """Return a list of tables, nothing where there are none."""
    content = [dict(table) for table in tables]
    return to_toml({name: content}) if content else ""


def _short(value: float) -> float:
    """Return a number without the last digit, which a change of units has left."""
    return float(f"{value:.15g}")


def _pair(at: Floats) -> list[float]:
    return [_short(float(at[0])), _short(float(at[1]))]


def _list(points: Floats) -> list[list[float]]:
    return [_pair(point) for point in points]


def _at(at: Floats) -> str:
    return f"({at[0]:.6g}, {at[1]:.6g})"


def _ends(line: Segment) -> str:
    return f"{_at(line.ends[0])} to {_at(line.ends[1])}"


TOLERANCE_MAX = 1.5e-3
"""Largest such tolerance, m: corners rounded to millimetres lie sqrt(2) of them apart at most."""


@dataclass(frozen=True, kw_only=True)
class DrawnBlocks:
    """Blocks of a file that touch where they are meant to."""

    file: str
    """The file."""
    blocks: Blocks
    """The blocks, counter-clockwise, with notes and omissions."""
    tolerance: float
    """Distance within which they were put together, m."""
    repairs: tuple[Repair, ...]
    """The repairs, each with its first places."""
    largest_movement: float
    """How far a vertex moved at most, m."""

    def as_dict(self) -> dict[str, Any]:
        """Return the imported parts and all changes, for JSON."""
        rocks = self.blocks.rock
        return {
            "file": self.file,
            "blocks": self.blocks.count,
            "rocks": {name: rocks.count(name) for name in dict.fromkeys(rocks)},
            "joints": joints_of(self.blocks),
            "names": list(self.blocks.name),
            "tolerance": self.tolerance,
            "largest_movement": self.largest_movement,
            "repairs": [dataclasses.asdict(one) for one in self.repairs],
            "notes": list(self.blocks.notes),
            "left_out": [str(one) for one in self.blocks.left_out],
        }


def put_together(blocks: Blocks, file: str | Path, tolerance: float | None = None) -> DrawnBlocks:
    """Return the blocks of a file put together within a tolerance, m.

    It is a hundredth of the median edge if absent, TOLERANCE_MAX at most.  Raises ModelError for
    blocks that are no polygons, and where putting them together would spoil one.
    """
    start = blocks.block_start
    edges = np.hypot(*(blocks.vertices[following(start)] - blocks.vertices).T)
    if tolerance is None:
        # Tolerance as a share of the median edge where none is given
        tolerance = min(1e-2 * float(np.median(edges)), TOLERANCE_MAX)
    try:
        whole = repaired(blocks.vertices, start, tolerance)
        names = tuple(map(str, range(1, blocks.count + 1)))
        origin = np.floor(whole.vertices.min(axis=0))
        outlines = BlockOutlines(names, whole.start, whole.vertices - origin, origin)
        check_polygons(outlines, outlines.polygons())
    except ModelError as error:
        where = f"{file}: {error.where}".replace("repair, tolerance", "--tolerance")
        raise ModelError(error.what, where=where, remedy=error.remedy) from None
    joints = tuple(blocks.edge_joint[k] for k in whole.edge.tolist())
    return DrawnBlocks(
        file=str(file),
        blocks=dataclasses.replace(
            blocks, vertices=whole.vertices, block_start=whole.start, edge_joint=joints
        ),
        tolerance=tolerance,
        repairs=repairs_of(whole.report),
        largest_movement=whole.report.largest_movement,
    )


def joints_of(blocks: Blocks) -> list[str]:
    """Return the names of the joints of edges, sorted, without welds."""
    names = {name for name in blocks.edge_joint if name and name != WELDED}
    return sorted(name for name in names if not name.startswith(CONSTRUCTION))


def blocks_text(drawn: DrawnBlocks, block_file: str, fixed: Sequence[int] = ()) -> str:
    """Return the text of a case file (TOML) whose blocks stand in another file beside it.

    ``fixed`` are numbers of blocks, from 1.
    """
    unknown = dict.fromkeys(("young", "poisson", "density"), TO_BE_GIVEN)
    named = dict.fromkeys((DEFAULT_JOINT, *joints_of(drawn.blocks)))
    joints = {name: {"friction_angle": TO_BE_GIVEN} for name in named}
    held = {"fixed": list(fixed)} if fixed else {}
    head = [
        *comment(f"From {drawn.file}. Lengths are metres."),
        *comment(f'Keys with "{TO_BE_GIVEN}" need a number before the case can run.'),
        *listed(f"Put together within {drawn.tolerance:g} m:", map(str, drawn.repairs)),
        *listed("Taken otherwise than given:", drawn.blocks.notes),
        *listed("Not taken over:", map(str, drawn.blocks.left_out)),
    ]
    title = spelling.visible(Path(drawn.file).stem[:200])
    parts = [
        "\n".join(head),
        to_toml({"schema": 1, "title": title}),
        to_toml({"time": {"step": TO_BE_GIVEN, "end": TO_BE_GIVEN}}),
        to_toml({"rock": {name: unknown for name in dict.fromkeys(drawn.blocks.rock)}}),
        to_toml({"joint": joints}),
        to_toml({"block_file": [{"file": block_file, **held}]}),
    ]
    return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"
