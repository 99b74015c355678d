"""Figures of verification problems: nothing is covered, cut or lost in a crowd."""

from __future__ import annotations

import dataclasses
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from clast.pictures.verification import ARROWS, Chart, curve, exact_curve, figure_of

X = np.linspace(0.0, 0.02, 60)


def chart(curves: int, label: str = "modified, lagged friction") -> Chart:
    waves = [curve(f"{label} {k}", X, np.sin(900.0 * X)) for k in range(curves - 1)]
    every = (exact_curve("formula", X, np.sin(900.0 * X)), *waves)
    return Chart(title=f"{curves} curves", x_label="slip, m", y_label="way, m", curves=every)


def blocks(count: int):
    """Return a row of blocks that move, on nothing."""
    builder = InputBuilder(title="A row")
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    for k in range(count):
        builder.block(vertices=np.add(square, (1.5 * k, 0.0)), velocity=(1.0, 0.3, 0.0))
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
    builder = InputBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(-0.5, 0.0), (0.5, 0.0), (0.5, high), (-0.5, high)])
    return builder.build()


@pytest.mark.parametrize("set_up", [blocks(2), *map(column, (0.2, 0.6, 1.0, 2.0, 5.0, 12.0))])
def test_numbers_of_an_axis_do_not_meet(set_up: Any):
    figure = figure_of(set_up, [chart(3)])
    figure.canvas.draw()
    for axis in (figure.axes[1].xaxis, figure.axes[0].xaxis):
        labels = [one.get_window_extent() for one in axis.get_ticklabels() if one.get_text()]
        assert all(a.x1 < b.x0 for a, b in pairwise(labels))


def test_of_many_arrows_and_marks_some_are_drawn():
    few, many = (figure_of(blocks(count), []).axes[0] for count in (3, 150))
    assert len(few.texts) == 3 and 0.5 * ARROWS < len(many.texts) <= ARROWS
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
