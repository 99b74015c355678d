"""Scenes of any size, what is measured of them, and the program ``benchmarks.bench``."""

from __future__ import annotations

import json

import numpy as np
import pytest

from benchmarks import bench
from benchmarks.bench import benchmark, deepest_overlap, measure, measure_whole
from benchmarks.cuts import CUTS, measure_cut
from benchmarks.scenes import (
    SCENES,
    WHOLE_SCENES,
    BenchSettings,
    outlines_of_wall,
    wall,
)
from clast.results import read_results
from scenes.systems import overlaps

STAGES = {"contacts", "base system", "law", "advance", "ledger", "other"}


# --- scenes --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("size", [100, 1012, 3000])
def test_scenes_have_the_size_wanted_and_do_not_overlap(name, size):
    model = SCENES[name].build(size)
    assert abs(model.block_count - size) <= 0.1 * size
    assert model.fixed.any() and not model.fixed.all()
    assert all(area < 1e-9 for *_, area in overlaps(model, model.vertices))


@pytest.mark.parametrize("name", WHOLE_SCENES)
@pytest.mark.parametrize("size", [10, 100, 1000])
def test_whole_scenes_have_the_size_wanted_and_begin_without_overlap(name, size):
    scene = WHOLE_SCENES[name]
    model = scene.build(size)
    assert np.count_nonzero(~model.fixed) == pytest.approx(size, rel=0.1, abs=2)
    assert model.fixed.any()
    assert all(area < 1e-9 for *_, area in overlaps(model, model.vertices))
    assert 1.0 < scene.end(size) < 60.0


@pytest.mark.parametrize(("courses", "columns", "bricks"), [(10, 10, 105), (45, 22, 1012)])
def test_walls_have_half_bricks_at_their_ends(courses, columns, bricks):
    outlines = outlines_of_wall(courses, columns)
    assert len(outlines) == bricks
    assert np.ptp(outlines[:, :, 0]) == columns
    assert wall(courses, columns).area.sum() == pytest.approx(0.5 * courses * columns + columns + 2)


@pytest.mark.parametrize("name", [name for name, scene in SCENES.items() if scene.rests])
def test_scenes_at_rest_stand(name):
    row = measure(SCENES[name], 100, BenchSettings(steps=20, step=5e-3))
    assert row["finished"] and row["drift"] < 1e-4


def test_squares_fall_from_the_start():
    model = SCENES["heap"].build(30)
    row = measure(SCENES["heap"], 30, BenchSettings(steps=4, step=5e-3))
    assert row["contacts"] == 0 and row["drift"] is None
    assert row["simulated"] == pytest.approx(0.02)
    turned = model.vertices[model.block_start[:-1]][~model.fixed]
    assert len(np.unique(np.round(turned[:, 0] % 1.15, 9))) > 20
    assert np.array_equal(model.vertices, SCENES["heap"].build(30).vertices)


def test_the_ground_of_a_slide_goes_down_and_levels_out():
    _, ground = WHOLE_SCENES["slide"].outlines(100)
    top = ground[:, 3:1:-1]
    fall = np.diff(top[..., 1], axis=1)
    assert np.all(fall[:-1] < 0.0) and fall[-1] == 0.0
    assert np.array_equal(top[1:, 0], top[:-1, 1])


# --- figures -------------------------------------------------------------------------------


def test_overlap_is_the_thickness_of_the_thickest():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    triangle = np.array([(0.0, 0.99), (1.0, 0.99), (0.5, 2.0)])
    assert deepest_overlap([square, square + np.array([0.0, 5.0])]) == 0.0
    assert deepest_overlap([square, triangle]) == pytest.approx(0.01, rel=0.05)


def test_every_scene_is_measured():
    content = json.loads(json.dumps(benchmark(list(SCENES), (40,), BenchSettings(steps=3))))
    assert content["cuts"] == content["wholes"] == []
    assert content["settings"]["end"] == pytest.approx(3e-3)
    assert {"python", "numpy", "numba", "clast"} <= set(content["machine"]["versions"])
    assert [row["scene"] for row in content["rows"]] == list(SCENES)
    for row in content["rows"]:
        assert row["finished"] and row["steps"] == 3
        assert set(row["ms_per_step_by_stage"]) >= STAGES
        assert sum(row["ms_per_step_by_stage"].values()) == pytest.approx(row["ms_per_step"])
        assert row["peak_memory"] > 2**20
        if SCENES[row["scene"]].rests:  # a heap falls freely at first: there is nothing to solve
            assert row["counts_per_step"]["passes"] > 0.0


