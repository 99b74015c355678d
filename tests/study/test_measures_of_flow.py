"""Measures of water that flows in joints: inflow, largest pressure, uplift."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.pictures.fields import prefixed
from clast.study.expressions import read
from clast.study.measures import MEASURES, RunResults, check, known_names
from clast.verification.problems.water.flow_uplift import BASE, LEVEL, dam, exact_uplift

PRESSURE = 1000.0 * 9.81 * LEVEL


def value(run: clast.Run, text: str) -> Any:
    expression = read(text, "measure", [], MEASURES)
    check(expression, known_names(run.model))
    results = RunResults(run)
    return expression.value({}, {k: partial(one.value, results) for k, one in MEASURES.items()})


@pytest.mark.parametrize("drained", [False, True])
def test_uplift_and_flow_are_those_of_the_joint(drained: bool):
    """To the toe, or to drains 2 m behind the heel: triangles of pressure."""
    run = clast.simulate(dam(drained), end=0.02, step=0.01, dynamic_ratio=0.0)
    assert value(run, "uplift(dam)") == pytest.approx(exact_uplift(drained), rel=1e-6)
    assert value(run, "uplift(rock)") == pytest.approx(-exact_uplift(drained), rel=1e-6)
    assert value(run, "water_pressure()") == pytest.approx(PRESSURE)
    flow = 2e-4**3 * PRESSURE / (12e-3 * (2.0 if drained else BASE))
    into = '"drains"' if drained else '"bare rock"'
    assert value(run, f"inflow({into})") == pytest.approx(flow)
    assert value(run, "inflow(reservoir)") == pytest.approx(-flow)


def test_a_column_of_water_pushes_the_blocks_beside_it():
    """Half of a joint under 12 m is full: rho g d^2/2 to either side, whichever way it is drawn."""
    places = {"west": -4.0, "east": 0.0}
    for order in (("west", "east"), ("east", "west")):
        builder = clast.ModelBuilder(gravity=(0.0, -9.81))
        builder.add_rock("rock", young=30e9, poisson=0.2, density=2400.0)
        builder.add_joint(friction_angle=40.0, aperture=2e-4)
        for name in order:
            left = places[name]
            corners = [(left, 0), (left + 4, 0), (left + 4, 12), (left, 12)]
            builder.block(name=name, vertices=corners, fixed=True)
        builder.flow = {"state": "hydrostatic", "level": 6.0}
        run = clast.simulate(builder, end=0.01, step=0.01)
        push = 1000.0 * 9.81 * 6.0**2 / 2.0
        for name, force in (("west", -push), ("east", push)):
            block = run.model.block_name.index(name)
            np.testing.assert_allclose(run.flow(-1).force_on(block), [force, 0.0], atol=1e-6 * push)


def test_what_is_not_there_is_refused():
    run = clast.simulate(dam(), end=0.01, step=0.01)
    for text, words in (
        ("uplift(damm)", "there is no block 'damm'"),
        ("inflow(lake)", "there is no flow 'lake'"),
        ("water_pressure(dam)", "water_pressure is of no names"),
    ):
        with pytest.raises(CaseError, match=words):
            value(run, text)
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(name="stone", vertices=[(0, 0), (1, 0), (0, 1)])
    dry = clast.simulate(builder, end=0.01, step=0.01)
    for text in ("uplift(stone)", "inflow(lake)", "water_pressure()"):
        with pytest.raises(CaseError, match="of water that flows in joints, and there is none"):
            value(dry, text)


def test_square_metres_have_no_prefix():
    assert prefixed(4.9e-6, "m2/s") == (1.0, "m2/s")
    assert prefixed(4.9e-6, "m") == (1e6, "µm")


def test_twice_the_aperture_is_eight_times_the_flow(tmp_path: Path):
    """A sweep over apertures from its case file; the uplift does not change."""
    builder = clast.ModelBuilder(title="Dam", gravity=(0.0, -9.81))
    builder.add_rock("rock", young=30e9, poisson=0.2, density=2400.0)
    builder.add_joint(friction_angle=45.0, aperture=2e-4)
    builder.block(name="rock", vertices=[(-5, -5), (15, -5), (15, 0), (-5, 0)], fixed=True)
    builder.block(name="dam", vertices=[(0, 0), (10, 0), (2, 15), (0, 15)])
    builder.flow = {"longest": 1.0}
    wet = [((-5.0, 0.0), (0.0, 0.0)), ((0.0, 0.0), (0.0, 15.0))]
    builder.flow_boundary("reservoir", edges=wet, head=12.0)
    case = tmp_path / "dam.toml"
    case.write_text(builder.to_toml(step=0.01, end=0.01), encoding="utf-8")
    study = clast.Study(
        case,
        vary={"joint.default.aperture": [1e-4, 2e-4, 4e-4]},
        measure={"Q": 'inflow("bare rock")', "U": "uplift(dam)", "p": "water_pressure()"},
    )
    table = study.run(tmp_path / "study", workers=1)
    flow = np.array(table["Q"], float)
    np.testing.assert_allclose(flow[1:] / flow[:-1], 8.0)
    np.testing.assert_allclose(np.array(table["U"], float), exact_uplift(False), rtol=1e-5)
