"""What the report says of water that flows in joints."""

import pytest

import clast
from clast.verification.problems.water.flow_uplift import BASE, LEVEL, dam


def test_the_report_has_flow_pressure_and_reynolds_number():
    run = clast.simulate(dam(), end=0.01, step=0.01)
    notes = [one for one in run.report.notes if one.startswith("flow: ")]
    flow = 2e-4**3 * 1000.0 * 9.81 * LEVEL / (12e-3 * BASE)
    rate = f"flow: {flow:.4g} m3/s per m ({6e5 * flow:.4g} l/min per 10 m)"
    assert f"{rate} leaves the rock at 'bare rock'" in notes
    (reynolds,) = (one for one in notes if "Re = rho q/mu" in one)
    assert float(reynolds.split(", at")[0].split()[-1]) == pytest.approx(1e6 * flow, rel=1e-3)
    (pressure,) = (one for one in notes if "largest pressure" in one)
    assert f"{1000.0 * 9.81 * LEVEL:.4g} Pa, at (0, 0)" in pressure
    still = clast.simulate(at_rest(), end=0.01, step=0.01)
    assert not any("Re =" in one for one in still.report.notes)


def at_rest() -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=30e9, poisson=0.2, density=2400.0)
    builder.add_joint(friction_angle=40.0, aperture=2e-4)
    for x in (0.0, 2.0):
        builder.block(vertices=[(x, 0), (x + 2, 0), (x + 2, 2), (x, 2)], fixed=True)
    builder.flow = {"state": "hydrostatic", "level": 1.0}
    return builder
