"""A column under its own weight."""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Model, Plane, PlaneStrain, PlaneStress, Trial, problem
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, Variant

GRAVITY, DENSITY, YOUNG, POISSON = 9.8, 2700.0, 5e9, 0.25
HEIGHT, WIDTH = 10.0, 2.0
STIFFNESS = 2e9
WEIGHT = DENSITY * GRAVITY * HEIGHT * WIDTH
STRESS = -0.5 * DENSITY * GRAVITY * HEIGHT
"""Mean vertical stress, Pa."""
STEP, DURATION = 5e-3, 0.5
PLANES: tuple[Plane, ...] = (PlaneStress(), PlaneStrain())
STRAINED = "the weight acts on the shortened column: of the size of its strain, 2.6e-5"


def model_of_column(plane: Plane = PLANES[0]) -> Model:
    """Return a column of 2 m x 10 m on a fixed, smooth floor."""
    builder = new_model(
        "Column", plane=plane, gravity=GRAVITY, young=YOUNG, density=DENSITY, poisson=POISSON
    )
    builder.block(name="floor", vertices=box(-1, -1, 3, 0), fixed=True)
    builder.block(name="column", vertices=box(0, 0, WIDTH, HEIGHT))
    for name, height in (("foot", 0.0), ("top", HEIGHT)):
        builder.measured_point(name, (0.5 * WIDTH, height), block="column")
    return builder.build()


def exact_shortening(plane: Plane) -> float:
    """Return rho g H2/(2 E'), m."""
    modulus = YOUNG if plane.name == "stress" else YOUNG / (1.0 - POISSON**2)
    return -STRESS * HEIGHT / modulus


def settled(plane: Plane, variant: Variant) -> tuple[float, float, float]:
    """Return the vertical stress, Pa, the shortening and the settlement of the foot, m."""
    run = variant.static(
        model_of_column(plane), step=STEP, end=DURATION, p=STIFFNESS, max_displacement=0.05
    )
    foot, top = (float(run.history(name).displacement[-1, 1]) for name in ("foot", "top"))
    return float(run.state.stress[1, 1]), foot - top, -foot


@problem(
    set_up=model_of_column, variants=(LAGGED, EULER, CONVEX, OPEN_CLOSE), quick=(LAGGED, CONVEX)
)
def column(trial: Trial) -> None:
    """Column under its own weight.

    A block of 2 m x 10 m stands on a fixed, smooth floor; E = 5 GPa, nu = 0.25, rho = 2700 kg/m3, g
    = 9.8 m/s2, p = 2 GPa, h = 5 ms, static (dynamic_ratio = 0).

    Exact: sigma_yy = -rho g H/2; shortening rho g H^2/(2E') with E' = E in plane stress, E/(1 -
    nu^2) in plane strain; the foot settles by W/(2p).
    Source: elasticity, averaged over the column (a block has one strain).
    """
    chart = trial.chart("shortening below a height", "shortening, mm", "height, m")
    for plane in PLANES:
        shortening = 1e3 * exact_shortening(plane)
        chart.exact(f"plane {plane.name}", (0.0, shortening), (0.0, HEIGHT))
    shortenings = []
    for plane in PLANES:
        stress, shortening, settlement = settled(plane, trial.variant)
        shortenings.append(shortening)
        exact = exact_shortening(plane)
        sunk = WEIGHT / (2.0 * STIFFNESS)
        case = f"plane {plane.name}"
        trial.relative(f"vertical stress, {case}", "Pa", stress, STRESS, 1e-4, STRAINED)
        trial.relative(f"shortening, {case}", "m", shortening, exact, 1e-4, STRAINED)
        trial.relative(f"settlement of the foot, {case}", "m", settlement, sunk, 1e-6, "at rest")
    chart.computed(1e3 * np.array(shortenings), np.full(len(PLANES), HEIGHT))
