"""The force of a bolt by its length: elastic, yielding, unloading, broken."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.actions.bolts import Bolting, ruptured, stretched
from clast.model.model import Model

STIFFNESS, STRENGTH, PRETENSION = 2e6, 3e4, 5e3


def hung(**kind: object) -> Model:
    """A square below a beam, held by a bolt of 1 m."""
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=1e10, poisson=0.2, density=2500.0)
    builder.block(vertices=[(-2, 1), (2, 1), (2, 2), (-2, 2)], fixed=True)
    builder.block(vertices=[(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    given = {"stiffness": STIFFNESS, "yield_force": STRENGTH, "pretension": PRETENSION, **kind}
    builder.add_bolt_kind("bar", **given)
    builder.bolt((0, 0), (0, 1), kind="bar", name="b")
    return builder.build()


def forces(model: Model, *stretches: float) -> list[float]:
    """Return the forces, N/m, of the bolt at one stretch, m, after the other."""
    own = Bolting().begin(model)
    found = []
    for stretch in stretches:
        own = stretched(model.bolts, own, np.array([1.0 + stretch]), 0.0)
        own = ruptured(model.bolts, own, 0.0)
        found.append(float(own.force[0]))
    return found


def test_it_is_elastic_below_its_yield_force():
    expected = [PRETENSION + STIFFNESS * x for x in (0.0, 0.005, 0.01, 0.002)]
    assert forces(hung(), 0.0, 0.005, 0.01, 0.002) == pytest.approx(expected)


def test_it_yields_and_unloads_along_the_elastic_line():
    """Yields at 0.0125 m; stretched to 0.02 m it keeps 0.0075 m."""
    found = forces(hung(), 0.01, 0.02, 0.015, 0.02, 0.025, 0.02)
    lasting = 0.0075
    expected = [
        PRETENSION + STIFFNESS * 0.01,
        STRENGTH,
        PRETENSION + STIFFNESS * (0.015 - lasting),
        STRENGTH,
        STRENGTH,
        PRETENSION + STIFFNESS * (0.02 - lasting - 0.005),
    ]
    assert found == pytest.approx(expected)


def test_it_goes_slack_and_bears_again():
    assert forces(hung(), -0.01, 0.0) == pytest.approx([0.0, PRETENSION])


def test_broken_it_bears_nothing_for_good():
    assert forces(hung(rupture_elongation=0.03), 0.02, 0.05, 0.0)[1:] == [0.0, 0.0]
