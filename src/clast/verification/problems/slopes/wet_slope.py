"""Plane failure with water in a tension crack and on the plane, of two slopes with cohesion.

    F = (c A + N' tan phi)/T,    N' = W (cos a - k sin a) - U - V sin a,
    T = W (sin a + k cos a) + V cos a,    U = 1/2 w zw A,    V = 1/2 w zw2

for a block on a plane of dip a and length A, with a vertical crack of depth z behind it that is
filled to zw; on the plane the pressure falls from that at the foot of the crack to none at the toe.
Below a phreatic line U are the pressures w (y_line - y); drains take the head that they lie at:
from the foot of the crack to the first the pressure falls to none, and between two there is none.
An earthquake pushes the block out of the slope by k times its weight, as a force that lasts.

The block holds with its strength divided by a little less than F, and slides with it divided by a
little more.  The joint is ideally plastic: all of its cohesion is at work at once.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.verification.problems import Bracket, Floats, Model, StaticRun, Trial, problem
from clast.verification.variants import CONVEX, EACH_PROCESS, LAGGED, OPEN_CLOSE, Variant

GRAVITY, WATER = 9.81, 1000.0
WEIGHT = 26e3
"""Weight of the rock, N/m3."""
SEISMIC = 0.08
"""Push of an earthquake, as a share of the weight."""
STEP, STEPS = 4e-3 / 15.0, 300
"""Step by height of the slope, s/m: heavier blocks come to rest in longer steps."""
SPAN = 0.04
"""Half of the range of the factor of safety that is searched as a share of it."""
RESOLUTION = "bisected to 0.25 %"


@dataclass(frozen=True, kw_only=True)
class Slope:
    """A slope with a plane through its toe and a vertical crack behind its crest."""

    height: float
    """Height, m."""
    face: float
    """Dip of the face, degrees."""
    plane: float
    """Dip of the plane, degrees."""
    crack: float
    """Distance of the crack from the toe, m."""
    cohesion: float
    """Cohesion of the plane, Pa."""
    friction_angle: float
    """Friction angle of the plane, degrees."""

    @property
    def foot(self) -> Floats:
        """Foot of the crack, seen from the toe, m, shape (2,)."""
        return np.array([self.crack, self.crack * np.tan(np.radians(self.plane))])

    @property
    def depth(self) -> float:
        """Depth of the crack z, m."""
        return self.height - float(self.foot[1])

    def exact_factor(self, water: float, seismic: float = 0.0) -> float:
        """Return the factor of safety with ``water`` m of water in the crack.

        The slab is pushed out of the slope by ``seismic`` times its weight.
        """
        lifts = 0.5 * WATER * GRAVITY * water * float(np.hypot(*self.foot))
        return self.factor(*self.forces(lifts, water, seismic))

    def forces(self, lifts: float, water: float, seismic: float = 0.0) -> tuple[float, float]:
        """Return N' and T, N/m, with the uplift ``lifts``, N/m, and so much water in the crack."""
        dip, crest = np.radians(self.plane), self.height / np.tan(np.radians(self.face))
        # the quadrangle of toe, foot and top of the crack, and crest
        weight = WEIGHT * (0.5 * (self.height * (self.crack - crest) + self.crack * self.depth))
        pushes = 0.5 * WATER * GRAVITY * water**2 + seismic * weight
        presses = weight * np.cos(dip) - lifts - pushes * np.sin(dip)
        return float(presses), float(weight * np.sin(dip) + pushes * np.cos(dip))

    def factor(self, presses: float, drives: float) -> float:
        """Return F by N' and T, N/m."""
        holds = self.cohesion * np.hypot(*self.foot)
        return float((holds + presses * np.tan(np.radians(self.friction_angle))) / drives)


def critical_slope() -> Slope:
    """Return a slope of 60 m with its crack where a dry one is weakest (Hoek & Bray)."""
    height, face, plane = 60.0, np.radians(50.0), np.radians(35.0)
    return Slope(
        height=height,
        face=50.0,
        plane=35.0,
        crack=height / float(np.sqrt(np.tan(face) * np.tan(plane))),
        cohesion=1e5,
        friction_angle=35.0,
    )


def steep_slope() -> Slope:
    """Return a slope of 15 m with a crack 3 m behind its crest."""
    crest = 15.0 / float(np.tan(np.radians(75.0)))
    return Slope(
        height=15.0, face=75.0, plane=40.0, crack=crest + 3.0, cohesion=35e3, friction_angle=35.0
    )


