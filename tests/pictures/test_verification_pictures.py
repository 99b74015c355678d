"""Figures of verification problems: nothing is covered, cut or lost in a crowd."""

from __future__ import annotations

import dataclasses
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from clast.pictures.canvas import SMALL_SIZE
from clast.pictures.draw_water import BLUE
from clast.pictures.verification import (
    CROWD,
    ROCK,
    ROOM,
    SUPPORT,
    Chart,
    curve,
    draw_problem,
    exact_curve,
    figure_of,
)
from clast.thumbnails import CURVE_COLOURS

X = np.linspace(0.0, 0.02, 60)


def chart(curves: int, label: str = "modified, lagged friction") -> Chart:
    waves = [curve(f"{label} {k}", X, np.sin(900.0 * X)) for k in range(curves - 1)]
    every = (exact_curve("formula", X, np.sin(900.0 * X)), *waves)
    return Chart(title=f"{curves} curves", x_label="slip, m", y_label="way, m", curves=every)


SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def rock() -> InputBuilder:
    builder = InputBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    return builder


def blocks(count: int):
    """Return a row of blocks that move, on nothing."""
    builder = rock()
    for k in range(count):
        builder.block(vertices=np.add(SQUARE, (1.5 * k, 0.0)), velocity=(1.0, 0.3, 0.0))
    return builder.build()


@pytest.mark.parametrize("curves", [(2,), (5,), (16,), (3, 9, 2)])
def test_legends_cover_nothing_and_nothing_is_cut(curves: tuple[int, ...]):
    figure = figure_of(blocks(2), [chart(count) for count in curves])
    figure.canvas.draw()
    width, height = figure.canvas.get_width_height()
    boxes = []
    for axes in figure.axes:
        whole = axes.get_tightbbox()
        assert whole.x0 >= -1.0 and whole.y0 >= -1.0
        assert whole.x1 <= width + 1.0 and whole.y1 <= height + 1.0
        boxes.append(whole)
        legend = axes.get_legend()
        if legend is not None:
            assert legend.get_window_extent().x0 >= axes.get_window_extent().x1
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)
    # where nothing is held no room is kept for it
    assert boxes[0].x0 < 0.05 * width


def column(high: float) -> Any:
    """Return one block that is 1 m wide, its left edge at -0.5 m."""
    builder = rock()
    builder.block(vertices=[(-0.5, 0.0), (0.5, 0.0), (0.5, high), (-0.5, high)])
    return builder.build()


@pytest.mark.parametrize("set_up", [blocks(2), *map(column, (0.2, 0.6, 1.0, 2.0, 5.0, 12.0))])
def test_numbers_of_an_axis_do_not_meet(set_up: Any):
    figure = figure_of(set_up, [chart(3)])
    figure.canvas.draw()
    for axis in (figure.axes[1].xaxis, figure.axes[0].xaxis):
        labels = [one.get_window_extent() for one in axis.get_ticklabels() if one.get_text()]
        assert all(a.x1 < b.x0 for a, b in pairwise(labels))


@pytest.mark.parametrize("flat", [0.15, 0.17, 0.2, 0.25, 0.3, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("low", [0.0, -0.5])
def test_numbers_above_each_other_do_not_meet(flat: float, low: float):
    builder = rock()
    builder.block(vertices=np.add(SQUARE, (0.0, low)) * (6.2, 6.2 * flat))
    figure = figure_of(builder.build(), [chart(3)])
    figure.canvas.draw()
    axis = figure.axes[0].yaxis
    low, high = axis.get_view_interval()
    labels = [
        one.get_window_extent()
        for place, one in zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=True)
        if low <= place <= high
    ]
    assert labels and all(a.y1 <= b.y0 for a, b in pairwise(labels))


def test_of_many_arrows_and_marks_some_are_drawn():
    few, many = (figure_of(blocks(count), []).axes[0] for count in (3, 150))
    assert len(few.texts) == 3
    foot = np.sort([text.xyann[0] for text in many.texts])
    assert CROWD / 2 < len(foot) < 1.0 / ROOM + 2
    assert np.diff(foot).min() >= ROOM * (149 * 1.5 + 1.0)
    dense = dataclasses.replace(
        chart(1), curves=(curve("dense", np.linspace(0.0, 1.0, 4000), np.zeros(4000)),)
    )
    figure = figure_of(blocks(1), [dense])
    figure.canvas.draw()
    line = figure.axes[1].lines[0]
    assert isinstance(line.get_markevery(), float)


def test_every_one_of_a_few_values_has_its_mark():
    few = (curve("one", np.array([2.0]), np.array([1.0])), curve("two", np.arange(2.0), np.ones(2)))
    figure = figure_of(blocks(1), [dataclasses.replace(chart(1), curves=few)])
    figure.canvas.draw()
    assert [line.get_markevery() for line in figure.axes[1].lines] == [None, None]


@pytest.mark.parametrize(
    "span",
    [
        (50.0, 100.0),
        (2e8, 2e9),
        (1e-7, 2e-6),
        (250.0, 6000.0),
        (3.0, 4.5),
        (1e-3, 1e5),
        (0.17, 0.72),
    ],
)
@pytest.mark.parametrize("scales", [("log", "linear"), ("linear", "log"), ("log", "log")])
def test_numbers_of_logarithmic_axes_are_few_and_as_small_as_others(span: Any, scales: Any):
    line = curve("one", np.geomspace(*span, 5), np.geomspace(*span, 5))
    wide = dataclasses.replace(chart(1), curves=(line,), x_scale=scales[0], y_scale=scales[1])
    figure = figure_of(blocks(1), [wide])
    figure.canvas.draw()
    axes = figure.axes[1]
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        labels = [
            one
            for place, one in zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=True)
            if low <= place <= high and one.get_text()
        ]
        assert 2 <= len(labels) <= 7
        assert {one.get_fontsize() for one in labels} <= {SMALL_SIZE}
        assert not any(one.get_text() for one in axis.get_ticklabels(minor=True))
        boxes = [one.get_window_extent() for one in labels]
        assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


