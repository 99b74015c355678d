"""Water and blocks in one potential, on the joints of the problems of verification."""

from __future__ import annotations

import numpy as np
import pytest

from clast.verification.problems.water.flow_coupled import (
    BULK,
    LOAD,
    VISCOSITY,
    WEIGHT,
    along_joint,
    columns,
    run_of,
    stage,
    water_of,
)

pytestmark = pytest.mark.filterwarnings("ignore::clast.RunWarning")
NONE = {"pressure": 0.0}


def test_a_pressure_above_the_weight_lifts_the_block():
    rises = {"left": {"pressure": 1.001 * LOAD}}
    lift = stage("lift", 0.2, 20, dynamic_ratio=1.0, flow_boundary=rises)
    run = run_of(columns([0.0, 10.0], 5.0, longest=1.0, left=NONE), [lift], settled=2.0)
    assert run.state.velocity[1, 1] > 0.0


@pytest.mark.parametrize(("ratio", "near"), [(3.0, 5e-4), (11.0, 2e-3)])
def test_aperture_follows_pressure_in_steady_flow(ratio, near):
    """q = k_n (a_1^4 - a_2^4)/(48 mu L), though columns turn with the pressure below them."""
    kn, a2, number, long = 1e9, 2e-5, 20, 20.0
    a1 = ratio * a2
    rise = stage("rise", 1e7, 10, flow_boundary={"left": {"pressure": kn * (a1 - a2)}})
    given = {"stiffness": kn, "aperture": a2 + 10.0 * WEIGHT / kn, "left": NONE, "right": NONE}
    run = run_of(columns(np.linspace(0.0, long, number + 1), 10.0, **given), [rise])
    flow = np.abs(water_of(run).solved.flow)
    known = kn * (a1**4 - a2**4) / (48.0 * VISCOSITY * long)
    assert flow == pytest.approx(known, rel=near)
    # what steady flow brings in it loses on its way
    ledger = run.state.ledger
    assert ledger.seepage == pytest.approx(flow.max() * kn * (a1 - a2) * 1e7, rel=0.02)
    assert ledger.water == pytest.approx(ledger.seepage, rel=0.02)
    assert abs(ledger.unaccounted) < 1e-6 * ledger.seepage


def test_steps_of_any_length_come_to_one_answer():
    """A transient in steps of 0.3 ms, 0.1 s and 10 s; without the potential of both they grow."""
    kn, a, head, number = 1e10, 1e-4, 100.0, 6

    def pressures(time: float, step: float) -> np.ndarray:
        steps = round(time / step)
        rise = stage("rise", time, steps, flow_boundary={"left": {"pressure": head}})
        given = {"aperture": a + 10.0 * WEIGHT / kn, "left": NONE}
        return along_joint(
            water_of(run_of(columns(np.arange(number + 1.0), 10.0, **given), [rise]))
        )[1]

    late = pressures(40.0, 0.1)
    assert np.abs(pressures(40.0, 10.0) - late).max() < 0.1 * head
    assert np.abs(pressures(40.0, 1.0) - late).max() < 0.011 * head
    soon = pressures(0.012, 0.3e-3)
    assert np.abs(pressures(0.012, 6e-3) - soon).max() < 0.01 * head
    assert soon.max() == head


@pytest.mark.parametrize("digs", [False, True])
def test_energy_of_water_is_that_in_the_joints_that_are_left(digs):
    """Water of an excavated joint is gone with it; where its wall is bare it runs out."""
    dig = stage("dig", 0.1, 2, excavate=("column 1",) if digs else ())
    run = run_of(columns([0.0, 1.0, 2.0, 3.0], 5.0), [dig], settled=2.0)
    water, ledger = water_of(run), run.state.ledger
    held = 0.5 * (water.volume / BULK) @ water.solved.pressure**2
    assert ledger.water_stored == pytest.approx(held, rel=1e-9)
    assert (ledger.removed != 0.0) == digs
    # of the joint below the column
    gone = 2e-4 if digs else 0.0
    assert water.removed == pytest.approx(gone, rel=1e-3)
    assert run.table("flow", "all joints")["removed"][-1] == water.removed
    x, pressure = along_joint(water)
    bare = (x > 0.5) & (x < 2.5)
    assert (pressure[bare] == 0.0).all() == digs
    assert (pressure[~bare] > 0.0).all()
    assert abs(ledger.unaccounted) < 1e-6 * LOAD * 1e-5


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_mirrored_joints_have_mirrored_pressures(ratio):
    def pressures(side: str, places: np.ndarray) -> np.ndarray:
        rises = {side: {"pressure": 1e4}}
        rise = stage("rise", 0.5, 10, dynamic_ratio=ratio, flow_boundary=rises)
        return along_joint(water_of(run_of(columns(places, 5.0, **{side: NONE}), [rise])))[1]

    places = np.array([0.0, 1.0, 2.5, 3.0, 5.0])
    known = pressures("left", places)
    assert pressures("right", 5.0 - places[::-1])[::-1] == pytest.approx(known, abs=1e-6)
