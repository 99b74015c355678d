"""The incremental potential energy of a step, its gradient and its Hessian.

    E(d) = 1/2 d.K d - F.d + sum phi_n(gap + n.d) + phi_t(slip + t.d)
    -grad E = F - K d + sum N n + T t,                  N = -phi_n', T = -phi_t'
    Hessian = K + sum k_n n n^T + k_t t t^T

K and F are inertia, elasticity, weight and loads, block by block; the sums are over the springs
between blocks (clipped_spring.py).  E is convex and once continuously differentiable.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from clast.compute.compilation import Stages
from clast.compute.mat6 import times
from clast.compute.parallel import BLOCKS, summed
from clast.compute.vec6 import inner, plus_scaled, put_row, row
from clast.contact.clipped_spring import Forces, Springs
from clast.linear import assembly, block_matrix
from clast.linear.factor_cache import FactorOfStep
from clast.linear.system import (
    BlockSystem,
    DiagonalTerms,
    Graph,
    LinearisedForces,
    contact_motions,
    graph_of,
    inverse_of_blocks,
    symmetric_system,
    with_ground_for,
)
from clast.minimise.islands import Islands, islands_of
from clast.minimise.line_search import (
    blocks_along,
    common_length,
    island_sums,
    lengths_along,
    links_along,
    slopes,
)
from clast.model.model import Bools, Floats
from clast.read_only import changed

MOMENTUM_SHARE = 1e-4
"""Weight of the energy of motion among the forces that tolerances refer to."""


Motions = tuple[Floats, Floats, Floats, Floats]
"""Gap, its change, slip and its change of each spring, m, (m,) each."""
Product = Callable[[Floats], Floats]
"""A linear function of (n, 6)."""


class Law(Protocol):
    """Springs that are not clipped straight lines, given by their forces."""

    def at(self, gap: Floats, slip: Floats) -> LinearisedForces:
        """Return the forces of all springs at gaps and slips (m,), m."""
        ...

    def energy(self, gap: Floats, slip: Floats) -> float:
        """Return the energy of all springs at gaps and slips (m,), m, in J/m."""
        ...


@dataclass(frozen=True, kw_only=True)
class Point:
    """Unknowns d, and the potential's derivatives there."""

    unknowns: Floats
    """d, shape (n, 6)."""
    gap: Floats
    """Gap of each link, m, shape (m,)."""
    slip: Floats
    """Slip of each link, m, shape (m,)."""
    forces: LinearisedForces
    """The forces of the springs."""
    residual: Floats
    """F - K d + spring forces, minus the gradient, shape (n, 6); 0 for fixed blocks."""
    distances: Floats
    """Share of each block in the distance to the minimum, J/m: r.K^-1 r, shape (n,)."""

    @property
    def arrays(self) -> tuple[Floats, ...]:
        """The same as kernels take it (islands.py)."""
        forces = self.forces
        return (
            self.unknowns,
            self.gap,
            self.slip,
            forces.normal_force,
            forces.shear_force,
            forces.normal_stiffness,
            forces.shear_stiffness,
            self.residual,
            self.distances,
        )


@dataclass(frozen=True, kw_only=True)
class Line:
    """A search direction, its effect on the links, and how far to go along it."""

    direction: Floats
    """Change of d, shape (n, 6)."""
    motions: tuple[Floats, Floats, Floats, Floats]
    """Gap, its change, slip and its change of each link, m, shape (m,) each."""
    lengths: Floats
    """Share of the direction that each island goes, shape (islands.count,)."""


