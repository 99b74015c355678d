"""The network of channels: the same however blocks lie, are numbered and are cut."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.model.flow.network import Network, network_of
from clast.model.model import Floats, Model
from scenes import wet_rock


@pytest.fixture(scope="module")
def rock() -> Model:
    return wet_rock.cut(10.0, (20.0, 1.0), (95.0, 1.3))


def heads(at: Floats) -> Floats:
    return 2.0 * np.sin(0.3 * at[:, 0]) + 0.2 * at[:, 1]


def discharge(model: Model, network: Network, back: Floats | None = None) -> float:
    at = network.at + model.origin
    return wet_rock.through(
        wet_rock.confined(model, network, heads(at if back is None else at @ back))[1]
    )


def test_channels_are_the_joints_and_nodes_are_where_they_meet(rock):
    """Two sets across a square: each line ends at two outer nodes; Euler counts the rest."""
    network = network_of(rock)
    perimeter = 40.0
    lines = sum(
        np.hypot(*(np.roll(one, -1, 0) - one).T).sum() for one in wet_rock.polygons_of(rock)
    )
    assert network.length.sum() == pytest.approx(0.5 * (lines - perimeter), rel=1e-12)
    # the outline has as many pieces as outer nodes and corners
    assert network.count - len(network.length) - network.outer.sum() + rock.block_count == 1
    size = np.abs(network.at - 5.0).max(axis=1)
    np.testing.assert_array_equal(network.outer, size > 5.0 - 1e-9)
    np.testing.assert_allclose(
        np.hypot(*(network.at[network.node[:, 1]] - network.at[network.node[:, 0]]).T),
        network.length,
        rtol=1e-12,
    )


def test_five_thousand_kilometres_away_it_is_the_same(rock):
    away = [one + np.array([3e5, 5e6]) for one in wet_rock.polygons_of(rock)]
    model = wet_rock.rock_of(away)
    here, there = network_of(rock), network_of(model)
    np.testing.assert_array_equal(here.node, there.node)
    np.testing.assert_array_equal(here.outer, there.outer)
    moved = there.at + model.origin - here.at - rock.origin
    assert np.abs(moved - [3e5, 5e6]).max() < 1e-8


def test_turned_or_renumbered_the_flow_is_the_same(rock):
    known = discharge(rock, network_of(rock))
    rng, polygons = np.random.default_rng(1), wet_rock.polygons_of(rock)
    shuffled = [np.roll(polygons[k], rng.integers(4), 0) for k in rng.permutation(len(polygons))]
    model = wet_rock.rock_of(shuffled)
    assert discharge(model, network_of(model)) == pytest.approx(known, rel=1e-12)
    c, s = np.cos(0.6), np.sin(0.6)
    turn = np.array([[c, -s], [s, c]])
    model = wet_rock.rock_of([one @ turn.T for one in polygons])
    assert discharge(model, network_of(model), turn) == pytest.approx(known, rel=1e-11)


def test_channels_in_pieces_carry_the_same(rock):
    whole, pieces = network_of(rock), network_of(rock, longest=0.2)
    assert pieces.length.max() <= 0.2 * (1.0 + 1e-9)
    assert pieces.count - whole.count == len(pieces.length) - len(whole.length)
    assert not pieces.outer[whole.count :].any()
    assert discharge(rock, pieces) == pytest.approx(discharge(rock, whole), rel=1e-12)


def test_blocks_cut_in_two_by_welds_carry_the_same():
    """Each brick of a wall in one piece, or in two that are welded: no channel between these."""

    def wall(parts: int) -> Model:
        builder = clast.ModelBuilder(gravity=(0.0, -9.81))
        builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
        builder.add_joint(friction_angle=30.0, aperture=2e-4)
        if parts > 1:
            builder.add_weld("weld")
        for row in range(3):
            for column in range(3):
                for part in range(parts):
                    x = column + 0.3 * row + part / parts
                    joints = ["default", "weld" if part < parts - 1 else "default"]
                    joints += ["default", "weld" if part else "default"]
                    corners = [(0, 0), (1 / parts, 0), (1 / parts, 1), (0, 1)]
                    builder.block(
                        vertices=[(x + u, row + v) for u, v in corners], edge_joint=joints
                    )
        return builder.build()

    one, two = wall(1), wall(2)
    assert network_of(one).length.sum() == pytest.approx(network_of(two).length.sum(), rel=1e-12)
    flows = [discharge(model, network_of(model)) for model in (one, two)]
    assert flows[1] == pytest.approx(flows[0], rel=1e-9)


def test_an_excavated_block_bares_the_nodes_around_it(rock):
    before = network_of(rock)
    block = next(  # one with its corners inside
        k for k, one in enumerate(wet_rock.polygons_of(rock)) if np.abs(one - 5.0).max() < 3.0
    )
    network = network_of(wet_rock.without_block(rock, block))
    assert not (network.block == block).any()
    gone = (before.block == block).any(axis=1)
    assert len(network.length) == len(before.length) - gone.sum()
    corners = before.at[np.unique(before.node[gone])]
    bared = [np.hypot(*(network.at - one).T).argmin() for one in corners]
    assert network.outer[bared].all()
    assert network.outer.sum() == before.outer.sum() + len(corners)


def test_joints_without_an_aperture_are_no_channels():
    more = "[joint.tight]\nfriction_angle = 30\naperture = 0.0\n"
    model = wet_rock.cut(
        10.0,
        (0.0, 1.0),
        more=more + '[[joint_set]]\nname = "t"\nangle = 90.0\nspacing = 1.0\njoint = "tight"\n',
    )
    network = network_of(model)
    line = network.at[network.node[:, 1]] - network.at[network.node[:, 0]]
    assert len(line) > 50
    assert np.abs(line[:, 1]).max() < 1e-9


@pytest.mark.parametrize("angle", [0.0, 17.0, 45.0])
def test_two_sets_conduct_as_their_tensor(angle):
    """Linear heads on the outline are linear inside; flux = sum k P21 (I - n n) J (Snow 1969)."""
    model = wet_rock.cut(20.0, (angle, 1.0), (angle + 70.0, 1.3))
    network = network_of(model)
    gradient = np.array([0.01, -0.02])
    head = -(network.at + model.origin) @ gradient
    _, solved = wet_rock.confined(model, network, head)
    height = network.at[:, 1] + model.origin[1]
    found = solved.pressure / wet_rock.WEIGHT + height
    # corners of cut blocks are rounded
    assert np.abs(found - head).max() < 1e-6 * np.abs(head).max()
    line = network.at[network.node[:, 1]] - network.at[network.node[:, 0]]
    flux = (solved.flow[:, None] * line).sum(axis=0) / 400.0
    per_length = wet_rock.WEIGHT * 2e-4**3 / 12e-3
    along = line / network.length[:, None]
    p21 = [
        network.length[np.abs(along @ [np.cos(a), np.sin(a)]) > 0.999].sum() / 400.0
        for a in np.radians([angle, angle + 70.0])
    ]
    assert sum(p21) == pytest.approx(network.length.sum() / 400.0, rel=1e-12)
    tensor = np.zeros((2, 2))
    for intensity, a in zip(p21, np.radians([angle, angle + 70.0]), strict=True):
        normal = np.array([-np.sin(a), np.cos(a)])
        tensor += per_length * intensity * (np.eye(2) - np.outer(normal, normal))
    np.testing.assert_allclose(flux, tensor @ gradient, rtol=1e-6)
    # P21 is the inverse of the spacing, but for the lines that a square of 20 m happens to meet
    np.testing.assert_allclose(p21, [1.0, 1.0 / 1.3], rtol=0.03)
    assert abs(solved.unaccounted) < 1e-12 * solved.throughput
