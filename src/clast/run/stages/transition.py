"""Changes in a run at the start of a stage.

Model, method and schedule are replaced, never the shapes of arrays, so that the data of a run fit
all of its stages.  The same changes, but for those of the state, are made again where a run goes on
from a checkpoint.

Linings that a stage adds have segments without stress on the outline of the rock as it is by then.
Points of the outer face lie on the edges of the rock that they were drawn on, wherever these have
got to; where two blocks meet there, halfway between them.  Faces between segments turn with the
chords of the segments, so that the thickness stays.  Contacts with the rock carry nothing: the
force that a gap or an overlap of faces, both filled, would give is the rest force of their spring.
A gap at the end of a lining, to a floor for one, is not filled.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from clast.actions.active import actions_of, states_of
from clast.actions.linings import Linings, LiningShape, LiningStates, OneLining, linings_of
from clast.actions.relaxation import SupportForces
from clast.block import polygon
from clast.contact import contacts as modes
from clast.contact.contacts import Contacts
from clast.contact.joints.barton_bandis import rough_contacts
from clast.contact.joints.bonds import are_closed, flush_edges
from clast.contact.laws import normal_stiffness_of
from clast.contact.memory import memory_order
from clast.model.ground_motion import GroundMotion, InStages, Still
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stage_records import Event
from clast.model.stages import EQUILIBRIUM, LOCK, Stage, with_loads, with_strengths
from clast.model.state import ContactMemory, State
from clast.model.surroundings import blocks_called
from clast.run.excavation import excavated, release, with_drains, without
from clast.run.schedule import Schedule
from clast.step.method import Method
from clast.step.search_distance import search_within_step, travel_expected
from clast.step.start import begin

WELL_BELOW = 0.1
"""Unbalanced force to which a step is solved, in units of the limit of equilibrium."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Model, method and schedule of a stage."""

    model: Model
    method: Method
    schedule: Schedule


def before_all(base: Setting) -> Setting:
    """Return the setting before the first stage: loads that stages name do not act yet."""
    stages = base.schedule.stages
    model = with_loads(base.model, base.model, stages, ())
    motion = _motion(base.model.ground_motion, stages, ())
    named = [name for stage in stages for name in stage.install]
    return replace(
        base, model=replace(model, ground_motion=motion, bolts=model.bolts.without(named))
    )


def entered(
    base: Setting, current: Setting, state: State, starts: Sequence[float]
) -> tuple[Setting, State]:
    """Return setting and state of the stage that begins last at ``starts``, s.

    ``current`` is the setting before, ``base`` that without stages.
    """
    stages = base.schedule.stages[: len(starts)]
    stage = stages[-1]
    setting = changed(base, current, starts)
    before, now = (fraction_released(setting.model, some) for some in (stages[:-1], stages))
    if stage.excavate:
        blocks = excavated_by(setting.model, stage)
        model, state = excavated(
            setting.model, setting.method, state, blocks, stage.relax, stage.relax_time, now[blocks]
        )
        before[blocks] = now[blocks]
        setting = replace(setting, model=model)
    if stage.release:
        held = 1.0 - before
        fraction = np.divide(now - before, held, out=np.zeros_like(held), where=held > 0.0)
        state = release(
            setting.model, setting.method, state, fraction, stage.relax, stage.relax_time
        )
    model, state = lined(setting.model, setting.method, state, stage, setting.schedule.step)
    setting = replace(setting, model=model)
    if current.method.dynamic_ratio == 0.0 < setting.method.dynamic_ratio:
        state = at_rest(state)
    return setting, state


