"""Faces of blocks with a number each, which pictures draw as lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.pictures.strokes import visible


@dataclass(frozen=True, kw_only=True)
class Faces:
    """Faces of blocks with one number each; k faces."""

    ends: Floats
    """Their ends, m, shape (k, 2, 2); equal where there is one contact."""
    value: Floats
    """Mean of the contacts of each, shape (k,)."""
    edge: Ints
    """The vertex that an edge along it begins with, the same in all frames, shape (k,)."""
    width: Floats | None = None
    """Widths of their lines as shares of the widest, (k,); None: as wide as values are large."""

    @property
    def length(self) -> Floats:
        """Their lengths, m, shape (k,)."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    def within(self, low: Floats, high: Floats) -> Bools:
        """Return which may be seen in a part (low, high), m, shape (k,)."""
        return visible(self.ends, (low, high))


def together(some: Sequence[Faces]) -> Faces:
    """Return the faces of some frames as one."""
    widths = [one.width for one in some if one.width is not None]
    return Faces(
        ends=np.concatenate([one.ends for one in some]),
        value=np.concatenate([one.value for one in some]),
        edge=np.concatenate([one.edge for one in some]),
        width=None if not widths else np.concatenate(widths),
    )
