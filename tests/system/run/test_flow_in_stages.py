"""Whole runs with water that flows in joints: stages, results, files, and going on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.exports.csv_tables import write_csv
from scenes.command_line import good
from scenes.restarts import pressed_at
from scenes.two_lakes import lakes, rock

DRAINED = """
[output]
every = 0.01
[[well]]
name = "drain"
line = [[2.0, 5.0], [3.0, 4.0]]
pressure = 0.0
only_outflow = true
[[measured_flow]]
name = "water in the heading"
of = "tunnel"
"""
STAGES = """
[[stage]]
name = "before"
until = "time"
time = 0.02
[[stage]]
name = "drawdown"
until = "time"
time = 0.02
flow_boundary = {lake = {head = 5.0}}
[[stage]]
name = "drained"
until = "time"
time = 0.01
install = ["drain"]
[[stage]]
name = "dug"
until = "time"
time = 0.02
excavate = ["tunnel"]
"""


def staged() -> clast.Case:
    return clast.Case.from_text(rock() + lakes() + DRAINED + STAGES, "case")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    with pytest.warns(clast.RunWarning):
        return staged().run(output=tmp_path_factory.mktemp("flow") / "run.vtkhdf")


@pytest.mark.filterwarnings("ignore::clast.RunWarning")
def test_stages_end_with_the_flow_of_a_case_that_begins_so(run):
    void = rock(opening="excavated = true") + lakes(head=5.0) + DRAINED
    direct = clast.Case.from_text(void, "case").run()
    for name in ("lake", "sea", "drain", "tunnel", "all joints"):
        last = run.inflow(name).inflow[-1]
        assert last == pytest.approx(direct.inflow(name).inflow[-1], rel=1e-9, abs=1e-18), name


def test_flows_change_with_the_stages_and_balance(run):
    lake, sea, drain, tunnel = (run.inflow(n).inflow for n in ("lake", "sea", "drain", "tunnel"))
    stage = {name: run.frame(stage=name) for name in ("before", "drawdown", "drained", "dug")}
    at = {name: run.rows_at(run.inflow("lake").time, one.number) for name, one in stage.items()}
    assert abs(lake[at["before"]]) < 1e-15
    assert lake[at["drawdown"]] == pytest.approx(-sea[at["drawdown"]], rel=1e-9)
    assert sea[at["drawdown"]] < 0.0
    assert drain[at["drawdown"]] == 0.0 < drain[at["drained"]]
    assert tunnel[at["drained"]] == 0.0 < tunnel[at["dug"]]
    np.testing.assert_allclose(lake + sea + drain + tunnel, 0.0, atol=1e-9 * tunnel[-1])
    everything = run.table("flow", "all joints")
    assert np.abs(everything["unaccounted"]).max() < 1e-12 * tunnel[-1]
    measured = run.inflow("water in the heading")
    np.testing.assert_array_equal(measured.inflow, tunnel)


def test_frames_have_the_channels_and_the_water_table(run):
    first, last = run.flow(0), run.frame(-1).flow
    assert len(last) < len(first)
    assert last.pressure.min() >= 0.0
    level = np.concatenate(run.frame(0).water_table)
    np.testing.assert_allclose(level[:, 1], 7.3, atol=1e-9)
    # balance at an inner node of the frame: what comes along channels leaves along others
    node = np.concatenate([first["first_node"], first["last_node"]])
    out = np.bincount(node, np.concatenate([first["flow"], -first["flow"]]))
    inner = np.bincount(node) == 4
    assert np.abs(out[inner]).max() < 1e-15
    assert any("l/min per 10 m) leaves the rock at 'tunnel'" in one for one in run.report.notes)


def test_the_file_has_the_same_and_so_has_a_run_in_memory(run, tmp_path):
    read = clast.read(run.output)
    with pytest.warns(clast.RunWarning):
        memory = staged().run()
    for other in (read, memory, clast.read(memory.save(tmp_path / "saved.vtkhdf"))):
        for frame in range(len(run.times)):
            np.testing.assert_array_equal(other.flow(frame).rows, run.flow(frame).rows)
        for name in run.flow_name:
            np.testing.assert_array_equal(other.inflow(name).rows, run.inflow(name).rows)
    names = {one.name for one in write_csv(read, tmp_path / "csv")}
    assert {"flow.csv", "measured_flows.csv", "channels.csv"} <= names
    rows = (tmp_path / "csv" / "channels.csv").read_text().splitlines()
    assert len(rows) == 1 + sum(len(run.flow(k)) for k in range(len(run.times)))


def test_water_has_its_entry_in_the_ledger(run):
    energy = run.energy
    assert np.abs(energy["water"]).max() > 0.0
    assert np.abs(energy["unaccounted"]).max() < 1e-6 * np.abs(energy["water"]).max()


def test_without_a_flow_there_is_nothing_of_it(tmp_path: Path):
    dry = clast.Case.from_text(rock(), "case").run(output=tmp_path / "dry.vtkhdf")
    assert dry.flow_name == ()
    assert len(dry.flow()) == 0
    import h5py

    with h5py.File(dry.output) as file:
        assert not {"flow", "measured_flows", "channels"} & set(file)


@pytest.mark.filterwarnings("ignore::clast.RunWarning")
def test_a_run_that_was_stopped_goes_on_to_the_last_bit(run, tmp_path):
    part = staged().run(output=tmp_path / "part.vtkhdf", progress=pressed_at(5))
    assert not part.report.finished
    again = clast.resume(part.checkpoint)
    np.testing.assert_array_equal(again.state.vertices, run.state.vertices)
    for name in run.flow_name:
        np.testing.assert_array_equal(again.inflow(name).rows, run.inflow(name).rows)
    for frame in range(len(run.times)):
        np.testing.assert_array_equal(again.flow(frame).rows, run.flow(frame).rows)


def slope(head: str = "head = 7.0", more: str = "", **time: object) -> clast.Case:
    """Return a block on a level joint before a lake, drained behind."""
    text = f"""
