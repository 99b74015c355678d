"""Below which length edges are collapsed, and below which area blocks are merged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clast.rockmass.cut_lines import SetLines, Site
from clast.rockmass.joints.masonry import BlockPattern

SHARE = 0.01
"""Smallest edge as a share of the median spacing, where none is given."""


@dataclass(frozen=True, kw_only=True)
class SizeLimits:
    """Smallest edges and blocks."""

    smallest_edge: float
    """Shorter edges are collapsed, m."""
    smallest_block: float
    """Smaller blocks are merged, m2."""


def limits_of(at: Site, lines: Sequence[SetLines], patterns: Sequence[BlockPattern]) -> SizeLimits:
    """Return the limits of a domain: those given, else by the median spacing of its sets.

    Where only traces are drawn, their spacing is the area over their length.
    """
    domain = at.domain
    edge, block = domain.smallest_edge, domain.smallest_block
    if edge is None:
        edge = SHARE * _spacing(at, lines, patterns)
        if block is not None:
            edge = min(edge, 0.5 * math.sqrt(block))
    if block is None:
        block = (2.0 * edge) ** 2
    return SizeLimits(smallest_edge=float(edge), smallest_block=float(block))


def _spacing(at: Site, lines: Sequence[SetLines], patterns: Sequence[BlockPattern]) -> float:
    found, traced = [], 0.0
    for one in lines:
        if one.plan is None:
            traced += float(np.hypot(*(one.ends[:, 1] - one.ends[:, 0]).T).sum())
        elif one.plan.spacing is not None:
            found.append(one.plan.spacing.mean)
        elif one.plan.intensity is not None:
            found.append(1.0 / one.plan.intensity)
        else:
            found.append(math.sqrt(one.window.area / max(len(one.ends) / 3.0, 1.0)))
    found += [float(np.min(one.brick)) for one in patterns]
    if traced > 0.0 and not found:
        area = at.window.area
        found.append(min(area / traced, math.sqrt(area)))
    # Nothing cuts the domain but its openings: these have edges as short as they are meant.
    return float(np.median(found)) if found else 0.0
