"""Blocks as they are drawn: each by itself, rounded, so that neighbours overlap and gape."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from clast.rockmass import Box, Domain, JointSet, Opening, Parallel, cut


def wall(columns: int, rows: int, brick=(1.0, 0.5)) -> tuple[np.ndarray, np.ndarray]:
    """Return a wall in running bond: vertices (nv, 2), m, and where blocks start (nb + 1,)."""
    loops = []
    width, height = brick
    for row in range(rows):
        ends = [0.0, *np.arange(0.5 if row % 2 else 1.0, columns, 1.0), float(columns)]
        for left, right in pairwise(ends):
            low, high = row * height, (row + 1) * height
            x, y = left * width, right * width
            loops.append([(x, low), (y, low), (y, high), (x, high)])
    return np.array(loops).reshape(-1, 2), np.arange(0, 4 * len(loops) + 1, 4)


def jointed(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a rock mass of some hundred blocks with a void, cut by two sets."""
    rng = np.random.default_rng(seed)
    sets = [
        JointSet(name=f"{k}", angle=angle, spacing=rng.uniform(0.8, 1.6), model=Parallel())
        for k, angle in enumerate((rng.uniform(0, 50), rng.uniform(80, 140)))
    ]
    domain = Domain(
        boundary=[(0, 0), (14, 0), (14, 9), (0, 9)], smallest_edge=0.05, smallest_block=0.05
    )
    void = Opening(name="void", shape=Box(corner=(5, 3), size=(2.2, 1.7)), excavated=True)
    found = cut(domain, sets, openings=[void])
    return found.vertices, found.block_start


def rounded(vertices: np.ndarray, rng: np.random.Generator, noise: float) -> np.ndarray:
    """Return vertices rounded to millimetres, each moved by up to ``noise`` in x and y, m."""
    return np.round(vertices, 3) + rng.uniform(-noise, noise, vertices.shape)


def following(start: np.ndarray) -> np.ndarray:
    """Return the vertex after each vertex in its block, shape (nv,)."""
    after = np.arange(1, start[-1] + 1)
    after[start[1:] - 1] = start[:-1]
    return after


def area(loop: np.ndarray) -> float:
    """Return the signed area of a loop (k, 2), m2."""
    x, y = (loop - loop[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
