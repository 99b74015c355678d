"""Frames, and how they are read alike from a run just made and from a result file.

Frames are numbered from 0, negative numbers count from the end.  Nothing is interpolated: values
read are values computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Bools, Floats, Ints
from clast.renamed import names_of
from clast.results.result_tables import BlockHistory, FrameBolts, FrameContacts
from clast.results.schema import COMPONENTS

BLOCK_ROW = np.dtype(
    [
        ("time", "f8"),
        ("displacement", "f8", 2),
        ("velocity", "f8", 2),
        ("rotation", "f8"),
        ("stress", "f8", 3),
    ]
)
"""One block in one frame."""
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

    def bolt_points(self, frame: int) -> Floats:
        """Return the points of the bolts in a frame, m, shape (q, 2)."""
        ...


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One instant of a run as it was recorded; n blocks, nv vertices."""

    number: int
    """Its number, from 0."""
    time: float
    """Time, s."""
    store: FrameStore = field(repr=False)
    """Where it is kept."""

    @property
    def stage(self) -> str:
        """Name of its stage, "" where the run has no stages."""
        stages = self.store.frame_stages
        return stages[self.number] if stages else ""

    @property
    def vertices(self) -> Floats:
        """Vertices, m, shape (nv, 2)."""
        return self.field(VERTICES)

    def field(self, name: str) -> NDArray[Any]:
        """Return a field of the blocks, shape (n,), (n, 2) or (n, 3)."""
        return field_of(self.store, name, self.number)

    @property
    def contacts(self) -> FrameContacts:
        """The contacts that carry a force, as a table."""
        return contacts_of(self.store, self.number)


def frame_number(store: FrameStore, frame: int) -> int:
    """Return a frame's number counted from 0; negative ones count from the end."""
    count = len(store.times)
    if not -count <= frame < count:
        raise CaseError(
            f"there is no frame {frame}",
            remedy=f"there are {count} frames: 0 to {count - 1}, or -1 for the last",
        )
    return frame % count


def frame_of(store: FrameStore, number: int, at: float | None, stage: str | None) -> Frame:
    """Return a frame by its number, the one nearest to a time ``at``, s, or the last of a stage."""
    times = store.times
    if stage is not None:
        number = last_of_stage(store, stage)
    if at is not None:
        slack = 1e-9 * max(float(np.ptp(times)), abs(at))
        if not times[0] - slack <= at <= times[-1] + slack:
            raise CaseError(
                f"there is no frame at t = {at:g} s",
                remedy=f"the frames lie between {times[0]:g} and {times[-1]:g} s",
            )
        number = int(np.abs(times - at).argmin())
    number = frame_number(store, number)
    return Frame(number=number, time=float(times[number]), store=store)


def last_of_stage(store: FrameStore, stage: str) -> int:
    """Return the number of the last frame of a stage."""
    found = [number for number, name in enumerate(store.frame_stages) if name == stage]
    if not found:
        raise unknown_name("stage", stage, tuple(dict.fromkeys(store.frame_stages)))
    return found[-1]


def field_of(store: FrameStore, name: str, frame: int | None) -> NDArray[Any]:
    """Return a field in one frame, shape (n, ...), or in all, shape (frames, n, ...)."""
    known = (*store.field_names, *COMPONENTS, VERTICES)
    if name not in known:
        raise unknown_name("field", name, known)
    if name in COMPONENTS:
        whole, part = COMPONENTS[name]
        return field_of(store, whole, frame)[..., part]
    start = store.block_start
    count = int(start[-1]) if name == VERTICES else len(start) - 1
    if frame is None:
        return store.series(name, range(len(store.times)), 0, count)
    number = frame_number(store, frame)
    one: NDArray[Any] = store.series(name, range(number, number + 1), 0, count)[0]
    return one


class Fields(Protocol):
    """Fields of the blocks, frame by frame: of a run, or of a result file."""

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        ...

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        ...

    def field(self, name: str, frame: int | None = None) -> NDArray[Any]:
        """Return a field of the blocks in a frame."""
        ...


def absent_in_frame(results: Fields, frame: int) -> Bools:
    """Return which blocks are not there in a frame, shape (n,)."""
    if ABSENT not in results.field_names:  # an earlier clast wrote the file
        return np.zeros(len(results.block_start) - 1, np.bool_)
    return np.asarray(results.field(ABSENT, frame) != 0.0)


def contacts_of(store: FrameStore, frame: int) -> FrameContacts:
    """Return the contacts of a frame."""
    return FrameContacts(store.contact_rows(frame_number(store, frame)), store.block_start)


def block_of(store: FrameStore, name: str, names: Sequence[str]) -> BlockHistory:
    """Return how the block ``name`` among ``names`` moved."""
    if name not in names:
        raise unknown_name("block", name, names)
    number = list(names).index(name)
    frames = range(len(store.times))
    rows = np.zeros(len(frames), BLOCK_ROW)
    rows["time"] = store.times
    for field_name in (BLOCK_ROW.names or ())[1:]:
        rows[field_name] = store.series(field_name, frames, number, number + 1)[:, 0]
    first, past = (int(end) for end in store.block_start[number : number + 2])
    vertices = store.series(VERTICES, frames, first, past)
    return BlockHistory(rows, name, number, vertices, store.frame_stages)


def bolts_of(
    store: FrameStore, frame: int, names: Sequence[str], bolt: Ints, rows: NDArray[Any]
) -> FrameBolts:
    """Return the bolts called ``names`` in a frame, from their rows of all instants.

    ``bolt`` (q,) is that of each of their points.
    """
    number = frame_number(store, frame)
    if not len(names):
        none = np.zeros(0)
        return FrameBolts(
            name=(), points=np.zeros((0, 2)), bolt=bolt, force=none, elongation=none, state=bolt
        )
    row = rows[int(np.abs(rows["time"] - store.times[number]).argmin())]
    return FrameBolts(
        name=tuple(names),
        points=store.bolt_points(number),
        bolt=bolt,
        force=row["force"],
        elongation=row["elongation"],
        state=row["state"],
    )


def unknown_name(kind: str, name: str, known: Sequence[str]) -> CaseError:
    """Return the error for a name that does not exist, with the nearest one that does."""
    name = str(name)
    return CaseError(f"there is no {kind} '{name}'", remedy=spelling.advice(name, known, kind=kind))


__getattr__ = names_of("clast.results.frames", {"gone_in_frame": "absent_in_frame"})
