"""Stages of a run: changes at their start, their end, their loads and strengths of joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from clast.model.factors import NO_FACTOR, Factor
from clast.model.flow.given import Flow, with_changes
from clast.model.joints import Joint, JointTable
from clast.model.model import Model
from clast.model.water import Water

EQUILIBRIUM, TIME = "equilibrium", "time"
"""The conditions that may end a stage."""
BREAK, HOLD = "break", "hold"
"""The behaviour of bonds of joints in a stage."""
LOCK = "lock"
"""The behaviour of jacks at the start of a stage; or they hold."""
STRENGTHS = (
    "friction_angle",
    "cohesion",
    "tensile_strength",
    "residual_cohesion",
    "residual_friction_angle",
    "kinetic_friction_angle",
    "dilation_angle",
    "strength_reduction",
)
"""Numbers of a joint that a stage may change."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A part of a run; stages follow each other, and the state is carried from one to the next."""

    name: str
    """Name."""
    until: str = EQUILIBRIUM
    """When it ends: "equilibrium", or "time", when its time is over."""
    time: float | None = None
    """Length of the stage, s, for one until equilibrium at most; None: the end of the schedule."""
    damping: Any = None
    """Damping of the stage: an object of the method; None: as without stages."""
    dynamic_ratio: float | None = None
    """Share of velocity carried to the next step, 0 static, 1 dynamic; None: as without stages."""
    force_ratio: float = 1e-4
    """Largest unbalanced force on a block in equilibrium, as a share of all forces on it."""
    speed: float = 1e-6
    """Largest speed of a block in equilibrium, as a share of sqrt(g x its size)."""
    hold: int = 20
    """Consecutive steps in which that holds."""
    reset_displacement: bool = False
    """True: displacements are reset at the end of the stage; positions do not change."""
    step: float | None = None
    """Wanted length of a step, s; None: as without stages."""
    every: float | None = None
    """Time between frames, s; None: as without stages."""
    excavate: tuple[str, ...] = ()
    """Openings and blocks that are excavated at its start."""
    relax: float = 1.0
    """Share of the support forces released by the stage that ends at once."""
    relax_time: float = 0.0
    """Time over which the rest of the released forces ends, s."""
    release: Mapping[str, float] = field(default_factory=dict)
    """Share of the support forces of excavated blocks that is released by now, from 0 to 1:
    {"heading": 0.5}; all of it if absent.  A later stage releases the rest."""
    install: tuple[str, ...] = ()
    """Bolts that are installed at its start, by their names or kinds."""
    joints: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Strengths of joints from its start on: {"bedding": {"friction_angle": 25.0}}."""
    bonds: str = BREAK
    """"break" as forces reach their strength, or "hold" until the static stage is in balance; only
    then are they judged."""
    jacks: str = LOCK
    """"lock": the jacks of bolts come off at its start; "hold": they stay on."""
    loads: tuple[str, ...] = ()
    """Loads, pressures and tables that act from its start on, and none of them before."""
    flow: Mapping[str, str] = field(default_factory=dict)
    """{"state": "transient"}: the flow in joints takes time from its start on; or "steady"."""
    flow_boundary: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Other values of boundaries of the flow from its start on: {"lake": {"head": 40.0}}."""
    ground_motion: bool = False
    """True: the ground moves in this stage, its record beginning with the stage."""


KINDS = {"point_loads": "force", "line_loads": "traction", "pressures": "pressure"}
"""Loads of a model -> their values, which are 0 while they do not act."""


def load_names(model: Model) -> tuple[str, ...]:
    """Return the names of loads, pressures, water and tables that stages may name."""
    named = (*names_that_act(model), *(factor.name for factor in model.factors))
    return tuple(dict.fromkeys(named))


def names_that_act(model: Model) -> tuple[str, ...]:
    """Return the names of loads, pressures, fill, load trains, water and boundaries of the flow."""
    named = [name for kind in KINDS for name in getattr(model, kind).name if name]
    named += [name for name in model.surcharge.names if name not in named]
    named += [water.name for water in model.water if water.name]
    return *named, *(one.name for one in (model.flow.boundaries if model.flow else ()))


def with_loads(
    model: Model, base: Model, stages: Sequence[Stage], starts: Sequence[float]
) -> Model:
    """Return a model with the loads that act when so many stages have begun at ``starts``, s.

    ``base`` has all of them.  The table of a load that a stage names begins with that stage, as a
    table does that it names itself.
    """
    begun = {
        name: starts[number] if number < len(starts) else None
        for number, stage in enumerate(stages)
        for name in stage.loads
    }
    factors = [_begun(factor, begun) for factor in base.factors]
    loads = {
        kind: _acting(getattr(base, kind), values, begun, base.factors, factors)
        for kind, values in KINDS.items()
    }
    water = tuple(standing(one, begun) for one in base.water)
    flow = None if base.flow is None else flowing(base.flow, stages, starts)
    return replace(model, **loads, water=water, flow=flow, factors=tuple(factors))


