"""Conditions of water at the nodes of a network: heads, wells, rain, faces in air.

Boundaries are lines; the outer nodes on them belong to them.  Outer nodes of no boundary give
water off where the rock is bare, and are tight on the left, right and bottom side of the model.
Without gravity all of them are tight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from clast.model.arrays import Bools, Floats, Ints, no_bools, no_floats, no_ints
from clast.model.flow.balance import GIVEN, INNER, SEEPAGE
from clast.model.flow.channels import Network
from clast.model.flow.given import (
    FLUX,
    HEAD,
    PRESSURE,
    RAIN,
    RANK,
    RATE,
    SEEPS,
    Flow,
    FlowBoundary,
)
from clast.model.model import Model


@dataclass(frozen=True, kw_only=True, repr=False)
class Conditions:
    """The conditions at the m nodes of a network, as in ``balance.Balance``."""

    kind: Ints = no_ints()
    """INNER, GIVEN or SEEPAGE, shape (m,)."""
    pressure: Floats = no_floats()
    """Pressure at GIVEN and SEEPAGE nodes, Pa, shape (m,)."""
    inflow: Floats = no_floats()
    """Water put in, m2/s, shape (m,)."""
    part: Ints = no_ints()
    """Which of ``Flow.names`` a node belongs to, -1 for none, shape (m,)."""
    outer: Bools = no_bools()
    """Which nodes are outer, shape (m,)."""

    def same(self, other: Conditions) -> bool:
        """Return whether water does the same at all nodes."""
        mine = (self.kind, self.pressure, self.inflow)
        return all(map(np.array_equal, mine, (other.kind, other.pressure, other.inflow)))

    def __repr__(self) -> str:
        return f"Conditions(of {len(self.kind)} nodes)"


def conditions_of(model: Model, network: Network, faces: Floats, time: float) -> Conditions:
    """Return the conditions at the nodes of a network at a time, s.

    ``faces`` (r, 2, 2) are the parts of edges that no other block covers, m.
    """
    flow, count, height = model.flow, network.count, network.at[:, 1] + model.origin[1]
    if flow is None:
        return Conditions()
    kind, pressure = np.zeros(count, np.int64), np.zeros(count)
    inflow, part = np.zeros(count), np.full(count, -1)
    rank = np.full(count, -1)
    for number, one in enumerate(flow.boundaries):
        line = one.lines(model.absent)
        nodes = nodes_on(network, line)
        if one.kind in (FLUX, RAIN):
            on = faces[faces_on(faces, line)]
            inflow += one.value * _catchment(network, on, one.kind, nodes)
        mine = nodes[RANK[one.kind] > rank[nodes]]
        rank[mine], part[mine] = RANK[one.kind], number
        kind[mine], pressure[mine] = _at_boundary(flow, one, height[mine], time)
    _leave(flow, network, (kind, part))
    for number, well in enumerate(flow.wells, len(flow.boundaries)):
        if not well.begun:
            continue
        nodes = np.flatnonzero(_near(network, well.at))
        part[nodes] = number
        if well.kind == RATE:
            inflow[nodes] += well.value / max(len(nodes), 1)
            continue
        kind[nodes] = SEEPAGE if well.only_outflow else GIVEN
        head = flow.weight * (well.value - height[nodes])
        if not flow.confined:
            head = np.maximum(head, 0.0)
        pressure[nodes] = head if well.kind == HEAD else well.value
    return Conditions(kind=kind, pressure=pressure, inflow=inflow, part=part, outer=network.outer)


def nodes_on(network: Network, line: Floats) -> Ints:
    """Return the outer nodes on straight lines (s, 2, 2), m, shape (q,)."""
    if not len(line):
        return np.zeros(0, np.int64)
    outer = np.flatnonzero(network.outer)
    lines = shapely.STRtree(shapely.linestrings(line))
    points = shapely.points(network.at[outer])
    found = lines.query(points, predicate="dwithin", distance=2.0 * network.near[outer])[0]
    return outer[np.unique(found)]


def _at_boundary(flow: Flow, one: FlowBoundary, height: Floats, time: float) -> tuple[Ints, Floats]:
    """Return kind and pressure, Pa, of nodes at ``height`` (q,), m, of a boundary."""
    count, none = len(height), np.zeros(len(height))
    if one.kind == HEAD:
        head = flow.weight * (one.at(time) - height)
        under = (head >= 0.0) | flow.confined
        above = SEEPAGE if one.seeps_above else INNER
        return np.where(under, GIVEN, above), np.where(under, head, 0.0)
    if one.kind == PRESSURE:
        return np.full(count, GIVEN), none + one.value
    seeps = one.kind in (SEEPS, RAIN)
    return np.full(count, SEEPAGE if seeps else INNER), none


def _leave(flow: Flow, network: Network, marks: tuple[Ints, Ints]) -> None:
    """Write kind and part of outer nodes of no boundary."""
    kind, part = marks
    rest = np.flatnonzero(network.outer & (part < 0))
    x, y = network.at[rest].T
    near = 2.0 * network.near[rest]
    left, right, bottom = flow.sides
    side = (np.abs(x - left) <= near) | (np.abs(x - right) <= near) | (np.abs(y - bottom) <= near)
    tight = side | flow.confined
    kind[rest] = np.where(tight, INNER, SEEPAGE)
    part[rest] = len(flow.boundaries) + len(flow.wells) + tight


def _near(network: Network, at: Floats) -> Bools:
    """Return which nodes lie at places (d, 2), m, shape (m,)."""
    from scipy.spatial import KDTree

    return np.asarray(KDTree(at).query(network.at)[0] <= 2.0 * network.near)


def _catchment(network: Network, faces: Floats, kind: str, nodes: Ints) -> Floats:
    """Return the length of ``faces`` (r, 2, 2) from which water comes to nodes, m, shape (m,).

    Of rain it is that on the horizontal of faces that look up.  Each half of a face belongs to the
    nearest node of the boundary.
    """
    from scipy.spatial import KDTree

    length = np.zeros(network.count)
    if not len(faces) or not len(nodes):
        return length
    line = faces[:, 1] - faces[:, 0]
    # faces run with their block to the left: one that looks up runs to the left
    wide = np.maximum(-line[:, 0], 0.0) if kind == RAIN else np.hypot(*line.T)
    halves = np.concatenate([faces[:, 0] + 0.25 * line, faces[:, 1] - 0.25 * line])
    nearest = nodes[KDTree(network.at[nodes]).query(halves)[1]]
    np.add.at(length, nearest, 0.5 * np.concatenate([wide, wide]))
    return length


ALONG = 1e-6
"""A face lies on a line whose distance from it is less than this share of all faces' extent."""


def faces_on(faces: Floats, line: Floats) -> Ints:
    """Return the faces (r, 2, 2) whose ends and middle lie on straight lines (s, 2, 2), m."""
    if not len(line) or not len(faces):
        return np.zeros(0, np.int64)
    near = ALONG * float(np.hypot(*np.ptp(faces.reshape(-1, 2), axis=0)))
    lines = shapely.multilinestrings(shapely.linestrings(line))
    shapely.prepare(lines)
    at = np.concatenate([faces, faces.mean(axis=1, keepdims=True)], axis=1)
    beside = shapely.dwithin(shapely.points(at), lines, near)
    return np.flatnonzero(beside.all(axis=1))
