"""Direct shear of a rough joint: closure, peak strength and dilation after Barton and Bandis.

A block is pressed on a joint and drawn along it beside a frame, an elastic bar of stiffness K, that
takes what the joint does not: the joint carries T = F - K u, and there is an equilibrium at every
slip u.  With i = JRC log10(JCS/sigma) and x = u/u_peak

    closure   sigma V_m/(k_ni V_m + sigma)
    strength  sigma tan(phi_r + m(x) i)            m by the table of Barton, Bandis & Bakhtar (1985)
    opening   u_peak times the integral of tan(m(x) i/2)

u_peak = (L/500) (JRC/L)^0.33, k_ni and V_m by the formulas of Bandis et al. (1983).
"""

import numpy as np

from clast.verification.problems import Floats, Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, OPEN_CLOSE, PASSES, Variant

JRC, JCS, RESIDUAL, LENGTH = 10.0, 100e6, 28.0, 1.0
"""Roughness, strength of the walls, Pa, residual friction angle, degrees, and length, m."""
X = (0.0, 0.3, 0.6, 1.0, 2.0, 4.0, 10.0, 25.0, 100.0)
M = (-1.0, 0.0, 0.75, 1.0, 0.85, 0.7, 0.5, 0.4, 0.0)
"""Slip over u_peak, and share of i mobilised, the first -phi_r/i."""
PEAK_SLIP = LENGTH / 500.0 * (JRC / LENGTH) ** 0.33
WALLS = 1e-6 * JCS / (JRC / 50.0)
"""JCS over the initial aperture of JRC/50 mm, MPa/mm."""
STIFFNESS = 1e9 * (-7.15 + 1.75 * JRC + 0.02 * WALLS)
CLOSURE = 1e-3 * (-0.296 - 0.0056 * JRC + 2.241 * WALLS**-0.245)
"""k_ni, Pa/m, and V_m, m."""
STRESSES = (0.2e6, 1e6, 5e6)
CLOSING = (0.1e6, 1e6, 10e6)
"""Normal stresses of shearing and of closing, Pa."""
FARTHEST = 2.5
"""Slip at the end, in units of u_peak, at least."""
PRESSED, DRAWN, END, STEPS = 1.0, 8.0, 8.5, 400
"""When the block is pressed and drawn, s, and steps; in the end the load stays."""
LATE = "strength beyond the peak is that of the start of a step: some per cent of u_peak"


def roughness(stress: float) -> float:
    """Return i, degrees, under a normal stress, Pa."""
    return JRC * float(np.log10(JCS / stress))


def strength(slip: Floats, stress: float) -> Floats:
    """Return T/N mobilised after slips, m, (k,)."""
    x, angle = slip / PEAK_SLIP, roughness(stress)
    mobilised = np.interp(x, X, M) * angle
    mobilised = np.where(x < X[1], -RESIDUAL * (1.0 - x / X[1]), mobilised)
    return np.asarray(np.tan(np.radians(RESIDUAL + mobilised)))


def opened(slip: Floats, stress: float) -> Floats:
    """Return the opening after slips, m, (k,), by integration in small steps."""
    x = np.linspace(0.0, 2.0 * FARTHEST, 100_001)
    share = np.maximum(0.0, np.interp(x, X, M))
    slope = np.tan(np.radians(0.5 * share * roughness(stress)))
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(x))])
    return np.asarray(PEAK_SLIP * np.interp(slip / PEAK_SLIP, x, summed))


def frame(stress: float) -> float:
    """Return the stiffness of the frame, N/m per m: more than the joint loses by slip."""
    return 0.3 * stress * LENGTH / PEAK_SLIP


def shear_box(stress: float = STRESSES[1], pull: float = 0.0) -> Model:
    """Return a block on a rough joint, pressed, Pa, and drawn at its foot with a force, N/m."""
    builder = new_model("Direct shear of a rough joint", young=5e13, density=2500.0, poisson=0.0)
    builder.add_joint(
        law="barton-bandis",
        jrc=JRC,
        jcs=JCS,
        residual_friction_angle=RESIDUAL,
        sample_length=LENGTH,
    )
    base = box(-0.5, -0.2, 2.0, 0.0)
    builder.block(name="base", vertices=base, fixed=True)
    anchor = box(-3.0, -0.2, -2.0, 0.2)
    builder.block(name="anchor", vertices=anchor, fixed=True)
    builder.block(name="block", vertices=box(0.0, 0.0, LENGTH, 0.1))
    builder.line_load((0.0, 0.1), (LENGTH, 0.1), (0.0, -stress))
    builder.add_bolt_kind("frame", stiffness=frame(stress), compression=True)
    middle = 0.5 * LENGTH
    builder.bolt((middle, 1e-3), (-2.5, 1e-3), kind="frame", name="frame")
    grows = builder.add_amplitude("grows", [0.0, PRESSED, DRAWN], [0.0, 0.0, 1.0])
    builder.point_load((middle, 0.0), (pull, 0.0), block="block", amplitude=grows)
    builder.measured_point("foot", (middle, 0.0), block="block")
    return builder.build()


