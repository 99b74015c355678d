"""Networks of channels by hand and at random, without blocks."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.model.flow.balance import INNER, Balance

WEIGHT = 9810.0
"""Weight of water, N/m3."""


def network(*, at: Any, node: Any, conductance: Any, **given: Any) -> Balance:
    """Return the balance of channels between points (m, 2), m; ``given``: fields of Balance."""
    at, node = np.asarray(at, np.float64), np.asarray(node, np.int64)
    count, channels = len(at), len(node)
    fields: dict[str, Any] = {
        "kind": np.full(count, INNER),
        "pressure": np.zeros(count),
        "inflow": np.zeros(count),
        "volume": np.zeros(count),
        "opened": np.zeros(count),
    }
    given = {name: np.asarray(value) if name in fields else value for name, value in given.items()}
    return Balance(
        node=node,
        conductance=np.broadcast_to(np.asarray(conductance, np.float64), channels).copy(),
        weight=WEIGHT * (at[node[:, 0], 1] - at[node[:, 1], 1]),
        **(fields | given),
    )
