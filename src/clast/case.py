"""The case file: what to simulate and how, as TOML; to Model, Method, Schedule and Run.

    case = clast.load("incline.toml")
    run = case.run()

The tables below are the format: their keys, units and defaults are what ``clast schema`` prints.
This is the only place where methods are chosen by name; the dictionaries of names come first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
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
    model_validator,
)

from clast import spelling
from clast.casefile import text as case_text
from clast.casefile.choices import Alternatives, Choice, Chosen, Number
from clast.casefile.faults import Fault, case_error, faults_of, refusal
from clast.casefile.meanings import explain
from clast.casefile.record import read_record
from clast.errors import ModelError
from clast.ground_motion import Accelerogram, GroundMotion, InertialForce, MovingBase, Still
from clast.model import Model, PlaneStrain, PlaneStress
from clast.model_builder import ModelBuilder

if TYPE_CHECKING:
    from clast.interfaces import Method
    from clast.results import Run
    from clast.simulate import Progress, Schedule

PROCESSES = {
    "modified": "clast.stepping.modified:Modified",
    "convex": "clast.stepping.convex:Convex",
    "open-close": "clast.stepping.open_close:OpenClose",
}
FRICTIONS = {
    "lagged": "clast.stepping.modified:LaggedFriction",
    "implicit": "clast.stepping.modified:ImplicitFriction",
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
    "bisector": "clast.contact.corners:Bisector",
    "shi": "clast.contact.corners:EntranceLines",
}
ROTATIONS = {
    "exact": "clast.kinematics.rotation:Exact",
    "sine": "clast.kinematics.rotation:Sine",
    "linear": "clast.kinematics.rotation:Linear",
}
INTEGRATORS = {
    "constant-acceleration": "clast.stepping.advance:ConstantAcceleration",
    "backward-euler": "clast.stepping.advance:BackwardEuler",
}
SOLVERS = {
    "auto": "clast.equations.solvers:Automatic",
    "cholesky": "clast.equations.solvers:Direct",
    "pcg": "clast.equations.solvers:PCG",
    "scipy": "clast.equations.solvers:Scipy",
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
        "normal_stiffness": Field(gt=0.0),
        "shear_stiffness": Field(gt=0.0),
        "passes": Field(ge=1),
        "tolerance": Field(gt=0.0),
        "iterations": Field(ge=1),
        "solves": Field(ge=1),
        "penetration_tolerance": Field(ge=0.0),
        "friction_updates": Field(ge=0),
        "restitution": Field(ge=0.0, le=1.0),
    },
    automatic=frozenset({"normal_stiffness"}),
)
"""Every key that offers a choice.  A class's own numbers are read from its dataclass."""

SYSTEM = frozenset(
    {"plane", "gravity", "rock", "joint", "geometry", "block", "fixed_point", "measured_point"}
    | {"point_load", "line_load", "ground_motion"}
)
"""What a reference depends on."""
FRAMES = 100
"""Frames of a run that does not say how many it wants."""
TRAVEL_SHARE = 0.01
"""Default max_displacement, as a share of the size (square root of area) of the smallest block."""
CRITDIS_SHARE = 0.5
"""Default critdis, as a share of max_displacement (the paper's own ratio)."""
FIXED_POINT_FACTOR = 100.0
"""Fixed points are this many times stiffer than the contacts and the stiffest rock."""

Positive = Annotated[Number, Field(gt=0.0)]
NotNegative = Annotated[Number, Field(ge=0.0)]
Two = tuple[Number, Number]
Three = tuple[Number, Number, Number]
Loop = list[Two]


class Table(BaseModel):
    """A table of the case file: unknown keys and numbers that are none are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class TimeTable(Table):
    """When to simulate."""

    step: Positive
    """Length of a step, s; shorter steps are used where max_displacement asks for them."""
    end: Positive
    """End of the run, s."""
    max_displacement: Positive | None = None
    """Largest vertex movement in a step, m; 1 % of the size of the smallest block if absent."""
    dynamic_ratio: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.0
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    smallest_step: Positive | None = None
    """The run stops where it would need a smaller step than this, s."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
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

    young: Positive
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(gt=-1.0, le=0.5)]
    """Poisson's ratio, -; below 0.5 in plane strain."""
    density: Positive
    """Density, kg/m3."""
    initial_stress: Three = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""


class JointTable(Table):
    """Strength of the contacts along a joint; the joint called default serves all others."""

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: NotNegative = 0.0
    """Cohesion, Pa; lost where the joint has slipped or opened."""
    tensile_strength: NotNegative = 0.0
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
    velocity: Three = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Three | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""


class GeometryTable(Table):
    """Blocks by numbered vertices."""

    vertices: Loop
    """Coordinates [x, y] of all vertices, m; the first is number 1."""
    blocks: list[LoopTable]
    """Blocks as counter-clockwise loops of vertex numbers."""

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
    velocity: Three = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Three | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""


