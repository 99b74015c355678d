"""How many blocks lines will make, judged before anything is cut."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.arrays import connected
from clast.model.model import Floats, Ints
from clast.rockmass.cut_lines import LineTable, SetLines, Site
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.masonry import BlockPattern
from clast.rockmass.joints.plan import Plan
from clast.rockmass.joints.spacing_distributions import number_or

ROUGHLY = 3.0
"""Numbers that are only expected must exceed the limit this often before lines are drawn."""
LINES_AT_ONCE = 100_000.0
"""So many lines and crossings are drawn and counted at once, whatever the limit is."""


def check_expected(
    sets: Sequence[JointSet], plans: Sequence[Plan], patterns: Sequence[BlockPattern], most: int
) -> None:
    """Refuse sets and patterns that are expected to make far more than ``most`` blocks.

    Nothing is drawn for it.
    """
    for pattern in patterns:
        bricks = float(np.prod(pattern.bricks()))
        if bricks > max(ROUGHLY * most, LINES_AT_ONCE):
            times = math.sqrt(bricks / most)
            advice = f"give bricks {times:.3g} times as long and as high, or raise"
            raise _too_many(bricks, most, f"{pattern.where}, brick", advice)
    lines = float(sum(one.model.blocks(plan) for one, plan in zip(sets, plans, strict=True)))
    crossings = 0.0
    for k, one in enumerate(plans):
        for other in plans[: k + 1]:
            turn = 2.0 / math.pi
            if one.direction.angle is not None and other.direction.angle is not None:
                turn = abs(math.sin(one.direction.angle - other.direction.angle))
            share = 0.5 if one is other else 1.0
            area = min(one.window.area, other.window.area)
            crossings += share * turn * area * one.density * other.density
    if not 1.0 + lines + crossings <= max(ROUGHLY * most, LINES_AT_ONCE):
        densest = sets[int(np.argmax([plan.density for plan in plans]))]
        raise _too_dense(lines, crossings, most, densest)


def check_counted(tables: Sequence[LineTable], sets: Sequence[JointSet], most: int) -> int:
    """Return how many blocks lines make; ModelError where it exceeds ``most``.

    Euler's formula for L lines with X crossings, B of whose 2 L ends lie on the boundary, in C
    parts that hang on nothing: 1 + X + B - L + C.  Lines that reach from boundary to boundary make
    1 + L + X.  It is exact where no three lines meet in a point, but for small blocks that are
    merged and those in openings.
    """
    # The last table is the boundary, which cuts nothing.
    inner, boundary = tables[:-1], tables[-1]
    total = 1 + round(sum(one.faces for one in inner)) + _of_lines(inner, boundary)
    if total > most:
        size = [len(one.ends) for one in inner]
        which = int(np.argmax(size))
        if which >= len(sets):
            raise _too_many(total, most, f"'{inner[which].name}'", "remove lines; or raise")
        lines = float(min(sum(size), total - 1))
        raise _too_dense(lines, total - 1 - lines, most, sets[which])
    return total


def _too_many(blocks: float, most: int, where: str, advice: str) -> ModelError:
    return ModelError(
        f"about {blocks:.3g} blocks are expected, more than the {most:g} allowed",
        where=where,
        remedy=f"{advice} domain.most_blocks",
    )


def _too_dense(lines: float, crossings: float, most: int, densest: JointSet) -> ModelError:
    """Return the error of sets whose lines and crossings make more than ``most`` blocks."""
    # Spacings k times as large do: lines/k + crossings/k2 = most - 1.
    room = max(most - 1.0, 1.0)
    times = (lines + math.sqrt(lines**2 + 4.0 * room * crossings)) / (2.0 * room)
    if densest.intensity is not None:
        advice = f"intensities of at most 1/{times:.3g} of those given ("
        advice += f"{densest.intensity / times:.3g} m/m2 for this set)"
    else:
        spacing = number_or(densest.spacing)
        advice = f"spacings {times:.3g} times as large"
        advice += f" ({spacing.mean * times:.3g} m for this set)" if spacing else ""
    where = f"{densest.where}, spacing"
    return _too_many(1.0 + lines + crossings, most, where, f"{advice} would do; or raise")


def _of_lines(tables: Sequence[LineTable], boundary: LineTable) -> int:
    """Return how many blocks more lines make, crossings within cells and courses not counted."""
    if not tables:
        return 0
    ends = np.concatenate([one.ends for one in tables])
    table = np.repeat(np.arange(len(tables)), [len(one.ends) for one in tables])
    whole = np.array([one.whole for one in tables])[table]
    # Courses stand in two tables of one name.
    names = {name: k for k, name in enumerate(dict.fromkeys(one.name for one in tables))}
    group = np.array([names[one.name] if one.courses else -k for k, one in enumerate(tables, 1)])
    group = group[table]
    first, second = _pairs(ends)
    inside = whole[first] & whole[second] & (group[first] == group[second])
    free = np.flatnonzero(~whole)
    # Lines that end at the boundary reach a little beyond it.
    domain = shapely.polygons(boundary.ends[:, 0])
    outer = ~shapely.contains_xy(domain, ends[free].reshape(-1, 2)).reshape(-1, 2)
    # Parts that touch no boundary, outline, cell or course hang on nothing: the others on one more.
    held = np.flatnonzero(whole | np.isin(np.arange(len(ends)), free[outer.any(axis=1)]))
    one = np.concatenate([first, held])
    other = np.concatenate([second, np.full(len(held), len(ends))])
    parts = int(connected(one, other, len(ends) + 1).max())
    return int((~inside).sum()) + int(outer.sum()) - len(free) + parts


def _pairs(ends: Floats) -> tuple[Ints, Ints]:
    """Return the pairs of lines (n, 2, 2) that meet, the lower number first, (k,) each."""
    if len(ends) > 3000:
        lines = shapely.linestrings(ends)
        first, second = shapely.STRtree(lines).query(lines, predicate="intersects")
        once = first < second
        return first[once], second[once]

    def turn(line: Floats, at: Floats) -> Floats:
        along, to = line[:, 1] - line[:, 0], at - line[:, 0]
        return along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]

    first, second = np.triu_indices(len(ends), 1)
    a, b = ends[first], ends[second]
    meet = turn(a, b[:, 0]) * turn(a, b[:, 1]) <= 0.0
    meet &= turn(b, a[:, 0]) * turn(b, a[:, 1]) <= 0.0
    return first[meet], second[meet]


def limits_of(
    at: Site, lines: Sequence[SetLines], patterns: Sequence[BlockPattern]
) -> tuple[float, float]:
    """Return the smallest edge, m, and block, m2: those given, else by the spacing of the sets.

    An edge is a hundredth of their median; where only traces are drawn, their spacing is the area
    over their length.
    """
    edge, block = at.domain.smallest_edge, at.domain.smallest_block
    if edge is None:
        spacings, traced = [], 0.0
        for one in lines:
            if one.plan is None:
                traced += float(np.hypot(*(one.ends[:, 1] - one.ends[:, 0]).T).sum())
            elif one.plan.spacing is not None:
                spacings.append(one.plan.spacing.mean)
            elif one.plan.intensity is not None:
                spacings.append(1.0 / one.plan.intensity)
            else:
                spacings.append(math.sqrt(one.window.area / max(len(one.ends) / 3.0, 1.0)))
        spacings += [float(np.min(one.brick)) for one in patterns]
        if traced > 0.0 and not spacings:
            spacings.append(min(at.window.area / traced, math.sqrt(at.window.area)))
        edge = 0.01 * (float(np.median(spacings)) if spacings else 0.0)
        if block is not None:
            edge = min(edge, 0.5 * math.sqrt(block))
    return float(edge), float((2.0 * edge) ** 2 if block is None else block)
