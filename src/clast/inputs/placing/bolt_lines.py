"""The blocks that a straight line runs through, and the joints between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError
from clast.inputs.declaring.values import number_of
from clast.model.checks import OVERLAP_TOLERANCE, BlockOutlines, beside_reach, locate, point_text
from clast.model.factors import NO_FACTOR, Factor
from clast.model.model import Bools, Floats, Ints, MaterialPoints

BESIDE_NAMED_MAX = 5
"""Most places beside blocks that a note names."""


@dataclass(frozen=True, kw_only=True)
class LinePieces:
    """The parts of a line that lie in blocks, in their order along it."""

    block: Ints
    """Block of each part, shape (p,)."""
    ends: Floats
    """Where it begins and ends along the line, m, shape (p, 2)."""

    def __len__(self) -> int:
        return len(self.block)


@dataclass(frozen=True, kw_only=True)
class Ground:
    """The blocks that things between blocks are set in, about the origin."""

    outlines: BlockOutlines
    tree: Any
    """shapely.STRtree of their polygons."""
    moved: float = 0.0
    """How far vertices may have moved since they were drawn, m."""
    tolerance: float = 0.0
    """Distance beside a block within which places belong to it, m."""
    factors: tuple[Factor, ...] = ()
    """Tables of time."""
    fixed: Bools = field(default_factory=lambda: np.zeros(0, np.bool_))
    """Blocks that cannot move at all, shape (n,)."""
    points: MaterialPoints = field(default_factory=MaterialPoints)
    """The fixed points."""

    @cached_property
    def _numbers(self) -> dict[str, dict[str, int]]:
        """Kind of thing -> name -> number."""
        factors = [factor.name for factor in self.factors]
        names = {"block": self.outlines.names, "amplitude": factors}
        return {kind: {name: k for k, name in enumerate(of)} for kind, of in names.items()}

    def block(self, name: str, where: str) -> int:
        """Return the number of a block; raises ModelError for a name of none."""
        return number_of(name, self._numbers["block"], "block", where)

    def blocks(self, names: Iterable[str], where: str) -> Ints:
        """Return the numbers of blocks, (k,)."""
        return np.array([self.block(name, where) for name in names], np.int64)

    def amplitude(self, name: str | None, where: str) -> int:
        """Return the number of an amplitude, NO_FACTOR for None."""
        if name is None:
            return NO_FACTOR
        return number_of(name, self._numbers["amplitude"], "amplitude", where)

    def fixed_point(self, at: Sequence[float], where: str) -> Ints:
        """Return the numbers of the fixed points at a place, (k,); raises ModelError for none."""
        place = np.array(at) - self.outlines.origin
        near = OVERLAP_TOLERANCE * float(np.hypot(*np.ptp(self.outlines.vertices, axis=0)))
        points = np.flatnonzero(np.hypot(*(self.points.at - place).T) <= near)
        if not len(points):
            what = f"there is no fixed point at {self.text(place)}"
            remedy = "give the coordinates of a [[fixed_point]]"
            raise ModelError(what, where=f"{where}, fixed_point", remedy=remedy)
        return points

    def text(self, at: Floats) -> str:
        """Return a point (2,) about the origin as messages write it."""
        return point_text(at + self.outlines.origin)

    def beside_note(self, places: Iterable[tuple[str, int, Floats]]) -> Iterator[str]:
        """Yield the note on places that lie beside their block.

        A place is its label, its block and its points about the origin, m, (e, 2).
        """
        said = []
        for label, block, at in places:
            away = float(shapely.distance(shapely.points(at), self.tree.geometries[block]).max())
            if away > OVERLAP_TOLERANCE * np.sqrt(abs(self._area[block])):
                said.append(f"{label}, {away:.2g} m from {self.outlines.label(block)}")
        if said:
            count = "1 place lies" if len(said) == 1 else f"{len(said)} places lie"
            more = "; ..." if len(said) > BESIDE_NAMED_MAX else ""
            yield (
                f"{count} beside a block, and moves with it where it is: "
                f"{'; '.join(said[:BESIDE_NAMED_MAX])}{more}"
            )

    @cached_property
    def _area(self) -> Floats:
        return self.outlines.area

    def blocks_of_ends(self, label: str, line: Floats, blocks: tuple[str, str] | None) -> list[int]:
        """Return the blocks that carry both ends of a line (2, 2) about the origin, m.

        ``blocks`` are their names where they are given.  Raises ModelError where no block carries
        an end, or several do, in words that begin with the ``label``.
        """
        named = np.full(2, -1, np.int64)
        if blocks is not None:
            named[:] = self.blocks(blocks, f"{label}, blocks")

        def where(k: int) -> str:
            return f"{label}, {('start', 'end')[k]} at {self.text(line[k])}"

        shapes = np.array(shapely.points(line))
        try:
            blocks_there = locate(shapes, named, where, self.outlines, self.tree, self.tolerance)
        except ModelError as error:
            if "common boundary" not in error.what:
                raise
            remedy = 'name the blocks of its ends, the head first: blocks = ["1", "2"]'
            raise ModelError(error.what, where=error.where, remedy=remedy) from None
        return [int(one) for one in blocks_there]

    def pieces(self, line: Floats) -> LinePieces:
        """Return the parts of a line (2, 2) that lie in blocks."""
        length = float(np.hypot(*(line[1] - line[0])))
        along, shape = (line[1] - line[0]) / length, shapely.linestrings(line)
        near = self.tree.query(shape, predicate="intersects")
        common = shapely.intersection(self.tree.geometries[near], shape)
        parts, owner = shapely.get_parts(common, return_index=True)
        long = shapely.length(parts) > OVERLAP_TOLERANCE * length
        parts, owner = parts[long], owner[long]
        ends = np.array(
            [(shapely.get_coordinates(one)[[0, -1]] - line[0]) @ along for one in parts]
        )
        ends = np.sort(ends.reshape(-1, 2), axis=1)
        order = np.lexsort((near[owner], ends[:, 0]))
        return _joined(near[owner][order].astype(np.int64), ends[order], OVERLAP_TOLERANCE * length)


def _joined(block: Ints, ends: Floats, close: float) -> LinePieces:
    """Return the parts with those of one block that follow each other as one."""
    kept_block: list[int] = []
    kept_ends: list[list[float]] = []
    for number, (first, last) in zip(block.tolist(), ends.tolist(), strict=True):
        if kept_block and kept_block[-1] == number and first <= kept_ends[-1][1] + close:
            kept_ends[-1][1] = max(last, kept_ends[-1][1])
            continue
        kept_block.append(number)
        kept_ends.append([first, last])
    return LinePieces(
        block=np.array(kept_block, np.int64), ends=np.array(kept_ends, float).reshape(-1, 2)
    )


def joints_between(
    pieces: LinePieces, line: Floats, ground: Ground, label: str, widest: float
) -> None:
    """Refuse a grouted line that begins or ends in no block, leaves rock, or runs along a joint."""
    length = float(np.hypot(*(line[1] - line[0])))
    close = OVERLAP_TOLERANCE * max(length, float(np.sqrt(np.abs(ground.outlines.area)).max()))
    beside = beside_reach(ground.outlines, ground.tolerance)
    for k, (name, gap) in enumerate(_outside(pieces, length)):
        if gap > close + (beside[pieces.block[-k]] if len(pieces) else 0.0):
            what = f"its {name} lies outside every block; {_nearest(line[k], ground)}"
            remedy = "move it into a block or onto its boundary"
            raise ModelError(what, where=f"{label} at {ground.text(line[k])}", remedy=remedy)
    along = (line[1] - line[0]) / length
    for k, gap in enumerate(pieces.ends[1:, 0] - pieces.ends[:-1, 1]):
        here = ground.text(line[0] + pieces.ends[k, 1] * along)
        pair = [ground.outlines.label(int(b)) for b in pieces.block[k : k + 2]]
        if gap < -close:
            what = (
                f"runs along the joint between {pair[0]} and {pair[1]} from "
                f"{ground.text(line[0] + pieces.ends[k + 1, 0] * along)} on"
            )
            raise ModelError(what, where=label, remedy="move or turn it so that it crosses joints")
        if gap > widest:
            what = f"runs through {gap:.3g} m of void from {here} on"
            raise ModelError(what, where=label, remedy="end it there, or use two bolts")


def _outside(pieces: LinePieces, length: float) -> list[tuple[str, float]]:
    """Return how far the rock is from start and end of a line, m, along it; all of it for none."""
    if not len(pieces):
        return [("start", length), ("end", length)]
    return [("start", float(pieces.ends[0, 0])), ("end", length - float(pieces.ends[:, 1].max()))]


def _nearest(at: Floats, ground: Ground) -> str:
    """Return which block is nearest to a point, and how far away."""
    point = shapely.points(at)
    block = int(ground.tree.nearest(point))
    away = float(shapely.distance(point, ground.tree.geometries[block]))
    return f"the nearest is {ground.outlines.label(block)}, {away:.3g} m away"
