"""Springs of bolts, links and linings beside contacts that are held linear.

The modified process and open-close iteration solve equations in which each contact has one
stiffness.  A spring that yields, slackens or takes up its play in the step must not be held like
that: taken as yielded it has no stiffness, and the blocks that it joins are thrown apart.  With
the contacts held linear the step is the minimum of a convex potential, and Newton's method with an
exact line search finds the forces of all such springs, as it does in the convex process.  Where
none of them changes it is one solve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.contact.clipped_spring import Forces, Rows, Springs, merged, springs_of
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import StepOutcome, StepRejected
from clast.linear.factor_cache import FactorOfStep
from clast.linear.system import (
    BlockSystem,
    DiagonalTerms,
    PairedLinks,
    assemble,
    contact_motions,
    stretches,
)
from clast.model.model import Bools, Floats
from clast.step.energy_balance import FINEST
from clast.step.prescribed import DrivenBlocks
from clast.step.start import StepContext

SOLVES_MAX = 100
"""Solves in which springs must settle; most that yield take two to five."""


@dataclass(frozen=True, kw_only=True)
class LinearContacts:
    """Contacts as a solve holds them, each by a straight line."""

    contacts: Contacts
    response: ContactResponse
    """Their forces and stiffnesses."""
    seen: tuple[Floats, Floats]
    """Gaps and slips (m,) at which they have these, m."""


def solved(
    context: StepContext,
    base: DiagonalTerms,
    factor: FactorOfStep,
    held: LinearContacts,
    at: Floats,
) -> tuple[Floats, Floats]:
    """Return d (n, 6) of a step, and the displacements (n, 6) about which springs are linear.

    ``at`` (n, 6) are those that are tried first.  Raises StepRejected where springs do not settle.
    """
    stages, springs, at = context.stages, context.springs, context.total(at)
    off = np.zeros(0, np.bool_)
    for _ in range(SOLVES_MAX):
        stages("assembly")
        system, bearing = _coupled_system(context, base, held, at)
        stages("solve")
        unknowns = context.total(factor.solve(system, bearing)[: len(at)])
        if springs is None:
            return unknowns, at
        stages("law")
        line = _Line.of(springs, at, unknowns)
        off = line.differs(float(np.abs(context.model.vertices).max()))
        if not off.any():
            return unknowns, at
        at = at + line.share(base, held) * line.displacement
    raise StepRejected(StepOutcome.NOT_CONVERGED, _unsettled(context, off))


def _unsettled(context: StepContext, off: Bools) -> str:
    """Return which springs (m,) do not settle, in words."""
    if context.springs is None:
        return ""
    springs, one = context.springs, int(off.argmax())
    first, second = (
        "the ground" if k == springs.ground else f"block '{context.model.block_name[k]}'"
        for k in (springs.vertex_block[one], springs.edge_block[one])
    )
    return (
        f"a bolt, link or lining between {first} and {second} still changes between bearing and "
        f"yielding after {SOLVES_MAX} solves"
    )


@dataclass(frozen=True, kw_only=True)
class _Line:
    """Springs on the line from the displacements at which they are linear to a solution."""

    springs: Springs
    displacement: Floats
    """From there to the solution, (n, 6)."""
    start: tuple[Floats, Floats]
    """Gaps and slips (m,) where it begins, m."""
    moved: tuple[Floats, Floats]
    """By how much they grow on it, m, (m,) each."""
    straight: tuple[Floats, Floats]
    """Normal and shear forces (m,) at its end by the straight lines of its start, N/m."""
    stiffness: tuple[Floats, Floats]
    """Stiffnesses (m,) of these lines, N/m per m."""

    @classmethod
    def of(cls, springs: Springs, at: Floats, unknowns: Floats) -> _Line:
        """Return the line from displacements (n, 6) to the solution about them, (n, 6)."""
        displacement = unknowns - at
        start, moved = stretches(springs, at), contact_motions(springs, displacement)
        bear = springs.at(*start)
        return cls(
            springs=springs,
            displacement=displacement,
            start=start,
            moved=moved,
            straight=(
                bear.normal_force - bear.normal_stiffness * moved[0],
                bear.shear_force - bear.shear_stiffness * moved[1],
            ),
            stiffness=(bear.normal_stiffness, bear.shear_stiffness),
        )

    def forces(self, share: float) -> Forces:
        """Return the forces of the springs at a share of the line."""
        gap, slip = (a + share * b for a, b in zip(self.start, self.moved, strict=True))
        return self.springs.at(gap, slip)

    def differs(self, size: float) -> Bools:
        """Return which springs (m,) end elsewhere than on their lines, by more than rounding.

        ``size`` is that of the coordinates, m.
        """
        springs, bear = self.springs, self.forces(1.0)
        rounded = FINEST * (size + np.abs(springs.arms[:, 2:]).max(axis=1, initial=0.0))
        forces = bear.normal_force, bear.shear_force
        stiffnesses = bear.normal_stiffness, bear.shear_stiffness
        off = np.zeros(len(springs), np.bool_)
        for kind, spring in enumerate((springs.normal, springs.shear)):
            force, straight = forces[kind], self.straight[kind]
            # Share of a spring's force by which it may differ from that of its straight line
            least = 1e-9 * np.maximum(np.abs(force), np.abs(straight))
            beyond = np.abs(force - straight) > least + spring.stiffness * rounded
            # a spring may go from its one bound to the other, stiff at neither
            on_line = (stiffnesses[kind] == self.stiffness[kind]) & (self.stiffness[kind] > 0.0)
            off |= beyond & ~on_line
        return off

    def share(self, base: DiagonalTerms, held: LinearContacts) -> float:
        """Return the share of the line, up to 1, where the potential is least."""
        displacement, response = self.displacement, held.response
        opening, slip = contact_motions(held.contacts, displacement)
        kn, ks = response.normal_stiffness, response.shear_stiffness
        of_blocks = np.einsum("ni,nij,nj->n", displacement, base.diagonal, displacement)
        of_contacts = kn * opening**2 + ks * slip**2
        curvature = float(of_blocks.sum() + of_contacts.sum())

        def slope(share: float) -> float:
            bear = self.forces(share)
            more = (bear.normal_force - self.straight[0]) * self.moved[0]
            more += (bear.shear_force - self.straight[1]) * self.moved[1]
            return (share - 1.0) * curvature - float(more.sum())

        low, high = 0.0, 1.0
        if slope(high) <= 0.0:
            return high
        # Halvings of the line search
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if slope(middle) <= 0.0 else (low, middle)
        return 0.5 * (low + high)


def _coupled_system(
    context: StepContext, base: DiagonalTerms, held: LinearContacts, at: Floats
) -> tuple[BlockSystem, ContactResponse | Forces]:
    """Return the system of a solve, and the forces in it.

    The springs of the step are at the displacements ``at`` (n, 6).
    """
    contacts, response, seen = held.contacts, held.response, held.seen
    springs, fixed = context.springs, context.model.fixed
    if springs is None:
        seen = _beside(context.held, contacts, *seen)
        return assemble(base, contacts, response, *seen, fixed), response
    table, (of_contacts, of_springs) = merged(springs_of(contacts), (springs,))
    gap, slip = stretches(springs, at)
    bear = springs.at(gap, slip)

    def joined(one: Floats, other: Floats) -> Floats:
        return _joined(len(table), (of_contacts, one), (of_springs, other))

    bearing = Forces(
        normal_force=joined(response.normal_force, bear.normal_force),
        shear_force=joined(response.shear_force, bear.shear_force),
        normal_stiffness=joined(response.normal_stiffness, bear.normal_stiffness),
        shear_stiffness=joined(response.shear_stiffness, bear.shear_stiffness),
    )
    # a link's slip in the equations counts from the start of the step, a spring's from its own
    own = gap, slip - springs.slip
    gaps, slips = (joined(one, other) for one, other in zip(seen, own, strict=True))
    gaps, slips = _beside(context.held, table, gaps, slips)
    return assemble(base, table, bearing, gaps, slips, fixed), bearing


def _beside(
    held: DrivenBlocks | None, links: PairedLinks, gap: Floats, slip: Floats
) -> tuple[Floats, Floats]:
    """Return gaps and slips (m,), m, without the part of prescribed motions."""
    if held is None:
        return gap, slip
    opening, sliding = held.motions(links)
    return gap - opening, slip - sliding


def _joined(count: int, *parts: tuple[Rows, Floats]) -> Floats:
    """Return an array (count,) of the values of parts of its rows."""
    result = np.empty(count)
    for rows, values in parts:
        result[rows] = values
    return result
