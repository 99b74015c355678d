"""The records of a state: outlines, fields, contacts, rows of tables; frames in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.actions.bolts import Bolting, BoltStates
from clast.actions.linings import linings_of
from clast.actions.relaxation import absent_in
from clast.block import polygon
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.checks import point_text
from clast.model.model import Floats, Ints, Model
from clast.model.state import LEDGER_ENTRIES, ContactMemory, ReferenceState, State
from clast.results.contact_samples import (
    contact_rows,
    opening_and_slip,
    places_of,
    shear_strengths,
    worn,
)
from clast.results.frames import VERTICES
from clast.results.schema import (
    BESIDE,
    BLOCK_FIELDS,
    BOLT_POINTS,
    CHANNELS,
    CONTACTS,
    FLOWS,
    KIND_FIELDS,
    PLANE_VECTORS,
)
from clast.step.method import StepResult

_ledger_entries = attrgetter(*LEDGER_ENTRIES)
RowOf = Callable[[State], tuple[Any, ...]]
"""Returns the row of an instant, its entries in the order of the columns."""


def beside_of(model: Model, state: State) -> dict[str, Floats]:
    """Return the arrays of a frame beside those of blocks (``schema.BESIDE``)."""
    arrays = {BOLT_POINTS: state.points[model.point_slices.bolts] + model.origin}
    return arrays if model.flow is None else {**arrays, CHANNELS: channel_values(model, state)}


class FrameFields:
    """Turns the states of one model into the arrays of frames, in user coordinates.

    Displacements and rotations count from ``reference``, or from the start of the run.
    """

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        self._model = model
        self._vertices = model.vertices if reference is None else reference.vertices
        self._rotation = None if reference is None else reference.rotation
        _, self._start, _ = polygon.moments(self._vertices, model.block_start)

    def of(self, state: State) -> dict[str, Floats]:
        """Return the arrays of a frame by their place in /VTKHDF (``schema.FIELDS``)."""
        model = self._model
        _, centroid, _ = polygon.moments(state.vertices, model.block_start)
        # sigma_1 >= sigma_3 in the plane, Pa, tension positive, from stress (n, 3).
        xx, yy, xy = state.stress.T
        mean = 0.5 * (xx + yy)
        radius = np.hypot(0.5 * (xx - yy), xy)
        sigma_1, sigma_3 = mean + radius, mean - radius
        absent = absent_in(state)
        return {
            "Points": with_z(state.vertices + model.origin),
            "PointData/displacement": with_z(state.vertices - self._vertices),
            "CellData/displacement": with_z(centroid - self._start),
            "CellData/velocity": with_z(state.velocity[:, :2]),
            "CellData/rotation": counted(state.rotation, self._rotation),
            "CellData/stress": state.stress,
            "CellData/sigma_1": sigma_1,
            "CellData/sigma_3": sigma_3,
            "CellData/max_shear": 0.5 * (sigma_1 - sigma_3),
            "CellData/gone": np.asarray(model.absent if absent is None else absent, np.float64),
        }

    def contacts(self, state: State, contacts: Contacts, response: ContactResponse) -> NDArray[Any]:
        """Return a row for every contact that carries a force."""
        loaded = np.flatnonzero((response.normal_force != 0.0) | (response.shear_force != 0.0))
        rows = np.zeros(len(loaded), CONTACTS.row)
        rows["position"] = places_of(self._model, state, contacts, loaded) + self._model.origin
        rows["normal"] = contacts.normal[loaded]
        rows["normal_force"] = response.normal_force[loaded]
        rows["shear_force"] = response.shear_force[loaded]
        rows["vertex"] = contacts.vertex[loaded]
        rows["edge"] = contacts.edge[loaded]
        rows["mode"] = response.mode[loaded]
        rows["joint"] = contacts.joint[loaded]
        rows["opening"], rows["slip"] = opening_and_slip(self._model, state, contacts, loaded)
        rows["strength"] = shear_strengths(contacts, response, loaded)
        rows["worn"] = worn(self._model, state, (contacts, response.bonded), loaded)
        return rows


def counted(rotation: Floats, reference: Floats | None) -> Floats:
    """Return rotations (n,), rad, as they count from those of ``reference``, if there are any."""
    return rotation if reference is None else rotation - reference


def with_z(plane: Floats) -> Floats:
    """Return vectors (k, 2) as VTK wants them: (k, 3) with z = 0."""
    space = np.zeros((len(plane), 3))
    space[:, :2] = plane
    return space


def bolt_states(model: Model, state: State) -> BoltStates:
    """Return the states of the springs of the bolts, at the start of a run as well."""
    states = [one for one in state.actions if isinstance(one, BoltStates)]
    return states[0] if states else Bolting().begin(model)


def joint_water(model: Model, state: State) -> Any:
    """Return the water in joints (actions/flow.py), at the start of a run as well."""
    from clast.actions.flow import JointWater, water_at  # few cases need it

    return next((one for one in state.actions if isinstance(one, JointWater)), None) or water_at(
        model, state.time
    )


def channel_values(model: Model, state: State) -> Floats:
    """Return the water in the channels that the model has at its start (``schema.CHANNELS``)."""
    count, flow = BESIDE[CHANNELS][1](model), model.flow
    values = np.zeros((count, BESIDE[CHANNELS][0]))
    if not count or flow is None or flow.network is None:
        return values
    from clast.actions.flow import wet_share

    water = joint_water(model, state)
    network, solved = water.network, water.solved
    columns = (solved.pressure[network.node], solved.saturation[network.node], water.aperture)
    whole = np.column_stack([*columns, solved.flow, wet_share(water, flow)])
    if len(whole) == count:
        return whole
    # those that are left are the same to the last bit
    key = [
        np.concatenate([one.edge, one.share.reshape(-1, 4)], axis=1)
        for one in (flow.network, network)
    ]
    _, number = np.unique(np.concatenate(key), axis=0, return_inverse=True)
    place = np.zeros(number.max(initial=-1) + 1, np.int64)
    place[number[:count]] = np.arange(count)
    values[place[number[count:]]] = whole
    return values


def flow_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time and the columns of ``FLOW_TABLE`` of parts and all, (k,) each."""
    names = FLOWS.names(model)

    def row(state: State) -> tuple[Any, ...]:
        water, count = joint_water(model, state), len(names)
        solved, part = water.solved, water.conditions.part
        pressure = np.zeros(count)
        np.maximum.at(pressure, part[part >= 0], solved.pressure[part >= 0])
        none = np.zeros(count - 1)
        columns = _exchange(water, count)
        pressure[-1] = solved.pressure.max(initial=0.0)
        stored = np.append(none, solved.stored)
        content = np.append(none, water.content(model.flow))
        removed = np.append(none, water.removed)
        unaccounted = np.append(none, solved.unaccounted)
        iterations = np.append(none, solved.iterations).astype(np.int64)
        of_all = (content, stored, removed, unaccounted, iterations)
        return state.time, *columns, pressure, *of_all

    return row


