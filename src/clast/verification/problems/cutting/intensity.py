"""Intensities of joint sets: length per area, and joints met by a scanline."""

import numpy as np

from clast.rockmass import Baecher, JointSet, PoissonLines, cut
from clast.rockmass.cut_report import frequency
from clast.verification.fixtures import CUT, drawing_of, lines_of, rectangle
from clast.verification.problems import Floats, Model, Trial, problem

SIDE = 100.0
"""Side of the square, m."""
ANGLE, SPACING = 20.0, 2.0
"""Direction of traces and of persistent joints, degrees, and their spacing, m."""
TRACE, BRIDGE = 6.0, 2.0
"""Lengths of traces and of the rock bridges between them, m."""
OFF = 35.0
"""Angle between a scanline and the normal of the joints, degrees."""
ANYWHERE = 2.0
"""P21 of joints of all directions, m/m2."""
TRACES = JointSet(
    name="traces",
    angle=ANGLE,
    spacing=SPACING,
    trace_length=TRACE,
    bridge_length=BRIDGE,
    stagger=0.5,
)
PERSISTENT = JointSet(name="persistent", angle=ANGLE, spacing=SPACING)
ISOTROPIC = {
    "Baecher's traces": JointSet(
        name="traces", model=Baecher(), intensity=ANYWHERE, trace_length=5.0
    ),
    "Poisson's lines": JointSet(name="lines", model=PoissonLines(), intensity=ANYWHERE),
}
TIMES = {"Baecher's traces": 4, "Poisson's lines": 60}
"""How often each is drawn: a hundred lines scatter by a tenth, thousands of traces by less."""
SCANLINES = np.array([0.0, 30.0, 60.0, 90.0, 120.0, 150.0])
"""Directions of scanlines, degrees."""
RIM = "lines begin and end at the rim of 100 m; their number is whole"
CHANCE = "two standard errors of the lines drawn"


def exact_of_traces() -> float:
    """Return t/((t + g) s), m/m2."""
    return TRACE / ((TRACE + BRIDGE) * SPACING)


def exact_on_scanline(angle: Floats | float) -> Floats:
    """Return the persistent joints that scanlines at these angles, degrees, meet, 1/m."""
    off = np.radians(np.asarray(angle) - (ANGLE + 90.0))
    return np.asarray(np.abs(np.cos(off)) / SPACING)


def exact_anywhere() -> float:
    """Return 2 P21/pi, 1/m."""
    return 2.0 * ANYWHERE / np.pi


def met(ends: Floats, angle: float, area: float) -> float:
    """Return how many of the lines (n, 2, 2) scanlines meet, 1/m; ``angle`` degrees, ``area`` m2.

    The mean of all scanlines of that direction: lengths across it over the area.
    """
    displacement = np.radians(angle)
    return frequency(ends, np.array([np.cos(displacement), np.sin(displacement)]), area)


def _drawing() -> Model:
    sets = [TRACES, JointSet(name="across", angle=ANGLE + 80.0, spacing=2.5 * SPACING)]
    return drawing_of(cut(rectangle(40.0, 30.0), sets), "Traces with rock bridges")


@problem(set_up=_drawing, variants=(CUT,), quick=(CUT,))
def intensity(trial: Trial, isotropic: tuple[str, ...] = tuple(ISOTROPIC)) -> None:
    """Intensities of joint sets.

    In 100 m x 100 m: traces of 6 m with bridges of 2 m on lines 2 m apart, persistent joints 2 m
    apart on scanlines of all directions, and joints of all directions with 2 m/m2 (Baecher's traces
    four times, Poisson's lines sixty times). The picture has the blocks between such traces and a
    second set.

    Exact: P21 = t/((t + g) s) = 0.375 m/m2; P10 = |cos d|/s, 0.409576/m at 35 degrees; P10 = 2
    P21/pi for all directions alike.
    Source: stereology: the mean of |cos d| over all directions is 2/pi.
    """
    traces = cut(rectangle(SIDE, SIDE), [TRACES]).report.sets[0]
    persistent, area = lines_of(PERSISTENT, rectangle(SIDE, SIDE)), SIDE**2
    scanline = ANGLE + 90.0 + OFF
    trial.relative("P21 of traces", "m/m2", traces.p21, exact_of_traces(), 0.02, RIM)
    quantity = "P10 of persistent joints at 35 degrees off their normal"
    computed = met(persistent, scanline, area)
    trial.relative(quantity, "1/m", computed, float(exact_on_scanline(scanline)), 0.02, RIM)
    fine = np.linspace(0.0, 180.0, 181)
    chart = trial.chart("joints on a scanline", "direction of the scanline, degrees", "P₁₀, 1/m")
    chart.exact("|cos d|/s", fine, exact_on_scanline(fine))
    chart.exact("2 P₂₁/π", fine, np.full(len(fine), exact_anywhere()))
    crossed = [met(persistent, one, area) for one in SCANLINES]
    chart.computed(SCANLINES, crossed, label="persistent")
    for name in isotropic:
        # The lines of all draws of an isotropic set, m, (n, 2, 2), and their area, m2.
        times, domain = TIMES[name], rectangle(SIDE, SIDE)
        lines = [lines_of(ISOTROPIC[name], domain, seed) for seed in range(times)]
        ends, all_area = np.concatenate(lines), times * SIDE**2
        length = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
        trial.relative(f"P21 of {name}", "m/m2", length / all_area, ANYWHERE, 0.02, CHANCE)
        met_by = np.array([met(ends, one, all_area) for one in SCANLINES])
        worst = met_by[np.abs(met_by - exact_anywhere()).argmax()]
        quantity = f"P10 of {name} along the worst of {len(SCANLINES)} scanlines"
        trial.relative(quantity, "1/m", worst, exact_anywhere(), 0.03, CHANCE)
        chart.computed(SCANLINES, met_by, label=name)
