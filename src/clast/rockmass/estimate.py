"""How many blocks lines will make, judged before anything is cut."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.arrays import connected
from clast.model.model import Bools, Floats, Ints
from clast.rockmass.cut_lines import LineTable, SetLines, Site
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.masonry import BlockPattern
from clast.rockmass.joints.plan import Plan
from clast.rockmass.joints.spacing_distributions import distribution

ROUGH = 3.0
"""Numbers that are only expected must exceed the limit this often before lines are drawn."""
QUICK = 100_000.0
"""So many lines and crossings are drawn and counted at once, whatever the limit is."""
BRUTE = 3000
"""Up to this many lines all pairs are tried for crossings."""


@dataclass(frozen=True, kw_only=True)
class _Expected:
    """Blocks that lines make: those that grow with their number, and with its square."""

    lines: float
    """Lines, or cells."""
    crossings: float
    """Crossings between them."""

    @property
    def total(self) -> float:
        """Blocks."""
        return 1.0 + self.lines + self.crossings

    def times(self, most: int) -> float:
        """Return by which factor all spacings must grow for ``most`` blocks."""
        # lines/k + crossings/k2 = most - 1
        room = max(most - 1.0, 1.0)
        root = math.sqrt(self.lines**2 + 4.0 * room * self.crossings)
        return (self.lines + root) / (2.0 * room)


def check_expected(
    sets: Sequence[JointSet], plans: Sequence[Plan], patterns: Sequence[BlockPattern], most: int
) -> None:
    """Refuse sets and patterns that are expected to make far more than ``most`` blocks.

    Nothing is drawn for it.
    """
    for pattern in patterns:
        bricks = float(np.prod(pattern.bricks()))
        if bricks > max(ROUGH * most, QUICK):
            times = math.sqrt(bricks / most)
            raise ModelError(
                f"about {bricks:.3g} blocks are expected, more than the {most:g} allowed",
                where=f"{pattern.where}, brick",
                remedy=f"give bricks {times:.3g} times as long and as high, or raise "
                "domain.most_blocks",
            )
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
    expected = _Expected(lines=float(sum(lines)), crossings=crossings)
    if not expected.total <= max(ROUGH * most, QUICK):
        where = sets[int(np.argmax([plan.density for plan in plans]))]
        raise _too_many(expected, most, where)


def check_counted(tables: Sequence[LineTable], sets: Sequence[JointSet], most: int) -> int:
    """Return how many blocks lines make; ModelError where it exceeds ``most``.

    Euler's formula for L lines with X crossings, B of whose 2 L ends lie on the boundary, in C
    parts that hang on nothing: 1 + X + B - L + C.  Lines that reach from boundary to boundary make
    1 + L + X.  It is exact where no three lines meet in a point, but for small blocks that are
    merged and those in openings.
    """
    # The last table is the boundary, which cuts nothing.
    inner, boundary = tables[:-1], tables[-1]
    faces = sum(one.faces for one in inner)
    total = 1 + round(faces) + _of_lines(inner, boundary)
    if total > most:
        size = [len(one.ends) for one in inner]
        which = int(np.argmax(size))
        where = sets[which] if which < len(sets) else inner[which].name
        lines = float(min(sum(size), total - 1))
        raise _too_many(_Expected(lines=lines, crossings=total - 1 - lines), most, where)
    return total


def _too_many(expected: _Expected, most: int, where: JointSet | str) -> ModelError:
    times = expected.times(most)
    label, advice = f"'{where}'", "remove lines"
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
        f"about {expected.total:.3g} blocks are expected, more than the {most:g} allowed",
        where=f"{label}, spacing" if isinstance(where, JointSet) else label,
        remedy=f"{advice}; or raise domain.most_blocks",
    )


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
    parts = _hanging_on_nothing(
        first, second, whole, np.isin(np.arange(len(ends)), free[outer.any(axis=1)])
    )
    return int((~inside).sum()) + int(outer.sum()) - len(free) + parts


def _pairs(ends: Floats) -> tuple[Ints, Ints]:
    """Return the pairs of lines (n, 2, 2) that meet, the lower number first, (k,) each."""
    if len(ends) <= BRUTE:
        first, second = np.triu_indices(len(ends), 1)
        meet = _meeting(ends, first, second)
        return first[meet], second[meet]
    lines = shapely.linestrings(ends)
    first, second = shapely.STRtree(lines).query(lines, predicate="intersects")
    once = first < second
    return first[once], second[once]


def _hanging_on_nothing(first: Ints, second: Ints, whole: Bools, at_rim: Bools) -> int:
    """Return how many parts pairs of lines make that touch no boundary, outline, cell or course.

    ``whole`` and ``at_rim`` (n,) mark the lines of those, and the lines that end at the boundary.
    """
    count = len(whole)
    held = np.flatnonzero(whole | at_rim)
    one, other = np.concatenate([first, held]), np.concatenate([second, np.full(len(held), count)])
    return int(connected(one, other, count + 1).max())


def _meeting(ends: Floats, first: Ints, second: Ints) -> Bools:
    """Return whether lines (n, 2, 2) of pairs (k,) cross, shape (k,)."""
    a, b = ends[first], ends[second]

    def turn(line: Floats, at: Floats) -> Floats:
        way, to = line[:, 1] - line[:, 0], at - line[:, 0]
        return way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0]

    return (turn(a, b[:, 0]) * turn(a, b[:, 1]) <= 0.0) & (
        turn(b, a[:, 0]) * turn(b, a[:, 1]) <= 0.0
    )


SHARE = 0.01
"""Smallest edge as a share of the median spacing, where none is given."""


@dataclass(frozen=True, kw_only=True)
class SizeLimits:
    """Smallest edges and blocks."""

    smallest_edge: float
    """Shorter edges are collapsed, m."""
    smallest_block: float
    """Smaller blocks are merged, m2."""


def limits_of(at: Site, lines: Sequence[SetLines], patterns: Sequence[BlockPattern]) -> SizeLimits:
    """Return the limits of a domain: those given, else by the median spacing of its sets.

    Where only traces are drawn, their spacing is the area over their length.
    """
    domain = at.domain
    edge, block = domain.smallest_edge, domain.smallest_block
    if edge is None:
        edge = SHARE * _spacing(at, lines, patterns)
        if block is not None:
            edge = min(edge, 0.5 * math.sqrt(block))
    if block is None:
        block = (2.0 * edge) ** 2
    return SizeLimits(smallest_edge=float(edge), smallest_block=float(block))


def _spacing(at: Site, lines: Sequence[SetLines], patterns: Sequence[BlockPattern]) -> float:
    found, traced = [], 0.0
    for one in lines:
        if one.plan is None:
            traced += float(np.hypot(*(one.ends[:, 1] - one.ends[:, 0]).T).sum())
        elif one.plan.spacing is not None:
            found.append(one.plan.spacing.mean)
        elif one.plan.intensity is not None:
            found.append(1.0 / one.plan.intensity)
        else:
            found.append(math.sqrt(one.window.area / max(len(one.ends) / 3.0, 1.0)))
    found += [float(np.min(one.brick)) for one in patterns]
    if traced > 0.0 and not found:
        area = at.window.area
        found.append(min(area / traced, math.sqrt(area)))
    # Nothing cuts the domain but its openings: these have edges as short as they are meant.
    return float(np.median(found)) if found else 0.0
