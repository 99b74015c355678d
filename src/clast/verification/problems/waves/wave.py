"""A P-wave runs along a bar of blocks, through a soft joint and to the free end.

A thin elastic strip carries waves at c = sqrt(E/rho).  A bar of blocks does so too, as long as a
wave length holds many blocks and the joints are stiff.  At a free end the velocity doubles.  A
single joint with the normal stiffness k per area lets a wave of circular frequency w through with

    1 / sqrt(1 + (w rho c/(2 k))^2)

of its amplitude (Pyrak-Nolte et al. 1990).

The start is a bell of velocity in blocks without stress: half of it runs to the right, half to the
left.  The contacts have no shear stiffness to speak of: blocks of constant strain that are tied
together at all corners cannot narrow one without the other, which makes the bar as stiff as if it
could not narrow at all, E/(1 - nu2).
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from clast.contact.laws import Penalty
from clast.verification.fixtures import box, new_model
from clast.verification.problems import BONDED, Model, PointHistory, Rock, Run, Trial, problem
from clast.verification.variants import EACH_PROCESS, LAGGED, Variant

YOUNG, DENSITY = 50e9, 2700.0
GRANITE = Rock(name="granite", young=YOUNG, poisson=0.2, density=DENSITY)
SPEED = float(np.sqrt(YOUNG / DENSITY))
"""Wave speed c, m/s."""
BLOCKS = 64
"""Number of blocks of 1 m x 1 m."""
WAVE_LENGTH = 20.0
"""Width of the bell, m: 20 blocks."""
SOURCE = 24.0
"""Middle of the bell at the start, m."""
HEIGHT_OF_BELL = 0.01
"""Largest velocity at the start, m/s."""
JOINT = 34
"""Place of the soft joint, m."""
NEAR, FAR = 39.5, 49.5
"""Places behind the joint where velocity is recorded, m."""
STIFF, SHEAR = 1e13, 1e8
"""Normal and shear stiffness of the contacts, N/m per m."""
FREQUENCY = 2.0 * np.pi * SPEED / WAVE_LENGTH
"""Circular frequency of waves as long as the bell, 1/s."""
SOFT = 0.5 * FREQUENCY * DENSITY * SPEED
"""Stiffness k of the soft joint, Pa/m: lets 1/sqrt(2) of those waves through."""
EVEN = Penalty(STIFF, SHEAR)
"""Law of all joints but soft ones."""
SANDSTONE = Rock(name="sandstone", young=20e9, poisson=0.2, density=2500.0)
"""Rock of the bar whose joints are all soft, by ``CLOSING``."""
CLOSING = 1e11
"""Their stiffness k, Pa/m."""
SLOWER = float(np.sqrt(1.0 / (1.0 / SANDSTONE.young + 1.0 / CLOSING) / SANDSTONE.density))
"""Wave speed along that bar, m/s; blocks are 1 m long."""
SHARES = (0.5, 0.75, 1.0)
"""Frequencies compared, in units of FREQUENCY."""
STEP, DURATION = 1e-5, 50.0 / SPEED
COARSE = "20 blocks a wave length"
DAMPING = "numerical damping, exp(-w2 h t/4)"


def bell(place: float) -> float:
    """Return the velocity at the start, m/s, at a place along the bar, m."""
    offset = (place - SOURCE) / WAVE_LENGTH
    return HEIGHT_OF_BELL * float(np.cos(np.pi * offset)) ** 2 if abs(offset) < 0.5 else 0.0


def bar(soft: Mapping[int, float], rock: Rock = GRANITE) -> Model:
    """Return a bar of blocks that hold together in tension, with a bell of velocity.

    ``soft`` is the normal stiffness, Pa/m, of the joints at some places, m.
    """
    builder = new_model(
        "P-wave", young=rock.young, density=rock.density, poisson=rock.poisson, **BONDED
    )
    for joint, stiffness in soft.items():
        numbers: dict[str, Any] = {**BONDED, "normal_stiffness": stiffness}
        builder.add_joint(f"soft {joint}", between=[(str(joint - 1), str(joint))], **numbers)
    for k in range(BLOCKS):
        builder.block(name=str(k), vertices=box(k, 0, k + 1, 1), velocity=(bell(k + 0.5), 0.0, 0.0))
    for name, place in (("near", NEAR), ("far", FAR), ("end", float(BLOCKS))):
        builder.measured_point(name, (place, 0.5), block=str(min(int(place), BLOCKS - 1)))
    return builder.build()


def run(soft: Mapping[int, float], variant: Variant, rock: Rock = GRANITE) -> Run:
    """Return the run of the wave along the bar with these soft joints."""
    model, end = bar(soft, rock), DURATION
    return variant.run(model, step=STEP, end=end, p=STIFF, max_displacement=0.01, contact_law=EVEN)


def peak(history: PointHistory) -> tuple[float, float]:
    """Return time, s, and velocity, m/s, of the crest, by a parabola through it."""
    velocity = history.velocity[:, 0]
    crest = slice(int(velocity.argmax()) - 15, int(velocity.argmax()) + 16)
    time = history.time[crest]
    a, b, c = np.polyfit(time - time[0], velocity[crest], 2)
    return float(time[0] - 0.5 * b / a), float(c - 0.25 * b**2 / a)


def amplitude(history: PointHistory, frequency: float) -> float:
    """Return the Fourier amplitude of the velocity at a circular frequency, 1/s."""
    wave = np.exp(-1j * frequency * history.time)
    return float(abs(np.sum(history.velocity[:, 0] * wave)))


def exact_transmission(frequency: float) -> float:
    """Return the share of the amplitude that passes the joint."""
    return float(1.0 / np.sqrt(1.0 + (0.5 * frequency * DENSITY * SPEED / SOFT) ** 2))


def compare_passage(trial: Trial) -> Run:
    """Compare speed, amplitude and reflection in the bar without a soft joint; return its run."""
    whole = run({}, trial.variant)
    near, far, end = (peak(whole.history(name)) for name in ("near", "far", "end"))
    speed = (FAR - NEAR) / (far[0] - near[0])
    half = 0.5 * HEIGHT_OF_BELL
    trial.relative("wave speed", "m/s", speed, SPEED, 0.005, COARSE)
    trial.relative("velocity of the wave", "m/s", near[1], half, 0.03, DAMPING)
    trial.relative("velocity at the free end", "m/s", end[1], 2.0 * far[1], 0.02, DAMPING)
    time = np.linspace(0.0, DURATION, 200)
    half_bell = np.array([0.5 * bell(NEAR - SPEED * t) for t in time])
    doubled = np.array([bell(BLOCKS - SPEED * t) for t in time])
    chart = trial.chart("passage of the wave", "time, ms", "velocity, mm/s")
    chart.exact("half the bell", 1e3 * time, 1e3 * half_bell)
    chart.exact("free end: doubled", 1e3 * time, 1e3 * doubled)
    for name, of in (("near", ""), ("end", "end")):
        history = whole.history(name)
        chart.computed(1e3 * history.time[::40], 1e3 * history.velocity[::40, 0], of)
    return whole


def compare_transmission(trial: Trial, whole: Run, jointed: Run) -> None:
    """Compare the wave that passes the soft joint, at three frequencies."""
    passed = []
    for share in SHARES:
        frequency = share * FREQUENCY
        passing = amplitude(jointed.history("near"), frequency)
        passed.append(passing / amplitude(whole.history("near"), frequency))
        quantity = f"transmission of waves of {WAVE_LENGTH / share:.3g} m"
        exact = exact_transmission(frequency)
        trial.relative(quantity, "", passed[-1], exact, 0.01, "blocks instead of a strip")
    fine = np.linspace(0.0, 1.2, 50)
    labels = ("frequency / frequency of the bell", "amplitude behind / before")
    chart = trial.chart("transmission of the soft joint", *labels)
    chart.exact("formula", fine, [exact_transmission(f * FREQUENCY) for f in fine])
    chart.computed(SHARES, passed)


@problem(set_up=partial(bar, {}), variants=EACH_PROCESS, quick=(LAGGED,), briefly=compare_passage)
def wave(trial: Trial) -> None:
    """P-wave in a bar of blocks.

    A bar of 64 blocks of 1 m x 1 m without gravity, bonded in tension; a bell of velocity 20 m wide
    sends 5 mm/s to either side. E = 50 GPa, nu = 0.2, rho = 2700 kg/m3, plane stress, h = 10 us. In
    a second run one joint has the normal stiffness k = w rho c/2; in a third all have k = 100
    GPa/m, with E = 20 GPa and rho = 2500 kg/m3.

    Exact: c = sqrt(E/rho); velocity doubles at the free end; the joint transmits 1/sqrt(1 + (w rho
    c/(2k))^2); with joints at every l the bar has 1/(1/E + 1/(k l)) for E.
    Source: one-dimensional elasticity; displacement discontinuity of Pyrak-Nolte et al. (1990).
    """
    whole = compare_passage(trial)
    compare_transmission(trial, whole, run({JOINT: SOFT}, trial.variant))
    quantity = "wave speed along joints of 1e11 Pa/m"
    slow = run(dict.fromkeys(range(1, BLOCKS), CLOSING), trial.variant, SANDSTONE)
    near, far = (peak(slow.history(name)) for name in ("near", "far"))
    trial.relative(quantity, "m/s", (FAR - NEAR) / (far[0] - near[0]), SLOWER, 0.01, COARSE)