def changed(base: Setting, current: Setting, starts: Sequence[float]) -> Setting:
    """Return the setting with the changes of a stage beside excavation."""
    stages = base.schedule.stages
    stage = stages[len(starts) - 1]
    model = with_loads(current.model, base.model, stages, starts)
    model = replace(
        model,
        joint_table=with_strengths(model.joint_table, stage.joints),
        ground_motion=_motion(base.model.ground_motion, stages, starts),
        viscous_edges=model.viscous_edges.at_stage(stage.name, starts[-1]),
        begun=tuple((one.name, at) for one, at in zip(stages, starts, strict=False)),
    )
    model = with_drains(model)
    locks = len(starts) > 1 and stage.jacks == LOCK
    bolts = model.bolts.locked_by_now() if locks else model.bolts
    return Setting(
        model=replace(model, bolts=bolts.at_stage(stage.name, stage.install)),
        method=_method(base.method, stage),
        schedule=_schedule(base.schedule, stage, starts[-1]),
    )


def at_rest(state: State) -> State:
    """Return a state without velocities: a static run has thrown them away at every step."""
    ledger = state.ledger
    stopped = replace(ledger, kinetic=0.0, removed=ledger.removed + ledger.kinetic)
    return replace(state, velocity=np.zeros_like(state.velocity), ledger=stopped)


def excavated_by(model: Model, stage: Stage) -> Ints:
    """Return the blocks that a stage excavates, shape (k,)."""
    return blocks_called(stage.excavate, model.openings, model.block_name)


def fraction_released(model: Model, stages: Sequence[Stage]) -> Floats:
    """Return the fraction of the support of every block that the stages release, shape (n,).

    It is 0 for blocks that none of them excavates.
    """
    fraction = np.zeros(model.block_count)
    for stage in stages:
        fraction[excavated_by(model, stage)] = 1.0
        for name, share in stage.release.items():
            fraction[model.blocks_called([name])] = share
    return fraction


def events_at_start(model: Model, stage: Stage, time: float) -> Iterator[Event]:
    """Yield the events at the start of a stage."""

    def event(kind: str, what: str, text: str) -> Event:
        return Event(time=time, stage=stage.name, kind=kind, what=what, text=text)

    yield event("stage begins", stage.name, f"stage '{stage.name}' begins")
    for name in stage.excavate:
        yield event("excavated", name, f"'{name}' is excavated")
    for name, share in stage.release.items():
        yield event("released", name, f"{share:.0%} of the support of '{name}' is released by now")
    for name in stage.install:
        yield event("installed", name, f"'{name}' is installed")
    for name, changes in stage.joints.items():
        numbers = ", ".join(f"{key} {value:g}" for key, value in changes.items())
        yield event("joint changes", name, f"joint '{name}' gets {numbers}")
    for name in stage.loads:
        yield event("load begins", name, f"'{name}' begins to act")
    for state in stage.flow.values():
        yield event("flow changes", "", f"the flow is {state}")
    for name, changes in stage.flow_boundary.items():
        numbers = ", ".join(f"{key} {value:g}" for key, value in changes.items())
        yield event("flow boundary changes", name, f"flow boundary '{name}' gets {numbers}")
    if stage.ground_motion:
        yield event("ground motion begins", "", "the ground begins to move")
    for lining in _added_by(model, stage):
        yield event("installed", lining.name, f"lining '{lining.name}' is installed")


def _motion(motion: GroundMotion, stages: Sequence[Stage], starts: Sequence[float]) -> GroundMotion:
    if isinstance(motion, Still):
        return motion
    ends = (*starts[1:], math.inf)
    parts = tuple(
        (start, end)
        for stage, start, end in zip(stages, starts, ends, strict=False)
        if stage.ground_motion
    )
    return InStages(motion=motion, parts=parts)


def _method(method: Method, stage: Stage) -> Method:
    if stage.dynamic_ratio is not None:
        method = replace(method, dynamic_ratio=stage.dynamic_ratio)
    if stage.until == EQUILIBRIUM:
        method = replace(method, balance=WELL_BELOW * stage.force_ratio)
    return method if stage.damping is None else replace(method, damping=stage.damping)


def _schedule(schedule: Schedule, stage: Stage, start: float) -> Schedule:
    step = stage.step or schedule.step
    smallest = schedule.smallest_step
    return replace(
        schedule,
        stages=(),
        step=step,
        end=start + (stage.time or schedule.end),
        every=stage.every or schedule.every,
        smallest_step=None if smallest is None else min(smallest, step),
    )


