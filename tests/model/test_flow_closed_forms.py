"""Flow of water in channels against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from clast.model.flow.balance import GIVEN, INNER, SEEPAGE
from clast.model.flow.solving import steady
from scenes.channels import network

CAPACITY = 9810.0 * 1e-10
"""Flow of a full vertical metre of a channel of conductance 1e-10."""


def test_channels_in_series() -> None:
    balance = network(
        at=[(0, 0), (1, 0), (3, 0)],
        node=[(0, 1), (1, 2)],
        conductance=[1e-10, 4e-10],
        kind=[GIVEN, INNER, GIVEN],
        pressure=[1e5, 0, 0],
        confined=True,
    )
    solved = steady(balance)
    assert solved.flow == pytest.approx(1e5 / (1e10 + 0.25e10), rel=1e-12)
    assert abs(solved.unaccounted) <= 1e-12 * solved.throughput


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_rain_enters_up_to_the_capacity_of_a_joint(share: float) -> None:
    balance = network(
        at=[(0, 10), (0, 5), (0, 0)],
        node=[(0, 1), (1, 2)],
        conductance=[1e-10, 1e-10],
        kind=[SEEPAGE, INNER, GIVEN],
        pressure=[0, 0, 9810 * 4.0],
        inflow=[5 * CAPACITY * share, 0, 0],
    )
    solved = steady(balance)
    # a full joint from the face down to a head of 4 m: 6 m over twice the resistance
    most = 0.5 * 6.0 * CAPACITY
    assert solved.flow == pytest.approx(min(most, 5 * CAPACITY * share), rel=1e-12)
    assert solved.runoff[0] == pytest.approx(5 * CAPACITY * share - solved.flow[0], abs=1e-20)
    if share < 1.0:
        assert solved.saturation[0] == pytest.approx(share, rel=1e-12)
    assert np.all(solved.pressure >= 0.0)
