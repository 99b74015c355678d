"""Masonry: courses of equal blocks in a rectangle."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from clast.model.model import Floats
from clast.rockmass.domain import Box, points_of


@dataclass(frozen=True)
class RunningBond:
    """Every second course is moved by half a brick."""

    shift: ClassVar[float] = 0.5
    """Share of a brick by which every second course is moved."""


@dataclass(frozen=True)
class StackBond:
    """All head joints stand one above the other."""

    shift: ClassVar[float] = 0.0


@dataclass(frozen=True, kw_only=True)
class BlockPattern:
    """A wall of bricks: courses from the lower left corner, cut off at its right and its top.

    Its outline is cut, too.  Openings are cut out of it as out of rock; a lintel is a region that
    is one block, or a block given by hand in an opening that is void from the start.
    """

    corner: Any
    """Lower left corner, m, shape (2,)."""
    size: Any
    """Width and height of the wall, m, shape (2,)."""
    brick: Any
    """Width and height of a brick, m, shape (2,)."""
    pattern: RunningBond | StackBond = field(default_factory=RunningBond)
    """RunningBond or StackBond."""
    joint: str | None = None
    """Joint of bed and head joints; None: that of the pair of blocks, the rocks, or the default."""
    head_joint: str | None = None
    """Joint of the head joints, if it differs."""
    name: str = "masonry"
    """Name, for the report."""

    @property
    def where(self) -> str:
        """How messages call it."""
        return f"block_pattern '{self.name}'"

    def outline(self) -> Floats:
        """Return the corners of the wall, m, shape (4, 2): the boundary of a domain of its own."""
        return Box(corner=self.corner, size=self.size).corners(self.where)

    def bricks(self) -> Floats:
        """Return how many bricks lie side by side, and how many courses; parts count, (2,)."""
        brick = Box(corner=(0.0, 0.0), size=self.brick).corners(f"{self.where}, brick")[2]
        size = self.outline()[2] - self.outline()[0]
        return np.ceil(size / brick - 1e-9)

    def lines(self) -> tuple[Floats, Floats]:
        """Return the bed joints with the outline, and the head joints, m, shape (k, 2, 2) each."""
        corners = self.outline()
        low, high = corners[0], corners[2]
        width, height = points_of([self.brick], f"{self.where}, brick", 1)[0]
        courses = int(self.bricks()[1])
        level = np.minimum(low[1] + height * np.arange(courses + 1), high[1])
        beds = np.array([[[low[0], y], [high[0], y]] for y in level[1:-1]]).reshape(-1, 2, 2)
        outline = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        heads = []
        for course in range(courses):
            shift = (course % 2) * self.pattern.shift
            last = math.ceil((high[0] - low[0]) / width - shift)
            at = low[0] + width * (shift + np.arange(-1, last + 1))
            at = at[(at > low[0] + 1e-9 * width) & (at < high[0] - 1e-9 * width)]
            bottom, top = np.full(len(at), level[course]), np.full(len(at), level[course + 1])
            heads.append(np.stack([np.stack([at, bottom], 1), np.stack([at, top], 1)], axis=1))
        return np.concatenate([outline, beds]), np.concatenate(heads)
