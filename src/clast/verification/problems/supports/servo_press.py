"""A press with a servo closes the joints of a sample under a stress that it holds."""

import numpy as np

from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, Variant

STRESS, YOUNG, STIFFNESS = 1e6, 2e10, 2e10
"""Pa, Pa, Pa/m."""
LAYERS, THICKNESS, WIDTH = 4, 0.25, 0.5
REASON = "faces are integrated by points; strains are finite"


def scene(layers: int = LAYERS, turned: int = 0) -> Model:
    """Return base, sample of so many layers and platen; lying on its side where ``turned``."""
    builder = new_model("Servo press", young=YOUNG, density=2500.0, poisson=0.0)
    builder.add_joint(friction_angle=30.0, normal_stiffness=STIFFNESS, shear_stiffness=STIFFNESS)
    tall = LAYERS * THICKNESS / layers
    heights = [-0.1, *(tall * np.arange(layers + 1)), LAYERS * THICKNESS + 0.1]
    names = ["base", *(f"layer {k}" for k in range(layers)), "platen"]
    for name, low, high in zip(names, heights[:-1], heights[1:], strict=True):
        corners = box(0.0, low, WIDTH, high)
        if turned:
            corners = [(-y, x) for x, y in corners]
        builder.block(name=name, vertices=corners, fixed=name == "base")
    held, pressed = ("y", (STRESS, 0.0)) if turned else ("x", (0.0, -STRESS))
    builder.motion(
        name="press", block="platen", rotation=0.0, stress=pressed, limit_speed=0.02, **{held: 0.0}
    )
    top = (0.5 * WIDTH, LAYERS * THICKNESS)
    builder.measured_point("head", (-top[1], top[0]) if turned else top, block="platen")
    return builder.build()


def pressed(variant: Variant, layers: int = LAYERS, turned: int = 0) -> Run:
    """Return the run."""
    return variant.run(scene(layers, turned), step=1e-3, end=0.4, p=YOUNG, max_displacement=0.01)


def closure(layers: int) -> float:
    """Return the shortening at the platen, m: joints at both ends of the sample close, too."""
    joints = (layers + 1) / STIFFNESS
    # the platen strains by half its height below its centroid
    return STRESS * (joints + LAYERS * THICKNESS / YOUNG)


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE))
def servo_press(trial: Trial) -> None:
    """A press with a servo on a jointed sample.

    A platen with x and rotation held presses with 1 MPa, at 20 mm/s at most, on 4 layers of 0.25 m,
    E = 20 GPa, joints of 20 GPa/m; also turned, and of 8 layers; no gravity, h = 1 ms.

    Exact: u = sigma (j/k_n + H/E).
    Source: springs in series.
    Not run with: modified: one pass and four throw the layers in the first step, which ends with
    more energy than the press has given.
    """
    runs = {
        "4 layers": (LAYERS, pressed(trial.variant)),
        "turned": (LAYERS, pressed(trial.variant, turned=1)),
        "8 layers": (8, pressed(trial.variant, 8)),
    }
    for name, (layers, run) in runs.items():
        force = float(np.hypot(*run.reaction("press").force[-1]))
        displacement = float(np.hypot(*run.history("head").displacement[-1]))
        trial.relative(f"stress, {name}", "Pa", force / WIDTH, STRESS, 1e-2, REASON)
        trial.relative(f"closure, {name}", "m", displacement, closure(layers), 1e-2, REASON)
    run = runs["4 layers"][1]
    press, head = run.reaction("press"), run.history("head")
    most = closure(LAYERS)
    chart = trial.chart("stress and closure", "closure, mm", "stress, MPa")
    chart.exact("σ/u", 1e3 * np.array([0.0, most]), 1e-6 * np.array([0.0, STRESS]))
    chart.computed(-1e3 * head.displacement[1::8, 1], -1e-6 * press.force[1::8, 1] / WIDTH)
