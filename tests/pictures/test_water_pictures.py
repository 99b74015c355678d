"""Water in result files and on pictures."""

from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import clast
from clast.actions.water import pressed_by
from clast.pictures import canvas
from clast.pictures.draw_water import PALE, dry_of, pressures_of, waters_of, with_levels
from clast.pictures.figure_options import Look
from clast.pictures.film import FilmLook, FrameDrawer
from clast.pictures.plot import plot_two_frames
from clast.results.frames import absent_in_frame
from clast.run.excavation import without

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


def test_water_is_drawn_where_it_presses_and_nowhere_else(undercut: clast.Run):
    """The run's own forces, and by hand: none beside what is dug, nor on what it has laid bare."""
    results = clast.read(undercut.output)
    last = len(results.times) - 1
    (water,) = waters_of(results, last)
    found = pressures_of(results, (water,), last, results.vertices(last))
    state = undercut.state
    model = without(undercut.model, absent_in_frame(results, last))
    exact = pressed_by(model.water[0], model, state.vertices, state.time)
    np.testing.assert_allclose(found.ends, exact.ends + results.origin)
    np.testing.assert_allclose(found.pressure, exact.pressure)
    before = pressures_of(results, waters_of(results, 0), 0, results.vertices(0))
    # the sides of both voids, with rock beside them or not
    for x, high in ((2.0, 2.0), (4.0, 2.0), (-2.0, 1.0), (-1.0, 1.0)):
        for one, there in ((before, True), (found, False)):
            along = np.abs(one.ends[..., 0] - x).max(axis=1) < 1e-3
            along &= (one.ends[..., 1] > -1e-3).all(axis=1) & (one.ends[..., 1] < high + 1e-3).all(
                axis=1
            )
            assert along.any() == there, x
    # of the floor of the voids and the roof of the closed one nothing is left
    level = np.abs(np.diff(found.ends[..., 1], axis=1)[:, 0]) < 1e-3
    middle = found.ends.mean(axis=1)
    bare = level & (middle[:, 0] > 2.0) & (middle[:, 0] < 4.0) & (np.abs(middle[:, 1]) < 1e-3)
    bare |= level & (middle[:, 0] > -2.0) & (middle[:, 0] < -1.0) & (middle[:, 1] > -0.5)
    bare &= middle[:, 1] < 1.1
    assert not bare.any() and len(found.ends) > 10


def test_a_level_stops_where_it_comes_to_a_void(undercut: clast.Run):
    results = clast.read(undercut.output)
    (water,) = results.water
    assert len(dry_of(results, water, 0)) == 0
    # it comes 0.15 m below the right upper corner of what is dug, and above the closed void
    dry = dry_of(results, water, len(results.times) - 1)
    assert dry == pytest.approx(np.array([[2.0, 4.0]]), abs=0.02)


@pytest.mark.parametrize("drawn", ["plot", "compared"])
def test_no_picture_has_water_in_a_void(undercut: clast.Run, monkeypatch, drawn: str):
    results = clast.read(undercut.output)
    last = len(results.times) - 1
    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    if drawn == "plot":
        clast.plot_results(results, "x.png", field="none", contacts=False)
    else:
        plot_two_frames(results, "x.png", (0, last), field="none")
    axes = figures[0].axes[1 if drawn == "compared" else 0]
    lines = [line.get_xdata() for line in axes.lines if len(line.get_xdata()) > 1]
    assert len(lines) == 2 and max(lines[0]) < 2.1 and min(lines[1]) > 3.9
    blue = [
        path.vertices
        for collection in axes.collections
        if len(collection.get_facecolor())
        and collection.get_facecolor()[0][:3] == pytest.approx(to_rgb(PALE))
        for path in collection.get_paths()
    ]
    middle = np.array([0.25 * one[:4].sum(axis=0) for one in blue])
    assert len(middle) > 10
    for x0, y0, x1, y1 in ((2.05, 0.02, 3.95, 1.9), (-1.95, 0.02, -1.05, 0.98)):
        inside = (middle > (x0, y0)).all(axis=1) & (middle < (x1, y1)).all(axis=1)
        assert not inside.any()


@pytest.mark.parametrize("magnify", [1.0, 3.0])
def test_water_can_be_left_out_of_pictures_and_films(wet_run: clast.Run, tmp_path: Path, magnify):
    picture = tmp_path / "a.svg"
    for water in (True, False):
        look = Look(water=water, magnify=magnify)
        drawn = clast.plot_results(wet_run, picture, look=look).read_text("utf-8")
        assert ("water level" in drawn, "water pressure" in drawn) == (water, water)
    frames = range(len(wet_run.times))
    looks = [FilmLook(size=(400,), water=water, magnify=magnify) for water in (True, False)]
    with_water, without_water = (FrameDrawer(wet_run, frames, one, 400) for one in looks)
    last = len(wet_run.times) - 1
    blue = [
        int((one.picture(last)[..., 2] > 1.3 * one.picture(last)[..., 0]).sum())
        for one in (with_water, without_water)
    ]
    assert blue[0] > 100 > blue[1]


def test_pressures_leave_the_colours_of_blocks_to_be_seen(undercut: clast.Run):
    pixels = []
    for water in (True, False):
        figure = Figure(figsize=(8, 4), dpi=100)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        undercut.plot(ax=axes, field="rock", look=Look(water=water, zoom=(-3, -1, 5, 2)))
        drawn = FigureCanvasAgg(figure)
        drawn.draw()
        pixels.append(np.asarray(drawn.buffer_rgba())[..., :3].astype(float))
    change = np.abs(pixels[0] - pixels[1]).max(axis=2)
    assert 0.03 < (change > 20.0).mean() < 0.25
    assert (change > 80.0).mean() < 0.02