def _added_by(model: Model, stage: Stage) -> tuple[OneLining, ...]:
    linings, _ = linings_of(model)
    return tuple(one for one in linings.each if one.stage == stage.name) if linings else ()


def lined(
    model: Model, method: Method, state: State, stage: Stage, step: float
) -> tuple[Model, State]:
    """Return model and state with the linings of a stage that begins; its steps are ``step``, s."""
    fresh = _added_by(model, stage)
    linings, number = linings_of(model)
    if not fresh or linings is None:
        return model, state
    coming = np.zeros(model.block_count, np.bool_)
    for one in fresh:
        coming[one.segments] = True
    left = without(model, model.absent & ~coming)
    actions = actions_of(left, method.fixed_point_stiffness, method.damping)
    own = list(states_of(actions, left, state))
    number += len(actions) - len(model.actions)
    for one in fresh:
        state, own[number] = _put(left, state, one, linings, own[number])
    own = [
        replace(one, absent=left.absent) if isinstance(one, SupportForces) else one for one in own
    ]
    state = replace(state, actions=tuple(own))
    contacts = _contacts(left, method, state, step)
    return left, replace(state, memory=_bonded(left, method, state, contacts, coming))


def present_outline(shape: LiningShape, vertices: Floats, absent: Bools) -> Floats:
    """Return where the rock carries the points of the outer line, m, shape (p, 2).

    ``vertices`` (nv, 2) are where they are, ``absent`` (nv,) those of excavated blocks.  Points
    that nothing carries go with those on both sides.
    """
    count = len(shape.at)
    there = ~absent[shape.vertex[:, 0]]
    point, share = shape.point[there], shape.share[there, None]
    first, last = vertices[shape.vertex[there].T]
    moved = first + share * (last - first) - shape.at[point]
    times = np.bincount(point, minlength=count)
    total = np.stack([np.bincount(point, moved[:, k], count) for k in (0, 1)], axis=1)
    carried = np.flatnonzero(times)
    if not len(carried):
        return shape.at
    mean = total[carried] / times[carried, None]
    every = np.arange(count)
    return shape.at + np.stack([np.interp(every, carried, mean[:, k]) for k in (0, 1)], axis=1)


def _put(
    model: Model, state: State, one: OneLining, linings: Linings, own: LiningStates
) -> tuple[State, LiningStates]:
    """Return the state with a lining on the outline as it is, and the state of all linings."""
    shape = one.shape
    at = present_outline(shape, state.vertices, model.absent[model.vertex_block])
    vertices, rotation = state.vertices.copy(), state.rotation.copy()
    points = state.points.copy()
    turned = np.array([_turn(shape, at, k) for k in range(len(one.segments))])
    faces = _faces(one, turned)
    middles = np.zeros((len(one.segments), 2, 2))
    for k, block in enumerate(one.segments.tolist()):
        rows = shape.points_of(k)
        ends, drawn = at[rows[[0, -1]]], shape.at[rows[[0, -1]]]
        inner = ends + _rotated(shape.inner[k] - drawn, faces[k])
        vertices[model.block_start[block] : model.block_start[block + 1]] = np.concatenate(
            [at[rows], inner[::-1]]
        )
        rotation[block] += turned[k]
        middles[k] = 0.5 * (ends + inner)
        on = model.material_points.block == block
        angle = np.full(int(on.sum()), turned[k])
        points[on] = ends[0] + _rotated(points[on] - drawn[0], angle)
    places = own.joints.at.copy()
    met = np.isin(one.joints, one.meets[:, 0])
    places[one.joints[~met]] = middles[one.face[~met, 0], one.face[~met, 1]][:, None]
    joint, side, segment, end = one.meets.T
    places[joint, side] = middles[segment, end]
    state = replace(state, vertices=vertices, rotation=rotation, points=points)
    return state, replace(own, joints=replace(own.joints, at=places))


