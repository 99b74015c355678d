"""Base lines of records: corrections of accelerations before they move the ground."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np

from clast.errors import CaseError
from clast.inputs.records.conversion import Samples
from clast.model.model import Floats

ORDER = 4
"""Order of the Butterworth filter; it runs forwards and backwards, so the phase is kept."""
UNEVEN = 1e-3
"""Share of the interval by which the instants of a record that is filtered may be off."""
KNOWN = '"none", "linear", or "highpass:0.1" with the corner frequency in Hz'
HIGHPASS = re.compile(r"highpass:\s*([0-9.eE+-]+)")

Correction = Callable[[Samples], Floats]
"""From samples to their corrected accelerations, of the same shape."""


def correction_of(name: str) -> Correction:
    """Return the correction that a base line asks for; raises CaseError for a name of none."""
    if name in CORRECTIONS:
        return CORRECTIONS[name]
    found = HIGHPASS.fullmatch(name.strip())
    try:
        corner = float(found[1]) if found else math.nan
    except ValueError:
        corner = math.nan
    if not (math.isfinite(corner) and corner > 0.0):
        raise CaseError(f"'{name}' is not a valid base line", remedy=f"give {KNOWN}")
    return lambda samples: _highpassed(samples, corner)


def _as_it_is(samples: Samples) -> Floats:
    return samples.acceleration


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
    sections = butter(ORDER, corner, btype="highpass", fs=1.0 / interval, output="sos")
    memory = min(count - 1, math.ceil(ORDER / (corner * interval)))
    return np.asarray(sosfiltfilt(sections, samples.acceleration, axis=0, padlen=memory))


def _check_even(samples: Samples) -> None:
    """Refuse intervals that change: neither the line nor the filter knows them."""
    interval = np.diff(samples.time)
    if np.abs(interval - samples.interval).max() > UNEVEN * samples.interval:
        raise CaseError(
            f"the instants lie {interval.min():g} to {interval.max():g} s apart, and a base line "
            "needs equal intervals",
            remedy='give the record at equal intervals, or baseline = "none"',
        )


CORRECTIONS: dict[str, Correction] = {"none": _as_it_is, "linear": _straightened}
