"""Water and blocks in one potential, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import erfc

from scenes.coupled_joints import WEIGHT, along_joint, run_of, text_of, water_of

pytestmark = pytest.mark.filterwarnings("ignore::clast.RunWarning")
VISCOSITY, BULK = 1e-3, 2e9


def test_pressure_runs_along_a_joint_on_springs_as_consolidation_does():
    """D = a^3 k_n/12 mu, less what water itself gives way; 1 % in 20 steps."""
    kn, a, head, columns = 1e10, 1e-4, 100.0, 16
    spread = a**3 / (12.0 * VISCOSITY) / (1.0 / kn + a / BULK)
    time = (columns / 6.0) ** 2 / spread
    rise = {"time": time, "step": time / 20.0}
    rise["more"] = f"flow_boundary = {{left = {{pressure = {head}}}}}"
    text = text_of(
        np.arange(columns + 1.0), 10.0, rise, aperture=a + 10.0 * WEIGHT / kn, left="pressure = 0.0"
    )
    water = water_of(run_of(text))
    x, pressure = along_joint(water)
    assert np.abs(pressure - head * erfc(x / np.sqrt(4.0 * spread * time))).max() < 0.01 * head
    assert abs(water.solved.unaccounted) < 1e-12 * water.solved.throughput


@pytest.mark.parametrize("kn", [1e9, 1e11])
@pytest.mark.parametrize("longest", [1.0, 10.0])
def test_a_load_on_a_closed_joint_is_carried_by_its_water_until_it_drains(kn, longest):
    """p = sigma tau/(1 + tau) with tau = K/(a k_n); then springs carry it all."""
    load, a0 = 5.0 * WEIGHT, 2e-4
    drained = {"time": 1e5, "step": 1e4, "more": "flow_boundary = {left = {pressure = 0.0}}"}
    given = {"stiffness": kn, "settled": 2.0, "flow": f"longest = {longest}"}
    if kn == 1e9:
        given["aperture"] = a0 = 4e-4
    closed = water_of(run_of(text_of([0.0, 10.0], 5.0, **given)))
    pressure = load
    for _ in range(50):
        a = a0 / (1.0 + pressure / BULK)
        pressure = load / (1.0 + kn * a / BULK)
    assert closed.solved.pressure == pytest.approx(pressure, rel=1e-6)
    water = water_of(run_of(text_of([0.0, 10.0], 5.0, drained, **given)))
    assert np.abs(water.solved.pressure).max() < 1e-3 * load
    assert water.opening == pytest.approx(a0 - load / kn, abs=1e-3 * load / kn)


@pytest.mark.parametrize("volume", [5e-5, 1e-3, 1e-2])
def test_water_put_into_a_closed_joint_jacks_it_open(volume):
    """The block rides on its water: mean p = W/L; and the joint opens by V less what is pressed."""
    well = '[[well]]\nname = "well"\nat = [5.0, 0.0]\nrate = {}\nstage = "stage 0"\n'
    jack = {"time": 50.0, "step": 10.0}
    run = run_of(
        text_of(
            [0.0, 10.0],
            5.0,
            jack,
            settled=2.0,
            flow="longest = 1.0",
            more=well.format(volume / 50.0),
        )
    )
    water = water_of(run)
    x, pressure = along_joint(water)
    assert np.trapezoid(pressure, x) == pytest.approx(5.0 * WEIGHT * 10.0, rel=3e-6)
    # the water that was there has been pressed together by the weight
    held = 10.0 * 2e-4 * 5.0 * WEIGHT / BULK
    opened = 10.0 * (water.opening.mean() - 2e-4)
    assert opened + held == pytest.approx(volume, rel=3e-6)


@pytest.mark.parametrize("share", [0.5, 0.99])
def test_contacts_carry_what_a_given_pressure_leaves_them(share):
    load = 5.0 * WEIGHT
    rise = f"{{pressure = {share * load}}}"
    rises = f"flow_boundary = {{left = {rise}, right = {rise}}}"
    lift = {"time": 1e4, "step": 1e3, "more": rises}
    text = text_of(
        [0.0, 10.0], 5.0, lift, flow="longest = 1.0", left="pressure = 0.0", right="pressure = 0.0"
    )
    run = run_of(text)
    assert water_of(run).solved.pressure == pytest.approx(share * load, rel=1e-9)
    carried = run.state.memory.normal_force.sum()
    assert carried == pytest.approx(10.0 * load * (1.0 - share), abs=1e-5 * load)


def test_a_pressure_above_the_weight_lifts_the_block():
    load = 5.0 * WEIGHT
    rises = f"flow_boundary = {{left = {{pressure = {1.001 * load}}}}}"
    lift = {"time": 0.2, "step": 1e-2, "ratio": 1.0, "more": rises}
    given = {"settled": 2.0, "flow": "longest = 1.0", "left": "pressure = 0.0"}
    run = run_of(text_of([0.0, 10.0], 5.0, lift, **given))
    assert run.state.velocity[1, 1] > 0.0


@pytest.mark.parametrize(("ratio", "near"), [(3.0, 5e-4), (11.0, 2e-3)])
def test_aperture_follows_pressure_in_steady_flow(ratio, near):
    """q = k_n (a_1^4 - a_2^4)/(48 mu L), though columns turn with the pressure below them."""
    kn, a2, columns, long = 1e9, 2e-5, 20, 20.0
    a1 = ratio * a2
    rise = {
        "time": 1e7,
        "step": 1e6,
        "more": f"flow_boundary = {{left = {{pressure = {kn * (a1 - a2)}}}}}",
    }
    text = text_of(
        np.linspace(0.0, long, columns + 1),
        10.0,
        rise,
        stiffness=kn,
        aperture=a2 + 10.0 * WEIGHT / kn,
        left="pressure = 0.0",
        right="pressure = 0.0",
    )
    run = run_of(text)
    flow = np.abs(water_of(run).solved.flow)
    known = kn * (a1**4 - a2**4) / (48.0 * VISCOSITY * long)
    assert flow == pytest.approx(known, rel=near)
    # what steady flow brings in it loses on its way
    ledger = run.state.ledger
    assert ledger.seepage == pytest.approx(flow.max() * kn * (a1 - a2) * 1e7, rel=0.02)
    assert ledger.water == pytest.approx(ledger.seepage, rel=0.02)
    assert abs(ledger.unaccounted) < 1e-6 * ledger.seepage


def test_a_joint_that_opens_faster_than_water_follows_is_left_with_voids():
    """Opening = water + void, and no suction; then the void fills before the water presses."""
    lift = '[[motion]]\nblock = "column 0"\ny = {displacement = "lift"}\nstage = "stage 0"\n'
    lift += "[amplitude.lift]\ntime = [0.0, 0.1, 1.0]\nvalue = [0.0, 1e-4, 1e-4]\n"
    given = {"settled": 2.0, "flow": "longest = 1.0", "bulk": 2e13}
    stages = [
        {"time": 0.1, "step": 0.02},
        {"time": 0.1, "step": 0.02, "more": "flow_boundary = {left = {pressure = 1e4}}"},
    ]
    lifted = water_of(run_of(text_of([0.0, 10.0], 5.0, *stages[:1], **given, more=lift)))
    assert lifted.solved.pressure == pytest.approx(0.0, abs=1e-9)
    opened = 10.0 * (lifted.opening.mean() - 2e-4)
    assert lifted.void.sum() == pytest.approx(opened, rel=1e-7)
    # less what the block lengthens where water no longer presses
    assert opened == pytest.approx(1e-3, rel=0.04)
    filled = water_of(run_of(text_of([0.0, 10.0], 5.0, *stages, **given, more=lift)))
    assert filled.solved.pressure.min() >= 0.0
    assert 0.0 < filled.void.sum() < lifted.void.sum()
    assert abs(filled.solved.unaccounted) < 1e-12 * filled.solved.throughput


def test_steps_of_any_length_come_to_one_answer():
    """A transient in steps of 0.3 ms, 0.1 s and 10 s; without the potential of both they grow."""
    kn, a, head, columns = 1e10, 1e-4, 100.0, 6

    def pressures(time: float, step: float, ratio: float = 0.0) -> np.ndarray:
        rise = {
            "time": time,
            "step": step,
            "ratio": ratio,
            "more": f"flow_boundary = {{left = {{pressure = {head}}}}}",
        }
        places = np.arange(columns + 1.0)
        given = {"aperture": a + 10.0 * WEIGHT / kn, "left": "pressure = 0.0"}
        return along_joint(water_of(run_of(text_of(places, 10.0, rise, **given))))[1]

    late = pressures(40.0, 0.1)
    assert np.abs(pressures(40.0, 10.0) - late).max() < 0.1 * head
    assert np.abs(pressures(40.0, 1.0) - late).max() < 0.011 * head
    soon = pressures(0.012, 0.3e-3)
    assert np.abs(pressures(0.012, 6e-3) - soon).max() < 0.01 * head
    assert soon.max() == head


@pytest.mark.parametrize("digs", [False, True])
def test_energy_of_water_is_that_in_the_joints_that_are_left(digs):
    """Water of an excavated joint is gone with it; where its wall is bare it runs out."""
    dig = {"time": 0.1, "step": 0.05, "more": 'excavate = ["column 1"]' if digs else ""}
    run = run_of(text_of([0.0, 1.0, 2.0, 3.0], 5.0, dig, settled=2.0))
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
    assert abs(ledger.unaccounted) < 1e-6 * 5.0 * WEIGHT * 1e-5


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_mirrored_joints_have_mirrored_pressures(ratio):
    def pressures(side: str, places: np.ndarray) -> np.ndarray:
        rise = {"time": 0.5, "step": 0.05, "ratio": ratio}
        rise["more"] = f"flow_boundary = {{{side} = {{pressure = 1e4}}}}"
        given = {"aperture": 2e-4, side: "pressure = 0.0"}
        return along_joint(water_of(run_of(text_of(places, 5.0, rise, **given))))[1]

    places = np.array([0.0, 1.0, 2.5, 3.0, 5.0])
    known = pressures("left", places)
    assert pressures("right", 5.0 - places[::-1])[::-1] == pytest.approx(known, abs=1e-6)
