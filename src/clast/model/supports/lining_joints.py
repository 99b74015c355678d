"""Joints of linings: their names and places."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True, repr=False)
class LiningJoints:
    """The k joints of all linings, at which their forces are known."""

    name: tuple[str, ...] = ()
    """Name of each: that of its lining, a slash and its number."""
    along: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    """Where it is along the middle of its lining, m, shape (k,)."""
    face: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """Vertices of the segment beside it, outside and inside, shape (k, 2)."""
    section: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    """Its thickness, m, and strengths in tension and compression, Pa, infinite for none, shape
    (k, 3); (0, 3) in files of older versions."""

    @property
    def linings(self) -> tuple[str, ...]:
        """Names of the linings."""
        return tuple(dict.fromkeys(name.rpartition("/")[0] for name in self.name))

    def of(self, lining: str) -> NDArray[np.int64]:
        """Return the joints of a lining, shape (j,)."""
        own = [k for k, name in enumerate(self.name) if name.rpartition("/")[0] == lining]
        return np.array(own, np.int64)
