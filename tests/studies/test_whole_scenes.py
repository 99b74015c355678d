"""Scenes from beginning to end: they have a beginning without overlap, and come to their end."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from clast.cli.commands import app
from clast.studies.bench import WHOLE_SCENES, Settings, deepest_overlap, measure_whole
from clast.studies.bench.table import (
    WHOLE_HEADINGS,
    whole_cells,
    whole_stage_cells,
    whole_stage_headings,
)
from scenes.systems import overlaps


@pytest.mark.parametrize("name", WHOLE_SCENES)
@pytest.mark.parametrize("size", [10, 100, 1000])
def test_whole_scenes_have_the_size_wanted_and_begin_without_overlap(name, size):
    scene = WHOLE_SCENES[name]
    model = scene.build(size)
    assert np.count_nonzero(~model.fixed) == pytest.approx(size, rel=0.1, abs=2)
    assert model.fixed.any()
    assert all(area < 1e-9 for *_, area in overlaps(model, model.vertices))
    assert 1.0 < scene.end(size) < 60.0


def test_a_heap_comes_to_rest_and_its_impacts_are_timed():
    found = measure_whole(WHOLE_SCENES["rest"], 12)
    report = found.report
    assert report.finished and found.simulated == pytest.approx(WHOLE_SCENES["rest"].end(12))
    assert found.speed < 0.05 and found.overlap < 1e-3
    assert report.ledger.impacts > 0.0
    assert 0.0 < found.impacts < 0.5
    assert 0.5 < sum(found.seconds.values()) / found.processor_seconds < 1.01
    assert found.share(report.ledger.unaccounted) < 1e-6
    assert len(whole_cells(found)) == len(WHOLE_HEADINGS)
    assert len(whole_stage_cells([found], found)) == len(whole_stage_headings([found]))


def test_dominoes_fall_one_after_the_other():
    """Every one of them lies on the next at the end, the last on the floor."""
    scene, size = WHOLE_SCENES["dominoes"], 5
    model = scene.build(size)
    found = measure_whole(scene, size)
    assert found.report.finished
    # heights of their centres, of which the potential energy that is gone tells the mean
    weight = model.mass[~model.fixed].sum() * 9.8
    assert -found.report.ledger.gravity / weight > 0.2


def test_the_ground_of_a_slide_goes_down_and_levels_out():
    _, ground = WHOLE_SCENES["slide"].outlines(100)
    top = ground[:, 3:1:-1]
    fall = np.diff(top[..., 1], axis=1)
    assert np.all(fall[:-1] < 0.0) and fall[-1] == 0.0
    assert np.array_equal(top[1:, 0], top[:-1, 1])


def test_overlap_is_the_thickness_of_the_thickest():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    triangle = np.array([(0.0, 0.99), (1.0, 0.99), (0.5, 2.0)])
    assert deepest_overlap([square, square + np.array([0.0, 5.0])]) == 0.0
    assert deepest_overlap([square, triangle]) == pytest.approx(0.01, rel=0.05)


def test_the_command_measures_whole_scenes():
    asked = Settings(scenes=("whole",))
    assert [scene.name for scene in asked.wholes] == list(WHOLE_SCENES)
    assert asked.whole_sizes == (100,) and not asked.models
    result = CliRunner().invoke(app, ["bench", "rest", "--size", "10", "--json"])
    assert result.exit_code == 0
    row = json.loads(result.stdout)["wholes"][0]
    assert (row["scene"], row["blocks"], row["finished"]) == ("rest", 10, True)
    assert {"contacts", "impacts", "law", "ledger"} <= set(row["processor_seconds_by_stage"])
