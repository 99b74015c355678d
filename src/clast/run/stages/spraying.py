"""Linings that a stage adds: segments without stress on the outline of the rock as it is by then.

Points of the outer face lie on the edges of the rock that they were drawn on, wherever these have
got to; where two blocks meet there, halfway between them.  Faces between segments turn with the
chords of the segments, so that the thickness stays.  Contacts with the rock carry nothing: the
force that a gap or an overlap of faces, both filled, would give is the rest force of their spring.
A gap at the end of a lining, to a floor for one, is not filled.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np

from clast.actions.active import actions_of, states_of
from clast.actions.linings import Linings, LiningShape, LiningStates, OneLining, linings_of
from clast.actions.relaxation import SupportForces
from clast.block import polygon
from clast.contact.contacts import LOCK, Contacts
from clast.contact.joints.barton_bandis import rough_contacts
from clast.contact.joints.bonds import are_closed
from clast.contact.joints.flush import flush_edges
from clast.contact.laws import normal_stiffness_of
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stage_records import Event
from clast.model.stages import Stage
from clast.model.state import ContactMemory, State
from clast.run.excavation import without
from clast.step.method import Method
from clast.step.search_distance import search_within_step, travel_expected
from clast.step.start import begin


def added_by(model: Model, stage: Stage) -> tuple[OneLining, ...]:
    """Return the linings that a stage installs."""
    linings, _ = linings_of(model)
    return tuple(one for one in linings.each if one.stage == stage.name) if linings else ()


def events_of_linings(model: Model, stage: Stage, time: float) -> Iterator[Event]:
    """Yield the events of linings at the start of a stage."""
    for one in added_by(model, stage):
        text = f"lining '{one.name}' is installed"
        yield Event(time=time, stage=stage.name, kind="installed", what=one.name, text=text)


def lined(
    model: Model, method: Method, state: State, stage: Stage, step: float
) -> tuple[Model, State]:
    """Return model and state with the linings of a stage that begins; its steps are ``step``, s."""
    fresh = added_by(model, stage)
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
    way = np.stack([np.interp(np.arange(count), carried, mean[:, k]) for k in (0, 1)], axis=1)
    return np.asarray(shape.at + way)


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
    places[one.joints] = middles[one.face[:, 0], one.face[:, 1]][:, None]
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


# contacts with the rock --------------------------------------------------------------------------


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
        mode=np.full(len(near), LOCK),
        **{name: none for name in ZERO},
    )
    joined = {
        one.name: np.concatenate([getattr(state.memory, one.name), getattr(ours, one.name)])
        for one in fields(ContactMemory)
    }
    order = _order(joined["vertex"], joined["block"], joined["edge"], joined["point"])
    return ContactMemory(**{name: values[order] for name, values in joined.items()})


def _beside(model: Model, contacts: Contacts, coming: Bools, direction: Floats) -> Bools:
    """Return which contacts are along ends and inner faces of segments that come, (m,).

    What is sprayed on fills gaps of the outer face; these stay open.
    """
    others = np.zeros(len(direction) + 1, np.bool_)  # and of -1, which is none
    for last in model.block_start[1:][coming]:
        others[last - 3 : last] = True
    flush = flush_edges(contacts.vertex, contacts.edge, direction, model.block_start)
    own = [np.where(contacts.point > 0, contacts.vertex, one) for one in flush]
    on_outer = [coming[contacts.vertex_block] & (one >= 0) & ~others[one] for one in own]
    own_beside = (others[own[0]] | others[own[1]]) & ~(on_outer[0] | on_outer[1])
    return np.asarray(own_beside | others[contacts.edge])


ZERO = (
    "normal_force",
    "shear_force",
    "multiplier",
    "slip",
    "slide_length",
    "slide",
    "slide_speed",
    "dilation",
)
"""Fields of the memory that contacts without a history lack."""


def _order(vertex: Ints, block: Ints, edge: Ints, point: Ints) -> Ints:
    """Return the order of the memory: vertices, then points of faces."""
    inside = point > 0
    keys = np.where(inside, edge, block), np.where(inside, point, edge)
    return np.lexsort((keys[1], keys[0], vertex, inside))
