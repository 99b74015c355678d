"""A damped layer on ground that moves sideways and up at once, at 7.5 Hz and at 10.6 Hz."""

import numpy as np

from clast.actions.damping import Rayleigh
from clast.model.ground_motion import Accelerogram, MovingBase
from clast.verification.problems import BONDED, Floats, InputBuilder, Model, Trial, box, problem
from clast.verification.variants import HALF_WAY, MIDPOINT, Variant

HEIGHT, BLOCKS, WIDTH = 20.0, 20, 60.0
"""Height of the layer, m, number of blocks in it, and their width, m."""
SPEED, DENSITY = 200.0, 2000.0
"""Speed of shear waves, m/s, and density, kg/m3."""
YOUNG = 2.0 * DENSITY * SPEED**2
"""Young's modulus without Poisson's ratio, Pa."""
SPEEDS = SPEED, float(np.sqrt(YOUNG / DENSITY))
"""Speeds of waves sideways and up and down, m/s."""
FREQUENCIES = tuple(3.0 * speed / (4.0 * HEIGHT) for speed in SPEEDS)
"""Frequencies of the base, sideways and up and down, Hz: 3 c/(4 H)."""
RATIO = 0.05
"""Damping ratio sideways."""
DELAY = RATIO / (np.pi * FREQUENCIES[0])
"""Damping by elasticity s, s."""
PEAK = 0.5
"""Largest acceleration of the base, m/s2, either way."""
STEPS, SWELLING, EVEN, END = 20, 3.0, 4.2, 5.0
"""Steps a period; times, s, at which the base is up, at which all swings evenly, and the end."""
COARSE = "steps and blocks, 27 in a wave, lower the resonance by 1 %"


def layer() -> Model:
    """Return the layer on a base that is held by fixed points, which move."""
    time = np.arange(0.0, END + 1e-3, 1e-3)
    swell = np.where(time < SWELLING, np.sin(0.5 * np.pi * time / SWELLING) ** 2, 1.0)
    shake = [PEAK * swell * np.sin(2.0 * np.pi * f * time) for f in FREQUENCIES]
    motion = MovingBase(Accelerogram(time, np.stack(shake, axis=1)))
    builder = InputBuilder(title="Damped layer", gravity=(0.0, 0.0), ground_motion=motion)
    builder.add_rock("soil", young=YOUNG, poisson=0.0, density=DENSITY)
    builder.add_joint(**BONDED)
    thick = HEIGHT / BLOCKS
    for k in range(BLOCKS):
        low, high = k * thick, (k + 1) * thick
        builder.block(name=f"layer {k + 1}", vertices=box(0, low, WIDTH, high))
    for x in np.linspace(0.0, WIDTH, 5):
        builder.fixed_point((x, 0.0))
    builder.measured_point("base", (0.5 * WIDTH, 0.0), block="layer 1")
    builder.measured_point("surface", (0.5 * WIDTH, HEIGHT), block=f"layer {BLOCKS}")
    return builder.build()


def exact_amplification(frequency: float, speed: float) -> float:
    """Return surface by base at a frequency, Hz, of waves of a speed, m/s."""
    circular = 2.0 * np.pi * frequency
    number = circular / speed / np.sqrt(1.0 + 1j * circular * DELAY)
    return float(1.0 / abs(np.cos(number * HEIGHT)))


def amplitude(time: Floats, velocity: Floats, frequency: float) -> float:
    """Return the amplitude of a frequency, Hz, beside a velocity that changes evenly."""
    since = time > EVEN
    t = time[since]
    phase = 2.0 * np.pi * frequency * t
    terms = np.stack([np.sin(phase), np.cos(phase), np.ones_like(t), t], axis=1)
    return float(np.hypot(*np.linalg.lstsq(terms, velocity[since])[0][:2]))


def amplifications(variant: Variant) -> tuple[float, ...]:
    """Return surface by base, sideways and up and down."""
    run = variant.run(
        layer(),
        step=1.0 / (STEPS * max(FREQUENCIES)),
        end=END,
        p=1e12,
        max_displacement=0.05,
        damping=Rayleigh(stiffness=DELAY),
    )
    moved = [run.history(name) for name in ("surface", "base")]
    ratios = []
    for k, frequency in enumerate(FREQUENCIES):
        surface, base = (amplitude(one.time, one.velocity[:, k], frequency) for one in moved)
        ratios.append(surface / base)
    return tuple(ratios)


@problem(set_up=layer, variants=HALF_WAY, quick=(MIDPOINT,))
def damped_layer(trial: Trial) -> None:
    """Damped layer on ground that moves sideways and up.

    A layer of 20 m (c_s = 200 m/s, c_p = 283 m/s, 2000 kg/m3) of 20 wide blocks, bonded, with
    damping by elasticity (5 % of critical at 7.5 Hz), on fixed points that move sideways at 7.5 Hz
    and up and down at 10.6 Hz at once; 20 steps in a period of 10.6 Hz.

    Exact: 1/|cos(k H)|, k = (w/c)/sqrt(1 + i w s).
    Source: damped layer on rigid rock; Kramer (1996).
    """
    chart = trial.chart("amplification", "frequency, Hz", "surface / base")
    fine = np.linspace(1.0, 14.0, 300)
    directions = zip(("sideways", "up and down"), FREQUENCIES, SPEEDS, strict=True)
    for (name, frequency, speed), ratio in zip(
        directions, amplifications(trial.variant), strict=True
    ):
        exact = exact_amplification(frequency, speed)
        quantity = f"surface by base, {name} at {frequency:.3g} Hz"
        trial.relative(quantity, "", ratio, exact, 0.02, COARSE)
        chart.exact(f"formula, {name}", fine, [exact_amplification(f, speed) for f in fine])
        chart.computed([frequency], [ratio], name)
