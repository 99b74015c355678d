"""From blocks, rocks, joints, supports and loads in a script (or a case file) to a Model.

    from clast import ModelBuilder

    builder = ModelBuilder(title="Block on an incline")
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=20.0)
    builder.block(name="incline", vertices=[(0, 0), (10, 0), (0, 10)])
    builder.block(name="slider", vertices=[(1, 9), (4, 6), (4, 9)])
    builder.fixed_point((0, 0))
    builder.measured_point("A", (1, 9), block="slider")
    model = builder.build()

Nothing is judged before :meth:`ModelBuilder.build`, so things may be added in any order.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError, shortened
from clast.model import checks as model_checks
from clast.model import ranges, value_checks
from clast.model.block_input import Entry, Label, ManyBlocks, OneBlock, Vector
from clast.model.checks import Outlines, point_text
from clast.model.ground_motion import GroundMotion, Still
from clast.model.model import (
    Bools,
    Floats,
    Ints,
    Joint,
    JointTable,
    LineLoads,
    MaterialPoints,
    MeasuredPoints,
    Model,
    Plane,
    PlaneStress,
    PointLoads,
    Rock,
)
from clast.model.value_checks import check_name, check_number, check_numbers

NO_LOAD: Vector = ()
"""Load of a place that has none."""
FAR = 10.0
"""A case is far from the origin where its distance exceeds this many times its own size."""


@dataclass(frozen=True)
class _Joint:
    joint: Joint
    between: tuple[tuple[str, str], ...]
    between_rocks: tuple[tuple[str, str], ...]
    allow_small_friction_angle: bool


@dataclass(frozen=True)
class _Place:
    """A point, or a line from ``at`` to ``end``, on a block; ``load`` is its force or traction."""

    label: str
    at: Vector
    block: str | None
    end: Vector | None = None
    load: Vector = NO_LOAD


@dataclass(frozen=True)
class _Places:
    """Where points or lines ended up: blocks (k,), ends (k, 2) and loads (k, 2)."""

    block: Ints
    at: Floats
    end: Floats
    load: Floats


@dataclass
class ModelBuilder:
    """Collects what a system of blocks is made of; :meth:`build` checks it and makes the Model.

    Lengths in m, forces in N per metre of thickness, stresses in Pa (tension positive, order xx,
    yy, xy), angles in degrees, velocities in m/s and rad/s.  ``actions`` are objects of one's own
    that act on blocks beside gravity, loads, supports and the ground (clast.actions.action).
    """

    title: str = ""
    plane: Plane = field(default_factory=PlaneStress)
    gravity: Vector = (0.0, -9.8)
    ground_motion: GroundMotion = field(default_factory=Still)
    actions: list[Any] = field(default_factory=list)
    _rocks: list[Rock] = field(default_factory=list, init=False)
    _joints: list[_Joint] = field(default_factory=list, init=False)
    _entries: list[Entry] = field(default_factory=list, init=False)
    _count: int = field(default=0, init=False)
    _fixed_points: list[_Place] = field(default_factory=list, init=False)
    _point_loads: list[_Place] = field(default_factory=list, init=False)
    _line_loads: list[_Place] = field(default_factory=list, init=False)
    _measured_points: list[_Place] = field(default_factory=list, init=False)
    _measured_names: list[str] = field(default_factory=list, init=False)

    def add_rock(
        self,
        name: str,
        *,
        young: float,
        poisson: float,
        density: float,
        initial_stress: Vector = (0.0, 0.0, 0.0),
    ) -> str:
        """Add a rock: Young's modulus in Pa, Poisson's ratio, density in kg/m3; return its name.

        ``initial_stress`` (xx, yy, xy) in Pa is that of its blocks at the start.
        """
        xx, yy, xy = _three(initial_stress, f"rock '{name}', initial_stress")
        self._rocks.append(
            Rock(
                name=name,
                young=check_number(young, f"rock '{name}', young"),
                poisson=check_number(poisson, f"rock '{name}', poisson"),
                density=check_number(density, f"rock '{name}', density"),
                initial_stress=(xx, yy, xy),
            )
        )
        return name

    def add_joint(
        self,
        name: str = "default",
        *,
        friction_angle: float = 0.0,
        cohesion: float = 0.0,
        tensile_strength: float = 0.0,
        restitution: float | None = None,
        between: Iterable[tuple[str, str]] = (),
        between_rocks: Iterable[tuple[str, str]] = (),
        allow_small_friction_angle: bool = False,
    ) -> str:
        """Add a joint strength and return its name: friction in degrees, the others in Pa.

        The joint called "default" serves every contact that no other joint names with
        ``between`` (pairs of blocks) or ``between_rocks`` (pairs of rocks, equal ones allowed);
        a pair of blocks goes before a pair of rocks.  Without any default, contacts are
        frictionless.  ``restitution``, 0 to 1, goes before that of the process.
        ``allow_small_friction_angle`` confirms an angle that looks like radians.
        """
        joint = Joint(
            name=name,
            friction_angle=check_number(friction_angle, f"joint '{name}', friction_angle"),
            cohesion=check_number(cohesion, f"joint '{name}', cohesion"),
            tensile_strength=check_number(tensile_strength, f"joint '{name}', tensile_strength"),
            restitution=None
            if restitution is None
            else check_number(restitution, f"joint '{name}', restitution"),
        )
        self._joints.append(
            _Joint(
                joint,
                _pairs(between, f"joint '{name}', between"),
                _pairs(between_rocks, f"joint '{name}', between_rocks"),
                allow_small_friction_angle,
            )
        )
        return name

    def block(
        self,
        *,
        vertices: Sequence[Vector] | Floats,
        name: str | None = None,
        rock: str | None = None,
        fixed: bool = False,
        velocity: Vector = (0.0, 0.0, 0.0),
        initial_stress: Vector | None = None,
    ) -> str:
        """Add a block by its counter-clockwise vertices (k, 2), m; return its name.

        The name is its number, from 1, unless one is given.  ``rock`` may be left out where there
        is only one.  A ``fixed`` block cannot move at all; ``velocity`` (u, v, omega) is that of
        its centroid at the start; ``initial_stress`` (xx, yy, xy) overrides the rock's.
        """
        self._count += 1
        given = str(self._count) if name is None else name
        self._entries.append(OneBlock(given, rock, vertices, fixed, velocity, initial_stress))
        return given

    def blocks(
        self,
        *,
        vertices: Floats,
        start: Ints | Sequence[int] | None = None,
        names: Sequence[str] | None = None,
        rock: str | None = None,
        fixed: bool | Bools = False,
        velocity: Vector = (0.0, 0.0, 0.0),
        initial_stress: Vector | None = None,
    ) -> tuple[str, ...]:
        """Add k blocks at once, as arrays; return their names.  A wall of a million takes 13 s.

        ``vertices`` in m are (k, s, 2) where every block has s corners, or (nv, 2) with the index
        of each block's first vertex, and nv, in ``start`` (k + 1,).  ``fixed`` is one truth value
        or (k,); ``velocity`` and ``initial_stress`` are three numbers or (k, 3).  Everything
        else, and every check, is that of :meth:`block`.

        A run is gone on from with another load, joint or method by making its last state a model;
        the contact penetration in it is no bad geometry (what contacts of the stiffness that is
        then chosen cannot have left is refused by the next run):

            state, model = run.final, run.model
            builder.blocks(
                vertices=state.vertices,
                start=model.block_start,
                names=model.block_name,
                fixed=model.fixed,
                velocity=state.velocity[:, :3],
                initial_stress=state.stress,
            )

        Blocks of several rocks are added one by one: ``model.block_rock`` says which is whose.
        """
        entry = ManyBlocks(
            self._count, names, rock, vertices, start, fixed, velocity, initial_stress
        )
        self._count += len(entry.names)
        self._entries.append(entry)
        return entry.names

    def fixed_point(self, at: Vector, block: str | None = None) -> None:
        """Hold a point (x, y), m, of a block in place with a stiff spring."""
        label = f"fixed point {len(self._fixed_points) + 1}"
        self._fixed_points.append(_Place(label, at, block))

    def point_load(self, at: Vector, force: Vector, block: str | None = None) -> None:
        """Apply a constant force (x, y), N per metre of thickness, at a point, m, of a block."""
        label = f"point load {len(self._point_loads) + 1}"
        self._point_loads.append(_Place(label, at, block, load=force))

    def line_load(
        self, start: Vector, end: Vector, traction: Vector, block: str | None = None
    ) -> None:
        """Apply a constant traction (x, y), N/m per metre of thickness, along a line of a block.

        ``start`` and ``end`` (x, y) in m.
        """
        label = f"line load {len(self._line_loads) + 1}"
        self._line_loads.append(_Place(label, start, block, end=end, load=traction))

    def measured_point(self, name: str, at: Vector, block: str | None = None) -> None:
        """Record displacement, velocity and rotation of a point (x, y), m, of a block, every step.

        ``block`` names the block of a point; it may be left out where only one is there.
        """
        self._measured_names.append(name)
        self._measured_points.append(_Place(f"measured point '{shortened(str(name))}'", at, block))

    def build(self) -> Model:
        """Check everything and return the Model; raise ModelError with the remedy otherwise."""
        self._check_names()
        for rock in self._rocks:
            value_checks.check_rock(rock, self.plane)
        for entry in self._joints:
            value_checks.check_joint(
                entry.joint, allow_small_friction_angle=entry.allow_small_friction_angle
            )
        outlines = self._outlines()
        polygons = outlines.polygons()
        clockwise = model_checks.check_polygons(outlines, polygons)
        outlines = outlines.turned(clockwise)
        block_rock = self._block_rocks(outlines)
        block_number = {name: number for number, name in enumerate(outlines.names)}
        joint_table = self._joint_table(block_number)
        overlaps = model_checks.check_overlaps(outlines, polygons)

        def places(entries: list[_Place]) -> _Places:
            return _locate(entries, block_number, outlines, polygons)

        fixed, measured = places(self._fixed_points), places(self._measured_points)
        points, lines = places(self._point_loads), places(self._line_loads)
        value_checks.check_ground_motion(self.ground_motion, len(fixed.block))
        value_checks.check_actions(self.actions)
        return Model(
            title=self.title,
            plane=self.plane,
            gravity=check_numbers(self.gravity, 2, "gravity", ranges.ACCELERATION),
            origin=outlines.origin,
            rocks=tuple(self._rocks),
            joint_table=joint_table,
            block_name=outlines.names,
            block_start=outlines.start,
            block_rock=block_rock,
            fixed=self._fixed(outlines),
            vertices=outlines.vertices,
            velocity=self._velocities(outlines),
            initial_stress=self._initial_stresses(outlines, block_rock),
            area=outlines.area,
            fixed_points=MaterialPoints(block=fixed.block, at=fixed.at),
            point_loads=PointLoads(block=points.block, at=points.at, force=points.load),
            line_loads=LineLoads(
                block=lines.block, start=lines.at, end=lines.end, traction=lines.load
            ),
            measured_points=MeasuredPoints(
                block=measured.block, at=measured.at, name=tuple(self._measured_names)
            ),
            ground_motion=self.ground_motion,
            actions=tuple(self.actions),
            overlaps=overlaps,
            notes=model_checks.turned_note(outlines, clockwise),
        )

    def _check_names(self) -> None:
        value_checks.check_title(self.title)
        value_checks.check_names("rock", [rock.name for rock in self._rocks])
        value_checks.check_names("joint", [entry.joint.name for entry in self._joints])
        value_checks.check_names("block", self._names())
        value_checks.check_point_names(self._measured_names)

    def _names(self) -> list[str]:
        return [name for entry in self._entries for name in entry.names]

    def _labelled(self, outlines: Outlines) -> Iterator[tuple[Entry, Label]]:
        """Give every entry with the function that says what messages call its blocks."""
        first = 0
        for entry in self._entries:

            def label(number: int, first: int = first) -> str:
                return outlines.label(first + number)

            yield entry, label
            first += len(entry.names)

    def _outlines(self) -> Outlines:
        """Return all loops as flat arrays about an origin near the case."""
        names = tuple(self._names())
        given = Outlines(names, np.zeros(1, np.int64), np.zeros((0, 2)), np.zeros(2))
        loops = [entry.loops(label) for entry, label in self._labelled(given)]
        counts = np.concatenate([np.zeros(1, np.int64), *(count for count, _ in loops)])
        start = np.cumsum(counts)
        vertices = np.concatenate([np.zeros((0, 2)), *(vertices for _, vertices in loops)])
        given = Outlines(names, start, vertices, np.zeros(2))
        model_checks.check_corner_count(given)
        model_checks.check_coordinates(given)
        origin = _origin(vertices)
        return Outlines(names, start, np.ascontiguousarray(vertices - origin), origin)

    def _block_rocks(self, outlines: Outlines) -> Ints:
        """Return the rock index of each block, shape (n,)."""
        number = {rock.name: index for index, rock in enumerate(self._rocks)}
        only = self._rocks[0].name if len(self._rocks) == 1 else None
        found = []
        for entry, label in self._labelled(outlines):
            name = only if entry.rock is None else entry.rock
            if name is None:
                raise ModelError(
                    "does not say which rock it is made of",
                    where=label(0),
                    remedy=spelling.advice("", number, kind="rock"),
                )
            index = _number_of(name, number, "rock", label(0))
            found.append(np.full(len(entry.names), index, np.int64))
        return np.concatenate(found)

    def _fixed(self, outlines: Outlines) -> Bools:
        """Return True where a block cannot move at all, shape (n,)."""
        return np.concatenate([entry.held(label) for entry, label in self._labelled(outlines)])

    def _joint_table(self, block_number: dict[str, int]) -> JointTable:
        """Return the joints, the default first, and the pairs that they belong to."""
        ordered = sorted(self._joints, key=lambda entry: entry.joint.name != "default")
        if not ordered or ordered[0].joint.name != "default":
            ordered.insert(0, _Joint(Joint(), (), (), False))
        rock_number = {rock.name: index for index, rock in enumerate(self._rocks)}
        rock_joint: dict[tuple[int, int], int] = {}
        block_joint: dict[tuple[int, int], int] = {}
        for index, entry in enumerate(ordered):
            name = entry.joint.name
            if index > 0 and not entry.between and not entry.between_rocks:
                raise ModelError(
                    "belongs to no contact",
                    where=f"joint '{name}'",
                    remedy="call it default, or say where it is with between (pairs of blocks) "
                    "or between_rocks (pairs of rocks)",
                )
            _assign(entry.between_rocks, "rock", rock_number, index, rock_joint, ordered)
            _assign(entry.between, "block", block_number, index, block_joint, ordered)
        rock_pair = np.zeros((len(self._rocks), len(self._rocks)), np.int64)
        for (one, other), index in rock_joint.items():
            rock_pair[one, other] = rock_pair[other, one] = index
        pairs = sorted(block_joint)
        return JointTable(
            joints=tuple(entry.joint for entry in ordered),
            rock_pair=rock_pair,
            block_pair=np.array(pairs, np.int64).reshape(-1, 2),
            block_pair_joint=np.array([block_joint[pair] for pair in pairs], np.int64),
        )

    def _velocities(self, outlines: Outlines) -> Floats:
        """Return the start velocity (u, v, r, 0, 0, 0) of each block, shape (n, 6)."""
        velocity = np.zeros((self._count, 6))
        velocity[:, :3] = np.concatenate(
            [entry.velocities(label) for entry, label in self._labelled(outlines)]
        )
        moving = velocity.any(axis=1) & self._fixed(outlines)
        for index in np.flatnonzero(moving)[:1]:
            raise ModelError(
                "a fixed block has no velocity",
                where=f"{outlines.label(index)}, velocity",
                remedy="remove the velocity, or fixed = true",
            )
        return velocity

    def _initial_stresses(self, outlines: Outlines, block_rock: Ints) -> Floats:
        """Return the start stress (xx, yy, xy) of each block, Pa, shape (n, 3)."""
        stress = np.array([rock.initial_stress for rock in self._rocks])[block_rock]
        first = 0
        for entry, label in self._labelled(outlines):
            own, past = entry.stresses(label), first + len(entry.names)
            if own is not None:
                stress[first:past] = own
            first = past
        return np.ascontiguousarray(stress)


def _three(values: Vector, where: str) -> tuple[float, float, float]:
    first, second, third = check_numbers(values, 3, where, ranges.STRESS).tolist()
    return first, second, third


def _pairs(pairs: Iterable[tuple[str, str]], where: str) -> tuple[tuple[str, str], ...]:
    """Return pairs of names as tuples, or say that they are none."""
    given: object = pairs
    try:
        given = list(pairs)
        found = [tuple(pair) for pair in given if not isinstance(pair, str)]
        if len(found) == len(given) and all(len(pair) == 2 for pair in found):
            return tuple((one, other) for one, other in found)
    except TypeError:
        pass
    raise ModelError(
        f"{shortened(repr(given))} are no pairs of names",
        where=where,
        remedy='give pairs: [["a", "b"]]',
    )


def _origin(vertices: Floats) -> Floats:
    """Return a rounded centre of the case where it is far from (0, 0), else (0, 0), m.

    Coordinates of 1e6 m leave 1e-10 m of resolution; taken about a centre they leave 1e-16.  The
    centre is rounded so that shifted coordinates stay readable.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float(np.hypot(*(high - low)))
    if size == 0.0 or np.abs([low, high]).max() <= FAR * size:
        return np.zeros(2)
    unit = 10.0 ** math.floor(math.log10(size))
    return np.asarray(np.round(0.5 * (low + high) / unit) * unit)