def flowing(flow: Flow, stages: Sequence[Stage], starts: Sequence[float]) -> Flow:
    """Return a flow as so many stages that have begun at ``starts`` have made it."""
    begun = stages[: len(starts)]
    at = {name: start for stage, start in zip(stages, starts, strict=False) for name in stage.loads}
    changes = {name: values for stage in begun for name, values in stage.flow_boundary.items()}
    later = {name for stage in stages[len(starts) :] for name in stage.loads}
    names = {name for stage in begun for name in (stage.name, *stage.install)}
    named = {name for stage in stages for name in stage.install}
    wells = tuple(replace(one, begun=one.begun and one.name not in named) for one in flow.wells)
    boundaries = tuple(
        one if one.factor is None else replace(one, factor=_first_until(one.factor, at, later))
        for one in flow.boundaries
    )
    state = [stage.flow["state"] for stage in begun if stage.flow] or [flow.state]
    flow = replace(flow, wells=wells, boundaries=boundaries, state=state[-1])
    return with_changes(flow, changes, names, later)


def _first_until(factor: Factor, at: Mapping[str, float], later: set[str]) -> Factor:
    """Return a table of heads that begins with a stage: its first one until then."""
    if factor.name in later:
        return replace(factor, value=np.full_like(factor.value, factor.value[0]))
    return replace(factor, time=factor.time + at.get(factor.name, 0.0))


def _begun(factor: Factor, begun: Mapping[str, float | None]) -> Factor:
    """Return a table as it is after the stages that have begun: 0 before that which names it."""
    if factor.name not in begun:
        return factor
    start = begun[factor.name]
    if start is None:
        return replace(factor, value=np.zeros_like(factor.value))
    return replace(factor, time=factor.time + start)


def standing(water: Water, begun: Mapping[str, float | None]) -> Water:
    """Return water as it stands: none before the stage that names it.

    ``begun`` has when the stages that name loads and tables have begun, s; None: not yet.
    """
    if water.name and water.name in begun:
        start = begun[water.name]
        if start is None:
            return replace(water, share=0.0, factor=None)
        if water.factor is not None:
            return replace(water, factor=replace(water.factor, time=water.factor.time + start))
    if water.factor is not None:
        return replace(water, factor=_begun(water.factor, begun))
    return water


def factors_in(model: Model) -> tuple[Factor, ...]:
    """Return the tables of all loads and waters."""
    others = [one.factor for one in model.water]
    others += [one.factor for one in (model.flow.boundaries if model.flow else ())]
    return *model.factors, *(one for one in others if one is not None)


def _acting(
    loads: Any,
    values: str,
    begun: Mapping[str, float | None],
    tables: Sequence[Factor],
    factors: list[Factor],
) -> Any:
    """Return loads of one kind as they act; tables that begin later are put behind ``factors``."""
    size, number = getattr(loads, values).copy(), loads.factor.copy()
    own: dict[tuple[str, int], int] = {}
    for row, name in enumerate(loads.name):
        if name not in begun:
            continue
        start = begun[name]
        if start is None:
            size[row] = 0.0
        elif number[row] != NO_FACTOR:
            table = int(number[row])
            if (name, table) not in own:
                own[name, table] = len(factors)
                factors.append(replace(tables[table], time=tables[table].time + start))
            number[row] = own[name, table]
    return replace(loads, **{values: size}, factor=number)


def are_constant(factors: Sequence[Factor], time: float) -> bool:
    """Return whether no table changes any more after a time, s."""
    return all(
        time >= factor.time[-1]
        or bool((factor.value[np.searchsorted(factor.time, time) - 1 :] == factor.at(time)).all())
        for factor in factors
    )


HELD_STRENGTH = 1e9
"""Strength of bonds that nothing breaks, in units of their own strength."""


ANGLE_IN_RADIANS_MAX = 1.6
"""Friction angles up to this many degrees look like radians (pi/2 is 1.57)."""


@dataclass(frozen=True)
class Contradiction:
    """Numbers of a joint that are each possible, and not together or not meant."""

    key: str
    """Which number."""
    what: str
    """The fault."""
    remedy: str
    """The remedy."""


DILATION_IN_RADIANS_MAX = 0.35
"""Dilation angles up to this many degrees look like radians (20 degrees are 0.35)."""


