"""An oblique SV wave at the free surface: how much more the surface moves than the wave.

The incoming wave and those that leave the surface, SV at the same angle and P by Snell's law, add
up to no traction (Achenbach 1973; Aki & Richards 2002).  Beyond the critical angle, sin a >
c_s/c_p, P clings to the surface.  With nu = 1/4 all leaves as P at 30 degrees; at 45 degrees all
leaves as SV, and the surface moves across itself by sqrt(2) times the wave's size, and not along.

In a strip between rollers (see "oblique-wave") a packet of waves runs up to its free upper end.
The Fourier amplitudes of the surface's velocity at the wave's frequency are compared with that of
the incoming packet alone, of which half of the velocities at the start are known to run up:

    V(w) = 1/2 |F(k_y)|/(c cos a),    F(k_y) = integral of the packet exp(-i k_y y) dy.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.model.model import Floats, Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Comparison, Outcome, Problem, absolute
from clast.verification.problems.waves.oblique_wave import (
    C_P,
    C_S,
    FREE,
    STIFF,
    WAVE_LENGTH,
    Incidence,
    columns_of,
    packet,
    strip,
    triangles_of,
    velocities_of,
)
from clast.verification.variants import MIDPOINT, MIDPOINT_PASSES, Variant

CASES = (Incidence("SV", 30.0), Incidence("SV", 45.0))
STEPS_OF_PERIOD = 40
MESH = "ten rows of triangles a wave, strained evenly: 2 to 3 % in the speeds of waves"
TOLERANCE = 0.05


def surface_by_wave(angle: float) -> tuple[float, float]:
    """Return |v_x| and |v_y| of the surface by those of an SV wave of size 1, at an angle, degrees.

    Both by the size of the wave.
    """
    slowness = np.sin(np.radians(angle)) / C_S

    def wave(c: float, sense: float, shear: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return traction and velocity of a wave of size 1 that runs up (1) or down (-1)."""
        sine = slowness * c
        cosine = np.sqrt(complex(1.0 - sine**2))
        d = np.array([sine, sense * cosine])
        p = np.array([d[1], -d[0]]) if shear else d
        along = (C_P**2 - 2.0 * C_S**2) * (d @ p) * np.array([0.0, 1.0])
        pull = along + C_S**2 * (d[1] * p + p[1] * d)
        return pull / c, p

    pull, coming = wave(C_S, 1.0, True)
    p_pull, p_wave = wave(C_P, -1.0, False)
    s_pull, s_wave = wave(C_S, -1.0, True)
    sizes = np.linalg.solve(np.stack([p_pull, s_pull], axis=1), -pull)
    surface = coming + sizes[0] * p_wave + sizes[1] * s_wave
    return float(abs(surface[0])), float(abs(surface[1]))


def running(case: Incidence) -> Model:
    """Return a strip with free ends whose packet runs up and down."""
    return replace(strip(case, FREE), velocity=velocities_of(case, triangles_of(case)))


def coming(case: Incidence) -> float:
    """Return the Fourier amplitude of the incoming wave at the surface, at its own frequency, m."""
    up = np.linspace(0.0, case.height, 20001)
    across, number = case.wave_numbers
    # where the part across is largest: size times cos a
    part = packet(case, np.full(len(up), np.pi / (2.0 * across)), up)[:, 0]
    size = abs(np.trapezoid(part * np.exp(-1j * number * up), up))
    cosine = np.cos(np.radians(case.angle))
    return float(0.5 * size / cosine / (case.speed * cosine))


def computed(case: Incidence, variant: Variant) -> tuple[float, float]:
    """Return |v_x| and |v_y| of the surface by the size of the wave."""
    model = running(case)
    method = variant.method(model, normal_stiffness=STIFF, max_displacement=0.01)
    step, end = WAVE_LENGTH / case.speed / STEPS_OF_PERIOD, case.crossing
    run = simulate(model, method, Schedule(step=step, end=end, every=end))
    across = case.wave_numbers[0]
    at = case.width / columns_of(case) * (columns_of(case) // 2)
    middle, side = run.history("middle"), run.history("side")
    circular = 2.0 * np.pi * case.speed / WAVE_LENGTH

    def amplitude(time: Floats, value: Floats) -> float:
        return float(abs(np.trapezoid(value * np.exp(-1j * circular * time), time)))

    size = coming(case)
    along = amplitude(middle.time, middle.velocity[:, 0]) / float(np.sin(across * at))
    return along / size, amplitude(side.time, side.velocity[:, 1]) / size


def examine(variant: Variant) -> Outcome:
    """Compare the motion of the surface along and across itself."""
    rows: list[Comparison] = []
    found: list[tuple[float, tuple[float, float]]] = []
    for case in CASES:
        moves, exact = computed(case, variant), surface_by_wave(case.angle)
        found.append((case.angle, moves))
        for name, one, other in zip(("along", "across"), moves, exact, strict=True):
            quantity = f"surface by wave, {name}, SV at {case.angle:g} degrees"
            rows.append(absolute(quantity, "", one, other, TOLERANCE, MESH))
    angles = np.linspace(0.0, 60.0, 241)
    exact_along, exact_across = zip(*map(surface_by_wave, angles), strict=True)
    places = [angle for angle, _ in found]
    chart = Chart(
        title="motion of the surface by that of the wave",
        x_label="angle from the normal, degrees",
        y_label="surface / wave",
        curves=(
            exact_curve("along", angles, exact_along),
            exact_curve("across", angles, exact_across),
            curve(f"along, {variant.name}", places, [moves[0] for _, moves in found]),
            curve(f"across, {variant.name}", places, [moves[1] for _, moves in found]),
        ),
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="free-surface",
    title="SV waves at a free surface",
    text="A strip of rock of triangles of 1 m between rollers, four wave lengths of 10 m high, "
    "whose upper end is free, carries a packet of SV waves at 30 or 45 degrees from the normal. "
    "E = 20 GPa, nu = 0.25, plane strain, 40 steps a period, forces half way.",
    formula="v and t of the incoming SV wave and of the SV and P waves that leave fulfil t = 0",
    source="Aki & Richards (2002); plane waves solved",
    set_up=lambda: running(CASES[0]),
    examine=examine,
    variants=(MIDPOINT, MIDPOINT_PASSES),
    quick=(),
)
