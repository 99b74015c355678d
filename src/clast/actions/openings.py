"""How channels and their nodes open when the blocks beside them move.

Between two straight faces the opening is linear, g = (1 - s) g_0 + s g_1, and so is the aperture a.
Pressures push blocks by the shares that nodes take of openings, so that their work on blocks is
pressure times opening of nodes.  In even channels and dry ones these are linear, too: a node takes
L/3 of the opening at its own end of a channel and L/6 of that at the other one.  Water that flows
through a wedge loses its head where that is narrow, dp/ds ~ a^-3:

    p = p_0 + (p_1 - p_0) f,    f = (a_0^-2 - a^-2)/(a_0^-2 - a_1^-2)

With linear shares a joint that opens with its pressure closes at an outlet: 39 % of the flow are
missing where aperture falls to an eleventh along 20 blocks, with these 0.1 %.
"""

from __future__ import annotations

import numpy as np

from clast.block.displacement import basis
from clast.model.arrays import Floats, Ints
from clast.model.flow.channels import Network, faces_at

LINEAR = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
"""Shares of either node in the opening of either end of an even channel."""
NEARLY_EVEN = 0.1
"""Difference of apertures, as a share, up to which shares are found by Gauss's rule: to 1e-11."""
GAUSS = np.polynomial.legendre.leggauss(8)


def gap_rows(network: Network, vertices: Floats, after: Ints, centroid: Floats) -> Floats:
    """Return by how much channels open at their ends by d of their blocks, (k, end, side, 6).

    With blocks at ``vertices`` (nv, 2) and ``centroid`` (n, 2), m.
    """
    ends = faces_at(network, vertices, after).mean(axis=1)
    line = ends[:, 1] - ends[:, 0]
    along = line / np.hypot(*line.T)[:, None]
    # the first block lies to the left of the channel
    away = np.stack([-along[:, 1], along[:, 0]], axis=1)
    rows = []
    for side, sign in ((0, 1.0), (1, -1.0)):
        offset = ends - centroid[network.block[:, side]][:, None]
        every = basis(offset.reshape(-1, 2)).reshape(len(ends), 2, 2, 6)
        rows.append(sign * np.einsum("kx,kexd->ked", away, every))
    return np.stack(rows, axis=2)


def shares_in_wedges(aperture: Floats) -> Floats:
    """Return the share of either node in the opening of either end of channels, (k, end, node).

    ``aperture`` (k, 2), m, are those at their ends.
    """
    rise = aperture[:, 1] / aperture[:, 0] - 1.0
    even = np.abs(rise) < NEARLY_EVEN
    # the means of f and of s f
    first = (1.0 + rise) / (2.0 + rise)
    s, weight = 0.5 * (1.0 + GAUSS[0][:, None]), 0.5 * GAUSS[1]
    r = np.where(even, rise, 0.0)
    f = s * (2.0 + r * s) * (1.0 + r) ** 2 / ((2.0 + r) * (1.0 + r * s) ** 2)
    r = np.where(even, 1.0, rise)
    second = (0.5 - (np.log1p(r) - r / (1.0 + r)) / r**2) * (1.0 + r) ** 2 / (r * (2.0 + r))
    second = np.where(even, weight @ (s * f), second)
    of_ends = [[0.5 - first + second, first - second], [0.5 - second, second]]
    return np.asarray(np.transpose(np.array(of_ends), (2, 0, 1)))


def shares_of_wet_part(wet: Floats, dry: int) -> Floats:
    """Return the same of channels whose end ``dry``, 0 or 1, is, and ``wet`` (k,) the rest."""
    # hats of the full end end where the water does; what they leave is the dry end's
    near, far = 0.5 * wet - wet**2 / 6.0, wet**2 / 6.0
    of_full = np.stack([near, far], axis=1)
    both = np.stack([of_full, 0.5 - of_full], axis=2)
    return np.asarray(both if dry == 1 else both[:, ::-1, ::-1])


def volumes_of(network: Network, length: Floats, opening: Floats) -> Floats:
    """Return the volumes of nodes, m2, (m,), with ``opening`` (k, 2), m, of channels.

    ``length`` (k,) is that of the channels, m.
    """
    of_ends = length[:, None] * (opening @ LINEAR)
    volumes = np.bincount(network.node.ravel(), of_ends.ravel(), network.count)
    return np.asarray(volumes, np.float64)


def lengths_at(network: Network, vertices: Floats, after: Ints) -> Floats:
    """Return the lengths of channels with blocks at ``vertices`` (nv, 2), m, (k,)."""
    ends = faces_at(network, vertices, after).mean(axis=1)
    line = ends[:, 1] - ends[:, 0]
    return np.asarray(np.hypot(*line.T))
