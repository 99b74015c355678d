"""The surface of blocks as it is seen from a line above them, and forces that rest on it.

Of forces that are parallel the resultant acts on a block as they do: T is linear (Shi 1988), so
sum q_i T(x_i)^T e = Q T(x)^T e with Q = sum q_i and x the mean of the x_i by their q_i.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.checks import BlockOutlines
from clast.model.model import Bools, Floats, Ints

BESIDE = 1e-3
"""How far a line may run within a block and be taken to lie on it, in units of its size."""


@dataclass(frozen=True, kw_only=True)
class SurfaceParts:
    """Parts of edges that are seen from a line above them, from left to right."""

    block: Ints
    """Block of each part, shape (k,)."""
    x: Floats
    """Where each part begins and ends, m, shape (k, 2)."""
    y: Floats
    """Height of the edge there, m, shape (k, 2)."""
    hidden: tuple[tuple[float, float, int], ...]
    """Where the line runs within a block: from, to, m, and the block."""


def surface_parts(
    line: Floats, span: tuple[float, float], outlines: BlockOutlines, there: Bools
) -> SurfaceParts:
    """Return the edges that a line (m, 2), m, x rising, sees below it in a span of x.

    Beyond its ends it is level.  Blocks that are not ``there`` (n,) are left out.
    """
    first, last = outlines.vertices, outlines.vertices[outlines.following]
    low, high = np.minimum(first[:, 0], last[:, 0]), np.maximum(first[:, 0], last[:, 0])
    edges = np.flatnonzero((high > low) & (high > span[0]) & (low < span[1]))
    edges = edges[there[outlines.owner[edges]]]
    first, last, low, high = first[edges], last[edges], low[edges], high[edges]
    owner, is_top = outlines.owner[edges], last[:, 0] < first[:, 0]
    beside = BESIDE * np.sqrt(np.abs(outlines.area))[owner]
    slope = (last[:, 1] - first[:, 1]) / (last[:, 0] - first[:, 0])
    marks = np.unique(np.clip(np.concatenate([low, high, line[:, 0], span]), *span))
    seen, hidden = [], []
    for x in np.stack([marks[:-1], marks[1:]], axis=1):
        # Parts shorter than this fraction of the whole are round-off
        if x[1] - x[0] <= 1e-9 * (span[1] - span[0]):
            continue
        middle = float(x.mean())
        here = np.flatnonzero((low < middle) & (middle < high))
        y = first[here, 1] + slope[here] * (middle - first[here, 0])
        level = float(np.interp(middle, *line.T))
        above = y > level + beside[here]
        over = here[above][np.argmin(y[above])] if above.any() else -1
        if over >= 0 and is_top[over]:
            hidden.append((float(x[0]), float(x[1]), int(owner[over])))
            continue
        below = ~above & is_top[here]
        if below.any():
            edge = here[below][np.argmax(y[below])]
            ends = first[edge, 1] + slope[edge] * (x - first[edge, 0])
            seen.append((int(owner[edge]), x, ends))
    return SurfaceParts(
        block=np.array([one[0] for one in seen], np.int64),
        x=np.array([one[1] for one in seen]).reshape(-1, 2),
        y=np.array([one[2] for one in seen]).reshape(-1, 2),
        hidden=tuple(hidden),
    )


@dataclass(frozen=True, kw_only=True)
class Resting:
    """Parallel forces at rest on blocks, one resultant each."""

    block: Ints
    """Block of each, shape (k,)."""
    at: Floats
    """Place of its resultant, m, shape (k, 2)."""
    amount: Floats
    """Size of the resultant, shape (k,)."""

    @classmethod
    def of_parts(cls, block: Ints, at: Floats, amount: Floats) -> Resting:
        """Return the resultants of forces on parts (k,), one for each block."""
        own, number = np.unique(block[amount > 0.0], return_inverse=True)
        at, amount = at[amount > 0.0], amount[amount > 0.0]
        total = np.asarray(np.bincount(number, amount, len(own)), np.float64)
        mean = [np.bincount(number, amount * x, len(own)) / total for x in at.T]
        return cls(block=own, at=np.stack(mean, axis=1), amount=total)


def under_fill(line: Floats, parts: SurfaceParts) -> Resting:
    """Return the areas of fill between a line (m, 2) and the parts below it, m2, by block."""
    depth = np.maximum(0.0, np.interp(parts.x, *line.T) - parts.y)
    total = depth.sum(axis=1)
    # of a trapezium; where there is none it does not count
    share = (depth[:, 0] + 2.0 * depth[:, 1]) / (3.0 * np.where(total > 0.0, total, 1.0))
    at = np.stack(
        [one[:, 0] + share * (one[:, 1] - one[:, 0]) for one in (parts.x, parts.y)], axis=1
    )
    return Resting.of_parts(parts.block, at, 0.5 * total * np.ptp(parts.x, axis=1))


def footprint(wheel: Floats, half: float, spread: float, parts: SurfaceParts) -> SurfaceParts:
    """Return the parts under a wheel (2,), m: within ``half``, m, and ``spread`` times the depth.

    None where it stands over no block: all of them lie to one side of it.  Gaps that are deeper
    than wide are bridged.
    """
    run = np.ptp(parts.x, axis=1)
    depth = wheel[1] - parts.y
    begin, end = np.zeros(len(run)), np.ones(len(run))
    for sign in (1.0, -1.0):
        # room to one side, linear along a part: room >= 0 there
        room = half + spread * depth + sign * (parts.x - wheel[0])
        grows = room[:, 1] - room[:, 0]
        zero = -room[:, 0] / np.where(grows == 0.0, 1.0, grows)
        begin = np.where(grows > 0.0, np.maximum(begin, zero), begin)
        end = np.where(grows < 0.0, np.minimum(end, zero), end)
        end = np.where((grows == 0.0) & (room[:, 0] < 0.0), 0.0, end)
    kept = end > begin
    # what lies beyond the first place that leaves the cone is in its shadow
    for past in np.flatnonzero((parts.x[:, 1] > wheel[0]) & ((end < 1.0) | ~kept))[:1]:
        kept[past + 1 :] = False
    for past in np.flatnonzero((parts.x[:, 0] < wheel[0]) & ((begin > 0.0) | ~kept))[-1:]:
        kept[:past] = False
    share = np.stack([begin, end], axis=1)
    x = parts.x[:, :1] + share * np.diff(parts.x, axis=1)
    y = parts.y[:, :1] + share * np.diff(parts.y, axis=1)
    kept[kept] = ~_bridged(x[kept], y[kept])
    x, y = x[kept], y[kept]
    if not len(x) or x.min() > wheel[0] + 0.5 * half or x.max() < wheel[0] - 0.5 * half:
        kept, x, y = kept & False, x[:0], y[:0]
    return SurfaceParts(block=parts.block[kept], x=x, y=y, hidden=parts.hidden)


def _bridged(x: Floats, y: Floats) -> Bools:
    """Return whether parts (k, 2) are the bottom of a gap that is deeper than it is wide, (k,)."""
    bridged = np.zeros(len(x), np.bool_)
    for k, top in enumerate(y.max(axis=1)):
        before, after = np.flatnonzero(y[:k, 1] > top), np.flatnonzero(y[k + 1 :, 0] > top) + k + 1
        if len(before) and len(after):
            left, right = before[-1], after[0]
            bridged[k] = min(y[left, 1], y[right, 0]) - top > x[right, 0] - x[left, 1]
    return bridged


def under_wheel(parts: SurfaceParts) -> Resting:
    """Return the share of a load on each block whose parts carry it evenly along x."""
    length = np.ptp(parts.x, axis=1)
    at = np.stack([parts.x.mean(axis=1), parts.y.mean(axis=1)], axis=1)
    return Resting.of_parts(parts.block, at, length / length.sum())