def sheared(stress: float, variant: Variant) -> tuple[Floats, Floats, Floats]:
    """Return slip, m, T/N and opening since it was pressed, m, (k,) each, while it is drawn."""
    pull = frame(stress) * FARTHEST * PEAK_SLIP + 1.3 * stress * LENGTH
    run = variant.static(
        shear_box(stress, pull), step=END / STEPS, end=END, p=1e11, max_displacement=0.05
    )
    history = run.history("foot")
    # time waits in convex static steps until a load is in balance, whose last step counts
    last = np.append(np.diff(history.time) > 0.0, True) & (history.time > PRESSED)
    slip, opening = history.displacement[last].T
    share = (history.time[last] - PRESSED) / (DRAWN - PRESSED)
    load = pull * np.minimum(1.0, share)
    pressed = history.displacement[history.time <= PRESSED][-1, 1]
    return slip, (load - frame(stress) * slip) / (stress * LENGTH), opening - pressed


@problem(
    set_up=shear_box,
    variants=(PASSES, OPEN_CLOSE, CONVEX, CONVEX_MULTIPLIERS),
    few=(STRESSES[1:2],),
)
def rough_joint(trial: Trial, stresses: tuple[float, ...] = STRESSES) -> None:
    """Direct shear of a rough joint.

    A block of 1 m on a joint with JRC = 10, JCS = 100 MPa, phi_r = 28 degrees is pressed with 0.1
    to 10 MPa, and drawn beside an elastic frame under 0.2, 1 and 5 MPa; static, 300 steps.

    Exact: sigma = k_ni u/(1 - u/V_m); T/N = tan(phi_r + m JRC log10(JCS/sigma)).
    Source: Bandis, Lumsden & Barton 1983; Barton & Choubey 1977; Barton, Bandis & Bakhtar 1985.
    """
    for stress in CLOSING:
        exact = stress * CLOSURE / (STIFFNESS * CLOSURE + stress)
        which = f"closure under {1e-6 * stress:g} MPa"
        run = trial.variant.static(
            shear_box(stress), step=0.05, end=1.0, p=1e11, max_displacement=0.05
        )
        trial.relative(
            which, "m", -float(run.history("foot").displacement[-1, 1]), exact, 5e-3, "formula"
        )
    strengths = trial.chart("shear strength mobilised", "slip, mm", "T/N")
    openings = trial.chart("opening", "slip, mm", "opening, mm")
    for stress in stresses:
        slip, ratio, opening = sheared(stress, trial.variant)
        at = f"under {1e-6 * stress:g} MPa"
        peak = float(strength(np.array([PEAK_SLIP]), stress)[0])
        trial.relative(f"peak T/N {at}", "-", float(ratio.max()), peak, 5e-3, "formula")
        for x in (0.5, 2.0):
            near = int(np.argmin(np.abs(slip - x * PEAK_SLIP)))
            exact = float(strength(slip[near : near + 1], stress)[0])
            what = f"T/N near {x:g} u_peak {at}"
            trial.relative(what, "-", float(ratio[near]), exact, 0.01, LATE)
        exact = float(opened(slip[-1:], stress)[0])
        trial.relative(f"opening {at}", "m", float(opening[-1]), exact, 5e-3, "integral")
        fine = np.linspace(0.0, float(slip[-1]), 200)
        label = f"{1e-6 * stress:g} MPa"
        strengths.exact(f"formula, {label}", 1e3 * fine, strength(fine, stress))
        strengths.computed(1e3 * slip[::8], ratio[::8], label=label)
        openings.exact(f"formula, {label}", 1e3 * fine, 1e3 * opened(fine, stress))
        openings.computed(1e3 * slip[::8], 1e3 * opening[::8], label=label)
