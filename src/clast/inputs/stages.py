"""[[stage]]: the parts of a run, one after the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, StrictBool, StrictInt, StrictStr, ValidationError, model_validator

from clast.errors import CaseError, shortened
from clast.inputs.declaring.alternatives import Number, default_of, within
from clast.inputs.declaring.annotations import ANY, RefersTo
from clast.inputs.declaring.field_docs import explain
from clast.inputs.declaring.table import (
    OR_TABLE,
    Fraction,
    Interval,
    Positive,
    Strength,
    Table,
    as_plain,
)
from clast.inputs.declaring.validation_messages import faults_of, keys_text, refusal
from clast.inputs.flow import FlowValue
from clast.inputs.method import Damping, chosen_damping
from clast.model import ranges
from clast.model.stages import Stage

Excavated = Annotated[StrictStr, RefersTo("opening", "block")]
LOADS = "point_load", "line_load", "pressure", "fill", "load_train", "water", "amplitude"
LoadName = Annotated[StrictStr, RefersTo(*LOADS)]


class StrengthTable(Table):
    """Strengths of a joint from a stage on; those left out do not change."""

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Coulomb friction angle, degrees."""
    cohesion: Strength | None = None
    """Cohesion of intact bonds, Pa."""
    tensile_strength: Strength | None = None
    """Tension cut-off of intact bonds, Pa."""
    residual_cohesion: Strength | None = None
    """Cohesion of bonds that have slipped, Pa."""
    residual_friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Friction angle after sliding, degrees."""
    kinetic_friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Kinetic friction angle, degrees."""
    dilation_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Angle at which the joint opens from then on, degrees."""
    strength_reduction: Annotated[Positive, within(ranges.FACTOR)] | None = None
    """Factor that the tangent of the friction angle of a rough joint is divided by."""

    TYPICAL: ClassVar = {"friction_angle": (0.0, 60.0)}

    @model_validator(mode="after")
    def _changes_something(self) -> Self:
        if not self.model_fields_set:
            remedy = "give friction_angle or a strength such as cohesion, or leave the joint out"
            raise refusal("changes nothing of the joint", remedy)
        return self


class FlowOfStage(Table):
    """The flow in joints from a stage on."""

    state: Literal["steady", "transient"]
    """Steady flow, or flow that takes time and goes on from what there is."""


class StageTable(Table):
    """A stage of the run: changes at its start, its method, and its end."""

    name: StrictStr
    """Name."""
    until: Literal["equilibrium", "time"] = "equilibrium"
    """Lasts until the blocks are in equilibrium, or until its time is over."""
    time: Annotated[Positive, within(ranges.INTERVAL)] | None = None
    """Length of the stage, s, or its limit if it lasts until equilibrium; time.end if absent."""
    damping: Damping | None = None
    """Damping of the stage: a name, or a table with its numbers; that of the case if absent."""
    dynamic_ratio: Fraction | None = None
    """Share of velocity carried to the next step: 0 static, 1 dynamic; time.dynamic_ratio if
    absent."""
    force_ratio: Annotated[Number, Field(gt=0.0, le=1.0)] = 1e-4
    """Largest unbalanced force on a block in equilibrium, as a share of all forces on it."""
    speed: Annotated[Positive, within(ranges.FACTOR)] = 1e-6
    """Largest speed of a block in equilibrium, as a share of sqrt(g x its size)."""
    hold: Annotated[StrictInt, Field(ge=1, le=1_000_000)] = 20
    """Consecutive steps in which that holds."""
    reset_displacement: StrictBool = False
    """True: displacements are reset at the end of the stage; positions do not change."""
    step: Interval | None = None
    """Length of a step, s; time.step if absent."""
    every: Interval | None = None
    """Time between frames, s; output.every if absent."""
    excavate: list[Excavated] = Field([])
    """Openings and blocks that are excavated at its start."""
    relax: Fraction = 1.0
    """Share of the support forces released by the stage that ends at once."""
    relax_time: Annotated[Number, Field(ge=0.0), within(ranges.INTERVAL)] = 0.0
    """Time over which the rest of the released forces ends, s."""
    release: Annotated[Fraction | dict[Excavated, Fraction], OR_TABLE] = Field({})
    """Share of the support forces of excavated blocks that is released by now, 0 to 1; all of it if
    absent.  A later stage releases the rest: {heading = 1.0}."""
    install: list[Annotated[StrictStr, RefersTo("bolt", "bolt_kind", "bolt_pattern")]] = Field([])
    """Bolts that are installed at its start, by their names or kinds."""
    joint: dict[str, StrengthTable] = Field({})
    """Strengths of joints from its start on: {bedding = {friction_angle = 25}}."""
    bonds: Literal["break", "hold"] = "break"
    """Bonds break as forces reach their strength, or hold until a static stage is in balance."""
    jacks: Literal["lock", "hold"] = "lock"
    """The jacks of bolts that are there come off at its start, or stay on and hold their force."""
    loads: list[LoadName] = Field([])
    """Names of loads, pressures and amplitudes that act from its start on, and not before."""
    flow: FlowOfStage | None = None
    """The flow from its start on: {state = "transient"}; as before if absent."""
    flow_boundary: dict[str, FlowValue] = Field({})
    """Boundaries of the flow from its start on: {lake = {head = 40}}."""
    ground_motion: StrictBool = False
    """True: [ground_motion] acts in this stage; its record begins with the stage."""

    WHEN: ClassVar = {
        "until": {"equilibrium": ("force_ratio", "speed", "hold")},
        "excavate": {ANY: ("relax", "relax_time")},
    }
    BASIC: ClassVar = ("until", "time", "excavate", "install", "loads")
    RARE: ClassVar = ("force_ratio", "speed", "hold", "jacks", "bonds")

    @model_validator(mode="after")
    def _releases_what_it_excavates(self) -> Self:
        if not isinstance(self.release, dict) and not self.excavate:
            what = "a number is meant for what the stage excavates, and it excavates nothing"
            remedy = "name what was excavated before: release = {heading = 1.0}"
            raise refusal(what, remedy, "release")
        return self

    def stage(self) -> Stage:
        """Return the stage."""
        given = {key: value for key, value in self if key not in ("joint", "damping")}
        given["flow"] = dict(self.flow or ())
        given["flow_boundary"] = {
            name: {key: float(value) for key, value in one if value is not None}
            for name, one in self.flow_boundary.items()
        }
        for key in ("excavate", "install", "loads"):
            given[key] = tuple(given[key])
        if not isinstance(self.release, dict):
            given["release"] = dict.fromkeys(self.excavate, self.release)
        joints = {
            name: {key: value for key, value in strengths if value is not None}
            for name, strengths in self.joint.items()
        }
        damping = None if self.damping is None else chosen_damping(self.damping).build()
        return Stage(**given, joints=joints, damping=damping)


def given_stages(stages: Any) -> tuple[Stage, ...]:
    """Return the stages that a script gives; their damping may be a name or a table."""
    if isinstance(stages, str | Stage) or not isinstance(stages, Iterable):
        stages = [stages]
    listed = tuple(stages)
    for one in listed:
        if not isinstance(one, Stage):
            remedy = 'give a list of them: stages=[clast.Stage(name="gravity"), ...]'
            raise CaseError(f"{shortened(repr(one))} is not a stage", where="stages", remedy=remedy)
    return tuple(_table(one).stage() for one in listed)


def _table(stage: Stage) -> StageTable:
    """Return the table of a stage of a script; raises CaseError in the words of a case file."""
    keys = stage_keys(stage)
    try:
        return StageTable.model_validate(keys)
    except ValidationError as error:
        explain(StageTable)
        fault = faults_of(error, StageTable)[0]
        where = f"stage '{shortened(str(stage.name))}', {keys_text(fault.place)}"
        raise CaseError(fault.what, where=where, remedy=fault.remedy) from None


def stage_keys(stage: Stage) -> dict[str, Any]:
    """Return the keys of the table that makes a stage; those that are as usual are left out."""
    keys = {one.name: as_plain(getattr(stage, one.name)) for one in fields(Stage)}
    usual = {one.name: as_plain(default_of(one)) for one in fields(Stage)}
    return {
        "joint" if key == "joints" else key: value
        for key, value in keys.items()
        if value != usual[key]
    }
