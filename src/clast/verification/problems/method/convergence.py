"""How errors fall with the step and with the normal stiffness, in motion and at rest.

A block of mass m on two contact springs of stiffness p, which carry its weight, swings about its
sag W/(2 p) with

    x = (v/w) sin(w t),    w^2 = 2 p/m,

as long as v/w is less than the sag.  Forces at the end of a step leave an error of first order in
h, those half way one of second order.

On a floor that does not give way a block of height H, which has one strain, swings with

    w^2 = 3 E/(rho H^2);

a column of such blocks at rest is shorter by rho g H^2/(2 E), H its whole height.  Contacts that
give way make the frequency less and the shortening more, by amounts that fall as 1/p.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from clast.verification.problems import Floats, InputBuilder, Model, Trial, box, problem
from clast.verification.variants import CONVEX, HALF_WAY, LAGGED, MIDPOINT, OPEN_CLOSE, Variant

GRAVITY, DENSITY = 9.8, 2500.0
SOFT, RIGID = 1e7, 1e14
"""Normal stiffness p, and Young's modulus, Pa, of the block that swings on its springs."""
CIRCULAR = float(np.sqrt(2.0 * SOFT / DENSITY))
"""w of that block of 1 m2, 1/s."""
SHARE = 0.5
"""Amplitude of the oscillation, in units of the settlement under weight."""
STEPS, TURNED = (80, 160), 2.0
"""Steps of the motion on springs, and w t at its end, rad."""
YOUNG = 1e9
"""Young's modulus of blocks that give way by themselves, Pa."""
RATIOS, STATIC_RATIOS = (25.0, 50.0), (5.0, 10.0)
"""p/E in motion and at rest: one pass needs many steps to come to rest on stiffer contacts."""
PERIODS, STEPS_OF_PERIOD = 2.2, 200
"""Periods of the block that swings by its strain: the time between two upward crossings counts."""
BLOCKS = 3
"""Number of blocks of the column, 1 m x 1 m each."""
STATIC_STEP, STATIC_STEPS = 4e-4, 1500
IN_STEP = "order of the limit of small steps: the next term is (w h)^2 of the error"
IN_STIFFNESS = "order of the limit of stiff contacts: the next term is E/p of the error"
NUMBERS = "(w h)^2/12 of the time scheme is 8e-5"
AT_REST = "gaps are measured in shapes that the weight has strained by 5e-5"


def blocks_at_rest(young: float, stiffness: float, count: int = 1) -> Model:
    """Return blocks of 1 m2 on each other on a fixed floor.

    Young's modulus in Pa, normal stiffness in N/m per m.  One block alone is strained and sagged by
    its weight from the start.
    """
    builder = InputBuilder(title="Convergence", gravity=(0.0, -GRAVITY))
    weight = DENSITY * GRAVITY
    borne = (0.0, -0.5 * weight if count == 1 else 0.0, 0.0)
    builder.add_rock("rock", young=young, poisson=0.0, density=DENSITY, initial_stress=borne)
    builder.add_joint("default", friction_angle=0.0)
    builder.block(name="floor", vertices=box(-1, -1, 2, 0), fixed=True)
    low = -0.5 * weight / stiffness if count == 1 else 0.0
    for number in range(count):
        foot, top = low + number, low + number + 1.0
        builder.block(name=f"{number}", vertices=box(0, foot, 1, top))
    builder.measured_point("top", (0.5, low + count), block=f"{count - 1}")
    return builder.build()


def moved(
    variant: Variant, model: Model, velocity: Floats, p: float, step: float, end: float
) -> tuple[Floats, Floats]:
    """Return times, s, and heights, m, of the top of a block that begins with a velocity (6,)."""
    velocities = np.zeros_like(model.velocity)
    velocities[-1] = velocity
    model = replace(model, velocity=velocities)
    top = variant.run(model, step=step, end=end, p=p, max_displacement=0.05).history("top")
    return top.time, top.displacement[:, 1]


def error_in_step(steps: int, variant: Variant) -> float:
    """Return the error of the block that swings on its springs, in units of its amplitude."""
    size = SHARE * GRAVITY / CIRCULAR**2
    end = TURNED / CIRCULAR
    start = np.array([0.0, size * CIRCULAR, 0.0, 0.0, 0.0, 0.0])
    _, height = moved(variant, blocks_at_rest(RIGID, SOFT), start, SOFT, end / steps, end)
    return float(height[-1] / size - np.sin(TURNED))


def mode(stiffness: float) -> tuple[float, Floats]:
    """Return w, 1/s, and the shape (v0, ey) of the slow swing of a block on its springs."""
    spring = 2.0 * stiffness * np.array([[1.0, -0.5], [-0.5, 0.25]])
    square, shapes = eigh(spring + np.diag([0.0, YOUNG]), DENSITY * np.diag([1.0, 1.0 / 12.0]))
    return float(np.sqrt(square[0])), shapes[:, 0]


