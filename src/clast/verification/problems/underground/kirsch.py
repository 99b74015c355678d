"""A circular tunnel in rock under stress: Kirsch's solution, found with blocks.

Around a tunnel of radius a the stress before mining, p upwards and k p across, becomes

    s_r = p (1+k)/2 (1 - q) - p (1-k)/2 (1 - 4 q + 3 q2) cos 2t
    s_t = p (1+k)/2 (1 + q) + p (1-k)/2 (1 + 3 q2) cos 2t,        q = (a/r)2,

compression, t from the horizontal, and the wall closes by

    u = a/(4 G) (p (1+k) - p (1-k) (3 - 4 nu) cos 2t).

Rings of triangles of one stress each are welded by stiff joints.  Support of the wall before mining
fades out, by which the closure is that of mining alone.  Quadrilaterals would lock: two that share
both ends of an edge leave a ring only few ways to deform.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from clast.model.surroundings import InSituStress
from clast.verification.fixtures import new_model
from clast.verification.problems import Floats, Model, PlaneStrain, Run, Trial, problem
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE

YOUNG, POISSON, PRESSURE, RADIUS = 20e9, 0.25, 10e6, 3.0
"""E, Pa, nu, p, Pa, and a, m."""
STRONG = 1e9
"""Cohesion and tensile strength of the joints, Pa, which thus stay closed."""
STEP, FADING, RESTING = 2e-2, 6, 6
"""Step, s; steps in which the support fades out, and steps after them."""
ANGLES = (0.0, 45.0, 90.0)
"""Where wall and rock are looked at, degrees."""
AT = 1.5 * RADIUS
"""In which ring stresses are compared, m."""
HELD = 1e-6
"""Springs of the outline, in units of those of fixed points: they carry 2e-4 of the stress, and
keep the rock from turning, which pressure that keeps its direction would make it do."""
MESH = "triangles of one stress each; the rock ends at 14 radii"


@dataclass(frozen=True)
class Rings:
    """Rings of quadrilaterals, each of two triangles, around the tunnel."""

    round: int = 48
    count: int = 18
    growth: float = 1.16
    """Radius of each ring over that within."""

    def corner(self, ring: int, place: int) -> tuple[float, float]:
        """Return a corner, m; polygons have the area of the circle."""
        wide = 2.0 * np.pi / self.round
        radius = RADIUS * self.growth**ring * np.sqrt(wide / np.sin(wide))
        angle = wide * ((place % self.round) - 0.5)
        return float(radius * np.cos(angle)), float(radius * np.sin(angle))

    def triangles(self, ring: int, place: int) -> list[list[tuple[float, float]]]:
        """Return both triangles of a quadrilateral, that with its inner edge first."""
        inner, outer = self.corner(ring, place), self.corner(ring + 1, place)
        outer_next, inner_next = self.corner(ring + 1, place + 1), self.corner(ring, place + 1)
        if (ring + place) % 2:
            return [[inner, outer, inner_next], [outer, outer_next, inner_next]]
        return [[inner, outer_next, inner_next], [inner, outer, outer_next]]

    def middle(self, place: int) -> float:
        """Return the angle at the middle of a quadrilateral, rad."""
        return 2.0 * np.pi * place / self.round


FINE, COARSE = Rings(), Rings(24, 10, 1.3)


def kirsch_stresses(radius: float, angle: float, ratio: float) -> tuple[float, float]:
    """Return s_r and s_t, Pa, compression, at a radius, m, and angle, rad, for k = ``ratio``."""
    mean, half = 0.5 * PRESSURE * (1.0 + ratio), 0.5 * PRESSURE * (1.0 - ratio)
    q, across = (RADIUS / radius) ** 2, float(np.cos(2.0 * angle))
    return (
        mean * (1.0 - q) - half * (1.0 - 4.0 * q + 3.0 * q**2) * across,
        mean * (1.0 + q) + half * (1.0 + 3.0 * q**2) * across,
    )


def closure(angle: Floats | float, ratio: float) -> Floats:
    """Return by how much the wall closes at angles, rad, m."""
    shear = YOUNG / (2.0 * (1.0 + POISSON))
    varies = (1.0 - ratio) * (3.0 - 4.0 * POISSON) * np.cos(2.0 * np.asarray(angle))
    return np.asarray(0.25 * RADIUS / shear * PRESSURE * (1.0 + ratio - varies))


def tunnel(rings: Rings = FINE, ratio: float = 0.5) -> Model:
    """Return the rings under stress, with a support of the wall that fades out."""
    # Stiffness of the joints in units of E over the length of an edge of the wall
    stiffness = 100.0 * YOUNG / (2.0 * np.pi * RADIUS / rings.round)
    builder = new_model("Kirsch", plane=PlaneStrain(), young=YOUNG, density=2700.0, poisson=POISSON)
    builder.add_joint(
        friction_angle=45.0,
        cohesion=STRONG,
        tensile_strength=STRONG,
        normal_stiffness=stiffness,
        shear_stiffness=stiffness,
    )
    builder.in_situ = InSituStress(stress=(-ratio * PRESSURE, -PRESSURE, 0.0), held=(HELD, HELD))
    # the first step is part of the equilibrium that the run begins with
    instants = (0.0, STEP, STEP * (1 + FADING))
    fades = builder.add_amplitude("fades", instants, (1.0, 1.0, 0.0))
    for ring in range(rings.count):
        for place in range(rings.round):
            for part, corners in zip("ab", rings.triangles(ring, place), strict=True):
                builder.block(name=f"{ring} {place} {part}", vertices=corners)
    for place in range(rings.round):
        ends = rings.corner(0, place), rings.corner(0, place + 1)
        angle, wall = rings.middle(place), f"0 {place} a"
        push = (ratio * PRESSURE * np.cos(angle), PRESSURE * np.sin(angle))
        builder.line_load(ends[1], ends[0], push, block=wall, amplitude=fades)
        middle = 0.5 * np.add(*ends)
        builder.measured_point(str(place), (middle[0], middle[1]), block=wall)
    return builder.build()


def closed(run: Run, rings: Rings, place: int) -> float:
    """Return by how much the wall has closed at a place, m."""
    angle = rings.middle(place)
    moved = run.history(str(place)).displacement[-1]
    return -float(moved @ [np.cos(angle), np.sin(angle)])


def stress_at(run: Run, ring: int, place: int) -> tuple[float, float, float]:
    """Return the radius of a quadrilateral's centroid, m, and s_r and s_t there, Pa."""
    model = run.model
    blocks = [model.block_name.index(f"{ring} {place} {part}") for part in "ab"]
    weights = model.area[blocks] / model.area[blocks].sum()
    x, y = weights @ np.array([model.polygon(b).mean(axis=0) for b in blocks])
    xx, yy, xy = weights @ run.state.stress[blocks]
    radius = float(np.hypot(x, y))
    cos, sin = x / radius, y / radius
    turned = 2.0 * xy * cos * sin
    return (radius, -(xx * cos**2 + yy * sin**2 + turned), -(xx * sin**2 + yy * cos**2 - turned))


