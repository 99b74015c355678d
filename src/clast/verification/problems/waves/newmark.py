"""Newmark's sliding block: how far a slope slides in an earthquake."""

import numpy as np
from scipy.optimize import brentq

from clast.inputs.builder import InputBuilder
from clast.model.ground_motion import Accelerogram, InertialForce, MovingBase
from clast.verification.problems import Floats, KnownFailure, Model, Run, Trial, problem
from clast.verification.variants import BOTH_LAWS, CHATTERS, MULTIPLIERS

GRAVITY = 9.81
SLOPE, FRICTION = np.radians(20.0), np.radians(30.0)
"""Dip of the plane a and friction angle phi, rad."""
YIELD = float(GRAVITY * np.tan(FRICTION - SLOPE))
"""Yield acceleration, m/s2: 1.729768."""
FACTOR = float(np.cos(FRICTION - SLOPE) / np.cos(FRICTION))
"""Acceleration down the plane per acceleration beyond the yield: 1.137158."""
PEAK, CIRCULAR = 0.5 * GRAVITY, 2.0 * np.pi
"""Largest acceleration of the ground, m/s2, and its circular frequency, 1/s: one cycle a second."""
STEP, SAMPLING = 2e-3, 1e-3
"""Step, and distance of the instants of the accelerogram, s."""
ACTS: dict[str, type[InertialForce] | type[MovingBase]] = {
    "body force": InertialForce,
    "moving base": MovingBase,
}
"""The two ways of shaking."""
STOPPED = 5e-3
"""Speed below which the block has stopped, m/s; its shear springs then ring by twice as much."""
FIRST_ORDER = "first order in h where sliding begins and ends"


def begin() -> float:
    """Return when the block begins to slide, s: 0.0573604."""
    return float(np.arcsin(YIELD / PEAK) / CIRCULAR)


def speed(time: float | Floats) -> Floats:
    """Return the speed down the plane, m/s, ``time`` s into the first slide."""
    swung = np.cos(CIRCULAR * begin()) - np.cos(CIRCULAR * np.asarray(time))
    gained = PEAK / CIRCULAR * swung - YIELD * (np.asarray(time) - begin())
    return np.asarray(FACTOR * gained)


def end() -> float:
    """Return when the block has stopped, s: 0.6777028."""
    return float(brentq(lambda t: float(speed(t)), 0.5, 1.0))


def exact_displacement(time: float) -> float:
    """Return the displacement down the plane after ``time``, s, m: 0.31361979 a cycle."""
    cycles, rest = divmod(time + 1e-12, 1.0)
    first, last = begin(), end()

    def until(t: float) -> float:
        if t <= first:
            return 0.0
        s = min(t, last) - first
        swung = np.sin(CIRCULAR * (first + s)) - np.sin(CIRCULAR * first)
        slid = PEAK / CIRCULAR * (np.cos(CIRCULAR * first) * s - swung / CIRCULAR)
        return float(FACTOR * (slid - 0.5 * YIELD * s**2))

    return cycles * until(1.0) + until(rest)


def shaken_slope(acts: str = "moving base", cycles: int = 2) -> Model:
    """Return a wedge held at two corners, a block on it, and the ground motion."""
    along = np.array([np.cos(SLOPE), np.sin(SLOPE)])
    up = np.array([-along[1], along[0]])
    time = np.arange(0.0, cycles + 0.5 * SAMPLING, SAMPLING)
    shaking = np.stack([PEAK * np.sin(CIRCULAR * time), np.zeros(len(time))], axis=1)
    builder = InputBuilder(
        title="Newmark's block",
        gravity=(0.0, -GRAVITY),
        ground_motion=ACTS[acts](Accelerogram(time, shaking)),
    )
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=float(np.degrees(FRICTION)))
    builder.block(name="slope", vertices=[0 * along, (4 * along[0], 0), 4 * along])
    builder.fixed_point((0.0, 0.0))
    builder.fixed_point((4 * along[0], 0.0))
    low = 2.5 * along
    builder.block(name="block", vertices=[low, low + along, low + along + 0.5 * up, low + 0.5 * up])
    builder.measured_point("slope", 2.0 * along, block="slope")
    builder.measured_point("block", low + 0.5 * along + 0.25 * up, block="block")
    return builder.build()


def sliding(run: Run) -> tuple[Floats, Floats]:
    """Return time, s, and displacement of the block down the plane relative to the slope, m."""
    block, slope = run.history("block"), run.history("slope")
    moved = block.displacement - slope.displacement
    return block.time, -moved @ np.array([np.cos(SLOPE), np.sin(SLOPE)])


@problem(
    set_up=shaken_slope,
    variants=BOTH_LAWS,
    few=(("moving base",), 1),
    known_failures=(KnownFailure(MULTIPLIERS, "displacement in", CHATTERS),),
)
def newmark(trial: Trial, acts: tuple[str, ...] = tuple(ACTS), cycles: int = 2) -> None:
    """Newmark's sliding block.

    A block of 1 m x 0.5 m on a slope of 20 degrees with a friction angle of 30 degrees; the ground
    accelerates by 0.5 g sin(2 pi t), g = 9.81 m/s2, for two cycles of 1 s, as the motion of the
    slope's fixed points and as a body force. p = 0.1 GPa, h = 2 ms.

    Exact: slip'' = cos(phi - a)/cos(phi) (a_ground - g tan(phi - a)) while it slides: from 0.05736
    to 0.67770 s, 0.31361979 m a cycle.
    Source: Newmark (1965); integrated in closed form.
    """
    fine = np.linspace(0.0, cycles, 400)
    exact_slides = [exact_displacement(t) for t in fine]
    for one in acts:
        time, moved = sliding(
            trial.variant.run(
                shaken_slope(one, cycles),
                step=STEP,
                end=float(cycles),
                p=1e8,
                max_displacement=0.02,
            )
        )
        rate = np.gradient(moved, time)
        stopped = float(time[np.flatnonzero((time > begin() + 0.1) & (rate < STOPPED))[0]])
        exact = exact_displacement(float(cycles))
        quantity = f"displacement in {cycles} s, {one}"
        trial.relative(quantity, "m", moved[-1], exact, 0.002, FIRST_ORDER)
        trial.absolute(f"end of the slide, {one}", "s", stopped, end(), 2.5 * STEP, "steps of 2 ms")
        labels = ("time, s", "relative displacement, m")
        chart = trial.chart(f"displacement down the plane, {one}", *labels)
        chart.exact("Newmark", fine, exact_slides)
        chart.computed(time[::50], moved[::50])
