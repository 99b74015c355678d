"""Edges that lie along each other, against a comparison of every edge with every other."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import clast
from clast.model import edges as edges_module
from clast.model.edges import CORNER_FRACTION, Edges, edges_of, facing_edges

CUT = """
[time]
end = 1.0
step = 1e-2
[rock.stone]
young = 5e9
poisson = 0.2
density = 2500
[joint.default]
[domain]
boundary = [[0, 0], [9, 0], [9, 6], [2, 7]]
smallest_block = 0.0
smallest_edge = 0.0
[[joint_set]]
name = "cross"
angle = {0}
spacing = 0.7
trace_length = 3.0
bridge_length = 1.0
[[joint_set]]
name = "bedding"
angle = {1}
spacing = 0.9
"""


def edges_in(model: clast.Model) -> Edges:
    return edges_of(model.vertices, model.vertex_after, model.vertex_block, model.area)


def turned(edges: Edges, angle: float) -> Edges:
    c, s = np.cos(angle), np.sin(angle)
    vertices = edges.vertices @ np.array([[c, s], [-s, c]])
    return Edges(vertices=vertices, after=edges.after, owner=edges.owner, near=edges.near)


def of_every_pair(edges: Edges) -> dict[tuple[int, int], list[float]]:
    """Return what two edges share, one pair after the other."""
    here, there = edges.vertices, edges.vertices[edges.after]
    lines = shapely.linestrings(np.stack([here, there], axis=1))
    found = {}
    for e in range(len(here)):
        for f in np.flatnonzero(shapely.distance(lines[e], lines) <= edges.near[e]).tolist():
            near = min(edges.near[e], edges.near[f])
            length = np.hypot(*(there[e] - here[e]))
            along = (there[e] - here[e]) / length
            low, high = (there[f] - here[e]) @ along, (here[f] - here[e]) @ along
            if edges.owner[e] >= edges.owner[f] or high <= low:
                continue
            first, last = max(low, 0.0), min(high, length)
            if last - first <= near:
                continue
            share = []
            for at in (first, last):
                other = (high - at) / (high - low)
                place = here[f] + other * (there[f] - here[f])
                share += [at / length, other]
                if np.hypot(*(place - here[e] - at * along)) > near:
                    break
            else:
                found[e, f] = share
    return found


@pytest.mark.parametrize("angles", [(0.0, 90.0), (33.0, 100.0)])
@pytest.mark.parametrize("askew", [0.0, 0.6])
def test_they_are_those_of_a_comparison_of_all_pairs(angles, askew, monkeypatch):
    monkeypatch.setattr(edges_module, "TOGETHER", 64)
    model = clast.Case.from_text(CUT.format(*angles), "case").model()
    edges = turned(edges_in(model), askew)
    facing = facing_edges(edges)
    known = of_every_pair(edges)
    assert len(known) > 100
    assert [tuple(one) for one in facing.edge.tolist()] == sorted(known)
    expected = np.array([known[one] for one in sorted(known)])
    got = facing.share.transpose(0, 2, 1).reshape(-1, 4)
    assert np.abs(got - expected).max() < 1e-12 + CORNER_FRACTION
