"""Subproblems: some blocks move while all others stand still where they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.compute.jit import kernel
from clast.contact.clipped_spring import Clipped, Forces, Rows, Springs
from clast.linear.system import DiagonalTerms, contact_motions
from clast.minimise.islands import islands_of, put_back, taken_out
from clast.minimise.potential import Point, Potential
from clast.model.model import Bools, Floats, Ints
from clast.read_only import changed


@dataclass(frozen=True, kw_only=True)
class Subproblem:
    """The potential of some blocks of a whole while all others stand still.

    All fixed parts are one block, the last, of which nothing but that is known.
    """

    potential: Potential
    """Their potential."""
    point: Point
    """The whole's point as they have it."""
    blocks: Ints
    """Those that move among the blocks of the whole, shape (k,)."""
    links: Ints
    """Their links among those of the whole."""

    def rows(self, among: Rows) -> Ints:
        """Return where rows of the whole's table are in this one, which has all of them."""
        place = np.empty(len(self.links), np.int64)
        place[self.links] = np.arange(len(self.links))
        return place[among]

    def put_back(self, whole: Potential, point: Point, moved: Point) -> Point:
        """Return a ``point`` of the whole with these blocks where they ``moved`` to."""
        result = copied(point)
        put_back(self.blocks, self.links, moved.arrays, result.arrays)
        moves = np.zeros(len(whole.fixed), np.bool_)
        moves[self.blocks] = True
        beside = with_neighbours(moves, whole.springs.pairs) & ~moves & ~whole.fixed
        whole.balance_again(np.flatnonzero(beside), result)
        return result


def subproblem(potential: Potential, point: Point, moves: Bools) -> Subproblem:
    """Return the potential of the free blocks that may ``move`` (n,), the others being at a point.

    Of potentials of clipped springs alone, with nothing else between blocks.
    """
    blocks = np.flatnonzero(moves)
    place = np.cumsum(moves) - 1
    (system, links), own, source = taken_out(blocks, place, ~moves, potential.problem, point.arrays)
    diagonal, inverse, force, fixed = system
    pairs, graph, (vertex_block, edge_block, arms), both = links
    unknowns, gap, slip, *forces, residual, distances = own
    springs = Springs(
        vertex_block=vertex_block,
        edge_block=edge_block,
        arms=arms,
        pair=np.repeat(np.arange(len(pairs)), np.diff(graph[0])),
        pairs=pairs,
        gap=gap,
        slip=slip,
        normal=Clipped(*both[:4]),
        shear=Clipped(*both[4:]),
    )
    opened, slipped = contact_motions(springs, unknowns)
    springs = changed(springs, gap=gap - opened, slip=slip - slipped)
    return Subproblem(
        potential=Potential(
            base=DiagonalTerms(
                diagonal=diagonal,
                force=force,
                momentum=_with_one_more(potential.base.momentum, blocks),
                centroid=_with_one_more(potential.base.centroid, blocks),
            ),
            inverse=inverse,
            fixed=fixed,
            springs=springs,
            graph=graph,
            islands=islands_of(springs, fixed),
        ),
        point=Point(
            unknowns=unknowns,
            gap=gap,
            slip=slip,
            forces=Forces(*forces),
            residual=residual,
            distances=distances,
        ),
        blocks=blocks,
        links=source,
    )


def touched(potential: Potential, point: Point, most: float) -> Subproblem | None:
    """Return the blocks that have links, where they are at most a share ``most`` of those free.

    All others go as their own forces take them.  None, too, where a link is between two blocks that
    stand still, or more than clipped springs joins blocks.
    """
    if potential.joined or potential.law is not None:
        return None
    moves = np.zeros(len(potential.fixed), np.bool_)
    number, free = _mark_linked(potential.springs.pairs, potential.fixed, moves)
    if not 0 < number <= most * free:
        return None
    part = subproblem(potential, point, moves)
    return part if len(part.links) == len(potential.springs) else None


@kernel()
def _mark_linked(pairs, fixed, marks):
    """Write True for blocks (n,) that are not fixed and have ``pairs``.

    Return how many these are, and how many are not fixed.
    """
    linked, free = 0, 0
    for q in range(len(pairs)):
        for side in range(2):
            i = pairs[q, side]
            if not fixed[i] and not marks[i]:
                marks[i] = True
                linked += 1
    for i in range(len(fixed)):
        free += not fixed[i]
    return linked, free


def copied(point: Point) -> Point:
    """Return a copy of a point."""
    unknowns, *links, residual, distances = point.arrays
    gap, slip, *forces = np.array(links)
    unknowns, residual = np.array((unknowns, residual))
    return Point(
        unknowns=unknowns,
        gap=gap,
        slip=slip,
        forces=Forces(*forces),
        residual=residual,
        distances=distances.copy(),
    )


def _with_one_more(values: Floats, blocks: Ints) -> Floats:
    """Return the rows of ``blocks``, and the first of them once more."""
    return values.take(np.append(blocks, blocks[:1]), axis=0)


@kernel()
def with_neighbours(chosen, pairs):
    """Return True for blocks ``chosen`` (n,) and for those with which they share ``pairs``."""
    grown = chosen.copy()
    for q in range(len(pairs)):
        if chosen[pairs[q, 0]] or chosen[pairs[q, 1]]:
            grown[pairs[q, 0]] = grown[pairs[q, 1]] = True
    return grown
