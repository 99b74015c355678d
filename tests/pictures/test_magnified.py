"""Displacements that are drawn larger than they are."""

from pathlib import Path

import matplotlib
import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.pictures import canvas
from clast.pictures.figure_options import Look
from clast.pictures.film import FilmLook, FrameDrawer
from clast.pictures.frames import FrameDrawing
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.magnified import factor_to_be_seen, magnified

matplotlib.use("Agg")


@pytest.fixture(scope="module")
def leaning() -> clast.Run:
    """A column of two blocks that gravity presses together and a force turns a little."""
    builder = clast.ModelBuilder(title="Column", gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e8, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=40.0)
    builder.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="lower", vertices=[(0, 0), (1, 0), (1, 2), (0, 2)])
    builder.block(name="upper", vertices=[(0, 2), (1, 2), (1, 4), (0, 4)])
    builder.measured_point(name="top", at=(0.5, 4.0))
    builder.point_load(at=(1.0, 3.5), force=(4e3, 0.0))
    return clast.simulate(builder, end=0.05, step=1e-3)


@pytest.fixture(scope="module")
def bolted() -> clast.Run:
    """A block that hangs from a bolt in a fixed one."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e8, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=40.0)
    builder.block(name="roof", vertices=[(0, 1), (2, 1), (2, 3), (0, 3)], fixed=True)
    builder.block(name="wedge", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.add_bolt_kind("bar", stiffness=1e7)
    builder.bolt((1.0, 0.0), (1.0, 2.5), name="B", kind="bar")
    return clast.simulate(builder, end=0.05, step=1e-3)


@pytest.mark.parametrize("factor", [0.5, 40.0])
def test_every_place_moves_so_many_times_as_far(leaning: clast.Run, factor: float):
    drawn, start = magnified(leaning, factor), leaning.vertices(0)
    last = len(leaning.times) - 1
    moved = leaning.vertices(last) - start
    assert np.abs(moved).max() > 1e-5
    np.testing.assert_allclose(drawn.vertices(last), start + factor * moved)
    np.testing.assert_array_equal(
        drawn.field("displacement", last), leaning.field("displacement", last)
    )
    # a corner in contact is drawn where its block is
    contacts, places = leaning.contacts(last), drawn.contacts(last).position
    own = leaning.vertices(last)[contacts.vertex]
    at_corner = np.hypot(*(contacts.position - own).T) < 1e-9
    assert at_corner.any()
    np.testing.assert_allclose(
        places[at_corner], drawn.vertices(last)[contacts.vertex[at_corner]], atol=1e-9
    )
    assert drawn.contacts(0).position == pytest.approx(leaning.contacts(0).position)


def test_points_and_label_are_magnified_and_values_are_not(leaning: clast.Run, tmp_path: Path):
    last = len(leaning.times) - 1
    look = Look(magnify=2000.0, layers=("levels", "vectors"))
    drawing = FrameDrawing(leaning, [last], "displacement", look)
    plain = FrameDrawing(leaning, [last], "displacement", Look(layers=("levels", "vectors")))
    moved = leaning.history("top").displacement[-1]
    assert drawing._points[last][0] == pytest.approx([0.5, 4.0] + 2000.0 * moved)
    labels, before = ([h.get_label() for h in one.handles(last)] for one in (drawing, plain))
    assert [one for one in labels if one not in before] == ["displacements × 2,000"]
    assert set(before) <= set(labels)
    seen = drawing.part
    assert drawing.scale([last], seen, None) == plain.scale([last], plain.part, None)
    for field in ("opening", "slip"):
        values = [JOINT_FIELDS[field].values(one, last).value for one in (leaning, drawing.results)]
        np.testing.assert_allclose(*values)
    path = clast.plot_results(leaning, tmp_path / "a.svg", look=look, reactions=True)
    assert "displacements × 2,000" in path.read_text("utf-8")


def test_a_chosen_factor_is_round_and_shows_a_twentieth(leaning: clast.Run):
    last = len(leaning.times) - 1
    factor = factor_to_be_seen(leaning, [last])
    assert f"{factor:e}"[0] in "125" and float(f"{factor:.0e}") == factor
    largest = np.hypot(*(leaning.vertices(last) - leaning.vertices(0)).T).max()
    assert 0.02 * 5.0 <= factor * largest <= 0.05 * 5.0
    assert factor_to_be_seen(leaning, [0]) == 1.0  # nothing has moved
    assert FrameDrawing(leaning, [last], "none", Look(magnify="auto")).factor == factor


def test_a_film_shows_one_factor_in_all_pictures(leaning: clast.Run):
    frames = range(len(leaning.times))
    look = FilmLook(size=(400,), magnify="auto", field="none")
    drawer = FrameDrawer(leaning, frames, look, 400)
    still = FrameDrawer(leaning, frames, FilmLook(size=(400,), field="none"), 400)
    first, last = drawer.picture(0), drawer.picture(len(frames) - 1)
    assert (first != last).any(axis=2).mean() > 1.2 * (
        still.picture(0) != still.picture(len(frames) - 1)
    ).any(axis=2).mean()
    assert drawer._drawing.factor == factor_to_be_seen(leaning, frames)


@pytest.mark.parametrize("magnify", [0.0, -3.0, float("nan"), float("inf"), "much"])
def test_other_factors_are_refused(magnify):
    for look in (Look, FilmLook):
        with pytest.raises(CaseError, match="magnify"):
            look(magnify=magnify)


def test_two_frames_and_axes_of_ones_own_say_the_factor(leaning: clast.Run, monkeypatch):
    from matplotlib.figure import Figure

    from clast.pictures.plot import plot_two_frames

    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    plot_two_frames(leaning, "x.png", (0, -1), look=Look(magnify=50.0))
    assert "displacements × 50" in [t.get_text() for t in figures[0].legends[0].get_texts()]
    axes = Figure().add_subplot()
    leaning.plot(ax=axes, look=Look(magnify=50.0))
    assert axes.get_title(loc="right") == "displacements × 50"


def test_points_of_bolts_move_with_their_blocks(bolted: clast.Run):
    last = len(bolted.times) - 1
    start, now = (bolted.bolts(frame).points for frame in (0, last))
    drawn = magnified(bolted, 7.0).bolts(last).points
    np.testing.assert_allclose(drawn, start + 7.0 * (now - start))
