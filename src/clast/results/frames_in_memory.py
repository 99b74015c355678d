"""Frames that a run keeps in memory where no result file is written."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats, Ints, Model
from clast.model.state import ContactMemory, State
from clast.results.frames import KIND_FIELDS, VERTICES
from clast.results.layout import CELL_ARRAYS, PLANE_VECTORS
from clast.results.sampling import FrameFields


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
        """Let ``fields`` compute what is asked for of the frames that follow."""
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
        moving = (place.removeprefix("CellData/") for place in CELL_ARRAYS)
        return tuple(sorted((*moving, *KIND_FIELDS)))

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
            "fixed": model.fixed.astype(np.uint8),
        }
        if name in kinds:
            return kinds[name]
        values = fields.of(state)["Points" if name == VERTICES else f"CellData/{name}"]
        return values[:, :2] if name in (*PLANE_VECTORS, VERTICES) else values
