"""An oblique SV wave at the free surface: how much more the surface moves than the wave.

The incoming wave and those that leave the surface, SV at the same angle and P by Snell's law, add
up to no traction (Achenbach 1973; Aki & Richards 2002).  With nu = 1/4 all leaves as P at 30
degrees; from 35.3 degrees on, sin a > c_s/c_p, P clings to the surface.

A packet of waves runs up a strip between rollers (see "oblique-wave"), whose lower end is viscous:
from a free one P would come back before the packet has passed, for waves that turn from SV to P at
a free end are faster.  The motion of the surface is compared with that of the rock at the same
height where it goes on above, both by their Fourier amplitudes at the wave's frequency.  A packet
has neighbouring angles, too: near the critical angle and beyond it one of four wave lengths is 6 %
off, with any mesh, and one of eight is not.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.problems import InputBuilder, Model, PlaneStrain, Trial, problem
from clast.verification.problems.waves.oblique_wave import (
    C_P,
    C_S,
    DENSITY,
    POISSON,
    VISCOUS,
    WAVE_LENGTH,
    YOUNG,
    Incidence,
    columns_of,
    triangles_of,
    velocities_of,
)
from clast.verification.variants import MIDPOINT, MIDPOINT_OPEN_CLOSE, Variant

CASES = (
    Incidence("SV", 20.0),
    Incidence("SV", 25.0),
    Incidence("SV", 30.0, waves=8.0),
    Incidence("SV", 45.0, waves=8.0),
)
STIFF = 5e12
"""Normal stiffness of the contacts, N/m per m; with a tenth of it waves are 1 % slower."""
STEPS_OF_PERIOD = 40
MESH = "waves in triangles strained evenly, ten rows a wave, are 2 to 3 % off in speed and angle"
TOLERANCE = 0.04
"""Of the motion of the surface, in units of that of the wave."""


def surface_by_wave(angle: float) -> tuple[float, float]:
    """Return |v_x| and |v_y| of the surface under an SV wave of size 1, at an angle, degrees."""
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


def running(case: Incidence, rows: int) -> Model:
    """Return a strip of ``rows`` of 1 m whose packet begins in the lower ones.

    The points of all columns are where the surface of a strip of the case is.
    """
    builder = InputBuilder(title="Free surface", gravity=(0.0, 0.0), plane=PlaneStrain())
    builder.add_rock("rock", young=YOUNG, poisson=POISSON, density=DENSITY)
    builder.add_joint(friction_angle=45.0, cohesion=1e12, tensile_strength=1e12)
    triangles = triangles_of(case, rows)
    names, columns = builder.blocks(vertices=triangles), columns_of(case)
    for column in range(columns):
        # the second triangle of a rectangle has the left end of its upper side
        block = names[2 * ((round(case.height) - 1) * columns + column) + 1]
        at = (case.width / columns * column, case.height)
        builder.measured_point(f"{column}", at, block=block)
    for side in ("left", "right"):
        # so stiff a dashpot is a roller
        builder.viscous_boundary(side=side, normal=1e6, tangential=0.0)
    builder.viscous_boundary(side="bottom", normal=VISCOUS, tangential=VISCOUS)
    return replace(builder.build(), velocity=velocities_of(case, triangles))


def amplitudes(case: Incidence, rows: int, variant: Variant) -> tuple[float, float]:
    """Return the Fourier amplitudes of v_x and v_y at the surface's height, of all columns, m.

    Those of waves that stand across the strip: v_x ~ sin(k_x x), v_y ~ cos(k_x x).
    """
    model = running(case, rows)
    step, end = WAVE_LENGTH / case.speed / STEPS_OF_PERIOD, case.crossing
    run = variant.run(model, step=step, end=end, normal_stiffness=STIFF, max_displacement=0.01)
    columns = columns_of(case)
    histories = [run.history(f"{column}") for column in range(columns)]
    time = histories[0].time
    turned = np.exp(-2j * np.pi * case.speed / WAVE_LENGTH * time)
    found = np.array(
        [np.trapezoid(one.velocity[:, :2] * turned[:, None], time, axis=0) for one in histories]
    )
    phase = case.wave_numbers[0] * case.width / columns * np.arange(columns)
    across, up = np.sin(phase), np.cos(phase)
    return (
        float(abs(across @ found[:, 0]) / (across @ across)),
        float(abs(up @ found[:, 1]) / (up @ up)),
    )


def computed(case: Incidence, variant: Variant) -> tuple[float, float]:
    """Return |v_x| and |v_y| of the surface by the size of the wave."""
    rows = round(case.height)
    surface = amplitudes(case, rows, variant)
    coming = amplitudes(case, 2 * rows, variant)
    size = float(np.hypot(*coming))
    return surface[0] / size, surface[1] / size


@problem(
    set_up=lambda: running(CASES[0], round(CASES[0].height)),
    variants=(MIDPOINT, MIDPOINT_OPEN_CLOSE),
    quick=(),
)
def free_surface(trial: Trial) -> None:
    """SV waves at a free surface.

    A strip of rock of triangles of 1 m between rollers, four or eight wave lengths of 10 m high,
    with a free upper and a viscous lower end, carries a packet of SV waves at 20 to 45 degrees from
    the normal; the wave alone is that of a strip twice as high. E = 20 GPa, nu = 0.25, plane
    strain, 40 steps a period, forces half way.

    Exact: v and t of the incoming SV wave and of the SV and P waves that leave fulfil t = 0.
    Source: Aki & Richards (2002); plane waves solved.
    Not run with: modified: for its time.
    """
    found: list[tuple[float, float]] = []
    for case in CASES:
        found.append(computed(case, trial.variant))
        exact = surface_by_wave(case.angle)
        for name, one, other in zip(("along", "across"), found[-1], exact, strict=True):
            quantity = f"surface by wave, {name}, SV at {case.angle:g} degrees"
            trial.absolute(quantity, "", one, other, TOLERANCE, MESH)
    angles, places = np.linspace(0.0, 60.0, 241), [case.angle for case in CASES]
    exact_along, exact_across = zip(*map(surface_by_wave, angles), strict=True)
    trial.chart(
        "motion of the surface by that of the wave",
        "angle from the normal, degrees",
        "surface / wave",
        exact_curve("along", angles, exact_along),
        exact_curve("across", angles, exact_across),
        curve(f"along, {trial.variant.name}", places, [moves[0] for moves in found]),
        curve(f"across, {trial.variant.name}", places, [moves[1] for moves in found]),
    )
