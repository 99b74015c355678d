"""Openings: blocks that a stage may excavate together, and the welds along them until then."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from clast import spelling
from clast.errors import ModelError

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def _no_edges() -> Ints:
    return np.zeros(0, np.int64)


@dataclass(frozen=True, kw_only=True)
class Opening:
    """Rock that is there until it is excavated."""

    name: str
    """Name by which stages refer to it."""
    block: Ints
    """Its blocks, shape (k,)."""
    welded: Ints = field(default_factory=_no_edges)
    """Edges along its construction joint, welded until it is excavated: their first vertices, (w,).

    They belong to blocks inside and outside.
    """


def blocks_called(
    names: Iterable[str], openings: Iterable[Opening], block_name: Iterable[str]
) -> Ints:
    """Return the blocks of openings and blocks by their ``names``, sorted, each once, shape (k,).

    Raises ModelError for a name that neither has.
    """
    by_name = {name: np.array([number]) for number, name in enumerate(block_name)}
    by_name |= {one.name: one.block for one in openings}
    found = [_no_edges()]
    for name in names:
        if name not in by_name:
            raise ModelError(
                f"there is no opening or block '{name}'",
                where="excavate",
                remedy=spelling.advice(name, by_name, kind="opening or block"),
            )
        found.append(by_name[name])
    return np.unique(np.concatenate(found))
