"""Flow in networks of channels drawn at random: it is always found, and water is accounted for."""

from __future__ import annotations

import numpy as np
import pytest

from clast.model.flow.solving import advanced, steady
from scenes.channels import WEIGHT, drawn, in_pieces, out_of_balance, renumbered

GROUP = 25
"""Networks of a test."""


def within(drawn_one, solved):
    """Return whether pressures are such as heads and rain give, and mass is accounted for."""
    deepest = WEIGHT * (drawn_one.highest - drawn_one.at[:, 1].min())
    most = np.maximum(WEIGHT * (drawn_one.highest - drawn_one.at[:, 1]), 0.0)
    assert solved.pressure.min() >= 0.0
    assert (solved.pressure - most).max() <= 1e-12 * deepest
    assert solved.saturation.min() >= 0.0 and solved.saturation.max() <= 1.0
    assert abs(solved.unaccounted) <= 1e-12 * solved.throughput
    return True


@pytest.mark.parametrize("first", range(0, 500, GROUP))
def test_steady_flow_and_draw_down_of_a_random_network(first):
    for seed in range(first, first + GROUP):
        one = drawn(seed)
        solved = steady(one.balance)
        assert within(one, solved), seed
        assert out_of_balance(one.balance, solved) <= 1e-12, seed
        for step in (10.0, 1e3, 1e5):
            solved = advanced(one.lowered, solved, step)
            assert within(one, solved), seed


@pytest.mark.parametrize("first", range(0, 100, GROUP))
def test_results_depend_neither_on_numbers_nor_on_pieces_nor_on_the_start(first):
    for seed in range(first, first + GROUP):
        one, random = drawn(seed), np.random.default_rng(seed)
        solved = steady(one.balance)
        small = 1e-12 * WEIGHT * (one.highest - one.at[:, 1].min())
        order = random.permutation(len(one.at))
        channels = random.permutation(len(one.balance.node))
        other = steady(renumbered(one.balance, order, channels))
        assert np.abs(other.pressure - solved.pressure[order]).max() <= small, seed
        assert np.abs(other.saturation - solved.saturation[order]).max() <= 1e-9, seed
        cut = steady(in_pieces(one.balance, 3))
        assert np.abs(cut.pressure[: len(order)] - solved.pressure).max() <= small, seed
        from_lower = steady(one.balance, steady(one.lowered))
        assert np.abs(from_lower.pressure - solved.pressure).max() <= small, seed
