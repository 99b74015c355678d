"""Small regions come to the minimum that all together come to, each by itself."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from clast.compute.stopwatch import Stages
from clast.linear import elimination
from clast.linear.reuse import FactorOfStep
from clast.linear.solvers import Automatic, Direct
from clast.minimise import island_kernels as kernel
from clast.minimise import islands as small_regions
from clast.minimise import newton
from clast.minimise.islands import with_small_regions
from clast.studies.bench.scenes import SCENES
from scenes.potentials import TOLERANCE, by_newton, caught, strengthened
from scenes.systems import at_start, box, bricks, by_convex, heap, open_ledger, system, wall


def potentials_of(monkeypatch, model, step, end, stiffness=5e9):
    """Return some of the potentials that a run minimises."""
    kept = caught(monkeypatch, model, stiffness, step, end)
    return kept[:: max(1, len(kept) // 8)]


@pytest.fixture(params=["heap", "wall", "slope", "stack"])
def potentials(request, monkeypatch):
    """Return potentials of many small regions, or of one."""
    if request.param == "heap":
        return potentials_of(monkeypatch, heap(60, 15), 2.5e-3, 0.3)
    if request.param == "wall":
        return potentials_of(monkeypatch, wall(5, 5), 1e-3, 6e-3)
    return potentials_of(monkeypatch, SCENES[request.param].build(110), 2e-3, 1e-2)


def start(potential):
    """Return the point without displacements."""
    return potential.at(np.zeros((len(potential.fixed), 6)))


def none():
    """Return counts of nothing."""
    return {"passes": 0, "line_search": 0}


def check_same_minimum(monkeypatch, one, found, enough):
    """Assert that a point is the minimum, and that all that it says of itself is so."""
    wanted = by_newton(monkeypatch, one, 1e-4 * enough)
    apart = found.unknowns - wanted.unknowns
    energy = np.einsum("ni,nij,nj->", apart, one.base.diagonal, apart)
    assert energy <= 4.0 * enough  # d.K d, with K below the curvature, and 2 (V - V_min) <= enough
    there = one.at(found.unknowns)
    size = np.abs(there.response.normal_force).max() + np.abs(one.base.force).max()
    assert found.gap == pytest.approx(there.gap, abs=1e-9 * np.abs(there.gap).max())
    assert found.residual == pytest.approx(there.residual, abs=1e-7 * size)
    assert found.response.normal_force == pytest.approx(
        there.response.normal_force, abs=1e-7 * size
    )
    assert found.response.shear_force == pytest.approx(there.response.shear_force, abs=1e-7 * size)


def test_all_small_regions_come_to_their_minimum(potentials, monkeypatch):
    for one in potentials:
        enough = TOLERANCE**2 * one.yardstick()
        counts = none()
        found, left = with_small_regions(one, start(one), enough, counts)
        assert one.small_regions()[:-1].all()
        assert not one.small_regions()[-1]
        assert left <= enough
        assert 0 < counts["passes"] <= small_regions.ITERATIONS
        assert counts["line_search"] >= counts["passes"]
        check_same_minimum(monkeypatch, one, found, enough)


@pytest.mark.parametrize("seed", range(4))
def test_so_they_do_with_bonds_multipliers_and_remembered_forces(monkeypatch, seed):
    for usual in potentials_of(monkeypatch, heap(30, 10), 5e-3, 0.3, 5e8)[::2]:
        one = strengthened(usual, seed)
        enough = TOLERANCE**2 * one.yardstick()
        found, left = with_small_regions(one, start(one), enough, none())
        assert left <= enough
        check_same_minimum(monkeypatch, one, found, enough)


def test_regions_are_small_by_their_blocks_or_where_they_are_like_trees(monkeypatch):
    """A tower of 256 bricks is, a wall of as many is not."""
    tower = [box(0.0, 0.5 * k, 1.0, 0.5) for k in range(256)]
    for outlines, small in ((tower, True), (bricks(16, 16), False)):
        assert len(outlines) > kernel.FEW
        model = system([box(-1.0, -1.0, 30.0, 1.0), *outlines], fixed=[0])
        one = caught(monkeypatch, model, 5e9, 5e-3, 5e-3)[0]
        assert np.array_equal(one.small_regions(), [small, False])


def test_what_is_listed_of_regions_are_their_blocks():
    rng = np.random.default_rng(0)
    region = rng.integers(0, 12, 200)
    begin, blocks, place = kernel.listed(region, 12)
    for r in range(12):
        own = blocks[begin[r] : begin[r + 1]]
        assert np.array_equal(own, np.flatnonzero(region == r))
        assert np.array_equal(place[own], np.arange(len(own)))


def test_large_regions_stay_where_they_are_and_go_on_together(monkeypatch):
    """A wall beside a tower: the tower is minimised, then the wall is with all its contacts."""
    tower = [box(40.0, 0.5 * k, 1.0, 0.5) for k in range(6)]
    base = box(-5.0, -1.0, 60.0, 1.0)
    model = system([base, *bricks(16, 16), *tower], fixed=[0], friction_angle=30.0)
    one = caught(monkeypatch, model, 5e9, 2e-3, 4e-3)[0]
    sizes = np.bincount(one.regions.of_blocks)
    enough = TOLERANCE**2 * one.yardstick()
    before = start(one)
    found, left = with_small_regions(one, before, enough, none())
    large = sizes[one.regions.of_blocks] > 6
    assert np.array_equal(found.unknowns[large], before.unknowns[large])
    assert not np.array_equal(found.unknowns[~large], before.unknowns[~large])
    assert left > enough
    counts = none()
    found = newton.minimise(one, before, FactorOfStep(Automatic()), enough, 200, counts, Stages())
    check_same_minimum(monkeypatch, one, found, enough)


@pytest.mark.parametrize("model", [heap(60, 15), wall(5, 5)])
def test_what_is_not_finished_goes_on_together(monkeypatch, model):
    """Where they may take one iteration only."""
    monkeypatch.setattr(small_regions, "ITERATIONS", 1)
    unfinished = 0
    for one in potentials_of(monkeypatch, model, 2.5e-3, 0.3 if len(model.mass) > 50 else 0.02):
        enough = TOLERANCE**2 * one.yardstick()
        before = start(one)
        _, left = with_small_regions(one, before, enough, none())
        unfinished += left > enough
        found = newton.minimise(
            one, before, FactorOfStep(Automatic()), enough, 200, none(), Stages()
        )
        check_same_minimum(monkeypatch, one, found, enough)
    assert unfinished > 0


def test_who_asks_for_a_solver_has_everything_solved_by_it(monkeypatch):
    asked, free = FactorOfStep(Direct()), FactorOfStep(Automatic())
    one = potentials_of(monkeypatch, heap(30, 10), 5e-3, 0.3, 5e8)[-1]
    enough = TOLERANCE**2 * one.yardstick()
    for factor in (asked, free):
        found = newton.minimise(one, start(one), factor, enough, 200, none(), Stages())
        check_same_minimum(monkeypatch, one, found, enough)
    assert asked.factorised > 0
    assert free.factorised == 0


def test_numbers_that_are_none_are_left_as_they_are(monkeypatch):
    (one, *_) = potentials_of(monkeypatch, heap(30, 10), 5e-3, 0.3, 5e8)[-1:]
    before = start(one)
    odd = replace(before, residual=np.where(one.fixed[:, None], 0.0, np.nan))
    odd = replace(odd, left=np.where(one.fixed, 0.0, np.nan))
    found, left = with_small_regions(one, odd, 1e-9, none())
    assert np.array_equal(found.unknowns, before.unknowns)
    assert not left <= 1e-9


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


def test_room_is_bounded():
    """Blocks of 288 bytes, and what tells where they are, for each block of a region."""
    links = elimination.room_for(100)
    each = 288 * elimination.ROOM + 8 * elimination.MOST + 8
    assert sum(one.nbytes for one in links) <= 100 * each + 8
