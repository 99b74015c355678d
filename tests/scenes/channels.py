"""Networks of channels by hand and at random, without blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial import Delaunay

from clast.model.arrays import Floats, Ints
from clast.model.flow.balance import GIVEN, INNER, SEEPAGE, Balance, Solved

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
    given = {
        name: np.asarray(value, fields[name].dtype) if name in fields else value
        for name, value in given.items()
    }
    return Balance(
        node=node,
        conductance=np.broadcast_to(np.asarray(conductance, np.float64), channels).copy(),
        weight=WEIGHT * (at[node[:, 0], 1] - at[node[:, 1], 1]),
        **(fields | given),
    )


@dataclass(frozen=True)
class Drawn:
    """A network drawn at random."""

    at: Floats
    """Places of its nodes, m, shape (m, 2)."""
    balance: Balance
    lowered: Balance
    """The same, with lower heads and no rain."""

    @property
    def highest(self) -> float:
        """Return the highest head that water can have, m."""
        height, balance = self.at[:, 1], self.balance
        heads = (balance.pressure / WEIGHT + height)[balance.kind == GIVEN]
        rained = height[balance.inflow > 0.0]
        return float(np.concatenate([heads, rained, [height.mean()]]).max())


def drawn(seed: int) -> Drawn:
    """Return a random network: 12 to 200 nodes, some level with others, and closed ends.

    Conductances lie within four decades.  There are heads, faces with and without rain, and pumps.
    """
    random = np.random.default_rng(seed)
    count = int(10 ** random.uniform(1.1, 2.3))
    at = random.random((count, 2)) * (20.0, 10.0)
    level = random.random(count) < random.choice([0.0, 0.3])
    at[level, 1] = np.round(at[level, 1])
    corners = Delaunay(at + 1e-6 * random.random(at.shape)).simplices
    sides = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    sides = np.unique(sides, axis=0)
    node = sides[random.random(len(sides)) < random.uniform(0.4, 0.9)]
    node = node[random.permutation(len(node))]
    turned = random.random(len(node)) < 0.5
    node[turned] = node[turned, ::-1]
    kind = random.choice([INNER, GIVEN, SEEPAGE], count, p=[0.8, 0.08, 0.12])
    kind[np.argmin(at[:, 1])] = SEEPAGE
    spread = random.choice([0.0, 2.0])
    conductance = 1e-10 * 10.0 ** random.uniform(-spread, spread, len(node))
    head = random.uniform(0.0, 12.0, count)
    pressure = np.where(kind == GIVEN, WEIGHT * np.maximum(head - at[:, 1], 0.0), 0.0)
    inflow = 1e-6 * 10.0 ** random.uniform(-2.0, 1.0, count) * (random.random(count) < 0.5)
    pumps = np.where(random.random(count) < 0.03, -1e-6 * random.random(count), 0.0)
    volume = np.bincount(node.ravel(), minlength=count) * 1e-4 + 1e-6
    balance = network(
        at=at,
        node=node,
        conductance=conductance,
        kind=kind,
        pressure=pressure,
        inflow=np.where(kind == SEEPAGE, inflow, np.where(kind == INNER, pumps, 0.0)),
        volume=volume,
    )
    lowered = replace(
        balance, pressure=0.3 * balance.pressure, inflow=np.minimum(balance.inflow, 0.0)
    )
    return Drawn(at, balance, lowered)


def renumbered(balance: Balance, order: Ints, channels: Ints) -> Balance:
    """Return the same balance with nodes and channels in another order, (m,) and (k,)."""
    new = np.empty(len(order), np.int64)
    new[order] = np.arange(len(order))
    of_nodes = ("kind", "pressure", "inflow", "volume", "opened")
    return replace(
        balance,
        node=new[balance.node[channels]],
        conductance=balance.conductance[channels],
        weight=balance.weight[channels],
        **{name: getattr(balance, name)[order] for name in of_nodes},
    )


def in_pieces(balance: Balance, pieces: int) -> Balance:
    """Return the same network with each channel in pieces; new nodes come after those of old."""
    count, channels = len(balance.kind), len(balance.node)
    between = count + np.arange(channels * (pieces - 1)).reshape(channels, pieces - 1)
    chain = np.concatenate([balance.node[:, :1], between, balance.node[:, 1:]], axis=1)
    new = channels * (pieces - 1)
    more = {
        name: np.concatenate([getattr(balance, name), np.zeros(new, getattr(balance, name).dtype)])
        for name in ("kind", "pressure", "inflow", "volume", "opened")
    }
    return replace(
        balance,
        node=np.stack([chain[:, :-1], chain[:, 1:]], axis=2).reshape(-1, 2),
        conductance=np.repeat(balance.conductance * pieces, pieces),
        weight=np.repeat(balance.weight / pieces, pieces),
        **more,
    )


def out_of_balance(balance: Balance, solved: Solved) -> float:
    """Return by how much the steady balance of a node is out, as a share of the throughput.

    Flows are reckoned here from the law of channels, channel by channel.
    """
    left = -balance.inflow - solved.missing - solved.given + solved.outflow + solved.runoff
    left[balance.kind == GIVEN] = -solved.given[balance.kind == GIVEN]
    pressure, saturation = solved.pressure, solved.saturation
    for (one, other), conductance, weight in zip(
        balance.node.tolist(), balance.conductance, balance.weight, strict=True
    ):
        up, low = (one, other) if weight >= 0.0 else (other, one)
        drop = abs(weight)
        flow = conductance * (pressure[up] + min(saturation[up] * drop, drop - pressure[low]))
        left[up] += flow
        left[low] -= flow
    return float(np.abs(left).max() / solved.throughput)
