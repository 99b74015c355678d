"""Waves of 10 Hz that come in from below, sideways and up and down, with and without damping."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.actions.damping import Rayleigh
from clast.inputs.builder import InputBuilder
from clast.model.ground_motion import Accelerogram, IncomingWave
from clast.verification.fixtures import BONDED, box
from clast.verification.problems import Floats, Model, PointHistory, Trial, problem
from clast.verification.variants import HALF_WAY, MIDPOINT, Variant

SPEED, DENSITY = 1000.0, 2200.0
"""Speed of shear waves, m/s, and density, kg/m3; that of compression is sqrt(2) times as high."""
HEIGHT, BLOCKS, WIDTH = 100.0, 20, 200.0
"""Height of the pile, m, its blocks, and their width, m."""
FREQUENCY, LENGTH, PEAK = 10.0, 0.4, 0.05
"""Frequency, Hz, length, s, and velocity, m/s, of the burst."""
STEP, STIFF = 1.0 / (20.0 * FREQUENCY), 1e13
"""20 steps a period, s, and stiffness of the contacts, N/m per m."""
DAMPED = 0.05
"""Share of critical damping at 10 Hz of the damped run."""
RIGID = 1e6
"""Multiple of rho c_p at the bottom of a pile that is sheared: it must not rock."""
OF_STEP = "20 steps a period: (w h)^2/12 is 0.8 % of the distance the wave goes"


@dataclass(frozen=True)
class WaveKind:
    """A kind of wave."""

    name: str
    axis: int
    speed: float
    normal: float


KINDS = (
    WaveKind("sideways", 0, SPEED, RIGID),
    WaveKind("up and down", 1, float(np.sqrt(2.0)) * SPEED, 1.0),
)


def burst(time: Floats) -> Floats:
    """Return the velocity of the wave at times, s, m/s."""
    within = (time > 0.0) & (time < LENGTH)
    bell = np.sin(np.pi * time / LENGTH) ** 2
    return np.asarray(np.where(within, PEAK * bell * np.sin(2.0 * np.pi * FREQUENCY * time), 0.0))


def pile(kind: WaveKind) -> Model:
    """Return the pile, and the burst that comes in."""
    time = np.linspace(0.0, LENGTH, 1601)
    rate = np.zeros((len(time), 2))
    rate[:, kind.axis] = np.gradient(burst(time), time, edge_order=2)
    builder = InputBuilder(
        title="Incoming wave",
        gravity=(0.0, 0.0),
        ground_motion=IncomingWave(Accelerogram(time, rate)),
    )
    builder.add_rock("rock", young=2.0 * DENSITY * SPEED**2, poisson=0.0, density=DENSITY)
    builder.add_joint(**BONDED)
    thick = HEIGHT / BLOCKS
    for k in range(BLOCKS):
        low, high = k * thick, (k + 1) * thick
        builder.block(name=f"layer {k + 1}", vertices=box(0, low, WIDTH, high))
    builder.viscous_boundary(side="bottom", normal=kind.normal)
    builder.measured_point("surface", (0.5 * WIDTH, HEIGHT), block=f"layer {BLOCKS}")
    return builder.build()


def surface(kind: WaveKind, damping: float, variant: Variant) -> PointHistory:
    """Return how the surface moves, with stiffness damping, s."""
    numbers: dict[str, Any] = {"p": STIFF, "max_displacement": 0.05}
    if damping > 0.0:
        numbers["damping"] = Rayleigh(mass=0.0, stiffness=damping)
    end = LENGTH + 2.0 * HEIGHT / kind.speed
    return variant.run(pile(kind), step=STEP, end=end, **numbers).history("surface")


def amplitude(time: Floats, velocity: Floats) -> float:
    """Return the Fourier amplitude of a velocity at the burst's frequency."""
    turning = np.exp(-2j * np.pi * FREQUENCY * time)
    return float(abs(np.trapezoid(velocity * turning, time)))


@problem(set_up=lambda: pile(KINDS[0]), variants=HALF_WAY, quick=(MIDPOINT,))
def incoming_wave(trial: Trial) -> None:
    """Waves of 10 Hz from below.

    A burst of 10 Hz, 0.4 s long, comes up through a pile of 20 blocks of 5 m, bonded, on a viscous
    bottom: shear (c_s = 1000 m/s), and compression (1414 m/s, nu = 0). Again with stiffness damping
    of 5 % at 10 Hz. h = 5 ms, 20 steps a period, forces half way.

    Exact: v_surface = 2 v(t - H/c); exp(-b w^2 H/(2 c)) with damping b.
    Source: d'Alembert; Kolsky (1963).
    """
    circular = 2.0 * np.pi * FREQUENCY
    for kind in KINDS:
        history = surface(kind, 0.0, trial.variant)
        time, velocity = history.time, history.velocity[:, kind.axis]
        exact = 2.0 * burst(time - HEIGHT / kind.speed)
        by = amplitude(time, velocity) / amplitude(time, 0.5 * exact)
        trial.relative(f"surface by wave at 10 Hz, {kind.name}", "", by, 2.0, 0.02, OF_STEP)
        apart = float(np.abs(velocity - exact).max()) / (2.0 * PEAK)
        quantity = f"largest difference by largest velocity, {kind.name}"
        trial.absolute(quantity, "", apart, 0.0, 0.05, "the same, for the phase")
        damping = 2.0 * DAMPED / circular
        damped = surface(kind, damping, trial.variant)
        left = amplitude(damped.time, damped.velocity[:, kind.axis]) / amplitude(time, velocity)
        factor = float(np.exp(-0.5 * damping * circular**2 * HEIGHT / kind.speed))
        quantity = f"left by 5 % of damping, {kind.name}"
        why = "exp(-w H xi/c) is of first order in xi; a burst has neighbouring frequencies"
        trial.relative(quantity, "", left, factor, 0.02, why)
        chart = trial.chart(f"velocity of the surface, {kind.name}", "time, s", "velocity, m/s")
        chart.exact("2 v(t - H/c)", time, exact)
        chart.computed(time, velocity)