def test_every_curve_has_a_colour_and_a_mark_of_its_own():
    figure = figure_of(blocks(1), [chart(31)])
    marks = [(line.get_color(), line.get_marker()) for line in figure.axes[1].lines[1:]]
    assert len(set(marks)) == 30


def test_a_palette_keeps_the_colours_of_thin_marks(tmp_path: Path):
    """Marks of few points of each colour, and a set-up of many colours beside them."""
    from PIL import Image

    some = tuple(curve(str(k), np.arange(3.0), k + np.arange(3.0)) for k in range(6))
    file = tmp_path / "few.png"
    draw_problem(blocks(3), [dataclasses.replace(chart(1), curves=some)], file)
    found = np.unique(np.asarray(Image.open(file).convert("RGB")).reshape(-1, 3), axis=0)
    for colour in (ROCK, "#ffffff"):  # of large areas
        assert (found == [int(colour[k : k + 2], 16) for k in (1, 3, 5)]).all(axis=1).any()
    for colour in CURVE_COLOURS[:6]:
        asked = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
        assert np.abs(found - asked).sum(axis=1).min() < 24


@pytest.mark.parametrize(("height", "thin"), [(1.0, False), (0.1, True)])
def test_outlines_of_flat_blocks_are_thin(height: float, thin: bool):
    builder = rock()
    for k in range(5):
        builder.block(vertices=np.add(SQUARE, (0.0, k)) * (6.0, height))
    outlines = figure_of(builder.build(), []).axes[0].patches
    assert all((one.get_linewidth() < 0.5) == thin for one in outlines)


def test_a_crowd_of_arrows_about_one_place_is_not_drawn():
    builder = rock()
    builder.block(name="large", vertices=100.0 * SQUARE)
    for k in range(CROWD + 1):
        builder.point_load((50.0 + 0.1 * k, 50.0), (1.0, 0.0), block="large")
    assert not figure_of(builder.build(), []).axes[0].texts


@pytest.mark.parametrize("parts", [1, 2, 4])
def test_a_floor_in_parts_is_drawn_whole(parts: int):
    builder = rock()
    builder.block(vertices=SQUARE)
    for k in range(parts):
        part = np.add(SQUARE, (k, -1.0)) * (8.0 / parts, 1.0)
        builder.block(vertices=part, fixed=True)
    assert len(figure_of(builder.build(), []).axes[0].patches) == parts + 1


@pytest.mark.parametrize(("away", "seen"), [(0.0, 2), (1.2, 2), (5.0, 1)])
def test_fixed_blocks_far_away_are_left_out(away: float, seen: int):
    builder = rock()
    builder.block(vertices=SQUARE)
    builder.block(vertices=np.add(SQUARE, (1.0 + away, 0.0)), fixed=True)
    axes = figure_of(builder.build(), []).axes[0]
    assert len(axes.patches) == seen


def supported(wet: str):
    """Return a block on a fixed one, with a bolt to a wall 5 m away and a link, under 3 m of water.

    ``wet``: where the water presses, on "faces" or in "joints".
    """
    builder = rock()
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="block", vertices=SQUARE)
    builder.block(name="base", vertices=np.add(SQUARE, (0.0, -1.0)), fixed=True)
    builder.block(name="wall", vertices=np.add(SQUARE, (6.0, 0.0)), fixed=True)
    builder.add_bolt_kind("bar", stiffness=1e6)
    builder.bolt((0.5, 0.5), (6.5, 0.5), kind="bar", name="bolt")
    builder.link((0.2, 1.0), blocks=("block", "base"), x="rigid", contacts=False)
    builder.water(3.0, acts_on=wet)
    return builder.build()


def lines_of(axes: Any, colour: str) -> list[np.ndarray]:
    return [line.get_xydata() for line in axes.lines if line.get_color() == colour]


def test_bolts_links_and_water_are_in_the_set_up():
    axes = figure_of(supported("faces"), []).axes[0]
    assert len(axes.patches) == 3  # the wall is far away, and holds a bolt
    bolt, head, bar = lines_of(axes, SUPPORT)
    assert bolt.tolist() == [[0.5, 0.5], [6.5, 0.5]] and head.tolist() == [[0.5, 0.5]]
    # a link that holds x alone is a bar along x through its place
    assert bar.mean(axis=0) == pytest.approx((0.2, 1.0)) and np.ptp(bar[:, 1]) < 1e-12
    assert np.ptp(bar[:, 0]) > 0.1
    level = lines_of(axes, BLUE)[0]
    assert level.tolist() == [[0.0, 3.0], [7.0, 3.0]]
    # in joints alone it is shown where it is, not as a level in front of the blocks
    (joint,) = lines_of(figure_of(supported("joints"), []).axes[0], BLUE)
    assert np.sort(joint, axis=0).tolist() == [[0.0, 0.0], [1.0, 0.0]]
