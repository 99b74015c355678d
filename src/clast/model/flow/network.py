"""The network of channels in which water flows: lengths along which two blocks lie.

Blocks are impermeable.  Ends of channels that lie together are one node.  Joints without aperture,
welds and linings make no channels; linings do not hold water back either.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.model.arrays import Bools, Floats, Ints
from clast.model.drainage import nodes_of, parts_between
from clast.model.edges import Edges, Facing, edges_of, facing_edges, outer_parts
from clast.model.flow.channels import Network as Network
from clast.model.joints import JointTable
from clast.model.model import Model


def network_of(model: Model, longest: float = np.inf, points: Floats | None = None) -> Network:
    """Return the network of a model without its absent blocks.

    Channels longer than ``longest``, m, are divided, and all at ``points`` (d, 2) that lie on them,
    m, about the model's origin: wells.
    """
    vertices, owner, after = model.vertices, model.vertex_block, model.vertex_after
    edges = edges_of(vertices, after, owner, model.area)
    facing = facing_edges(edges)
    there = ~(model.absent | model.lined)[owner]
    both = there[facing.edge].all(axis=1)
    facing = Facing(facing.edge[both], facing.share[both])
    face_edge, face_share = outer_parts(edges, facing)
    bare = there[face_edge]
    joint = joints_along(model.joint_table, model.block_rock, model.edge_joint, edges, facing)
    wet = model.joint_table.conducts[joint]
    facing, joint = Facing(facing.edge[wet], facing.share[wet]), joint[wet]
    near = edges.near[facing.edge].min(axis=1)
    if points is not None and len(points):
        facing, row = _divided(facing, *parts_between(_ends(edges, facing), near, points))
        joint, near = joint[row], near[row]
    network = _joined(edges, facing, joint, near)
    network = replace(network, face_edge=face_edge[bare], face_share=face_share[bare])
    network = replace(network, outer=_on_faces(network, edges))
    return network if longest == np.inf else _pieces(network, longest)


def joints_along(
    table: JointTable, block_rock: Ints, edge_joint: Ints, edges: Edges, facing: Facing
) -> Ints:
    """Return the joint of parts of edges that lie along each other, shape (k,).

    That of a pair of blocks before that of edges, and this before a pair of rocks and the default.
    """
    joint, named = table.of_pairs(block_rock, edges.owner[facing.edge])
    first, second = edge_joint[facing.edge].T
    along = np.where(first >= 0, first, second)
    return np.asarray(np.where(named | (along < 0), joint, along))


def _ends(edges: Edges, facing: Facing) -> Floats:
    """Return the ends of channels halfway between their faces, m, shape (k, 2, 2)."""
    first, last = edges.vertices[facing.edge], edges.vertices[edges.after[facing.edge]]
    faces = first[:, :, None] + facing.share[..., None] * (last - first)[:, :, None]
    return np.asarray(0.5 * (faces[:, 0] + faces[:, 1]))


def _divided(facing: Facing, row: Ints, share: Floats) -> tuple[Facing, Ints]:
    """Return parts ``share`` (r, 2) of the channels ``row`` (r,), and these."""
    width = facing.share[row, :, 1:] - facing.share[row, :, :1]
    parts = facing.share[row, :, :1] + width * share[:, None]
    return Facing(facing.edge[row], parts), row


def _joined(edges: Edges, facing: Facing, joint: Ints, near: Floats) -> Network:
    """Return channels with ends that lie together as nodes, and no outer ones yet."""
    ends = _ends(edges, facing)
    points, reach = ends.reshape(-1, 2), np.repeat(near, 2)
    node = nodes_of(points, reach) if len(points) else np.zeros(0, np.int64)
    count = int(node.max(initial=-1)) + 1
    times = np.bincount(node, minlength=count)
    at = np.stack([np.bincount(node, one, count) / times for one in points.T], axis=1)
    wide = np.zeros(count)
    np.maximum.at(wide, node, reach)
    node = node.reshape(-1, 2)
    kept = node[:, 0] != node[:, 1]
    return Network(
        node=node[kept],
        at=at,
        length=np.hypot(*(ends[kept, 1] - ends[kept, 0]).T),
        block=edges.owner[facing.edge[kept]],
        edge=facing.edge[kept],
        share=facing.share[kept],
        joint=joint[kept],
        outer=np.zeros(count, np.bool_),
        near=wide,
        face_edge=np.zeros(0, np.int64),
        face_share=np.zeros((0, 2)),
    )


def _on_faces(network: Network, edges: Edges) -> Bools:
    """Return which nodes lie where outer faces end, shape (m,).

    Faces end where a joint comes out: an edge is of one block.
    """
    from scipy.spatial import KDTree

    first = edges.vertices[network.face_edge]
    line = edges.vertices[edges.after[network.face_edge]] - first
    ends = first[:, None] + network.face_share[..., None] * line[:, None]
    if not len(ends) or not network.count:
        return np.zeros(network.count, np.bool_)
    # the mean of places that are one lies up to that distance from each
    return np.asarray(KDTree(ends.reshape(-1, 2)).query(network.at)[0] <= 2.0 * network.near)


def _pieces(network: Network, longest: float) -> Network:
    """Return the network with channels divided into equal pieces of at most ``longest``, m."""
    # a channel as long as the longest is not divided for its last digit
    pieces = np.maximum(1, np.ceil(network.length / longest - 1e-9).astype(np.int64))
    row = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(row)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    share = np.stack([number, number + 1], axis=1) / pieces[row, None]
    new = network.count + (np.cumsum(pieces - 1) - (pieces - 1))[row] + number
    ends = network.node[row]
    last = number == pieces[row] - 1
    node = np.stack(
        [np.where(number == 0, ends[:, 0], new - 1), np.where(last, ends[:, 1], new)], axis=1
    )
    first, second = network.at[ends[:, 0]], network.at[ends[:, 1]]
    between = (first + share[:, 1:] * (second - first))[~last]
    facing, _ = _divided(Facing(network.edge, network.share), row, share)
    added = len(between)
    return replace(
        network,
        node=node,
        at=np.concatenate([network.at, between]),
        length=(network.length / pieces)[row],
        block=network.block[row],
        edge=facing.edge,
        share=facing.share,
        joint=network.joint[row],
        outer=np.concatenate([network.outer, np.zeros(added, np.bool_)]),
        near=np.concatenate([network.near, network.near[ends].min(axis=1)[~last]]),
    )
