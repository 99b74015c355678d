"""The incremental potential energy of a step and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from clast.compute.stopwatch import Stages
from clast.contact.contacts import ContactResponse, Contacts, SpringLimits
from clast.contact.laws import ContactLaw, limits_of
from clast.linear import assembly
from clast.linear import block_matrix as block_rows
from clast.linear import residual as balance
from clast.linear.reuse import FactorOfStep
from clast.linear.system import DiagonalTerms, Graph, contact_motions, symmetric_system
from clast.minimise import connected as regions
from clast.minimise import island_kernels as small_regions
from clast.minimise import island_sums as region_sums
from clast.minimise import line_search
from clast.minimise import reference_energy as yardsticks
from clast.model.model import Bools, Floats, Ints


@dataclass(frozen=True, kw_only=True)
class Point:
    """The potential's derivatives at unknowns d."""

    unknowns: Floats
    """d, shape (n, 6)."""
    gap: Floats
    """Gap of each contact, m, shape (m,)."""
    slip: Floats
    """Slip of each contact, m, shape (m,)."""
    response: ContactResponse
    """Answer of the law."""
    residual: Floats
    """F - K d + contact forces, minus the gradient of the potential, shape (n, 6)."""
    left: Floats
    """What each block has of the distance to the minimum, J/m: r.K^-1 r, shape (n,)."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """A direction, what it does to the contacts, and how far to go along it."""

    direction: Floats
    """Change of d, shape (n, 6)."""
    motions: tuple[Floats, Floats, Floats, Floats]
    """Gap, its change, slip and its change of each contact, m, shape (m,) each."""
    lengths: Floats
    """Share of the direction that each region goes, shape (regions.count,)."""


@dataclass(frozen=True, kw_only=True)
class Regions:
    """Blocks that contacts connect: the potential is a sum over regions."""

    count: int
    """Number of regions; the last holds the fixed blocks."""
    of_blocks: Ints
    """Region of each block, shape (n,)."""
    of_contacts: Ints
    """Region of each contact, shape (m,)."""

    @cached_property
    def listing(self) -> tuple[Ints, Ints, Ints]:
        """Where the blocks of each region begin (count + 1,), these, and their places (n,)."""
        start, blocks, place = small_regions.listed(self.of_blocks, self.count)
        return start, blocks, place


def regions_of(contacts: Contacts, fixed: Bools) -> Regions:
    """Return the regions of blocks of which some are ``fixed`` (n,)."""
    of_blocks, count = regions.regions(contacts.pairs, fixed)
    return Regions(
        count=count,
        of_blocks=of_blocks,
        of_contacts=regions.region_of_contacts(
            of_blocks, count, contacts.vertex_block, contacts.edge_block
        ),
    )


@dataclass(frozen=True, kw_only=True)
class Potential:
    """1/2 d.K d - F.d + sum of phi_n(gap + n.d) + phi_t(t.d); see step/convex.py."""

    base: DiagonalTerms
    """K and F without contacts."""
    inverse: Floats
    """Inverse of the blocks of K, shape (n, 6, 6)."""
    law: ContactLaw
    """Contact law, with the friction bound given by the contacts."""
    contacts: Contacts
    """Contacts of the step."""
    fixed: Bools
    """Blocks that cannot move, shape (n,)."""
    graph: Graph
    """Which pairs the blocks belong to and which contacts those have."""
    regions: Regions
    """Which blocks are connected by contacts."""

    @cached_property
    def limits(self) -> SpringLimits | None:
        """The law as springs with bounds, or None for any other law or without contacts."""
        return limits_of(self.law, self.contacts)

    def at(self, unknowns: Floats) -> Point:
        """Return the derivatives at ``unknowns`` (n, 6)."""
        opening, slip = contact_motions(self.contacts, unknowns)
        return self._where(unknowns, self.contacts.gap + opening, slip)

    def again(self, point: Point) -> Point:
        """Return a point of the same contacts under another law or with other bounds."""
        return self._where(point.unknowns, point.gap, point.slip)

    def answered(self, point: Point) -> Point:
        """Return a point with all that the law answers there (see :meth:`moved`)."""
        return replace(point, response=self.law.respond(self.contacts, point.gap, point.slip))

    def _where(self, unknowns: Floats, gap: Floats, slip: Floats) -> Point:
        """Return the derivatives at ``unknowns`` (n, 6), with the contacts' gap and slip (m,)."""
        response = self.law.respond(self.contacts, gap, slip)
        residual, left = self.unbalanced(unknowns, response.normal_force, response.shear_force)
        return Point(
            unknowns=unknowns,
            gap=gap,
            slip=slip,
            response=response,
            residual=residual,
            left=left,
        )

    def distances_at(self, starts: Floats) -> Floats:
        """Return the :meth:`distances` (k, regions.count), J/m, at ``starts`` (k, n, 6)."""
        forces = np.empty((2, len(starts), len(self.contacts)))
        for k, unknowns in enumerate(starts):
            opening, slip = contact_motions(self.contacts, unknowns)
            response = self.law.respond(self.contacts, self.contacts.gap + opening, slip)
            forces[0, k], forces[1, k] = response.normal_force, response.shear_force
        left = balance.left_at(*self._as_kernels_take_it, starts, *forces)
        at = self.regions
        return np.stack([region_sums.sums(one, at.of_blocks, at.count) for one in left])

    def untouched(self) -> Floats:
        """Return the unknowns (n, 6) of blocks without contacts, K^-1 F; 0 for fixed blocks."""
        free: Floats = block_rows.products(self.inverse, self.base.force)
        free[self.fixed] = 0.0
        return free

    def unbalanced(self, unknowns: Floats, normal: Floats, shear: Floats) -> tuple[Floats, Floats]:
        """Return r = F - K d + sum of N n + T t (n, 6) for forces (m,), and r.K^-1 r (n,), J/m.

        Both are 0 for fixed blocks.
        """
        residual, left = balance.unbalanced(*self._as_kernels_take_it, unknowns, normal, shear)
        return residual, left

    def balance_again(self, blocks: Ints, point: Point) -> None:
        """Write what is out of balance at a point, in place, where ``blocks`` (k,) have changed."""
        forces = point.response.normal_force, point.response.shear_force
        found = point.residual, point.left
        balance.balance_again(blocks, *self._as_kernels_take_it, point.unknowns, *forces, found)

    @property
    def _as_kernels_take_it(self) -> tuple[Any, Graph, Any]:
        """What is known of the blocks, which contacts they have, and what is known of those."""
        of_blocks = self.base.diagonal, self.inverse, self.base.force, self.fixed
        return of_blocks, self.graph, (self.contacts.vertex_block, self.contacts.levers)

    def distance(self, point: Point) -> float:
        """Return a bound on twice the potential above its minimum, J/m.

        Contacts only add curvature to K, so r.H^-1 r <= r.K^-1 r, which costs no system.
        """
        return float(point.left.sum())

    def distances(self, point: Point) -> Floats:
        """Return the part of the distance that each region has, J/m, shape (regions.count,)."""
        at = self.regions
        return np.asarray(region_sums.sums(point.left, at.of_blocks, at.count))

    @cached_property
    def _forces(self) -> tuple[float, float, float]:
        """Half of f.K^-1 f without and of momentum alone, J/m, and the sum of all forces, N/m."""
        base = self.base
        found = yardsticks.of_forces(self.inverse, base.force, base.momentum, self.fixed)
        weight, motion, forces = map(float, found)
        return weight, motion, forces

    def yardstick(self) -> float:
        """Return the energy, J/m, that tolerances refer to: 1/2 f.K^-1 f of the step's forces.

        f are weight, loads and stress; momentum counts with MOMENTUM_SHARE of its energy, so that
        fast blocks are not solved more coarsely than those at rest.
        """
        return self._forces[0] + MOMENTUM_SHARE * self._forces[1]

    def largest_force(self) -> float:
        """Return the sum of all forces on the blocks, N/m: more than any contact can bear."""
        return self._forces[2]

    def direction(self, point: Point, factor: FactorOfStep, stages: Stages) -> Floats:
        """Return the Newton direction (n, 6): H dd = residual."""
        with stages("assembly"):
            system = symmetric_system(
                self.base, self.contacts, point.response, point.residual, self.fixed, self.graph
            )
        with stages("solve"):
            return factor.solve(system, point.response)

    def line_search(self, point: Point, direction: Floats) -> tuple[Line, int]:
        """Return how far to go along ``direction`` to the least potential, and evaluations.

        The derivative along the line rises monotonically and, for a piecewise linear law, is
        piecewise linear: Newton's method on it, kept inside a bracket, ends on the exact root.
        Each region has a length of its own where the law is one of springs with bounds.
        """
        opening, slip = contact_motions(self.contacts, direction)
        motions = (point.gap, opening, point.slip, slip)
        if self.limits is None:
            length, evaluations = self._common_length(point, direction, opening, slip)
            lengths = np.full(self.regions.count, length)
            return Line(direction=direction, motions=motions, lengths=lengths), evaluations
        before = point.response
        region, count = self.regions.of_blocks, self.regions.count
        at = self.regions.of_contacts
        start = -region_sums.products(point.residual, direction, region, count)
        works = region_sums.works(before.normal_force, opening, before.shear_force, slip, at, count)
        lengths, evaluations = line_search.lengths_along(
            at,
            motions,
            self.springs(self.limits),
            start + works,
            region_sums.forms(self.base.diagonal, direction, region, count),
            start,
        )
        return Line(direction=direction, motions=motions, lengths=lengths), evaluations

    def small_regions(self) -> Bools:
        """Return which regions (r,) are minimised by themselves (minimise/island_kernels.py)."""
        regions, pairs = self.regions, self.contacts.pairs
        return np.asarray(
            small_regions.are_small(
                regions.of_blocks, regions.count, pairs, self.graph[0], self.fixed
            )
        )

    def problem(self, limits: SpringLimits) -> tuple[Any, ...]:
        """Return the potential as regions are minimised by themselves (minimise/one_island.py)."""
        of_blocks, graph, _ = self._as_kernels_take_it
        contacts = self.contacts
        ends = contacts.vertex_block, contacts.edge_block, contacts.levers
        return of_blocks, contacts.pairs, graph, ends, self.springs(limits)

    def springs(self, limits: SpringLimits) -> tuple[Floats, Floats, float, float, Floats, Floats]:
        """Return multipliers, shear forces, p, k, tension and strength, as kernels take them."""
        return (
            self.contacts.multiplier,
            self.contacts.shear_force,
            limits.normal_stiffness,
            limits.shear_stiffness,
            limits.tension,
            limits.strength,
        )

    def moved(self, point: Point, line: Line) -> Point:
        """Return the point at the end of a line from ``point``.

        Of a law of springs with bounds the answer is what Newton's method needs: forces and
        stiffnesses, but neither energies nor modes (:meth:`answered` has all).
        """
        of_blocks, of_contacts = self.regions.of_blocks, self.regions.of_contacts
        unknowns: Floats = region_sums.advanced(
            point.unknowns, line.direction, line.lengths, of_blocks
        )
        if self.limits is None:
            return self.at(unknowns)
        gap, slip, normal, shear, kn, ks = line_search.answers(
            of_contacts, line.lengths, line.motions, self.springs(self.limits)
        )
        residual, left = self.unbalanced(unknowns, normal, shear)
        return Point(
            unknowns=unknowns,
            gap=gap,
            slip=slip,
            response=replace(
                self.at_rest,
                normal_force=normal,
                shear_force=shear,
                normal_stiffness=kn,
                shear_stiffness=ks,
            ),
            residual=residual,
            left=left,
        )

    @cached_property
    def at_rest(self) -> ContactResponse:
        """No forces, no energies, and the modes and bonds of the last step."""
        none = np.zeros(len(self.contacts))
        return ContactResponse(
            normal_force=none,
            shear_force=none,
            normal_stiffness=none,
            shear_stiffness=none,
            coupling=none,
            mode=self.contacts.mode,
            bonded=self.contacts.bonded,
            energy=none,
            dissipation=none,
        )

    def _common_length(
        self, point: Point, direction: Floats, d_gap: Floats, d_slip: Floats
    ) -> tuple[float, int]:
        """Return the length for all regions together, by what any law answers, and evaluations."""
        curvature = float(assembly.form(self.base.diagonal, direction))
        before = point.response
        start = -float(np.vdot(point.residual, direction))
        smooth = start + float(before.normal_force @ d_gap + before.shear_force @ d_slip)
        low, high, length = 0.0, np.inf, 1.0
        for evaluations in range(1, line_search.LIMIT + 1):
            answer = self.law.respond(
                self.contacts, point.gap + length * d_gap, point.slip + length * d_slip
            )
            work = float(answer.normal_force @ d_gap + answer.shear_force @ d_slip)
            bend = float(answer.normal_stiffness @ d_gap**2 + answer.shear_stiffness @ d_slip**2)
            slope = smooth + length * curvature - work
            if abs(slope) <= line_search.TOLERANCE * abs(start):
                return length, evaluations
            low, high = (length, high) if slope < 0.0 else (low, length)
            trial = length - slope / (curvature + bend)
            inside = low < trial < high
            length = trial if inside else 0.5 * (low + min(high, 2.0 * low + 1.0))
        return length, line_search.LIMIT


MOMENTUM_SHARE = 1e-4
"""Weight of the energy of motion among the forces that tolerances refer to."""