def dry_slope(slope: Slope, divided_by: float = 1.0, seismic: float = 0.0) -> InputBuilder:
    """Return the slope without water, its strength divided, pushed by a share of its weight."""
    crest = (slope.height / float(np.tan(np.radians(slope.face))), slope.height)
    foot, top = tuple(slope.foot.tolist()), (slope.crack, slope.height)
    back = slope.crack + 0.5 * slope.height
    builder = InputBuilder(title="Wet slope", gravity=(0.0, -GRAVITY))
    builder.seismic_coefficient = (-seismic, 0.0)
    builder.add_rock("rock", young=20e9, poisson=0.2, density=WEIGHT / GRAVITY)
    friction = np.tan(np.radians(slope.friction_angle)) / divided_by
    angle = float(np.degrees(np.arctan(friction)))
    builder.add_joint(friction_angle=angle)
    builder.add_joint("plane", friction_angle=angle, cohesion=slope.cohesion / divided_by)
    # the plane goes on below the toe, so that nothing holds the slab there
    low = -0.2 * slope.height
    toe = (low, low * float(np.tan(np.radians(slope.plane))))
    corners = [(low, 2.0 * low), (back, 2.0 * low), (back, slope.height), top, foot, toe]
    builder.block(name="rock", vertices=corners, fixed=True)
    # its first edge lies on the plane; the crack has no cohesion
    joints = ["plane", "", "", ""]
    builder.block(name="slab", vertices=[(0.0, 0.0), foot, top, crest], edge_joint=joints)
    builder.measured_point("slab", top, block="slab")
    return builder


def slope_model(slope: Slope, water: float, divided_by: float = 1.0, seismic: float = 0.0) -> Model:
    """Return the slope with ``water`` m of water in its crack and its strength divided."""
    builder = dry_slope(slope, divided_by, seismic)
    if water > 0.0:
        level = float(slope.foot[1]) + water
        builder.water(level, acts_on="joints", drained_at=[(0.0, 0.0)])
    return builder.build()


def factor_of_safety(
    variant: Variant,
    slope: Slope,
    exact: float,
    divided: Callable[[float], Model],
    bisections: int = 5,
) -> Bracket:
    """Return the divisor of the strength at which the slab begins to slide.

    ``divided`` makes the model with its strength divided.
    """
    static = StaticRun(p=2e9, step=STEP * slope.height, steps=STEPS, bisections=bisections)
    # shares of the exact strength: from a little less, which slides, to a little more
    ends = 1.0 - SPAN, 1.0 + SPAN
    shares = static.limit(variant, lambda share: divided(exact / share), *ends)
    return Bracket(exact / shares.low, exact / shares.high)


def set_up() -> Model:
    """Return the slope of 60 m with its crack full to the middle."""
    slope = critical_slope()
    return slope_model(slope, 0.5 * slope.depth)


@problem(set_up=set_up, variants=EACH_PROCESS, quick=())
def wet_slope(trial: Trial, levels: tuple[float, ...] = (0.0, 0.25, 0.5, 1.0)) -> None:
    """Plane failure with cohesion under a water level.

    A slab on a plane through the toe of a slope, with a vertical crack behind its crest; water
    stands in the crack and runs out at the toe (drained_at), or an earthquake pushes the slab by a
    share k of its weight. The factor by which the strength is divided is bisected. p = 2 GPa, h = 4
    and 16 ms, static (dynamic_ratio = 0).

    Exact: F = (c A + (W (cos a - k sin a) - U - V sin a) tan phi)/(W (sin a + k cos a) + V cos a).
    Source: limit equilibrium of Hoek & Bray (1974).
    """
    critical, steep = critical_slope(), steep_slope()
    cases = [
        (critical, level * critical.depth, 0.0, f"60 m, water at {level:g} of the crack")
        for level in levels
    ]
    pushed = f"60 m, dry, pushed by {SEISMIC:g} of its weight"
    cases.append((critical, 0.0, SEISMIC, pushed))
    low = "15 m, water 2 m below the top of the crack"
    cases.append((steep, steep.depth - 2.0, 0.0, low))
    for slope, water, seismic, name in cases:
        exact = slope.exact_factor(water, seismic)
        divided = partial(slope_model, slope, water, seismic=seismic)
        factor = factor_of_safety(trial.variant, slope, exact, divided)
        quantity = f"factor of safety, slope of {name}"
        trial.relative(quantity, "-", factor, exact, 0.01, RESOLUTION)
    fine = np.linspace(0.0, 1.0, 41)
    labels = "height of the water / depth of the crack", "factor of safety"
    chart = trial.chart("factor of safety, slope of 60 m", *labels)
    chart.exact("Hoek & Bray", fine, [critical.exact_factor(x * critical.depth) for x in fine])
    chart.computed(levels, trial.computed[: len(levels)])


FIRM = 0.5
"""Divisor of the strength of a firm slope."""
SETTLES = "blocks give by microns, and the water with them"
FULL = 4.0
"""Height of the water in the crack zw, m."""


