"""The bound by which overlaps are passed over that contacts explain is one."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from clast.run.overlap import widest_circle


def convex(generator, corners, centre):
    angle = np.sort(generator.uniform(0.0, 2.0 * np.pi, corners))
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) + centre


@pytest.mark.parametrize("seed", range(40))
def test_no_circle_in_what_two_outlines_share_is_wider(seed):
    generator = np.random.default_rng(seed)
    one = convex(generator, int(generator.integers(3, 9)), 1e3)
    other = convex(generator, int(generator.integers(3, 9)), 1e3 + generator.uniform(-1.5, 1.5, 2))
    shared = shapely.intersection(shapely.Polygon(one), shapely.Polygon(other))
    bound = widest_circle(one, other)
    if shared.area < 1e-9:
        assert bound < 1e-4
        return
    widest = 2.0 * shapely.length(shapely.maximum_inscribed_circle(shared))
    assert widest <= bound * (1.0 + 1e-6)
    assert bound == pytest.approx(4.0 * shared.area / shared.length, rel=1e-6)


def test_outlines_that_are_not_convex_are_not_bounded():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    notched = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.5), (0.0, 1.0)])
    assert widest_circle(square, notched) == np.inf
    assert widest_circle(square, square + np.array([0.0, 0.9])) == pytest.approx(0.4 / 2.2)
    assert widest_circle(square, square + 2.0) == 0.0
