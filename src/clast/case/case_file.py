"""The case file: what to simulate and how, as TOML; to Model, Method, Schedule and Run.

    case = clast.load("incline.toml")
    run = case.run()

The tables below are the format: their keys, units and defaults are what ``clast schema`` prints.
This is the only place where methods are chosen by name; the dictionaries of names come first.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    PrivateAttr,
    StrictBool,
    StrictInt,
    StrictStr,
    ValidationError,
    field_validator,
    model_validator,
)

from clast import spelling
from clast.case import text as case_text
from clast.case import writing as case_writing
from clast.case.choices import Alternatives, Choice, Chosen, Given, Number, within
from clast.case.faults import SHOWN, Fault, case_error, faults_of, refusal
from clast.case.meanings import explain
from clast.case.record import read_record
from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.builder import ModelBuilder
from clast.model.ground_motion import Accelerogram, GroundMotion, InertialForce, MovingBase, Still
from clast.model.model import Model, PlaneStrain, PlaneStress

if TYPE_CHECKING:
    from clast.results import Run
    from clast.run.preflight import Sanity
    from clast.run.schedule import Progress, Schedule
    from clast.step.method import Method

PROCESSES = {
    "modified": "clast.step.modified:Modified",
    "convex": "clast.step.convex:Convex",
    "open-close": "clast.step.open_close:OpenClose",
}
FRICTIONS = {
    "lagged": "clast.step.modified:LaggedFriction",
    "implicit": "clast.step.modified:ImplicitFriction",
}
CONTACT_LAWS = {
    "penalty": "clast.contact.laws:Penalty",
    "augmented-lagrangian": "clast.contact.laws:AugmentedLagrangian",
}
MULTIPLIERS = {
    "reset": "clast.contact.laws:Reset",
    "carried": "clast.contact.laws:Carried",
}
CORNER_RULES = {
    "bisector": "clast.contact.corner_rules:Bisector",
    "shi": "clast.contact.corner_rules:EntranceLines",
}
ROTATIONS = {
    "exact": "clast.block.rotation:Exact",
    "sine": "clast.block.rotation:Sine",
    "linear": "clast.block.rotation:Linear",
}
INTEGRATORS = {
    "constant-acceleration": "clast.step.integration:ConstantAcceleration",
    "backward-euler": "clast.step.integration:BackwardEuler",
}
SOLVERS = {
    "auto": "clast.linear.solvers:Automatic",
    "cholesky": "clast.linear.solvers:Direct",
    "pcg": "clast.linear.solvers:PCG",
    "scipy": "clast.linear.solvers:Scipy",
}
PLANES: dict[str, type[PlaneStress] | type[PlaneStrain]] = {
    "stress": PlaneStress,
    "strain": PlaneStrain,
}
GROUND_MOTIONS: dict[str, type[InertialForce] | type[MovingBase]] = {
    "body-force": InertialForce,
    "base": MovingBase,
}

ALTERNATIVES = Alternatives(
    classes={
        "process": PROCESSES,
        "friction": FRICTIONS,
        "contact_law": CONTACT_LAWS,
        "multipliers": MULTIPLIERS,
        "corner_rule": CORNER_RULES,
        "rotation": ROTATIONS,
        "integrator": INTEGRATORS,
        "solver": SOLVERS,
    },
    limits={
        "normal_stiffness": (Field(gt=0.0), within(ranges.STIFFNESS)),
        "shear_stiffness": (Field(gt=0.0), within(ranges.STIFFNESS)),
        "passes": (Field(ge=1, le=ranges.MOST_PASSES),),
        "tolerance": (Field(gt=0.0), within(ranges.TOLERANCE)),
        "iterations": (Field(ge=1, le=ranges.MOST_ITERATIONS),),
        "plain": (Field(ge=0, le=ranges.MOST_ITERATIONS),),
        "solves": (Field(ge=1, le=ranges.MOST_PASSES),),
        "penetration_tolerance": (Field(ge=0.0), within(ranges.LENGTH)),
        "friction_updates": (Field(ge=0, le=ranges.MOST_PASSES),),
        "restitution": (Field(ge=0.0, le=1.0),),
    },
    automatic=frozenset({"normal_stiffness"}),
    needs={
        "process": ("step", "advice", "stiffness"),
        "friction": ("enter",),
        "contact_law": ("respond", "normal_stiffness"),
        "multipliers": ("first", "carries"),
        "corner_rule": ("choose",),
        "rotation": ("angle", "gradient"),
        "integrator": ("theta",),
        "solver": ("factor",),
    },
)
"""Every key that offers a choice.  A class's own numbers are read from its dataclass."""

