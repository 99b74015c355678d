"""The thinnest semicircular arch that stands under its own weight."""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.limit_analysis import add_voussoirs, joint_ends, reserve, voussoirs_between
from clast.verification.problems import Model, StaticRun, Trial, limit, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

RADIUS, VOUSSOIRS = 5.0, 20
"""Mean radius, m, and number of voussoirs: joints at the crown and at 54 degrees from it."""
FRICTION_ANGLE = 50.0
"""Friction angle, degrees; no joint slips."""
MILANKOVITCH = 0.1075
"""t/R of the thinnest arch."""
LOW, HIGH = 0.1045, 0.1105
"""t/R that are searched."""


def safety(share: float, voussoirs: int = VOUSSOIRS) -> float:
    """Return the reserve of an arch, N/m over rho g: not negative where it stands."""
    ends = joint_ends(RADIUS, share, 180.0, voussoirs)
    blocks = voussoirs_between(*ends, FRICTION_ANGLE)
    return reserve(blocks, blocks.body_force((0.0, -1.0)))


def exact_limit(voussoirs: int = VOUSSOIRS) -> float:
    """Return t/R of the thinnest arch of so many voussoirs."""
    return limit(lambda share: safety(share, voussoirs) > 0.0, LOW, HIGH, 20)


def model_of_arch(share: float = 0.12) -> Model:
    """Return a fixed base and the voussoirs of an arch with t/R = ``share``."""
    inner, outer = joint_ends(RADIUS, share, 180.0, VOUSSOIRS)
    reach = RADIUS * (1.0 + share)
    builder = new_model(
        "Semicircular arch", gravity=9.8, young=50e9, density=2400.0, friction_angle=FRICTION_ANGLE
    )
    builder.block(name="base", vertices=box(-reach, -0.5, reach, 0), fixed=True)
    add_voussoirs(builder, inner, outer)
    builder.measured_point("crown", (0.0, float(outer[VOUSSOIRS // 2, 1])), block="10")
    return builder.build()


@problem(set_up=model_of_arch, variants=(OPEN_CLOSE, CONVEX), few=(2,))
def arch(trial: Trial, bisections: int = 4) -> None:
    """Thinnest semicircular arch.

    Twenty voussoirs on a semicircle of 5 m mean radius under their weight; the thickness is
    bisected. E = 50 GPa, p = 10 GPa, phi = 50 degrees, h = 4 ms, static (dynamic_ratio = 0).

    Exact: t/R = 0.1075 without joints; 0.10735 with joints every 9 degrees.
    Source: Milankovitch (1907), Heyman (1969); with joints by linear programming (scipy).
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6.
    """
    static = StaticRun(p=1e10, step=4e-3, steps=300, bisections=bisections)
    thinnest = static.limit(trial.variant, model_of_arch, LOW, HIGH)
    exact, width = exact_limit(), (HIGH - LOW) / 2**bisections
    quantity, reason = f"t/R of {VOUSSOIRS} voussoirs", f"bisected to {width:.1g}; "
    reason += "joints and blocks give a little"
    trial.relative(quantity, "", thinnest, exact, 1.5 * width / exact, reason)
    quantity, reason = "t/R of an arch without joints", "hinges only at joints: 0.15 % less"
    tolerance = 0.01 + width / MILANKOVITCH
    trial.relative(quantity, "", thinnest, MILANKOVITCH, tolerance, reason)
    shares = np.linspace(0.102, 0.113, 12)
    labels = "t/R", "least end force of a joint, N/(ρ g)"
    chart = trial.chart("reserve of the line of thrust", *labels)
    chart.exact("by linear programming", shares, [safety(one) for one in shares])
    chart.computed((thinnest,), (0.0,), "limit")
