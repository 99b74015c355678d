"""Vertices that are meant to be one: which they are, and where their common place is.

A chain of vertices, each within the tolerance of the next, may be longer than the tolerance.  So
places are picked first, more than the tolerance apart from each other, those with most vertices
around them before others, until every vertex has one within the tolerance; then each vertex joins
the nearest.  No vertex moves by more than the tolerance, and all places stay further apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from clast.model.model import Floats, Ints


@dataclass(frozen=True, kw_only=True, eq=False)
class SharedCorners:
    """Vertices by their common places."""

    node: Ints
    """Place of each vertex, shape (nv,)."""
    at: Floats
    """Where each place is, m, shape (nn, 2)."""


def corners_of(points: Floats, reach: float) -> SharedCorners:
    """Return the common places of vertices (nv, 2), m, that lie within ``reach`` of each other.

    A place is where most of its vertices are, else their mean; where that would bring a vertex too
    far, or two places too near, it is the vertex that was picked.
    """
    key = np.ascontiguousarray(points).view(np.complex128)[:, 0]
    _, first, of, times = np.unique(key, return_index=True, return_inverse=True, return_counts=True)
    single = points[first]
    picked = single[_picked(single, times, reach)]
    # Round-off may put a vertex at the tolerance just beyond it.
    owner = cKDTree(picked).query(single, distance_upper_bound=reach * (1.0 + 1e-9))[1]
    place = _better(picked, single, owner, times, reach)
    return SharedCorners(node=owner[of], at=place)


def _picked(at: Floats, times: Ints, reach: float) -> Ints:
    """Return points (k,) of ``at`` (n, 2) further apart than ``reach``, near which all others are.

    Those with most vertices around go first; ``times`` (n,) says how many lie on each point.
    """
    pairs = cKDTree(at).query_pairs(reach, output_type="ndarray").astype(np.int64)
    count = len(at)
    weight = times.astype(np.int64)
    for one, other in ((0, 1), (1, 0)):
        np.add.at(weight, pairs[:, one], times[pairs[:, other]])
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    start = np.searchsorted(both[:, 0], np.arange(count + 1)).tolist()
    near = both[:, 1].tolist()
    free = [True] * count
    picked = []
    for point in np.lexsort((np.arange(count), -weight)).tolist():
        if free[point]:
            picked.append(point)
            for other in near[start[point] : start[point + 1]]:
                free[other] = False
    return np.sort(np.array(picked, np.int64))


def _better(picked: Floats, at: Floats, owner: Ints, times: Ints, reach: float) -> Floats:
    """Return for each place (k, 2) where most of its vertices are, their mean, or itself."""
    count = len(picked)
    total = np.bincount(owner, times, minlength=count)
    shift = (at - picked[owner]) * times[:, None]
    mean = np.stack([np.bincount(owner, shift[:, k], minlength=count) for k in (0, 1)], axis=1)
    place = picked + mean / total[:, None]
    order = np.lexsort((-times, owner))
    first = order[np.searchsorted(owner[order], np.arange(count))]
    most = 2 * times[first] > total
    place[most] = at[first[most]]
    gap = np.hypot(*(at - place[owner]).T)
    far = np.zeros(count)
    np.maximum.at(far, owner, gap)
    return kept_apart(np.where((far > reach)[:, None], picked, place), picked, reach)


def kept_apart(place: Floats, before: Floats, reach: float) -> Floats:
    """Return places (n, 2), those that came within ``reach`` of others put back to ``before``."""
    place = place.copy()
    while True:
        near = np.unique(cKDTree(place).query_pairs(reach, output_type="ndarray"))
        back = near[(place[near] != before[near]).any(axis=1)]
        if len(back) == 0:
            return place
        place[back] = before[back]
