"""Scenes of any size, what is measured of them, and the command ``clast bench``."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from clast.cli.commands import app
from clast.errors import CaseError
from clast.results import read_results
from clast.studies.bench import (
    CUTS,
    SCENES,
    Benchmark,
    BenchSettings,
    benchmark,
    measure,
    measure_cut,
    measuring,
    sizes_in,
)
from clast.studies.bench.bandwidth import (
    bytes_of_product,
    matrix_of_directions,
    system_of_step,
)
from clast.studies.bench.bench_table import (
    HEADINGS,
    MEMORY_HEADINGS,
    cells,
    memory_cells,
    remarks,
    stage_cells,
    stage_headings,
)
from clast.studies.bench.scenes import outlines_of_wall, wall
from clast.studies.bench.settings import method_for, schedule_of
from scenes.systems import at_start, overlaps

SHORT = ["--size", "40", "--steps", "3"]
PRODUCT = {"bytes", "rate", "triad", "triad_by_threads", "shared", "share"}
STAGES = {"contacts", "base system", "law", "advance", "ledger", "other"}


def bench_command(*arguments: object):
    return CliRunner().invoke(app, ["bench", *map(str, arguments)])


@pytest.fixture(scope="module")
def measured() -> Benchmark:
    return benchmark(BenchSettings(sizes=(40,), steps=3))


# --- scenes --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("size", [100, 1012, 3000])
def test_scenes_have_the_size_wanted_and_do_not_overlap(name, size):
    model = SCENES[name].build(size)
    assert abs(model.block_count - size) <= 0.1 * size
    assert model.fixed.any() and not model.fixed.all()
    assert all(area < 1e-9 for *_, area in overlaps(model, model.vertices))


@pytest.mark.parametrize(("courses", "columns", "bricks"), [(10, 10, 105), (45, 22, 1012)])
def test_walls_have_half_bricks_at_their_ends(courses, columns, bricks):
    outlines = outlines_of_wall(courses, columns)
    assert len(outlines) == bricks
    assert np.ptp(outlines[:, :, 0]) == columns
    assert wall(courses, columns).area.sum() == pytest.approx(0.5 * courses * columns + columns + 2)


@pytest.mark.parametrize("name", [name for name, scene in SCENES.items() if scene.rests])
def test_scenes_at_rest_stand(name):
    found = measure(SCENES[name], 100, BenchSettings(steps=20, step=5e-3))
    assert found.report.finished
    assert found.drift is not None
    assert found.drift < 1e-4


def test_squares_fall_from_the_start():
    model = SCENES["heap"].build(30)
    found = measure(SCENES["heap"], 30, BenchSettings(end=0.02, step=5e-3))
    assert found.contacts == 0 and found.drift is None
    assert found.costs.simulated == pytest.approx(0.02)
    turned = model.vertices[model.block_start[:-1]][~model.fixed]
    assert len(np.unique(np.round(turned[:, 0] % 1.15, 9))) > 20
    again = SCENES["heap"].build(30)
    assert np.array_equal(model.vertices, again.vertices)


# --- figures -------------------------------------------------------------------------------


def test_every_scene_is_measured(measured):
    assert [row.scene.name for row in measured.rows] == list(SCENES)
    for row in measured.rows:
        assert row.report.finished and row.steps == 3
        assert set(row.stages) >= STAGES
        assert sum(row.stages.values()) == pytest.approx(row.milliseconds)
        assert row.footprint.per_block > 400.0
        assert row.peak > 2**20
        if row.scene.rests:
            assert row.product is not None and row.product.rate > 0.0
        assert len(cells(row)) == len(HEADINGS)
        assert len(stage_cells(measured, row)) == len(stage_headings(measured))
        assert len(memory_cells(measured, row)) == len(MEMORY_HEADINGS)
    assert any("triad" in remark for remark in remarks(measured))


def test_steps_in_which_a_wall_settles_are_not_counted():
    whole = measure(SCENES["wall"], 100, BenchSettings(steps=6))
    rest = measure(SCENES["wall"], 100, BenchSettings(steps=2, settle=4))
    assert (whole.costs.steps, rest.costs.steps, rest.report.steps) == (6, 2, 6)
    assert rest.costs.simulated == pytest.approx(2e-3)
    assert rest.costs.counts["passes"] < whole.costs.counts["passes"]
    assert rest.costs.wall < rest.report.wall_seconds
    assert rest.drift == whole.drift


def test_figures_for_a_program(measured):
    content = json.loads(json.dumps(measured.as_dict()))
    assert set(content) == {
        "format",
        "machine",
        "settings",
        "triad",
        "triad_by_threads",
        "rows",
        "cuts",
        "wholes",
    }
    assert content["cuts"] == []
    assert content["wholes"] == []
    assert {"cpu", "cores", "memory", "system", "versions"} == set(content["machine"])
    assert {"python", "numpy", "numba", "clast"} <= set(content["machine"]["versions"])
    assert content["settings"]["end"] == pytest.approx(3e-3)
    for row in content["rows"]:
        assert row["wall_per_simulated_second"] > 0.0
        if SCENES[row["scene"]].rests:  # a heap falls freely at first: there is nothing to solve
            assert row["counts_per_step"]["passes"] > 0.0
            assert set(row["product"]) == PRODUCT


def test_the_product_moves_every_block_once():
    model = SCENES["wall"].build(100)
    system = system_of_step(model, method_for(model, BenchSettings()), at_start(model), 1e-3)
    assert system is not None
    matrix = matrix_of_directions(system)
    coupled = np.count_nonzero(system.upper.any(axis=(1, 2)))
    assert 0 < coupled < len(system.pairs)
    # single precision: 144 bytes a block; vectors of eight, short numbers of blocks
    assert bytes_of_product(matrix) == model.block_count * (144 + 64) + coupled * (144 + 8)


def test_a_singular_system_has_no_product():
    model = SCENES["wall"].build(40)
    system = system_of_step(model, method_for(model, BenchSettings()), at_start(model), 1e-3)
    assert measuring._product(system) is not None
    assert measuring._product(replace(system, diagonal=-system.diagonal)) is None


def test_a_run_that_stops_is_a_row_like_the_others(tmp_path):
    wanted = BenchSettings(sizes=(40,), step=1e3, steps=1)
    found = measure(SCENES["heap"], 40, wanted)
    content = found.as_dict()
    assert content["finished"] is False
    assert content["outcome"].startswith("stopped at")


# --- networks that are only cut --------------------------------------------------------------


@pytest.mark.parametrize("name", CUTS)
@pytest.mark.parametrize("size", [100, 1500])
def test_networks_have_about_the_size_wanted(name, size):
    found = measure_cut(CUTS[name], size)
    assert found.blocks == pytest.approx(size, rel=0.25 if size == 100 else 0.1)
    assert abs(found.area_error) < 1e-9
    assert {"lines", "noding", "faces", "tidying", "report"} <= set(found.seconds)
    assert 0.0 < max(found.seconds.values()) < found.total
    assert 0.0 < found.processor_seconds < 2.0 * found.total
    assert found.peak > 2**20


def test_networks_are_chosen_together_or_by_name():
    both = BenchSettings(scenes=("baecher", "cut", "wall"))
    assert [one.name for one in both.cuts] == ["baecher", "persistent"]
    assert [one.name for one in both.models] == ["wall"]
    assert BenchSettings().cuts == () and len(BenchSettings().models) == len(SCENES)
    assert (both.model_sizes, both.cut_sizes) == ((100, 1000), (100_000,))
    assert BenchSettings(sizes=(40,)).cut_sizes == (40,)


def test_cutting_needs_no_kernel(monkeypatch):
    def refuse(*_: object) -> None:
        raise AssertionError("something was compiled")

    monkeypatch.setattr(measuring, "warm_up", refuse)
    found = benchmark(BenchSettings(scenes=("persistent",), sizes=(40,)))
    assert len(found.cuts) == 1 and found.rows == () and found.triad == 0.0


def test_the_command_cuts(tmp_path):
    output = tmp_path / "cut.json"
    done = bench_command("cut", "--size", "60", "-o", output)
    assert done.exit_code == 0, done.output
    for word in ("persistent", "baecher", "noding", "area error"):
        assert word in done.stdout
    assert "triad" not in done.stdout
    rows = json.loads(output.read_text(encoding="utf-8"))["cuts"]
    assert [row["scene"] for row in rows] == ["persistent", "baecher"]
    for row in rows:
        assert sum(row["seconds_by_stage"].values()) == pytest.approx(row["wall_seconds"])


# --- settings --------------------------------------------------------------------------------


def test_sizes():
    assert sizes_in("100, 1e5") == (100, 100_000)
    assert schedule_of(BenchSettings(step=0.01, steps=7)).end == pytest.approx(0.07)
    with pytest.raises(CaseError, match="no size"):
        BenchSettings(sizes=())


REFUSED = {
    "scene": (["walls"], "did you mean 'wall'?"),
    "network": (["persistant"], "did you mean 'persistent'?"),
    "no number": (["--size", "ten"], "is not a valid number of blocks"),
    "half a block": (["--size", "10.5"], "is not a valid number of blocks"),
    "size 0": (["--size", "0"], "give a number of blocks from"),
    "negative step": (["--step", "-1e-3"], "--step: -0.001 must be above 0"),
    "no steps": (["--steps", "0"], "--steps: 0 is not a valid number of steps"),
    "both": (["--steps", "1", "--end", "1"], "--steps and --end"),
    "negative settle": (["--settle", "-1"], "--settle: -1 is not a valid number of steps"),
    "negative end": (["--end", "-1"], "--end"),
    "stiffness": (["--stiffness", "nan"], "--stiffness"),
    "solver": (["--solver", "cholesk"], "did you mean 'cholesky'?"),
    "folder": (["-o", "nowhere/bench.json"], "its folder does not exist"),
    "results": (["--results", "nowhere"], "is not a folder"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_settings_are_refused_before_anything_runs(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments, message = REFUSED[case]
    done = bench_command(*arguments)
    assert done.exit_code == 2, done.output
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


# --- the command -----------------------------------------------------------------------------


def test_the_command_prints_tables_and_keeps_json_and_states(tmp_path):
    output = tmp_path / "bench.json"
    done = bench_command("wall", *SHORT, "-o", output, "--results", tmp_path)
    assert done.exit_code == 0, done.output
    for word in ("wall", "ms per step", "small islands", "of triad", "GB/s"):
        assert word in done.stdout
    assert json.loads(output.read_text(encoding="utf-8"))["rows"][0]["scene"] == "wall"
    kept = read_results(tmp_path / "wall-40.vtkhdf")
    assert len(kept.times) == 2


def test_the_command_for_a_program():
    done = bench_command("stack", *SHORT, "--solver", "cholesky", "--json")
    content = json.loads(done.stdout)
    assert content["settings"]["solver"] == "cholesky"
    assert [row["scene"] for row in content["rows"]] == ["stack"]
    assert not Path("bench.json").exists()
