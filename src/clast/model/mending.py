"""Blocks put together before they are checked: what does it, and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clast.model.repairs import Repair

if TYPE_CHECKING:
    from clast.model.checks import Outlines
    from clast.model.model import Ints


@dataclass(frozen=True, kw_only=True)
class Mended:
    """The same blocks with other vertices."""

    outlines: Outlines
    """The blocks, counter-clockwise."""
    edge: Ints
    """Edge as given that the edge from each vertex to the next is, or is part of, shape (nv,)."""
    repairs: tuple[Repair, ...] = ()
    """What was done."""
    moved: float = 0.0
    """How far a vertex moved at most, m."""
