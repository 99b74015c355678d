"""Islands of blocks: found, searched along a line, and minimised each by itself."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from benchmarks.scenes import SCENES
from clast.linear.solvers import Automatic
from clast.minimise import strategy
from clast.minimise.islands import connected, listed
from clast.minimise.strategy import MinimisationStrategy, SmallIslands
from scenes.potentials import at_rest, by_newton, caught, some_of, strengthened, tolerance_of, work
from scenes.systems import at_start, box, bricks, by_convex, heap, open_ledger, system, wall


def random_pairs(rng, count):
    """Return random pairs (lower, higher) of blocks, sorted, each once."""
    both = np.sort(rng.integers(0, count, (count, 2)), axis=1)
    return np.unique(both[both[:, 0] < both[:, 1]], axis=0)


@pytest.mark.parametrize("seed", range(20))
def test_islands_are_the_connected_components_without_fixed_blocks(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 60))
    pairs, fixed = random_pairs(rng, count), rng.random(count) < 0.2
    island, found = connected(pairs, fixed)
    free = ~fixed[pairs].any(axis=1)
    links = coo_array((np.ones(free.sum()), tuple(pairs[free].T)), shape=(count, count))
    _, wanted = connected_components(links, directed=False)
    assert found == len(np.unique(wanted[~fixed])) + 1
    assert np.all(island[fixed] == found - 1)
    same = island[~fixed][:, None] == island[~fixed]
    assert np.array_equal(same, wanted[~fixed][:, None] == wanted[~fixed])


def test_what_is_listed_of_islands_are_their_blocks():
    rng = np.random.default_rng(0)
    island = rng.integers(0, 12, 200)
    begin, blocks, place = listed(island, 12)
    for r in range(12):
        own = blocks[begin[r] : begin[r + 1]]
        assert np.array_equal(own, np.flatnonzero(island == r))
        assert np.array_equal(place[own], np.arange(len(own)))


def of_walls_and_heaps():
    """Return potentials of a heap, with many islands, and of a wall, with one."""
    falling = some_of(caught(heap(40, 10), 5e8, 5e-3, 0.3))[2:]
    return [*falling, *some_of(caught(wall(4, 4), 5e10, 1e-3, 5e-3))]


@pytest.mark.parametrize("seed", [None, 0, 1])
def test_each_island_is_searched_for_its_own_minimum_along_a_line(seed):
    """With springs of all kinds, too (``seed``)."""
    rng = np.random.default_rng(1)
    most = 0
    for usual in of_walls_and_heaps()[::2]:
        one = usual if seed is None else strengthened(usual, seed)
        point = at_rest(one)
        way = np.einsum("nij,nj->ni", one.inverse, point.residual)
        way *= rng.uniform(0.5, 2.0, (len(way), 1))
        line, _ = one.line_search(point, way)
        lengths = line.lengths
        most = max(most, len(np.unique(lengths)))
        for island in np.unique(one.islands.of_blocks[~one.fixed]):
            mine = (one.islands.of_blocks == island)[:, None]

            def slope(length, mine=mine, point=point, way=way, one=one):
                return -np.sum(one.at(length * way * mine).residual * way * mine)

            if slope(0.0) >= -1e-12 * np.abs(point.residual).max():
                continue
            wanted = brentq(slope, 0.0, 100.0, xtol=1e-15, rtol=1e-14)
            assert lengths[island] == pytest.approx(wanted, rel=1e-6)
    assert most > 5


def test_what_a_line_leads_to_is_what_the_springs_bear_there():
    rng = np.random.default_rng(3)
    for one in of_walls_and_heaps():
        free = ~one.fixed[:, None]
        point = one.at(1e-4 * rng.normal(size=(len(one.fixed), 6)) * free)
        way = np.einsum("nij,nj->ni", one.inverse, point.residual)
        line, _ = one.line_search(point, way)
        found = one.moved(point, line)
        wanted = one.at(point.unknowns + line.lengths[one.islands.of_blocks][:, None] * way)
        assert found.unknowns == pytest.approx(wanted.unknowns, rel=1e-12, abs=1e-18)
        check_same(found, wanted, 1e-9)
        # at a kink the two may fall on either side of it
        here, there = found.forces, wanted.forces
        assert np.mean(here.normal_stiffness != there.normal_stiffness) < 0.02
        assert np.mean(here.shear_stiffness != there.shear_stiffness) < 0.02


def check_same(found, wanted, share):
    """Assert that what two points say of the same unknowns is the same but for rounding."""
    size = np.abs(wanted.gap).max()
    assert found.gap == pytest.approx(wanted.gap, abs=1e-9 * size)
    assert found.slip == pytest.approx(wanted.slip, abs=1e-9 * size)
    force = np.abs(wanted.forces.normal_force).max() + np.abs(wanted.residual).max()
    force += np.abs(wanted.forces.shear_force).max()
    assert found.forces.normal_force == pytest.approx(wanted.forces.normal_force, abs=share * force)
    assert found.forces.shear_force == pytest.approx(wanted.forces.shear_force, abs=share * force)
    assert found.residual == pytest.approx(wanted.residual, abs=share * force)


# --- each by itself ------------------------------------------------------------------------


@pytest.fixture(params=["heap", "wall", "slope", "stack"])
def potentials(request):
    """Return potentials of many small islands, or of one."""
    if request.param == "heap":
        return some_of(caught(heap(60, 15), 5e9, 2.5e-3, 0.3))
    if request.param == "wall":
        return some_of(caught(wall(5, 5), 5e9, 1e-3, 6e-3))
    return some_of(caught(SCENES[request.param].build(110), 5e9, 2e-3, 1e-2))


def check_minimum(one, found, tolerance):
    """Assert that a point is the minimum, and that all that it says of itself is so."""
    wanted = by_newton(one, 1e-4 * tolerance)
    apart = found.unknowns - wanted.unknowns
    energy = np.einsum("ni,nij,nj->", apart, one.base.diagonal, apart)
    assert energy <= 4.0 * tolerance  # d.K d, with K below the curvature
    check_same(found, one.at(found.unknowns), 1e-7)


@pytest.mark.parametrize("few", [0, 3, 200])
def test_all_small_islands_come_to_their_minimum(potentials, few, monkeypatch):
    """By either factor, whatever their size."""
    monkeypatch.setattr(strategy, "FEW_BLOCKS", few)
    small = SmallIslands()
    for one in potentials:
        tolerance, how = tolerance_of(one), work()
        found, left = small.minimise(one, at_rest(one), tolerance, how)
        assert small.small(one)[:-1].all()
        assert not small.small(one)[-1]
        assert left.sum() <= tolerance
        assert 0 < how.counts["passes"] <= small.iterations
        assert how.counts["line_search"] >= how.counts["passes"]
        check_minimum(one, found, tolerance)


@pytest.mark.parametrize("seed", range(4))
def test_so_they_do_with_springs_of_all_kinds(seed):
    for usual in some_of(caught(heap(30, 10), 5e8, 5e-3, 0.3))[::2]:
        one = strengthened(usual, seed)
        tolerance = tolerance_of(one)
        found, left = SmallIslands().minimise(one, at_rest(one), tolerance, work())
        assert left.sum() <= tolerance
        check_minimum(one, found, tolerance)


def test_islands_are_small_by_their_blocks_or_where_they_are_like_trees():
    """A tower of 256 bricks is, a wall of as many is not."""
    tower = [box(0.0, 0.5 * k, 1.0, 0.5) for k in range(256)]
    for outlines, small in ((tower, True), (bricks(16, 16), False)):
        assert len(outlines) > SmallIslands().few
        model = system([box(-1.0, -1.0, 30.0, 1.0), *outlines], fixed=[0])
        one = caught(model, 5e9, 5e-3, 5e-3)[0]
        assert np.array_equal(SmallIslands().small(one), [small, False])


def test_large_islands_stay_where_they_are_and_go_on_by_themselves():
    """A wall beside a tower: the tower is minimised, then the wall is with all its contacts."""
    tower = [box(40.0, 0.5 * k, 1.0, 0.5) for k in range(6)]
    base = box(-5.0, -1.0, 60.0, 1.0)
    model = system([base, *bricks(16, 16), *tower], fixed=[0], friction_angle=30.0)
    one = caught(model, 5e9, 2e-3, 4e-3)[0]
    sizes = np.bincount(one.islands.of_blocks)
    tolerance, before = tolerance_of(one), at_rest(one)
    found, left = SmallIslands().minimise(one, before, tolerance, work())
    large = sizes[one.islands.of_blocks] > 6
    assert np.array_equal(found.unknowns[large], before.unknowns[large])
    assert not np.array_equal(found.unknowns[~large], before.unknowns[~large])
    assert left.sum() > tolerance
    for most in (0.0, 1.0):  # all together, and without the tower
        found = MinimisationStrategy(most=most).minimise(one, before, tolerance, work(Automatic()))
        check_minimum(one, found, tolerance)


@pytest.mark.parametrize("most", [0.0, 1.0])
@pytest.mark.parametrize("model", [heap(60, 15), wall(5, 5)], ids=["heap", "wall"])
def test_what_is_not_finished_goes_on_together(model, most):
    """Where islands may take one iteration only, and with or without those that are finished."""
    one_each = MinimisationStrategy(small=SmallIslands(iterations=1), most=most)
    unfinished = 0
    for one in some_of(caught(model, 5e9, 2.5e-3, 0.3 if len(model.mass) > 50 else 0.02)):
        tolerance, before = tolerance_of(one), at_rest(one)
        _, left = one_each.small.minimise(one, before, tolerance, work())
        unfinished += left.sum() > tolerance
        found = one_each.minimise(one, before, tolerance, work(Automatic()))
        check_minimum(one, found, tolerance)
    assert unfinished > 0


def test_who_asks_for_a_solver_has_everything_solved_by_it():
    one = caught(heap(30, 10), 5e8, 5e-3, 0.3)[-1]
    tolerance = tolerance_of(one)
    for few in (0, 200):
        how = work()
        found = MinimisationStrategy(small=SmallIslands(few=few)).minimise(
            one, at_rest(one), tolerance, how
        )
        check_minimum(one, found, tolerance)
        assert (how.factor.factorised > 0) == (few == 0)


def test_numbers_that_are_none_are_left_as_they_are():
    one = caught(heap(30, 10), 5e8, 5e-3, 0.3)[-1]
    before = at_rest(one)
    odd = replace(before, residual=np.where(one.fixed[:, None], 0.0, np.full((10, 6), np.nan)))
    odd = replace(odd, distances=np.where(one.fixed, 0.0, np.nan))
    found, left = SmallIslands().minimise(one, odd, 1e-9, work())
    assert np.array_equal(found.unknowns, before.unknowns)
    assert not left.sum() <= 1e-9


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one processor")
def test_same_bits_by_any_number_of_threads():
    model, method = heap(240, 40), by_convex(5e9, max_displacement=0.1)
    falling, found = open_ledger(model, method, at_start(model)), []
    while falling.time < 0.3:
        falling = method.process.step(model, method, falling, 2.5e-3).state
    threads = numba.get_num_threads()
    for number in (1, 2):
        numba.set_num_threads(number)
        try:
            one = falling
            for _ in range(4):
                one = method.process.step(model, method, one, 2.5e-3).state
            found.append(one)
        finally:
            numba.set_num_threads(threads)
    for name, value in vars(found[0]).items():
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(found[1], name)), name
