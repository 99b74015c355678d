"""The potential of a step with water in joints that opens blocks, and is let in by them.

    E(d) + psi(V d),    -grad = -grad E + V^T p,    Hessian = K + V^T A^-1 V

(model/flow/opening_joints.py).  A^-1 is full: Newton's direction comes from the system of
displacements and pressures,

    | K   -V^T | | dd |   | r |
    | -V   -A  | | dp | = | 0 |

with the nodes that are free.  It is quasi-definite, so that it is factored without pivots in any
order (Vanderbei 1995).  The water joins islands; they go along a line together.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from clast.compute.compilation import Stages
from clast.compute.reductions import alike
from clast.errors import StepOutcome, StepRejected
from clast.linear import block_matrix
from clast.linear.factor_cache import FactorOfStep
from clast.linear.system import BlockSystem
from clast.minimise.line_search import common_length
from clast.minimise.potential import Line, Point, Potential, Product
from clast.model.flow.opening_joints import SYMMETRIC, OpeningJoints
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
            known = _Factor.of(self.hessian(point), self.water, stiffness, found.free)
            self.water.factors.blocks = known
        return known.solve


def sum_of_products(one: Floats, other: Floats) -> float:
    """Return the sum of products of (m,), without the threads of BLAS, which cost more."""
    return float(np.add.reduce(one * other))


@dataclass(frozen=True, kw_only=True)
class _Factor:
    """The system of displacements and free pressures, factored."""

    factor: Any
    matrix: Any
    count: int
    """Unknowns of blocks."""
    scale: Floats
    """Unit of each unknown, shape (count + free,)."""
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
        stiffness: tuple[Floats, Floats],
        free: Bools,
    ) -> _Factor:
        """Return the factor of a system and of the water at nodes that are ``free`` (m,)."""
        from scipy.sparse import block_array, csc_array, diags_array
        from scipy.sparse.linalg import splu

        stiff = blocks_of(system)
        count, some = stiff.shape[0], np.flatnonzero(free)
        moves = np.repeat(~system.fixed, 6).astype(np.float64)
        opens = water.volumes[some]
        opens = csc_array((opens.data, opens.indices, opens.indptr), shape=opens.shape[::-1])
        opens.resize((count, len(some)))
        opens = diags_array(moves) @ opens
        stored = water.matrix[some][:, some]
        whole = block_array([[stiff, -opens], [-opens.T, -stored]], format="csr")
        size = np.abs(whole.diagonal())
        size[count:] += (opens.power(2).T @ (1.0 / size[:count])).ravel()
        scale = 1.0 / np.sqrt(size)
        scaled = (diags_array(scale) @ whole @ diags_array(scale)).tocsc()
        try:
            factor = splu(scaled, **SYMMETRIC)
        except RuntimeError as error:
            raise StepRejected(StepOutcome.SINGULAR, "blocks and water in joints") from error
        return cls(
            factor=factor,
            matrix=scaled,
            count=count,
            scale=scale,
            stiffness=stiffness,
            free=free,
        )

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        right = np.zeros(len(self.scale))
        right[: self.count] = force.ravel()
        right *= self.scale
        found = self.factor.solve(right)
        found += self.factor.solve(right - self.matrix @ found)  # no pivots: once more
        if not np.isfinite(found).all():
            raise StepRejected(StepOutcome.NOT_FINITE)
        return np.asarray((self.scale * found)[: self.count].reshape(force.shape))


def blocks_of(system: BlockSystem) -> Any:
    """Return the matrix K of a system, sparse, shape (6 n, 6 n)."""
    from scipy.sparse import bsr_array

    count, pairs = len(system.diagonal), system.pairs
    couple = ~(system.fixed[pairs[:, 0]] | system.fixed[pairs[:, 1]])
    i, j = pairs[couple].T
    upper, own = system.upper[couple], np.arange(count)
    row, column = np.concatenate([own, i, j]), np.concatenate([own, j, i])
    blocks = np.concatenate([system.diagonal, upper, upper.transpose(0, 2, 1)])
    order = np.lexsort((column, row))
    first = np.searchsorted(row[order], np.arange(count + 1))
    return bsr_array((blocks[order], column[order], first), shape=(6 * count, 6 * count))


def with_water(potential: Potential, water: OpeningJoints) -> WetPotential:
    """Return the potential of a step with that of water in joints."""
    of_blocks = {one.name: getattr(potential, one.name) for one in fields(Potential)}
    return WetPotential(**{**of_blocks, "joined": True}, water=water)
