"""A lining as a cantilever: its deflection, and the moment at which it yields under compression."""

import numpy as np

from clast.verification.problems import InputBuilder, Model, Run, Trial, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

LENGTH, THICKNESS = 2.0, 0.1
"""m."""
YOUNG, POISSON = 30e9, 0.2
PRESSED, PULLED = 30e6, 3e6
"""Strengths, Pa."""
FORCE = 1e3
"""Load across the end, N/m."""
END = 0.3
SPEED = 0.1
"""Speed of the end that is pushed until the section yields, m/s."""
COMPRESSIONS = (0.0, 3e5, 6e5)
"""Normal forces of the section, N/m."""
REASON = "the trapezoidal rule over n segments: 1/(2 n^2)"
YIELDS = "the polygon is 0.3 % inside the curve at most"


def scene(segments: int = 10, turns: float = 0.0, **keys: float) -> Model:
    """Return a cantilever of so many segments to the right of a fixed block, turned by degrees."""
    builder = _beam(segments, turns, **keys)
    displacement = _turned((0.0, -FORCE), turns)
    tip = _turned((LENGTH, 0.0), turns)
    builder.point_load(tip, displacement, block=f"beam/{segments}")
    builder.measured_point("tip", tip, block=f"beam/{segments}")
    return builder.build()


def yielding(compression: float) -> Model:
    """Return a cantilever whose end is pressed, N/m, and pushed down."""
    builder = _beam(20, 0.0, tension=PULLED, compression=PRESSED)
    if compression:
        builder.point_load((LENGTH, 0.0), (-compression, 0.0), block="beam/20")
    builder.motion(name="push", block="beam/20", y=-SPEED, ease=0.05)
    return builder.build()


def _beam(segments: int, turns: float, **keys: float) -> InputBuilder:
    builder = new_model("Cantilever of a lining", young=YOUNG, density=2500.0, poisson=POISSON)
    corners = ((-1.0, -1.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0))
    builder.block(name="wall", vertices=[_turned(one, turns) for one in corners], fixed=True)
    builder.lining(
        "beam",
        polyline=[(0.0, 0.0), _turned((LENGTH, 0.0), turns)],
        side="middle",
        thickness=THICKNESS,
        segment=LENGTH / segments,
        young=YOUNG,
        poisson=POISSON,
        start="clamped",
        **keys,
    )
    return builder


def _turned(point: tuple[float, float], turns: float) -> tuple[float, float]:
    """Return a point turned by degrees."""
    angle = np.radians(turns)
    x, y = point
    return (
        float(np.cos(angle) * x - np.sin(angle) * y),
        float(np.sin(angle) * x + np.cos(angle) * y),
    )


def exact_deflection() -> float:
    """Return the deflection of Timoshenko's beam, m."""
    inertia, shear = THICKNESS**3 / 12.0, YOUNG / (2.0 * (1.0 + POISSON))
    bent = FORCE * LENGTH**3 / (3.0 * YOUNG * inertia)
    return bent + FORCE * LENGTH / (5.0 / 6.0 * shear * THICKNESS)


def exact_moment(compression: float) -> float:
    """Return the moment at which the section yields under a compression, N/m, N."""
    pressed = (PULLED * THICKNESS + compression) / (PULLED + PRESSED)
    return 0.5 * (PULLED + PRESSED) * pressed * (THICKNESS - pressed)


def bent(variant: Variant, model: Model, end: float) -> Run:
    """Return the run."""
    return variant.static(model, step=1e-2, end=end, p=1e10, max_displacement=0.1)


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, PASSES))
def lining_beam(trial: Trial) -> None:
    """Cantilever of a lining.

    A lining of 2 m and 0.1 m, clamped at one end, of 10 and 20 segments, with 1 kN/m across its
    free end, also turned by 37 degrees; then pushed down at its end until the section at the clamp
    yields, under three normal forces. Static (dynamic_ratio = 0), h = 10 ms.

    Exact: w = P L^3/(3 E I) + P L/(k G A);  M = (f_c + f_t) c (t - c)/2.
    Source: beam theory; a rectangular section that has yielded throughout.
    """
    exact = exact_deflection()
    for segments, turns, tolerance in ((10, 0.0, 1e-2), (20, 0.0, 3e-3), (20, 37.0, 3e-3)):
        run = bent(trial.variant, scene(segments, turns), END)
        value = float(np.hypot(*run.history("tip").displacement[-1]))
        name = f"deflection, {segments} segments" + (", turned" if turns else "")
        trial.relative(name, "m", value, exact, tolerance, REASON)
    load = bent(trial.variant, scene(20), END).lining("beam")
    quantity = "moment at the clamp"
    trial.relative(quantity, "N", float(load.moment[-1, 0]), FORCE * LENGTH, 2e-3, REASON)
    inside = np.linspace(-PRESSED * THICKNESS, PULLED * THICKNESS, 50)
    largest = 1e-3 * max(exact_moment(-n) for n in inside)
    labels = ("displacement of the end, mm", "moment, kN")
    chart = trial.chart("moment at the clamp as the end is pushed down", *labels)
    chart.exact("largest that any normal force allows", (0.0, 60.0), (largest, largest))
    for compression in COMPRESSIONS:
        run = bent(trial.variant, yielding(compression), 0.6)
        lining = run.lining("beam")
        value = float(lining.moment[-1, 0])
        exact = exact_moment(-float(lining.normal_force[-1, 0]))
        name = f"moment of the section under {1e-6 * compression:g} MN/m"
        trial.relative(name, "N", value, exact, 1e-2, YIELDS)
        moment, label = 1e-3 * lining.moment[:, 0], f"under {1e-6 * compression:g} MN/m"
        chart.computed(1e3 * SPEED * lining.time, moment, label=label)