def _exchange(water: Any, count: int) -> Floats:
    """Return flows in, out and run off of parts and all, m2/s, shape (3, count)."""
    parts = water.exchange
    result = np.zeros((3, count))
    result[:, : parts.shape[1]], result[:, -1] = parts, parts.sum(axis=1)
    return result


LITRES = 1e3 * 60.0 * 10.0
"""l/min per 10 m of a flow of 1 m2/s."""


def flow_notes(model: Model, state: State) -> tuple[str, ...]:
    """Return flows at boundaries and wells at the end, largest pressure, Re, unaccounted flow."""
    if model.flow is None:
        return ()
    water, names = joint_water(model, state), FLOWS.names(model)
    _, into, out, runoff, pressure, *_, unaccounted, _ = flow_rows(model, None)(state)
    notes = []
    for k, name in enumerate(names[:-1]):
        for rate, way in ((out[k], "leaves the rock"), (into[k], "enters the rock")):
            # what is next to nothing beside what pressures could drive is rounding
            if rate > 1e-9 * water.solved.throughput:
                ten = f"{LITRES * rate:.4g} l/min per 10 m"
                notes.append(f"flow: {rate:.4g} m3/s per m ({ten}) {way} at '{name}'")
        if runoff[k] > 0.0:
            notes.append(f"flow: {runoff[k]:.4g} m3/s per m of rain run off at '{name}'")
    if len(water.solved.pressure):
        at = water.network.at[water.solved.pressure.argmax()] + model.origin
        largest = f"flow: largest pressure {pressure[-1]:.4g} Pa, at {point_text(at)}"
        notes.append(f"{largest}; {abs(unaccounted[-1]):.2g} m3/s per m unaccounted for")
        reynolds = model.flow.reynolds(water.solved.flow)
        if reynolds.any():
            at = water.network.middle[reynolds.argmax()] + model.origin
            notes.append(f"flow: largest Re = rho q/mu {reynolds.max():.3g}, at {point_text(at)}")
    return tuple(notes)


def measured_flow_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, inflow and outflow of each measured flow, (k,) each."""
    names = FLOWS.names(model)
    measured = model.flow.measured if model.flow else ()
    which = np.array([names.index(of) for _, of in measured], np.int64)

    def row(state: State) -> tuple[Any, ...]:
        into, out, _ = _exchange(joint_water(model, state), len(names))[:, which]
        return state.time, into, out

    return row


def ledger_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time and every entry of the ledger."""
    return lambda state: (state.time, *_ledger_entries(state.ledger))


