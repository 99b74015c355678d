"""A ground motion that acts in some stages only, its record beginning with each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clast.model.ground_motion import NOTHING, Floats, GroundMotion, Still


@dataclass(frozen=True, kw_only=True)
class InStages:
    """A ground motion in parts of a run; in between the ground rests where it has come to."""

    motion: GroundMotion
    """The motion, as it is from time 0 on."""
    parts: tuple[tuple[float, float], ...] = ()
    """Start and end, s, of each stage in which it acts; the end is inf while that goes on."""

    def body_acceleration(self, start: float, end: float) -> Floats:
        """Return the mean mass force per mass in a step from ``start`` to ``end``, s, m/s2."""
        for begin, stop in self.parts:
            if begin <= start and end <= stop:
                return self.motion.body_acceleration(start - begin, end - begin)
        return NOTHING

    def anchor_displacement(self, time: float) -> Floats:
        """Return how far the anchors of the fixed points have moved, m, shape (2,)."""
        moved = np.zeros(2)
        for begin, stop in self.parts:
            if time > begin:
                moved = moved + self.motion.anchor_displacement(min(time, stop) - begin)
        return moved

    def incoming_velocity(self, start: float, end: float) -> Floats:
        """Return the mean velocity of a wave from below in a step, m/s, shape (2,)."""
        for begin, stop in self.parts:
            if begin <= start and end <= stop:
                return self.motion.incoming_velocity(start - begin, end - begin)
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
