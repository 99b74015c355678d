"""Potentials that short runs minimise, and their minima."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from clast.compute.compilation import Stages
from clast.contact.clipped_spring import Clipped
from clast.linear.factor_cache import FactorOfStep
from clast.linear.solvers import Direct, LinearSolver
from clast.minimise.newton import Newton, SolverContext
from clast.minimise.potential import Point, Potential
from clast.minimise.strategy import MinimisationStrategy, NonlinearElimination, SmallIslands
from clast.model.model import Model
from clast.step.convex import Convex
from scenes.systems import by_convex, march

TOLERANCE = 1e-7
"""Share of the norm of a step's forces to which minima are found."""
ALONE = MinimisationStrategy(
    newton=Newton(iterations=500),
    small=SmallIslands(few=0),
    elimination=NonlinearElimination(large=10**9),
    inside=None,
    most=0.0,
)
"""Newton's method alone, on all blocks together."""


@dataclass(frozen=True)
class Scheduled(Convex):
    """The convex process with another schedule, that keeps what it minimises."""

    changes: dict[str, Any] = field(default_factory=dict)
    """Changed fields of the schedule."""
    kept: list[Potential] = field(default_factory=list)
    """All potentials with springs."""

    def schedule(self, factor: FactorOfStep) -> MinimisationStrategy:
        """Return the usual schedule with some things changed."""
        usual = replace(super().schedule(factor), **self.changes)
        return Keeping(kept=self.kept, **vars(usual))


@dataclass(frozen=True, kw_only=True)
class Keeping(MinimisationStrategy):
    """A schedule that keeps what it is asked to minimise."""

    kept: list[Potential]

    def minimise(
        self, potential: Potential, point: Point, tolerance: float, work: SolverContext
    ) -> Point:
        """Return the minimum."""
        if len(potential.springs):
            self.kept.append(potential)
        return super().minimise(potential, point, tolerance, work)


def caught(model: Model, stiffness: float, step: float, end: float) -> list[Potential]:
    """Return the potentials that a short run minimises."""
    process = Scheduled()
    march(model, by_convex(stiffness, process=process, max_displacement=0.1), step, end)
    return process.kept


def some_of(potentials: list[Potential]) -> list[Potential]:
    """Return about eight of them."""
    return potentials[:: max(1, len(potentials) // 8)]


def work(solver: LinearSolver | None = None) -> SolverContext:
    """Return what minimisations share."""
    return SolverContext(factor=FactorOfStep(solver or Direct()), counts={}, stages=Stages())


def at_rest(potential: Potential) -> Point:
    """Return the point without displacements."""
    return potential.at(np.zeros((len(potential.fixed), 6)))


def tolerance_of(potential: Potential) -> float:
    """Return the distance, J/m, to which a step is solved."""
    return TOLERANCE**2 * potential.reference_energy()


def by_newton(potential: Potential, tolerance: float) -> Point:
    """Return the minimum found by Newton's method alone."""
    found = ALONE.minimise(potential, at_rest(potential), tolerance, work())
    return potential.at(found.unknowns)


def strengthened(potential: Potential, seed: int, force: float = 1e4) -> Potential:
    """Return the potential with springs of all kinds in place of those that it has.

    Bonds, multipliers, remembered shear forces and friction bounds, none of them for some; and
    springs that yield in tension and in compression, or not at all, and that do not shear.
    """
    rng = np.random.default_rng(seed)
    springs, count = potential.springs, len(potential.springs)
    some = rng.choice([0.0, 1.0], count)
    low = -rng.choice([0.0, 0.5, 1.0], count) * force
    high = np.full(count, np.inf)
    bound = rng.choice([0.0, 1e-6, 1.0], count) * force
    other = rng.random(count)
    low[other < 0.05], high[other < 0.03] = -np.inf, 3.0 * force
    low[other > 0.95], high[other > 0.95] = -force, 2.0 * force
    stiff = springs.shear.stiffness.copy()
    stiff[other > 0.98], bound[other > 0.98] = 0.0, 0.0
    normal = Clipped(
        at_zero=some * force * rng.uniform(0.0, 1.0, count),
        stiffness=springs.normal.stiffness * rng.uniform(0.5, 1.0, count),
        low=low,
        high=high,
    )
    shear = Clipped(
        at_zero=np.where(bound > 0.0, force * rng.normal(size=count), 0.0),
        stiffness=stiff,
        low=-bound,
        high=bound,
    )
    return replace(potential, springs=replace(springs, normal=normal, shear=shear))
