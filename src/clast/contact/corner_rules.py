"""Corner rules: which of the candidate edges of a vertex become contacts.

Where two convex corners P and Q meet vertex to vertex there are two *entrance lines* (Shi 1988;
the boundary of the entrance block at its corner, Shi 2015): on either side of the corners the edge
of one of the blocks, to be passed by the vertex of the other.  The corners are inside each other
where both lines are passed, and the line with the shorter way out makes the contact.  At a
re-entrant corner the vertex is inside where either edge is passed, and each is a contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from clast.contact import corner_kernels as kernel
from clast.contact.candidates import Candidates
from clast.model.model import Bools, Floats


@dataclass(frozen=True)
class Bisector:
    """The angle bisector of a convex corner parts its two edges (Yu & Yin 2015).

    At a re-entrant corner, and between the walls of a slot, both edges are kept.  Where two convex
    corners are inside each other one of the two vertices makes the contact, by the same principle:
    the shortest exit.  Where corners coincide at the end of a joint both vertices make a contact.
    """

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        return _shortest_exit(candidates, vertices)


@dataclass(frozen=True)
class EntranceLines:
    """Shi's two entrance lines, and one contact for each pair of corners (Shi 1988).

    Two corners are inside each other where both entrance lines are passed; the shorter distance
    holds.  An edge is an entrance line exactly where the entrance test makes it a candidate, and
    the bisector picks the line with the larger signed gap, so that the two rules agree on corners
    that meet at an angle.  They differ where faces lie on each other within 3 degrees and two
    corners coincide, as everywhere in a wall of aligned joints: the bisector keeps the vertices of
    both blocks, Shi's rule reduces the pair to one vertex and the other's edge, which then carries
    twice as much.  The vertex in contact before stays; else the one whose foot is on the edge.

    Shi's program judges the lines again after each solve; here they are judged at the start of the
    step.
    """

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        keep = _shortest_exit(candidates, vertices)
        kernel.one_vertex_per_joint_end(
            keep,
            candidates.group_start,
            candidates.pair,
            candidates.vertex,
            candidates.edge,
            candidates.along,
            candidates.remembered,
            candidates.critdis,
            vertices,
            candidates.direction,
            candidates.length,
            candidates.vertex_block,
            candidates.block_start,
        )
        return keep


def _shortest_exit(candidates: Candidates, vertices: Floats) -> Bools:
    """Return True for the edges of the shortest exit from the corners that are entered, (m,)."""
    found = (
        candidates.group_start,
        candidates.vertex,
        candidates.edge,
        candidates.pair,
        candidates.gap,
        candidates.along,
        candidates.remembered,
    )
    outlines = (
        vertices,
        candidates.direction,
        candidates.length,
        candidates.vertex_block,
        candidates.block_start,
    )
    keep: Bools = kernel.shortest_exit(found, outlines, candidates.critdis)
    return keep


class CornerRule(Protocol):
    """Chooses entrance edges among the candidate edges of a vertex at a corner of a block."""

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        ...
