"""What is recorded of a state: outlines, fields of the blocks, contacts, measured points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.actions.bolts.bolt_states import BoltStates
from clast.actions.bolts.bolts import Bolting
from clast.actions.relaxation import gone_in
from clast.block import polygon
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.model import Floats, Ints, Model
from clast.model.stages.reference import Reference
from clast.model.state import State
from clast.results.layout import CONTACT_ROW


class FrameFields:
    """Turns the states of one model into the arrays of frames, in user coordinates.

    Displacements and rotations count from ``reference``, or from the start of the run.
    """

    def __init__(self, model: Model, reference: Reference | None = None) -> None:
        self._model = model
        self._vertices = model.vertices if reference is None else reference.vertices
        self._rotation = None if reference is None else reference.rotation
        _, self._start, _ = polygon.moments(self._vertices, model.block_start)

    def of(self, state: State) -> dict[str, Floats]:
        """Return the arrays of a frame by their place in /VTKHDF (``layout.FRAME_ARRAYS``)."""
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
            "CellData/gone": self._gone(state),
        }

    def _gone(self, state: State) -> Floats:
        """Return 1 for blocks that have been excavated, else 0, (n,)."""
        gone = gone_in(state)
        return np.asarray(self._model.gone if gone is None else gone, np.float64)

    def contacts(self, state: State, contacts: Contacts, response: ContactResponse) -> NDArray[Any]:
        """Return a row for every contact that carries a force."""
        loaded = np.flatnonzero((response.normal_force != 0.0) | (response.shear_force != 0.0))
        rows = np.zeros(len(loaded), CONTACT_ROW)
        rows["position"] = self._places(state, contacts, loaded) + self._model.origin
        rows["normal"] = contacts.normal[loaded]
        rows["normal_force"] = response.normal_force[loaded]
        rows["shear_force"] = response.shear_force[loaded]
        rows["vertex"] = contacts.vertex[loaded]
        rows["edge"] = contacts.edge[loaded]
        rows["mode"] = response.mode[loaded]
        rows["joint"] = contacts.joint[loaded]
        return rows

    def _places(self, state: State, contacts: Contacts, rows: Ints) -> Floats:
        """Return where the points P of some contacts are, m, (k, 2)."""
        vertex, along = contacts.vertex[rows], contacts.along[rows, None]
        here = state.vertices
        return here[vertex] + along * (here[self._model.vertex_after[vertex]] - here[vertex])


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
    """Return what the springs of the bolts have been through, at the start of a run as well."""
    own = [one for one in state.actions if isinstance(one, BoltStates)]
    return own[0] if own else Bolting().begin(model)


class BoltTracker:
    """Follows the bolts of a model through its states."""

    def __init__(self, model: Model) -> None:
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

    def __init__(self, model: Model, reference: Reference | None = None) -> None:
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
