"""Blocks that were drawn one by one, put together where they are meant to touch.

    from clast.rockmass.repair import repaired

    vertices = [(0, 0), (1, 0), (1, 1), (0, 1), (1.0004, 0), (2, 0), (2, 1), (0.9997, 1)]
    blocks = repaired(vertices, [0, 4, 8], tolerance=1e-3)
    print(blocks.report.joined.count, blocks.polygon(1))

Drawings that are rounded to millimetres overlap and gape by some tenths of one.  Vertices within
the tolerance of each other become one; vertices within it of an edge of another block are put onto
the edge.  Blocks that touch then have the very same corners: there is no round-off between them.
Nothing else changes, not in the last digit; and no vertex moves by more than the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.errors import ModelError
from clast.model.arrays import areas
from clast.model.checks import BlockOutlines, RepairedBlocks
from clast.model.model import Floats, Ints
from clast.model.surroundings import Repair
from clast.rockmass.block_loops import sound
from clast.rockmass.cut_report import Finding, finding
from clast.rockmass.shared_places import (
    Cycles,
    corners_of,
    onto_edges,
    through_places,
    without_folds,
)

TOLERANCE_MAX = 0.1
"""Largest tolerance over the median edge: a larger one would undo the drawing."""
BLOCKS_NAMED = 10
"""Most blocks that a refusal names."""


@dataclass(frozen=True, kw_only=True)
class RepairReport:
    """Repairs to blocks so that they touch, how often, and where first."""

    tolerance: float
    """Distance within which things are meant to touch, m."""
    joined: Finding
    """Vertices that moved to others, or others to them."""
    onto_edges: Finding
    """Vertices that moved onto an edge of another block."""
    put_in: Finding
    """Vertices that an edge of another block beside them got."""
    closed: Finding
    """Edges that became points, and spikes that came back on themselves: taken out."""
    left: Finding
    """Vertices that stay nearer to an edge than the tolerance, and not on it."""
    largest_movement: float
    """How far a vertex moved at most, m."""

    @property
    def changes(self) -> dict[str, Finding]:
        """The repairs, in words, where there were any."""
        named = {
            f"vertices within {self.tolerance:g} m of each other became one": self.joined,
            f"vertices within {self.tolerance:g} m of an edge were put onto it": self.onto_edges,
            "vertices were added to edges that pass beside them": self.put_in,
            f"edges within {self.tolerance:g} m became points": self.closed,
            f"vertices are nearer to an edge than {self.tolerance:g} m still": self.left,
        }
        return {what: one for what, one in named.items() if one.count}


@dataclass(frozen=True, kw_only=True, eq=False)
class Repaired:
    """Blocks that touch where they are meant to."""

    vertices: Floats
    """Vertices, counter-clockwise by block, m, shape (nv, 2)."""
    start: Ints
    """Index of each block's first vertex, and the number of vertices, shape (nb + 1,)."""
    edge: Ints
    """Edge as given that the edge from each vertex to the next is, or is part of, shape (nv,)."""
    report: RepairReport
    """The repairs."""

    def polygon(self, block: int) -> Floats:
        """Return the outline of one block, m, shape (k, 2)."""
        return self.vertices[self.start[block] : self.start[block + 1]]


def repaired(
    vertices: Any, start: Any, tolerance: float, label: Callable[[int], str] | None = None
) -> Repaired:
    """Return counter-clockwise blocks (nv, 2), m, that touch where they were within a tolerance.

    ``start`` (nb + 1,) are first vertices and the number of all; ``label`` names a block in
    messages.  ModelError where a block would vanish, turn over or cross itself, with the blocks and
    the places, and where the tolerance is not a valid distance or a tenth of the median edge.
    """
    drawn, first = np.asarray(vertices, np.float64), np.asarray(start, np.int64)
    called = label or (lambda block: f"block {block + 1}")
    origin = np.floor(drawn.min(axis=0))
    local = drawn - origin
    loops = Cycles(start=first, node=np.arange(len(drawn)), edge=np.arange(len(drawn)))
    reach = checked(tolerance, np.hypot(*(local[loops.after] - local[loops.node]).T))
    node, corners = corners_of(local, reach)
    loops, closed = without_folds(replace(loops, node=node))
    refusal = _Refusal(drawn=drawn, start=first, reach=reach, label=called)
    refusal.vanished(loops)
    place = onto_edges(loops, node, corners, local, reach)
    loops, put_in, left = through_places(loops, place, reach)
    moved = (place[node] != local).any(axis=1)
    # What stays keeps its last digit: no origin is added to it again.
    at = place + origin
    at[node[~moved]] = drawn[~moved]
    refusal.unsound(loops, at)
    slid = np.flatnonzero((place != corners).any(axis=1))

    def places(nodes: Ints) -> Finding:
        """Return a finding of places, each named once however often it occurs."""
        return finding(at[np.unique(nodes)], count=len(nodes))

    report = RepairReport(
        tolerance=reach,
        joined=places(node[moved & ~np.isin(node, slid)]),
        onto_edges=finding(at[slid]),
        put_in=places(put_in),
        closed=places(closed),
        left=finding(at[left]),
        largest_movement=float(np.hypot(*(place[node] - local).T).max(initial=0.0)),
    )
    return Repaired(vertices=at[loops.node], start=loops.start, edge=loops.edge, report=report)