def _number_of(name: str, number: dict[str, int], kind: str, where: str) -> int:
    """Return the index of a named thing, or suggest the nearest name."""
    name = check_name(name, kind, where)
    if name not in number:
        raise ModelError(
            f"there is no {kind} '{shortened(name)}'",
            where=where,
            remedy=spelling.advice(name, number, kind=kind),
        )
    return number[name]


def _assign(
    pairs: tuple[tuple[str, str], ...],
    kind: str,
    number: dict[str, int],
    index: int,
    assigned: dict[tuple[int, int], int],
    joints: list[_Joint],
) -> None:
    """Give pairs of blocks or rocks to a joint; refuse pairs that two joints claim."""
    where = f"joint '{joints[index].joint.name}'"
    for one, other in pairs:
        found = (_number_of(one, number, kind, where), _number_of(other, number, kind, where))
        pair = (min(found), max(found))
        if kind == "block" and found[0] == found[1]:
            raise ModelError(
                f"block '{one}' has no joint with itself",
                where=f"{where}, between",
                remedy="name two different blocks",
            )
        before = assigned.setdefault(pair, index)
        if before != index:
            raise ModelError(
                f"the {kind}s '{one}' and '{other}' belong to joint "
                f"'{joints[before].joint.name}' already",
                where=where,
                remedy="name the pair in one joint only",
            )


