"""Templates that run in stages: that they do what their comments say."""

from __future__ import annotations

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES


def outcomes(run):
    """Return how the stages of a run ended, by name."""
    return {one.name: one.outcome for one in run.stages}


@pytest.mark.slow
def test_cables_hold_the_slope_when_water_comes():
    run = Case.from_toml(TEMPLATES["slope"]).run()
    assert set(outcomes(run).values()) == {"equilibrium"}
    assert not run.report.warnings
    assert np.hypot(*run.history("crest").displacement[-1]) < 2e-4


@pytest.mark.slow
def test_without_cables_the_slope_stands_dry_and_slides_wet():
    run = Case.from_toml(TEMPLATES["slope"], ["bolt=[]"]).run()
    assert outcomes(run) == {"dry": "equilibrium", "cables": "equilibrium", "water": "moving"}
    assert np.hypot(*run.history("crest").displacement[-1]) > 0.02


@pytest.mark.slow
def test_bolts_hold_the_wall_of_the_tunnel():
    run = Case.from_toml(TEMPLATES["tunnel"]).run()
    assert outcomes(run)["settled"] == outcomes(run)["support"] == "equilibrium"
    assert not run.report.warnings
    assert np.hypot(*run.field("displacement")[-1].T).max() < 2e-3


@pytest.mark.slow
def test_without_bolts_a_block_of_the_tunnel_comes_loose():
    run = Case.from_toml(TEMPLATES["tunnel"], ["bolt_pattern=[]", "stage.3.time=0.2"]).run()
    assert outcomes(run)["support"] == "moving"
    assert f"block '{run.stages[-1].mover.block}'" in run.report.warnings[0]
    assert (np.hypot(*run.field("displacement")[-1].T) > 0.02).sum() == 1


def test_the_ground_of_the_shaken_wall_ends_where_it_began():
    peak, frequency = 8.0, 1.5
    model = Case.from_toml(TEMPLATES["shaken-wall"]).model()
    record = model.ground_motion.accelerogram
    end = record.time[-1]
    assert np.abs(record.velocity(end)).max() < 1e-12
    assert np.abs(record.displacement(end)).max() < 1e-12
    middle = record.time[record.acceleration[:, 0].argmax()]
    assert record.acceleration[:, 0].max() == pytest.approx(peak, rel=1e-3)
    # the velocity of a Ricker wavelet is peak t exp(-q): largest at q = 1/2
    at = middle + 1.0 / (np.sqrt(2.0) * np.pi * frequency)
    highest = peak / (np.sqrt(2.0) * np.pi * frequency) * np.exp(-0.5)
    assert record.velocity(at)[0] == pytest.approx(highest, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "least", "most"), [(1.0, 2e-3, 0.05), (2.0, 0.2, 0.6)])
@pytest.mark.one_in(2)
def test_the_shaken_wall_cracks_and_twice_as_strong_a_pier_comes_apart(scale, least, most):
    settings = [f"ground_motion.scale={scale}", "time.step=4e-3"]
    run = Case.from_toml(TEMPLATES["shaken-wall"], settings).run()
    assert outcomes(run)["rest"] == "equilibrium"
    assert least < np.hypot(*run.field("displacement")[-1].T).max() < most


def test_drains_relieve_the_dam():
    """N of the base is the weight less the uplift, and its shear force the thrust of the water."""
    run = Case.from_toml(TEMPLATES["dam"]).run()
    assert set(outcomes(run).values()) == {"equilibrium"}
    assert not run.report.warnings
    dam = run.block_name.index("dam")
    weight, thrust = 2400 * 9.81 * 0.5 * (11 + 2) * 15, 0.5 * 9810 * 13.5**2
    for stage, uplift, water in (
        ("empty", 0.0, 0.0),
        ("full", 0.664e6, 1.0),
        ("drained", 0.153e6, 1.0),
    ):
        frame = run.frame(-1, stage=stage)
        contacts, up = frame.contacts, frame.flow.force_on(dam)[1]
        below = (contacts.vertex_block == dam) | (contacts.edge_block == dam)
        assert up == pytest.approx(uplift, rel=2e-3)
        normal, shear = contacts.normal_force[below].sum(), contacts.shear_force[below].sum()
        assert normal == pytest.approx(weight - up, rel=1e-5)
        assert abs(shear) == pytest.approx(water * thrust, rel=1e-4, abs=100.0)
