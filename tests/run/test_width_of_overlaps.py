"""The bound on the depth of overlaps, against circles inscribed by GEOS."""

import numpy as np
import pytest
import shapely

from clast.run.overlap import width_max


@pytest.mark.parametrize("seed", range(20))
def test_no_circle_in_an_overlap_is_wider_than_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shapes = [
        shapely.convex_hull(shapely.multipoints(rng.uniform(0.0, 2.0, (9, 2)) + shift))
        for shift in (np.zeros(2), rng.uniform(-1.5, 1.5, 2))
    ]
    one, other = (np.array(shapely.normalize(one).exterior.coords)[:-1][::-1] for one in shapes)
    shared = shapely.intersection(*shapes)
    circle = shapely.maximum_inscribed_circle(shared) if shared.area else shapely.LineString()
    assert width_max(one, other) >= 2.0 * shapely.length(circle) - 1e-9 or not shared.area
    assert width_max(one, other) <= 2.0 * np.sqrt(2.0) + 1e-9


def test_a_block_on_a_slope_is_as_deep_as_its_corners() -> None:
    slope = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]])
    block = np.array([[3.0, 0.99], [4.0, 0.995], [4.0, 2.0], [3.0, 2.0]])
    assert width_max(slope, block) == pytest.approx(0.01)
    assert width_max(slope, block + np.array([0.0, 1.0])) < 0.0
    notched = np.array([[0, 0], [4, 0], [4, 3], [2, 1], [0, 3]], float)
    assert width_max(notched, notched) == np.inf