gravity = [0.0, -9.81]
[time]
end = 0.05
step = 1e-2
dynamic_ratio = 0.0
[rock.stone]
young = 50e9
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 40.0
aperture = 2e-4
[[block]]
name = "base"
vertices = [[-5, -2], [15, -2], [15, 0], [-5, 0]]
fixed = true
[[block]]
name = "top"
vertices = [[0, 0], [10, 0], [10, 10], [0, 10]]
[flow]
longest = 1.0
[[flow_boundary]]
name = "lake"
where = {{edges = [[[0, 0], [0, 10]]]}}
{head}
presses = false
{more}
"""
    return clast.Case.from_text(text, "case")


def test_a_head_follows_its_amplitude():
    more = "[amplitude.falling]\ntime = [0.0, 0.04]\nvalue = [8.0, 2.0]\n"
    run = slope('amplitude = "falling"', more).run()
    history = run.inflow("lake")
    level = np.interp(history.time, [0.0, 0.04], [8.0, 2.0])
    known = 9810.0 * level * 2e-4**3 / (12e-3 * 10.0)
    np.testing.assert_allclose(history["into_rock"], known, rtol=1e-9)
    assert not any("falling" in one for one in run.report.warnings)


def test_water_that_waits_for_its_stage_and_a_well_of_its_own():
    more = """
[[well]]
name = "drain"
at = [4.0, 0.0]
pressure = 0.0
only_outflow = true
stage = "second"
[[stage]]
name = "first"
until = "time"
time = 0.02
[[stage]]
name = "second"
until = "time"
time = 0.02
loads = ["lake"]
"""
    run = slope(more=more).run()
    first = run.rows_at(run.inflow("lake").time, run.frame(stage="first").number)
    assert run.inflow("lake").inflow[first] == 0.0
    assert run.inflow("drain").inflow[-1] > 0.0
    assert run.flow(0).pressure.max() == 0.0
    # from the lake to the drain, and none beyond
    flow = run.flow()
    beyond = flow.start[:, 0] > 4.5
    assert np.abs(flow["flow"][beyond]).max() < 1e-18
    assert run.inflow("drain").inflow[-1] == pytest.approx(-run.inflow("lake").inflow[-1])


def test_what_the_flow_cannot_follow_is_warned_of():
    wide = slope(more="").text.replace("aperture = 2e-4", "aperture = 2e-3")
    with pytest.warns(clast.RunWarning, match="Re = rho q/mu is"):
        clast.Case.from_text(wide, "case").run()
    light = slope().text.replace("density = 2600.0", "density = 200.0")
    with pytest.warns(clast.RunWarning, match="have opened by more than half of their aperture"):
        lifted = clast.Case.from_text(light, "case").run()
    (told,) = [one for one in lifted.report.warnings if "water lifts the faces of" in one]
    assert "of 10 m of joints" in told and 'coupling = "full"' in told
    quiet = slope().run().report.warnings
    assert not any("flow:" in one for one in quiet)


def drawdown(more: str) -> clast.Case:
    return clast.Case.from_text(rock() + lakes() + DRAINED + more, "case")


@pytest.mark.filterwarnings("ignore::clast.RunWarning")
def test_water_that_takes_time_drains_into_what_steady_flow_leaves():
    """A lake falls at once: content falls by what has left, and ends as steady flow has it."""
    stages = """
