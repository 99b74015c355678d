"""Scenes from beginning to end: they begin without overlap, and as they are meant to."""

from __future__ import annotations

import numpy as np
import pytest

from clast.studies.bench import WHOLE_SCENES, BenchSettings, deepest_overlap
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


def test_whole_scenes_are_asked_for_by_one_name_or_their_own():
    asked = BenchSettings(scenes=("whole",))
    assert [scene.name for scene in asked.wholes] == list(WHOLE_SCENES)
    assert asked.whole_sizes == (100,) and not asked.models
    assert BenchSettings(scenes=("slide", "whole")).wholes[0].name == "slide"
