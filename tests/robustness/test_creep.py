"""Friction that holds a block does not let it creep."""

import numpy as np
import pytest

from scenes.systems import box, by_convex, march, system, turned


def creep(step: float, end: float) -> float:
    """Return how far a block held at 44.9 degrees by 45 degrees moves after its first second, m."""
    angle = np.radians(44.9)
    blocks = [turned(box(-5.0, -2.0, 10.0, 2.0), angle), turned(box(0.0, 0.0), angle)]
    model = system(blocks, fixed=[0], friction_angle=45.0, young=50e9)
    results = march(model, by_convex(5e9), step, end)
    first = next(one.state for one in results if one.state.time > 1.0 - 1e-9)
    return float(np.abs(results[-1].state.vertices - first.vertices).max())


def test_a_block_held_for_ten_seconds_does_not_creep() -> None:
    assert creep(0.02, 10.0) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.01, 0.02])
def test_a_block_held_for_a_hundred_seconds_does_not_creep(step: float) -> None:
    assert creep(step, 100.0) < 1e-6