[[stage]]
name = "full"
until = "time"
time = 0.02
[[stage]]
name = "falls"
until = "time"
time = 200.0
step = 10.0
flow = {state = "transient"}
flow_boundary = {lake = {head = 3.0}, sea = {head = 3.0}}
[[stage]]
name = "later"
until = "time"
time = 1e7
step = 1e7
"""
    run = drawdown(stages).run()
    total = run.table("flow", "all joints")
    content, stored = total["content"], total["into_rock"] - total["out_of_rock"]
    np.testing.assert_allclose(total["stored"], stored, atol=1e-12 * np.abs(stored).max())
    step = np.diff(total.time)
    at = np.flatnonzero(step > 1.0)
    assert len(at) >= 20
    gained = (step * stored[1:])[at]
    np.testing.assert_allclose(np.diff(content)[at], gained, atol=1e-12 * content.max())
    assert (np.diff(content)[at] <= 0.0).all()
    scale = np.abs(total["out_of_rock"]).max()
    assert np.abs(total["unaccounted"]).max() < 1e-12 * scale
    steady = drawdown(stages.replace('flow = {state = "transient"}\n', "")).run()
    np.testing.assert_allclose(run.flow().pressure, steady.flow().pressure, atol=10.0)
    # closed ends may keep water that steady flow does not know of
    least = steady.table("flow", "all joints")["content"][-1]
    assert least <= content[-1] < 1.05 * least


@pytest.mark.filterwarnings("ignore::clast.RunWarning")
def test_what_is_in_excavated_joints_goes_with_them():
    """Water in = water out + stored + removed, in every step; removed is what was in the joints."""
    stages = """
[[stage]]
name = "full"
until = "time"
time = 0.02
[[stage]]
name = "falls"
until = "time"
time = 0.2
flow = {state = "transient"}
flow_boundary = {lake = {head = 3.0}}
[[stage]]
name = "dug"
until = "time"
time = 0.2
excavate = ["tunnel"]
"""
    run = drawdown(stages).run()
    before, after = (run.flow(run.frame(stage=name).number) for name in ("falls", "dug"))
    left = set(zip(after["left"], after["right"], strict=True))
    gone = np.array([one not in left for one in zip(before["left"], before["right"], strict=True)])
    assert 0 < gone.sum() == len(before) - len(after)
    water = before["saturation"] + before.pressure / 2e9
    half = 0.25 * np.hypot(*(before.end - before.start).T) * before["aperture"].sum(axis=1)
    held = (half[:, None] * water).sum(axis=1)
    total = run.table("flow", "all joints")
    removed, content = total["removed"], total["content"]
    assert removed[-1] == pytest.approx(held[gone].sum(), rel=1e-5)
    assert np.unique(removed).size == 2
    step, stored = np.diff(total.time), total["into_rock"] - total["out_of_rock"]
    left_over = np.diff(content) - step * stored[1:] + np.diff(removed)
    takes_time = total.time[1:] > 0.0201
    assert np.abs(left_over[takes_time]).max() < 1e-12 * content.max()
    assert run.inflow("tunnel").inflow[-1] > 0.0


def test_a_summary_has_the_flows_at_the_end(run):
    flows = clast.results.summary(clast.read(run.output))["flows"]
    tunnel = run.inflow("tunnel")
    assert flows["tunnel"]["out_of_rock"] == tunnel["out_of_rock"][-1]
    assert flows["all joints"]["pressure"] == run.flow().pressure.max()
    assert "water in joints at the end" in good("info", run.output)


PUMP = """
[[well]]
name = "pump"
at = [4.0, 0.0]
rate = {}
"""


def test_a_pump_that_asks_for_more_than_the_joint_yields_is_told():
    """It takes what the lake's head drives through four metres to where pressure is none."""
    with pytest.warns(clast.RunWarning, match="the pump 'pump' asks for 1 m3/s per m and gets"):
        run = slope(more=PUMP.format(-1.0)).run()
    known = 9810.0 * 7.0 * 2e-4**3 / (12e-3 * 4.0)
    assert run.inflow("pump")["out_of_rock"][-1] == pytest.approx(known, rel=1e-9)


def test_water_without_a_way_out_stops_a_run_with_its_results():
    shut = """
[[stage]]
name = "open"
until = "time"
time = 0.02
[[stage]]
name = "shut"
until = "time"
time = 0.02
flow_boundary = {lake = {impermeable = true}, back = {impermeable = true}}
[[flow_boundary]]
name = "back"
where = {edges = [[[10, 0], [10, 10]]]}
seepage = true
"""
    with pytest.raises(clast.RunStopped, match="water has nowhere to go") as stopped:
        slope(more=PUMP.format(1e-6) + shut).run()
    assert stopped.value.run.times[-1] == pytest.approx(0.02)
    assert "give these joints a [[flow_boundary]]" in str(stopped.value)
