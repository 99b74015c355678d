"""A run with its displacements drawn larger than they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats, Ints
from clast.pictures.fields import round_below
from clast.results import Recording
from clast.results.frames import VERTICES, FrameStore, absent_in_frame
from clast.results.schema import BOLT_POINTS, TableSchema

SEEN = 0.05
"""Share of the model that the largest displacement is drawn as, where clast chooses the factor."""


@dataclass(frozen=True, kw_only=True, repr=False)
class MagnifiedRecording(Recording):
    """A run whose places are X + f (x - X): x where they are, X where they were at the start.

    Values, as stresses and displacements, are those of the run.
    """

    of: Recording
    factor: float

    @property
    def file(self) -> Path | None:
        """The result file of the run."""
        return self.of.file

    @cached_property
    def _frames(self) -> FrameStore:
        return _MagnifiedFrames(self.of, self.factor)

    def _rows(self, table: TableSchema, index: int | None = None) -> NDArray[Any]:
        return self.of._rows(table, index)


def magnified(results: Recording, factor: float) -> Recording:
    """Return the run with its displacements from the start ``factor`` times as large."""
    if factor == 1.0:
        return results
    same = {one.name: getattr(results, one.name) for one in fields(Recording)}
    return MagnifiedRecording(**same, of=results, factor=factor)


def as_it_was(results: Recording) -> Recording:
    """Return the run itself, without magnification."""
    return results.of if isinstance(results, MagnifiedRecording) else results


def factor_to_be_seen(results: Recording, frames: Sequence[int]) -> float:
    """Return the round factor with which the largest displacement is a twentieth of the model."""
    start, largest = results.vertices(0), 0.0
    for frame in frames:
        moved = np.hypot(*(results.vertices(frame) - start).T)
        there = np.repeat(~absent_in_frame(results, frame), np.diff(results.block_start))
        largest = max(largest, float(moved[there].max(initial=0.0)))
    wanted = SEEN * float(np.ptp(start, axis=0).max())
    return round_below(wanted / largest) if 0.0 < largest < wanted else 1.0


def carried(results: Recording, frame: int, block: Ints, places: Floats) -> Floats:
    """Return where places of blocks (k,) in a frame of the run are drawn, m, shape (k, 2)."""
    if not isinstance(results, MagnifiedRecording):
        return places
    start, now = results.vertices(0), results.of.vertices(frame)
    drawn = places.copy()
    for one in np.unique(block):
        corners = slice(results.block_start[one], results.block_start[one + 1])
        middle, before = now[corners].mean(axis=0), start[corners].mean(axis=0)
        # a block moves as X -> a + B X: its corners tell where a place of it was
        back = np.linalg.lstsq(now[corners] - middle, start[corners] - before)[0]
        mine = block == one
        began = before + (places[mine] - middle) @ back
        drawn[mine] = began + results.factor * (places[mine] - began)
    return drawn


class _MagnifiedFrames:
    """The frames of a run, with places that are magnified."""

    def __init__(self, of: Recording, factor: float) -> None:
        self._of, self._frames, self._factor = of, of._frames, factor
        self.times, self.block_start = of.times, of.block_start
        self.field_names, self.frame_stages = of.field_names, of.frame_stages

    def series(self, name: str, frames: range, first: int, past: int) -> NDArray[Any]:
        """Return rows ``first`` to ``past`` - 1 of a field in some frames, (frames, rows, ...)."""
        rows = self._frames.series(name, frames, first, past)
        if name != VERTICES:
            return rows
        start = self._frames.series(name, range(1), first, past)
        return np.asarray(start + self._factor * (rows - start))

    def contact_rows(self, frame: int) -> NDArray[Any]:
        """Return a row for every contact of a frame that carries a force."""
        rows = self._frames.contact_rows(frame).copy()
        block = self._of.contacts(frame).vertex_block
        drawn = magnified(self._of, self._factor)
        rows["position"] = carried(drawn, frame, block, rows["position"])
        return rows

    def beside(self, name: str, frame: int) -> Floats:
        """Return an array of a frame beside those of blocks: points of bolts are magnified."""
        values = self._frames.beside(name, frame)
        if name != BOLT_POINTS:
            return values
        start = self._frames.beside(name, 0)
        return start + self._factor * (values - start)
