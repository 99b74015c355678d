"""The potential of a step with water in joints that opens blocks, and is let in by them.

    E(d) + psi(V d),    -grad = -grad E + V^T p,    Hessian = K + V^T A^-1 V

(linear/opening_joints.py).  A^-1 is full: Newton's direction comes from the system of
displacements and pressures,

    | K   -V^T | | dd |   | r |
    | -V   -A  | | dp | = | 0 |

with the nodes that are free (linear/quasi_definite.py).  The water joins islands; they go along a
line together.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from clast.compute.compilation import Stages
from clast.compute.reductions import alike
from clast.errors import StepOutcome, StepRejected
from clast.linear import block_matrix, quasi_definite
from clast.linear.block_matrix import multiply
from clast.linear.factor_cache import FactorOfStep
from clast.linear.opening_joints import OpeningJoints
from clast.linear.pattern import Patterns, exact_pattern
from clast.linear.system import BlockSystem
from clast.minimise.line_search import common_length
from clast.minimise.potential import Line, Point, Potential, Product
from clast.model.model import Bools, Floats


@dataclass(frozen=True, kw_only=True)
class WetPotential(Potential):
    """The incremental potential energy of a step with water in joints."""

    water: OpeningJoints

    def energy(self, unknowns: Floats) -> float:
        """Return E, J/m, at ``unknowns`` (n, 6), which are 0 for fixed blocks."""
        return super().energy(unknowns) + self.water.energy(self.water.opened(unknowns))

    def unbalanced(self, unknowns: Floats, normal: Floats, shear: Floats) -> tuple[Floats, Floats]:
        """Return r, the forces of water among them, (n, 6), and r.K^-1 r (n,), J/m."""
        residual, _ = super().unbalanced(unknowns, normal, shear)
        found = self.water.pressures(self.water.opened(unknowns))
        residual = residual + self.water.forces(found.pressure - self.water.acting, len(residual))
        residual[self.fixed] = 0.0
        own = block_matrix.products(self.inverse, residual)
        return residual, np.add.reduce(own * residual, axis=1)

    def distances_at(self, starts: Floats) -> Floats:
        """Return the distance (k, islands.count), J/m, at ``starts`` (k, n, 6).

        The same for all islands, which go on from one start.
        """
        left = [self.distance(self.at(one)) for one in starts]
        return np.repeat(np.array(left)[:, None], self.islands.count, axis=1)

    def direction(self, point: Point, factor: FactorOfStep, stages: Stages) -> Floats:
        """Return the Newton direction (n, 6): Hessian dd = -gradient."""
        stages("solve")
        return self._solver(point, factor)(point.residual)

    def tangent(self, point: Point, factor: FactorOfStep) -> tuple[Product, Product]:
        """Return the product of the Hessian at a point with d (n, 6), and its solution for F."""
        springs, _ = super().tangent(point, factor)
        found = self.water.pressures(self.water.opened(point.unknowns))

        def times(direction: Floats) -> Floats:
            risen = self.water.rates(found, self.water.opened(direction))
            pushed = self.water.forces(risen, len(direction))
            pushed[self.fixed] = 0.0
            return springs(direction) - pushed

        return times, self._solver(point, factor)

    def line_search(self, point: Point, direction: Floats) -> tuple[Line, int]:
        """Return how far to go along ``direction`` to the least potential, and evaluations."""
        water = self.water
        motions, (bend, start, smooth) = self.slopes_along(point, direction)
        _, opening, _, slip = motions
        opened, opens = water.opened(point.unknowns), water.opened(direction)
        first = water.pressures(opened).pressure
        smooth, curvature = float(smooth.sum()), float(bend.sum())

        def along(length: float) -> tuple[float, float]:
            found = water.pressures(opened + length * opens)
            of_springs = self.forces.at(point.gap + length * opening, point.slip + length * slip)
            work = sum_of_products(of_springs.normal_force, opening)
            work += sum_of_products(of_springs.shear_force, slip)
            work += sum_of_products(found.pressure - first, opens)
            bends = sum_of_products(of_springs.normal_stiffness, opening**2)
            bends += sum_of_products(of_springs.shear_stiffness, slip**2)
            bends -= sum_of_products(water.rates(found, opens), opens)
            return smooth + length * curvature - work, curvature + bends

        length, evaluations = common_length(along, float(start.sum()))
        return Line(
            direction=direction, motions=motions, lengths=np.full(self.islands.count, length)
        ), evaluations

    def _solver(self, point: Point, factor: FactorOfStep) -> Product:
        """Return the solution for a force; the factor is made anew where something has changed."""
        found = self.water.pressures(self.water.opened(point.unknowns))
        stiffness = point.forces.normal_stiffness, point.forces.shear_stiffness
        known: _Factor | None = self.water.factors.blocks
        if known is None or not known.serves(stiffness, found.free):
            factor.factorised += 1
            system = self.hessian(point)
            known = _Factor.of(system, self.water, point, found.free, factor.patterns)
            self.water.factors.blocks = known
        return known.solve


def sum_of_products(one: Floats, other: Floats) -> float:
    """Return the sum of products of (m,), without the threads of BLAS, which cost more."""
    return float(np.add.reduce(one * other))


@dataclass(frozen=True, kw_only=True)
class _Factor:
    """The system of displacements and free pressures, factored."""

    factor: tuple[Any, ...]
    """The factor (linear/quasi_definite.py)."""
    system: BlockSystem
    """The part of blocks."""
    water: OpeningJoints
    stiffness: tuple[Floats, Floats]
    """Normal and shear stiffness of the springs that it is made of, N/m per m, (s,) each."""
    free: Bools
    """Nodes that are free in it, shape (m,)."""

    def serves(self, stiffness: tuple[Floats, Floats], free: Bools) -> bool:
        """Return whether it is that of other stiffnesses and free nodes, too."""
        return np.array_equal(self.free, free) and all(map(alike, self.stiffness, stiffness))

    @classmethod
    def of(
        cls,
        system: BlockSystem,
        water: OpeningJoints,
        point: Point,
        free: Bools,
        patterns: Patterns,
    ) -> _Factor:
        """Return the factor of a system and of the water at nodes that are ``free`` (m,)."""
        at, count = water.channels, len(system.fixed)
        diagonal, upper, opens = water.matrices(free, system.fixed)
        ground = np.zeros(at.groups, np.bool_)
        whole = BlockSystem(
            diagonal=np.concatenate([system.diagonal, -diagonal]),
            pairs=np.concatenate(
                [system.pairs, at.touched + np.array([0, count]), at.pairs + count]
            ),
            rows=system.rows,
            upper=np.concatenate([system.upper, opens, -upper]),
            fixed=np.concatenate([system.fixed, ground]),
            force=system.force,
            centroid=NOWHERE,
        )
        pattern = patterns.of(whole, exact_pattern)
        signs = np.concatenate([np.ones(count), -np.ones(at.groups)])
        factor, bad = quasi_definite.factor(pattern, whole.diagonal, whole.upper, signs)
        if bad >= 0:
            raise StepRejected(StepOutcome.SINGULAR, "blocks and water in joints")
        stiffness = point.forces.normal_stiffness, point.forces.shear_stiffness
        return cls(factor=factor, system=system, water=water, stiffness=stiffness, free=free)

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        system, water, count = self.system, self.water, len(force)
        place, none = water.channels.place, np.zeros((water.channels.groups, 6))
        found = quasi_definite.solve(self.factor, np.concatenate([force, none]))
        move, pressure = found[:count], found[count:].ravel()[place] * self.free
        # no pivots: once more
        stretched = multiply(system.diagonal, system.upper, system.pairs, system.rows, move)
        pushed = water.forces(pressure, count)
        pushed[system.fixed] = 0.0
        left = water.opened(move) + water.held(pressure)
        right = [force - stretched + pushed, water.by_groups(left, self.free)]
        found = quasi_definite.solve(self.factor, np.concatenate(right))
        move = move + found[:count]
        if not np.isfinite(move).all():
            raise StepRejected(StepOutcome.NOT_FINITE)
        return move


NOWHERE = np.zeros((0, 2))
"""Patterns with all fill do not depend on where blocks are."""


def with_water(potential: Potential, water: OpeningJoints) -> WetPotential:
    """Return the potential of a step with that of water in joints."""
    of_blocks = {one.name: getattr(potential, one.name) for one in fields(Potential)}
    return WetPotential(**{**of_blocks, "joined": True}, water=water)
