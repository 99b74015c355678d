"""The report of a cut: plain numbers and texts."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from clast.model.model import Floats

PLACES = 5
"""Places that a finding names."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Something that was done to the lines or the blocks, how often, and where first."""

    count: int = 0
    """How often."""
    places: tuple[tuple[float, float], ...] = ()
    """The first places, m, at most five."""
    length: float = 0.0
    """Length of line that it concerns, m; 0 where it concerns none."""


def finding(places: Floats, count: int | None = None, length: float = 0.0) -> Finding:
    """Return a finding with its first places (k, 2), m."""
    some = np.asarray(places, float).reshape(-1, 2)[:PLACES]
    return Finding(
        count=len(places) if count is None else count,
        places=tuple((float(x), float(y)) for x, y in some),
        length=float(length),
    )


def place_text(place: tuple[float, float], tolerance: float) -> str:
    """Return a place (x, y), m, as text with as many decimals as the tolerance, m, has."""
    decimals = max(0, math.ceil(-math.log10(tolerance) - 1e-9))
    texts = [f"{value:.{decimals}f}" for value in place]
    x, y = (text.rstrip("0").rstrip(".") if "." in text else text for text in texts)
    return f"({x}, {y})"


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Smallest, median and largest of some sizes."""

    smallest: float
    median: float
    largest: float


def sizes(values: Floats) -> Sizes:
    """Return smallest, median and largest of values (k,)."""
    return Sizes(
        smallest=float(values.min()), median=float(np.median(values)), largest=float(values.max())
    )


@dataclass(frozen=True, kw_only=True)
class SetReport:
    """Statistics of a joint set, or of the drawn traces of one name."""

    name: str
    """Name of the set."""
    lines: int
    """Straight lines inside the window."""
    length: float
    """Their length, m."""
    p21: float
    """Length per area of the window, m/m2."""
    p21_asked: float | None
    """Intensity that is asked for, directly or by the spacing, m/m2."""
    p10: float
    """Lines per length of all scanlines along the normal of the set, 1/m."""
    persistence: float
    """Share of the lines that is trace."""
    persistence_asked: float
    """Share asked for: t/(t + g)."""
    kept: float
    """Share of the length that became edges of blocks."""


@dataclass(frozen=True, kw_only=True)
class CutReport:
    """Number and quality of the blocks of a cut, and changes on the way."""

    blocks: int
    """Number of blocks."""
    estimate: int
    """Blocks that the lines make by Euler's formula, before small ones are merged, holes split."""
    domain_area: float
    """Area of the domain without voids, m2."""
    area: float
    """Sum of the areas of the blocks, m2."""
    area_error: float
    """Difference of the two as a share of the domain."""
    block_area: Sizes
    """Areas of the blocks, m2."""
    edge_length: Sizes
    """Lengths of their edges, m."""
    aspect: Sizes
    """Longer over shorter side of the smallest rectangle about each block."""
    tolerance: float
    """Grid to which lines were rounded, m."""
    smallest_edge: float
    """Length below which edges were collapsed, m."""
    smallest_block: float
    """Area below which blocks were merged, m2."""
    sets: tuple[SetReport, ...]
    """Joint sets, and drawn traces by their set."""
    dangling: Finding
    """Ends of lines that border nothing, and bridges: taken out."""
    loose: Finding
    """Those of them that stop just short of another line, within ten tolerances."""
    collapsed: Finding
    """Edges that were collapsed."""
    merged: Finding
    """Blocks that joined a neighbour."""
    rings: Finding
    """Holes and touching loops that were split by welds."""
    coincident: Finding
    """Edges on which lines of different joints coincide; the later table has it."""
    snapped: Finding
    """Points of traces and outlines that moved to points or lines within the tolerance."""
    short_edges: int
    """Edges that stayed shorter: corners of outlines, or collapsing them would spoil a block."""
    small_blocks: int
    """Blocks that stayed smaller, because no neighbour would leave a simple loop."""
    notes: tuple[str, ...] = field(default=())
    """Other changes to the input, e.g. boundaries that were turned round."""
    warnings: tuple[str, ...] = field(default=())
    """Doubts about the input, each with its remedy."""

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain dictionaries, lists, numbers and texts, for JSON."""
        return asdict(self)
