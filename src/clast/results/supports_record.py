"""Supports and links in a result file, for pictures: which blocks, where, and what kind."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from clast.model.model import Ints, Model
from clast.model.supports.link_lines import GROUND, RIGID, LinkLines
from clast.results.open_file import MalformedError


@dataclass(frozen=True, kw_only=True)
class SupportsRecord:
    """The blocks of reactions, and the links of a run."""

    of_block: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """Reaction and block that it holds or moves, shape (b, 2)."""
    links: LinkLines = field(default_factory=LinkLines)
    """The links, where they were at the start."""


def supported_by(model: Model) -> SupportsRecord:
    """Return the supports and links of a model, in coordinates of the user."""
    return SupportsRecord(of_block=model.reactions.of_block, links=model.link_lines)


def supported_in(file: Any, blocks: int, reactions: int, links: tuple[str, ...]) -> SupportsRecord:
    """Return those of a file, none where an older version wrote it; raises MalformedError."""
    model = file["model"]
    of_block = _whole(model, "reaction_of_block", 2, (reactions, blocks))
    name = _whole(model, "link_line", 0, (len(links),))
    lines = LinkLines(
        name=tuple(links[one] for one in name),
        block=_whole(model, "link_block", 2, (blocks, blocks), (0, GROUND)),
        holds=_whole(model, "link_holds", 3, (RIGID + 1,) * 3),
        at=_numbers(model, "link_at"),
        along=_numbers(model, "link_along"),
    )
    if len({len(one) for one in (name, lines.block, lines.holds, lines.at, lines.along)}) != 1:
        raise MalformedError("/model has links that are inconsistent")
    return SupportsRecord(of_block=of_block, links=lines)


def _whole(model: Any, name: str, wide: int, below: tuple[int, ...], least: Any = 0) -> Ints:
    """Return whole numbers (k, wide), or (k,), from the least to below the limit of a column."""
    shape = (0, wide) if wide else (0,)
    if name not in model:
        return np.zeros(shape, np.int64)
    found = np.asarray(model[name][()])
    fits = found.dtype.kind in "iu" and found.shape[1:] == shape[1:]
    if not fits or (found < np.array(least)).any() or (found >= np.array(below)).any():
        raise MalformedError(f"/model/{name} does not match the blocks, supports and links")
    return found.astype(np.int64)


def _numbers(model: Any, name: str) -> Any:
    """Return points (k, 2)."""
    if name not in model:
        return np.zeros((0, 2))
    found = np.asarray(model[name][()])
    if found.dtype.kind != "f" or found.shape[1:] != (2,) or not np.isfinite(found).all():
        raise MalformedError(f"/model/{name} has no points")
    return found
