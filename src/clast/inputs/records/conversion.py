"""From a record's quantity to the acceleration that moves the ground, exactly.

Blocks are loaded by the mean acceleration of each step, or by the displacement of the anchors; both
are integrals of the acceleration, and are taken exactly (clast.model.ground_motion).  The ground
starts from rest at its first instant, where its displacement is none.

==============  ==================================================================================
acceleration    linear between the instants
velocity        linear between the instants: the acceleration is (v_k+1 - v_k) / dt in each
                interval and jumps at the instants
displacement    the cubic spline through all instants, from rest, without acceleration at the end:
                the acceleration is linear between the instants.  Straight lines between them would
                be a blow at every instant
==============  ==================================================================================
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clast.errors import CaseError
from clast.inputs.records.series import number_of
from clast.model.ground_motion import Accelerogram
from clast.model.model import Floats

STOP_TIME_S = 1.0
"""Time in which the ground is brought to rest after its record, s."""


@dataclass(frozen=True, kw_only=True)
class Samples:
    """The acceleration of components, linear between instants."""

    time: Floats
    """Instants, s, rising, shape (k,)."""
    acceleration: Floats
    """Acceleration at the instants, m/s2, shape (k, c)."""

    @property
    def interval(self) -> float:
        """Time between two instants, s, where it is always the same."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    def accelerogram(self) -> Accelerogram:
        """Return the motion of two components (x, y)."""
        return Accelerogram(self.time, self.acceleration)


@dataclass(frozen=True, kw_only=True)
class HeldSamples(Samples):
    """The acceleration of components, constant between instants, shape (k - 1, c)."""

    def accelerogram(self) -> Accelerogram:
        """Return the motion of two components (x, y); inner instants stand twice, for the jumps."""
        return Accelerogram(np.repeat(self.time, 2)[1:-1], np.repeat(self.acceleration, 2, axis=0))


def from_velocity(time: Floats, values: Floats) -> Samples:
    """Return the acceleration of velocities, m/s, shape (k, c), that are linear between instants.

    Every velocity but the first is met exactly; the first is none, as the ground starts from rest.
    Raises CaseError where it is more than START_VELOCITY_SHARE_MAX of the largest.
    """
    most = float(np.abs(values).max())
    first = float(np.abs(values[0]).max())
    # Share of the largest velocity up to which a velocity at the first instant is taken as none
    if first > 0.01 * most:
        raise CaseError(
            f"the velocity begins with {first:.3g} m/s, of {most:.3g} m/s at most, but the ground "
            "must start from rest",
            remedy="let it begin with 0: prepend an interval in which it rises from 0",
        )
    moved = np.concatenate([np.zeros_like(values[:1]), values[1:]])
    return HeldSamples(time=time, acceleration=np.diff(moved, axis=0) / np.diff(time)[:, None])


def from_displacement(time: Floats, values: Floats) -> Samples:
    """Return the acceleration of displacements, m, shape (k, c): of a cubic spline through all.

    Displacements count from the first.  The spline begins with no velocity and ends with no
    acceleration.
    """
    from scipy.interpolate import CubicSpline  # slow to load, and few cases need it

    spline = CubicSpline(
        time,
        values - values[0],
        bc_type=((1, np.zeros(values.shape[1])), (2, np.zeros(values.shape[1]))),
    )
    return Samples(time=time, acceleration=spline(time, 2))


CONVERSIONS: dict[str, Callable[[Floats, Floats], Samples]] = {
    "acceleration": lambda time, values: Samples(time=time, acceleration=values),
    "velocity": from_velocity,
    "displacement": from_displacement,
}
"""Quantity -> the acceleration that it stands for."""


def brought_to_rest(record: Accelerogram) -> Accelerogram:
    """Return a record that goes on for one second more, in which the ground comes to rest.

    The acceleration goes on from its last value to a peak in the middle of the second and to 0 at
    its end, both in straight lines; the peak follows from the velocity v and the acceleration a at
    the end of the record: (a + 2 peak) / 4 x 1 s = -v.
    """
    end, last = float(record.time[-1]), record.acceleration[-1]
    peak = -2.0 * record.velocity(end) / STOP_TIME_S - 0.5 * last
    return Accelerogram(
        np.append(record.time, [end + 0.5 * STOP_TIME_S, end + STOP_TIME_S]),
        np.concatenate([record.acceleration, [peak, np.zeros(2)]]),
    )


KNOWN = '"none", "linear", or "highpass:0.1" with the corner frequency in Hz'
HIGHPASS = re.compile(r"highpass:\s*([0-9.eE+-]+)")

Correction = Callable[[Samples], Floats]
"""From samples to their corrected accelerations, of the same shape."""


def correction_of(name: str) -> Correction:
    """Return the correction that a base line asks for; raises CaseError for a name of none."""
    if name in CORRECTIONS:
        return CORRECTIONS[name]
    written = HIGHPASS.fullmatch(name.strip())
    corner = number_of(written[1]) if written else None
    if corner is None or corner <= 0.0:
        raise CaseError(f"'{name}' is not a valid base line", remedy=f"give {KNOWN}")
    return lambda samples: _highpassed(samples, corner)


def _straightened(samples: Samples) -> Floats:
    """Return accelerations without the straight line that fits them best (least squares)."""
    from scipy.signal import detrend  # takes two seconds to load, and few cases need it

    _check_even(samples)
    return np.asarray(detrend(samples.acceleration, axis=0, type="linear"))


def _highpassed(samples: Samples, corner: float) -> Floats:
    """Return accelerations without frequencies below a corner frequency, Hz.

    Butterworth of order 4 forwards and backwards: gain 1 / (1 + (corner / f)^8), 1/2 at the corner,
    no shift of phase.  Before its first and after its last instant the record is continued by its
    mirror image, for as long as the filter remembers.
    """
    from scipy.signal import butter, sosfiltfilt

    _check_even(samples)
    count, interval = len(samples.acceleration), samples.interval
    if not 1.0 / (count * interval) <= corner < 0.5 / interval:
        raise CaseError(
            f"a record of {count * interval:g} s at {interval:g} s has no corner at {corner:g} Hz",
            remedy=f"give a corner from {1.0 / (count * interval):.3g} Hz, one period in the "
            f"record, to below {0.5 / interval:g} Hz, two instants a period",
        )
    sections = butter(4, corner, btype="highpass", fs=1.0 / interval, output="sos")
    memory = min(count - 1, math.ceil(4 / (corner * interval)))
    return np.asarray(sosfiltfilt(sections, samples.acceleration, axis=0, padlen=memory))


def _check_even(samples: Samples) -> None:
    """Refuse intervals that change: neither the line nor the filter knows them."""
    interval = np.diff(samples.time)
    # Share of the interval by which the instants of a record that is filtered may be off
    if np.abs(interval - samples.interval).max() > 1e-3 * samples.interval:
        raise CaseError(
            f"the instants lie {interval.min():g} to {interval.max():g} s apart, and a base line "
            "needs equal intervals",
            remedy='give the record at equal intervals, or baseline = "none"',
        )


CORRECTIONS: dict[str, Correction] = {
    "none": lambda samples: samples.acceleration,
    "linear": _straightened,
}
