"""How nodes of water take part in the openings of channels."""

from __future__ import annotations

import numpy as np
import pytest

from clast.actions.openings import LINEAR, shares_in_wedges


def test_water_at_rest_and_in_even_channels_presses_linearly():
    assert shares_in_wedges(np.full((1, 2), 3e-4))[0] == pytest.approx(LINEAR, abs=1e-15)


@pytest.mark.parametrize("ratio", [1e-3, 0.2, 0.899, 0.901, 0.99, 1.099, 1.101, 7.0, 1e3])
def test_head_is_lost_where_a_wedge_is_narrow(ratio):
    """Shares are integrals over dp/ds ~ a^-3, by the midpoints of many pieces."""
    apertures = 2e-4 * np.array([1.0, ratio])
    s = (np.arange(400_000) + 0.5) / 400_000
    lost = ((1.0 - s) * apertures[0] + s * apertures[1]) ** -3.0
    f = np.cumsum(lost) - 0.5 * lost
    f /= lost.sum()
    known = [[np.mean(n * m) for n in (1.0 - f, f)] for m in (1.0 - s, s)]
    (shares,) = shares_in_wedges(apertures[None])
    assert shares == pytest.approx(np.array(known), abs=1e-6)
    assert shares.sum(axis=1) == pytest.approx([0.5, 0.5], abs=1e-12)
