"""A symmetric wedge in a tunnel roof, pulled out of joints that give way (Brady & Brown).

The sides of the wedge lean by a from the vertical and meet rock that does not move; the horizontal
stress before mining presses each of them with the force H0, N0 = H0 cos a across and S0 = H0 sin a
along.  Joints have the stiffnesses kn and ks per area.  Where the wedge sinks by u, a side of
length L is relieved of kn L u sin a and sheared by ks L u cos a more, until S = N tan phi.  With
D = ks cos a cos phi + kn sin a sin phi that is at

    u = H0 sin(phi - a)/(L D),      P0 = 2 (H0/D) (ks cos2 a + kn sin2 a) sin(phi - a).

Stiff joints lose the stress that holds the wedge sooner than they can shear:  P0 is far below 2 H0
tan(phi - a), the capacity of rigid-plastic joints.
"""

from dataclasses import dataclass

import numpy as np

from clast.model.surroundings import InSituStress
from clast.verification.problems import Floats, Model, Trial, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, Variant

PRESS, FRICTION_ANGLE, NORMAL = 1e6, 40.0, 1e10
"""H0, N/m, friction angle, degrees, and kn, Pa/m."""
BASE, HEIGHT, BEYOND = 4.0, 2.0, 0.5
"""Width of the wedge below and its height; how far the rock beside it goes on, m."""
STEP, STEPS, FURTHER = 2e-2, 200, 1.1
"""Step, s, steps and the load at the end over P0."""
RAMP = f"the load grows by {100 * FURTHER / STEPS:.2g} % of P0 a step"
LINEAR = "the rock is not rigid: E = 1e14 Pa; inertia lags by a part of a step"


@dataclass(frozen=True)
class Wedge:
    """A wedge: a, degrees, and kn/ks."""

    lean: float = 20.0
    ratio: float = 10.0

    @property
    def side(self) -> float:
        """Length L of a side, m."""
        return HEIGHT / float(np.cos(np.radians(self.lean)))

    def exact(self) -> tuple[float, float]:
        """Return the load at pull-out P0, N/m, and how far the wedge has sunk there, m."""
        a, phi = np.radians(self.lean), np.radians(FRICTION_ANGLE)
        shear = NORMAL / self.ratio
        D = shear * np.cos(a) * np.cos(phi) + NORMAL * np.sin(a) * np.sin(phi)
        sunk = PRESS * np.sin(phi - a) / (self.side * D)
        stiffness = 2.0 * self.side * (shear * np.cos(a) ** 2 + NORMAL * np.sin(a) ** 2)
        return float(stiffness * sunk), float(sunk)

    @property
    def name(self) -> str:
        """Its name in the table."""
        return f"a = {self.lean:g} degrees, kn/ks = {self.ratio:g}"


WEDGES = tuple(Wedge(lean, ratio) for lean in (10.0, 20.0, 30.0) for ratio in (1.0, 10.0, 1000.0))
FEW = (Wedge(20.0, 1.0), Wedge(20.0, 10.0))


def roof(wedge: Wedge = FEW[1]) -> Model:
    """Return the wedge between two fixed blocks, without gravity, with a load that grows."""
    lean = float(np.tan(np.radians(wedge.lean)))
    builder = new_model("Roof wedge", young=1e14, density=2600.0, poisson=0.0)
    builder.add_joint(
        friction_angle=FRICTION_ANGLE, normal_stiffness=NORMAL, shear_stiffness=NORMAL / wedge.ratio
    )

    def half_width(y: float) -> float:
        return 0.5 * BASE - y * lean

    low, high, out = -BEYOND, HEIGHT + BEYOND, BASE
    right = [(half_width(low), low), (out, low), (out, high), (half_width(high), high)]
    builder.block(name="right", vertices=right, fixed=True)
    left = [(-x, y) for x, y in reversed(right)]
    builder.block(name="left", vertices=left, fixed=True)
    corners = [(half_width(y), y) for y in (0.0, HEIGHT)]
    mirrored = [(-x, y) for x, y in reversed(corners)]
    builder.block(name="wedge", vertices=[*corners, *mirrored])
    builder.in_situ = InSituStress(stress=(-PRESS / HEIGHT, 0.0, 0.0), held=(0.0, 0.0))
    # the loads of the first step belong to the equilibrium that the run begins with
    grows = builder.add_amplitude("grows", (0.0, STEP, STEP * (STEPS + 1)), (0.0, 0.0, FURTHER))
    pull = wedge.exact()[0] / BASE
    base = 0.5 * BASE
    builder.line_load((-base, 0.0), (base, 0.0), (0.0, -pull), block="wedge", amplitude=grows)
    builder.measured_point("wedge", (0.0, 0.0), block="wedge")
    return builder.build()