@dataclass(frozen=True, kw_only=True)
class Potential:
    """The incremental potential energy of a step."""

    base: DiagonalTerms
    """K and F without springs between blocks."""
    inverse: Floats
    """Inverse of the blocks of K, shape (n, 6, 6)."""
    fixed: Bools
    """Blocks that stand still, shape (n,)."""
    springs: Springs
    """Springs between blocks."""
    graph: Graph
    """Which pairs the blocks belong to and which links those have."""
    islands: Islands
    """Which blocks are connected by springs."""
    law: Law | None = None
    """The law of springs that are not the clipped springs of the table."""
    joined: bool = False
    """Whether blocks are joined by more than springs: none may be minimised by themselves."""

    @classmethod
    def of(
        cls, base: DiagonalTerms, fixed: Bools, springs: Springs, graph: Graph | None = None
    ) -> Potential:
        """Return that of ``fixed`` (n,) and other blocks, and of the ground where springs hold on.

        The ground is its last block then; ``graph`` is that of the springs, where it is known.
        """
        base, fixed = with_ground_for(springs, base, fixed)
        return cls(
            base=base,
            inverse=inverse_of_blocks(base.diagonal),
            fixed=fixed,
            springs=springs,
            graph=graph or graph_of(springs, len(fixed)),
            islands=islands_of(springs, fixed),
        )

    def energy(self, unknowns: Floats) -> float:
        """Return E, J/m, at ``unknowns`` (n, 6), which are 0 for fixed blocks."""
        gap, slip = self.stretches(unknowns)
        stretched = self.forces.energy(gap, slip)
        bent = block_matrix.products(self.base.diagonal, unknowns)
        return float(np.vdot(0.5 * bent - self.base.force, unknowns)) + stretched

    def gradient(self, unknowns: Floats) -> Floats:
        """Return dE/dd (n, 6) at ``unknowns`` (n, 6), N/m (moments N); 0 for fixed blocks."""
        return -self.at(unknowns).residual

    def hessian(self, point: Point) -> BlockSystem:
        """Return the Hessian at a point, with minus the gradient as the right-hand side."""
        return symmetric_system(
            self.base, self.springs, point.forces, point.residual, self.fixed, self.graph
        )

    @property
    def forces(self) -> Springs | Law:
        """The source of the forces of the springs."""
        return self.springs if self.law is None else self.law

    def stretches(self, unknowns: Floats) -> tuple[Floats, Floats]:
        """Return gap and slip of the links (m,), m, at ``unknowns`` (n, 6)."""
        opening, slip = contact_motions(self.springs, unknowns)
        return self.springs.gap + opening, self.springs.slip + slip

    def at(self, unknowns: Floats) -> Point:
        """Return the derivatives at ``unknowns`` (n, 6)."""
        return self.where(unknowns, *self.stretches(unknowns))

    def again(self, point: Point) -> Point:
        """Return a point of the same links with other springs."""
        return self.where(point.unknowns, point.gap, point.slip)

    def where(self, unknowns: Floats, gap: Floats, slip: Floats) -> Point:
        """Return the derivatives at ``unknowns`` (n, 6), with the links' gap and slip (m,), m."""
        return self.bearing(unknowns, gap, slip, self.forces.at(gap, slip))

    def bearing(
        self, unknowns: Floats, gap: Floats, slip: Floats, forces: LinearisedForces
    ) -> Point:
        """Return the point at ``unknowns`` (n, 6) where the springs carry ``forces``."""
        balance = self.unbalanced(unknowns, forces.normal_force, forces.shear_force)
        return Point(
            unknowns=unknowns,
            gap=gap,
            slip=slip,
            forces=forces,
            residual=balance[0],
            distances=balance[1],
        )

    def unbalanced(self, unknowns: Floats, normal: Floats, shear: Floats) -> tuple[Floats, Floats]:
        """Return r = F - K d + sum of N n + T t (n, 6) for forces (m,), and r.K^-1 r (n,), J/m.

        Both are 0 for fixed blocks.
        """
        balance = assembly.unbalanced(*self._balance, unknowns, normal, shear)
        return balance[0], balance[1]

    def balance_again(self, blocks: Any, point: Point) -> None:
        """Write residual and distances of a point, in place, where ``blocks`` (k,) have changed."""
        forces = point.forces.normal_force, point.forces.shear_force
        into = point.residual, point.distances
        assembly.balance_again(blocks, *self._balance, point.unknowns, *forces, into)

    @property
    def _balance(self) -> tuple[Any, Graph, Any]:
        """Data of the blocks, their links, and data of those."""
        system = self.base.diagonal, self.inverse, self.base.force, self.fixed
        return system, self.graph, (self.springs.vertex_block, self.springs.arms)

    @property
    def problem(self) -> tuple[Any, Any]:
        """The same as islands are minimised by themselves (islands.py)."""
        springs = self.springs
        ends = springs.vertex_block, springs.edge_block, springs.arms
        return self._balance[0], (springs.pairs, self.graph, ends, springs.arrays)

    def distance(self, point: Point) -> float:
        """Return a bound on twice the potential above its minimum, J/m.

        Springs only add curvature to K, so r.H^-1 r <= r.K^-1 r, which costs no system.
        """
        return float(np.add.reduce(point.distances))

    def island_distances(self, point: Point) -> Floats:
        """Return the part of the distance that each island has, J/m, shape (islands.count,)."""
        at = self.islands
        distances: Floats = island_sums(point.distances, at.of_blocks, at.count)
        return distances

    def untouched(self) -> Floats:
        """Return the unknowns (n, 6) of blocks without springs, K^-1 F; 0 for fixed blocks."""
        free: Floats = block_matrix.products(self.inverse, self.base.force)
        free[self.fixed] = 0.0
        return free

    def reference_energy(self) -> float:
        """Return the energy, J/m, that tolerances refer to: 1/2 f.K^-1 f of the step's forces.

        f are weight, loads and stress; momentum counts with MOMENTUM_SHARE of its energy, so that
        fast blocks are not solved more coarsely than those at rest.
        """
        base = self.base
        of_forces = _half_forms(
            len(self.fixed), self.inverse, base.force, base.momentum, -1.0, self.fixed
        )
        moving = _half_forms(
            len(self.fixed), self.inverse, base.momentum, base.momentum, 0.0, self.fixed
        )
        return float(of_forces + MOMENTUM_SHARE * moving)

    def sum_of_forces(self) -> float:
        """Return the sum of all forces on the blocks, N/m: more than any spring has to carry."""
        return float(_sum_of_forces(len(self.fixed), self.base.force, self.fixed))

    def direction(self, point: Point, factor: FactorOfStep, stages: Stages) -> Floats:
        """Return the Newton direction (n, 6): Hessian dd = -gradient."""
        stages("assembly")
        system = self.hessian(point)
        stages("solve")
        return factor.solve(system, point.forces)

    def tangent(self, point: Point, factor: FactorOfStep) -> tuple[Product, Product]:
        """Return the product of the Hessian at a point with d (n, 6), and its solution for F."""
        system = self.hessian(point)
        symmetric = system.diagonal, system.upper, system.pairs, system.rows

        def times(direction: Floats) -> Floats:
            known: Floats = block_matrix.multiply(*symmetric, direction)
            return known

        def solved(force: Floats) -> Floats:
            return factor.solve(changed(system, force=force), point.forces)

        return times, solved

    def slopes_along(self, point: Point, direction: Floats) -> tuple[Motions, Any]:
        """Return the motions of springs, and curvature, slope and that of blocks by islands."""
        opening, slip = contact_motions(self.springs, direction)
        at, forces = self.islands, point.forces
        terms = slopes(
            at.of_blocks,
            at.of_links,
            at.count,
            self.base.diagonal,
            point.residual,
            direction,
            (forces.normal_force, forces.shear_force),
            (opening, slip),
        )
        return (point.gap, opening, point.slip, slip), terms

    def line_search(self, point: Point, direction: Floats) -> tuple[Line, int]:
        """Return how far to go along ``direction`` to the least potential, and evaluations.

        Each island has a length of its own, unless a law gives the forces of the springs.
        """
        at = self.islands
        motions, (bend, start, smooth) = self.slopes_along(point, direction)
        if self.law is None:
            lengths, evaluations = lengths_along(
                at.of_links, motions, self.springs.arrays, smooth, bend, start
            )
        else:
            along = _along(self.law, motions, float(smooth.sum()), float(bend.sum()))
            length, evaluations = common_length(along, float(start.sum()))
            lengths = np.full(at.count, length)
        return Line(direction=direction, motions=motions, lengths=lengths), evaluations

    def moved(self, point: Point, line: Line) -> Point:
        """Return the point at the end of a line from ``point``."""
        unknowns: Floats = blocks_along(
            point.unknowns, line.direction, line.lengths, self.islands.of_blocks
        )
        if self.law is not None:
            return self.at(unknowns)
        gap, slip, *forces = links_along(
            self.islands.of_links, line.lengths, line.motions, self.springs.arrays
        )
        return self.bearing(unknowns, gap, slip, Forces(*forces))


