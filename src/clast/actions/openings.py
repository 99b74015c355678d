"""How channels and their nodes open when the blocks beside them move.

Between two straight faces the opening is linear, g = (1 - s) g_0 + s g_1, and so is the pressure.
So a node takes L/3 of the opening at its own end of a channel and L/6 of that at the other one, and
pressures push blocks by the same numbers: their work on blocks is pressure times opening of nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.block.displacement import basis
from clast.model.arrays import Floats, Ints
from clast.model.flow.channels import Network, faces_at


def gap_rows(network: Network, vertices: Floats, after: Ints, centroid: Floats) -> Any:
    """Return by how much channels open at their ends by d, sparse, (2 k, 6 n): first, last, ...

    With blocks at ``vertices`` (nv, 2) and ``centroid`` (n, 2), m.
    """
    from scipy.sparse import csr_array

    ends = faces_at(network, vertices, after).mean(axis=1)
    line = ends[:, 1] - ends[:, 0]
    along = line / np.hypot(*line.T)[:, None]
    # the first block lies to the left of the channel
    away = np.stack([-along[:, 1], along[:, 0]], axis=1)
    count, rows = len(ends), []
    for side, sign in ((0, 1.0), (1, -1.0)):
        offset = ends - centroid[network.block[:, side]][:, None]
        every = basis(offset.reshape(-1, 2)).reshape(count, 2, 2, 6)
        rows.append(sign * np.einsum("kx,kexd->ked", away, every))
    value = np.concatenate(rows, axis=2).ravel()
    column = 6 * network.block[:, None, :, None] + np.arange(6)
    column = np.broadcast_to(column, (count, 2, 2, 6)).ravel()
    first = np.arange(0, 24 * count + 1, 12)
    return csr_array((value, column, first), shape=(2 * count, 6 * len(centroid)))


def shares_of_nodes(network: Network, length: Floats) -> Any:
    """Return the share of nodes in the openings of the ends of channels, m, sparse, (m, 2 k).

    ``length`` (k,) is that of the channels, m.
    """
    from scipy.sparse import coo_array

    end = np.arange(2 * len(length))
    own, width = network.node.ravel(), np.repeat(length, 2)
    value = np.concatenate([width / 3.0, width / 6.0])
    place = np.concatenate([own, own]), np.concatenate([end, end ^ 1])
    return coo_array((value, place), shape=(network.count, len(end))).tocsr()


def lengths_at(network: Network, vertices: Floats, after: Ints) -> Floats:
    """Return the lengths of channels with blocks at ``vertices`` (nv, 2), m, (k,)."""
    ends = faces_at(network, vertices, after).mean(axis=1)
    line = ends[:, 1] - ends[:, 0]
    return np.asarray(np.hypot(*line.T))
