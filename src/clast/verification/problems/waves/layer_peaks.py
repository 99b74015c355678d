"""Resonant peaks of a soft layer at 20 steps a period of the highest.

The layer of the problem "layer" has peaks of surface by outcrop of 1/a at (2 m - 1) c_1/(4 H).
Forces at the end of the step would damp the third by 15 %; those half way through it damp none.
The remaining error is the blocks' size: with lambda/d blocks a wave, strained evenly each, the pile
has

    1/a (1 + (2 pi d/lambda)^2/24)

(the impedance of linear finite elements with consistent masses), 2.6 % too much with 8 blocks a
wave, 0.6 % with 16.
"""

from __future__ import annotations

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.problems import Model, PointHistory, Trial, problem, relative
from clast.verification.problems.waves.layer import (
    HEIGHT,
    RATIO,
    SOFT,
    STIFF,
    amplification,
    exact_amplification,
    pile,
    pulse,
)
from clast.verification.variants import MIDPOINT, MIDPOINT_OPEN_CLOSE, MIDPOINT_PASSES

BLOCKS, PULSE = 20, 0.05
"""Number of blocks, and length of the pulse, s: up to 20 Hz."""
PEAKS = tuple((2 * mode - 1) * SOFT[0] / (4.0 * HEIGHT) for mode in (1, 2, 3))
"""Frequencies of the peaks, Hz: 2.5, 7.5 and 12.5."""
STEP, DURATION = 1.0 / (20.0 * PEAKS[-1]), 4.0
NEAR = 0.04
"""Half of the band, as a share of its middle, in which a peak is looked for."""
WHY = "16 blocks a wave of the third peak: 0.6 %; 20 steps a period: 0.9 %"


def struck() -> Model:
    """Return the layer, and a pulse of shear from below."""
    return pile(pulse(PULSE), BLOCKS)


def peak(surface: PointHistory, frequency: float) -> float:
    """Return the largest ratio of surface by outcrop near a frequency, Hz."""
    near = frequency * np.linspace(1.0 - NEAR, 1.0 + NEAR, 81)
    return max(amplification(surface, one, PULSE) for one in near)


@problem(
    set_up=struck, variants=(MIDPOINT, MIDPOINT_PASSES, MIDPOINT_OPEN_CLOSE), quick=(MIDPOINT,)
)
def layer_peaks(trial: Trial) -> None:
    """Resonant peaks of a soft layer.

    The layer of 20 m of the problem before, of 20 blocks, with forces half way through the step
    (integrator = midpoint): a pulse of shear of 0.05 s comes up; h = 4 ms, 20 steps a period of the
    third peak.

    Exact: 1/a = 5.5, a = rho_1 c_1/(rho_2 c_2), at (2 m - 1) c_1/(4 H) = 2.5, 7.5 and 12.5 Hz.
    Source: vertical shear waves in a layer on an elastic half-space; Kramer (1996).
    """
    model = struck()
    surface = trial.variant.run(
        model, step=STEP, end=DURATION, normal_stiffness=STIFF, max_displacement=0.05
    ).history("surface")
    trial.rows += [
        relative(f"peak at {one:g} Hz", "", peak(surface, one), 1.0 / RATIO, 0.02, WHY)
        for one in PEAKS
    ]
    fine, some = np.linspace(0.5, 14.0, 400), np.linspace(0.5, 14.0, 109)
    trial.chart(
        "amplification",
        "frequency, Hz",
        "surface / outcrop",
        exact_curve("formula", fine, [exact_amplification(f) for f in fine]),
        curve(trial.variant.name, some, [amplification(surface, f, PULSE) for f in some]),
    )
