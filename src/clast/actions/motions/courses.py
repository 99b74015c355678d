"""Prescribed displacement and velocity over time, with an optional ease.

The velocity is piecewise linear.  An ``ease`` e spreads each of its jumps over a time,

    x~(t) = 1/e int_{t-e}^{t} x,    v~(t) = (x(t) - x(t-e))/e,

the mean of the displacement over the preceding time e: a constant velocity is reached with the
acceleration v/e, and the displacement lags by the time e/2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.factors import Factor
from clast.model.model import Floats


@dataclass(frozen=True, kw_only=True)
class Course:
    """Displacement x(t) of one component, 0 before t = 0; k pieces of constant acceleration."""

    time: Floats
    """Start of each piece, s, increasing from 0, shape (k,); the last one has no end."""
    way: Floats
    """x at the start of each, m or rad, shape (k,)."""
    velocity: Floats
    """Velocity at the start of each, per s, shape (k,)."""
    acceleration: Floats
    """Acceleration in each, per s2, shape (k,)."""
    ease: float = 0.0
    """Time over which jumps of velocity are spread, s."""
    table: str = ""
    """Name of its amplitude, "" for none."""

    def at(self, time: float, last: float = np.inf) -> tuple[float, float]:
        """Return displacement and velocity at a time, s, after its beginning.

        From ``last``, s, on it rests; an ease spreads that jump of the velocity, too.
        """
        if self.ease == 0.0:
            return self._until(last, time)[:2]
        now, _, area = self._until(last, time)
        before, _, area_before = self._until(last, time - self.ease)
        return (area - area_before) / self.ease, (now - before) / self.ease

    @property
    def end(self) -> float:
        """Time from which it is at rest, s; infinity if never."""
        if self.velocity[-1] or self.acceleration[-1]:
            return np.inf
        return float(self.time[-1]) + self.ease

    def _until(self, last: float, time: float) -> tuple[float, float, float]:
        """Return x, its velocity and its integral at a time, s, where it rests from ``last`` on."""
        if time < last:
            return self._way(time)
        x, _, area = self._way(last)
        return x, 0.0, area + (time - last) * x

    def _way(self, time: float) -> tuple[float, float, float]:
        """Return x, its velocity and its integral from 0 at a time, s; 0 before 0."""
        if time <= 0.0:
            return 0.0, 0.0, 0.0
        k = int(np.searchsorted(self.time, time, side="right")) - 1
        x, v, a, since = self.way[k], self.velocity[k], self.acceleration[k], time - self.time[k]
        area = self._areas[k] + since * (x + since * (v / 2.0 + since * a / 6.0))
        return float(x + since * (v + since * a / 2.0)), float(v + since * a), float(area)

    @property
    def _areas(self) -> Floats:
        """Integral of x from 0 to where each piece begins."""
        since, x = np.diff(self.time), self.way[:-1]
        v, a = self.velocity[:-1], self.acceleration[:-1]
        pieces = since * (x + since * (v / 2.0 + since * a / 6.0))
        return np.concatenate([[0.0], np.cumsum(pieces)])


def at_constant_speed(velocity: float, ease: float) -> Course:
    """Return a course with a constant velocity."""
    none = np.zeros(1)
    return Course(time=none, way=none, velocity=np.array([velocity]), acceleration=none, ease=ease)


def along_displacements(table: Factor, scale: float, ease: float) -> Course:
    """Return a course whose way is ``scale`` times a table."""
    time, value = _from_zero(table)
    way = scale * value
    velocity = np.append(np.diff(way) / np.diff(time), 0.0)
    none = np.zeros(len(time))
    return Course(
        time=time, way=way, velocity=velocity, acceleration=none, ease=ease, table=table.name
    )


def along_velocities(table: Factor, scale: float, ease: float) -> Course:
    """Return a course whose velocity is ``scale`` times a table."""
    time, value = _from_zero(table)
    velocity, since = scale * value, np.diff(time)
    acceleration = np.append(np.diff(velocity) / since, 0.0)
    pieces = since * (velocity[:-1] + velocity[1:]) / 2.0
    way = np.concatenate([[0.0], np.cumsum(pieces)])
    return Course(
        time=time,
        way=way,
        velocity=velocity,
        acceleration=acceleration,
        ease=ease,
        table=table.name,
    )


def _from_zero(table: Factor) -> tuple[Floats, Floats]:
    """Return instants from 0 on, s, and the values of a table there."""
    time = np.concatenate([[0.0], table.time[table.time > 0.0]])
    return time, np.interp(time, table.time, table.value)