SYSTEM = frozenset(
    {"plane", "gravity", "rock", "joint", "geometry", "block", "fixed_point", "measured_point"}
    | {"point_load", "line_load", "ground_motion"}
)
"""What a reference depends on."""
FRAMES = 100
"""Frames of a run that does not say how many it wants."""
TRAVEL_SHARE = 0.05
"""Default max_displacement, as a share of the size (square root of area) of the smallest block."""
CRITDIS_SHARE = 0.005
"""Default critdis, likewise."""
OTHER_UNIT = 5.0
"""A scale that is off by more than this factor belongs to another unit."""
SECONDS_OF_A_STEP = 1e-5
"""Wall time of a step that none falls below, s."""
FIXED_POINT_FACTOR = 100.0
"""Fixed points are this many times stiffer than the contacts and the stiffest rock."""

Positive = Annotated[Number, Field(gt=0.0)]
Interval = Annotated[Positive, within(ranges.INTERVAL)]
Length = Annotated[Positive, within(ranges.LENGTH)]
Strength = Annotated[Number, Field(ge=0.0), within(ranges.STRESS)]
Coordinate = Annotated[Number, within(ranges.COORDINATE)]
Point = tuple[Coordinate, Coordinate]
Force = Annotated[Number, within(ranges.FORCE)]
Speed = Annotated[Number, within(ranges.SPEED)]
Motion = tuple[Speed, Speed, Speed]
Acceleration = Annotated[Number, within(ranges.ACCELERATION)]
Instant = Annotated[Number, within(ranges.TIME)]
Stress = Annotated[Number, within(ranges.STRESS)]
Stresses = tuple[Stress, Stress, Stress]
Loop = list[Point]


class Table(BaseModel):
    """A table of the case file: unknown keys and numbers that are none are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class TimeTable(Table):
    """When to simulate."""

    step: Interval
    """Length of a step, s; shorter steps are used where max_displacement asks for them."""
    end: Positive
    """End of the run, s."""
    max_displacement: Length | None = None
    """Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size
    (square root of the area) of the smallest block if absent."""
    dynamic_ratio: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.0
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    smallest_step: Interval | None = None
    """The run stops where it would need a smaller step than this, s."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        steps = min(self.end / self.step, 1e300)
        if steps > ranges.MOST_STEPS:
            raise refusal(
                Fault(
                    place=("end",),
                    what=f"{self.end:g} s are {steps:.3g} steps of {self.step:g} s: more than "
                    f"{steps * SECONDS_OF_A_STEP / 3600.0:.2g} hours",
                    remedy="lower end, or raise step",
                )
            )
        if self.step > self.end:
            raise refusal(
                Fault(
                    place=("step",),
                    what=f"{self.step:g} s is longer than the whole run of {self.end:g} s",
                    remedy="lower step, or raise end",
                )
            )
        if self.smallest_step is not None and self.smallest_step > self.step:
            raise refusal(
                Fault(
                    place=("smallest_step",),
                    what=f"{self.smallest_step:g} s is longer than step, {self.step:g} s",
                    remedy="lower it below step, or leave it out",
                )
            )
        return self