def _along(
    law: Law, motions: tuple[Floats, Floats, Floats, Floats], smooth: float, curvature: float
) -> Callable[[float], tuple[float, float]]:
    """Return the slope of the potential of a law along a line and its bend, as a function."""
    gap, opening, slip, sliding = motions

    def along(length: float) -> tuple[float, float]:
        forces = law.at(gap + length * opening, slip + length * sliding)
        work = float(forces.normal_force @ opening + forces.shear_force @ sliding)
        bend = float(forces.normal_stiffness @ opening**2 + forces.shear_stiffness @ sliding**2)
        return smooth + length * curvature - work, curvature + bend

    return along


@summed(BLOCKS)
def _half_forms(first, last, inverse, force, momentum, share, fixed):
    """Return the sum of 1/2 f.B^-1 f, J/m, of f = force + share x momentum where not fixed."""
    f, forms = np.empty((1, 6)), 0.0
    for i in range(first, last):
        if not fixed[i]:
            put_row(f, 0, plus_scaled(row(force, i), share, row(momentum, i)))
            forms += 0.5 * inner(times(inverse, i, f, 0), row(f, 0))
    return forms


@summed(BLOCKS)
def _sum_of_forces(first, last, force, fixed):
    """Return the sum of the sizes of the forces on blocks that are not fixed, N/m."""
    size = 0.0
    for i in range(first, last):
        if not fixed[i]:
            size += np.hypot(force[i, 0], force[i, 1])
    return size