class FixedPointTable(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Two
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class PointLoadTable(Table):
    """A constant force at a point that moves with its block."""

    at: Two
    """Coordinates [x, y], m."""
    force: Two
    """Force [x, y], N per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class LineLoadTable(Table):
    """A constant traction along a line that moves with its block, usually along an edge."""

    start: Two
    """First end [x, y], m."""
    end: Two
    """Second end [x, y], m."""
    traction: Two
    """Force per length [x, y], N/m per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class MeasuredPointTable(Table):
    """A point whose displacement, velocity and rotation are recorded every step."""

    name: StrictStr
    """Name."""
    at: Two
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


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
    time: list[Number] | None = None
    """Instants, s, rising."""
    acceleration: list[Number] | None = None
    """Horizontal acceleration of the ground at the instants, m/s2, to the right."""
    vertical: list[Number] | None = None
    """Vertical acceleration of the ground at the instants, m/s2, upwards; none if absent."""
    scale: Number = 1.0
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
            time, acceleration = read_record(folder / self.file)
        else:
            time = np.array(self.time, np.float64)
            horizontal = np.array(self.acceleration, np.float64)
            vertical = np.zeros(len(time)) if self.vertical is None else np.array(self.vertical)
            acceleration = np.stack([horizontal, vertical], axis=1)
        return GROUND_MOTIONS[self.acts](Accelerogram(time, self.scale * acceleration))


class ReferenceTable(Table):
    """A displacement that is known from elsewhere, to compare a run with."""

    point: StrictStr
    """Measured point that it is known for."""
    displacement: Two
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
    critdis: Positive | None = None
    """Edges are lengthened by this in contact detection, m; half of max_displacement if absent."""
    fixed_point_stiffness: Positive | None = None
    """Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent."""

    def chosen(self, key: str) -> Chosen:
        """Return the choice of a key."""
        value = getattr(self, key)
        return value if isinstance(value, Chosen) else Choice(key, ALTERNATIVES).validate(value)

    def build(self, key: str, **provided: Any) -> Any:
        """Return the object that a key chooses."""
        return self.chosen(key).build(**provided)

    def method(
        self, model: Model, *, step: float, max_displacement: float, dynamic_ratio: float = 1.0
    ) -> Method:
        """Return how to simulate; what the table leaves open follows from the model."""
        from clast.interfaces import Method
        from clast.kinematics.first_order import FirstOrder

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
            critdis=self.critdis or CRITDIS_SHARE * max_displacement,
            max_displacement=max_displacement,
            dynamic_ratio=dynamic_ratio,
            notes=notes,
        )


class OutputTable(Table):
    """What to keep of a run."""

    every: Positive | None = None
    """Time between frames, s; a hundredth of the run if absent."""
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
    gravity: Two = (0.0, -9.8)
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
        case = cls._validated(content, file)
        case._text = None if settings else text
        return case

    @classmethod
    def _validated(cls, content: dict[str, Any], file: str) -> Case:
        """Return the case with a content; its faults become one CaseError."""
        try:
            case = cls.model_validate(content)
        except ValidationError as error:
            faults = faults_of(error, explained_case())
            raise case_error(faults, file=file, content=content) from None
        case._file = file
        return case

    def with_method(self, **choices: Any) -> Case:
        """Return the case with other choices in [method]: names, or tables with their numbers.

        ``case.with_method(process="convex", contact_law={"name": "penalty"})``
        """
        content = self.model_dump(by_alias=True, exclude_unset=True)
        content["method"] = {**content.get("method", {}), **choices}
        return self._validated(content, self._file)

    @property
    def name(self) -> str:
        """Name of the case: its file without the ending."""
        return Path(self._file).stem

    @property
    def text(self) -> str:
        """The case as a TOML text: the file's own, or written anew where values were set."""
        return self.to_toml() if self._text is None else self._text

    def to_toml(self) -> str:
        """Return the case as a TOML text, with what differs from the defaults."""
        content = self.model_dump(by_alias=True, exclude_unset=True)
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
        try:
            self._add_materials(builder)
            self._add_blocks(builder)
            self._add_points(builder)
            return builder.build()
        except ModelError as error:
            where = f"{self._file}: {error.where}"
            raise ModelError(error.what, where=where, remedy=error.remedy) from None

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

    def schedule(self) -> Schedule:
        """Return when to simulate and when to keep a frame."""
        from clast.simulate import Schedule

        return Schedule(
            step=self.time.step,
            end=self.time.end,
            every=self.output.every or self.time.end / FRAMES,
            smallest_step=self.time.smallest_step,
        )

    def run(
        self,
        *,
        progress: bool | Callable[[Progress], None] = False,
        output: str | Path | None = None,
    ) -> Run:
        """Simulate the case and return its results.

        ``progress`` is True for a line on the terminal, or a function to call after every step;
        ``output`` is the result file to write.  Raises RunStopped, with the partial results in
        its ``run``, where the run cannot go on.
        """
        # A bad case is refused before anything slow is loaded and anything is written.
        model = self.model()
        method = self.method(model)

        from clast.progress import shown
        from clast.results import RunRecorder
        from clast.sanity import examine
        from clast.simulate import simulate

        schedule = self.schedule()
        warnings = examine(model, method, schedule).warnings
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
