"""Clipped springs: force, stiffness and energy, and tables of them."""

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.parallel import CONTACTS
from clast.contact.clipped_spring import Clipped, Springs, merged, table

INF = np.inf


@pytest.mark.parametrize(
    ("low", "high"),
    [(0.0, INF), (-50.0, INF), (-40.0, 40.0), (-INF, 30.0), (-INF, INF), (5.0, 5.0)],
)
@pytest.mark.parametrize("at_zero", [0.0, 20.0, -70.0])
@pytest.mark.parametrize("stiffness", [1e6, 0.0])
def test_the_force_is_what_the_energy_falls_by(low, high, at_zero, stiffness):
    stretch = np.linspace(-1e-4, 1e-4, 41) + 1.7e-7
    springs = one_link(at_zero, stiffness, low, high)
    step = 1e-9
    for x in stretch:
        here = springs.at(np.array([x]), np.zeros(1))
        slope = [springs.energy(np.array([x + h]), np.zeros(1)) for h in (-step, step)]
        wanted = np.clip(at_zero - stiffness * x, low, high)
        assert here.normal_force[0] == pytest.approx(wanted)
        assert -(slope[1] - slope[0]) / (2.0 * step) == pytest.approx(wanted, rel=1e-4, abs=1e-3)
        inside = low < at_zero - stiffness * x < high
        assert here.normal_stiffness[0] == (stiffness if inside else 0.0)
        assert here.shear_force[0] == here.shear_stiffness[0] == 0.0


def one_link(at_zero, stiffness, low, high):
    """Return a table of one link with a normal spring alone."""
    given = [np.array([value]) for value in (at_zero, stiffness, low, high)]
    zero = np.zeros(1)
    return table(
        vertex_block=np.array([1]),
        edge_block=np.array([0]),
        arms=np.array([[0.0, 1.0, 0.0, -0.5, 0.0, 0.5]]),
        gap=zero,
        slip=zero,
        normal=Clipped(at_zero=given[0], stiffness=given[1], low=given[2], high=given[3]),
        shear=Clipped(at_zero=zero, stiffness=zero, low=zero, high=zero),
    )[0]


def test_at_a_kink_a_spring_is_stiff_unless_its_force_is_given():
    at = one_link(0.0, 1e6, 0.0, INF).at(np.zeros(1), np.zeros(1))
    assert at.normal_stiffness[0] == 1e6
    at = one_link(0.0, 1e6, 0.0, 0.0).at(np.zeros(1), np.zeros(1))
    assert at.normal_stiffness[0] == 0.0


def random_table(rng, blocks, count):
    """Return links between random blocks as a table, and as they were given."""
    ends = np.array([rng.choice(blocks, 2, replace=False) for _ in range(count)]).reshape(-1, 2)

    def springs():
        values = rng.normal(size=(4, count))
        return Clipped(at_zero=values[0], stiffness=values[1], low=values[2], high=values[3])

    given = {
        "vertex_block": ends[:, 0],
        "edge_block": ends[:, 1],
        "arms": rng.normal(size=(count, 6)),
        "gap": rng.normal(size=count),
        "slip": rng.normal(size=count),
        "normal": springs(),
        "shear": springs(),
    }
    return (*table(**given), given)


def check_is_table(springs: Springs):
    """Assert that links are in the order of their pairs, and these sorted."""
    ends = np.sort(np.stack([springs.vertex_block, springs.edge_block], axis=1), axis=1)
    assert np.array_equal(springs.pairs[springs.pair], ends)
    assert (np.diff(springs.pair) >= 0).all()
    assert [tuple(one) for one in springs.pairs] == sorted({tuple(one) for one in ends})


def check_rows(springs, rows, given):
    """Assert that the links given are in some rows."""
    for name in ("vertex_block", "edge_block", "arms", "gap", "slip"):
        assert np.array_equal(getattr(springs, name)[rows], given[name])
    for kind in ("normal", "shear"):
        for one, other in zip(getattr(springs, kind).arrays, given[kind].arrays, strict=True):
            assert np.array_equal(one[rows], other)


@pytest.mark.parametrize("count", [0, 1, 40])
def test_links_are_put_in_the_order_of_their_pairs(count):
    springs, rows, given = random_table(np.random.default_rng(count), 9, count)
    check_is_table(springs)
    check_rows(springs, rows, given)


def test_tables_are_merged_and_each_knows_its_rows():
    rng = np.random.default_rng(5)
    (first, _, _), (second, own, given), (third, _, _) = (
        random_table(rng, 9, count) for count in (30, 7, 2)
    )
    springs, (of_first, of_second, of_third) = merged(first, (second, third))
    check_is_table(springs)
    assert sorted(np.concatenate([of_first, of_second, of_third])) == list(range(39))
    check_rows(springs, of_second[own], given)
    # the links of a pair that were there first come first
    assert (np.diff(of_first) > 0).all()
    changed = replace(third.normal, low=third.normal.low - 1.0)
    put = springs.put(of_third, changed, third.shear)
    assert np.array_equal(put.normal.low[of_third], third.normal.low - 1.0)
    assert np.array_equal(put.normal.low[of_first], first.normal.low)


def test_nothing_is_done_where_there_are_no_others():
    springs, _, _ = random_table(np.random.default_rng(1), 9, 30)
    assert merged(springs, ()) == (springs, (slice(None),))


def test_many_springs_bear_what_each_bears():
    rng = np.random.default_rng(2)
    count = CONTACTS.many + CONTACTS.part + 3
    springs, _, _ = random_table(rng, 50, count)
    spread = np.abs(rng.normal(size=count))
    normal = replace(springs.normal, stiffness=np.abs(springs.normal.stiffness))
    normal = replace(normal, low=normal.at_zero - spread, high=normal.at_zero + spread)
    springs = replace(springs, normal=normal, shear=normal)
    gap, slip = rng.normal(size=(2, count))
    found = springs.at(gap, slip)
    for stretch, force, stiffness in (
        (gap, found.normal_force, found.normal_stiffness),
        (slip, found.shear_force, found.shear_stiffness),
    ):
        straight = normal.at_zero - normal.stiffness * stretch
        wanted = np.clip(straight, normal.low, normal.high)
        assert np.array_equal(force, wanted)
        assert np.array_equal(stiffness, np.where(wanted == straight, normal.stiffness, 0.0))
    each = sum(
        one_link(normal.at_zero[c], normal.stiffness[c], normal.low[c], normal.high[c]).energy(
            x[c : c + 1], np.zeros(1)
        )
        for c in range(200)
        for x in (gap, slip)
    )
    few = replace(
        springs,
        gap=springs.gap[:200],
        normal=Clipped(**{name: one[:200] for name, one in vars(normal).items()}),
        shear=Clipped(**{name: one[:200] for name, one in vars(normal).items()}),
    )
    assert few.energy(gap[:200], slip[:200]) == pytest.approx(each, rel=1e-12)
