"""Flow of water in channels against closed forms."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import erfc

from clast.model.flow.balance import GIVEN, INNER, SEEPAGE, Balance, Solved
from clast.model.flow.solving import NoFlow, advanced, steady
from scenes.channels import WEIGHT, in_pieces, network

CHANNEL = 1e-10
"""Conductance, m2/(s Pa)."""
CAPACITY = WEIGHT * CHANNEL
"""Flow of a metre of a vertical channel that is full, by its weight, m2/s."""


def chain(heights: list[float], **given: object) -> Balance:
    """Return channels from each point to the next, at some heights, m."""
    count = len(heights)
    at = np.stack([np.arange(count), heights], axis=1)
    node = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    return network(at=at, node=node, conductance=CHANNEL, **given)


def accounted(solved: Solved) -> bool:
    """Return whether the mass of water is accounted for."""
    return abs(solved.unaccounted) <= 1e-12 * solved.throughput


def test_channels_in_series() -> None:
    balance = network(
        at=[(0, 0), (1, 0), (3, 0)],
        node=[(0, 1), (2, 1)],
        conductance=[1e-10, 4e-10],
        kind=[GIVEN, INNER, GIVEN],
        pressure=[1e5, 0, 0],
        confined=True,
    )
    solved = steady(balance)
    flow = 1e5 / (1 / 1e-10 + 1 / 4e-10)
    assert solved.flow == pytest.approx([flow, -flow], rel=1e-12)
    assert solved.given == pytest.approx([flow, 0.0, -flow], rel=1e-12, abs=1e-20)
    assert accounted(solved)


def test_channels_side_by_side() -> None:
    balance = network(
        at=[(0, 3), (1, 1)],
        node=[(0, 1), (1, 0)],
        conductance=[1e-10, 4e-10],
        kind=[GIVEN, GIVEN],
        pressure=[1e5, 2e4],
    )
    solved = steady(balance)
    flow = (1e5 + 2 * WEIGHT - 2e4) * np.array([1e-10, -4e-10])
    assert solved.flow == pytest.approx(flow, rel=1e-12)


def test_water_below_one_level_is_at_rest() -> None:
    # a zigzag that dips under the level, rises above it, and has a closed end
    heights = [2.0, 0.5, 3.0, 1.0, 6.5, 0.2]
    kind = [GIVEN, INNER, GIVEN, INNER, INNER, INNER]
    pressure = WEIGHT * np.array([3.0, 0.0, 2.0, 0.0, 0.0, 0.0])
    balance = chain(heights, kind=kind, pressure=pressure)
    solved = steady(balance)
    head = np.array([3.0, 4.5, 2.0, 4.0, 0.0, 0.0])  # dry beyond the crest
    assert solved.pressure == pytest.approx(WEIGHT * head, rel=1e-12, abs=1e-9)
    assert np.abs(solved.flow).max() <= 1e-12 * CAPACITY
    assert solved.saturation[4:] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_no_water_flows_over_a_dry_crest() -> None:
    balance = chain([0.0, 1.0, 0.0], kind=[GIVEN, INNER, GIVEN], pressure=[0.95 * WEIGHT, 0, 0])
    solved = steady(balance)
    assert np.abs(solved.flow).max() <= 1e-12 * CAPACITY
    higher = replace(balance, pressure=np.array([1.2 * WEIGHT, 0.0, 0.0]))
    # over it 0.2 m of head fall in a metre of channel, and p is 0 at the crest
    assert steady(higher).flow == pytest.approx(0.2 * CAPACITY, rel=1e-12)


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_rain_enters_up_to_the_capacity_of_a_joint(share: float) -> None:
    rain = 5 * CAPACITY * share
    balance = chain(
        [10.0, 5.0, 0.0],
        kind=[SEEPAGE, INNER, GIVEN],
        pressure=[0, 0, 4 * WEIGHT],
        inflow=[rain, 0, 0],
    )
    solved = steady(balance)
    # a full joint from the face down to a head of 4 m: 6 m by two channels in series
    flow = min(rain, 3 * CAPACITY)
    assert solved.flow == pytest.approx(flow, rel=1e-12)
    assert solved.runoff[0] == pytest.approx(rain - flow, abs=1e-20)
    assert solved.outflow[0] == pytest.approx(0.0, abs=1e-20)
    assert solved.saturation[0] == pytest.approx(min(1.0, share), rel=1e-12)
    assert accounted(solved)


def test_rain_runs_down_a_dry_joint() -> None:
    balance = chain([10.0, 5.0, 0.0], kind=[SEEPAGE, INNER, SEEPAGE], inflow=[2 * CAPACITY, 0, 0])
    solved = steady(balance)
    assert solved.saturation[:2] == pytest.approx([0.4, 0.4], rel=1e-12)  # s = q/(C G)
    assert solved.outflow == pytest.approx([0, 0, 2 * CAPACITY], rel=1e-12, abs=1e-20)
    assert (solved.pressure == 0.0).all()


def level_grid(wide: int, high: int, length: float, height: float) -> tuple[Balance, np.ndarray]:
    """Return joints on a level grid, as wide as high of ``length`` by ``height``, and their places.

    The vertical ones end at half a spacing below the lowest level one and above the highest.
    """
    across, up = length / wide, height / high
    x = np.concatenate([[0.0], (np.arange(wide) + 0.5) * across, [length]])
    y = (np.arange(high) + 0.5) * up
    number = np.arange(len(x) * high).reshape(len(x), high)
    level = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    steep = np.stack([number[1:-1, :-1].ravel(), number[1:-1, 1:].ravel()], axis=1)
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2).reshape(-1, 2)
    node = np.concatenate([level, steep])
    conductance = CHANNEL / np.hypot(*(at[node[:, 1]] - at[node[:, 0]]).T)
    return network(at=at, node=node, conductance=conductance), at


@pytest.mark.parametrize(("wide", "high"), [(8, 10), (20, 20), (40, 40)])
def test_a_dam_lets_through_what_dupuit_and_charny_say(wide: int, high: int) -> None:
    balance, at = level_grid(wide, high, 20.0, 10.0)
    x, y = at.T
    kind, pressure = balance.kind.copy(), balance.pressure.copy()
    for side, level in ((x == 0.0, 8.0), (x == 20.0, 2.0)):
        kind[side & (y <= level)] = GIVEN
        pressure[side] = WEIGHT * np.maximum(level - y[side], 0.0)
    kind[(x == 20.0) & (y > 2.0)] = SEEPAGE
    solved = steady(replace(balance, kind=kind, pressure=pressure))
    conductivity = CAPACITY / (10.0 / high)
    discharge = conductivity * (8.0**2 - 2.0**2) / (2 * 20.0)
    assert solved.given[x == 0.0].sum() == pytest.approx(discharge, rel=1e-12)
    assert solved.outflow.sum() > 0.05 * discharge  # a seepage face
    assert accounted(solved)


def pulse(pieces: int, steps: int) -> float:
    """Return the error of a pulse along a joint, as a share of the pressure at its end.

    It diffuses by the bulk modulus alone: D = C l K/a for channels of length l.
    """
    long, aperture, bulk = 100.0, 1e-4, 2e9
    size = long / pieces
    ends = np.where(np.isin(np.arange(pieces + 1), [0, pieces]), 0.5, 1.0)
    balance = network(
        at=np.stack([np.linspace(0.0, long, pieces + 1), np.zeros(pieces + 1)], axis=1),
        node=np.stack([np.arange(pieces), np.arange(1, pieces + 1)], axis=1),
        conductance=aperture**3 / 12e-3 / size,
        kind=np.where(np.arange(pieces + 1) == 0, GIVEN, INNER),
        pressure=np.where(np.arange(pieces + 1) == 0, 1e6, 0.0),
        volume=ends * aperture * size,
        confined=True,
    )
    diffusivity = aperture**2 * bulk / 12e-3
    time = 250.0 / diffusivity
    solved = steady(replace(balance, pressure=np.zeros(pieces + 1)))
    for _ in range(steps):
        solved = advanced(balance, solved, time / steps)
        assert accounted(solved)
    right = 1e6 * erfc(np.linspace(0.0, long, pieces + 1) / (2 * np.sqrt(diffusivity * time)))
    return float(np.abs(solved.pressure - right).max() / 1e6)


def test_a_pulse_diffuses_at_second_order_in_space_and_first_in_time() -> None:
    errors = [pulse(50, 20), pulse(100, 80), pulse(200, 320)]
    assert errors[2] < 1e-3
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(4.0, rel=0.1)


def test_a_long_step_comes_to_the_steady_state() -> None:
    balance, at = level_grid(6, 6, 6.0, 6.0)
    x, y = at.T
    kind = np.where((x == 0.0) & (y < 5.0), GIVEN, np.where(x == 6.0, SEEPAGE, INNER))
    pressure = np.where(kind == GIVEN, WEIGHT * (5.0 - y), 0.0)
    volume = np.full(len(x), 1e-5)
    balance = replace(balance, kind=kind, pressure=pressure, volume=volume)
    dry = steady(replace(balance, pressure=np.zeros(len(x)), kind=np.full(len(x), INNER)))
    assert dry.pressure.max() == 0.0 and dry.saturation.max() == 0.0
    long, ended = advanced(balance, dry, 1e12), steady(balance)
    # but for what still fills the joints
    assert long.flow == pytest.approx(ended.flow, abs=volume.sum() / 1e12)
    assert long.pressure == pytest.approx(ended.pressure, abs=volume.sum() / 1e12 / CHANNEL)


def test_what_drains_was_in_the_joints() -> None:
    balance, at = level_grid(5, 8, 5.0, 8.0)
    x, y = at.T
    kind = np.where(x == 0.0, GIVEN, INNER)
    volume = 1e-4 * (1.0 + x)
    full = replace(balance, kind=kind, pressure=np.where(kind == GIVEN, WEIGHT * (8.0 - y), 0.0))
    full = replace(full, volume=volume)
    before = steady(full)
    lower = replace(
        full,
        kind=np.where((x == 0.0) & (y > 1.0), SEEPAGE, kind),
        pressure=np.where(kind == GIVEN, WEIGHT * np.maximum(1.0 - y, 0.0), 0.0),
    )
    solved, gone = before, 0.0
    for step in (10.0, 100.0, 1e3, 1e4, 1e5, 1e6):
        solved = advanced(lower, solved, step)
        assert accounted(solved)
        gone += step * (solved.outflow.sum() - solved.given.sum())
    drained = volume * (before.saturation - solved.saturation)
    eased = volume * (before.pressure - solved.pressure) / balance.bulk_modulus
    assert gone == pytest.approx(drained.sum() + eased.sum(), rel=1e-12)
    assert drained.sum() > 0.4 * volume.sum()
    head = WEIGHT * np.maximum(1.0 - y, 0.0)
    assert solved.pressure == pytest.approx(head, abs=1e-3 * WEIGHT)


def test_a_joint_that_opens_shares_out_its_water() -> None:
    # closed all round: no water comes, so that it fills less of the joint
    balance = chain([0.0, 1.0], volume=[2e-4, 1e-4], opened=[1e-4, 0.0])
    before = steady(replace(balance, kind=np.array([GIVEN, GIVEN])))
    solved = advanced(balance, replace(before, saturation=np.array([1.0, 0.0])), 1.0)
    assert solved.saturation == pytest.approx([0.5, 0.0], rel=1e-12)
    assert solved.pressure == pytest.approx([0.0, 0.0])
    assert accounted(solved)


@pytest.mark.parametrize(("asked", "got"), [(0.5, 0.5), (4.0, 1.5)])
def test_a_pump_takes_what_it_asks_for_or_what_comes(asked: float, got: float) -> None:
    # from a head of 1.5 m one metre away
    balance = chain(
        [0.0, 0.0], kind=[GIVEN, INNER], pressure=[1.5 * WEIGHT, 0], inflow=[0, -asked * CAPACITY]
    )
    solved = steady(balance)
    assert solved.given[0] == pytest.approx(got * CAPACITY, rel=1e-12)
    assert solved.missing[1] == pytest.approx((asked - got) * CAPACITY, abs=1e-20)
    assert solved.pressure[1] == pytest.approx(max(1.5 - asked, 0.0) * WEIGHT, abs=1e-9)
    assert accounted(solved)


@pytest.mark.parametrize("confined", [False, True])
def test_a_drain_gives_off_water_at_its_pressure_and_takes_none(confined: bool) -> None:
    balance = chain(
        [0.0, 0.0, 0.0],
        kind=[GIVEN, SEEPAGE, GIVEN],
        pressure=[3 * WEIGHT, WEIGHT, WEIGHT],
        confined=confined,
    )
    solved = steady(balance)
    assert solved.outflow[1] == pytest.approx(2 * CAPACITY, rel=1e-12)
    high = steady(replace(balance, pressure=np.array([3.0, 2.5, 1.0]) * WEIGHT))
    assert high.outflow[1] == 0.0
    assert high.pressure[1] == pytest.approx(2.0 * WEIGHT, rel=1e-12)


def test_water_that_nothing_feeds_is_not_there_in_steady_flow() -> None:
    # two closed ends below a joint along which no water comes
    balance = chain([0.0, 3.0, 4.0, 1.0], kind=[INNER, INNER, SEEPAGE, INNER])
    full = steady(replace(balance, kind=np.full(4, GIVEN), pressure=np.full(4, WEIGHT)))
    solved = steady(balance, full)
    assert (solved.pressure == 0.0).all() and (solved.saturation == 0.0).all()
    rained = steady(replace(balance, inflow=np.array([0.0, 0.0, 0.1 * CAPACITY, 0.0])))
    # and full where it comes: rain runs off in the end
    assert rained.pressure == pytest.approx(WEIGHT * np.array([4.0, 1.0, 0.0, 3.0]), rel=1e-9)
    assert rained.runoff[2] == pytest.approx(0.1 * CAPACITY, rel=1e-9)


@pytest.mark.parametrize("confined", [False, True])
def test_a_source_in_a_closed_part_is_refused(confined: bool) -> None:
    balance = chain([0.0, 1.0, 0.5], inflow=[0.0, 2e-6, 0.0], confined=confined)
    with pytest.raises(NoFlow, match=r"nowhere to go: 2e-06 m2/s flow into a part .* of 3 ends"):
        steady(balance)
    # two that cancel each other are not, nor is a step of transient flow
    pumped = replace(balance, inflow=np.array([0.0, 2e-6, -2e-6]))
    assert steady(pumped).flow == pytest.approx([0.0, 2e-6], abs=1e-12 * 2e-6)
    before = steady(replace(balance, inflow=np.zeros(3)))
    solved = advanced(replace(balance, volume=np.full(3, 1e-3)), before, 1.0)
    assert solved.stored == pytest.approx(2e-6, rel=1e-12)


def test_channels_in_pieces_carry_the_same() -> None:
    balance, at = level_grid(4, 5, 8.0, 5.0)
    x, y = at.T
    kind = np.where(x == 0.0, GIVEN, np.where(x == 8.0, SEEPAGE, INNER))
    balance = replace(
        balance, kind=kind, pressure=np.where(kind == GIVEN, 5 * WEIGHT - WEIGHT * y, 0)
    )
    whole, cut = steady(balance), steady(in_pieces(balance, 3))
    assert cut.pressure[: len(x)] == pytest.approx(whole.pressure, abs=1e-12 * 5 * WEIGHT)
    assert cut.flow[::3] == pytest.approx(whole.flow, abs=1e-12 * whole.throughput)
