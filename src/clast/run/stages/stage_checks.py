"""Checks of stages against the model that they are of; each by itself is checked before."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from clast import spelling
from clast.actions.linings import linings_of
from clast.errors import ModelError, shortened
from clast.model.flow.given import STEADY
from clast.model.ground_motion import Still
from clast.model.model import Model
from clast.model.ranges import check_names
from clast.model.stages import (
    ANGLE_IN_RADIANS_MAX,
    EQUILIBRIUM,
    TIME,
    Stage,
    contradiction,
    load_names,
    names_that_act,
    with_strengths,
)
from clast.model.surroundings import blocks_called


def check_stages(stages: Sequence[Stage], model: Model) -> None:
    """Raise ModelError for impossible stages, or stages naming things the model lacks."""
    check_names("stage", [stage.name for stage in stages])
    for stage in stages:
        if stage.until == TIME and stage.time is None:
            raise _fault(stage, "time", "is missing", "give the duration of the stage, s")
        if stage.time is not None and stage.step is not None and stage.step > stage.time:
            what = f"{stage.step:g} s is longer than the whole stage of {stage.time:g} s"
            raise _fault(stage, "step", what, "lower step, or raise time")
        _check_relaxation(stage)
        joints = {joint.name: joint for joint in model.joint_table.joints}
        for name in stage.joints:
            if name not in joints:
                remedy = spelling.advice(name, joints, kind="joint")
                raise _fault(stage, "joint", f"there is no joint '{shortened(name)}'", remedy)
        for joint in with_strengths(model.joint_table, stage.joints).joints:
            is_small = 0.0 < joints[joint.name].friction_angle < ANGLE_IN_RADIANS_MAX
            fault = contradiction(joint, is_small_meant=is_small)
            if joint.name in stage.joints and fault is not None:
                key = f"joint '{shortened(joint.name)}', {fault.key}"
                raise _fault(stage, key, fault.what, fault.remedy)
    for stage in stages:
        if stage.flow and (model.flow is None or model.flow.state == "hydrostatic"):
            what = "no water flows" if model.flow is None else "the water is at rest"
            remedy = 'give [flow] with state = "steady" or "transient", or leave this key out'
            raise _fault(stage, "flow", what, remedy)
        if (
            model.flow is not None
            and model.flow.coupling == STEADY
            and "transient" in (stage.flow.values())
        ):
            remedy = 'leave it out, or give [flow] coupling = "none"'
            raise _fault(stage, "flow", "apertures follow steady flow alone", remedy)
        heads = [name for name, one in stage.flow_boundary.items() if "head" in one]
        if heads and model.flow is not None and model.flow.weight == 0.0:
            what = f"there is no gravity, and so no head of '{shortened(heads[0])}'"
            raise _fault(stage, "flow_boundary", what, "give the pressure, Pa")
    for names in _NAMED:
        names.check(stages, model)
    _check_excavation(stages, model)
    _check_waiting(stages, model)
    _check_ground_motion(stages, model)
    _check_table_names(stages, model)


def _excavatable(model: Model) -> tuple[str, ...]:
    return *(one.name for one in model.openings), *model.block_name


def _installable(model: Model) -> tuple[str, ...]:
    bolts = model.bolts
    return tuple(name for name in (*bolts.name, *bolts.kind, *bolts.group, *_wells(model)) if name)


def _wells(model: Model) -> tuple[str, ...]:
    return tuple(one.name for one in model.flow.wells) if model.flow else ()


def _flow_boundaries(model: Model) -> tuple[str, ...]:
    return tuple(one.name for one in model.flow.boundaries) if model.flow else ()


@dataclass(frozen=True)
class _Names:
    """Names in one key of a stage."""

    key: str
    kind: str
    """The kind of thing they name, for messages."""
    known: Callable[[Model], Iterable[str]]
    again: str
    """The fault where two stages name the same; "": they may."""

    def check(self, stages: Sequence[Stage], model: Model) -> None:
        """Refuse unknown names, and those that two stages have."""
        known = tuple(dict.fromkeys(self.known(model)))
        for stage in stages:
            for name in getattr(stage, self.key):
                if name not in known:
                    remedy = spelling.advice(name, known, kind=self.kind)
                    raise _fault(
                        stage, self.key, f"there is no {self.kind} '{shortened(name)}'", remedy
                    )
        first: dict[str, Stage] = {}
        for stage in stages if self.again else ():
            for name in getattr(stage, self.key):
                if name in first:
                    what = f"'{shortened(name)}' {self.again} in {_where(first[name])}"
                    raise _fault(stage, self.key, what, "name it once")
                first[name] = stage


_NAMED = (
    _Names("excavate", "opening or block", _excavatable, "was already excavated"),
    _Names("release", "opening or block", _excavatable, ""),
    _Names("flow_boundary", "flow boundary", _flow_boundaries, ""),
    _Names("install", "bolt, kind of bolt or well", _installable, "was already installed"),
    _Names("loads", "named load or table", load_names, "already acts"),
)


def _where(stage: Stage) -> str:
    return f"stage '{shortened(str(stage.name))}'"


def _fault(stage: Stage, key: str, what: str, remedy: str) -> ModelError:
    return ModelError(what, where=f"{_where(stage)}, {key}", remedy=remedy)


def _check_relaxation(stage: Stage) -> None:
    lasting = stage.relax_time
    given = [key for key in ("relax", "relax_time") if getattr(stage, key) != getattr(Stage, key)]
    if given and not stage.excavate and not stage.release:
        raise _fault(
            stage,
            given[0],
            "there is nothing to release: the stage excavates nothing",
            'name the excavated blocks, e.g. excavate = ["heading"]',
        )
    if lasting > 0.0 and stage.relax == 1.0:
        raise _fault(
            stage,
            "relax_time",
            "there is nothing left to release: all support forces end at once",
            "give relax, the share that is released at once, below 1, e.g. relax = 0.3",
        )
    if lasting == 0.0 and stage.relax < 1.0:
        what = (
            f"{lasting:g} s is too short a time in which {1.0 - stage.relax:.3g} of the support "
            "forces could be released"
        )
        raise _fault(stage, "relax_time", what, "give it in s, above 0")
    if stage.until == EQUILIBRIUM and stage.time is not None and lasting > stage.time:
        what = f"{lasting:g} s is longer than the stage, {stage.time:g} s"
        remedy = 'lower it, raise time, or let later stages go on with it: until = "time"'
        raise _fault(stage, "relax_time", what, remedy)


def _check_ground_motion(stages: Sequence[Stage], model: Model) -> None:
    is_used = any(stage.ground_motion for stage in stages)
    for stage in stages:
        if stage.ground_motion and isinstance(model.ground_motion, Still):
            remedy = "give it with [ground_motion], or leave this key out"
            raise _fault(stage, "ground_motion", "the case has no ground motion", remedy)
    if stages and not is_used and not isinstance(model.ground_motion, Still):
        raise ModelError(
            "is used in no stage",
            where="ground_motion",
            remedy="add ground_motion = true to one of the stages, or remove it",
        )


def _check_waiting(stages: Sequence[Stage], model: Model) -> None:
    names = [stage.name for stage in stages]
    bolts = zip(model.bolts.name, model.bolts.stage, strict=True)
    waiting = [(f"bolt '{shortened(bolt)}'", name) for bolt, name in bolts]
    waiting += [("viscous boundary", name) for name in dict.fromkeys(model.viscous_edges.stage)]
    wells = model.flow.wells if model.flow else ()
    waiting += [(f"well '{shortened(one.name)}'", one.stage) for one in wells]
    waiting += [(f"drawpoint '{shortened(one.name)}'", one.stage) for one in model.drawpoints]
    waiting += [pair for action in model.actions for pair in getattr(action, "waits", ())]
    for what, name in waiting:
        if name and name not in names:
            raise ModelError(
                f"there is no stage '{shortened(name)}'",
                where=f"{what}, stage",
                remedy=spelling.advice(name, names, kind="stage")
                if names
                else "add [[stage]] with this name, or leave stage out",
            )


def _check_excavation(stages: Sequence[Stage], model: Model) -> None:
    since: dict[int, str] = {}
    installed: dict[int, str] = {}
    released: dict[int, float] = {}
    for stage in stages:
        for name in stage.excavate:
            for block in blocks_called([name], model.openings, model.block_name).tolist():
                if block in since:
                    excavated = f"'{shortened(model.block_name[block])}' was already excavated"
                    raise _fault(
                        stage,
                        "excavate",
                        f"block {excavated} in {since[block]}",
                        "name it once, by itself or with its opening",
                    )
                since[block] = _where(stage)
        if len(since) == model.block_count:
            what = "no block would be left"
            raise _fault(stage, "excavate", what, "excavate some of the blocks")
        own = np.array([name == stage.name for name in model.bolts.stage], np.bool_)
        for bolt in np.flatnonzero(own | model.bolts.named(stage.install)).tolist():
            name = f"bolt '{shortened(model.bolts.name[bolt])}'"
            springs = model.bolts.blocks[model.bolts.of_spring == bolt]
            left_out = np.isin(springs, list(since))
            if len(springs) and left_out.any(axis=1).all():
                block = int(springs[left_out][0])
                what = (
                    f"{name} would be anchored in block '{shortened(model.block_name[block])}', "
                    f"which was excavated in {since[block]}"
                )
                remedy = "anchor it in blocks that stay, or install it before"
                raise _fault(stage, "install", what, remedy)
            if bolt in installed:
                what = f"{name} was already installed in {installed[bolt]}"
                remedy = "let one stage install it, by install or by the bolt's own stage"
                raise _fault(stage, "install", what, remedy)
            installed[bolt] = _where(stage)
        _check_release(stage, model, since, released)
        _check_room(stage, model, since)


def _check_release(
    stage: Stage, model: Model, since: Mapping[int, str], released: dict[int, float]
) -> None:
    """Refuse releases of rock, and of less than before; add the stage to ``released``."""
    fresh = blocks_called(stage.excavate, model.openings, model.block_name).tolist()
    released.update(dict.fromkeys(fresh, -1.0))
    here = dict.fromkeys(fresh, 1.0)
    for name, share in stage.release.items():
        where = f"{_where(stage)}, release, {shortened(name)}"
        blocks = blocks_called([name], model.openings, model.block_name).tolist()
        for block in blocks:
            if block not in since:
                raise ModelError(
                    f"block '{shortened(model.block_name[block])}' has not been excavated by then",
                    where=where,
                    remedy="excavate it in this stage or in one before",
                )
            if share <= released[block]:
                raise ModelError(
                    f"{share:g} is not more than the {released[block]:g} released before",
                    where=where,
                    remedy="give the fraction that is released by now, which grows up to 1; what "
                    "is excavated without release has released all",
                )
            here[block] = share
    released.update(here)


def _check_room(stage: Stage, model: Model, since: Mapping[int, str]) -> None:
    linings, _ = linings_of(model)
    for one in linings.each if linings else ():
        for block in one.inside.tolist() if one.stage == stage.name else ():
            if block not in since:
                raise ModelError(
                    f"lies in block '{shortened(model.block_name[block])}', which has not been "
                    f"excavated by {_where(stage)}",
                    where=f"lining '{shortened(one.name)}', stage",
                    remedy="name a later stage, or excavate its place before; an end is square to "
                    "the line: where the wall leans, let the line end upright",
                )


def _check_table_names(stages: Sequence[Stage], model: Model) -> None:
    both = set(names_that_act(model)) & {factor.name for factor in model.factors}
    for stage in stages:
        for name in stage.loads:
            if name in both:
                what = f"'{name}' names both a load and a table"
                raise _fault(stage, "loads", what, "give one of them another name")