def exact_frequency(stiffness: float) -> float:
    """Return w, 1/s, on contacts of a stiffness, N/m per m, which may be infinite."""
    if np.isinf(stiffness):
        return float(np.sqrt(3.0 * YOUNG / DENSITY))
    return mode(stiffness)[0]


def frequency(stiffness: float, variant: Variant) -> float:
    """Return w, 1/s, of the block that swings by its strain, counted over a period."""
    circular, (up, strain) = mode(stiffness)
    # the top goes half of the sag of a block with one strain to and fro
    size = SHARE * 0.5 * DENSITY * GRAVITY / YOUNG
    rate = size * circular / (up + 0.5 * strain)
    period = 2.0 * np.pi / circular
    end = PERIODS * period
    start = rate * np.array([0.0, up, 0.0, 0.0, strain, 0.0])
    step, model = period / STEPS_OF_PERIOD, blocks_at_rest(YOUNG, stiffness)
    time, y = moved(variant, model, start, stiffness, step, end)
    at = np.flatnonzero((y[1:-1] < 0.0) & (y[2:] >= 0.0)) + 1
    crossing = time[at] - y[at] * (time[at + 1] - time[at]) / (y[at + 1] - y[at])
    return float(2.0 * np.pi * (len(at) - 1) / (crossing[-1] - crossing[0]))


def exact_shortening(stiffness: float) -> float:
    """Return how far the top of the column goes down, m, the stiffness as for w."""
    above = DENSITY * GRAVITY * np.arange(BLOCKS, 0, -1)
    springs = stiffness * np.array([2.0] + [4.0] * (BLOCKS - 1))
    return 0.5 * DENSITY * GRAVITY * BLOCKS**2 / YOUNG + float(np.sum(above / springs))


def shortening(stiffness: float, variant: Variant) -> float:
    """Return how far the top of the column goes down in statics, m."""
    run = variant.static(
        blocks_at_rest(YOUNG, stiffness, BLOCKS),
        step=STATIC_STEP,
        end=STATIC_STEPS * STATIC_STEP,
        p=stiffness,
        max_displacement=0.01,
    )
    return -float(run.history("top").displacement[-1, 1])


@problem(
    set_up=lambda: blocks_at_rest(YOUNG, RATIOS[0] * YOUNG, BLOCKS),
    variants=(CONVEX, LAGGED, OPEN_CLOSE, *HALF_WAY),
    quick=(MIDPOINT,),
)
def convergence(trial: Trial) -> None:
    """Convergence in the step and in the stiffness of contacts.

    A block of 1 m2 that rests on its contact springs (p = 10 MPa) swings about its sag, in 80 and
    in 160 steps; one of E = 1 GPa swings by its strain, 200 steps a period, on contacts with p of
    25 and 50 E; and a column of three such blocks stands under its own weight, p of 5 and 10 E,
    static (dynamic_ratio = 0). No contact opens or strikes.

    Exact: error proportional to h with forces at the end of the step and to h^2 half way; w of a
    block with one strain on springs, sqrt(3 E/(rho H^2)) for p without limit; shortening rho g
    H^2/(2 E) + sum of W/(n p): both differ from their limits by 1/p.
    Source: oscillator; elasticity of blocks with one strain each.
    """
    half_way = trial.variant.integrator == "midpoint"
    in_step = [abs(error_in_step(steps, trial.variant)) for steps in STEPS]
    order = float(np.log2(in_step[0] / in_step[1]))
    trial.absolute("order in h", "", order, 2.0 if half_way else 1.0, 0.05, IN_STEP)
    parts = (
        ("frequency", "1/s", RATIOS, frequency, exact_frequency, NUMBERS),
        ("shortening", "m", STATIC_RATIOS, shortening, exact_shortening, AT_REST),
    )
    chart = trial.chart("what contacts that give way change", "p/E", "relative change", log="xy")
    for name, unit, ratios, computed, exact, why in parts:
        runs = np.array([computed(ratio * YOUNG, trial.variant) for ratio in ratios])
        right = np.array([exact(ratio * YOUNG) for ratio in ratios])
        for k, ratio in enumerate(ratios):
            quantity = f"{name} at p = {ratio:g} E"
            trial.relative(quantity, unit, runs[k], right[k], 3e-4, why)
        errors, of_formula = (np.abs(values / exact(np.inf) - 1.0) for values in (runs, right))
        order = float(np.log(errors[0] / errors[1]) / np.log(ratios[1] / ratios[0]))
        trial.absolute(f"order in 1/p, {name}", "", order, 1.0, 0.03, IN_STIFFNESS)
        chart.exact(f"{name} by formula", ratios, of_formula)
        chart.computed(ratios, errors, name)
