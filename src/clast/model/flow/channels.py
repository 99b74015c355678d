"""Channels of water between nodes, and where they are while blocks move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.arrays import Bools, Floats, Ints, connected


@dataclass(frozen=True, kw_only=True, repr=False)
class Network:
    """Channels of water between nodes: k channels, m nodes, numbered by blocks and edges."""

    node: Ints
    """Nodes at the ends of each channel, shape (k, 2)."""
    at: Floats
    """Places of the nodes about the model's origin, m, shape (m, 2)."""
    length: Floats
    """Length of each channel, m, shape (k,)."""
    block: Ints
    """Blocks on either side, to the left first, shape (k, 2)."""
    edge: Ints
    """Their edges, shape (k, 2)."""
    share: Floats
    """Where either face, (k, face), begins and ends as the first one runs, shape (k, 2, 2)."""
    joint: Ints
    """Joint of each channel: index into those of the model, shape (k,)."""
    outer: Bools
    """True for nodes on faces that no other block covers, shape (m,)."""
    near: Floats
    """How near to each other places are one, by node, m, shape (m,)."""
    face_edge: Ints
    """Edge of each part that no other block covers, shape (r,)."""
    face_share: Floats
    """Where it begins and ends, shape (r, 2)."""

    @property
    def count(self) -> int:
        """Number of nodes m."""
        return len(self.at)

    @property
    def middle(self) -> Floats:
        """Middle of each channel about the model's origin, m, shape (k, 2)."""
        return np.asarray(self.at[self.node].mean(axis=1))

    @property
    def parts(self) -> Ints:
        """The connected part of each node, numbered from 0, shape (m,)."""
        return connected(self.node[:, 0], self.node[:, 1], self.count)

    def __repr__(self) -> str:
        return f"Network({len(self.length)} channels between {self.count} nodes)"


def faces_at(network: Network, vertices: Floats, after: Ints) -> Floats:
    """Return the ends of either face of channels at ``vertices`` (nv, 2), m, (k, face, end, 2)."""
    first, last = vertices[network.edge], vertices[after[network.edge]]
    return np.asarray(first[:, :, None] + network.share[..., None] * (last - first)[:, :, None])
