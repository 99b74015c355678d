"""The exact values against numbers and integrations that owe nothing to the problems."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from clast.model.model import PlaneStrain, PlaneStress
from clast.verification.problems.blocks import patch, pendulum
from clast.verification.problems.contact import bounce
from clast.verification.problems.friction import decelerating_block, incline
from clast.verification.problems.slopes import toppling
from clast.verification.variants import EULER, LAGGED

TABLE_1 = {
    0: 2.45,
    5: 2.235653,
    10: 2.017999,
    15: 1.793524,
    20: 1.558273,
    25: 1.307546,
    30: 1.035492,
    35: 0.734492,
    40: 0.394206,
    45: 0.0,
}


@pytest.mark.parametrize(("angle", "way"), TABLE_1.items())
def test_incline(angle, way):
    assert incline.exact_displacement(angle) == pytest.approx(way, abs=6e-7)


def test_deceleration():
    # 9.8 (cos 20 tan 30 - sin 20), by hand
    assert decelerating_block.DECELERATION == pytest.approx(9.8 * (0.5425317875 - 0.3420201433))


@pytest.mark.parametrize("amplitude", pendulum.AMPLITUDES)
def test_period_against_integration(amplitude):
    factor = pendulum.GRAVITY * pendulum.ARM / pendulum.INERTIA

    def passes_vertical(_, state):
        return state[0]

    passes_vertical.terminal = True
    found = solve_ivp(
        lambda _, state: (state[1], -factor * np.sin(state[0])),
        (0.0, 10.0),
        (np.radians(amplitude), 0.0),
        events=passes_vertical,
        rtol=1e-11,
        atol=1e-13,
    )
    assert pendulum.exact_period(amplitude) == pytest.approx(4.0 * found.t_events[0][0], rel=1e-7)


@pytest.mark.parametrize(("variant", "theta"), [(LAGGED, 0.5), (EULER, 1.0)])
def test_restitution_against_an_oscillator(variant, theta):
    step = 0.02  # w h
    x, v = 0.0, -1.0
    while x <= 0.0:
        # v1 = v - w2 h x1,  x1 = x + h ((1 - theta) v + theta v1), in units of w = 1
        x_next = (x + step * v) / (1.0 + theta * step**2)
        v, x = v - step * x_next, x_next
    assert bounce.exact_restitution(step, variant) == pytest.approx(v, abs=2e-3)


@pytest.mark.parametrize("plane", [PlaneStress(), PlaneStrain()])
def test_compliance_inverts_elasticity(plane):
    stiffness = plane.elasticity(patch.YOUNG, patch.POISSON)
    assert stiffness @ patch.strain(plane) == pytest.approx(patch.STRESS)


def test_limit_of_the_toppling_slope():
    assert np.tan(np.radians(toppling.limit_angle())) == pytest.approx(0.7855, abs=5e-5)
    heights = [toppling.height(column) for column in (1, 10, 11, 16)]
    assert heights == [4.0, 40.0, 34.0, 4.0]
    # the far top corner of the highest column stands 92.5 m above the toe of the base
    assert toppling.place(100.0, 50.0)[1] == pytest.approx(92.5, abs=1.0)
