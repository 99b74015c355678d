"""Two free blocks collide: the momentum that one gains the other loses, to the last digit."""

import numpy as np

from clast.block import polygon
from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, Model, State, Trial, initial_state, problem
from clast.verification.variants import BOTH_LAWS, CONVEX, LAGGED

VELOCITY = (1.0, 0.2, 0.0)
"""Velocity (u, v, omega) of the arriving block, m/s and rad/s."""
ROUND_OFF = "every contact force acts with opposite signs on two blocks: round-off"
MOMENT = (
    "friction acts on the vertex and on its foot on the edge, which lie one penetration (2.7 mm) "
    "apart; rotation is linear within a step"
)


def two_blocks(friction_angle: float = 30.0) -> Model:
    """Return a block that flies towards a larger one at rest and hits it off its centre."""
    builder = new_model("Collision", young=5e9, density=2700.0, friction_angle=friction_angle)
    arriving = [(-0.1, 0.3), (-0.1, 1.3), (-1.1, 1.2), (-1.0, 0.2)]
    builder.block(name="arriving", vertices=arriving, velocity=VELOCITY)
    builder.block(name="at rest", vertices=box(0, 0, 2, 1))
    builder.measured_point("arriving", (-0.54, 0.75), block="arriving")
    builder.measured_point("at rest", (1.0, 0.5), block="at rest")
    return builder.build()


def momentum(model: Model, state: State) -> Floats:
    """Return momentum (x, y), N s/m, and moment of momentum about the origin, N m s/m."""
    area, centroid, second = polygon.moments(state.vertices, model.block_start)
    linear = model.mass[:, None] * state.velocity[:, :2]
    x, y = centroid.T
    inertia = model.mass / area * (second[:, 0] + second[:, 1])
    angular = x * linear[:, 1] - y * linear[:, 0] + inertia * state.velocity[:, 2]
    return np.array([*linear.sum(axis=0), angular.sum()])


@problem(set_up=two_blocks, variants=BOTH_LAWS, quick=(LAGGED, CONVEX))
def collision(trial: Trial) -> None:
    """Collision of two free blocks.

    A tilted block of 1 m2 flying at (1, 0.2) m/s hits a block of 2 m2 at rest, off its centre, with
    a friction angle of 30 degrees and no gravity; p = 0.1 GPa, h = 1 ms.

    Exact: momentum and moment of momentum after = before.
    Source: Newton's third law.
    """
    model = two_blocks()
    run = trial.variant.run(model, step=1e-3, end=0.3, p=1e8, max_displacement=0.02)
    before, after = momentum(model, initial_state(model)), momentum(model, run.state)
    scale = float(np.hypot(*before[:2]))
    lost = (after - before) / scale
    trial.absolute("change of momentum x / momentum", "", lost[0], 0.0, 1e-13, ROUND_OFF)
    trial.absolute("change of momentum y / momentum", "", lost[1], 0.0, 1e-13, ROUND_OFF)
    trial.absolute("change of moment of momentum / momentum", "m", lost[2], 0.0, 1e-3, MOMENT)
    mass = model.mass
    velocity = np.array([run.history(name).velocity[::15, 0] for name in model.block_name])
    centre = mass @ velocity / mass.sum()
    time = run.history("arriving").time[::15]
    chart = trial.chart("horizontal velocity of the blocks", "time, s", "velocity, m/s")
    chart.exact("centre of mass", time, np.full(len(time), before[0] / mass.sum()))
    chart.computed(np.tile(time, 3), np.ravel([*velocity, centre]))