def bolt_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, force, elongation and state (k,) of each bolt's worst spring."""
    bolts, count = model.bolts, len(model.bolts)

    def row(state: State) -> tuple[Any, ...]:
        springs, owner = bolt_states(model, state), bolts.of_spring
        force, elongation, worst = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
        order = np.argsort(np.abs(springs.force), kind="stable")  # the largest is written last
        force[owner[order]] = springs.force[order]
        elongation[owner[order]] = springs.elongation(bolts)[order]
        np.maximum.at(worst, owner, springs.state)
        return state.time, force, elongation, worst

    return row


def point_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, displacement, velocity (k, 2), rotation (k,) of the points.

    Displacements and rotations count from ``reference``, or from the start of the run.
    """
    points, total = model.measured_points, len(model.material_points.block)
    rows = slice(total - len(points.block), total)
    start = points.at if reference is None else reference.points[rows]
    turned = None if reference is None else reference.rotation[points.block]
    # Centroids are wanted of the points' blocks only: their vertices, block after block.
    blocks, outline = np.unique(points.block, return_inverse=True)
    outlines = [np.arange(model.block_start[b], model.block_start[b + 1]) for b in blocks]
    vertices = np.concatenate([np.zeros(0, np.int64), *outlines])
    outline_start = np.cumsum([0, *map(len, outlines)])

    def row(state: State) -> tuple[Any, ...]:
        at = state.points[rows]
        if not len(at):
            return state.time, at, at, np.zeros(0)
        _, centroid, _ = polygon.moments(state.vertices[vertices], outline_start)
        velocity = point_velocity(at - centroid[outline], state.velocity[points.block])
        return state.time, at - start, velocity, counted(state.rotation[points.block], turned)

    return row


def convergence_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time and the approach (k,) of the points of each convergence."""
    points, slices = model.measured_points, model.point_slices
    start = points.at if reference is None else reference.points[slices.measured]
    first, second = model.convergences.point.T
    way = points.at[second] - points.at[first]
    way /= np.hypot(*way.T)[:, None]

    def row(state: State) -> tuple[Any, ...]:
        moved = state.points[slices.measured] - start
        return state.time, np.add.reduce((moved[first] - moved[second]) * way, axis=1)

    return row


ACROSS = np.array([1.0, -1.0])
"""Signs of (y, x) of a vector that is turned by a quarter, clockwise."""


def reaction_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, force (k, 2), moment (k,), point of application (k, 2)."""
    about = model.reactions.about

    def row(state: State) -> tuple[Any, ...]:
        reactions = state.reactions if state.reactions.size else np.zeros((len(about), 3))
        force, moment = reactions[:, :2], reactions[:, 2]
        square = np.add.reduce(force**2, axis=1)
        ratio = np.empty(square.shape)
        ratio.fill(np.nan)
        np.divide(moment, square, out=ratio, where=square > 0.0)
        arm = force[:, ::-1] * ACROSS * ratio[:, None]
        return state.time, force, moment, about + model.origin + arm

    return row


def link_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, force (k, 2), moment (k,) and state (k,) of each link."""
    actions = model.actions

    def row(state: State) -> tuple[Any, ...]:
        states = state.actions[-len(actions) :] or [one.begin(model) for one in actions]
        pairs = [pair for pair in zip(actions, states, strict=True) if hasattr(pair[0], "borne")]
        forces = np.concatenate([one.borne(held) for one, held in pairs])
        condition = np.concatenate([one.condition(held) for one, held in pairs])
        return state.time, forces[:, :2], forces[:, 2], condition

    return row


def lining_rows(model: Model, reference: ReferenceState | None) -> RowOf:
    """Return the function of time, N, Q, M, utilisation and state (k,) of each joint."""
    linings, number = linings_of(model)

    def row(state: State) -> tuple[Any, ...]:
        if linings is None:
            return state.time, *np.zeros((4, 0)), np.zeros(0, np.int64)
        place = number - len(model.actions)
        joints = state.actions[place] if state.actions else linings.begin(model)
        used = linings.utilisation(joints)
        return state.time, *linings.forces(joints).T, used, linings.condition(joints)

    return row


ROWS: dict[str, Callable[[Model, ReferenceState | None], RowOf]] = {
    "energy": ledger_rows,
    "history": point_rows,
    "bolts": bolt_rows,
    "reactions": reaction_rows,
    "links": link_rows,
    "linings": lining_rows,
    "convergences": convergence_rows,
    "flow": flow_rows,
    "measured_flows": measured_flow_rows,
}
"""Tables with a row per instant -> the function that gives their rows from a reference on."""


