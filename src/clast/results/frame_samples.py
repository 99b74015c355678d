"""The records of a state: outlines, fields, contacts, rows of tables; frames in memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from operator import attrgetter
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from clast.actions.bolts.bolt_states import BoltStates
from clast.actions.bolts.bolts import Bolting
from clast.actions.linings.linings import linings_of
from clast.actions.relaxation import absent_in
from clast.block import polygon
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.model import Floats, Ints, Model
from clast.model.stages.reference import ReferenceState
from clast.model.state import LEDGER_ENTRIES, ContactMemory, State
from clast.results.contact_samples import (
    contact_rows,
    opening_and_slip,
    places_of,
    shear_strengths,
    worn,
)
from clast.results.frames import VERTICES
from clast.results.schema import BLOCK_FIELDS, CONTACTS, KIND_FIELDS, PLANE_VECTORS
from clast.step.method import StepResult

_ledger_entries = attrgetter(*LEDGER_ENTRIES)


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
        sigma_1, sigma_3 = principal_stresses(state.stress)
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
            "CellData/gone": self._absent(state),
        }

    def _absent(self, state: State) -> Floats:
        """Return 1 for blocks that are not there, else 0, (n,)."""
        absent = absent_in(state)
        return np.asarray(self._model.absent if absent is None else absent, np.float64)

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


def principal_stresses(stress: Floats) -> tuple[Floats, Floats]:
    """Return sigma_1 >= sigma_3 in the plane, Pa, tension positive, from stress (n, 3)."""
    xx, yy, xy = stress.T
    mean = 0.5 * (xx + yy)
    radius = np.hypot(0.5 * (xx - yy), xy)
    return mean + radius, mean - radius


def own_of_bolts(model: Model, state: State) -> BoltStates:
    """Return the states of the springs of the bolts, at the start of a run as well."""
    own = [one for one in state.actions if isinstance(one, BoltStates)]
    return own[0] if own else Bolting().begin(model)


class Tracker(Protocol):
    """Gives the rows of a table."""

    def row(self, state: State) -> tuple[Any, ...]:
        """Return the row of an instant, its entries in the order of the columns."""
        ...


class LedgerTracker:
    """Follows the energy ledger."""

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        pass

    def row(self, state: State) -> tuple[float, ...]:
        """Return time and every entry of the ledger."""
        return state.time, *_ledger_entries(state.ledger)


class BoltTracker:
    """Follows the bolts of a model through its states."""

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        self._model = model
        self._count = len(model.bolts)

    def row(self, state: State) -> tuple[float, Floats, Floats, Ints]:
        """Return time, and force, elongation and state (k,) of each bolt: of its worst spring."""
        bolts, count = self._model.bolts, self._count
        own, owner = own_of_bolts(self._model, state), bolts.of_spring
        force, elongation, worst = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
        stretched = own.elongation(bolts)
        order = np.argsort(np.abs(own.force), kind="stable")  # the largest is written last
        force[owner[order]] = own.force[order]
        elongation[owner[order]] = stretched[order]
        np.maximum.at(worst, owner, own.state)
        return state.time, force, elongation, worst


class PointTracker:
    """Follows the measured points of a model through its states.

    Their displacements and rotations count from ``reference``, or from the start of the run.
    """

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        points = model.measured_points
        total = len(model.material_points.block)
        self._rows = slice(total - len(points.block), total)
        self._start = points.at if reference is None else reference.points[self._rows]
        self._block = points.block
        self._rotation = None if reference is None else reference.rotation[points.block]
        self._rotations = np.zeros(len(points.block))
        # Centroids are wanted of the points' blocks only: their vertices, block after block.
        blocks, self._outline = np.unique(points.block, return_inverse=True)
        outlines = [np.arange(model.block_start[b], model.block_start[b + 1]) for b in blocks]
        self._vertices = np.concatenate([np.zeros(0, np.int64), *outlines])
        self._outline_start = np.cumsum([0, *map(len, outlines)])

    def row(self, state: State) -> tuple[float, Floats, Floats, Floats]:
        """Return time and displacement (k, 2), velocity (k, 2), rotation (k,) of the points."""
        at = state.points[self._rows]
        if not len(at):
            return state.time, at, at, self._rotations
        _, centroid, _ = polygon.moments(state.vertices[self._vertices], self._outline_start)
        velocity = point_velocity(at - centroid[self._outline], state.velocity[self._block])
        rotation = counted(state.rotation[self._block], self._rotation)
        return state.time, at - self._start, velocity, rotation


ACROSS = np.array([1.0, -1.0])
"""Signs of (y, x) of a vector that is turned by a quarter, clockwise."""


class ReactionTracker:
    """Follows the reactions of a model through its states."""

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        self._about = model.reactions.about
        self._origin = model.origin

    def row(self, state: State) -> tuple[float, Floats, Floats, Floats]:
        """Return time, and force (k, 2), moment (k,) and point of application (k, 2) of each."""
        found = state.reactions if state.reactions.size else np.zeros((len(self._about), 3))
        force, moment = found[:, :2], found[:, 2]
        square = np.add.reduce(force**2, axis=1)
        ratio = np.empty(square.shape)
        ratio.fill(np.nan)
        np.divide(moment, square, out=ratio, where=square > 0.0)
        arm = force[:, ::-1] * ACROSS * ratio[:, None]
        return state.time, force, moment, self._about + self._origin + arm


class LinkTracker:
    """Follows the links of a model through its states."""

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        self._model = model

    def row(self, state: State) -> tuple[float, Floats, Floats, Ints]:
        """Return time, and force (k, 2), moment (k,) and state (k,) of each link."""
        actions = self._model.actions
        own = state.actions[-len(actions) :] or [one.begin(self._model) for one in actions]
        pairs = [
            (one, mine) for one, mine in zip(actions, own, strict=True) if hasattr(one, "borne")
        ]
        borne = np.concatenate([one.borne(mine) for one, mine in pairs])
        condition = np.concatenate([one.condition(mine) for one, mine in pairs])
        return state.time, borne[:, :2], borne[:, 2], condition


class LiningTracker:
    """Follows the linings of a model through its states."""

    def __init__(self, model: Model, reference: ReferenceState | None = None) -> None:
        self._model = model
        self._linings, self._number = linings_of(model)

    def row(self, state: State) -> tuple[float, Floats, Floats, Floats, Floats, Ints]:
        """Return time, and N, Q, M, utilisation and state (k,) of each joint."""
        linings = self._linings
        if linings is None:
            none = np.zeros(0)
            return state.time, none, none, none, none, np.zeros(0, np.int64)
        place = self._number - len(self._model.actions)
        own = state.actions[place] if state.actions else linings.begin(self._model)
        used = linings.utilisation(own)
        return state.time, *linings.forces(own).T, used, linings.condition(own)


ROWS: dict[str, Callable[[Model, ReferenceState | None], Tracker]] = {
    "energy": LedgerTracker,
    "history": PointTracker,
    "bolts": BoltTracker,
    "reactions": ReactionTracker,
    "links": LinkTracker,
    "linings": LiningTracker,
}
"""Tables with a row per instant -> the function that gives their rows from a reference on."""


def step_row(result: StepResult, step: float, unbalanced: float) -> tuple[float, ...]:
    """Return the row of an accepted step of length ``step``, s, with its unbalanced force."""
    return (
        result.state.time,
        step,
        result.passes,
        len(result.contacts),
        result.penetration,
        result.travel,
        unbalanced,
    )


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


class FramesInMemory:
    """The frames of a run in memory, as states; their fields are computed when asked for.

    Frames beyond ``limit`` bytes are not kept, but for the last.
    """

    def __init__(self, model: Model, limit: float) -> None:
        self._model = model
        self._fields = FrameFields(model)
        self._frames: list[tuple[State, NDArray[Any], FrameFields]] = []
        self._stages: list[str] = []
        self._bytes = 0
        self._limit = limit
        self.left_out_from: float | None = None
        """Time from which frames found no room, s; the last is kept all the same."""

    def count_from(self, fields: FrameFields) -> None:
        """Make ``fields`` compute the requested fields of the frames that follow."""
        self._fields = fields

    def add(self, state: State, contacts: NDArray[Any], stage: str) -> None:
        """Keep a state, the rows of its contacts and the name of its stage."""
        state = replace(state, memory=ContactMemory())
        arrays = (state.vertices, state.velocity, state.stress, state.rotation, contacts)
        self._bytes += sum(array.nbytes for array in arrays)
        if self._bytes > self._limit and len(self._frames) > 1:
            if self.left_out_from is None:
                self.left_out_from = self._frames[-1][0].time
            self._frames.pop()
            self._stages.pop()
        self._frames.append((state, contacts, self._fields))
        self._stages.append(stage)

    @property
    def times(self) -> Floats:
        """Time of each frame, s, shape (frames,)."""
        return np.array([state.time for state, *_ in self._frames])

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        return tuple(self._stages) if any(self._stages) else ()

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
        return self._frames[frame][1]

    def bolt_points(self, frame: int) -> Floats:
        """Return the points of the bolts in a frame, m, shape (q, 2)."""
        rows = self._model.point_slices.bolts
        return np.asarray(self._frames[frame][0].points[rows] + self._model.origin)

    def _one(self, name: str, frame: int) -> NDArray[Any]:
        """Return a field of one frame, shape (n, ...), or its vertices, (nv, 2)."""
        model = self._model
        state, _, fields = self._frames[frame]
        kinds: dict[str, NDArray[Any]] = {
            "block": np.arange(model.block_count),
            "rock": model.block_rock,
            "fixed": (model.fixed & ~model.lined).astype(np.uint8),
        }
        if name in kinds:
            return kinds[name]
        values = fields.of(state)["Points" if name == VERTICES else f"CellData/{name}"]
        return values[:, :2] if name in (*PLANE_VECTORS, VERTICES) else values
