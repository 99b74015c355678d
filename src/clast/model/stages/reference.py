"""Where displacements count from, if that is not the start of the run."""

from __future__ import annotations

from dataclasses import dataclass

from clast.model.model import Floats
from clast.model.state import State


@dataclass(frozen=True, kw_only=True, repr=False)
class ReferenceState:
    """Where displacements and rotations count from."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    points: Floats
    """Material points, m, shape (np, 2)."""
    rotation: Floats
    """Rotation of each block since the start of the run, rad, shape (n,)."""


def here(state: State) -> ReferenceState:
    """Return a state as the reference of displacements."""
    return ReferenceState(vertices=state.vertices, points=state.points, rotation=state.rotation)
