"""Regions of blocks: found, searched along a line and finished each by itself."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clast.minimise import connected as kernel
from clast.minimise import unfinished
from clast.minimise.subproblem import part_of
from scenes.potentials import caught
from scenes.systems import by_convex, heap, march, wall


def random_pairs(rng, count):
    """Return random pairs (lower, higher) of blocks, sorted, each once."""
    both = np.sort(rng.integers(0, count, (count, 2)), axis=1)
    return np.unique(both[both[:, 0] < both[:, 1]], axis=0)


@pytest.mark.parametrize("seed", range(20))
def test_regions_are_the_connected_components_without_fixed_blocks(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 60))
    pairs, fixed = random_pairs(rng, count), rng.random(count) < 0.2
    region, found = kernel.regions(pairs, fixed)
    free = ~fixed[pairs].any(axis=1)
    links = coo_array((np.ones(free.sum()), tuple(pairs[free].T)), shape=(count, count))
    _, wanted = connected_components(links, directed=False)
    assert found == len(np.unique(wanted[~fixed])) + 1
    assert np.all(region[fixed] == found - 1)
    same = region[~fixed][:, None] == region[~fixed]
    assert np.array_equal(same, wanted[~fixed][:, None] == wanted[~fixed])


def potentials(monkeypatch):
    """Return potentials of a heap, with many regions, and of a wall, with one."""
    falling = caught(monkeypatch, heap(40, 10), 5e8, 5e-3, 0.3)[10::7]
    return [*falling, *caught(monkeypatch, wall(4, 4), 5e10, 1e-3, 5e-3)[::3]]


def test_each_region_is_searched_for_its_own_minimum_along_a_line(monkeypatch):
    rng = np.random.default_rng(1)
    most = 0
    for one in potentials(monkeypatch):
        zero = np.zeros((len(one.fixed), 6))
        point = one.at(zero)
        way = np.einsum("nij,nj->ni", one.inverse, point.residual)
        way *= rng.uniform(0.5, 2.0, (len(way), 1))
        line, _ = one.line_search(point, way)
        lengths = line.lengths
        most = max(most, len(np.unique(lengths)))
        for region in np.unique(one.regions.of_blocks[~one.fixed]):
            mine = (one.regions.of_blocks == region)[:, None]

            def slope(length, mine=mine, point=point, way=way, one=one):
                return -np.sum(one.at(length * way * mine).residual * way * mine)

            if slope(0.0) >= -1e-12 * np.abs(point.residual).max():
                continue
            wanted = brentq(slope, 0.0, 100.0, xtol=1e-15, rtol=1e-14)
            assert lengths[region] == pytest.approx(wanted, rel=1e-6)
    assert most > 5


def test_what_a_line_leads_to_is_what_the_law_answers_there(monkeypatch):
    rng = np.random.default_rng(3)
    for one in potentials(monkeypatch):
        free = ~one.fixed[:, None]
        point = one.at(1e-4 * rng.normal(size=(len(one.fixed), 6)) * free)
        way = np.einsum("nij,nj->ni", one.inverse, point.residual)
        line, _ = one.line_search(point, way)
        found = one.moved(point, line)
        wanted = one.at(point.unknowns + line.lengths[one.regions.of_blocks][:, None] * way)
        assert found.unknowns == pytest.approx(wanted.unknowns, rel=1e-12, abs=1e-18)
        scale = np.abs(wanted.gap).max()
        assert found.gap == pytest.approx(wanted.gap, abs=1e-12 * scale)
        assert found.slip == pytest.approx(wanted.slip, abs=1e-12 * scale)
        here, there = found.response, wanted.response
        force = np.abs(there.normal_force).max()
        assert here.normal_force == pytest.approx(there.normal_force, abs=1e-9 * force)
        assert here.shear_force == pytest.approx(there.shear_force, abs=1e-9 * force)
        # at a kink the two may fall on either side of it
        assert np.mean(here.normal_stiffness != there.normal_stiffness) < 0.02
        assert np.mean(here.shear_stiffness != there.shear_stiffness) < 0.02
        assert found.residual == pytest.approx(wanted.residual, abs=1e-9 * force)


def test_a_part_is_what_the_whole_is_there(monkeypatch):
    rng = np.random.default_rng(2)
    for one in potentials(monkeypatch):
        unknowns = 1e-4 * rng.normal(size=(len(one.fixed), 6)) * ~one.fixed[:, None]
        whole = one.at(unknowns)
        wanted = rng.random(one.regions.count) < 0.5
        wanted[-1] = False  # fixed blocks do not move
        part = part_of(one, wanted[one.regions.of_blocks] & ~one.fixed)
        inside = ~part.potential.fixed
        assert np.array_equal(
            np.sort(part.blocks[inside]), np.flatnonzero(wanted[one.regions.of_blocks])
        )
        point = part.potential.at(unknowns[part.blocks])
        assert np.array_equal(point.residual[inside], whole.residual[part.blocks][inside])
        distances = one.distances(whole)
        assert part.potential.distance(point) == pytest.approx(distances[wanted].sum(), rel=1e-12)
        assert one.distance(whole) == pytest.approx(distances.sum(), rel=1e-12)


@pytest.mark.parametrize("share", [0.1, 10.0])
def test_going_on_with_unfinished_regions_alone_gives_the_same_steps(monkeypatch, share):
    how = replace(by_convex(share * 5e9), max_displacement=0.05)

    def run(small):
        monkeypatch.setattr(unfinished, "SMALL", small)
        return march(heap(30, 10), how, 5e-3, 0.5)

    apart, together = run(0), run(10**9)
    assert len(apart) == len(together)
    here, there = apart[-1].state.vertices, together[-1].state.vertices
    assert np.abs(here - apart[0].state.vertices).max() > 0.5
    assert np.abs(here - there).max() < 1e-6


@pytest.mark.parametrize("seed", range(10))
def test_what_is_left_alone_is_as_many_regions_as_may_be(seed):
    """One after the other from the nearest to its minimum, as long as all together are enough."""
    rng = np.random.default_rng(seed)
    distances = rng.choice([0.0, 1e-9, 1e-3], 30) * rng.random(30)
    for enough in (1e-12, 1e-8, 1e-2, 1.0):
        left, allowed = 0.0, unfinished.FINISHED * enough
        finished = np.zeros(30, bool)
        for region in np.argsort(distances, kind="stable"):
            left += distances[region]
            finished[region] = left <= allowed
        assert np.array_equal(unfinished.unfinished(distances, enough), ~finished)
    distances[3] = np.nan
    assert unfinished.unfinished(distances, 1e9)[3]