class RockTable(Table):
    """A linear elastic rock."""

    young: Annotated[Positive, within(ranges.MODULUS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(gt=-1.0, le=0.5)]
    """Poisson's ratio, -; below 0.5 in plane strain."""
    density: Annotated[Positive, within(ranges.DENSITY)]
    """Density, kg/m3."""
    initial_stress: Stresses = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""


class JointTable(Table):
    """Strength of the contacts along a joint; the joint called default serves all others."""

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: Strength = 0.0
    """Cohesion, Pa; lost where the joint has slipped or opened."""
    tensile_strength: Strength = 0.0
    """Tension cut-off, Pa; lost where the joint has slipped or opened."""
    restitution: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None
    """Share of the closing velocity with which impacts rebound, 0 to 1; else the process' own."""
    between: list[tuple[StrictStr, StrictStr]] = []
    """Pairs of blocks with this joint between them: [["a", "b"], ...]."""
    between_rocks: list[tuple[StrictStr, StrictStr]] = []
    """Pairs of rocks with this joint between their blocks: [["granite", "granite"], ...]."""
    allow_small_friction_angle: StrictBool = False
    """True where a friction angle below 1.6 is meant in degrees, not in radians."""


class LoopTable(Table):
    """A block as a loop of numbered vertices."""

    loop: list[StrictInt]
    """Numbers of its vertices, from 1, counter-clockwise."""
    name: StrictStr | None = None
    """Name; the block's number if absent."""
    rock: StrictStr | None = None
    """Rock; may be left out where there is only one."""
    fixed: StrictBool = False
    """True for a block that cannot move at all."""
    velocity: Motion = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Stresses | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""


class GeometryTable(Table):
    """Blocks by numbered vertices."""

    vertices: Loop
    """Coordinates [x, y] of all vertices, m; the first is number 1."""
    blocks: list[LoopTable]
    """Blocks as counter-clockwise loops of vertex numbers; others are turned round."""

    @model_validator(mode="after")
    def _vertices_exist(self) -> Self:
        count = len(self.vertices)
        faults = [
            Fault(
                place=("blocks", number, "loop", position),
                what=f"there is no vertex {vertex}",
                remedy=f"vertices are numbered from 1 to {count}",
            )
            for number, block in enumerate(self.blocks)
            for position, vertex in enumerate(block.loop)
            if not 1 <= vertex <= count
        ]
        if faults:
            raise refusal(*faults)
        return self

    def remarks(self) -> Iterator[str]:
        """Say which vertices belong to no block."""
        used = {vertex for block in self.blocks for vertex in block.loop}
        idle = [k for k in range(1, len(self.vertices) + 1) if k not in used]
        if idle:
            shown = ", ".join(map(str, idle[:SHOWN])) + (", ..." if len(idle) > SHOWN else "")
            yield (
                f"[geometry] {len(idle)} of {len(self.vertices)} vertices belong to no block: "
                f"{shown}. Is a loop missing?"
            )


class BlockTable(Table):
    """A block by its coordinates."""

    vertices: Loop
    """Coordinates [x, y] of its vertices, counter-clockwise, m."""
    name: StrictStr | None = None
    """Name; the block's number if absent."""
    rock: StrictStr | None = None
    """Rock; may be left out where there is only one."""
    fixed: StrictBool = False
    """True for a block that cannot move at all."""
    velocity: Motion = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Stresses | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""


class FixedPointTable(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class PointLoadTable(Table):
    """A constant force at a point that moves with its block."""

    at: Point
    """Coordinates [x, y], m."""
    force: tuple[Force, Force]
    """Force [x, y], N per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class LineLoadTable(Table):
    """A constant traction along a line that moves with its block, usually along an edge."""

    start: Point
    """First end [x, y], m."""
    end: Point
    """Second end [x, y], m."""
    traction: tuple[Force, Force]
    """Force per length [x, y], N/m per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class MeasuredPointTable(Table):
    """A point whose displacement, velocity and rotation are recorded every step."""

    name: StrictStr
    """Name."""
    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    @field_validator("name")
    @classmethod
    def _has_no_slash(cls, name: str) -> str:
        if "/" in name:
            what = f"'{shortened(name)}' has a /, but names places in the result file"
            raise refusal(Fault(what=what, remedy="give it a name without /"))
        return name


class GroundMotionTable(Table):
    """An accelerogram, linear between its instants, and how it reaches the blocks.

    The ground starts from rest.  After the last instant it has no acceleration, and keeps the
    velocity that it then has.
    """

    acts: Literal["body-force", "base"]
    """"body-force": minus the acceleration on the mass of every block, motion is relative to the
    ground; "base": the fixed points move with the ground.  Fixed blocks do not move: a base that
    moves is held by fixed points."""
    file: StrictStr | None = None
    """Text file beside the case file, with columns t, ax and, if wanted, ay; instead of lists."""
    time: list[Instant] | None = None
    """Instants, s, rising."""
    acceleration: list[Acceleration] | None = None
    """Horizontal acceleration of the ground at the instants, m/s2, to the right."""
    vertical: list[Acceleration] | None = None
    """Vertical acceleration of the ground at the instants, m/s2, upwards; none if absent."""
    scale: Annotated[Number, within(ranges.FACTOR)] = 1.0
    """Factor on all accelerations: 9.81 for a record in g."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        lists = {"time": self.time, "acceleration": self.acceleration, "vertical": self.vertical}
        given = {key: len(values) for key, values in lists.items() if values is not None}
        if self.file is not None and given:
            remedy = "name the file, or give the lists"
            raise refusal(Fault(place=("file",), what="there are lists as well", remedy=remedy))
        if self.file is None and not {"time", "acceleration"} <= set(given):
            remedy = 'give file = "record.csv", or time = [...] and acceleration = [...]'
            raise refusal(Fault(what="there is no accelerogram", remedy=remedy))
        if len(set(given.values())) > 1:
            counted = ", ".join(f"{key} {count}" for key, count in given.items())
            remedy = "give as many numbers in each list"
            raise refusal(Fault(what=f"the lists differ in length: {counted}", remedy=remedy))
        return self

    def motion(self, folder: Path) -> GroundMotion:
        """Return the ground motion; a file is looked for in ``folder``."""
        if self.file is not None:
            record = read_record(folder / self.file)
            time, acceleration = record.time, record.acceleration
        else:
            time = np.array(self.time, np.float64)
            horizontal = np.array(self.acceleration, np.float64)
            vertical = np.zeros(len(time)) if self.vertical is None else np.array(self.vertical)
            acceleration = np.stack([horizontal, vertical], axis=1)
        return GROUND_MOTIONS[self.acts](Accelerogram(time, self.scale * acceleration))

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say where the unit that a record's heading names contradicts the scale."""
        unit = read_record(folder / self.file).unit if self.file is not None else None
        if unit is None:
            return
        name, size = unit
        if not size / OTHER_UNIT <= abs(self.scale) <= size * OTHER_UNIT:
            yield (
                f"[ground_motion] scale is {self.scale:g}, but the heading of "
                f"{shortened(str(self.file))} says that accelerations are in {name}: give scale = "
                f"{size:g} if they are"
            )


class ReferenceTable(Table):
    """A displacement that is known from elsewhere, to compare a run with."""

    point: StrictStr
    """Measured point that it is known for."""
    displacement: Point
    """Displacement [u, v] since the start, m."""
    time: Positive | None = None
    """When, s; the end of the run if absent."""
    source: StrictStr = ""
    """Where it comes from, e.g. "closed form: g t2/2"."""


class MethodTable(Table):
    """How to simulate: a name for each choice, or a table with the name and its numbers."""

    process: Annotated[Any, Choice("process", ALTERNATIVES)] = "convex"
    """Process of a step."""
    contact_law: Annotated[Any, Choice("contact_law", ALTERNATIVES)] = "penalty"
    """Forces from penetration and slip."""
    corner_rule: Annotated[Any, Choice("corner_rule", ALTERNATIVES)] = "bisector"
    """Which edge a vertex enters through at a corner."""
    rotation: Annotated[Any, Choice("rotation", ALTERNATIVES)] = "sine"
    """How points follow the rotation of their block."""
    integrator: Annotated[Any, Choice("integrator", ALTERNATIVES)] = "constant-acceleration"
    """Time integration."""
    solver: Annotated[Any, Choice("solver", ALTERNATIVES)] = "auto"
    """Solver of the equations of a step."""
    critdis: Length | None = None
    """Edges are lengthened by this in contact detection, m; 0.5 % of the smallest block's size
    (square root of its area) if absent."""
    fixed_point_stiffness: Annotated[Positive, within(ranges.STIFFNESS)] | None = None
    """Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent."""

    def chosen(self, key: str) -> Chosen | Given:
        """Return the choice of a key."""
        value = getattr(self, key)
        return (
            value
            if isinstance(value, Chosen | Given)
            else Choice(key, ALTERNATIVES).validate(value)
        )

    def build(self, key: str, **provided: Any) -> Any:
        """Return the object that a key chooses."""
        return self.chosen(key).build(**provided)

    def method(
        self, model: Model, *, step: float, max_displacement: float, dynamic_ratio: float = 1.0
    ) -> Method:
        """Return how to simulate; what the table leaves open follows from the model."""
        from clast.block.displacement import FirstOrder
        from clast.step.method import Method

        process = self.build("process")
        provided: dict[str, float] = {}
        notes: tuple[str, ...] = ()
        if self.chosen("contact_law").is_automatic("normal_stiffness"):
            stiffness, reason = process.stiffness(model, step)
            provided["normal_stiffness"] = stiffness
            notes = (f"normal_stiffness = {stiffness:.4g} N/m per m: {reason}",)
        contact_law = self.build("contact_law", **provided)
        stiffest = max(contact_law.normal_stiffness, model.stiffest)
        return Method(
            process=process,
            contact_law=contact_law,
            corner_rule=self.build("corner_rule"),
            displacement=FirstOrder(rotation=self.build("rotation")),
            integrator=self.build("integrator"),
            solver=self.build("solver"),
            fixed_point_stiffness=self.fixed_point_stiffness or FIXED_POINT_FACTOR * stiffest,
            critdis=self.critdis or CRITDIS_SHARE * float(np.sqrt(model.area.min())),
            max_displacement=max_displacement,
            dynamic_ratio=dynamic_ratio,
            notes=notes,
        )


class OutputTable(Table):
    """What to keep of a run."""

    every: Interval | None = None
    """Time between frames, s; a hundredth of the run, or a step, if absent."""
    contacts: StrictBool = True
    """True keeps the contact forces of every frame."""


class Case(Table):
    """A case of the discontinuous deformation analysis program clast."""

    schema_: Literal[1] = Field(1, alias="schema")
    """Version of this format."""
    title: StrictStr = ""
    """Title."""
    plane: Literal["stress", "strain"] = "stress"
    """Plane stress or plane strain."""
    gravity: tuple[Acceleration, Acceleration] = (0.0, -9.8)
    """Acceleration of gravity [x, y], m/s2."""
    time: TimeTable
    """When to simulate: [time] with step and end."""
    rock: dict[str, RockTable]
    """Rocks by name: [rock.granite] with young, poisson and density."""
    joint: dict[str, JointTable] = {}
    """Joint strengths by name: [joint.default] with friction_angle."""
    geometry: GeometryTable | None = None
    """Blocks by numbered vertices."""
    block: list[BlockTable] = []
    """Blocks by their coordinates."""
    fixed_point: list[FixedPointTable] = []
    """Points held in place."""
    point_load: list[PointLoadTable] = []
    """Forces at points."""
    line_load: list[LineLoadTable] = []
    """Tractions along lines."""
    ground_motion: GroundMotionTable | None = None
    """Earthquake or shaking table."""
    measured_point: list[MeasuredPointTable] = []
    """Points recorded every step."""
    reference: list[ReferenceTable] = []
    """Displacements known from elsewhere; clast run and clast compare print the error."""
    method_: MethodTable = Field(default_factory=MethodTable, alias="method")
    """How to simulate."""
    output: OutputTable = Field(default_factory=OutputTable)
    """How often to keep a frame, and what is in it."""

    _file: str = PrivateAttr("case")
    _text: str | None = PrivateAttr(None)

    @model_validator(mode="after")
    def _references_have_points(self) -> Self:
        names = [point.name for point in self.measured_point]
        faults = [
            Fault(
                place=("reference", number, "point"),
                what=f"there is no measured point '{reference.point}'",
                remedy=spelling.advice(reference.point, names, kind="measured point"),
            )
            for number, reference in enumerate(self.reference)
            if reference.point not in names
        ]
        if faults:
            raise refusal(*faults)
        return self

    @classmethod
    def from_toml(cls, source: str | Path, settings: Iterable[str] = ()) -> Case:
        """Return the case in a file, or in a TOML text (a ``str`` of several lines).

        ``settings`` such as ``"time.end=2"`` replace single values.  References belong to the
        system as the file has it: settings that change it, such as
        ``"joint.default.friction_angle=30"``, leave them out unless they set them too.  Raises
        CaseError naming file, table, key and remedy.
        """
        settings = list(settings)
        is_text = isinstance(source, str) and "\n" in source
        file = "case" if is_text else str(source)
        text = str(source) if is_text else case_text.read_text(Path(source))
        content = case_text.parse(text, file)
        if settings:
            content = case_text.with_values(content, settings)
            tables = {setting.replace("=", ".").split(".")[0].strip() for setting in settings}
            if tables & SYSTEM and "reference" not in tables:
                content.pop("reference", None)
        case = cls.validated(content, file)
        case._text = None if settings else text
        return case

    @classmethod
    def validated(cls, content: dict[str, Any], file: str) -> Case:
        """Return the case with a content from ``file``; its faults become one CaseError."""
        try:
            case = cls.model_validate(content)
        except ValidationError as error:
            faults = faults_of(error, explained_case())
            raise case_error(faults, file=file, content=content) from None
        case._file = file
        return case

    def with_method(self, **choices: Any) -> Case:
        """Return the case with other choices in [method]: names, tables with numbers, objects.

        ``case.with_method(process="convex", contact_law={"name": "penalty"})``.  An object of a
        script, ``contact_law=MyLaw()``, may be in the place of a name; only a file cannot hold it.
        """
        content = self.model_dump(by_alias=True, exclude_unset=True)
        content["method"] = {**content.get("method", {}), **choices}
        return self.validated(content, self._file)

    @property
    def name(self) -> str:
        """Name of the case: its file without the ending."""
        return Path(self._file).stem

    @property
    def text(self) -> str:
        """The case as a TOML text: the file's own, or written anew; objects appear as texts."""
        return self._written(repr) if self._text is None else self._text

    def to_toml(self) -> str:
        """Return the case as a TOML text, with what differs from the defaults.

        Raises CaseError where the case holds an object of a script.
        """
        return self._written(case_writing.refuse_object)

    def _written(self, instead: Callable[[Any], str]) -> str:
        content = self.model_dump(by_alias=True, exclude_unset=True)
        method = case_writing.without_objects(content.get("method", {}), instead)
        content = {**content, "method": method} if method else content
        return case_text.to_toml({"schema": 1, **content})

    def model(self) -> Model:
        """Return the system of blocks; raises ModelError naming the place and the remedy."""
        shaken = self.ground_motion
        builder = ModelBuilder(
            title=self.title,
            plane=PLANES[self.plane](),
            gravity=self.gravity,
            ground_motion=Still() if shaken is None else shaken.motion(Path(self._file).parent),
        )
        with self._located():
            self._add_materials(builder)
            self._add_blocks(builder)
            self._add_points(builder)
            return builder.build()

    def _add_materials(self, builder: ModelBuilder) -> None:
        for name, rock in self.rock.items():
            builder.add_rock(name, **dict(rock))
        for name, joint in self.joint.items():
            builder.add_joint(name, **dict(joint))

    def _add_blocks(self, builder: ModelBuilder) -> None:
        if self.geometry is not None:
            vertices = np.array(self.geometry.vertices, np.float64).reshape(-1, 2)
            for numbered in self.geometry.blocks:
                values = {key: value for key, value in numbered if key != "loop"}
                loop = np.array(numbered.loop, np.int64)
                builder.block(vertices=vertices[loop - 1], **values)
        for block in self.block:
            builder.block(**dict(block))

    def _add_points(self, builder: ModelBuilder) -> None:
        for fixed in self.fixed_point:
            builder.fixed_point(**dict(fixed))
        for load in self.point_load:
            builder.point_load(**dict(load))
        for line in self.line_load:
            builder.line_load(**dict(line))
        for measured in self.measured_point:
            builder.measured_point(**dict(measured))

    def method(self, model: Model | None = None) -> Method:
        """Return how to simulate; what the case leaves open follows from its model."""
        model = model or self.model()
        smallest = float(np.sqrt(model.area.min()))
        return self.method_.method(
            model,
            step=self.time.step,
            max_displacement=self.time.max_displacement or TRAVEL_SHARE * smallest,
            dynamic_ratio=self.time.dynamic_ratio,
        )

    def examine(self) -> Sanity:
        """Return what the case consists of, with warnings of what seems unsound about it."""
        model = self.model()
        sanity = self._examined(model, self.method(model))
        return dataclasses.replace(sanity, warnings=(*sanity.warnings, *self._not_compared()))

    def _examined(self, model: Model, method: Method) -> Sanity:
        """Return what the case consists of, with what its run warns of."""
        from clast.run.preflight import examine

        with self._located():
            sanity = examine(model, method, self.schedule())
        return dataclasses.replace(sanity, warnings=(*sanity.warnings, *self._remarks()))

    def _remarks(self) -> Iterator[str]:
        """Say what seems unsound about what only the case file knows."""
        if self.geometry is not None:
            yield from self.geometry.remarks()
        if self.ground_motion is not None:
            yield from self.ground_motion.remarks(Path(self._file).parent)

    def _not_compared(self) -> Iterator[str]:
        """Say which references the run does not reach; the run itself says so at its end."""
        for number, reference in enumerate(self.reference, start=1):
            if reference.time is not None and reference.time > self.time.end:
                yield (
                    f"[[reference]] {number} is for {reference.time:g} s, but the run ends at "
                    f"{self.time.end:g} s: it is not compared. Raise time.end, or lower its time"
                )

    @contextmanager
    def _located(self) -> Iterator[None]:
        """Name the file in the errors of its model."""
        try:
            yield
        except ModelError as error:
            where = f"{self._file}: {error.where}"
            raise ModelError(error.what, where=where, remedy=error.remedy) from None

    def schedule(self) -> Schedule:
        """Return when to simulate and when to keep a frame."""
        from clast.run.schedule import Schedule

        return Schedule(
            step=self.time.step,
            end=self.time.end,
            every=self.output.every or max(self.time.step, self.time.end / FRAMES),
            smallest_step=self.time.smallest_step,
        )

    def run(
        self,
        *,
        progress: bool | Callable[[Progress], None] = False,
        output: str | Path | None = None,
        warn: Callable[[str], None] | None = None,
    ) -> Run:
        """Simulate the case and return its results.

        ``progress`` is True for a line on the terminal, or a function to call after every step;
        ``output`` is the result file to write; ``warn`` is called before the first step with each
        warning that is known by then (the report has them all).  Raises RunStopped, with the
        partial results in its ``run``, where the run cannot go on.
        """
        # A bad case is refused before anything slow is loaded and anything is written.
        model = self.model()
        method = self.method(model)

        from clast.results import RunRecorder
        from clast.run.progress import shown
        from clast.run.simulate import simulate

        schedule = self.schedule()
        warnings = self._examined(model, method).warnings
        if warn:
            for warning in warnings:
                warn(warning)
        recorder = RunRecorder(
            model,
            case_text=self.text,
            output=None if output is None else Path(output),
            contacts=self.output.contacts,
        )
        with shown(progress) as watch:
            return simulate(
                model, method, schedule, recorder=recorder, watch=watch, warnings=warnings
            )

    def __repr__(self) -> str:
        numbered = len(self.geometry.blocks) if self.geometry else 0
        chosen = self.method_.chosen
        return (
            f"Case('{self.title or self.name}', {numbered + len(self.block)} blocks, "
            f"{chosen('process').name} with {chosen('contact_law').name}, "
            f"step {self.time.step:g} s to {self.time.end:g} s)"
        )

    __str__ = __repr__


def load(path: str | Path) -> Case:
    """Return the case in a file; raises CaseError naming file, table, key and remedy."""
    return Case.from_toml(Path(path))


@cache
def explained_case() -> type[Case]:
    """Return Case when all keys of all tables have been given their meanings."""
    for table in Table.__subclasses__():  # in the order of this file: inner tables first
        explain(table)
    return Case


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of the case file."""
    schema = explained_case().model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
