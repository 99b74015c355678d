"""Openings that cross each other at random, on a coarse grid: what the areas then sum up to."""

from __future__ import annotations

import numpy as np
import pytest

from clast.rockmass import Box, Circle, Domain, JointSet, Opening, Polygon, cut


def openings(seed: int, count: int) -> list[Opening]:
    rng = np.random.default_rng(seed)
    found = []
    for number in range(count):
        center, corners = rng.uniform(0, 10, 2), int(rng.integers(3, 7))
        angle = (np.arange(corners) + rng.uniform(0, 0.9, corners)) * 2 * np.pi / corners
        radius = rng.uniform(0.3, 2, (corners, 1))
        shape = Polygon(points=center + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        if rng.random() < 0.5:
            chords = int(rng.integers(5, 20))
            shape = Circle(center=center, radius=rng.uniform(0.3, 2), chords=chords)
        excavated = bool(rng.random() < 0.5)
        found.append(Opening(name=f"{number}", shape=shape, excavated=excavated))
    return found


def domain(tolerance: float) -> Domain:
    square = [(0, 0), (10, 0), (10, 10), (0, 10)]
    return Domain(boundary=square, tolerance=tolerance, smallest_edge=0.0, smallest_block=0.0)


def sets(seed: int) -> list[JointSet]:
    rng = np.random.default_rng(1000 + seed)
    spacings = {"a": 0.7, "b": 0.9}
    return [
        JointSet(name=name, angle=rng.uniform(0, 180), spacing=spacing)
        for name, spacing in spacings.items()
    ]


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-5, 1e-3, 1e-2])
@pytest.mark.one_in(3)
def test_areas_of_thirty_openings(tolerance):
    """Blocks have all of the rock: to round-off, but where the rock is thinner than the grid.

    On a grid of 1e-3 of the domain some acute corners between voids are thinner than four cells;
    the blocks there are merged, which costs no more than the tip: some cells times its length.
    """
    errors = []
    for seed in range(12):
        report = cut(domain(tolerance), sets(seed), openings=openings(seed, 30)).report
        errors.append(abs(report.area - report.domain_area))
        assert (abs(report.area_error) > 1e-9) == any(
            "differ from that" in one for one in report.notes
        )
    exact = np.sum(np.array(errors) < 1e-9 * 40.0)
    # Tips of a cell's width are a hundred times as frequent on a grid a hundred times as coarse.
    assert exact >= {1e-5: 12, 1e-3: 10, 1e-2: 7}[tolerance]
    assert max(errors) < 4.0 * tolerance * 0.5


def test_outlines_that_meet_in_one_cell_stay_on_the_rim():
    """Two outlines cross next to the wall of a void: their crossing is put onto the wall."""
    void = Opening(name="void", shape=Box(corner=(4, 2), size=(4, 6)), excavated=True)
    tips = [(3.999_6, 5.0), (1.0, 7.0), (1.0, 6.0)], [(3.999_7, 5.000_3), (1.5, 2.0), (1.0, 4.0)]
    others = [
        Opening(name=f"{number}", shape=Polygon(points=tip)) for number, tip in enumerate(tips)
    ]
    found = cut(domain(1e-3), sets(0), openings=[void, *others]).report
    assert abs(found.area - (100.0 - 24.0)) < 1e-9
