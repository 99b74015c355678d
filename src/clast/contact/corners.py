"""Corner rules: which of the candidate edges of a vertex become contacts."""

from __future__ import annotations

from dataclasses import dataclass

from clast.contact.detection import Candidates
from clast.kernels import narrow_phase
from clast.model import Bools, Floats


@dataclass(frozen=True)
class Bisector:
    """The angle bisector of a convex corner parts its two edges (Yu & Yin 2015).

    At a re-entrant corner, and between the walls of a slot, both edges are kept.
    """

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        return narrow_phase.bisector(
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
