"""Where the frames of a run are kept: in memory, or in its result file."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Bools, Floats, Ints

ABSENT = "gone"
"""Field that is 1 for blocks that are not there: excavated, or the lining of a later stage."""
VERTICES = "vertices"
"""Name of the vertices in ``field``, which are not fields of the blocks."""


class FrameStore(Protocol):
    """Frames in memory or in a file; n blocks, nv vertices."""

    @property
    def times(self) -> Floats:
        """Time of each frame, s, shape (frames,)."""
        ...

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        ...

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        ...

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        ...

    def series(self, name: str, frames: range, first: int, past: int) -> NDArray[Any]:
        """Return rows ``first`` to ``past`` - 1 of a field in some frames, (frames, rows, ...)."""
        ...

    def contact_rows(self, frame: int) -> NDArray[Any]:
        """Return a row for every contact of a frame that carries a force."""
        ...

    def beside(self, name: str, frame: int) -> Floats:
        """Return an array of a frame beside those of blocks (``schema.BESIDE``)."""
        ...


def absent_in_frame(results: Any, frame: int) -> Bools:
    """Return which blocks of a ``Recording`` are not there in a frame, shape (n,)."""
    return np.asarray(results.field(ABSENT, frame) != 0.0)
