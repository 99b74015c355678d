"""A block that is found deep inside another comes out of it slowly, and its energy is explained."""

from dataclasses import replace

import numpy as np
import pytest

from scenes.systems import GRAVITY, at_start, box, by_convex, march, system, turned

DEEP, P = 4e-3, 1e9
WEIGHT = 2500.0 * GRAVITY
"""Of a block of 1 m2, N/m."""


def depths(angle=0.0, step=1e-3, steps=800):
    """Return how deep a block lies in the ground after each step, m, and the last result."""
    gravity = GRAVITY * np.array([np.sin(angle), -np.cos(angle)])
    ground, block = (turned(one, angle) for one in (box(-1, -1, 3, 1), box(0, -DEEP)))
    model = system([ground, block], fixed=[0], gravity=gravity)
    # later than the start, where an overlap is taken as it is; nothing is remembered of it
    begun = replace(at_start(model), time=1.0)
    results = march(model, by_convex(P), step, 1.0 + steps * step, begun)
    out = np.array([-np.sin(angle), np.cos(angle)])
    low = [float((one.state.vertices[4:] @ out).min()) for one in results]
    return -np.array(low), results[-1]


def test_a_block_found_deep_inside_comes_out_without_a_throw():
    deep, last = depths()
    # two corners carry the weight, on springs of p each
    assert deep[-1] == pytest.approx(WEIGHT / (2.0 * P), rel=0.05)
    assert deep[10] > 0.5 * DEEP
    assert (-np.diff(deep)).max() < 2.0 * by_convex(P).critdis / 200
    # and it has come to its end: rest behind the edge is none
    assert not last.state.memory.multiplier.any()
    ledger = last.state.ledger
    assert abs(ledger.unaccounted) < 1e-9 * WEIGHT * DEEP
    # lifted by so much: the time integration has brought that in
    assert -ledger.numerical > 0.9 * WEIGHT * (DEEP - deep[-1])


@pytest.mark.parametrize("angle", [0.7, np.pi])
def test_it_comes_out_as_far_whatever_way_is_up(angle):
    deep = depths(angle)[0]
    assert np.abs(deep - depths()[0]).max() < 1e-6
