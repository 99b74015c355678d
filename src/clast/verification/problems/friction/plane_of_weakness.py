"""Strength of rock with a plane of weakness, by the angle of the plane (Jaeger).

A specimen is pressed from its sides by s3 and along its axis by s1.  On a plane that dips by b, the
axis being vertical, are the stresses

    sn = (s1 + s3)/2 + (s1 - s3)/2 cos(2 b),    t = (s1 - s3)/2 sin(2 b),

and with t = c + sn tan phi the plane slips at

    s1 - s3 = 2 (c + s3 tan phi)/((1 - tan phi tan(90 - b)) sin(2 b)),    b > phi.

It is least at b = 45 + phi/2 degrees; a plane that dips by less than phi never slips.
"""

from functools import partial
from itertools import pairwise

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, new_model, problem
from clast.verification.variants import EACH_PROCESS, LAGGED

FRICTION_ANGLE, COHESION = 30.0, 0.4e6
"""Friction angle, degrees, and cohesion, Pa, of the planes."""
CONFINING = 1e6
"""Stress s3 on the sides, Pa."""
WIDTH, HEIGHT = 1.0, 5.0
"""Width and height of the specimen, m."""
SPECIMENS = ((40.0, 1), (50.0, 1), (60.0, 1), (70.0, 1), (60.0, 3))
"""Dip of the planes, degrees, and their number."""
FLAT = 25.0
"""Dip of a plane that never slips, degrees."""
MUCH = 4.0
"""Axial stress on it, over s3."""
APART = 0.6
"""Vertical distance of planes, m."""
DENSITY = 2500.0
SPAN = 0.02
"""Half of the range of s1 - s3 that is searched as a share of it."""
RESOLUTION = "bracket of 0.5 %"
STATIC = StaticRun(p=1e9, step=2e-3, steps=300, unit=CONFINING / (DENSITY * HEIGHT), bisections=3)


def exact_strength(dip: float) -> float:
    """Return s1 - s3 at which a plane that dips by ``dip``, degrees, slips, Pa; inf for never."""
    b, friction = np.radians(dip), np.tan(np.radians(FRICTION_ANGLE))
    holds = 1.0 - friction / np.tan(b)
    if holds <= 0.0:
        return np.inf
    return float(2.0 * (COHESION + CONFINING * friction) / (holds * np.sin(2.0 * b)))


def specimen(dip: float = 60.0, planes: int = 1, difference: float | None = None) -> Model:
    """Return a specimen cut by planes, under s3 and s1 = s3 + ``difference``, Pa."""
    difference = exact_strength(dip) if difference is None else difference
    builder = new_model("Plane of weakness", young=20e9, density=DENSITY, poisson=0.0)
    builder.add_joint(friction_angle=FRICTION_ANGLE, cohesion=COHESION)
    rise = 0.5 * WIDTH * float(np.tan(np.radians(dip)))
    middle = 0.5 * HEIGHT + APART * (np.arange(planes) - 0.5 * (planes - 1))
    left, right = [0.0, *(middle - rise), HEIGHT], [0.0, *(middle + rise), HEIGHT]
    sides = zip(pairwise(left), pairwise(right), strict=True)
    for number, ((low, high), (other_low, other_high)) in enumerate(sides):
        name = str(number)
        corners = [(0.0, low), (WIDTH, other_low), (WIDTH, other_high), (0.0, high)]
        builder.block(name=name, vertices=corners, fixed=number == 0)
        if number == 0:
            continue
        press = (CONFINING, 0.0)
        builder.line_load((0.0, high), (0.0, low), press, block=name)
        builder.line_load((WIDTH, other_low), (WIDTH, other_high), (-CONFINING, 0.0), block=name)
        builder.measured_point(name, np.mean(corners, axis=0), block=name)
    axial = CONFINING + difference
    builder.line_load((WIDTH, HEIGHT), (0.0, HEIGHT), (0.0, -axial), block=str(planes))
    return builder.build()


@problem(set_up=specimen, variants=EACH_PROCESS, few=(SPECIMENS[2:3],))
def plane_of_weakness(trial: Trial, specimens: tuple[tuple[float, int], ...] = SPECIMENS) -> None:
    """Strength of rock with a plane of weakness.

    A specimen of 1 m x 5 m, its lower end fixed, with a plane that dips by 40 to 70 degrees or with
    three, phi = 30 degrees, c = 0.4 MPa, under 1 MPa from both sides; the axial stress is bisected.
    p = 1 GPa, h = 2 ms, static (dynamic_ratio = 0). Three planes not with modified: one pass does
    not tolerate the springs of thin blocks in such steps. The rock does not break.

    Exact: s1 - s3 = 2 (c + s3 tan phi)/((1 - tan phi tan(90 - b)) sin(2 b)).
    Source: Jaeger (1960), as in Brady & Brown (2004), section 4.6.
    """
    strengths = []
    # one pass does not tolerate the springs of the thin blocks between several planes
    some = [one for one in specimens if trial.variant is not LAGGED or one[1] == 1]
    for dip, planes in some:
        exact = exact_strength(dip)
        pressed = partial(specimen, dip, planes)
        ends = exact * (1.0 + SPAN), exact * (1.0 - SPAN)
        strengths.append(STATIC.limit(trial.variant, pressed, *ends))
        cut = "" if planes == 1 else f", {planes} planes"
        quantity = f"s1 - s3 at b = {dip:g} degrees{cut}"
        trial.relative(quantity, "Pa", strengths[-1], exact, 0.01, RESOLUTION)
    much = float(STATIC.stands(specimen(FLAT, 1, MUCH * CONFINING), trial.variant))
    quantity = f"holds at b = {FLAT:g} degrees, s1 = {MUCH + 1:g} s3"
    trial.absolute(quantity, "", much, 1.0, 0.0, "1: holds, 0: slips")
    fine = np.linspace(36.0, 80.0, 89)
    single = [k for k, (_, planes) in enumerate(some) if planes == 1]
    labels = "dip of the plane b, degrees", "σ₁ − σ₃, MPa"
    chart = trial.chart("strength over the dip of the plane", *labels)
    chart.exact("Jaeger", fine, [1e-6 * exact_strength(b) for b in fine])
    chart.computed([some[k][0] for k in single], [1e-6 * strengths[k] for k in single])
