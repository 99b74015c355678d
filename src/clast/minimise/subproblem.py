"""Parts of a potential: some blocks while the others stand still, or all in another order."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.contact.contacts import Contacts, of_pairs, reordered
from clast.linear import block_matrix as block_rows
from clast.linear.system import DiagonalTerms, graph_of
from clast.minimise.neighbours import touching, with_neighbours
from clast.minimise.potential import Point, Potential, regions_of
from clast.model.model import Bools, Floats, Ints

ANSWERS = ("normal_force", "shear_force", "normal_stiffness", "shear_stiffness")
"""What Newton's method needs of what a law of springs with bounds answers."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """A potential of some blocks, or of all in another order, and where they are in the whole."""

    potential: Potential
    """Their potential; blocks that stand still are fixed in it."""
    blocks: Ints
    """Its blocks among those of the whole."""
    contacts: Ints
    """Its contacts among those of the whole."""

    def within(self, point: Point) -> Point:
        """Return the whole's ``point`` as the part has it."""
        potential, own = self.potential, self.contacts
        unknowns = point.unknowns.take(self.blocks, axis=0)
        if potential.limits is None:
            return potential.at(unknowns)
        residual, left = point.residual.take(self.blocks, axis=0), point.left.take(self.blocks)
        residual[potential.fixed], left[potential.fixed] = 0.0, 0.0
        answers = {name: getattr(point.response, name).take(own) for name in ANSWERS}
        return Point(
            unknowns=unknowns,
            gap=point.gap.take(own),
            slip=point.slip.take(own),
            response=replace(potential.at_rest, **answers),
            residual=residual,
            left=left,
        )


def part_of(potential: Potential, wanted: Bools) -> Part:
    """Return the potential of the free blocks ``wanted`` (n,) while all others stand still.

    Those that they touch are there too, with the displacements that they have.
    """
    contacts = potential.contacts
    pairs, kept, pair = touching(wanted, contacts.pairs, potential.graph[0])
    needed = with_neighbours(wanted, contacts.pairs)
    blocks = np.flatnonzero(needed)
    own = of_pairs(contacts, pairs, kept, pair, np.cumsum(needed) - 1)
    part = _potential_of(potential, blocks, own, ~wanted[blocks])
    return Part(potential=part, blocks=blocks, contacts=kept)


def renumbered(potential: Potential, order: Ints) -> Part:
    """Return the same potential with the blocks in another ``order`` (n,)."""
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    contacts, places = reordered(potential.contacts, number)
    own = _potential_of(potential, order, contacts, potential.fixed[order])
    return Part(potential=own, blocks=order, contacts=places)


def with_part(potential: Potential, point: Point, part: Part, moved: Point) -> Point:
    """Return ``point`` with the blocks and contacts of a part where they ``moved`` to."""
    unknowns = _put(moved.unknowns, part.blocks, point.unknowns)
    if potential.limits is None:
        return potential.at(unknowns)
    before, after = point.response, moved.response
    answers: dict[str, Any] = {
        name: _put(getattr(after, name), part.contacts, getattr(before, name)) for name in ANSWERS
    }
    found = Point(
        unknowns=unknowns,
        gap=_put(moved.gap, part.contacts, point.gap),
        slip=_put(moved.slip, part.contacts, point.slip),
        response=replace(potential.at_rest, **answers),
        residual=point.residual.copy(),
        left=point.left.copy(),
    )
    potential.balance_again(part.blocks, found)
    return found


def _put(values: Floats, where: Ints, among: Floats) -> Floats:
    """Return a copy of ``among`` with ``values`` at the places ``where``."""
    result = among.copy()
    result[where] = values
    return result


def _potential_of(
    potential: Potential, blocks: Ints, contacts: Contacts, fixed: Bools
) -> Potential:
    """Return the potential of ``blocks`` (k,), some ``fixed`` (k,), and their ``contacts``."""
    base = potential.base
    return replace(
        potential,
        base=DiagonalTerms(
            diagonal=block_rows.taken(base.diagonal, blocks),
            force=base.force.take(blocks, axis=0),
            momentum=base.momentum.take(blocks, axis=0),
            centroid=base.centroid.take(blocks, axis=0),
        ),
        inverse=block_rows.taken(potential.inverse, blocks),
        contacts=contacts,
        fixed=fixed,
        graph=graph_of(contacts, len(blocks)),
        regions=regions_of(contacts, fixed),
    )
