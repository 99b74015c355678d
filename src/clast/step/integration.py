"""The theta family of implicit schemes.

    M (v+ - v) = h F,   d = h ((1 - theta) v + theta v+)

with F the forces at the end of the step.  theta = 1/2 is constant acceleration (Shi 1988), 1 is
backward Euler.  Eliminating v+ gives M/(theta h2) (d - h v) = F.  Every block receives the impulse
h F whatever its theta, so blocks with different theta still exchange momentum exactly.

theta may be 1 for some motions of a block and the scheme's for all others: with Q that takes of a
motion what contacts stop, orthogonally in the sense of M, M (1/theta + (1 - 1/theta) Q) stands in
place of M/theta.  What is free of these contacts moves as if they were not there.

Where impacts change a block's velocity within the step (step/impact.py) v is that after them,
and in place of h v stands how far the block would go, its ``drift``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from clast.model.model import Floats, Ints
from clast.step import stopping


@dataclass(frozen=True, kw_only=True)
class Scheme:
    """How blocks take a step."""

    theta: float
    """Share of the end velocity in the displacement."""
    step: float
    """h, s."""
    stopped: tuple[Ints, Floats, Floats] | None = None
    """Motions with theta = 1, as kernels take them (step/stopping.py)."""

    @property
    def inertia(self) -> float:
        """1/(theta h2), 1/s2."""
        return 1.0 / (self.theta * self.step**2)

    @property
    def of_stopped(self) -> float:
        """What stopped motions have beside that, (1 - 1/theta)/h2, 1/s2."""
        return (1.0 - 1.0 / self.theta) / self.step**2


def end_velocity(scheme: Scheme, displacement: Floats, drift: Floats, velocity: Floats) -> Floats:
    """Return v+ of each block, shape (n, 6), from d, the ``drift``, m, and v, (n, 6) each."""
    change = displacement - drift
    result: Floats = velocity + scheme.inertia * scheme.step * change
    if scheme.stopped is not None:
        stopping.add_velocities(scheme.stopped, scheme.of_stopped * scheme.step, change, result)
    return np.asarray(result)


class Integrator(Protocol):
    """An implicit time scheme of the theta family: d = h ((1 - theta) v + theta v+)."""

    @property
    def theta(self) -> float:
        """Share of the end velocity in the displacement, 1/2 to 1."""
        ...


@dataclass(frozen=True)
class ConstantAcceleration:
    """(2/h2) M d = (2/h) M v + F at the end of the step; v+ = (2/h) d - v (Shi 1988)."""

    theta: ClassVar[float] = 0.5


@dataclass(frozen=True)
class BackwardEuler:
    """(1/h2) M d = (1/h) M v + F at the end of the step; v+ = d/h; dissipative."""

    theta: ClassVar[float] = 1.0
