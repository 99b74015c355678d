"""Joints that are open at the start hold nothing, whatever their strength; closed ones hold."""

import numpy as np

from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, box, problem
from clast.verification.variants import EACH_PROCESS, Variant

GRAVITY, DENSITY, STRENGTH = 9.8, 2500.0, 1e5
"""m/s2, kg/m3; cohesion and tensile strength, Pa: four times the weight."""
GAPS = (2e-4, 1e-3, 4e-3)
"""How far the joint is open, m; critdis is 5 mm."""
TURN, AWAY = np.radians(33.0), (4.5e5, -1.2e5)
"""The whole scene is turned by an angle, rad, and far from the origin, m."""
CORNERS = 4
"""Vertices of the ceiling, the first block."""
STEP, END = 1e-3, 0.05
"""s."""


def hung(gap: float, weight: float = GRAVITY) -> Model:
    """Return two bonded blocks of 1 m below a ceiling; ``weight`` is gravity, m/s2."""
    along, up = np.array([np.cos(TURN), np.sin(TURN)]), np.array([-np.sin(TURN), np.cos(TURN)])

    def place(left: float, bottom: float, right: float, top: float) -> Floats:
        corners = np.array(box(left, bottom, right, top))
        return corners[:, :1] * along + corners[:, 1:] * up + np.array(AWAY)

    builder = InputBuilder(title="Open joint", gravity=tuple(-weight * up))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=DENSITY)
    strengths = {"cohesion": STRENGTH, "tensile_strength": STRENGTH}
    builder.add_joint("default", friction_angle=30.0, **strengths)
    builder.block(name="ceiling", vertices=place(-1.0, gap, 2.0, 1.0), fixed=True)
    builder.block(name="upper", vertices=place(0.0, -1.0, 1.0, 0.0))
    builder.block(name="lower", vertices=place(0.0, -2.0, 1.0, -1.0))
    middle = place(0.5, -0.5, 0.5, -0.5)[0]
    builder.measured_point("middle", tuple(middle), block="upper")
    return builder.build()


def run_of(model: Model, variant: Variant, dynamic_ratio: float = 1.0) -> Run:
    """Return the run of a scene."""
    return variant.run(
        model, step=STEP, end=END, p=2e10, max_displacement=0.01, dynamic_ratio=dynamic_ratio
    )


@problem(set_up=lambda: hung(GAPS[1]), variants=EACH_PROCESS)
def open_joints(trial: Trial) -> None:
    """Joints that are open at the start.

    Two blocks of 1 m below a ceiling, c = sigma_t = 0.1 MPa, turned by 33 degrees and at
    coordinates of 4.5e5 m; the joint to the ceiling is open by 0.2, 1 and 4 mm (critdis 5 mm),
    without weight as well, or closed.

    Exact: open: g t^2/2, 0 without weight; closed: tension = weight.
    Source: equilibrium; Newton.
    """
    fall, why = 0.5 * GRAVITY * END**2, "coordinates of 4.5e5 m are rounded to 6e-11 m"
    for gap in GAPS:
        displacement = float(
            np.hypot(*run_of(hung(gap), trial.variant).history("middle").displacement[-1])
        )
        trial.relative(f"fall from {1e3 * gap:g} mm", "m", displacement, fall, 1e-6, why)
    still = run_of(hung(GAPS[0], weight=0.0), trial.variant).state.velocity
    trial.absolute("speed without weight", "m/s", float(np.abs(still).max()), 0.0, 1e-9, why)
    closed = run_of(hung(0.0), trial.variant, dynamic_ratio=0.0)
    memory = closed.state.memory
    of_ceiling = (memory.block == 0) | (memory.vertex < CORNERS)
    tension = -float(memory.normal_force[of_ceiling].sum())
    exact, rest = 2.0 * DENSITY * GRAVITY, "what inertia in the last static step holds"
    trial.relative("tension of the closed joint", "N/m", tension, exact, 1e-8, rest)
