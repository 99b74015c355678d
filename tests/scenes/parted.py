"""Rectangles parted by chords that end on earlier ones: n chords make n + 1 blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Floats = np.ndarray


@dataclass(frozen=True)
class Placed:
    """Where a drawing lies: turned, mirrored, moved."""

    turn: float = 0.0
    """Angle, rad."""
    flip: float = 1.0
    """-1.0 mirrors it."""
    at: tuple[float, float] = (0.0, 0.0)
    """Where its origin lies, m."""

    def __call__(self, points: Floats) -> Floats:
        """Return points (..., 2) in their place, m."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        return (np.asarray(points) * [self.flip, 1.0]) @ np.array([[c, s], [-s, c]]) + self.at


def rectangle(width: float, height: float) -> Floats:
    """Return the corners of a rectangle, m, shape (4, 2)."""
    return np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])


def parted(rng: np.random.Generator, corners: Floats, chords: int, apart: float) -> Floats:
    """Return chords (n, 2, 2) of a convex polygon (k, 2), each across one of the faces so far.

    No face is narrower, and no edge shorter, than ``apart``, so that there may be fewer chords.
    """
    faces, found = [corners], []
    for _ in range(20 * chords):
        if len(found) == chords:
            break
        k = int(rng.integers(len(faces)))
        face, count = faces[k], len(faces[k])
        i, j = np.sort(rng.choice(count, 2, replace=False))
        a, b = (
            face[n] + share * (face[(n + 1) % count] - face[n])
            for n, share in zip((i, j), rng.uniform(0.1, 0.9, 2), strict=True)
        )
        parts = [
            np.concatenate([[a], face[i + 1 : j + 1], [b]]),
            np.concatenate([[b], face[j + 1 :], face[: i + 1], [a]]),
        ]
        if min(map(_narrowest, parts)) < apart:
            continue
        faces[k] = parts[0]
        faces.append(parts[1])
        found.append([a, b] if rng.random() < 0.5 else [b, a])
    order = rng.permutation(len(found))
    return np.array(found).reshape(-1, 2, 2)[order]


def _narrowest(face: Floats) -> float:
    edge = np.hypot(*(face - np.roll(face, 1, axis=0)).T)
    x, y = face.T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    return min(float(edge.min()), 2.0 * area / float(edge.sum()))


def ladder(rungs: int, length: float, place: Callable[[Floats], Floats]) -> Floats:
    """Return two rails across a square of this side and rungs between them, (rungs + 2, 2, 2)."""
    rails = length * np.array([[[0.0, 0.31], [1.0, 0.43]], [[0.0, 0.52], [1.0, 0.71]]])
    share = (np.arange(rungs) + 0.5) / rungs
    feet = [rail[0] + share[:, None] * (rail[1] - rail[0]) for rail in rails]
    return place(np.concatenate([rails, np.stack(feet, axis=1)]))
