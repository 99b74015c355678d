"""Water in result files and on pictures."""

from pathlib import Path

import matplotlib
import numpy as np
import pytest

import clast
from clast.pictures.draw_water import pressures_of, waters_of, with_levels
from clast.pictures.figure_options import Look

matplotlib.use("Agg")


def test_a_result_file_keeps_the_water(wet_run: clast.Run):
    assert wet_run.output is not None
    (back,) = clast.read(wet_run.output).water
    (kept,) = wet_run.model.water
    assert (back.name, back.weight, back.share) == (kept.name, kept.weight, kept.share)
    assert back.factor is not None and kept.factor is not None
    assert back.factor.name == "rise"
    pairs = [(back.surface, kept.surface), (back.factor.value, kept.factor.value)]
    for one, other in ((back.faces, kept.faces), (back.joints, kept.joints)):
        pairs += [(values, vars(other)[name]) for name, values in vars(one).items()]
    for one, other in pairs:
        np.testing.assert_array_equal(one, other)


def test_pressures_of_a_frame_follow_table_and_depth(wet_run: clast.Run):
    assert wet_run.output is not None
    results = clast.read(wet_run.output)
    assert not waters_of(results, 0)
    last = len(results.times) - 1
    found = pressures_of(results, waters_of(results, last), last, results.vertices(-1))
    assert found.largest == pytest.approx(1000.0 * 9.81 * 3.4, rel=1e-3)  # at the foot of the base
    on_faces = found.sides[:, 0] == 0.0
    assert (found.ends[..., 0] > 9999.0).all()  # where the user drew them
    assert on_faces.any() and not on_faces.all()


def test_the_level_above_the_blocks_is_in_the_picture(wet_run: clast.Run, tmp_path: Path):
    part = np.array([1e4, -1.0]), np.array([10004.0, 2.0])
    assert with_levels(wet_run, wet_run.water, part)[1][1] == pytest.approx(2.4)
    path = clast.plot_results(wet_run, tmp_path / "pier.svg", field="block")
    text = path.read_text("utf-8")
    assert "water level" in text and "water pressure, up to 33.4 kPa" in text
    zoomed = clast.plot_results(
        wet_run, tmp_path / "zoom.svg", look=Look(zoom=(10001, 0, 10002, 1)), contacts=False
    )
    assert zoomed.exists()


def test_a_picture_without_water_says_nothing_of_it(tmp_path: Path):
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (0, 1)], fixed=True)
    run = clast.simulate(builder, end=0.002, step=1e-3)
    assert "water" not in clast.plot_results(run, tmp_path / "dry.svg").read_text("utf-8")
