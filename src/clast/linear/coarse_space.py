"""The aggregates whose coarse system helps the iterative solver, found once for a step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from clast.linear import aggregates
from clast.linear import coarse_kernels as coarse
from clast.linear.system import BlockSystem
from clast.model.model import Floats, Ints

THOUSAND, TENFOLD = 6.0, 2.4
"""Of 1,000 blocks 2^THOUSAND aggregates are made, of ten times as many 2^TENFOLD times as many:
more would need fewer iterations, and cost more to factorise than those."""


@dataclass(frozen=True, kw_only=True)
class Aggregates:
    """Aggregates of the blocks of a step, in the order in which they are eliminated."""

    aggregate: Ints
    """That of each block, shape (n,)."""
    offset: Floats
    """Centroid of each block less that of its aggregate, m, shape (n, 2)."""
    pairs: Ints
    """Pairs of aggregates that the factor couples, i < j, sorted, shape (q, 2)."""
    rows: tuple[Ints, Ints, Ints]
    """Their right, left and listed (linear/block_matrix.py)."""

    @property
    def arrays(self) -> tuple[Any, ...]:
        """As linear/coarse_kernels.py takes them."""
        return self.aggregate, self.offset, self.pairs, self.rows


def number_of_aggregates(blocks: int) -> int:
    """Return how many aggregates so many blocks are parted into, a power of two."""
    wanted = round(THOUSAND + TENFOLD * math.log10(max(blocks, 1) / 1000.0))
    return int(2 ** min(max(0, wanted), math.floor(math.log2(max(blocks, 1)))))


def aggregates_of(system: BlockSystem) -> Aggregates:
    """Return the aggregates of neighbouring blocks, whatever their contacts bear."""
    number = number_of_aggregates(len(system.centroid))
    of_blocks = aggregates.bisected(system.centroid, number)
    found = coarse.arranged(system.centroid, of_blocks, number, system.pairs, system.rows)
    return Aggregates(aggregate=found[0], offset=found[1], pairs=found[2], rows=found[3])


class LastAggregates:
    """The aggregates of the last system, for all that have the same blocks and pairs.

    Systems of one step share the arrays of their centroids and pairs, which nobody changes.
    """

    def __init__(self) -> None:
        self._last: tuple[Any, Any, Aggregates] | None = None

    def of(self, system: BlockSystem) -> Aggregates:
        """Return the aggregates of a system."""
        last = self._last
        if last is None or last[0] is not system.centroid or last[1] is not system.pairs:
            last = system.centroid, system.pairs, aggregates_of(system)
            self._last = last
        return last[2]


LAST = LastAggregates()
"""Shared by all runs: aggregates are a function of the system alone."""
