"""Water and blocks in one potential, on the joints of the problems of verification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clast
from clast.run.flow_warnings import flow_warnings
from clast.verification.problems.water import flow_follows
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


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ({"angle": 37.0}, 1e-9),
        ({"angle": 90.0}, 1e-12),
        ({"mirrored": True}, 1e-12),
        ({"order": np.random.default_rng(3).permutation(20)}, 1e-12),
    ],
    ids=["turned", "turned upright", "mirrored", "renumbered"],
)
def test_blocks_and_water_are_the_same(given, same):
    def found(**given) -> np.ndarray:
        model = flow_follows.model_of(20, **given)
        whole = {"state": "transient", "coupling": "full", "initial": "hydrostatic", "level": 0.0}
        model = replace(model, flow=replace(model.flow, **whole))
        run = flow_follows.at_rest(model, end=1e3, step=1e2)
        flow = flow_follows.through(run) / flow_follows.FLOW
        return np.array([flow, *np.sort(water_of(run).solved.pressure / 1e5)])

    known = found()
    assert 0.9 < known[0] < 1.0
    assert found(**given) == pytest.approx(known, rel=0.0, abs=same)


def test_a_pump_draws_no_more_than_a_joint_holds():
    """It gets the share of its rate that the node is full by, and is told of the rest."""
    builder = columns([0.0, 10.0], 5.0)
    builder.well("well", (5.0, 0.0), rate=-1e-4, stage="pump")
    run = run_of(builder, [stage("pump", 100.0, 20)], settled=2.0)
    water = water_of(run)
    (node,) = np.flatnonzero(water.conditions.inflow < 0.0)
    assert 0.99 * water.volume[node] < water.void[node] < water.volume[node]
    drawn = 1e-4 - water.solved.missing[node]
    assert drawn == pytest.approx(1e-4 * water.solved.saturation[node], rel=1e-6)
    assert abs(water.solved.unaccounted) < 1e-12 * water.solved.throughput
    (warning,) = flow_warnings(run.model, run.state)
    assert "the pump 'well' asks for 0.0001 m3/s per m" in warning


WALLS = """
title = "A column of water beside a block"
gravity = [0.0, -9.81]
[time]
end = 1000.0
step = 100.0
dynamic_ratio = 0.0
[joint.default]
friction_angle = 0.0
normal_stiffness = 1e10
[joint.wet]
between_rocks = [["wall", "block"]]
friction_angle = 0.0
normal_stiffness = 1e10
aperture = 2e-4
[flow]
state = "transient"
coupling = "full"
initial = "hydrostatic"
level = {level}
{flow}
[[well]]
name = "well"
at = [0.0, 0.0]
head = {level}
[[flow_boundary]]
where = {{polygon = [[-9, -9], [9, -9], [9, 9], [-9, 9]]}}
impermeable = true
"""


@pytest.mark.parametrize("level", [0.4, 2.3, 4.9, 5.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("flow", ["", "longest = 1.0"])
def test_a_column_of_water_presses_as_high_as_it_stands(level, side, flow):
    """rho g H^2/2, wherever the nodes of the joint are."""
    text = WALLS.format(level=level, flow=flow)
    rocks = {"wall": (-2, 0, 0, 5), "block": (0, 0, 2, 5), "stop": (2, 0, 4, 5)}
    for name, (left, low, right, high) in {**rocks, "floor": (-2, -1, 4, 0)}.items():
        text += f"[rock.{name}]\nyoung = 50e9\npoisson = 0.0\ndensity = 2600.0\n"
        left, right = sorted((side * left, side * right))
        outline = [[left, low], [right, low], [right, high], [left, high]]
        text += f'[[block]]\nname = "{name}"\nrock = "{name}"\nvertices = {outline}\n'
        text += f"fixed = {str(name != 'block').lower()}\n"
    run = clast.Case.from_text(text, "case").run()
    memory, block = run.state.memory, run.model.vertex_block
    pairs = np.sort(np.stack([block[memory.vertex], memory.block], axis=1), axis=1)
    carried = [memory.normal_force[(pairs == pair).all(axis=1)].sum() for pair in ([1, 2], [0, 1])]
    assert carried[0] - carried[1] == pytest.approx(0.5 * 9810.0 * level**2, rel=1e-5)
