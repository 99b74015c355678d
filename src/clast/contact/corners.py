"""Corner rules: which of the candidate edges of a vertex become contacts."""

from __future__ import annotations

from dataclasses import dataclass

from clast.contact.detection import Candidates
from clast.kernels import narrow_phase
from clast.model import Bools, Floats


@dataclass(frozen=True)
class Bisector:
    """The angle bisector of a convex corner parts its two edges (Yu & Yin 2015).

    At a re-entrant corner, and between the walls of a slot, both edges are kept.  Where two convex
    corners are inside each other one of the two vertices makes the contact, by the same principle:
    the shortest exit.
    """

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        keep = narrow_phase.bisector(
            candidates.group_start,
            candidates.edge,
            candidates.gap,
            candidates.along,
            candidates.remembered,
            candidates.critdis,
            candidates.direction,
            candidates.length,
            candidates.vertex_block,
            candidates.block_start,
        )
        narrow_phase.drop_deeper_corners(
            keep,
            candidates.group_start,
            candidates.pair,
            candidates.vertex,
            candidates.edge,
            candidates.gap,
            candidates.remembered,
            candidates.direction,
            candidates.length,
            candidates.vertex_block,
            candidates.block_start,
        )
        return keep