def test_a_run_that_stops_is_a_row_like_the_others():
    row = measure(SCENES["heap"], 40, BenchSettings(step=1e3, steps=1))
    assert row["finished"] is False
    assert row["outcome"].startswith("stopped at")


@pytest.mark.parametrize("name", CUTS)
@pytest.mark.parametrize("size", [100, 1500])
def test_networks_have_about_the_size_wanted(name, size):
    row = measure_cut(CUTS[name], size)
    assert row["blocks"] == pytest.approx(size, rel=0.25 if size == 100 else 0.1)
    assert abs(row["area_error"]) < 1e-9
    assert {"lines", "noding", "faces", "tidying", "report"} <= set(row["seconds_by_stage"])
    assert sum(row["seconds_by_stage"].values()) == pytest.approx(row["wall_seconds"])
    assert 0.0 < row["processor_seconds"] < 2.0 * row["wall_seconds"]


def test_a_heap_comes_to_rest_and_its_impacts_are_timed():
    row = measure_whole(WHOLE_SCENES["rest"], 12)
    assert row["finished"] and row["simulated"] == pytest.approx(WHOLE_SCENES["rest"].end(12))
    assert row["speed_at_end"] < 0.05 and row["overlap_at_end"] < 1e-3
    assert row["energy_lost_in_impacts"] > 0.0
    assert 0.0 < row["share_of_impacts"] < 0.5
    stages = row["processor_seconds_by_stage"]
    assert {"contacts", "impacts", "law", "ledger"} <= set(stages)
    assert 0.5 < sum(stages.values()) / row["processor_seconds"] < 1.01
    assert abs(row["energy_unaccounted"]) < 1e-6 * row["energy_turned_over"]


def test_dominoes_fall_one_after_the_other():
    """Every one of them lies on the next at the end, the last on the floor."""
    scene, size = WHOLE_SCENES["dominoes"], 5
    model = scene.build(size)
    row = measure_whole(scene, size)
    assert row["finished"]
    # heights of their centres, of which the potential energy that is gone tells the mean
    weight = model.mass[~model.fixed].sum() * 9.8
    assert -row["energy_of_gravity"] / weight > 0.2


# --- the command -----------------------------------------------------------------------------


def test_cutting_needs_no_kernel(monkeypatch, capsys):
    monkeypatch.setattr(bench, "warm_up", lambda *_: pytest.fail("something was compiled"))
    bench.main(["baecher", "cut", "--size", "60"])
    printed = capsys.readouterr().out
    assert printed.index("baecher") < printed.index("persistent")
    assert "noding" in printed and "first steps" not in printed


def test_the_command_prints_tables_and_keeps_json_and_states(tmp_path, capsys):
    output = tmp_path / "bench.json"
    words = ["wall", "--size", "40", "--steps", "3"]
    bench.main([*words, "-o", str(output), "--results", str(tmp_path)])
    printed = capsys.readouterr().out
    for word in ("wall", "ms per step", "small islands"):
        assert word in printed
    content = json.loads(output.read_text(encoding="utf-8"))
    assert content["rows"][0]["scene"] == "wall"
    assert len(read_results(tmp_path / "wall-40.vtkhdf").times) == 2


REFUSED = {
    "scene": ["walls"],
    "no number": ["--size", "ten"],
    "half a block": ["--size", "10.5"],
    "size 0": ["--size", "0"],
    "negative step": ["--step", "-1e-3"],
    "no steps": ["--steps", "0"],
    "stiffness": ["--stiffness", "nan"],
    "folder": ["-o", "nowhere/bench.json"],
    "results": ["--results", "nowhere"],
}


@pytest.mark.parametrize("words", REFUSED.values(), ids=list(REFUSED))
def test_bad_settings_are_refused_before_anything_runs(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        bench.main(words)
    assert not list(tmp_path.iterdir())
