"""Lengths along a line, against numpy: in parts, by threads, for islands of any order."""

import numpy as np
import pytest

from clast.compute.parallel import CONTACTS
from clast.minimise import line_search

COUNTS = [1, 5, CONTACTS.part + 3, CONTACTS.many + CONTACTS.part + 7]


def bear(stretch, springs):
    """Return the forces of springs and their stiffnesses."""
    at_zero, k, low, high = springs
    straight = at_zero - k * stretch
    force = np.clip(straight, low, high)
    return force, np.where((force == straight) & (low < high), k, 0.0)


@pytest.mark.parametrize("islands", [1, 3, 400])
@pytest.mark.parametrize("count", COUNTS)
def test_every_island_goes_to_the_least_potential_of_its_own(count, islands):
    rng = np.random.default_rng(3)
    gap, slip, d_gap, d_slip = rng.normal(size=(4, count)) * 1e-5
    stiffness = rng.uniform(5e8, 2e9, (2, count))
    bound = rng.choice([0.0, 1.0], count) * rng.uniform(1e2, 1e5, count)
    tension = rng.choice([0.0, 1e3], count)
    normal = rng.choice([0.0, 1e4], count), stiffness[0], -tension, np.full(count, np.inf)
    springs = normal, (rng.normal(size=count) * 1e4, stiffness[1], -bound, bound)
    island = np.sort(rng.integers(0, islands, count))
    island[: count // 7] = 0  # not all links of an island follow each other
    curvature = np.full(islands, 1e-2)
    works = bear(gap, springs[0])[0] * d_gap + bear(slip, springs[1])[0] * d_slip
    work = np.bincount(island, works, islands)
    start = -rng.uniform(1e-3, 1e-1, islands)
    line = gap, d_gap, slip, d_slip
    lengths, evaluations = line_search.lengths_along(
        island, line, (*springs[0], *springs[1]), start + work, curvature, start
    )
    assert 0 < evaluations < line_search.EVALUATIONS_MAX
    at = lengths[island]
    found = line_search.links_along(island, lengths, line, (*springs[0], *springs[1]))
    n, kn = bear(gap + at * d_gap, springs[0])
    t, ks = bear(slip + at * d_slip, springs[1])
    wanted = gap + at * d_gap, slip + at * d_slip, n, t, kn, ks
    for one, other in zip(found, wanted, strict=True):
        assert np.array_equal(one, other)
    slope = start + work + lengths * curvature
    slope -= np.bincount(island, n * d_gap + t * d_slip, islands)
    allowed = (
        line_search.SLOPE_TOLERANCE * np.abs(start) + line_search.SLOPE_NOISE * np.abs(start).sum()
    )
    size = np.bincount(island, np.abs(n * d_gap) + np.abs(t * d_slip), islands)
    assert (np.abs(slope) <= allowed + 1e-13 * size).all()
