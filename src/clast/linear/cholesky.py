"""Our block Cholesky factorisation: nested dissection, dense fronts, the pattern analysed once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.errors import StepOutcome, StepRejected
from clast.linear import cholesky_kernels as kernel
from clast.linear.system import BlockSystem
from clast.model.model import Bools, Floats, Ints


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """What a pattern of coupled blocks determines: order, fronts, and where each number goes."""

    order: Ints
    """Blocks in the order of elimination, shape (n,)."""
    first: Ints
    """First column of each front, shape (s + 1,)."""
    front_start: Ints
    """First of each front's rows, shape (s + 1,)."""
    front_rows: Ints
    """Rows of the fronts: their own columns, then those below."""
    above: Ints
    """Parent of each front, -1 for roots, shape (s,)."""
    relative: Ints
    """Where each row stands in the parent front; as ``front_rows``."""
    where: Ints
    """Row, column and turn of each pair's block in its front, shape (q, 3)."""
    pair_start: Ints
    """First of each front's pairs, shape (s + 1,)."""
    listed: Ints
    """Pairs by front."""
    value_start: Ints
    """First number of each front in the factor, shape (s + 1,)."""
    highest: int
    """Numbers that wait on the stack at most."""
    largest: int
    """Rows of the largest front."""

    @property
    def stored(self) -> int:
        """Numbers in the factor."""
        return int(self.value_start[-1])


class Analyses:
    """The analyses of the last few patterns; the pattern of contacts changes rarely."""

    def __init__(self, kept: int = 4) -> None:
        self._kept = kept
        self._known: dict[bytes, Analysis] = {}

    def of(self, count: int, pairs: Ints, coupled: Bools) -> Analysis:
        """Return the analysis of ``count`` blocks with the ``coupled`` (q,) of ``pairs`` (q, 2)."""
        key = count.to_bytes(8) + pairs.tobytes() + coupled.tobytes()
        found = self._known.pop(key, None)
        if found is None:
            found = analyse(count, pairs, coupled)
            while len(self._known) >= self._kept:
                self._known.pop(next(iter(self._known)))
        self._known[key] = found
        return found


ANALYSES = Analyses()
"""Shared by all runs: an analysis is a function of its pattern alone."""


def analyse(count: int, pairs: Ints, coupled: Bools) -> Analysis:
    """Return the analysis of a pattern."""
    pattern, (value_start, highest, largest) = kernel.analyse(count, pairs, coupled)
    order, first, front_start, front_rows, above, relative, where, pair_start, listed = pattern
    return Analysis(
        order=order,
        first=first,
        front_start=front_start,
        front_rows=front_rows,
        above=above,
        relative=relative,
        where=where,
        pair_start=pair_start,
        listed=listed,
        value_start=value_start,
        highest=highest,
        largest=largest,
    )


@dataclass(frozen=True)
class CholeskyFactor:
    """A matrix K = U^T U."""

    analysis: Analysis
    """Order and fronts."""
    values: Floats
    """Rows of U, front by front."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        one = self.analysis
        displacement: Floats = kernel.solve(
            self.values,
            one.order,
            one.first,
            one.front_start,
            one.front_rows,
            one.value_start,
            force,
        )
        if not np.isfinite(displacement).all():
            raise StepRejected(StepOutcome.NOT_FINITE)
        return displacement


@dataclass(frozen=True)
class Cholesky:
    """Multifrontal block Cholesky; symmetric systems only."""

    def factor(self, system: BlockSystem) -> CholeskyFactor:
        """Return the factorised matrix; raises StepRejected where K is not positive definite."""
        coupled = kernel.coupled_pairs(system.diagonal, system.pairs)
        analysis = ANALYSES.of(len(system.diagonal), system.pairs, coupled)
        values, definite = kernel.factorise(
            system.diagonal,
            system.upper,
            analysis.order,
            analysis.first,
            analysis.front_start,
            analysis.above,
            analysis.relative,
            analysis.where,
            analysis.pair_start,
            analysis.listed,
            analysis.value_start,
            analysis.highest,
            analysis.largest,
        )
        if not definite:
            raise StepRejected(StepOutcome.SINGULAR, "the matrix is not positive definite")
        return CholeskyFactor(analysis, values)
