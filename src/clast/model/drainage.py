"""How drains lower the head of water in joints.

Water stands in joints up to its level unless it can run out.  Where points are drained, the head
falls towards them along the joints as it does in a network of pipes of one width: with l the
lowering of the head below the water level, s the distance along a joint,

    d2 l/ds2 = 0 in joints, sum of dl/ds = 0 where they meet, l = y_w - y (no pressure) at drains, l
    = 0 at the sources of the water.

It comes from the water level itself; through the ends of the joints that are not drained; and
through cracks: a joint that the level cuts stands full down to where it first bends or meets
another.  One plane below such a crack, drained at its toe, has the pressures of Hoek & Bray: that
of the crack at its foot, falling linearly along the plane to none at the toe.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from clast.model.arrays import Bools, Floats, Ints, connected
from clast.model.water import Water, surface_at

STRAIGHT = float(np.cos(np.radians(20.0)))
"""Cosine of the bend up to which a crack goes on."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """Joints as a network: k joints between m nodes."""

    node: Ints
    """Nodes at the ends of each joint, shape (k, 2)."""
    length: Floats
    """Length of each joint, m, shape (k,)."""
    along: Floats
    """Unit vector from its first to its last end, shape (k, 2)."""
    depth: Floats
    """Depth of its ends below the water level, m, negative above it, shape (k, 2)."""
    at_drain: Bools
    """True for nodes at drains, shape (m,)."""
    drained: Bools
    """True for those that take water, shape (m,)."""

    @property
    def wet(self) -> Ints:
        """Joints that have an end under water, shape (q,)."""
        return np.flatnonzero((self.depth > 0.0).any(axis=1))

    @property
    def deep(self) -> Floats:
        """Depth of every node, m, shape (m,)."""
        depth = np.zeros(len(self.drained))
        depth[self.node] = self.depth
        return depth


def drained(water: Water, absent: Bools) -> Water:
    """Return a water with the head that its drains leave while blocks are ``absent`` (n,).

    Joints of an excavated opening that drains are part of the void: there is no pressure in them,
    nor where others meet them.
    """
    joints = water.joints
    void = np.asarray(((joints.drain >= 0) & absent[joints.drain]).any(axis=1))
    lowered = np.zeros(joints.ends.shape[:2])
    lowered[void] = (surface_at(water.surface, joints.ends[..., 0]) - joints.ends[..., 1])[void]
    drains = np.concatenate([water.drain_at, joints.ends[void].reshape(-1, 2)])
    pipes = joints.conducts & ~void
    if len(drains) and pipes.any():
        lowered[pipes] = lowering(joints.ends[pipes], joints.near[pipes], water.surface, drains)
    return replace(water, joints=replace(joints, lowered=lowered))


def places_on(line: Floats, ends: Floats, near: Floats) -> Floats:
    """Return where joints meet a line (c, 2): their ends on it and where they cross, m, (d, 2).

    ``ends`` (k, 2, 2) are those of the joints, m, which count when nearer than ``near`` (k,), m.
    """
    drain = shapely.linestrings(line)
    joints = shapely.linestrings(ends)
    on_line = shapely.distance(shapely.points(ends), drain) <= near[:, None]
    crossing = ~on_line.any(axis=1) & shapely.intersects(joints, drain)
    crossings = shapely.get_coordinates(shapely.intersection(joints[crossing], drain))
    return np.concatenate([ends[on_line], crossings])


def parts_between(ends: Floats, near: Floats, drains: Floats) -> tuple[Ints, Floats]:
    """Return the parts of joints between drains: joint (r,), share (r, 2).

    ``ends`` (k, 2, 2) are those of the joints, m, ``drains`` (d, 2) the points, which count for
    joints nearer than ``near`` (k,), m.
    """
    place, beside = _measured(ends, drains)
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    margin = (near / length)[:, None]
    inside = (beside <= near[:, None]) & (place > margin) & (place < 1.0 - margin)
    joint, drain = np.nonzero(inside)
    every = np.arange(len(ends))
    line = np.concatenate([every, joint, every])
    share = np.concatenate([np.zeros(len(ends)), place[joint, drain], np.ones(len(ends))])
    order = np.lexsort((share, line))
    line, share = line[order], share[order]
    same = (line[1:] == line[:-1]) & (share[1:] > share[:-1])
    return line[1:][same], np.stack([share[:-1], share[1:]], axis=1)[same]


def distances(ends: Floats, drains: Floats) -> Floats:
    """Return the distance of points (d, 2) from the nearest joint (k, 2, 2), m, shape (d,)."""
    return np.asarray(_measured(ends, drains)[1].min(axis=0, initial=np.inf))


def lowering(ends: Floats, near: Floats, surface: Floats, drains: Floats) -> Floats:
    """Return by how much drains lower the head at the ends of joints, m, shape (k, 2).

    ``ends`` (k, 2, 2) are those of the joints, divided where drains lie in them; ``near`` (k,), m,
    is how near to each other ends are one; ``surface`` (m, 2) is the phreatic line.
    """
    network = _network(ends, near, surface, drains)
    fixed = network.drained | _fed(network)
    level = _solved(network, fixed, network.drained)
    # a drain takes water, or lies above what the others leave and has no pressure: by turns, which
    # ends for equations like these (Hintermueller, Ito & Kunisch 2002)
    for _ in range(len(drains)):
        # Flow that is none, as a share of that of the whole lowering along the shortest joint
        none = 1e-9 * float(level.max())
        takes = _outflow(network, level) >= -none / float(network.length.min())
        presses = network.deep - level > none
        drained = network.at_drain & np.where(network.drained, takes, presses)
        if (drained == network.drained).all():
            break
        network = replace(network, drained=drained)
        level = _solved(network, drained | _fed(network), drained)
    lowered = level[network.node]
    for dry in (0, 1):  # a joint that the level cuts: no pressure there
        cut = (network.depth[:, dry] <= 0.0) & (network.depth[:, 1 - dry] > 0.0)
        share = np.minimum(1.0, lowered[cut, 1 - dry] / network.depth[cut, 1 - dry])
        lowered[cut, dry] = share * network.depth[cut, dry]
    return np.asarray(lowered)


def nodes_of(points: Floats, reach: Floats) -> Ints:
    """Return the node of each point (k, 2): those nearer than either's ``reach``, m, share one."""
    from scipy.spatial import KDTree  # slow to load, and few cases need it

    one, other = KDTree(points).query_pairs(float(reach.max()), output_type="ndarray").T
    apart = np.hypot(*(points[one] - points[other]).T)
    same = apart <= np.minimum(reach[one], reach[other])
    return connected(one[same], other[same], len(points))


