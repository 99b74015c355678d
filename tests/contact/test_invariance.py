"""Moving, turning and renumbering a system, and taking it far away, changes no contact."""

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from scenes.systems import (
    box,
    bricks,
    contacts_of,
    convex,
    star,
    system,
    touches_of,
    turned,
    voussoirs,
)


def crowd(rng, side=7, spacing=0.1):
    """Return polygons on a jittered lattice, most of them touching or overlapping some others."""
    return [
        spacing
        * turned(
            (convex if rng.uniform() < 0.5 else star)(rng, rng.integers(3, 8), 0.72),
            rng.uniform(0.0, 6.0),
            (column + rng.uniform(-0.1, 0.1), row + rng.uniform(-0.1, 0.1)),
        )
        for row in range(side)
        for column in range(side)
    ]


def as_set(touches):
    return {(one.vertex, one.edge): one.gap for one in touches}


def same(found, wanted, tolerance):
    """Assert that two sets of contacts are the same with the same gaps."""
    assert set(found) == set(wanted)
    for key, gap in wanted.items():
        assert found[key] == pytest.approx(gap, abs=tolerance)


@pytest.mark.parametrize("seed", range(12))
def test_moving_and_turning_a_crowd(seed):
    rng = np.random.default_rng(seed)
    outlines = crowd(rng)
    angle, shift = rng.uniform(0.0, 6.28), rng.uniform(-50.0, 50.0, 2)
    wanted = as_set(touches_of(outlines))
    assert len(wanted) > 20
    same(as_set(touches_of([turned(one, angle, shift) for one in outlines])), wanted, 1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_renumbering_blocks_and_starting_loops_elsewhere(seed):
    rng = np.random.default_rng(seed)
    outlines = crowd(rng)
    order = rng.permutation(len(outlines))  # new block k is old block order[k]
    first = [int(rng.integers(len(one))) for one in outlines]
    renumbered = [np.roll(outlines[old], -first[old], axis=0) for old in order]

    def old_name(block, vertex):
        old = int(order[block])
        return old, (vertex + first[old]) % len(outlines[old])

    found = {
        (old_name(*one.vertex), old_name(*one.edge)): one.gap for one in touches_of(renumbered)
    }
    same(found, as_set(touches_of(outlines)), 0.0)


@pytest.mark.parametrize("seed", range(6))
def test_mirroring_a_crowd(seed):
    """Left and right, start and end of an edge, are treated alike."""
    outlines = crowd(np.random.default_rng(seed))
    mirrored = [(one * [-1.0, 1.0])[::-1] for one in outlines]

    def unmirrored(block, vertex, edge=False):
        count = len(outlines[block])
        return block, (count - 1 - vertex - edge) % count

    found = {
        (unmirrored(*one.vertex), unmirrored(*one.edge, edge=True)): one.gap
        for one in touches_of(mirrored)
    }
    same(found, as_set(touches_of(outlines)), 1e-14)


@pytest.mark.parametrize("outlines", [bricks(4, 4), voussoirs(11)], ids=["wall", "arch"])
def test_model_far_from_the_origin_has_the_same_contacts(outlines):
    """The model takes coordinates about an origin of its own."""
    near = contacts_of(system(outlines))
    model = system([one + np.array([2.0**20, -(2.0**21)]) for one in outlines])
    assert np.abs(model.vertices).max() < 20.0
    far = contacts_of(model)
    assert np.array_equal(near.vertex, far.vertex)
    assert np.array_equal(near.edge, far.edge)
    assert far.gap == pytest.approx(near.gap, abs=1e-9)
    assert far.normal == pytest.approx(near.normal, abs=1e-8)
    assert far.rows == pytest.approx(near.rows, abs=1e-8)
    assert far.length == pytest.approx(near.length, abs=1e-8)


def test_fixed_blocks_do_not_touch_each_other():
    outlines = bricks(3, 3)
    contacts = contacts_of(system(outlines, fixed=range(9)))
    assert len(contacts) == 0
    some = contacts_of(system(outlines, fixed=range(4)))
    assert not ((some.vertex_block < 4) & (some.edge_block < 4)).any()
    everything = contacts_of(system(outlines))
    # corners of blocks that move; where fixed ones are one body its surface has none at a joint
    free = everything.vertex_block >= 4
    assert np.array_equal(some.vertex[some.vertex_block >= 4], everything.vertex[free])
    assert set(some.vertex) <= set(everything.vertex)


def test_joints_go_by_pair_of_blocks_then_by_pair_of_rocks():
    builder = InputBuilder()
    for rock in ("granite", "clay"):
        builder.add_rock(rock, young=1e9, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=10.0)
    builder.add_joint("seam", friction_angle=20.0, between_rocks=[("clay", "granite")])
    builder.add_joint("bolted", friction_angle=30.0, cohesion=5.0, between=[("c", "a")])
    for name, rock, x in (("a", "granite", 0), ("b", "granite", 1), ("c", "clay", 0.5)):
        builder.block(name=name, rock=rock, vertices=box(x, 1.0 if name == "c" else 0.0))
    contacts = contacts_of(builder.build())
    blocks = np.sort(np.stack([contacts.vertex_block, contacts.edge_block], axis=1), axis=1)
    angle = {(0, 1): 10.0, (0, 2): 30.0, (1, 2): 20.0}
    wanted = [np.tan(np.radians(angle[tuple(pair)])) for pair in blocks.tolist()]
    assert {tuple(pair) for pair in blocks.tolist()} == set(angle)
    assert contacts.friction == pytest.approx(wanted)
    assert contacts.cohesion == pytest.approx(
        [5.0 if (p == [0, 2]) else 0.0 for p in blocks.tolist()]
    )
