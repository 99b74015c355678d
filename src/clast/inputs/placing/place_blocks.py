"""Blocks as a case file or a script hands them over: as arrays with a row for each block."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.blocks import BlockTable
from clast.inputs.declaring.values import number_of
from clast.model import ranges
from clast.model.model import Bools, Floats, Ints

Vector = Sequence[float] | Floats
"""Two or three numbers."""
Names = np.ndarray[Any, np.dtype[np.str_]]
"""Names in an array."""


@dataclass(frozen=True)
class BlockArrays:
    """k blocks: loops of s vertices (k, s, 2), or (nv, 2) cut by ``start`` (k + 1,)."""

    first: int
    """Number of the first of them among all blocks, from 0."""
    given_names: Sequence[str] | None
    rock: str | Sequence[str] | None
    vertices: Any
    start: Any
    fixed: Any
    velocity: Any
    initial_stress: Any
    joints: Any = None
    """Name of the joint of each edge, or none."""

    @classmethod
    def of_table(cls, first: int, record: BlockTable) -> BlockArrays:
        """Return one block, which its table has judged; its name is its number if it has none."""
        return cls(
            first,
            None if record.name is None else [record.name],
            record.rock,
            np.array(record.vertices, np.float64).reshape(-1, 2),
            [0, len(record.vertices)],
            record.fixed,
            record.velocity,
            record.initial_stress,
            record.edge_joint,
        )

    def label(self, block: int) -> str:
        """Return how messages call a block of these."""
        number, name = str(self.first + block + 1), shortened(self.names[block])
        return f"block {number}" if name == number else f"block {number} '{name}'"

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Their names: their numbers from 1, unless some are given."""
        if self.given_names is None:
            return tuple(map(str, range(self.first + 1, self.first + self._count + 1)))
        try:
            names = tuple(self.given_names)
        except TypeError:
            raise self._error("are not a list of names", "names") from None
        if len(names) != self._count:
            raise self._error(f"{len(names)} names are given for {self._count} blocks", "names")
        return names

    def edge_joints(self) -> Names:
        """Return the name of the joint of each edge, "" for none of its own."""
        given, edges = self.joints, len(self.loops[1])
        if given is None:
            return np.full(edges, "")
        whole = not isinstance(given, str) and len(given) == edges
        if whole and all(one is None or isinstance(one, str) for one in given):
            return np.array(["" if one is None else str(one) for one in given], np.str_)
        where = self.label(0) if self._count == 1 else f"blocks from number {self.first + 1} on"
        raise ModelError(
            f"does not name a joint for each of its {edges} edges",
            where=f"{where}, edge_joint",
            remedy='give one name for each vertex, that of the edge that begins there; "" for '
            "edges without a joint of their own",
        )

    def held(self) -> Bools:
        """Return True where a block is fixed, shape (k,)."""
        fixed = np.asarray(self.fixed)
        if fixed.dtype != np.bool_ or fixed.shape not in ((), (self._count,)):
            raise self._error("give one truth value, or one for each block", "fixed")
        return np.broadcast_to(fixed, (self._count,))

    def velocities(self) -> Floats:
        """Return the velocity of each block, shape (k, 3)."""
        return self._rows(self.velocity, "velocity", ranges.SPEED)

    def stresses(self) -> Floats | None:
        """Return the stress of each block, Pa, shape (k, 3), or None."""
        given = self.initial_stress
        return None if given is None else self._rows(given, "initial_stress", ranges.STRESS)

    @property
    def _count(self) -> int:
        return len(self.loops[0])

    @cached_property
    def loops(self) -> tuple[Ints, Floats]:
        """Vertex count of each loop (k,), and the vertices (nv, 2), m."""
        try:
            vertices = np.asarray(self.vertices, np.float64)
            start = None if self.start is None else np.asarray(self.start)
        except (TypeError, ValueError, OverflowError):
            raise self._error("are not arrays of numbers", "vertices and start") from None
        if start is None:
            if vertices.ndim != 3 or vertices.shape[2] != 2:
                raise self._error(f"have shape {vertices.shape}", "vertices")
            count, sides, _ = vertices.shape
            return np.full(count, sides, np.int64), vertices.reshape(-1, 2)
        if vertices.ndim != 2 or vertices.shape[1] != 2:
            raise self._error(f"have shape {vertices.shape}", "vertices")
        whole = start.ndim == 1 and len(start) > 0 and np.issubdtype(start.dtype, np.integer)
        if not whole or start[0] != 0 or start[-1] != len(vertices) or (np.diff(start) < 0).any():
            raise self._error("does not run from 0 up to the number of vertices", "start")
        return np.diff(start).astype(np.int64), vertices

    def _rows(self, values: Any, key: str, limits: ranges.AllowedRange) -> Floats:
        """Return three numbers for each block (k, 3), the same for all where three are given."""
        try:
            rows = np.asarray(values, np.float64)
        except (TypeError, ValueError, OverflowError):
            rows = np.zeros(0)
        if rows.shape not in ((3,), (self._count, 3)) or not np.isfinite(rows).all():
            raise self._error("give 3 finite numbers, or 3 for each block", key)
        fault = limits.fault(float(np.abs(rows).max(initial=0.0)))
        if fault is not None:
            raise self._error(fault, key)
        return np.broadcast_to(rows, (self._count, 3))

    def _error(self, what: str, key: str) -> ModelError:
        return ModelError(
            what,
            where=f"blocks from number {self.first + 1} on, {key}",
            remedy="give vertices (blocks, corners, 2), or (vertices, 2) with start (blocks + 1,), "
            "and one row for each block of properties that differ",
        )


def rocks_of(entries: Iterable[BlockArrays], names: Sequence[str], of_linings: int = 0) -> Ints:
    """Return the rock index of each block, shape (n,)."""
    number = {name: index for index, name in enumerate(names)}
    only = names[0] if len(names) - of_linings == 1 else None
    rocks = []
    for entry in entries:
        given = only if entry.rock is None else entry.rock
        if given is None:
            remedy = spelling.advice("", number, kind="rock")
            raise ModelError("names no rock", where=entry.label(0), remedy=remedy)
        if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
            index = number_of(given, number, "rock", entry.label(0))
            rocks.append(np.full(len(entry.names), index, np.int64))
            continue
        if len(given) != len(entry.names):
            what = f"{len(given)} rocks are given for {len(entry.names)} blocks"
            remedy = "give one name, or one for each block"
            raise ModelError(what, where=f"{entry.label(0)}, rock", remedy=remedy)
        numbers = [number_of(name, number, "rock", entry.label(k)) for k, name in enumerate(given)]
        rocks.append(np.array(numbers, np.int64))
    return np.concatenate(rocks)
