"""The comparison with other programs: same outlines, same measures, a page of what is kept."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
import pytest

from benchmarks import peers, programs
from benchmarks.bench import benchmark
from benchmarks.scenes import WHOLE_SCENES, BenchSettings, model_of
from benchmarks.tables import put_tables

PROGRAMS = (
    programs.Clast(0.005),
    programs.Chipmunk(50),
    programs.Box2D(),
    programs.Box2D(500.0),
)


@pytest.fixture
def small_wall() -> programs.Setting:
    return programs.Setting(
        name="wall", free=peers.outlines_of_wall(3, 3), fixed=peers.box(-1.0, -1.0, 4.0, 0.0)
    )


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.name)
def test_a_wall_stands_in_every_program(small_wall, program):
    if program.missing:
        pytest.skip(f"{program.missing} is not installed")
    outcome = program.simulate(small_wall, 0.05, 60.0)
    found = peers.figures(small_wall, program, outcome)
    assert outcome.free.shape == small_wall.free.shape
    assert (found.simulated, found.remark) == (pytest.approx(0.05), "")
    assert found.drift is not None
    assert found.drift < 1e-2 and found.overlap < 1e-2
    assert found.seconds > 0.0


def test_runs_that_take_too_long_end_early(small_wall):
    outcome = programs.Clast(0.005).simulate(small_wall, 1.0, 0.0)
    assert outcome.time == pytest.approx(0.005)
    assert outcome.remark == "stopped after 0 s"
    time, _, remark = programs.stepped(lambda: None, 1.0, 0.0)
    assert (time, remark) == (pytest.approx(1e-3), "stopped after 0 s")


def test_overlaps_are_measured_by_their_thickness():
    squares = np.concatenate([peers.box(0.0, 0.0, 1.0, 1.0), peers.box(0.0, 0.999, 1.0, 1.999)])
    assert peers.deepest_overlap(squares) == pytest.approx(1e-3, rel=2e-3)
    assert peers.deepest_overlap(squares[:1]) == 0.0


@pytest.mark.parametrize("name", WHOLE_SCENES)
def test_other_programs_get_the_outlines_of_whole_scenes(name):
    setting = peers.whole(name, 30)
    model = model_of("whole", setting.free, setting.fixed)
    assert len(setting.free) == pytest.approx(30, abs=5)
    assert np.array_equal(model.vertices, WHOLE_SCENES[name].build(30).vertices)


def test_rigid_outlines_turn_about_their_centre():
    square = peers.box(0.0, 0.0, 1.0, 1.0)
    turned = programs.moved(square, np.array([[0.5, 0.5]]), np.array([0.5 * np.pi]))
    assert turned[0] == pytest.approx(np.roll(square[0], -1, axis=0))


@pytest.mark.slow  # a whole scene, to its rest
def test_the_page_shows_what_is_kept(small_wall, tmp_path):
    outcome = programs.Clast(0.005).simulate(small_wall, 0.01, 60.0)
    row = asdict(peers.figures(small_wall, programs.Clast(0.005), outcome))
    whole = asdict(replace(peers.figures(small_wall, programs.Clast(0.005), outcome), scene="rest"))
    bench = benchmark(("stack", "rest"), (12,), BenchSettings(steps=2))
    kept = {"machine": peers.machine(), "rows": [whole, row]}
    file = tmp_path / "page.md"
    file.write_text(peers.PAGE.read_text(encoding="utf-8"), encoding="utf-8")
    put_tables(file, peers.page_tables(kept, bench))
    page = file.read_text(encoding="utf-8")
    assert page.count("<!-- end -->") == 3 and "1,012 blocks" not in page
    assert page.index("### Wall at rest, 10 blocks") < page.index("### Heap to rest, 10 blocks")
    assert "| clast, h = 5 ms, p = 1 E |" in page
    assert "| stack | 13 |" in page
    assert "| rest | 12 |" in page
