"""Checks whether the data of a run in a checkpoint are possible for a model and its stages.

Kernels look at no index twice: a vertex that does not exist would be read from anywhere.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from clast.actions.active import actions_of
from clast.actions.damping import DampingState
from clast.actions.relaxation import SupportForces
from clast.contact.memory import memory_order
from clast.model.arrays import areas
from clast.model.model import Model
from clast.model.state import POINT_NUMBERS, ContactMemory, State
from clast.run.run_checks import Watch
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.stages.equilibrium import MODES
from clast.run.stages.stage_position import Position
from clast.run.stages.static_path import OnPath
from clast.step.method import Method


def faults(run: RunState, model: Model, method: Method, schedule: Schedule) -> Iterator[str]:
    """Yield the faults in the data of a run."""
    state = run.state
    yield from _of_numbers(run, schedule)
    yield from _of_blocks(state, model)
    yield from _of_memory(state.memory, model)
    actions = actions_of(model, method.fixed_point_stiffness, method.damping)
    if len(state.actions) not in (0, len(actions)):
        yield "other things act on the blocks"
        return
    for action, own in zip(actions, state.actions, strict=False):
        may_be = getattr(action, "may_be", None)  # a state that stages change in shape
        begun = action.begin(model) if may_be is None else None
        if not (_own_fits(own, begun, model) if may_be is None else may_be(own, model)):
            yield f"the state of {type(action).__name__} is impossible"
    watched = Watch(model=model, method=method).begin(state)
    for name in ("least", "greatest"):
        if getattr(run.seen, name).shape != getattr(watched, name).shape:
            yield "the energies that were seen are not those of a run"
    yield from _of_position(run.position, model, schedule)
    yield from _of_path(run.path, model)


def _of_numbers(run: RunState, schedule: Schedule) -> Iterator[str]:
    tally, longest = run.tally, max([schedule.step, *(one.step or 0.0 for one in schedule.stages)])
    if run.path is not None:  # a pseudo time step has nothing to do with those of the case
        longest = np.finfo(float).max / 2.0
    if not 0.0 < run.step <= longest * (1.0 + 1e-9) or not 0.0 <= run.taken <= longest * 1.5:
        yield "the length of its step does not belong to this run"
    if not 0.0 <= run.state.time < np.inf or run.frame < 0:
        yield "its time is impossible"
    counts = (tally.steps, tally.passes, tally.cut_steps, tally.contacts, *tally.counts.values())
    if min(counts) < 0 or not np.isfinite([tally.penetration, *tally.seconds.values()]).all():
        yield "its counts are impossible"
    for ledger in (run.first, run.state.ledger):
        if not np.isfinite(dataclasses.astuple(ledger)).all():
            yield "its energies are not finite"


def _of_blocks(state: State, model: Model) -> Iterator[str]:
    blocks, vertices = model.block_count, len(model.vertices)
    shapes = {
        "vertices": (vertices, 2),
        "velocity": (blocks, 6),
        "stress": (blocks, 3),
        "rotation": (blocks,),
        "points": model.material_points.at.shape,
    }
    for name, shape in shapes.items():
        array = getattr(state, name)
        if array.shape != shape:
            yield f"it has {name} of other blocks"
        elif not np.isfinite(array).all():
            yield f"its {name} are not finite"
        elif name == "vertices":
            with np.errstate(all="ignore"):
                area = areas(array, model.block_start)
            if not (area > 0.0).all():
                yield "it has blocks without an area"


def _of_memory(memory: ContactMemory, model: Model) -> Iterator[str]:
    arrays = {one.name: getattr(memory, one.name) for one in dataclasses.fields(memory)}
    if any(array.shape != (len(memory),) for array in arrays.values()):
        yield "its contacts do not have as many numbers each"
        return
    vertices = len(model.vertices)
    limits = {"vertex": vertices, "edge": vertices, "block": model.block_count}
    for name, limit in {**limits, "mode": len(MODES), "point": POINT_NUMBERS}.items():
        if ((arrays[name] < 0) | (arrays[name] >= limit)).any():
            yield f"its contacts have a {name} that does not exist"
            return
    if not all(np.isfinite(array).all() for array in arrays.values()):
        yield "its contacts have forces that are not finite"
    owner = model.vertex_block
    if (owner[memory.edge] != memory.block).any() or (owner[memory.vertex] == memory.block).any():
        yield "its contacts are between other blocks than they say"
    order = memory_order(memory.vertex, memory.block, memory.edge, memory.point)
    if (order != np.arange(len(memory))).any():
        yield "its contacts are out of order"


def _own_fits(own: Any, begun: Any, model: Model) -> bool:
    """Return whether an action can have a state of its own, given that at the start of a run."""
    if isinstance(own, DampingState):  # any stage may have damped
        free = own.force.shape in ((0, 6), (model.block_count, 6))
        return begun is None and free and bool(np.isfinite(own.force).all())
    if isinstance(own, SupportForces):
        return isinstance(begun, SupportForces) and _forces_fit(own, model)
    if begun is None or own is None or type(begun).__module__.split(".")[0] != "clast":
        return own is None or begun is not None  # that of a script's action is the script's own
    return _alike(own, begun)


def _alike(own: Any, begun: Any) -> bool:
    if type(own) is not type(begun):
        return False
    pairs = [(getattr(own, one.name), getattr(begun, one.name)) for one in dataclasses.fields(own)]
    return all(
        _alike(*pair)
        if dataclasses.is_dataclass(pair[1])
        else np.shape(pair[0]) == np.shape(pair[1])
        for pair in pairs
    )


def _forces_fit(own: SupportForces, model: Model) -> bool:
    count = len(own.block)
    shapes: dict[str, tuple[int, ...]] = {
        name: (count,) for name in ("of", "block", "share", "since")
    }
    shapes |= {"absent": (model.block_count,), "vertex": (count, 2), "force": (count, 2)}
    if not _have_shapes(own, shapes) or own.duration.shape != (count,):
        return False
    limits = [(one, model.block_count) for one in (own.of, own.block)]
    limits.append((own.vertex, len(model.vertices)))
    exist = all(((rows >= 0) & (rows < limit)).all() for rows, limit in limits)
    return exist and bool((own.duration > 0.0).all())  # infinite: held


def _of_position(position: Position | None, model: Model, schedule: Schedule) -> Iterator[str]:
    if (position is None) != (not schedule.stages):
        yield "its stages are not those of the case"
        return
    if position is None:
        return
    starts, records = position.starts, position.records
    begun = 1 <= len(starts) <= len(schedule.stages) and list(starts) == sorted(starts)
    if not begun or not len(starts) - 1 <= len(records) <= len(starts):
        yield "its stages are not those of the case"
    if position.steps < 0 or not np.isfinite([*starts, position.seconds]).all():
        yield "the numbers of its stage are impossible"
    points = len(model.measured_points.name)
    if any(len(one.reset) not in (0, points) for one in records):
        yield "its displacements count from other points"
    reference = position.reference
    shapes = {"points": model.material_points.at.shape, "rotation": (model.block_count,)}
    shapes["vertices"] = model.vertices.shape
    if reference is not None and not _have_shapes(reference, shapes):
        yield "its displacements count from other blocks"
    held = position.held
    count = model.block_count if held.steps else 0
    moved = {"sliding": (count,), "net": (count, 2), "path": (count,)}
    halves = ((0,), (model.block_count,)) if held.steps else ((0,),)
    if held.steps < 0 or held.half.shape not in halves or not _have_shapes(held, moved):
        yield "its steps in equilibrium are those of other blocks"


def _of_path(path: OnPath | None, model: Model) -> Iterator[str]:
    if path is None:
        return
    moves = path.convergence
    widths = [(path.moved, 2), (path.missing, 6), (path.ahead, 6), (path.judged.left, 3)]
    widths += [(moves.total, 3), (moves.last, 3)]
    fits = all(one.shape in ((0, k), (model.block_count, k)) for one, k in widths)
    fits = fits and path.driven.shape[1:] == (2,) and moves.ratios.ndim == 1
    arrays = [path.driven, *(one for one, _ in widths)]
    if not fits or not all(np.isfinite(one).all() for one in arrays):
        yield "its path of equilibria is that of other blocks"
    numbers = (path.growth, path.clock, path.reached, path.increment)
    if not np.isfinite(numbers).all() or min(*numbers, path.steps, path.far, path.broken) < 0:
        yield "the numbers of its path of equilibria are impossible"


def _have_shapes(parts: Any, shapes: Mapping[str, tuple[int, ...]]) -> bool:
    """Return whether arrays have these shapes, and only finite numbers."""
    arrays = [(getattr(parts, name), shape) for name, shape in shapes.items()]
    return all(one.shape == shape and np.isfinite(one).all() for one, shape in arrays)
