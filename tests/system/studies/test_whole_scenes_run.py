"""Scenes from beginning to end come to their end, and what is measured of them."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from clast.cli.commands import app
from clast.studies.bench import WHOLE_SCENES, measure_whole
from clast.studies.bench.bench_table import (
    WHOLE_HEADINGS,
    whole_cells,
    whole_stage_cells,
    whole_stage_headings,
)


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


def test_the_command_measures_whole_scenes():
    result = CliRunner().invoke(app, ["bench", "rest", "--size", "10", "--json"])
    assert result.exit_code == 0
    row = json.loads(result.stdout)["wholes"][0]
    assert (row["scene"], row["blocks"], row["finished"]) == ("rest", 10, True)
    assert {"contacts", "impacts", "law", "ledger"} <= set(row["processor_seconds_by_stage"])
