"""Contacts are looked for as far as blocks go in the step, and again where one goes farther."""

from dataclasses import replace

import numpy as np
import pytest

from clast.step import convex
from clast.step.search_distance import SPARE_CRITDIS, farther
from scenes.systems import at_start, box, by_convex, heap, march, method, system

MAX = 0.05


def everywhere(monkeypatch):
    """Look for contacts as far as max_displacement lets blocks go; return a list of counts."""
    monkeypatch.setattr(
        convex, "travel_expected", lambda context: np.full(context.model.block_count, MAX)
    )


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.1, 10.0])
def test_fewer_candidates_give_the_same_heap(monkeypatch, share):
    how = replace(by_convex(share * 5e9), max_displacement=MAX)
    near = march(heap(30, 10), how, 5e-3, 0.5)
    everywhere(monkeypatch)
    far = march(heap(30, 10), how, 5e-3, 0.5)
    assert sum(len(one.contacts) for one in near) < 0.9 * sum(len(one.contacts) for one in far)
    assert np.abs(near[-1].state.vertices - near[0].state.vertices).max() > 0.5
    assert near[-1].state.vertices == pytest.approx(far[-1].state.vertices, abs=1e-6)


def test_a_block_at_rest_that_is_hit_meets_the_next_within_the_same_step(monkeypatch):
    """A fast block hits one at rest, which closes a gap of 10 mm: nobody could expect that."""
    outlines = [box(0.0, 0.0), box(1.001, 0.0), box(2.011, 0.0)]
    model = system(outlines, gravity=(0.0, 0.0), velocity={0: (20.0, 0.0, 0.0)})
    how = replace(by_convex(5e9), max_displacement=MAX)
    found = how.process.step(model, how, at_start(model), 2e-3)
    everywhere(monkeypatch)
    wanted = how.process.step(model, how, at_start(model), 2e-3)
    assert wanted.state.velocity[2, 0] > 1.0, "the third block was hit"
    assert found.state.velocity == pytest.approx(wanted.state.velocity, rel=1e-6, abs=1e-6)


def test_only_blocks_that_went_too_far_are_expected_to_go_farther():
    how = method(critdis=0.01, max_displacement=0.1)
    expected = np.array([0.01, 0.02, 0.03])
    spared = expected + 0.9 * SPARE_CRITDIS * how.critdis
    assert farther(how, expected, spared) is None
    gone = np.array([0.01, 0.05, 0.03])
    assert farther(how, expected, gone) == pytest.approx([0.01, 0.075, 0.03])
    assert farther(how, expected, np.array([0.0, 0.0, 0.2])) is None, "such a step is cut"
    assert farther(how, expected, np.array([0.0, np.nan, 0.0])) is None
