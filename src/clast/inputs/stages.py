"""[[stage]]: the parts of a run, one after the other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StrictBool, StrictInt, StrictStr, model_validator
from pydantic_core import PydanticCustomError

from clast.errors import CaseError, shortened
from clast.inputs.damping import DAMPINGS, Damping, chosen_damping
from clast.inputs.declaring.choices import Number, class_at, within
from clast.inputs.declaring.faults import Fault, refusal
from clast.inputs.declaring.table import Interval, Positive, Strength, Table
from clast.model import ranges
from clast.model.stages.stage import Stage


class StrengthTable(Table):
    """Strengths of a joint from a stage on; what is left out stays."""

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Coulomb friction angle, degrees."""
    cohesion: Strength | None = None
    """Cohesion of bonds that are whole, Pa."""
    tensile_strength: Strength | None = None
    """Tension cut-off of bonds that are whole, Pa."""
    residual_cohesion: Strength | None = None
    """Cohesion of bonds that have slipped, Pa."""

    @model_validator(mode="after")
    def _changes_something(self) -> Self:
        if not self.model_fields_set:
            remedy = (
                "give friction_angle or a strength, cohesion for example, or leave the joint out"
            )
            raise refusal(Fault(what="says nothing of the joint", remedy=remedy))
        return self


class StageTable(Table):
    """A part of the run: what is done when it begins, how it is simulated, and when it ends."""

    name: StrictStr
    """Name."""
    until: Literal["equilibrium", "time"] = "equilibrium"
    """Lasts until the blocks are in equilibrium, or until its time is over."""
    time: Annotated[Positive, within(ranges.INTERVAL)] | None = None
    """Length of the stage, s, or its limit if it lasts until equilibrium; time.end if absent."""
    damping: Damping | None = None
    """Damping of the stage: a name, or a table with its numbers; as without stages if absent."""
    dynamic_ratio: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None
    """Share of velocity carried to the next step: 0 static, 1 dynamic; time.dynamic_ratio if
    absent."""
    force_ratio: Annotated[Number, Field(gt=0.0, le=1.0)] = 1e-4
    """Unbalanced force on a block, as a share of all forces on it, that is none in equilibrium."""
    speed: Annotated[Positive, within(ranges.FACTOR)] = 1e-6
    """Speed of a block, as a share of sqrt(g x its size), that is none in equilibrium."""
    hold: Annotated[StrictInt, Field(ge=1, le=1_000_000)] = 20
    """Steps in a row in which that holds."""
    reset_displacement: StrictBool = False
    """True: displacements count from the end of the stage; positions stay as they are."""
    step: Interval | None = None
    """Length of a step, s; time.step if absent."""
    every: Interval | None = None
    """Time between frames, s; output.every if absent."""
    excavate: list[StrictStr] = Field([])
    """Openings and blocks that are taken out at its start."""
    relax: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.0
    """Share of the support forces of what is taken out that is released at once."""
    relax_time: Annotated[Number, Field(ge=0.0), within(ranges.INTERVAL)] = 0.0
    """Time over which the rest is released, s."""
    install: list[StrictStr] = Field([])
    """Bolts that are put in at its start, by their names or kinds."""
    joint: dict[str, StrengthTable] = Field({})
    """Strengths of joints from its start on: {bedding = {friction_angle = 25}}."""
    bonds: Literal["break", "hold"] = "break"
    """Bonds break as forces reach their strength, or hold until a static stage is in balance."""
    loads: list[StrictStr] = Field([])
    """Names of loads, pressures and tables that act from its start on, and not before."""
    ground_motion: StrictBool = False
    """True: [ground_motion] acts in this stage; its record begins with the stage."""

    def stage(self) -> Stage:
        """Return the stage."""
        given = {key: value for key, value in self if key not in ("joint", "damping")}
        for key in ("excavate", "install", "loads"):
            given[key] = tuple(given[key])
        joints = {
            name: {key: value for key, value in strengths if value is not None}
            for name, strengths in self.joint.items()
        }
        damping = None if self.damping is None else chosen_damping(self.damping).build()
        return Stage(**given, joints=joints, damping=damping)


def given_stages(stages: Any) -> tuple[Stage, ...]:
    """Return the stages that a script gives; their damping may be a name or a table, as in a file.

    Raises CaseError for what are no stages, and for a damping that is none.
    """
    if isinstance(stages, str | Stage) or not isinstance(stages, Iterable):
        stages = [stages]
    found = tuple(stages)
    for one in found:
        if not isinstance(one, Stage):
            raise CaseError(
                f"{shortened(repr(one))} is no stage",
                where="stages",
                remedy='give a list of them: stages=[clast.Stage(name="gravity"), ...]',
            )
    return tuple(one if one.damping is None else _with_damping(one) for one in found)


def _with_damping(stage: Stage) -> Stage:
    """Return a stage whose damping is an object."""
    try:
        return replace(stage, damping=chosen_damping(stage.damping).build())
    except PydanticCustomError as error:
        fault: Fault = (error.context or {})["faults"][0]
        where = f"stage '{shortened(str(stage.name))}', damping"
        raise CaseError(fault.what, where=where, remedy=fault.remedy) from None


def stage_keys(stage: Stage) -> dict[str, Any]:
    """Return the keys of the table that makes a stage; those that are as usual are left out."""
    usual = Stage(name=stage.name)
    keys: dict[str, Any] = {"name": stage.name}
    for entry in fields(Stage):
        value = getattr(stage, entry.name)
        if value != getattr(usual, entry.name):
            keys[entry.name] = list(value) if isinstance(value, tuple) else value
    if "joints" in keys:
        joints: Mapping[str, Mapping[str, float]] = keys.pop("joints")
        keys["joint"] = {name: dict(changes) for name, changes in joints.items()}
    if "damping" in keys:
        keys["damping"] = _damping_key(stage)
    return keys


def _damping_key(stage: Stage) -> str | dict[str, Any]:
    """Return name or table of a stage's damping in case files."""
    for name, path in DAMPINGS.items():
        if type(stage.damping) is class_at(path):
            numbers = {
                one.name: getattr(stage.damping, one.name)
                for one in fields(stage.damping)
                if getattr(stage.damping, one.name) != one.default
            }
            return {"name": name, **numbers} if numbers else name
    raise CaseError(
        f"{type(stage.damping).__name__} is an object of a script, which no case file can hold",
        where=f"stage '{stage.name}', damping",
        remedy="run the model itself: clast.simulate(builder.build(), stages=...)",
    )
