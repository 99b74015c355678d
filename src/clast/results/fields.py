"""What a frame of the result file holds of a state: geometry, fields of the blocks, contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.block import polygon
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.results.tables import CONTACT_ROW


class FrameFields:
    """Turns the states of one model into the arrays of frames, in user coordinates."""

    def __init__(self, model: Model) -> None:
        self._model = model
        _, self._start, _ = polygon.moments(model.vertices, model.block_start)

    def of(self, state: State) -> dict[str, Floats]:
        """Return the arrays of a frame by their place in /VTKHDF (``layout.FRAME_ARRAYS``)."""
        model = self._model
        _, centroid, _ = polygon.moments(state.vertices, model.block_start)
        sigma_1, sigma_3 = principal_stresses(state.stress)
        return {
            "Points": with_z(state.vertices + model.origin),
            "PointData/displacement": with_z(state.vertices - model.vertices),
            "CellData/displacement": with_z(centroid - self._start),
            "CellData/velocity": with_z(state.velocity[:, :2]),
            "CellData/rotation": state.rotation,
            "CellData/stress": state.stress,
            "CellData/sigma_1": sigma_1,
            "CellData/sigma_3": sigma_3,
            "CellData/max_shear": 0.5 * (sigma_1 - sigma_3),
        }

    def contacts(self, state: State, contacts: Contacts, response: ContactResponse) -> NDArray[Any]:
        """Return a row for every contact that carries a force."""
        loaded = np.flatnonzero((response.normal_force != 0.0) | (response.shear_force != 0.0))
        rows = np.zeros(len(loaded), CONTACT_ROW)
        rows["position"] = state.vertices[contacts.vertex[loaded]] + self._model.origin
        rows["normal"] = contacts.normal[loaded]
        rows["normal_force"] = response.normal_force[loaded]
        rows["shear_force"] = response.shear_force[loaded]
        rows["vertex"] = contacts.vertex[loaded]
        rows["edge"] = contacts.edge[loaded]
        rows["mode"] = response.mode[loaded]
        return rows


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
