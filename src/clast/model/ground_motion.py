"""Ground motion: an accelerogram, and how it reaches the blocks.

The accelerogram is linear between its instants and is integrated exactly,

    v(t) = v_k + a_k s + b s2/2,    u(t) = u_k + v_k s + a_k s2/2 + b s3/6,    s = t - t_k

with the slope b of the interval that begins at t_k; the ground starts from rest.  Before the first
instant and after the last one it has no acceleration; the velocity it has at the end it keeps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clast.model.arrays import Floats


def highest_frequency(time: Floats, values: Floats) -> float:
    """Return the frequency, Hz, below which 95 % of the power of a record about its mean is.

    ``time`` (k,), s, rises; ``values`` (k, c) are linear between, in any unit.  A straight line
    from the first value to the last counts as of no frequency: a ramp, which a spectrum would take
    for the tooth of a saw. 0 for a record that does not change.
    """
    apart = np.diff(time)
    apart = apart[apart > 0.0]
    if not len(apart):
        return 0.0
    length = float(time[-1] - time[0])
    # Samples of a record at most that its spectrum is taken from
    count = int(min(65_536, max(16.0, np.ceil(length / float(np.median(apart))))))
    share = np.arange(count) / count
    power = np.zeros(count // 2 + 1)
    for component in values.T:
        ramp = (component[-1] - component[0]) * share
        about = np.interp(time[0] + length * share, time, component) - component[0] - ramp
        power += np.abs(np.fft.rfft(about - about.mean())) ** 2
        power[0] += 0.5 * count * np.sum((ramp - ramp.mean()) ** 2)
    whole = np.cumsum(power)
    if not whole[-1] > 0.0:
        return 0.0
    # Share of a record's power that is in frequencies up to its highest significant one
    return float(np.searchsorted(whole, 0.95 * whole[-1]) / length)


@dataclass(frozen=True, repr=False)
class Accelerogram:
    """Acceleration of the ground over time, linear between instants."""

    time: Floats
    """Instants, s, rising, shape (k,); an inner one stands twice where the acceleration jumps."""
    acceleration: Floats
    """Acceleration (x, y) of the ground, m/s2, shape (k, 2)."""

    @cached_property
    def _at_instants(self) -> tuple[Floats, Floats]:
        """Velocity and displacement at the instants, each of shape (k, 2)."""
        length = np.diff(self.time)[:, None]
        first, second = self.acceleration[:-1], self.acceleration[1:]
        velocity = np.zeros(self.acceleration.shape)
        velocity[1:] = np.cumsum(0.5 * length * (first + second), axis=0)
        moved = length * velocity[:-1] + length**2 * (2.0 * first + second) / 6.0
        displacement = np.zeros(self.acceleration.shape)
        displacement[1:] = np.cumsum(moved, axis=0)
        return velocity, displacement

    def __repr__(self) -> str:
        most = np.hypot(*self.acceleration.T).max(initial=0.0)
        return f"Accelerogram({len(self.time)} instants, at most {most:.3g} m/s2)"

    def velocity(self, time: float) -> Floats:
        """Return the velocity (x, y) of the ground, m/s, shape (2,)."""
        return self._integrals(time)[0]

    def displacement(self, time: float) -> Floats:
        """Return the displacement (x, y) of the ground, m, shape (2,)."""
        return self._integrals(time)[1]

    @property
    def fastest(self) -> float:
        """Largest speed of the ground at the instants and half way between them, m/s."""
        speed = self._at_instants[0]
        length = np.diff(self.time)[:, None]
        first, second = self.acceleration[:-1], self.acceleration[1:]
        between = speed[:-1] + length * (3.0 * first + second) / 8.0
        return float(np.hypot(*np.concatenate([speed, between]).T).max(initial=0.0))

    def _integrals(self, time: float) -> tuple[Floats, Floats]:
        velocity, displacement = self._at_instants
        k = int(np.searchsorted(self.time, time, side="right")) - 1
        if k < 0:
            return np.zeros(2), np.zeros(2)
        s = time - self.time[k]
        if k == len(self.time) - 1:
            return velocity[k], displacement[k] + s * velocity[k]
        begin = self.acceleration[k]
        # an instant that stands twice is found at its second place, so no interval is empty here
        slope = (self.acceleration[k + 1] - begin) / (self.time[k + 1] - self.time[k])
        return (
            velocity[k] + s * begin + 0.5 * s**2 * slope,
            displacement[k] + s * velocity[k] + 0.5 * s**2 * begin + s**3 * slope / 6.0,
        )

    def ending(self) -> str:
        """Return how the motion ends, in a sentence: a drift shows in it."""
        end = float(self.time[-1])
        # rounded, and without -0, lest a ground at rest is said to creep
        speed = (np.round(self.velocity(end), 12) + 0.0).tolist()
        end_at = (np.round(self.displacement(end), 12) + 0.0).tolist()
        return (
            f"the ground motion ends at {end:g} s with a velocity of ({speed[0]:.3g}, "
            f"{speed[1]:.3g}) m/s and a displacement of ({end_at[0]:.3g}, {end_at[1]:.3g}) m"
        )


NOTHING = np.zeros(2)


class GroundMotion:
    """The motion of the ground; this one is none, and others override how it acts."""

    def body_acceleration(self, start: float, end: float) -> Floats:
        """Return the mass force per mass in a step from ``start`` to ``end``, s, m/s2, (2,)."""
        return NOTHING

    def anchor_displacement(self, time: float) -> Floats:
        """Return how far the anchors of the fixed points have moved, m, shape (2,)."""
        return NOTHING

    def incoming_velocity(self, start: float, end: float) -> Floats:
        """Return the mean velocity of a wave from below in a step, m/s, shape (2,)."""
        return NOTHING


@dataclass(frozen=True)
class Still(GroundMotion):
    """No ground motion."""


@dataclass(frozen=True)
class InertialForce(GroundMotion):
    """The ground's acceleration a(t) as the body force -rho a(t): motion relative to the ground.

    A step uses the mean of -a over the step, so that the velocity it gives is exact at the end of
    every step whatever the step's length; a value at either end would be of first order only.
    """

    accelerogram: Accelerogram
    """Acceleration of the ground."""

    def body_acceleration(self, start: float, end: float) -> Floats:
        """Return minus the ground's mean acceleration."""
        gained = self.accelerogram.velocity(end) - self.accelerogram.velocity(start)
        return -gained / (end - start)


