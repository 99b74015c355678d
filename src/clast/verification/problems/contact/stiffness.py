"""How stiff the contacts may be: the block on the incline and a dropped block over p.

A penalty must be stiff enough not to be seen and soft enough to be carried.  The process that puts
springs only on vertices which have already invaded, in one pass, has a limit: a block that falls
into a contact during one step is thrown out in the next, and where p h2/m (m: mass per contact)
exceeds about 6 it comes back faster than it went.  Processes that look for the contacts which the
end of the step will have know no such limit.
"""

import numpy as np

from clast.errors import RunStopped
from clast.verification.fixtures import box, new_model
from clast.verification.problems import KnownFailure, Model, Run, Trial, problem
from clast.verification.problems.friction.incline import (
    GRAVITY,
    exact_displacement,
    model_of_incline,
)
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE, PASSES, Variant

FRICTION_ANGLE = 20.0
STIFFNESSES = (1e7, 1e9, 3e10, 1e11, 1e12)
"""Normal stiffnesses p on the incline, N/m per m."""
SLIDE = 0.2
"""Duration of the slide, s."""
SETTLED = 1e9
"""From this stiffness on the vibration of the contacts has died at the end of the slide."""
NUMBERS = (1.0, 6.0, 12.0)
"""p h2/m of the dropped block."""
DROP = 1e-4
"""Height of the drop, m."""
STEP, MASS = 1e-3, 2700.0
NORMAL_FORCE = float(MASS * 4.5 * GRAVITY * np.cos(np.radians(45.0)))
"""Normal force of the slider of 4.5 m2, N/m."""
SOFT = "the paper's 0.66 %, and what the springs give, W cos 45/(2p)"


SLID = ("displacement on the incline", "penetration on the incline")
UNSTABLE = "one pass, springs only after invasion: unstable above p h2/m = 6"
LATE = "friction is that of the pass before: the run does not reach its end"
THROWN = (
    "constant acceleration throws stiff impacts back (p h2/m = 165), and the process has no "
    "remedy: the block hops where its two corners do not land alike"
)


def run_to(model: Model, stiffness: float, end: float, variant: Variant) -> Run | None:
    """Return the run to ``end``, s, or None where it could not go on."""
    try:
        return variant.run(model, step=STEP, end=end, p=stiffness, max_displacement=0.01)
    except RunStopped:
        return None


def slide(stiffness: float, variant: Variant) -> tuple[float, float]:
    """Return the way along the incline / sqrt(2) and the mean penetration, m; nan if stopped."""
    run = run_to(model_of_incline(FRICTION_ANGLE), stiffness, SLIDE, variant)
    if run is None:
        return np.nan, np.nan
    right, up = run.history("A").displacement[-1]
    return float(0.5 * (right - up)), float(-run.state.memory.gap.mean())


def energy_left(number: float, variant: Variant) -> float:
    """Return the kinetic energy at the end over that of the fall, for p h2/m = ``number``."""
    # A stiff block of 1 m x 1 m, 0.1 mm above a fixed floor.
    builder = new_model("Dropped block", gravity=GRAVITY, young=5e13, density=MASS)
    builder.block(name="floor", vertices=box(-1, -0.5, 2, 0), fixed=True)
    builder.block(name="block", vertices=box(0, DROP, 1, 1 + DROP))
    run = run_to(builder.build(), 0.5 * MASS * number / STEP**2, 0.4, variant)
    if run is None:
        return np.inf
    return float(run.energy["kinetic"][-50:].max()) / (MASS * GRAVITY * DROP)


KNOWN = (
    *((LAGGED, f"{what} at p = {p}", UNSTABLE) for what in SLID for p in ("1e+11", "1e+12")),
    (LAGGED, "energy left of a drop at p h2/m = 12", UNSTABLE),
    *((PASSES, f"{what} at p = 1e+12", LATE) for what in SLID),
    *((OPEN_CLOSE, f"{what} at p = 1e+12", THROWN) for what in SLID),
)


@problem(
    set_up=model_of_incline,
    variants=(LAGGED, PASSES, OPEN_CLOSE, CONVEX),
    quick=(),
    known_failures=tuple(KnownFailure(*each) for each in KNOWN),
)
def stiffness(trial: Trial) -> None:
    """How stiff contacts may be.

    The block on the incline at 20 degrees with normal stiffnesses from 10 MPa to 1 TPa, 0.2 s from
    rest, and a block of 1 m x 1 m dropped by 0.1 mm; h = 1 ms. On the incline p h2/m = 1 is at p =
    6.1 GPa.

    Exact: displacement as in the incline problem; penetration N/(2p); a dropped block comes to
    rest.
    Source: Newton's law; the paper's Section 3 has the study.
    """
    exact = exact_displacement(FRICTION_ANGLE, SLIDE)
    errors = []
    for stiffness in STIFFNESSES:
        displacement, penetration = slide(stiffness, trial.variant)
        sunk = 0.5 * NORMAL_FORCE / stiffness
        at = f"at p = {stiffness:.0e}"
        tolerance = 0.0066 + sunk / exact
        trial.relative(
            f"displacement on the incline {at}", "m", displacement, exact, tolerance, SOFT
        )
        if stiffness >= SETTLED:
            quantity = f"penetration on the incline {at}"
            trial.relative(quantity, "m", penetration, sunk, 2e-3, "vibration has not died out yet")
        errors.append(100.0 * abs(displacement / exact - 1.0))
    for number in NUMBERS:
        quantity = f"energy left of a drop at p h2/m = {number:g}"
        trial.absolute(quantity, "", energy_left(number, trial.variant), 0.0, 1e-6, "at rest")
    fine = np.geomspace(STIFFNESSES[0], STIFFNESSES[-1], 60)
    labels = "normal stiffness p, N/m per m", "error, %"
    chart = trial.chart("error of the displacement on the incline", *labels, log="xy")
    chart.exact("tolerance", fine, 100.0 * (0.0066 + 0.5 * NORMAL_FORCE / fine / exact))
    chart.computed(STIFFNESSES, errors)