def pulled(wedge: Wedge, variant: Variant) -> tuple[Floats, Floats]:
    """Return load, N/m, and how far the wedge has sunk, m, under every load, (k,) each.

    Time waits in convex static steps until a load is in balance, whose last step counts.
    """
    history = variant.static(
        roof(wedge), step=STEP, end=STEP * (STEPS + 1), p=NORMAL, max_displacement=0.02
    ).history("wedge")
    last = np.append(np.diff(history.time) > 0.0, True)
    last[0] = False
    share = FURTHER * (history.time[last] - STEP) / (STEP * STEPS)
    return share * wedge.exact()[0], -history.displacement[last, 1]


def pull_out(wedge: Wedge, load: Floats, sunk: Floats) -> int:
    """Return the last step before the wedge slips."""
    P0, u = wedge.exact()
    elastic = np.diff(load) * u / P0
    # A step moves a wedge that slips by so many times the movement of one that does not
    slips = np.flatnonzero(np.diff(sunk) > 2.0 * elastic)
    return int(slips[0]) if len(slips) else len(load) - 1


@problem(set_up=roof, variants=(OPEN_CLOSE, CONVEX), few=(FEW,))
def roof_wedge(trial: Trial, wedges: tuple[Wedge, ...] = WEDGES) -> None:
    """Roof wedge between joints that give way.

    A wedge 4 m wide below, pressed from both sides by H0 = 1 MN/m of in-situ stress, is pulled down
    by a growing load; kn = 10 GPa/m, ks from kn down to a thousandth of it, phi = 40 degrees, h =
    20 ms, static (dynamic_ratio = 0).

    Exact: P0 = 2 H0/D (ks cos^2 a + kn sin^2 a) sin(phi - a), D = ks cos a cos phi + kn sin a sin
    phi; sunk by H0 sin(phi - a)/(L D).
    Source: Brady & Brown (2004), equations 9.26 to 9.30; equilibrium of the wedge on springs.
    Not run with: modified: one pass throws the wedge, p h2/m being far above 6; with four passes P0
    comes out 10 % too high, for modes still change after them.
    """
    loads = []
    for wedge in wedges:
        load, sunk = pulled(wedge, trial.variant)
        at = pull_out(wedge, load, sunk)
        P0, u = wedge.exact()
        half = len(load) // 2
        stiffness = load[half] / sunk[half]
        loads.append((wedge, load[at]))
        trial.relative(f"P0, {wedge.name}", "N/m", load[at], P0, 0.01, RAMP)
        trial.relative(f"sunk at pull-out, {wedge.name}", "m", sunk[at], u, 0.015, RAMP)
        trial.relative(f"stiffness, {wedge.name}", "N/m per m", stiffness, P0 / u, 2e-3, LINEAR)
    fine = np.geomspace(0.5, 2000.0, 60)
    leans = dict.fromkeys(wedge.lean for wedge in wedges)
    chart = trial.chart("load at pull-out", "kₙ/kₛ", "P₀/H₀", log="x")
    for lean in leans:
        chart.exact(
            f"a = {lean:g} degrees", fine, [Wedge(lean, r).exact()[0] / PRESS for r in fine]
        )
    chart.computed([wedge.ratio for wedge, _ in loads], [load / PRESS for _, load in loads])