@dataclass(frozen=True)
class MovingBase(GroundMotion):
    """The anchors of all fixed points move with the ground; the blocks they hold follow.

    The springs of the fixed points act with their elongation at the end of a step, as all springs
    do.  Fixed blocks do not move: a base that moves is held by fixed points.
    """

    accelerogram: Accelerogram
    """Acceleration of the ground."""

    def anchor_displacement(self, time: float) -> Floats:
        """Return the displacement of the ground."""
        return self.accelerogram.displacement(time)


@dataclass(frozen=True)
class IncomingWave(GroundMotion):
    """A wave that comes up through the viscous edges that face down, with the record's velocity.

    Waves that leave the model there are absorbed by the dashpots of these edges.  At a free surface
    the motion doubles: the record of an outcrop has twice the velocity of the wave.
    """

    accelerogram: Accelerogram
    """Acceleration of the wave as it comes up."""

    def incoming_velocity(self, start: float, end: float) -> Floats:
        """Return the wave's mean velocity, so that every step brings its exact impulse."""
        moved = self.accelerogram.displacement(end) - self.accelerogram.displacement(start)
        return np.asarray(moved / (end - start))


Recorded = InertialForce | MovingBase | IncomingWave
"""Ground motions that have an accelerogram."""


def ending_note(motion: GroundMotion) -> tuple[str, ...]:
    """Return how the motion of an accelerogram ends, nothing for other ground motions."""
    if isinstance(motion, Recorded):
        return (motion.accelerogram.ending(),)
    return ()


@dataclass(frozen=True, kw_only=True)
class InStages(GroundMotion):
    """A ground motion in parts of a run; in between the ground rests where it has come to."""

    motion: GroundMotion
    """The motion, as it is from time 0 on."""
    parts: tuple[tuple[float, float], ...] = ()
    """Start and end, s, of each stage in which it acts; the end is inf while that goes on."""

    def body_acceleration(self, start: float, end: float) -> Floats:
        """Return the mean mass force per mass in a step from ``start`` to ``end``, s, m/s2."""
        return self._within(self.motion.body_acceleration, start, end)

    def anchor_displacement(self, time: float) -> Floats:
        """Return how far the anchors of the fixed points have moved, m, shape (2,)."""
        moved = np.zeros(2)
        for begin, stop in self.parts:
            if time > begin:
                moved = moved + self.motion.anchor_displacement(min(time, stop) - begin)
        return moved

    def incoming_velocity(self, start: float, end: float) -> Floats:
        """Return the mean velocity of a wave from below in a step, m/s, shape (2,)."""
        return self._within(self.motion.incoming_velocity, start, end)

    def _within(self, mean: Callable[[float, float], Floats], start: float, end: float) -> Floats:
        """Return a ``mean`` over a step, by the time of the part that it lies in; else nothing."""
        for begin, stop in self.parts:
            if begin <= start and end <= stop:
                return mean(start - begin, end - begin)
        return NOTHING

    def is_over(self, time: float) -> bool:
        """Return whether nothing is left of the motion at a time, s.

        A motion without an accelerogram may always go on.
        """
        length = _length(self.motion)
        return all(time >= min(stop, begin + length) for begin, stop in self.parts)


def is_over(motion: GroundMotion, time: float) -> bool:
    """Return whether nothing is left of a motion of the ground at a time, s."""
    if isinstance(motion, InStages):
        return motion.is_over(time)
    return isinstance(motion, Still) or time >= _length(motion)


def _length(motion: GroundMotion) -> float:
    """Return when the record of a motion ends, s; inf for one without."""
    record = getattr(motion, "accelerogram", None)
    return math.inf if record is None else float(record.time[-1])
