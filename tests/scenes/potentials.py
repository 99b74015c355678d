"""The potentials that runs minimise, and their minima by Newton's method."""

from dataclasses import replace

import numpy as np

from clast.compute.stopwatch import Stages
from clast.linear.reuse import FactorOfStep
from clast.linear.solvers import Direct
from clast.minimise import newton
from clast.minimise.potential import Potential
from scenes.systems import by_convex, march

TOLERANCE = 1e-7


def caught(monkeypatch, model, stiffness, step, end):
    """Return the potentials that a short run minimises."""
    kept = []
    usual = newton.minimise

    def minimise(potential, *others):
        if len(potential.contacts):
            kept.append(potential)
        return usual(potential, *others)

    monkeypatch.setattr("clast.step.convex.minimise", minimise)
    march(model, replace(by_convex(stiffness), max_displacement=0.05), step, end)
    return kept


def by_newton(monkeypatch, potential, enough):
    """Return the minimum found by Newton's method alone."""
    point = potential.at(np.zeros((len(potential.fixed), 6)))
    counts = {"passes": 0, "line_search": 0}
    with monkeypatch.context() as alone:
        alone.setattr(newton, "INTERIOR", np.inf)
        found = newton.descend(
            potential, point, FactorOfStep(Direct()), enough, 500, counts, Stages()
        )
    return potential.at(found.unknowns)


def strengthened(potential: Potential, seed: int) -> Potential:
    """Return the potential with random bonds, multipliers, shear forces and friction bounds."""
    rng = np.random.default_rng(seed)
    contacts = potential.contacts
    count = len(contacts)
    force = 1e4
    return replace(
        potential,
        contacts=replace(
            contacts,
            bonded=np.ones(count, np.bool_),
            cohesion=rng.choice([0.0, 1e4], count),
            tensile_strength=rng.choice([0.0, 5e3], count),
            multiplier=rng.choice([0.0, 1.0], count) * force * rng.uniform(0.0, 1.0, count),
            shear_force=force * rng.normal(size=count),
            friction_base=rng.choice([0.0, 1e-6, 1.0], count) * force,
        ),
    )