@dataclass(frozen=True, kw_only=True)
class WaterHead:
    """Heads of water over a plane, and how they are entered."""

    name: str
    """Its name in the table."""
    share: tuple[float, ...]
    """Places on the plane, shares of its length from the toe, from 0 to 1."""
    head: tuple[float, ...]
    """Height of the water above the plane there, m; linear between."""
    drains: tuple[float, ...] = ()
    """Places of drains; none: a phreatic line through the heads."""

    def at(self, slope: Slope, share: Floats) -> Floats:
        """Return the pressure on the plane at places, Pa."""
        return WATER * GRAVITY * np.interp(share, self.share, self.head)

    def forces(self, slope: Slope) -> tuple[float, float]:
        """Return N' and T, N/m."""
        length = float(np.hypot(*slope.foot))
        lifts = WATER * GRAVITY * length * float(np.trapezoid(self.head, self.share))
        return slope.forces(lifts, self.head[-1])

    def keys(self, slope: Slope) -> dict[str, Any]:
        """Return the keys of the water: a level and drains, or a phreatic line."""
        along = np.array(self.share)[:, None] * slope.foot
        if self.drains:
            drained = [tuple(share * slope.foot) for share in self.drains]
            level = float(slope.foot[1]) + self.head[-1]
            return {"level": level, "drained_at": drained}
        line = along + np.stack([np.zeros(len(along)), self.head], axis=1)
        beyond = line[-1] + (10.0, 0.0)
        return {"line": np.vstack([line, beyond])}


WATERS = (
    WaterHead(name="line to the toe", share=(0.0, 1.0), head=(0.0, FULL)),
    WaterHead(name="line with a corner", share=(0.0, 0.4, 1.0), head=(1.0, 3.0, FULL)),
    WaterHead(name="drain at the toe", share=(0.0, 1.0), head=(0.0, FULL), drains=(0.0,)),
    WaterHead(
        name="drains at the toe and at 0.4 A",
        share=(0.0, 0.4, 1.0),
        head=(0.0, 0.0, FULL),
        drains=(0.0, 0.4),
    ),
)


def wet(water: WaterHead, divided_by: float = FIRM) -> Model:
    """Return the slope of 15 m with water, its strength divided."""
    builder: InputBuilder = dry_slope(steep_slope(), divided_by)
    builder.water(acts_on="joints", **water.keys(steep_slope()))
    return builder.build()


def borne(water: WaterHead, variant: Variant) -> tuple[float, float]:
    """Return N' and T that the plane carries, N/m."""
    model, slope = wet(water), steep_slope()
    step = STEP * slope.height
    run = variant.static(model, step=step, end=STEPS * step, p=2e9, max_displacement=0.02)
    contacts, slab = run.contacts(), model.block_name.index("slab")
    sense = np.where(contacts.vertex_block == slab, 1.0, -1.0)
    force = (sense[:, None] * contacts.force).sum(axis=0)
    dip = np.radians(slope.plane)
    along, across = np.array([np.cos(dip), np.sin(dip)]), np.array([-np.sin(dip), np.cos(dip)])
    return float(force @ across), float(force @ along)


@problem(
    set_up=lambda: wet(WATERS[3]), variants=(CONVEX, OPEN_CLOSE, LAGGED), few=(WATERS[1:4:2], 3)
)
def drained_slope(
    trial: Trial, waters: tuple[WaterHead, ...] = WATERS, bisections: int = 5
) -> None:
    """Phreatic lines and drains on the plane of a slope.

    The slope of 15 m of wet-slope with 4 m of water in its crack, entered as a phreatic line
    (straight to the toe, or with a corner), or as a level with drains at the toe and in the plane.
    Forces on the plane with twice the strength, and the factor of safety, bisected. p = 2 GPa, h =
    4 ms, static (dynamic_ratio = 0).

    Exact: N' = W cos a - U - V sin a, T = W sin a + V cos a, F = (c A + N' tan phi)/T.
    Source: limit equilibrium of Hoek & Bray (1974).
    """
    slope = steep_slope()
    for water in waters:
        carries, exact = borne(water, trial.variant), water.forces(slope)
        for name, one, other in zip(("N'", "T"), carries, exact, strict=True):
            trial.relative(f"{name}, {water.name}", "N/m", one, other, 2e-3, SETTLES)
        factor, divided = slope.factor(*exact), partial(wet, water)
        safety = factor_of_safety(trial.variant, slope, factor, divided, bisections)
        quantity = f"factor of safety, {water.name}"
        trial.relative(quantity, "-", safety, factor, 0.01, RESOLUTION)
    fine = np.linspace(0.0, 1.0, 51)
    chart = trial.chart("pressure on the plane", "distance from the toe / A", "pressure, kPa")
    for water in waters:
        chart.exact(water.name, fine, 1e-3 * water.at(slope, fine))
    chart.computed((1.0,), (1e-3 * WATER * GRAVITY * FULL,), label="foot of the crack")
