"""A block on a moving base: stick, slip and stick again."""

import numpy as np

from clast.model.ground_motion import Accelerogram, MovingBase
from clast.verification.problems import Floats, InputBuilder, Model, Trial, box, problem
from clast.verification.variants import MULTIPLIERS, WITH_EULER

GRAVITY, FRICTION_ANGLE = 9.8, 15.0
GRIP = GRAVITY * float(np.tan(np.radians(FRICTION_ANGLE)))
"""Largest acceleration that friction gives the block, m/s2: 2.626."""
PEAK, CIRCULAR = 4.0, 2.0 * np.pi
"""Largest acceleration of the base, m/s2, and its circular frequency, 1/s."""
SAMPLING, DURATION = 1e-3, 1.5
INSTANTS = (0.4, 0.8, 1.2, 1.5)
"""Times at which block and base are compared, s."""
FIRST_ORDER = "first order in h where slip begins and ends"


def base_speed(time: float | Floats) -> Floats:
    """Return the speed of the base, m/s."""
    return np.asarray(PEAK / CIRCULAR * (1.0 - np.cos(CIRCULAR * np.asarray(time))))


def base_displacement(time: float | Floats) -> Floats:
    """Return the displacement of the base, m."""
    t = np.asarray(time)
    return np.asarray(PEAK / CIRCULAR * (t - np.sin(CIRCULAR * t) / CIRCULAR))


def phases() -> list[tuple[float, float, float]]:
    """Return the slips: begin and end, s, and the block's acceleration, m/s2."""
    fine = np.linspace(0.0, DURATION, 30001)
    slips: list[tuple[float, float, float]] = []
    last = 0.0
    while True:
        asked = PEAK * np.sin(CIRCULAR * fine)
        begins = fine[(fine >= last) & (np.abs(asked) > GRIP)]
        if len(begins) == 0:
            return slips
        begin = float(begins[0])
        pull = float(np.copysign(GRIP, np.sin(CIRCULAR * begin)))
        later = fine[fine > begin]
        ahead = base_speed(later) - base_speed(begin) - pull * (later - begin)
        caught = np.flatnonzero(ahead * pull < 0.0)
        last = float(later[caught[0]]) if len(caught) else DURATION
        slips.append((begin, last, pull))
        if len(caught) == 0:
            return slips


def exact_displacement(time: Floats) -> Floats:
    """Return the displacement of the block, m, at ``time``, s, shape (k,)."""
    displacement = base_displacement(time)
    for begin, end, pull in phases():
        # what the block falls behind the base while it slips, and keeps afterwards
        s = np.clip(time, begin, end) - begin
        goes = base_speed(begin) * s + 0.5 * pull * s**2
        displacement += goes - (base_displacement(begin + s) - base_displacement(begin))
    return displacement


def shaken_block() -> Model:
    """Return a block of 1 m x 0.5 m on a base that is held by two fixed points."""
    time = np.arange(0.0, DURATION + 0.5 * SAMPLING, SAMPLING)
    shaking = np.stack([PEAK * np.sin(CIRCULAR * time), np.zeros(len(time))], axis=1)
    motion = MovingBase(Accelerogram(time, shaking))
    builder = InputBuilder(title="Moving base", gravity=(0.0, -GRAVITY), ground_motion=motion)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=FRICTION_ANGLE)
    builder.block(name="base", vertices=box(-1, -0.5, 2, 0))
    builder.fixed_point((-1, -0.5))
    builder.fixed_point((2, -0.5))
    builder.block(name="block", vertices=box(0, 0, 1, 0.5))
    builder.measured_point("base", (0.5, -0.5), block="base")
    builder.measured_point("block", (0.5, 0.25), block="block")
    return builder.build()


@problem(set_up=shaken_block, variants=(*WITH_EULER, MULTIPLIERS), quick=())
def moving_base(trial: Trial) -> None:
    """Block on a moving base: stick and slip.

    A block of 1 m x 0.5 m on a base whose fixed points move with the acceleration 4 m/s2 sin(2 pi
    t); phi = 15 degrees, so that friction gives the block 2.63 m/s2. p = 0.1 GPa, h = 2 ms.

    Exact: speed' = that of the base while it sticks, g tan(phi) of either sign while it slips.
    Source: Newton's law with Coulomb friction, integrated in closed form between the instants at
    which slip begins and ends.
    """
    run = trial.variant.run(shaken_block(), step=2e-3, end=DURATION, p=1e8, max_displacement=0.02)
    base, block = run.history("base"), run.history("block")
    moved = block.displacement[:, 0]
    for instant in INSTANTS:
        at = int(np.argmin(np.abs(block.time - instant)))
        exact = float(exact_displacement(np.array([instant]))[0])
        quantity = f"displacement of the block at {instant:g} s"
        trial.absolute(quantity, "m", moved[at], exact, 1e-3, FIRST_ORDER)
    exact = float(base_displacement(DURATION))
    quantity = f"displacement of the base at {DURATION:g} s"
    trial.absolute(quantity, "m", base.displacement[-1, 0], exact, 1e-4, "its springs give")
    fine = np.linspace(0.0, DURATION, 300)
    chart = trial.chart("displacement", "time, s", "displacement, m")
    chart.exact("base", fine, base_displacement(fine))
    chart.exact("block", fine, exact_displacement(fine))
    chart.computed(block.time[::50], moved[::50], "block")