def _locate(
    entries: list[_Place],
    block_number: dict[str, int],
    outlines: Outlines,
    polygons: model_checks.Geometries,
) -> _Places:
    """Return blocks and coordinates about the origin of points or lines."""
    count = len(entries)
    at, end, load = np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2))
    named = np.full(count, -1, np.int64)
    for k, entry in enumerate(entries):
        at[k] = check_numbers(entry.at, 2, entry.label) - outlines.origin
        if entry.end is not None:
            end[k] = check_numbers(entry.end, 2, f"{entry.label}, end") - outlines.origin
        if entry.load is not NO_LOAD:
            load[k] = check_numbers(
                entry.load, 2, f"{entry.label}, force or traction", ranges.FORCE
            )
        if entry.block is not None:
            named[k] = _number_of(entry.block, block_number, "block", entry.label)
    lines = np.array([entry.end is not None for entry in entries], dtype=np.bool_)
    for k in np.flatnonzero(lines & (at == end).all(axis=1))[:1]:
        raise ModelError("has no length", where=entries[k].label, remedy="give two different ends")
    shapes = np.array(shapely.points(at))
    if lines.any():
        shapes = np.array(shapely.linestrings(np.stack([at, end], axis=1)))
    if count == 0:
        return _Places(np.zeros(0, np.int64), at, end, load)

    def where(k: int) -> str:
        return f"{entries[k].label} at {point_text(at[k] + outlines.origin)}"

    block = model_checks.locate(shapes, named, where, outlines, polygons)
    return _Places(block, at, end, load)
