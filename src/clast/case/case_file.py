"""The case file, TOML, turned into Model, Method, Schedule and Run.

    run = clast.load("incline.toml").run()

Each group of tables has a file in ``clast.inputs``; ``clast schema`` prints their keys and units.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, get_origin

import numpy as np
from pydantic import (
    BaseModel,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    StrictStr,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from clast import spelling
from clast.errors import CaseError, ClastError, Fault, ModelError, Points, Remark
from clast.inputs.blocks import BlockFileTable, BlockTable, GeometryTable, RepairTable
from clast.inputs.bolts import Bolt, BoltKind, BoltPattern
from clast.inputs.builder import InputBuilder
from clast.inputs.declaring import table as case_writing
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.annotations import annotate, without_null
from clast.inputs.declaring.field_docs import describe
from clast.inputs.declaring.places import located, located_error, remark
from clast.inputs.declaring.table import Acceleration, Share, Table
from clast.inputs.declaring.validation_messages import (
    error_of,
    faults_of,
    keys_of,
    refusals,
    table_in,
)
from clast.inputs.drawpoints import DrawpointTable
from clast.inputs.flow import FlowBoundary, FlowTable, MeasuredFlow, Well
from clast.inputs.ground_motion import GroundMotionTable
from clast.inputs.in_situ import InSituTable
from clast.inputs.joint_sets import JointSetTable
from clast.inputs.linings.linings import Lining
from clast.inputs.loads import Amplitude, FixedPoint, LineLoad, PointLoad, Pressure
from clast.inputs.materials import Joint, Rock
from clast.inputs.measurements import (
    MeasuredContact,
    MeasuredConvergence,
    MeasuredPoint,
    MeasuredReaction,
    Reference,
    point_faults,
)
from clast.inputs.method import Damping, MethodTable, OutputTable, TimeTable, chosen_damping
from clast.inputs.placing import plausibility
from clast.inputs.placing.place_rock_mass import DEFAULT as DEFAULT_JOINT
from clast.inputs.placing.place_rock_mass import CutCase, RockMass
from clast.inputs.placing.place_rockfall import RockfallInputs, blocks_of_model
from clast.inputs.rock_mass import (
    BlockPatternTable,
    DomainTable,
    OpeningTable,
    RegionTable,
    TraceTable,
)
from clast.inputs.rockfall import (
    BarrierTable,
    CollectorTable,
    RockfallTable,
    SourceTable,
    Surface,
)
from clast.inputs.stages import StageTable
from clast.inputs.supports.links import Link, Moment
from clast.inputs.supports.motions import Motion
from clast.inputs.surcharges import Fill, LoadTrain
from clast.inputs.viscous_boundaries import ViscousBoundary
from clast.inputs.water import Water
from clast.model.model import Floats, Model

if TYPE_CHECKING:
    from clast.results import Run
    from clast.results.checkpoints.checkpoint import Source
    from clast.run.preflight import CaseSummary
    from clast.run.schedule import Progress, Schedule
    from clast.step.method import Method
    from clast.trajectory.campaign import Campaign

BLOCKS = {"block", "geometry", "block_file", "domain"}
"""Tables that blocks come from."""
NO_TIME = TimeTable(step=1e-3, end=1.0)
"""The time of a case whose rocks are followed and whose blocks are not run."""
FALLING = ("surface", "source", "barrier", "collector")
"""Tables of rockfall beside [rockfall]."""
NAMING = "file"
"""Key of all tables of a case that names a file beside it."""
FILE = "file"
"""Key of the name of the file in the context of a validation."""
SAME_SYSTEM = frozenset({"schema", "title", "time", "method", "damping", "output", "reference"})
"""Tables and keys that leave the system of blocks, and with it all checks of it, as it is."""


class Case(BaseModel):
    """A case of the discontinuous deformation analysis program clast."""

    model_config = Table.model_config

    schema_: Literal[1] = Field(1, alias="schema")
    """Version of this format."""
    title: StrictStr = ""
    """Title."""
    plane: Literal["stress", "strain"] = "stress"
    """Plane stress or plane strain."""
    gravity: tuple[Acceleration, Acceleration] = (0.0, -9.8)
    """Acceleration of gravity [x, y], m/s2."""
    gravity_amplitude: StrictStr | None = None
    """Amplitude over time by which gravity is multiplied; constant if absent."""
    seismic_coefficient: tuple[Share, Share] = (0.0, 0.0)
    """Pseudo-static force on all blocks [x, y], as a share of their weight; not on water."""
    time: TimeTable
    """Duration and step: [time] with step and end."""
    rock: dict[str, Rock]
    """Rocks by name: [rock.granite] with young, poisson and density."""
    joint: dict[str, Joint] = {}
    """Joint strengths by name: [joint.default] with friction_angle."""
    geometry: GeometryTable | None = None
    """Blocks by numbered vertices."""
    block: list[BlockTable] = []
    """Blocks by their coordinates."""
    block_file: list[BlockFileTable] = []
    """Blocks of files beside the case file."""
    repair: RepairTable | None = None
    """Repair of blocks that were drawn slightly apart."""
    domain: DomainTable | None = None
    """Rock mass that is cut into blocks."""
    joint_set: list[JointSetTable] = []
    """Joints that cut the domain, by statistics."""
    trace: list[TraceTable] = []
    """Joints that cut the domain, as mapped."""
    opening: list[OpeningTable] = []
    """Openings in the domain, and blocks that are excavated together."""
    region: list[RegionTable] = []
    """Regions of the domain with another rock."""
    block_pattern: list[BlockPatternTable] = []
    """Masonry in the domain."""
    amplitude: dict[str, Amplitude] = {}
    """Factors of loads over time by name: [amplitude.ramp] with time and value."""
    fixed_point: list[FixedPoint] = []
    """Points held in place."""
    point_load: list[PointLoad] = []
    """Forces at points."""
    line_load: list[LineLoad] = []
    """Tractions along lines."""
    pressure: list[Pressure] = []
    """Pressures on edges."""
    fill: list[Fill] = []
    """Fill that rests on blocks."""
    load_train: list[LoadTrain] = []
    """Axles on paths over the blocks."""
    motion: list[Motion] = []
    """Prescribed motions of blocks: settlements, presses, driven walls."""
    link: list[Link] = []
    """Links between blocks at points: hinges, sliders, springs."""
    lining: list[Lining] = []
    """Linings: shotcrete, rings, arches of steel."""
    moment: list[Moment] = []
    """Moments on blocks."""
    bolt_kind: dict[str, BoltKind] = {}
    """Kinds of rock bolts by name: [bolt_kind.NAME] with stiffness and yield_force."""
    bolt: list[Bolt] = []
    """Rock bolts."""
    bolt_pattern: list[BoltPattern] = []
    """Rock bolts round openings."""
    water: list[Water] = []
    """Water on outer faces and in joints."""
    flow: FlowTable | None = None
    """Water that flows in joints."""
    flow_boundary: list[FlowBoundary] = []
    """Heads, pressures, rain and faces in air for the flow."""
    well: list[Well] = []
    """Wells and drains of the flow."""
    measured_flow: list[MeasuredFlow] = []
    """Flows recorded every step."""
    viscous_boundary: list[ViscousBoundary] = []
    """Absorbing (viscous) outer edges."""
    in_situ: InSituTable | None = None
    """Stress in the rock before excavation."""
    ground_motion: GroundMotionTable | None = None
    """Earthquake or shaking table."""
    measured_point: list[MeasuredPoint] = []
    """Points recorded every step."""
    measured_convergence: list[MeasuredConvergence] = []
    """Pairs of measured points whose approach is recorded every step."""
    measured_contact: list[MeasuredContact] = []
    """Contacts recorded every step."""
    measured_reaction: list[MeasuredReaction] = []
    """Reactions of supports recorded every step, beside the totals."""
    drawpoint: list[DrawpointTable] = []
    """Lines past which blocks leave while the run goes on."""
    rockfall: RockfallTable | None = None
    """Profile that rocks fall on; clast rockfall follows them."""
    surface: dict[str, Surface] = {}
    """Surfaces of the profile by name: [surface.NAME] with normal_restitution."""
    source: list[SourceTable] = []
    """Rocks that fall, by where they start."""
    barrier: list[BarrierTable] = []
    """Barriers on the profile."""
    collector: list[CollectorTable] = []
    """Places at which passing rocks are measured."""
    reference: list[Reference] = []
    """Known displacements; clast run and clast compare print the error."""
    stage: list[StageTable] = []
    """Stages of the run, in order."""
    damping: Damping = "none"
    """Damping, which takes energy from all blocks: "none", "adaptive", "kinetic", or a table:
    [damping] with mass and stiffness is Rayleigh's."""
    method_: MethodTable = Field(default_factory=MethodTable, alias="method")
    """Numerical method."""
    output: OutputTable = Field(default_factory=OutputTable)
    """Interval and content of frames."""

    _file: str = PrivateAttr("case")
    _text: str | None = PrivateAttr(None)
    _origin: str | None = PrivateAttr(None)
    _cut: CutCase | None = PrivateAttr(None)

    @model_validator(mode="before")
    @classmethod
    def _rocks_need_no_blocks(cls, content: Any) -> Any:
        """Let a case that has rockfall leave out what runs of blocks need."""
        if isinstance(content, dict) and "rockfall" in content:
            without = (
                {"time": NO_TIME} if BLOCKS & content.keys() else {"time": NO_TIME, "rock": {}}
            )
            return {**without, **content}
        return content

    @model_validator(mode="after")
    def _time_is_given(self) -> Self:
        if self.time is NO_TIME:
            self.model_fields_set.discard("time")
        return self

    @model_validator(mode="after")
    def _rocks_have_a_profile(self) -> Self:
        given = [key for key in FALLING if getattr(self, key)]
        if self.rockfall is None and given:
            what, remedy = "there is no [rockfall]", "give it, with the profile that rocks fall on"
            raise refusals([Fault(what, remedy, (key,)) for key in given])
        return self

    @model_validator(mode="after")
    def _references_have_points(self) -> Self:
        faults = list(point_faults(self.measured_point, self.reference, self.measured_convergence))
        if faults:
            raise refusals(faults)
        return self

    @model_validator(mode="after")
    def _rock_mass_is_whole(self) -> Self:
        rock_mass = self._rock_mass
        if rock_mass is not None:
            faults = list(rock_mass.faults())
        else:
            lists = {key: getattr(self, key) for key in ("joint_set", "trace")}
            lists["opening"] = [one for one in self.opening if not one.blocks]
            lists |= {key: getattr(self, key) for key in ("region", "block_pattern")}
            what, remedy = "there is no [domain] to cut", "give [domain] with its boundary"
            faults = [
                Fault(what, remedy, (key, getattr(self, key).index(tables[0])))
                for key, tables in lists.items()
                if tables
            ]
        if faults:
            raise refusals(faults)
        return self

    @model_validator(mode="after")
    def _stages_are_known(self) -> Self:
        stages = [one.name for one in self.stage]
        given = [
            ((key, number, "stage"), one.stage)
            for key in ("bolt", "bolt_pattern", "motion", "link", "lining", "well")
            for number, one in enumerate(getattr(self, key))
            if one.stage is not None
        ]
        given += [
            (("motion", number, "until"), one.until)
            for number, one in enumerate(self.motion)
            if isinstance(one.until, str)
        ]
        faults = [
            Fault(f"there is no stage '{name}'", spelling.advice(name, stages, kind="stage"), place)
            for place, name in given
            if name not in stages
        ]
        if faults:
            raise refusals(faults)
        return self

    @model_validator(mode="wrap")
    @classmethod
    def _in_words(
        cls, content: Any, validate: ModelWrapValidatorHandler[Self], info: ValidationInfo
    ) -> Self:
        """Make one CaseError of the faults that pydantic finds, whoever asks for the case."""
        try:
            return validate(content)
        except ValidationError as error:
            tables = content if isinstance(content, dict) else {}
            known = explained(cls)
            faults = [located(one, "", tables, known) for one in faults_of(error, known)]
            file = (info.context or {}).get(FILE, "case")
            raise error_of(faults, file=file, content=tables) from None

    @classmethod
    def from_toml(cls, source: str | Path, settings: Iterable[str] = ()) -> Case:
        """Return the case in a file, or in a TOML text (a ``str`` of several lines).

        ``settings`` such as ``"time.end=2"`` replace single values.  References belong to the
        system as the file has it: settings that change it, such as
        ``"joint.default.friction_angle=30"``, leave them out unless they set them too.  Raises
        CaseError naming file, table, key and remedy.
        """
        is_text = isinstance(source, str) and "\n" in source
        file = "case" if is_text else str(source)
        text = str(source) if is_text else case_text.read_text(Path(source))
        return cls.from_text(text, file, settings)

    @classmethod
    def from_text(cls, text: str, file: str, settings: Iterable[str] = ()) -> Case:
        """Return the case of a TOML text as if it stood in ``file``; else as ``from_toml``."""
        settings = list(settings)
        content = case_text.parse(text, file)
        if settings:
            content = case_text.with_values(content, settings)
            tables = {setting.replace("=", ".").split(".")[0].strip() for setting in settings}
            if tables - SAME_SYSTEM and "reference" not in tables:
                content.pop("reference", None)
        case = cls.validated(content, file)
        case._text = None if settings else text
        case._origin = text
        return case

    @classmethod
    def validated(cls, content: dict[str, Any], file: str) -> Case:
        """Return the case with a content from ``file``; its faults become one CaseError."""
        case = cls.model_validate(content, context={FILE: file})
        case._file = file
        return case

    def with_method(self, **choices: Any) -> Case:
        """Return the case with other choices in [method]: names, tables with numbers, objects.

        ``case.with_method(process="convex", contact_law={"name": "penalty"})``.  An object of a
        script, ``contact_law=MyLaw()``, may be in the place of a name; only a file cannot hold it.
        """
        return self.with_(method=choices)

    def with_(self, **tables: Any) -> Case:
        """Return the case with other values: ``case.with_(time={"end": 2.0}, plane="strain")``.

        Keys of a table that are not given stay, as do rocks, joints and the like of other names;
        lists are replaced.  References go where the system of blocks changes.  Raises CaseError.
        """
        content = self._content()
        kinds = {one.alias or key: one.annotation for key, one in Case.model_fields.items()}
        for key, value in tables.items():
            named = get_origin(kinds.get(key)) is dict
            depth = 0 if table_in(kinds.get(key)) is None else 1 + named
            content[key] = _merged(content.get(key), case_writing.as_plain(value), depth)
        if tables.keys() - SAME_SYSTEM and "reference" not in tables:
            content.pop("reference", None)
        return self.validated(content, self._file).cut_as(self)

    def cut_as(self, other: Case) -> Self:
        """Return the case; where its rock mass is that of another, it is not cut again."""
        if self._rock_mass == other._rock_mass:
            self._cut = other._cut
        return self

    @property
    def name(self) -> str:
        """Name of the case: its file without the ending."""
        return Path(self._file).stem

    @property
    def text(self) -> str:
        """The case as a TOML text: the file's own, or written anew; objects appear as texts."""
        if self._text is not None:
            return self._text
        return self._written(lambda value, where: repr(value))

    def to_toml(self) -> str:
        """Return the case as a TOML text, without values that are defaults."""
        return self._written(case_writing.refuse_object)

    def _written(self, instead: case_writing.Instead) -> str:
        content = self._content()
        return case_text.to_toml({"schema": 1, **case_writing.without_objects(content, instead)})

    def model(self) -> Model:
        """Return the system of blocks; raises ModelError naming the place and the remedy."""
        if self.rockfall is not None and not self.has_blocks:
            raise ModelError(
                "has rocks that fall, but no blocks",
                where=self._file,
                remedy=f"follow its rocks: clast rockfall {self._file}",
            )
        builder = InputBuilder(
            self.title, self.plane, self.gravity, self.gravity_amplitude, self.seismic_coefficient
        )
        with self._located():
            folder = self._folder
            for name, table in self._tables():
                table.add_to(builder, name, folder)
            if self.domain is not None:
                cut = self.cut()
                cut.check_room(self.block)
                cut.add_to(builder)
            model = builder.build()
            if self.block_file and DEFAULT_JOINT not in self.joint:
                plausibility.refuse_unnamed_faces(model)
        vars(model)["made_by"] = self
        return model

    @property
    def has_blocks(self) -> bool:
        """Whether the case has blocks, or a rock mass that is cut into blocks."""
        return any(getattr(self, key) for key in BLOCKS)

    def campaign(self) -> Campaign:
        """Return the rocks that fall on the profile; raises CaseError where there is none."""
        if self.rockfall is None:
            what, remedy = "has no [rockfall]", "give it: the profile that rocks fall on"
            raise CaseError(what, where=self._file, remedy=remedy)
        inputs = RockfallInputs(
            table=self.rockfall,
            surfaces=self.surface,
            sources=self.source,
            barriers=self.barrier,
            collectors=self.collector,
            blocks=blocks_of_model(self.model()) if self.has_blocks else None,
            gravity=self.gravity,
            folder=self._folder,
        )
        with self._located():
            return inputs.campaign()

    def lines(self) -> Floats:
        """Return both ends of all lines that cut [domain], m, shape (n, 2, 2); raises ModelError.

        There are none where the case has all its blocks.
        """
        if self._rock_mass is None:
            return np.zeros((0, 2, 2))
        with self._located():
            return self._rock_mass.lines(self._folder)

    def cut(self) -> CutCase:
        """Return the blocks that [domain] is cut into, the same ones every time."""
        if self._cut is None:
            with self._located():
                rock_mass = self._rock_mass
                if rock_mass is None:
                    what = "is missing, so there is nothing to cut"
                    remedy = "give it with a boundary, and [[joint_set]] that cut it"
                    raise ModelError(what, where="[domain]", remedy=remedy)
                self._cut = rock_mass.cut(self._folder)
        return self._cut

    @property
    def _rock_mass(self) -> RockMass | None:
        """The domain and the lines that cut it; None where the case has all its blocks."""
        if self.domain is None:
            return None
        return RockMass(
            domain=self.domain,
            joint_sets=self.joint_set,
            traces=self.trace,
            openings=[one for one in self.opening if not one.blocks],
            regions=self.region,
            patterns=self.block_pattern,
            rocks=list(self.rock),
            joints=list(self.joint),
        )

    def _tables(self) -> Iterator[tuple[str, Table]]:
        """Give all tables in the order of the keys above, with their names or those of the keys."""
        for key, value in self:
            tables = value if isinstance(value, list) else [value]
            named = value.items() if isinstance(value, dict) else ((key, one) for one in tables)
            yield from ((name, one) for name, one in named if isinstance(one, Table))

    @property
    def file(self) -> str:
        """The file of the case, or another name for it in messages."""
        return self._file

    @property
    def origin(self) -> str | None:
        """The text that was read, before any settings; None where the case was made."""
        return self._origin

    @property
    def _folder(self) -> Path:
        """Where the file is, and files that it names."""
        return Path(self._file).parent

    def method(self, model: Model | None = None) -> Method:
        """Return the method of the run; options left out of the case follow from its model."""
        model = model or self.model()
        method = self.method_.method(
            model,
            # an automatic stiffness is for the longest step of the run
            step=max([self.time.step, *(one.step for one in self.stage if one.step)]),
            max_displacement=self.time.largest_movement(model),
            dynamic_ratio=self.time.dynamic_ratio,
        )
        return dataclasses.replace(method, damping=chosen_damping(self.damping).build())

    def examine(self, model: Model | None = None) -> CaseSummary:
        """Return a summary of the case and its model, with warnings of anything unsound."""
        model = model or self.model()
        summary = self._examined(model, self.method(model))
        warnings = (*summary.warnings, *self._remarks(self._not_compared(), model))
        return dataclasses.replace(summary, warnings=warnings)

    def foreseen(self, model: Model, method: Method) -> tuple[str, ...]:
        """Return the warnings known before the first step of a run."""
        return self._examined(model, method).warnings

    def _examined(self, model: Model, method: Method) -> CaseSummary:
        """Return a summary of the case, with the warnings of its run."""
        from clast.run.preflight import examine

        schedule = self.schedule()
        with self._located():
            summary = examine(model, method, schedule)
        remarks = [text for _, table in self._tables() for text in table.remarks(self._folder)]
        cut = self._cut.warnings if self._cut else ()
        doubts = plausibility.doubts(self.bolt_kind, self.in_situ, model, schedule.stages)
        warnings = (*summary.warnings, *cut, *remarks, *doubts)
        return dataclasses.replace(
            summary,
            warnings=self._remarks(warnings, model),
            notes=self._remarks(summary.notes, model),
        )

    def _remarks(self, texts: Iterable[str], model: Model) -> tuple[Remark, ...]:
        """Return warnings or notes with their places in the file and in the section."""

        def outline(name: str) -> Points:
            if name not in model.block_name:
                return ()
            block = model.block_name.index(name)
            corners = slice(*model.block_start[block : block + 2])
            return tuple(map(tuple, (model.vertices[corners] + model.origin).tolist()))

        content = self._content()
        return tuple(remark(text, content, type(self), outline) for text in texts)

    def _content(self) -> dict[str, Any]:
        """Return the values that the case gives, by their keys."""
        return self.model_dump(by_alias=True, exclude_unset=True)

    def _not_compared(self) -> Iterator[str]:
        """Say which references the run does not reach; the run itself says so at its end."""
        end = self.schedule().latest
        for number, reference in enumerate(self.reference, start=1):
            if reference.time is not None and reference.time > end:
                yield (
                    f"[[reference]] {number} is for {reference.time:g} s, but the run ends at "
                    f"{end:g} s: it is not compared. Raise time.end, or lower its time"
                )

    @contextmanager
    def _located(self) -> Iterator[None]:
        """Name the file in the errors of its model."""
        try:
            yield
        except ModelError as error:
            if f"{error.where}: ".startswith(f"{self._file}: "):
                raise
            faults = located_error(error, self._content(), type(self))
            where = ": ".join(filter(None, (self._file, error.where)))
            raise ModelError(error.what, where=where, remedy=error.remedy, faults=faults) from None

    def schedule(self) -> Schedule:
        """Return when to simulate and when to keep a frame."""
        from clast.run.schedule import Schedule

        if "time" not in self.model_fields_set:
            remedy = "give it with step and end; clast rockfall needs none"
            raise CaseError("is missing", where=f"{self._file}: [time]", remedy=remedy)
        with self._located():
            stages = tuple(table.stage() for table in self.stage)
        schedule = Schedule(
            step=self.time.step,
            end=self.time.end,
            every=self.time.step,
            smallest_step=self.time.smallest_step,
            stages=stages,
        )
        every = self.output.interval(self.time.step, schedule.latest)
        return dataclasses.replace(schedule, every=every)

    def run(
        self,
        *,
        progress: bool | Callable[[Progress], None] = False,
        output: str | Path | None = None,
        warn: Callable[[str], None] | None = None,
    ) -> Run:
        """Simulate the case and return its results.

        ``progress`` is True for a line on the terminal, or a function to call after every step;
        ``output`` is the result file to write.  ``warn`` is called once with each warning, before
        the first step or after the last; without it they are Python warnings, of the category
        ``clast.RunWarning``.  Raises RunStopped, with its partial ``run``, where it cannot go on.
        """
        # A bad case is refused before anything slow is loaded and anything is written.
        model = self.model()
        method = self.method(model)
        from clast.run.launch import Launch, Target, launch

        schedule, path = self.schedule(), None if output is None else Path(output)
        what = Launch(
            model=model,
            method=method,
            schedule=schedule,
            foreseen=lambda: self.foreseen(model, method),
            source=lambda: self._source(model, method, schedule),
            target=lambda say: Target(output=path),
            case_text=self.text,
            contacts=self.output.contacts,
            checkpoint_every=self.output.checkpoint_every,
        )
        return launch(what, progress, warn)

    def is_whole(self) -> bool:
        """Return whether a text can hold all of the case."""
        try:
            self.to_toml()
        except CaseError:
            return False
        return True

    def named_files(self) -> list[str]:
        """Return the files that the case names, each once."""

        def named(value: Any, key: str) -> Iterator[str]:
            if isinstance(value, dict):
                for name, inner in value.items():
                    yield from named(inner, str(name))
            elif isinstance(value, list | tuple):
                for inner in value:
                    yield from named(inner, key)
            elif isinstance(value, str) and key == NAMING:
                yield value

        return list(dict.fromkeys(named(self.model_dump(by_alias=True), "")))

    def _source(self, model: Model, method: Method, schedule: Schedule) -> Source:
        """Return where a run of the case comes from, as its checkpoints say."""
        from clast.results.checkpoints.checkpoint import OBJECTS, TEXT, Source
        from clast.results.checkpoints.fingerprints import (
            fingerprints,
            print_of_named,
            print_of_text,
        )

        folder = Path(self.file).parent
        return Source(
            text=self.text,
            gives=TEXT if self.is_whole() else OBJECTS,
            file=str(Path(self.file).absolute()),
            file_text="" if self.origin is None else print_of_text(self.origin),
            files={name: print_of_named(folder / name) for name in self.named_files()},
            schedule=schedule,
            fingerprints=fingerprints(model=model, method=method),
        )

    def _repr_html_(self) -> str:
        from clast import thumbnails

        chosen = self.method_.chosen
        rows: list[tuple[str, object]] = [
            ("process", chosen("process").name),
            ("contact law", chosen("contact_law").name),
            ("step", f"{self.time.step:.6g} s"),
            ("end", f"{self.time.end:.6g} s"),
            ("stages", ", ".join(stage.name for stage in self.stage) or "none"),
        ]
        drawing = ""
        try:
            model = self.model()
            drawing = thumbnails.blocks(model.vertices, model.block_start, model.fixed)
            rows.insert(0, ("blocks", f"{model.block_count} ({int(model.fixed.sum())} fixed)"))
        except ClastError as error:
            rows.append(("cannot be built", str(error)))
        return thumbnails.side_by_side(self.title or self.name, drawing, rows)

    def __repr__(self) -> str:
        numbered = len(self.geometry.blocks) if self.geometry else 0
        chosen = self.method_.chosen
        return (
            f"Case('{self.title or self.name}', {numbered + len(self.block)} blocks"
            f"{', and those of a domain' if self.domain else ''}, "
            f"{chosen('process').name} with {chosen('contact_law').name}, "
            f"step {self.time.step:g} s to {self.time.end:g} s)"
        )

    __str__ = __repr__


def _merged(old: Any, new: Any, depth: int) -> Any:
    """Return a value with the keys of another, so many tables deep."""
    if not (depth and isinstance(old, dict) and isinstance(new, dict)):
        return new
    return {**old, **{key: _merged(old.get(key), one, depth - 1) for key, one in new.items()}}


def load(path: str | Path) -> Case:
    """Return the case in a file; raises CaseError naming file, table, key and remedy."""
    return Case.from_toml(Path(path))


@cache
def explained(case: type[Case]) -> type[Case]:
    """Return Case, or a class made of it, with the meanings of all keys of all tables."""
    tables: list[type[BaseModel]] = [*_tables_below(Table), case]  # inner tables come first
    keys = frozenset(keys_of(case))
    for table in tables:
        describe(table)
        annotate(table, keys)
        table.model_rebuild(force=True)
    return case


def _tables_below(kind: type[Table]) -> Iterator[type[Table]]:
    """Give all tables that are made of one, in the order in which they were."""
    for table in kind.__subclasses__():
        yield table
        yield from _tables_below(table)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of the case file."""
    schema = without_null(explained(Case).model_json_schema(by_alias=True))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
