"""The balance of water in a network of channels, and the law of a channel.

From its upper node u to its lower node l, with G = rho g (y_u - y_l) >= 0, a channel carries

    q = C (p_u + min(s_u G, G - p_l)),  p >= 0,  0 <= s <= 1,  p (1 - s) = 0.

Saturated this is C (p_u + G - p_l).  Below a dry node s is the share of its capacity with which
water runs down, and a column that stands in the channel does not flow.  At every node

    sum of q out + R + (V (s - s0) + V s (p - p0)/K + s0 (V - V0))/h = Q,  R >= 0,

with the outflow R of faces, where p <= the pressure there, the inflow Q from wells and rain, and
the volume V of the joints at the node.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clast.model.arrays import Bools, Floats, Ints

INNER = 0
"""Kind of a node whose inflow leaves along other channels, or is stored."""
GIVEN = 1
"""Kind of a node whose pressure is given: a head, or a well with a pressure."""
SEEPAGE = 2
"""Kind of a node that gives water off at its pressure, and takes none: a face in air, a drain."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Balance:
    """A network of k channels between m nodes, and the conditions and storage at the nodes."""

    node: Ints
    """First and second node of each channel, shape (k, 2)."""
    conductance: Floats
    """Flow of each channel by difference of pressure, m2/(s Pa), above 0, shape (k,)."""
    weight: Floats
    """Weight of the water from its second up to its first node, rho g (y0 - y1), Pa, shape (k,)."""
    kind: Ints
    """INNER, GIVEN or SEEPAGE, shape (m,)."""
    pressure: Floats
    """Pressure at GIVEN nodes, and that at which SEEPAGE nodes give water off, Pa, shape (m,)."""
    inflow: Floats
    """Inflow from rain and wells, m2/s; negative: the demand of pumps; shape (m,).

    A pump takes the share s of its demand: all of it while its node is saturated.
    """
    volume: Floats
    """Volume of the joints at each node at the end of the step, m2, shape (m,)."""
    opened: Floats
    """By how much it has grown in the step, m2, shape (m,)."""
    bulk_modulus: float = 2e9
    """Bulk modulus of water, Pa."""
    confined: bool = False
    """Whether all joints are full: p may be negative, s is 1, and the balance is linear."""

    @cached_property
    def upper(self) -> Ints:
        """Upper node of each channel, the first where both are level, shape (k,)."""
        return np.where(self.weight >= 0.0, self.node[:, 0], self.node[:, 1])

    @cached_property
    def lower(self) -> Ints:
        """Lower node of each channel, shape (k,)."""
        return np.where(self.weight >= 0.0, self.node[:, 1], self.node[:, 0])

    @cached_property
    def drop(self) -> Floats:
        """Weight of the water from the lower up to the upper node, Pa, 0 or more, shape (k,)."""
        return np.abs(self.weight)

    @property
    def free(self) -> Bools:
        """True where the pressure is not given, shape (m,)."""
        return np.asarray(self.kind != GIVEN)

    def __repr__(self) -> str:
        return f"Balance({len(self.node)} channels between {len(self.kind)} nodes)"


@dataclass(frozen=True, kw_only=True, repr=False)
class Solved:
    """Water in a network, with its inflow and outflow; rates in m2/s."""

    pressure: Floats
    """Pressure at the nodes, Pa, shape (m,)."""
    saturation: Floats
    """Share of the capacity with which water runs down from a node, 1: full, shape (m,)."""
    flow: Floats
    """Flow in each channel from its first to its second node, shape (k,)."""
    given: Floats
    """Inflow at GIVEN nodes, below 0: outflow, shape (m,)."""
    outflow: Floats
    """Outflow from the joints at SEEPAGE nodes, 0 or more, shape (m,)."""
    runoff: Floats
    """Part of the inflow Q at SEEPAGE nodes that cannot enter, 0 or more, shape (m,)."""
    missing: Floats
    """Unmet demand of pumps, 0 or more, shape (m,)."""
    stored: float
    """Rate of storage, 0 in steady flow."""
    unaccounted: float
    """Inflow less outflow and storage, not 0 by rounding alone."""
    throughput: float
    """All that comes in, or 1e-3 C p of a channel where that is larger: measure of the above."""
    iterations: int
    """Linear systems that were solved."""

    def __repr__(self) -> str:
        wet = int((self.pressure > 0.0).sum())
        return f"Solved({wet} of {len(self.pressure)} nodes under pressure)"
