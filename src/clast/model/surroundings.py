"""Stress in the rock around a model, edges that absorb waves, openings to excavate, repairs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from clast import spelling
from clast.errors import ModelError
from clast.model.arrays import Floats, Ints, no_floats, no_ints


@dataclass(frozen=True, kw_only=True)
class InSituStress:
    """Stress as a function of depth: stress + gradient x (datum - y).

    Blocks begin with the stress at their centroids, and contacts with the forces that belong to it.
    The outline of the system is loaded by the stress, and held beside that by springs.
    """

    stress: tuple[float, float, float]
    """Stress (xx, yy, xy) at the datum, Pa, tension positive."""
    gradient: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Its change by metre of depth, Pa/m."""
    datum: float = 0.0
    """Height y at which ``stress`` holds, m, in the coordinates of the case."""
    in_contacts: float = 1.0
    """Share of the stress that contacts carry at the start: 1, or 0 where they are to find it."""
    held: tuple[float, float] = (1.0, 0.0)
    """Springs of the outline along its normal and along itself, in units of those of fixed points.

    (1, 0) are rollers, (1, 1) hold it altogether, (0, 0) leave it to the stress alone.
    """
    sides: tuple[str, ...] = ()
    """Sides of the box around all blocks that are loaded; empty: the convex hull, and the notches
    within it where the stress at the top of the model says that it lies at depth."""
    voids: tuple[int, ...] = ()
    """Edges of openings that are there from the start, by their first vertices: these are free."""

    def at(self, y: Floats) -> Floats:
        """Return the stress (xx, yy, xy) at heights y (k,), m, in Pa, shape (k, 3)."""
        depth = self.datum - np.asarray(y, float)
        return np.asarray(self.stress) + depth[:, None] * np.asarray(self.gradient)


DOWNWARDS = -float(np.sqrt(0.5))
"""n_y of the outward normals of edges that face down, at most: within 45 degrees."""


@dataclass(frozen=True, kw_only=True, repr=False)
class ViscousEdges:
    """Edges with dashpots, k of them: a rho c_p v_n along the normal, b rho c_s v_t along the edge.

    Before they begin, springs hold these edges in the directions that have dashpots.
    """

    edge: Ints = no_ints()
    """Index of the first vertex of each edge, shape (k,)."""
    block: Ints = no_ints()
    """Its block, shape (k,)."""
    normal: Floats = no_floats()
    """Multiple a of rho c_p, shape (k,)."""
    tangential: Floats = no_floats()
    """Multiple b of rho c_s, shape (k,)."""
    kept: Floats = no_floats()
    """Share of the spring forces that stays as a traction when dashpots begin, shape (k,)."""
    begins: Floats = no_floats()
    """Time from which dashpots are in the place of springs, s, inf until a stage, shape (k,)."""
    stage: tuple[str, ...] = ()
    """Name of the stage with which they begin, "" where it is a time."""

    def __len__(self) -> int:
        return len(self.edge)

    def at_stage(self, name: str, time: float) -> ViscousEdges:
        """Return the edges when a stage begins at a time, s, and with it dashpots."""
        if name not in self.stage:
            return self
        begins = np.where([one == name for one in self.stage], time, self.begins)
        return replace(self, begins=begins)

    def __repr__(self) -> str:
        return f"ViscousEdges({len(self)} edges)"


@dataclass(frozen=True, kw_only=True)
class OpeningBlocks:
    """Rock that is there until it is excavated."""

    name: str
    """Name by which stages refer to it."""
    block: Ints
    """Its blocks, shape (k,)."""
    welded: Ints = no_ints()
    """Edges along its construction joint, welded until it is excavated: their first vertices, (w,).

    They belong to blocks inside and outside.
    """


def blocks_called(
    names: Iterable[str], openings: Iterable[OpeningBlocks], block_name: Iterable[str]
) -> Ints:
    """Return the blocks of openings and blocks by their ``names``, sorted, each once, shape (k,).

    Raises ModelError for a name that neither has.
    """
    by_name = {name: np.array([number]) for number, name in enumerate(block_name)}
    by_name |= {one.name: one.block for one in openings}
    blocks = [np.zeros(0, np.int64)]
    for name in names:
        if name not in by_name:
            raise ModelError(
                f"there is no opening or block '{name}'",
                where="excavate",
                remedy=spelling.advice(name, by_name, kind="opening or block"),
            )
        blocks.append(by_name[name])
    return np.unique(np.concatenate(blocks))


@dataclass(frozen=True, kw_only=True)
class Repair:
    """Something that was done to blocks as they were drawn, so that they touch."""

    what: str
    """The repair, in words."""
    count: int
    """How often."""
    places: tuple[tuple[float, float], ...]
    """The first places, m."""

    def __str__(self) -> str:
        places = ", ".join(f"({x:.9g}, {y:.9g})" for x, y in self.places)
        more = ", ..." if self.count > len(self.places) else ""
        return f"{self.count} {self.what}: {places}{more}"
