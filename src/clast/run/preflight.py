"""The check of a case before its first step: its contents, and warnings."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.block.inertia import block_frames
from clast.compute.compilation import working_time
from clast.contact.detection import detect
from clast.errors import ModelError, StepRejected, shortened
from clast.model import ranges
from clast.model.model import Model
from clast.model.state import State, initial_state
from clast.model.surroundings import Repair
from clast.run.method_warnings import (
    check_coupling,
    check_overlaps,
    method_warnings,
    open_joint_warnings,
)
from clast.run.model_warnings import model_warnings
from clast.run.stages.stage_sequence import StageSequence
from clast.run.stages.transition import Setting
from clast.step.method import Workspace
from clast.step.modified import STABILITY_LIMIT, search_of_modified, stability_number

if TYPE_CHECKING:
    from clast.run.schedule import Schedule
    from clast.step.method import Method

WALL_SECONDS_MAX, STEPS_MAX = 3600.0, 1e6
"""Expected duration, s of wall time, and steps of a run above which it is warned of."""
TRIALS_MAX, TRIAL_SECONDS_MAX = 4, 10.0
"""The first step is tried so often, or for so long, s, to find its time."""
STEP_SECONDS_MIN = 1e-5, 5e-6
"""Wall time of a step, and more for each block, below which none is on any machine, s."""


@dataclass(frozen=True, kw_only=True)
class CaseSummary:
    """The contents of a case, and warnings."""

    title: str
    blocks: int
    vertices: int
    rocks: tuple[str, ...]
    joints: tuple[str, ...]
    """Names of the joints, the default first."""
    fixed_blocks: int
    fixed_points: int
    loads: int
    """Number of point and line loads and pressures."""
    measured_points: int
    mass: float
    """Mass of all blocks, kg per metre of thickness."""
    box: tuple[float, float, float, float]
    """Bounding box xmin, ymin, xmax, ymax, m."""
    smallest: tuple[str, float]
    """Name and area, m2, of the smallest block."""
    largest: tuple[str, float]
    """Name and area, m2, of the largest block."""
    contacts: int
    touching_pairs: int
    """Pairs of blocks that touch at the start."""
    unsupported: tuple[str, ...]
    """Blocks that are not fixed anywhere and touch nothing."""
    steps: int
    """Steps that the run takes if none is cut; at most, where it has stages."""
    stages: tuple[str, ...]
    max_displacement: float
    """Largest vertex movement in a step, m."""
    critdis: float
    """Critical distance of contact detection, m."""
    stability_number: float
    """Largest p h2/m, m being a block's mass per contact."""
    stability_limit: float
    """Largest p h2/m with which contacts settle without passes."""
    warnings: tuple[str, ...]
    repairs: tuple[Repair, ...]
    """Repairs to blocks so that they touch, each with its first places."""
    notes: tuple[str, ...]
    """Changes and choices that clast made by itself."""


def examine(model: Model, method: Method, schedule: Schedule) -> CaseSummary:
    """Return the contents of a case, and the warnings about it; raises ModelError."""
    check_coupling(model, method)
    check_overlaps(model, method)
    StageSequence(base=Setting(model=model, method=method, schedule=schedule)).check()
    _check_steps(schedule)
    start = initial_state(model)
    centroid, search = block_frames(model, start).centroid, search_of_modified(method)
    contacts = detect(model, method.corner_rule, start, centroid, search)
    corners = model.vertices + model.origin
    (xmin, ymin), (xmax, ymax) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    smallest, largest = int(model.area.argmin()), int(model.area.argmax())
    # The names of blocks that are not fixed anywhere and touch nothing.
    held = model.fixed | model.moved
    for blocks in (model.fixed_points.block, contacts.pairs, model.bolts.blocks):
        held[blocks] = True
    return CaseSummary(
        title=model.title,
        blocks=model.block_count,
        vertices=len(model.vertices),
        rocks=tuple(rock.name for rock in model.rocks),
        joints=tuple(joint.name for joint in model.joint_table.joints),
        fixed_blocks=int(model.fixed.sum()),
        fixed_points=len(model.fixed_points.block),
        loads=len(model.point_loads.block)
        + len(model.line_loads.block)
        + len(model.pressures.block),
        measured_points=len(model.measured_points.name),
        mass=float(model.mass.sum()),
        box=(xmin, ymin, xmax, ymax),
        smallest=(model.block_name[smallest], float(model.area[smallest])),
        largest=(model.block_name[largest], float(model.area[largest])),
        contacts=len(contacts),
        touching_pairs=len(contacts.pairs),
        unsupported=tuple(model.block_name[block] for block in np.flatnonzero(~held)),
        steps=schedule.steps,
        stages=tuple(stage.name for stage in schedule.stages),
        max_displacement=method.max_displacement,
        critdis=method.critdis,
        stability_number=stability_number(model, method, start, schedule.step),
        stability_limit=STABILITY_LIMIT,
        warnings=(
            *_duration_warnings(model, method, schedule, start),
            *method.process.advice(model, method, start, schedule.step),
            *model_warnings(model, *schedule.of_motion),
            *method_warnings(model, method, schedule),
            *open_joint_warnings(model, contacts),
        ),
        repairs=model.repairs,
        notes=(*model.notes, *method.notes),
    )


def _check_steps(schedule: Schedule) -> None:
    for stage in schedule.stages:
        length, step = stage.time or schedule.end, stage.step or schedule.step
        if length / step > ranges.STEPS_MAX:
            raise ModelError(
                f"{length:g} s are {length / step:.3g} steps of {step:g} s",
                where=f"stage '{shortened(stage.name)}', time",
                remedy="lower its time, or raise its step",
            )


def _duration_warnings(
    model: Model, method: Method, schedule: Schedule, start: State
) -> Iterable[str]:
    """Warn of long runs; where a guess leaves the duration open, the first step is timed."""
    steps = schedule.steps
    base, more = STEP_SECONDS_MIN
    if steps < STEPS_MAX and steps * (base + more * model.block_count) < 0.1 * WALL_SECONDS_MAX:
        return
    trials: list[float] = []
    while len(trials) < TRIALS_MAX and sum(trials) < TRIAL_SECONDS_MAX:
        begin = working_time()
        with suppress(StepRejected):
            method.process.step(model, method, start, schedule.step, Workspace())
        trials.append(working_time() - begin)
    seconds = min(trials)
    if steps < STEPS_MAX and steps * seconds < WALL_SECONDS_MAX:
        return
    yield (
        f"{steps:.3g} steps of {schedule.latest / steps:g} s: at {1e3 * seconds:.2g} ms each, as "
        f"the first one takes, about {steps * seconds / 3600.0:.2g} hours. Lower time.end or raise "
        "time.step if that is not meant"
    )
