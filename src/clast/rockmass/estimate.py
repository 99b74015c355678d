"""How many blocks lines will make, judged before anything is cut."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.model import Floats
from clast.rockmass.joints.distributions import distribution
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.plan import Plan
from clast.rockmass.sources import Table

ROUGH = 3.0
"""Numbers that are only expected must exceed the limit this often before lines are drawn."""
BRUTE = 3000
"""Up to this many lines all pairs are tried for crossings."""


def check_expected(sets: Sequence[JointSet], plans: Sequence[Plan], most: int) -> None:
    """Refuse sets that are expected to make far more than ``most`` blocks, before drawing them."""
    lines = [one.model.blocks(plan) for one, plan in zip(sets, plans, strict=True)]
    crossings = 0.0
    for k, one in enumerate(plans):
        for other in plans[: k + 1]:
            turn = 2.0 / math.pi
            if one.direction.angle is not None and other.direction.angle is not None:
                turn = abs(math.sin(one.direction.angle - other.direction.angle))
            share = 0.5 if one is other else 1.0
            area = min(one.window.area, other.window.area)
            crossings += share * turn * area * one.density * other.density
    total = 1.0 + sum(lines) + crossings
    if not total <= ROUGH * most:
        where = sets[int(np.argmax([plan.density for plan in plans]))]
        raise _too_many(total, most, where)


def check_counted(tables: Sequence[Table], sets: Sequence[JointSet], most: int) -> int:
    """Return 1 + L + X of L lines with X crossings; ModelError where it exceeds ``most``.

    It is the number of blocks that persistent lines make of a convex domain (Euler); traces that
    end inside blocks make fewer.
    """
    # The last table is the boundary, which cuts nothing.
    inner = tables[:-1]
    count = sum(0 if one.whole else len(one.ends) for one in inner)
    faces = sum(one.faces for one in inner)
    total = 1 + count + round(faces) + _crossings(inner)
    if total > most:
        size = [len(one.ends) for one in inner]
        which = int(np.argmax(size))
        where = sets[which] if which < len(sets) else inner[which].name
        raise _too_many(total, most, where)
    return total


def _too_many(total: float, most: int, where: JointSet | str) -> ModelError:
    times = math.sqrt(total / most)
    label, advice = f"'{where}'", "take lines out"
    if isinstance(where, JointSet):
        label = where.where
        if where.intensity is not None:
            advice = f"intensities of at most 1/{times:.3g} of those given ("
            advice += f"{where.intensity / times:.3g} m/m2 for this set) would do"
        else:
            mean = None if where.spacing is None else distribution(where.spacing).mean
            advice = f"spacings {times:.3g} times as large"
            advice += f" ({mean * times:.3g} m for this set)" if mean else ""
            advice += " would do"
    return ModelError(
        f"about {total:.3g} blocks are expected, and {most:g} are allowed",
        where=f"{label}, spacing" if isinstance(where, JointSet) else label,
        remedy=f"{advice}; or raise domain.most_blocks",
    )


def _crossings(tables: Sequence[Table]) -> int:
    """Return how often lines of tables meet, those of one that makes cells not counted."""
    if not tables:
        return 0
    ends = np.concatenate([one.ends for one in tables])
    table = np.repeat(np.arange(len(tables)), [len(one.ends) for one in tables])
    whole = np.array([one.whole for one in tables])[table]
    # Courses stand in two tables of one name.
    names = {name: k for k, name in enumerate(dict.fromkeys(one.name for one in tables))}
    group = np.array([names[one.name] if one.courses else -k for k, one in enumerate(tables, 1)])
    group = group[table]
    if len(ends) <= BRUTE:
        first, second = np.triu_indices(len(ends), 1)
        meet = _meeting(ends, first, second)
        first, second = first[meet], second[meet]
    else:
        lines = shapely.linestrings(ends)
        first, second = shapely.STRtree(lines).query(lines, predicate="intersects")
        once = first < second
        first, second = first[once], second[once]
    return int((~(whole[first] & whole[second] & (group[first] == group[second]))).sum())


def _meeting(ends: Floats, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return whether lines (n, 2, 2) of pairs (k,) cross, shape (k,)."""
    a, b = ends[first], ends[second]

    def turn(line: Floats, at: Floats) -> Floats:
        way, to = line[:, 1] - line[:, 0], at - line[:, 0]
        return way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0]

    return (turn(a, b[:, 0]) * turn(a, b[:, 1]) <= 0.0) & (
        turn(b, a[:, 0]) * turn(b, a[:, 1]) <= 0.0
    )
