"""A free-standing block under one cycle of ground acceleration: two ways to fall, a safe region."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from clast.model.ground_motion import Accelerogram, InertialForce
from clast.verification.problems import Floats, InputBuilder, Model, Trial, box, problem
from clast.verification.variants import CONVEX

GRAVITY, WIDTH, HEIGHT = 9.81, 0.5, 2.0
RADIUS = 0.5 * float(np.hypot(WIDTH, HEIGHT))
"""Half diagonal R, m."""
SLENDERNESS = float(np.arctan2(WIDTH, HEIGHT))
"""Angle a, rad."""
SQUARE = 0.75 * GRAVITY / RADIUS
"""p2, 1/s2."""
KEPT = 1.0 - 1.5 * float(np.sin(SLENDERNESS)) ** 2
"""Share of its rate that an impact leaves: 0.9118."""
FALLEN = 1.2
"""Tilt to which a fall is followed, rad."""
SLOW = 1e-4
"""Rate of a block that has come to rest, rad/s."""
END, STEP, SAMPLING = 2.8, 2e-3, 1e-3
"""How long a block is watched, its step and the instants of the ground motion, s."""
CLOSE = "0.03 g on either side of where it changes"
IMPACTS = "an impact takes some steps"


@dataclass(frozen=True)
class Pulse:
    """One cycle of sine or cosine."""

    kind: str
    phase: float
    period: float
    """Period T, s."""

    def shape(self, time: Floats | float) -> Floats:
        """Return the acceleration of the ground over its amplitude."""
        t = np.asarray(time, float)
        wave = np.sin(2.0 * np.pi * t / self.period + self.phase)
        return np.where((t >= 0.0) & (t <= self.period), wave, 0.0)


SINE, COSINE = Pulse("sine", 0.0, 0.5), Pulse("cosine", 0.5 * np.pi, 1.0)
SHAKEN = {SINE: (0.59, 0.65, 1.51, 1.57, 1.65, 1.71), COSINE: (0.36, 0.42, 1.25, 1.31)}
"""Amplitudes over g: on either side of 0.62, 1.54 and 1.68, and of 0.39 and 1.28."""


def exact_tilt(pulse: Pulse, amplitude: float, end: float) -> tuple[Floats, Floats]:
    """Return time, s, and tilt, rad, of the block until it has fallen or ``end``, s.

    ``amplitude`` is that of the ground's acceleration over g.
    """
    fine = np.linspace(0.0, pulse.period, 20001)
    asked = amplitude * pulse.shape(fine)
    begins = np.flatnonzero(np.abs(asked) > np.tan(SLENDERNESS))
    if len(begins) == 0:
        return np.array([0.0, end]), np.zeros(2)
    now, tilt, rate = float(fine[begins[0]]), 0.0, 0.0
    # the ground goes to the right, the block leans to the left
    side = -float(np.sign(asked[begins[0]]))
    times, tilts = [np.array([0.0, now])], [np.zeros(2)]

    def motion(time: float, state: Floats, side: float) -> tuple[float, float]:
        corner = side * SLENDERNESS - state[0]
        return state[1], -SQUARE * (
            np.sin(corner) + amplitude * float(pulse.shape(time)) * np.cos(corner)
        )

    def strikes(_: float, state: Floats, side: float) -> float:
        return float(side * state[0])

    def falls(_: float, state: Floats, side: float) -> float:
        return float(side * state[0]) - FALLEN

    strikes.terminal, strikes.direction = True, -1.0  # type: ignore[attr-defined]
    falls.terminal = True  # type: ignore[attr-defined]
    while now < end:
        # the cosine ends with a jump
        until = pulse.period if now < pulse.period else end
        part = solve_ivp(
            motion,
            (now, until),
            (tilt, rate),
            args=(side,),
            events=(strikes, falls),
            max_step=1e-2,
            rtol=1e-8,
            atol=1e-10,
        )
        times.append(part.t)
        tilts.append(part.y[0])
        now, tilt, rate = float(part.t[-1]), float(part.y[0, -1]), float(part.y[1, -1])
        if len(part.t_events[1]):
            break
        if len(part.t_events[0]):
            tilt, rate, side = 0.0, KEPT * rate, -side
            if now > pulse.period and abs(rate) < SLOW:
                break
    return np.concatenate(times), np.concatenate(tilts)


def standing_block(pulse: Pulse = SINE, amplitude: float = 0.7) -> Model:
    """Return the block on a floor whose motion acts on it as a body force."""
    time = np.arange(0.0, pulse.period + 0.5 * SAMPLING, SAMPLING)
    along = amplitude * GRAVITY * pulse.shape(np.minimum(time, pulse.period))
    # the cosine begins and ends with a jump
    time, along = np.append(time, pulse.period + 1e-6), np.append(along, 0.0)
    shaking = Accelerogram(time, np.stack([along, np.zeros(len(time))], axis=1))
    motion = InertialForce(shaking)
    builder = InputBuilder(title="Rocking block", gravity=(0.0, -GRAVITY), ground_motion=motion)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=70.0)
    builder.block(name="floor", vertices=box(-4, -0.4, 4, 0), fixed=True)
    half = 0.5 * WIDTH
    builder.block(name="block", vertices=box(-half, 0.0, half, HEIGHT))
    builder.measured_point("centroid", (0.0, 0.5 * HEIGHT), block="block")
    return builder.build()


def stands(tilt: Floats) -> float:
    """Return 1 for a block that is not tilted beyond its balance at the end, else 0."""
    return float(abs(tilt[-1]) < SLENDERNESS)


@problem(set_up=standing_block, variants=(CONVEX,), quick=())
def rocking_spectrum(trial: Trial, shaken: dict[Pulse, tuple[float, ...]] = SHAKEN) -> None:
    """Block that rocks under one cycle of the ground.

    A block of 0.5 m x 2 m under one cycle of sine of 0.5 s and one of cosine of 1 s, as a body
    force, at amplitudes 0.03 g on either side of those at which it begins or ceases to fall; p = 5
    GPa, h = 2 ms, friction angle 70 degrees. Tilts above 1.2 are blocks that fall.

    Exact: t'' = -p^2 (sin(+-a - t) + u''/g cos(+-a - t)), each impact leaves 1 - 3/2 sin^2 a of the
    rate; sine: falls from 0.62 to 1.54 g and above 1.68 g, stays up between.
    Source: Housner (1963), Zhang & Makris (2001); integrated by scipy.
    Not run with: modified and open-close: their runs stop with more energy than the ground gave,
    for springs of 5 GPa throw what lands in steps of 2 ms.
    """
    for pulse, amplitudes in shaken.items():
        largest = []
        for amplitude in amplitudes:
            run = trial.variant.run(
                standing_block(pulse, amplitude), step=STEP, end=END, p=5e9, max_displacement=0.02
            )
            tilt = run.history("centroid").rotation
            exact = exact_tilt(pulse, amplitude, END)[1]
            largest.append(float(np.abs(tilt).max()))
            under = f"{pulse.kind} of {amplitude:g} g"
            trial.absolute(f"stays up, {under}", "", stands(tilt), stands(exact), 0.0, CLOSE)
            if stands(exact):
                most = float(np.abs(exact).max())
                trial.relative(f"tilt, {under}", "rad", largest[-1], most, 0.03, IMPACTS)
        fine = np.linspace(0.9 * amplitudes[0], 1.05 * amplitudes[-1], 41)
        tilts = [np.abs(exact_tilt(pulse, a, END)[1]).max() for a in fine]
        labels = "amplitude of the ground's acceleration over g", "tilt, rad"
        chart = trial.chart(f"largest tilt, one {pulse.kind} of {pulse.period:g} s", *labels)
        chart.exact("Housner, integrated", fine, np.minimum(tilts, FALLEN))
        chart.computed(amplitudes, np.minimum(largest, FALLEN))