@problem(set_up=partial(tunnel, COARSE), variants=(OPEN_CLOSE, CONVEX, LAGGED), quick=())
def kirsch(trial: Trial, rings: Rings = FINE, ratios: tuple[float, ...] = (0.5, 1.0)) -> None:
    """Circular tunnel in rock under stress.

    18 rings of 96 triangles around a tunnel of 3 m radius, out to 14 radii, welded by joints of 100
    E over the length of an edge; p = 10 MPa upwards, k = 0.5 and 1; E = 20 GPa, nu = 0.25, plane
    strain. The support of the wall fades out in 6 steps of 20 ms, static (dynamic_ratio = 0).

    Exact: s_r, s_t = p (1+k)/2 (1 -+ q) -+ p (1-k)/2 (...) cos 2t; u = a/(4 G) (p (1+k) - p (1-k)
    (3 - 4 nu) cos 2t).
    Source: Kirsch (1898), as in Brady & Brown (2004).
    """
    chart = trial.chart("closure of the wall", "angle from the horizontal, degrees", "closure, mm")
    ring = int(np.log(AT / RADIUS) / np.log(rings.growth))
    fine = np.linspace(0.0, 0.5 * np.pi, 91)
    for ratio in ratios:
        run = trial.variant.static(
            tunnel(rings, ratio),
            step=STEP,
            end=STEP * (1 + FADING + RESTING),
            p=20.0 * YOUNG,
            max_displacement=0.05,
        )
        for degrees in ANGLES:
            place = round(degrees / 360.0 * rings.round)
            angle = rings.middle(place)
            where = f"k = {ratio:g}, {degrees:g} degrees"
            computed, exact = closed(run, rings, place), float(closure(angle, ratio))
            trial.relative(f"closure, {where}", "m", computed, exact, 0.015, MESH)
            radius, *stresses = stress_at(run, ring, place)
            for name, value, true in zip(
                ("radial", "tangential"),
                stresses,
                kirsch_stresses(radius, angle, ratio),
                strict=True,
            ):
                quantity = f"{name} stress at r = {radius:.3g} m, {where}"
                trial.relative(quantity, "Pa", value, true, 0.05, MESH)
        places = range(rings.round // 4 + 1)
        chart.exact(f"Kirsch, k = {ratio:g}", np.degrees(fine), 1e3 * closure(fine, ratio))
        chart.computed(
            [np.degrees(rings.middle(place)) for place in places],
            [1e3 * closed(run, rings, place) for place in places],
            f"k = {ratio:g}",
        )