def _measured(ends: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return where on each joint each point has its foot, and its distance, m, (k, d) each."""
    line = ends[:, 1] - ends[:, 0]
    away = points[None] - ends[:, None, 0]
    place = np.clip((away * line[:, None]).sum(axis=2) / (line**2).sum(axis=1)[:, None], 0.0, 1.0)
    gap = away - place[..., None] * line[:, None]
    return place, np.hypot(gap[..., 0], gap[..., 1])


def _network(ends: Floats, near: Floats, surface: Floats, drains: Floats) -> Network:
    """Return the joints as a network; ends that lie together are one node."""
    points = np.concatenate([ends.reshape(-1, 2), drains])
    node = nodes_of(points, np.concatenate([np.repeat(near, 2), np.full(len(drains), near.max())]))
    drained = np.zeros(node.max() + 1, np.bool_)
    drained[node[2 * len(ends) :]] = True
    line = ends[:, 1] - ends[:, 0]
    length = np.hypot(*line.T)
    return Network(
        node=node[: 2 * len(ends)].reshape(-1, 2),
        length=length,
        along=line / length[:, None],
        depth=surface_at(surface, ends[..., 0]) - ends[..., 1],
        at_drain=drained,
        drained=drained,
    )


def _fed(network: Network) -> Bools:
    """Return the nodes that water comes to from outside or through a crack, shape (m,)."""
    wet, deep = network.wet, network.deep
    degree = np.bincount(network.node[wet].ravel(), minlength=len(deep))
    fed = (degree == 1) & (deep > 0.0)
    cut = wet[(network.depth[wet] <= 0.0).any(axis=1)]
    meeting: dict[int, list[int]] = {}
    for joint in wet.tolist():
        for node in network.node[joint].tolist():
            meeting.setdefault(node, []).append(joint)
    for joint in cut.tolist():
        fed[_foot(network, joint, meeting)] = True
    return np.asarray(fed & ~network.at_drain)


def _foot(network: Network, joint: int, meeting: dict[int, list[int]]) -> int:
    """Return the node where a crack that the level cuts bends, meets another joint, or ends."""
    side = int(network.depth[joint, 1] > 0.0)
    while True:
        node = int(network.node[joint, side])
        others = [one for one in meeting[node] if one != joint]
        if network.at_drain[node] or len(others) != 1:
            return node
        ahead = network.along[joint] if side else -network.along[joint]
        joint = others[0]
        side = int(network.node[joint, 0] == node)
        on = network.along[joint] if side else -network.along[joint]
        if ahead @ on < STRAIGHT:
            return node
        if network.depth[joint, side] <= 0.0:
            return node  # up to the level again


def _solved(network: Network, fixed: Bools, drained: Bools) -> Floats:
    """Return the lowering at every node, m, shape (m,): 0 where no drain is connected."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    one, other, conducts, to_level = _pipes(network)
    count = len(fixed)
    level = np.where(drained, np.maximum(network.deep, 0.0), 0.0)
    links = coo_array((conducts, (one, other)), shape=(count, count)).tocsr()
    links = links + links.T
    part = connected(one, other, count)
    reached = np.zeros(count, np.bool_)
    reached[part[drained]] = True
    free = np.flatnonzero(reached[part] & ~fixed)
    if len(free):
        sums = np.asarray(links.sum(axis=1)).ravel() + to_level
        matrix = (diags_array(sums) - links).tocsr()[free]
        known = np.flatnonzero(fixed)
        level[free] = spsolve(matrix[:, free].tocsc(), -matrix[:, known] @ level[known])
    return level


def _outflow(network: Network, level: Floats) -> Floats:
    """Return the outflow of every node, in head by length, shape (m,)."""
    one, other, conducts, to_level = _pipes(network)
    outflow = to_level * level
    np.add.at(outflow, one, conducts * (level[one] - level[other]))
    np.add.at(outflow, other, conducts * (level[other] - level[one]))
    return np.asarray(outflow)


def _pipes(network: Network) -> tuple[Ints, Ints, Floats, Floats]:
    """Return the joints under water: nodes and 1/length, and 1/length up to the level (m,)."""
    wet = network.wet
    depth, node, length = network.depth[wet], network.node[wet], network.length[wet]
    under = (depth > 0.0).all(axis=1)
    to_level = np.zeros(len(network.drained))
    cut = np.flatnonzero(~under)
    side = (depth[cut, 1] > 0.0).astype(np.int64)
    deep, high = depth[cut, side], depth[cut, 1 - side]
    np.add.at(to_level, node[cut, side], (deep - high) / (deep * length[cut]))
    return node[under, 0], node[under, 1], 1.0 / length[under], to_level
