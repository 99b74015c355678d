"""Areas, centroids, moments, boxes and edges of polygons, near and far from the origin."""

import numpy as np
import pytest
import shapely

from clast.block import polygon
from scenes.quadrature import integral
from scenes.systems import box, convex, flat, regular, star, turned

SEEDS = range(20)


def some_outlines(seed):
    """Return a few polygons of all kinds about different places."""
    rng = np.random.default_rng(seed)
    made = [convex(rng, 3), convex(rng, 7), star(rng, 5), star(rng, 11), regular(6), box(0, 0, 3.0)]
    return [one * 10.0 ** rng.uniform(-2.0, 2.0) + rng.uniform(-5.0, 5.0, 2) for one in made]


@pytest.mark.parametrize("seed", SEEDS)
def test_area_and_centroid(seed):
    outlines = some_outlines(seed)
    flats = flat(outlines)
    area, centroid, _ = polygon.moments(flats.vertices, flats.start)
    for k, one in enumerate(outlines):
        solid = shapely.Polygon(one)
        assert area[k] == pytest.approx(solid.area, rel=1e-12)
        assert centroid[k] == pytest.approx([solid.centroid.x, solid.centroid.y], rel=1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_second_moments_about_the_centroid(seed):
    outlines = some_outlines(seed)
    flats = flat(outlines)
    area, centroid, second = polygon.moments(flats.vertices, flats.start)
    for k, one in enumerate(outlines):

        def products(at, middle=centroid[k]):
            x, y = (at - middle).T
            return np.stack([x * x, y * y, x * y, x, y], axis=1)

        found = integral(one, products)
        size = np.sqrt(area[k])
        assert second[k] == pytest.approx(found[:3], rel=1e-10, abs=1e-11 * size**4)
        assert found[3:] == pytest.approx([0.0, 0.0], abs=1e-11 * size**3)


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_is_lost_far_from_the_origin(seed):
    """At 1e6 m coordinates are exact to 1e-10 m; the moments to as many digits of the size."""
    near = [np.round(one, 6) for one in some_outlines(seed)[:4]]
    shift = np.array([1e6, -2e6])
    far = [one + shift for one in near]
    area, centroid, second = polygon.moments(flat(near).vertices, flat(near).start)
    area_far, centroid_far, second_far = polygon.moments(flat(far).vertices, flat(far).start)
    size = np.sqrt(area)
    assert np.all(np.abs(area_far - area) < 4e-9 * size)
    assert np.all(np.abs(centroid_far - shift - centroid) < 3e-9)
    assert np.all(np.abs(second_far - second) < 4e-9 * size[:, None] ** 3)


def test_moments_turn_with_the_polygon():
    outline = star(np.random.default_rng(3), 7)
    flats = flat([outline, turned(outline, 0.7), turned(outline, np.pi / 2)])
    _, _, second = polygon.moments(flats.vertices, flats.start)
    xx, yy, xy = second[0]
    c, s = np.cos(0.7), np.sin(0.7)
    assert second[1] == pytest.approx(
        [
            c * c * xx + s * s * yy - 2 * c * s * xy,
            s * s * xx + c * c * yy + 2 * c * s * xy,
            c * s * (xx - yy) + (c * c - s * s) * xy,
        ]
    )
    assert second[2] == pytest.approx([yy, xx, -xy])


def test_boxes_and_edges():
    outlines = some_outlines(1)
    flats = flat(outlines)
    boxes = polygon.boxes(flats.vertices, flats.start)
    direction, length = polygon.edges(flats.vertices, flats.start)
    for k, one in enumerate(outlines):
        rows = slice(flats.start[k], flats.start[k + 1])
        assert boxes[k].tolist() == [*one.min(axis=0), *one.max(axis=0)]
        side = np.roll(one, -1, axis=0) - one
        assert direction[rows] * length[rows, None] == pytest.approx(side, rel=1e-12)
        assert np.hypot(*direction[rows].T) == pytest.approx(1.0, abs=1e-15)


def test_travel():
    before = np.zeros((4, 2))
    after = np.array([[0.0, 1.0], [3.0, -4.0], [0.1, 0.1], [0.0, 0.0]])
    assert polygon.travel(before, after) == 5.0
    assert polygon.travel(before, before) == 0.0
    for bad in (np.nan, np.inf, -np.inf):
        broken = after.copy()
        broken[2, 1] = bad
        assert np.isnan(polygon.travel(before, broken))