def checked(tolerance: float, edges: Floats) -> float:
    """Return the tolerance; ModelError where it is out of all proportion to edges (k,), m."""
    median = float(np.median(edges))
    if not 0.0 < tolerance < np.inf:
        what = f"{tolerance:g} m is not a valid distance"
        raise ModelError(what, where="repair, tolerance", remedy="give m, above 0")
    if tolerance > TOLERANCE_MAX * median:
        raise ModelError(
            f"{tolerance:g} m is {tolerance / median:.3g} of the median edge, {median:.3g} m",
            where="repair, tolerance",
            remedy=f"give {TOLERANCE_MAX * median:.2g} m at most: the largest distance by which "
            "corners that belong together were drawn apart",
        )
    return float(tolerance)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Refusal:
    """Blocks as drawn, for messages on those that cannot be put together."""

    drawn: Floats
    start: Ints
    reach: float
    label: Callable[[int], str]

    def vanished(self, loops: Cycles) -> None:
        """Refuse blocks of which fewer than three corners are left."""
        degenerate = np.flatnonzero(np.diff(loops.start) < 3)
        self._refuse(degenerate, "would vanish", self.drawn[self.start[degenerate]])

    def unsound(self, loops: Cycles, at: Floats) -> None:
        """Refuse blocks that turn over or cross themselves with places (nn, 2), and did not."""
        vertices = at[loops.node]
        bad = ~sound(vertices, loops.start) & sound(self.drawn, self.start)
        turned = bad & (areas(vertices, loops.start) <= 0.0)
        new = (vertices != self.drawn[loops.edge]).any(axis=1)
        # The first corner that is another one than drawn, for each block.
        order = np.lexsort((~new, loops.owner))
        first = vertices[order[loops.start[:-1]]]
        for which, what in ((turned, "would turn over"), (bad, "would cross or touch itself")):
            self._refuse(np.flatnonzero(which), what, first[which])

    def _refuse(self, blocks: Ints, what: str, places: Floats) -> None:
        if len(blocks) == 0:
            return
        label, reach = self.label, self.reach
        named = [
            f"{label(int(block))} at ({at[0]:.9g}, {at[1]:.9g})"
            for block, at in zip(blocks[:BLOCKS_NAMED], places, strict=False)
        ]
        more = f" and {len(blocks) - BLOCKS_NAMED} more" if len(blocks) > BLOCKS_NAMED else ""
        what = f"{what} if what is nearer than {reach:g} m became one: {'; '.join(named)}{more}"
        remedy = "give a smaller tolerance, or take out blocks, corners and notches so thin"
        raise ModelError(what, where=f"repair, tolerance: {label(int(blocks[0]))}", remedy=remedy)


@dataclass(frozen=True, kw_only=True)
class BlockRepair:
    """Puts the blocks of a ModelBuilder together where they are nearer than a tolerance."""

    tolerance: float
    """Distance within which things are meant to touch, m."""

    def __call__(self, outlines: BlockOutlines) -> RepairedBlocks:
        """Return the repaired blocks, and the repairs."""
        blocks = repaired(outlines.vertices, outlines.start, self.tolerance, outlines.label)
        vertices = np.ascontiguousarray(blocks.vertices)
        return RepairedBlocks(
            outlines=replace(outlines, start=blocks.start, vertices=vertices),
            edge=blocks.edge,
            moved=blocks.report.largest_movement,
            tolerance=self.tolerance,
            repairs=repairs_of(blocks.report, tuple(outlines.origin.tolist())),
        )


def repairs_of(report: RepairReport, origin: tuple[float, ...] = (0.0, 0.0)) -> tuple[Repair, ...]:
    """Return the repairs in the form of a model; places are about an origin, m."""
    return tuple(
        Repair(
            what=what,
            count=one.count,
            places=tuple((x + origin[0], y + origin[1]) for x, y in one.places),
        )
        for what, one in report.changes.items()
    )
