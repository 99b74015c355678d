"""The history of the springs of bolts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Bools, Floats, Ints
from clast.model.supports import Bolts


@dataclass(frozen=True, kw_only=True)
class BoltStates:
    """The history of the m springs of bolts."""

    rest: Floats
    """Length at which it was installed l0, m, nan before, shape (m,)."""
    plastic: Floats
    """Plastic elongation p, m, shape (m,)."""
    force: Floats
    """Force F, N/m, tension positive, shape (m,)."""
    yielded_at: Floats
    """When it first yielded, s, nan where it has not, shape (m,)."""
    broken_at: Floats
    """When it broke, s, nan where it has not, shape (m,)."""
    locked: Bools
    """False where a jack holds it, shape (m,)."""
    lost: Bools
    """True where a block that it was anchored in is excavated, shape (m,)."""
    counted: Bools
    """True where the ledger has the energy that it was installed with, shape (m,)."""

    @property
    def carries(self) -> Bools:
        """Whether it can carry a force, shape (m,)."""
        return np.asarray(~np.isnan(self.rest) & np.isnan(self.broken_at) & ~self.lost)

    @property
    def state(self) -> Ints:
        """Number of its state: not installed, intact, yielded, broken, lost, shape (m,).

        The names are ``clast.results.schema.BOLT_STATES``.
        """
        found = np.where(np.isnan(self.rest), 0, 1)
        found = np.where(np.isnan(self.yielded_at), found, 2)
        found = np.where(np.isnan(self.broken_at), found, 3)
        return np.where(self.lost, 4, found).astype(np.int64)

    def elongation(self, bolts: Bolts) -> Floats:
        """Return F/s + p: the elongation since the state without force, m, shape (m,)."""
        return np.asarray(self.force / bolts.stiffness + self.plastic)

    def energy(self, bolts: Bolts) -> Floats:
        """Return the elastic energy F^2/(2 s), J/m, shape (m,)."""
        return np.asarray(0.5 * self.force**2 / bolts.stiffness)


def untouched(count: int) -> BoltStates:
    """Return so many springs before they are installed."""
    never, no = np.full(count, np.nan), np.zeros(count, np.bool_)
    return BoltStates(
        rest=never,
        plastic=np.zeros(count),
        force=np.zeros(count),
        yielded_at=never,
        broken_at=never,
        locked=no,
        lost=no,
        counted=no,
    )