def step_row(result: StepResult, step: float, unbalanced: float) -> tuple[float, ...]:
    """Return the row of an accepted step of length ``step``, s, with its unbalanced force."""
    contacts, penetration = len(result.contacts), result.penetration
    return result.state.time, step, result.passes, contacts, penetration, result.travel, unbalanced


STEP_ROWS: dict[str, Callable[[Model], Callable[[StepResult, float, float], tuple[Any, ...]]]] = {
    "steps": lambda model: step_row,
    "measured_contacts": contact_rows,
}
"""Tables with a row per step -> the function that gives their rows."""


def point_velocity(offset: Floats, velocity: Floats) -> Floats:
    """Return the velocity (k, 2), m/s, of points at ``offset`` (k, 2) from their block's centroid.

    ``velocity`` (k, 6) is the block's (u, v, r, ex, ey, gxy): translation, spin and strain rate.
    """
    x, y = offset.T
    u, v, spin, ex, ey, gxy = velocity.T
    out = np.empty_like(offset)
    out[:, 0] = u - y * spin + x * ex + 0.5 * y * gxy
    out[:, 1] = v + x * spin + y * ey + 0.5 * x * gxy
    return out


@dataclass(frozen=True, kw_only=True)
class PlaceOfFrame:
    """Where a frame is in its run."""

    name: str
    """Name of its stage, "" where the run has no stages."""
    stage: int
    """Number of its stage."""
    counts: Mapping[str, int]
    """Rows of each table when it was kept."""


class FramesInMemory:
    """The frames of a run in memory, as states; their fields are computed when asked for.

    Frames beyond ``limit`` bytes are not kept, but for the last.
    """

    def __init__(self, model: Model, limit: float) -> None:
        self._model = model
        self._fields = FrameFields(model)
        self.kept: list[tuple[State, NDArray[Any], FrameFields, PlaceOfFrame]] = []
        """The frames: state, rows of contacts, the maker of fields, and the place in the run."""
        self._bytes = 0
        self._limit = limit
        self.left_out_from: float | None = None
        """Time from which frames are dropped, s; the last is kept all the same."""

    def count_from(self, fields: FrameFields) -> None:
        """Make ``fields`` compute the requested fields of the frames that follow."""
        self._fields = fields

    def add(self, state: State, contacts: NDArray[Any], place: PlaceOfFrame) -> None:
        """Keep a state, the rows of its contacts and its place in the run."""
        state = replace(state, memory=ContactMemory())
        arrays = (state.vertices, state.velocity, state.stress, state.rotation, contacts)
        self._bytes += sum(array.nbytes for array in arrays)
        if self._bytes > self._limit and len(self.kept) > 1:
            if self.left_out_from is None:
                self.left_out_from = self.kept[-1][0].time
            self.kept.pop()
        self.kept.append((state, contacts, self._fields, place))

    @property
    def times(self) -> Floats:
        """Time of each frame, s, shape (frames,)."""
        return np.array([state.time for state, *_ in self.kept])

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        names = tuple(place.name for *_, place in self.kept)
        return names if any(names) else ()

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        return self._model.block_start

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        return tuple(sorted((*(one.name for one in BLOCK_FIELDS), *KIND_FIELDS)))

    def series(self, name: str, frames: range, first: int, past: int) -> NDArray[Any]:
        """Return rows ``first`` to ``past`` - 1 of a field in some frames, (frames, rows, ...)."""
        return np.stack([self._one(name, frame)[first:past] for frame in frames])

    def contact_rows(self, frame: int) -> NDArray[Any]:
        """Return a row for every contact of a frame that carries a force."""
        return self.kept[frame][1]

    def beside(self, name: str, frame: int) -> Floats:
        """Return an array of a frame beside those of blocks (``schema.BESIDE``)."""
        return beside_of(self._model, self.kept[frame][0])[name]

    def _one(self, name: str, frame: int) -> NDArray[Any]:
        """Return a field of one frame, shape (n, ...), or its vertices, (nv, 2)."""
        model = self._model
        state, _, fields, _ = self.kept[frame]
        kinds: dict[str, NDArray[Any]] = {
            "block": np.arange(model.block_count),
            "rock": model.block_rock,
            "fixed": (model.fixed & ~model.lined).astype(np.uint8),
        }
        if name in kinds:
            return kinds[name]
        values = fields.of(state)["Points" if name == VERTICES else f"CellData/{name}"]
        return values[:, :2] if name in (*PLANE_VECTORS, VERTICES) else values
