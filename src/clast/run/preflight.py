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
from clast.model.model import Bools, Model
from clast.model.state import State, initial_state
from clast.model.surroundings import Repair
from clast.run.method_warnings import check_overlaps, method_warnings, open_joint_warnings
from clast.run.model_warnings import model_warnings
from clast.run.stages.stage_checks import check_stages
from clast.step.method import Workspace
from clast.step.modified import STABILITY_LIMIT, search_of_modified, stability_number

if TYPE_CHECKING:
    from clast.contact.contacts import Contacts
    from clast.run.schedule import Schedule
    from clast.step.method import Method

LONG = 3600.0
"""Expected duration of a run above which it is warned of, s of wall time."""
MANY_STEPS = 1e6
"""Number of steps above which it is warned of."""
MOST_TRIALS, LONGEST_TRIAL = 4, 10.0
"""The first step is tried so often, or for so long, s, to find its time."""
QUICKEST = 1e-5, 5e-6
"""Wall time of a step, and more for each block, below which none is on any machine, s."""


@dataclass(frozen=True, kw_only=True)
class CaseSummary:
    """The contents of a case, and warnings."""

    title: str
    """Title of the case."""
    blocks: int
    """Number of blocks."""
    vertices: int
    """Number of vertices."""
    rocks: tuple[str, ...]
    """Names of the rocks."""
    joints: tuple[str, ...]
    """Names of the joints, the default first."""
    fixed_blocks: int
    """Number of blocks that cannot move."""
    fixed_points: int
    """Number of fixed points."""
    loads: int
    """Number of point and line loads."""
    measured_points: int
    """Number of measured points."""
    mass: float
    """Mass of all blocks, kg per metre of thickness."""
    box: tuple[float, float, float, float]
    """Bounding box xmin, ymin, xmax, ymax, m."""
    smallest: tuple[str, float]
    """Name and area, m2, of the smallest block."""
    largest: tuple[str, float]
    """Name and area, m2, of the largest block."""
    contacts: int
    """Contacts at the start."""
    touching_pairs: int
    """Pairs of blocks that touch at the start."""
    unsupported: tuple[str, ...]
    """Blocks that are not fixed anywhere and touch nothing."""
    steps: int
    """Steps that the run takes if none is cut; at most, where it has stages."""
    stages: tuple[str, ...]
    """Names of the stages."""
    max_displacement: float
    """Largest vertex movement in a step, m."""
    critdis: float
    """Critical distance of contact detection, m."""
    stability_number: float
    """Largest p h2/m, m being a block's mass per contact."""
    stability_limit: float
    """Largest p h2/m with which contacts settle without passes."""
    warnings: tuple[str, ...]
    """Warnings, each with its remedy."""
    repairs: tuple[Repair, ...]
    """Repairs to blocks so that they touch, each with its first places."""
    notes: tuple[str, ...]
    """Changes and choices that clast made by itself."""


def examine(model: Model, method: Method, schedule: Schedule) -> CaseSummary:
    """Return the contents of a case, and the warnings about it.

    Raises ModelError where blocks overlap by more than contacts of this stiffness explain, and for
    stages that cannot be.
    """
    check_overlaps(model, method)
    check_stages(schedule.stages, model)
    _check_steps(schedule)
    start = initial_state(model)
    contacts = _contacts(model, method, start)
    unsupported = _unsupported(model, contacts)
    number = stability_number(model, method, start, schedule.step)
    low = model.vertices.min(axis=0) + model.origin
    high = model.vertices.max(axis=0) + model.origin
    smallest, largest = int(model.area.argmin()), int(model.area.argmax())
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
        box=(float(low[0]), float(low[1]), float(high[0]), float(high[1])),
        smallest=(model.block_name[smallest], float(model.area[smallest])),
        largest=(model.block_name[largest], float(model.area[largest])),
        contacts=len(contacts),
        touching_pairs=len(contacts.pairs),
        unsupported=tuple(model.block_name[block] for block in np.flatnonzero(unsupported)),
        steps=schedule.steps,
        stages=tuple(stage.name for stage in schedule.stages),
        max_displacement=method.max_displacement,
        critdis=method.critdis,
        stability_number=number,
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
    """Refuse stages with more steps than any run has."""
    for stage in schedule.stages:
        length, step = stage.time or schedule.end, stage.step or schedule.step
        if length / step > ranges.MOST_STEPS:
            raise ModelError(
                f"{length:g} s are {length / step:.3g} steps of {step:g} s",
                where=f"stage '{shortened(stage.name)}', time",
                remedy="lower its time, or raise its step",
            )


def _duration_warnings(
    model: Model, method: Method, schedule: Schedule, start: State
) -> Iterable[str]:
    """Warn of long runs: how many steps, and how many hours they are expected to take.

    Where a guess leaves that open, the first step is made some times: compilation in the first of
    them does not count.
    """
    steps = schedule.steps
    base, more = QUICKEST
    if steps < MANY_STEPS and steps * (base + more * model.block_count) < 0.1 * LONG:
        return
    tried: list[float] = []
    while len(tried) < MOST_TRIALS and sum(tried) < LONGEST_TRIAL:
        tried.append(_seconds_of_a_step(model, method, schedule, start))
    seconds = min(tried)
    if steps < MANY_STEPS and steps * seconds < LONG:
        return
    yield (
        f"{steps:.3g} steps of {schedule.latest / steps:g} s: at {1e3 * seconds:.2g} ms each, as "
        f"the first one takes, about {steps * seconds / 3600.0:.2g} hours. Lower time.end or raise "
        "time.step if that is not meant"
    )


def _seconds_of_a_step(model: Model, method: Method, schedule: Schedule, start: State) -> float:
    """Return how long the first step takes, s of wall time, without compilation."""
    begin = working_time()
    with suppress(StepRejected):
        method.process.step(model, method, start, schedule.step, Workspace())
    return working_time() - begin


def _contacts(model: Model, method: Method, state: State) -> Contacts:
    frames = block_frames(model, state)
    return detect(
        model,
        method.corner_rule,
        state,
        frames.centroid,
        search_of_modified(method),
    )


def _unsupported(model: Model, contacts: Contacts) -> Bools:
    """Return True for blocks that are not fixed anywhere and touch nothing, shape (n,)."""
    held = model.fixed.copy()
    held[model.fixed_points.block] = True
    held[contacts.pairs.ravel()] = True
    held[model.bolts.blocks.ravel()] = True
    held[model.moved] = True
    return ~held
