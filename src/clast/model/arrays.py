"""Arrays of blocks, one after another: types, empty ones, following entries, connected parts."""

from __future__ import annotations

from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def no_floats(*width: int) -> Any:
    """Return a field that is an array of no rows where it is not given, shape (0, *width)."""
    return field(default_factory=lambda: np.zeros((0, *width)))


def no_ints(*width: int) -> Any:
    """Return a field that is an array of no rows of whole numbers, shape (0, *width)."""
    return field(default_factory=lambda: np.zeros((0, *width), np.int64))


def no_bools() -> Any:
    """Return a field that is an array of no truth values, shape (0,)."""
    return field(default_factory=lambda: np.zeros(0, np.bool_))


def following(start: Ints) -> Ints:
    """Return the vertex after each in its block, (nv,), by first vertices (nb + 1,)."""
    after = np.arange(1, start[-1] + 1)
    after[start[1:] - 1] = start[:-1]
    return after


def owners(start: Ints) -> Ints:
    """Return the block of each vertex, (nv,), by first vertices (nb + 1,)."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


def areas(vertices: Floats, start: Ints) -> Floats:
    """Return the signed area of each block, positive counter-clockwise, m2, shape (nb,).

    About its first vertex, so that no digits are lost to its distance from the origin.
    """
    here = vertices - vertices[start[:-1]][owners(start)]
    there = here[following(start)]
    cross = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
    return np.asarray(0.5 * np.add.reduceat(cross, start[:-1]))


def polygons_of(vertices: Floats, start: Ints) -> NDArray[Any]:
    """Return blocks (nv, 2) as shapely polygons, shape (nb,)."""
    import shapely  # slow to load

    return np.asarray(shapely.polygons(shapely.linearrings(vertices, indices=owners(start))))


def entries(start: Ints, which: Ints) -> tuple[Ints, Ints]:
    """Return the entries of groups (k,), one group after another, and which of (k,) each is of.

    Group g has the entries ``start[g]`` to ``start[g + 1]``.
    """
    count = start[which + 1] - start[which]
    number = np.repeat(np.arange(len(which)), count)
    step = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
    return start[which][number] + step, number


def connected(first: Ints, second: Ints, count: int) -> Ints:
    """Return the connected part that each of ``count`` things is of, numbered from 0, (count,).

    Links (k,) join ``first`` to ``second``.
    """
    from scipy.sparse import coo_array  # slow to load
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1], np.int64)