def _turn(shape: LiningShape, at: Floats, segment: int) -> float:
    """Return by how much the chord of a segment has turned since it was drawn, rad."""
    rows = shape.points_of(segment)[[0, -1]]
    (x, y), (u, v) = np.diff(shape.at[rows], axis=0)[0], np.diff(at[rows], axis=0)[0]
    return float(np.arctan2(x * v - y * u, x * u + y * v))


def _faces(one: OneLining, turned: Floats) -> Floats:
    """Return by how much the two faces of each segment turn, (s, 2): as both beside them do."""
    before, after = np.roll(turned, 1), np.roll(turned, -1)
    shape = one.shape
    last = shape.points_of(len(turned) - 1)[-1]
    if last != shape.first[0]:  # it does not come back
        before[0], after[-1] = turned[0], turned[-1]
    return np.stack([0.5 * (turned + before), 0.5 * (turned + after)], axis=1)


def _rotated(vectors: Floats, angle: Floats) -> Floats:
    """Return vectors (k, 2) turned by angles (k,), rad."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)


def _contacts(model: Model, method: Method, state: State, step: float) -> Contacts:
    """Return the contacts of the first step."""
    still = replace(state, velocity=np.zeros_like(state.velocity))
    context = begin(model, method, still, step, None)
    return context.contacts(search_within_step(method, travel_expected(context)))


def _bonded(
    model: Model, method: Method, state: State, contacts: Contacts, coming: Bools
) -> ContactMemory:
    """Return the memory with the contacts of segments that come (n,): whole, and without force."""
    of_lining = coming[contacts.vertex_block] ^ coming[contacts.edge_block]
    direction = polygon.edges(state.vertices, model.block_start)[0]
    filled = are_closed(contacts, model, direction) | ~_beside(model, contacts, coming, direction)
    near = np.flatnonzero(of_lining & filled & (np.abs(contacts.gap) <= method.critdis))
    gap = contacts.gap[near]
    rest = np.zeros(len(near))
    if hasattr(method.contact_law, "normal_stiffness"):
        rest = normal_stiffness_of(contacts, method.contact_law)[near] * gap
    rough = rough_contacts(model.joint_table, contacts.joint[near])
    if rough is not None:
        rest[rough.rows] = 0.0
    none, whole = np.zeros(len(near)), np.ones(len(near), np.bool_)
    ours = ContactMemory(
        vertex=contacts.vertex[near],
        block=contacts.edge_block[near],
        edge=contacts.edge[near],
        point=contacts.point[near],
        gap=gap,
        rest_force=rest,
        bonded=whole,
        cohesive=whole,
        mode=np.full(len(near), modes.LOCK),
        **dict.fromkeys(WITHOUT_HISTORY, none),
    )
    joined = {
        one.name: np.concatenate([getattr(state.memory, one.name), getattr(ours, one.name)])
        for one in fields(ContactMemory)
    }
    order = memory_order(joined["vertex"], joined["block"], joined["edge"], joined["point"])
    return ContactMemory(**{name: values[order] for name, values in joined.items()})


def _beside(model: Model, contacts: Contacts, coming: Bools, direction: Floats) -> Bools:
    """Return which contacts are along ends and inner faces of segments that come, (m,).

    A lining that is sprayed on fills gaps of the outer face; these stay open.
    """
    others = np.zeros(len(direction) + 1, np.bool_)  # and of -1, which is none
    for last in model.block_start[1:][coming]:
        others[last - 3 : last] = True
    flush = flush_edges(contacts.vertex, contacts.edge, direction, model.block_start)
    own = [np.where(contacts.point > 0, contacts.vertex, one) for one in flush]
    on_outer = [coming[contacts.vertex_block] & (one >= 0) & ~others[one] for one in own]
    own_beside = (others[own[0]] | others[own[1]]) & ~(on_outer[0] | on_outer[1])
    return np.asarray(own_beside | others[contacts.edge])


WITHOUT_HISTORY = (
    *("normal_force", "shear_force", "multiplier", "slip"),
    *("slide_length", "slide", "slide_speed", "dilation"),
)
"""Fields of the memory that contacts without a history lack."""