def contradiction(joint: Joint, *, is_small_meant: bool) -> Contradiction | None:
    """Return the fault in the strengths of a joint; None: all is well.

    ``is_small_meant``: a friction angle below ANGLE_IN_RADIANS_MAX is one in degrees.
    """
    for key in ("friction_angle", "residual_friction_angle", "kinetic_friction_angle"):
        angle = getattr(joint, key)
        if angle is not None and 0.0 < angle < ANGLE_IN_RADIANS_MAX and not is_small_meant:
            return Contradiction(
                key,
                f"{angle:g} looks like radians, but friction angles are in degrees",
                f"write {math.degrees(angle):.6g}, or 0 for no friction; if {angle:g} "
                "degrees is meant, add allow_small_friction_angle = true to the joint",
            )
    if joint.roughness is None:
        return next(_contradictions(joint), None)
    zero = dict.fromkeys(("friction_angle", "cohesion", "tensile_strength", "dilation_angle"), 0.0)
    for key, none in {**zero, "residual_cohesion": None, "kinetic_friction_angle": None}.items():
        if getattr(joint, key) != none:
            return Contradiction(
                key,
                'does not belong to law = "barton-bandis"',
                "change residual_friction_angle or strength_reduction",
            )
    return None


def _contradictions(joint: Joint) -> Iterator[Contradiction]:
    """Yield the faults of a joint without roughness: of residual strength, sliding, dilation."""
    cohesion, angle = joint.residual_cohesion, joint.residual_friction_angle
    kinetic, peak, dilation = (
        joint.kinetic_friction_angle,
        joint.friction_angle,
        joint.dilation_angle,
    )
    least = min(one for one in (peak, angle, kinetic) if one is not None)
    above = "{:g} degrees are more than the friction angle, {:g}"
    rules = (
        (
            cohesion is not None and cohesion > joint.cohesion,
            "residual_cohesion",
            f"{cohesion or 0.0:g} Pa are more than the cohesion, {joint.cohesion:g} Pa",
            "give a residual cohesion up to that, or leave it out: then all of it remains",
        ),
        (
            angle is not None and angle > peak,
            "residual_friction_angle",
            above.format(angle or 0.0, peak),
            "give a residual value up to that, or leave it out: then all of it remains",
        ),
        (
            joint.slip_weakening > 0.0 and cohesion is None and angle is None,
            "slip_weakening",
            "the joint has no residual strength",
            "give residual_friction_angle or residual_cohesion, or leave this out",
        ),
        (
            kinetic is not None and kinetic > peak,
            "kinetic_friction_angle",
            above.format(kinetic or 0.0, peak),
            "give an angle up to that, or leave it out: then they are equal",
        ),
        (
            joint.critical_speed > 0.0 and kinetic is None,
            "critical_speed",
            "the joint has no kinetic friction angle",
            "give kinetic_friction_angle, or leave this out",
        ),
        (
            joint.strength_reduction != 1.0,
            "strength_reduction",
            'belongs to a joint with law = "barton-bandis"',
            "change friction_angle, cohesion and tensile_strength themselves",
        ),
        (
            0.0 < dilation < DILATION_IN_RADIANS_MAX,
            "dilation_angle",
            f"{dilation:g} looks like radians, but angles are in degrees",
            f"write {math.degrees(dilation):.6g}, or leave it out",
        ),
        (
            joint.dilation_until is not None and dilation == 0.0,
            "dilation_until",
            "the joint does not dilate",
            "give dilation_angle, or leave this out",
        ),
        (
            dilation > least,
            "dilation_angle",
            f"{dilation:g} degrees are more than the least friction angle, {least:g}: sliding "
            "would create energy",
            "give an angle up to that; the friction angle is that of a test, roughness included",
        ),
    )
    return (Contradiction(key, what, remedy) for is_wrong, key, what, remedy in rules if is_wrong)


def with_strengths(table: JointTable, changes: Mapping[str, Mapping[str, float]]) -> JointTable:
    """Return the joints with other strengths: ``{"bedding": {"friction_angle": 25.0}}``.

    Cohesion and tensile strength are those of bonds: a contact that has lost its bond gets none.
    """
    joints = tuple(_changed(joint, changes.get(joint.name, {})) for joint in table.joints)
    return replace(table, joints=joints)


def with_bonds_held(model: Model) -> Model:
    """Return the model with bonds that nothing breaks."""
    joints = tuple(
        replace(
            one,
            cohesion=HELD_STRENGTH * one.cohesion,
            tensile_strength=HELD_STRENGTH * one.tensile_strength,
        )
        for one in model.joint_table.joints
    )
    return replace(model, joint_table=replace(model.joint_table, joints=joints))


def _changed(joint: Joint, changes: Mapping[str, float]) -> Joint:
    """Return a joint with other strengths."""
    numbers: dict[str, Any] = {key: float(value) for key, value in changes.items()}
    return replace(joint, **numbers)
