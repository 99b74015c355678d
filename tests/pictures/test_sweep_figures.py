"""Figures of sweeps: what is drawn of runs that stand, fail, or have no result."""

from itertools import product

import numpy as np
import pytest

from clast.pictures import canvas
from clast.pictures.study.figures import BLUE, RED
from clast.pictures.study.sweep_figures import (
    MOST_PANELS,
    SweepAxis,
    SweepGrid,
    draw_sweep,
    is_by_logarithms,
    panels_in,
    panels_of,
)

ANGLE, COHESION = SweepAxis(label="phi", values=(30, 20, 25), unit="°"), (1e3, 1e5, 1e4)


def grid(*axes, lost=(), label="u (m)"):
    """Return a grid of u = product of the positions + 1, which fails above 2."""
    shape = tuple(len(one.values) for one in axes)
    values = np.array([np.prod(np.add(at, 1.0)) for at in np.ndindex(shape)]).reshape(shape)
    is_lost = np.zeros(shape, bool)
    for at in lost:
        is_lost[at], values[at] = True, np.nan
    return SweepGrid(axes=axes, label=label, values=values, fails=values > 2.0, lost=is_lost)


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Return a function that draws a grid and returns its figure."""
    pytest.importorskip("matplotlib")
    kept, save = [], canvas.save
    monkeypatch.setattr(canvas, "save", lambda figure, path: kept.append(figure) or path)

    def draw(one):
        draw_sweep(one, tmp_path / "sweep.png")
        assert save(kept[-1], tmp_path / "sweep.png").stat().st_size > 5000
        return kept[-1]

    return draw


def marks(axes, colour, mark):
    """Return the points of a curve with a mark, (k, 2)."""
    own = [one for one in axes.get_lines() if (one.get_color(), one.get_marker()) == (colour, mark)]
    assert len(own) == 1
    return own[0].get_xydata().tolist()


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([1e3, 1e4, 1e5], True),
        ([1e5, 1e3, 1e4], True),
        ([1, 2, 5, 10, 20, 50], True),
        ([20, 25, 30, 35, 40], False),
        ([26, 28, 30, 32, 34, 36, 38, 95], False),
        ([20, 22, 25, 30, 35, 40, 45], False),
        ([1e3, 8e3, 15e3, 3e4], False),
        (np.linspace(1.0, 1000.0, 40), False),
        ([1e7, 1e10], True),
        ([20, 40], False),
        ([0, 1, 10, 100], False),
        ([-1, -10, -100], False),
        ([5, 5, 5], False),
    ],
)
def test_an_axis_is_logarithmic_where_logarithms_are_more_even(values, found):
    assert is_by_logarithms(np.array(values, float)) is found


def test_a_curve_marks_runs_by_their_end(drawn):
    """Values in the order of the axis, not of the list; the lost run at the lower edge."""
    axis = SweepAxis(label="phi", values=(35, 20, 25, 30), unit="°")
    axes = drawn(grid(axis, lost=[(2,)])).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("phi (°)", "u (m)")
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "linear")
    line = axes.get_lines()[0].get_xydata()
    assert np.array_equal(line, [[20, 2], [25, np.nan], [30, 4], [35, 1]], equal_nan=True)
    assert marks(axes, BLUE, "o")[0] == [20.0, 2.0] and marks(axes, BLUE, "o")[-1] == [35.0, 1.0]
    assert marks(axes, RED, "X") == [[30.0, 4.0]]
    assert [x for x, _ in marks(axes, canvas.INK, "x")] == [25.0]
    assert [one.get_text() for one in axes.get_legend().get_texts()] == [
        "stands",
        "fails",
        "no result",
    ]


def test_a_curve_of_decades_has_a_logarithmic_axis(drawn):
    axes = drawn(grid(SweepAxis(label="c", values=COHESION, unit="Pa"))).axes[0]
    assert axes.get_xscale() == "log"
    assert axes.get_xlabel() == "c (Pa)"


def test_a_curve_of_texts_and_of_one_kind_of_run(drawn):
    axes = drawn(grid(SweepAxis(label="process", values=("modified", True)))).axes[0]
    assert [one.get_text() for one in axes.get_xticklabels()] == ["modified", "true"]
    assert axes.get_legend() is None


def by_values(one):
    """Return the value of each combination: names with values -> measure."""
    found = {}
    for at in product(*(range(len(axis.values)) for axis in one.axes)):
        key = frozenset((axis.label, axis.values[k]) for axis, k in zip(one.axes, at, strict=True))
        found[key] = (one.values[at], one.fails[at], one.lost[at])
    return found


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0), (2, 1, 0)])
def test_panels_keep_each_value_with_its_parameters(order):
    """Whichever way the lists are ordered, and the values in them."""
    axes = [
        ANGLE,
        SweepAxis(label="c", values=(2.0, 1.0, 4.0, 3.0)),
        SweepAxis(label="on", values=(True, False)),
    ]
    one = grid(*(axes[k] for k in order))
    found, titles, places = panels_of(one)
    assert by_values(found) == by_values(one)
    assert [axis.label for axis in found.axes] == ["on", "phi", "c"]
    assert found.axes[1].values == (20, 25, 30) and found.axes[2].values == (1.0, 2.0, 3.0, 4.0)
    assert titles == [("on = true",), ("on = false",)] and places == [(0,), (1,)]
    assert panels_in(one) == 2


def test_a_matrix_has_numbers_frames_and_crosses(drawn):
    one = grid(ANGLE, SweepAxis(label="c", values=(*COHESION, 2e5), unit="Pa"), lost=[(0, 1)])
    axes = drawn(one).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("c (Pa)", "phi (°)")
    assert [text.get_text() for text in axes.get_xticklabels()] == [
        "1000",
        "10000",
        "100000",
        "200000",
    ]
    rows, columns = [1, 2, 0], [0, 2, 1, 3]
    wanted = {
        (x, y): f"{one.values[row, column]:.3g}"
        for y, row in enumerate(rows)
        for x, column in enumerate(columns)
        if not one.lost[row, column]
    }
    assert {text.get_position(): text.get_text() for text in axes.texts} == wanted
    frames = axes.collections[0].get_paths()
    middles = {tuple(np.round(frame.vertices[:4].mean(axis=0)).astype(int)) for frame in frames}
    assert middles == {at for at, text in wanted.items() if float(text) > 2.0}
    assert axes.get_lines()[0].get_xydata().tolist() == [[2.0, 2.0]]


def test_more_parameters_have_small_matrices_of_the_same_colours(drawn):
    axes = [SweepAxis(label=name, values=(1, 2, 3)) for name in "abcd"]
    figure = drawn(grid(*axes))
    *panels, scale = figure.axes
    assert len(panels) == 9 and panels_in(grid(*axes)) == 9
    assert {one.images[0].norm for one in panels} == {panels[0].images[0].norm}
    assert panels[0].images[0].norm.vmax == 81.0
    assert panels[5].get_title() == "c = 2\nd = 3"
    assert scale.get_xlabel() == "u (m)"
    boxes = [one.get_tightbbox(figure.canvas.get_renderer()) for one in panels]
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[k + 1 :])


def test_of_very_many_matrices_the_first_are_drawn(drawn):
    axes = [SweepAxis(label=name, values=tuple(range(4))) for name in "abcd"]
    assert len(drawn(grid(*axes)).axes) == MOST_PANELS + 1
    assert panels_in(grid(*axes)) == 16
