"""A bead slides outwards on a rod that turns freely: energy and angular momentum stay.

The rod turns about a pin in its middle by the angle q; the bead turns with it at the distance r
along it, its centroid h beside the line through the pin.  With the moment of inertia I of both,
each about its own centre, and the mass m of the bead

    T = 1/2 I q'2 + 1/2 m ((r' - h q')2 + r2 q'2),
    L = I q' + m (r2 q' - h (r' - h q')),

and both stay as they were, with which r'' - h q'' = r q'2.  The force between rod and bead is
across the rod where the bead is, not where it was at first.  Links that give in store some of the
energy.
"""

from dataclasses import dataclass

import numpy as np

from clast.verification.fixtures import new_model
from clast.verification.problems import Floats, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, MIDPOINT, OPEN_CLOSE

DENSITY, YOUNG = 1000.0, 1e12
LENGTH, HEIGHT, SIDE = 4.0, 0.1, 0.2
"""Rod, and side of the square bead, m."""
SPIN, AWAY = 2.0, 1.0
"""Angular velocity, 1/s, and distance of the bead from the pin, m, at the start."""
BESIDE = 0.5 * (HEIGHT + SIDE)
END, STEP, SOFT = 1.0, 1e-3, 1e7
BEAD = DENSITY * SIDE**2
INERTIA = (
    DENSITY * LENGTH * HEIGHT * (LENGTH**2 + HEIGHT**2) / 12.0 + DENSITY * SIDE**2 * SIDE**2 / 6.0
)
CONVERGES = "second order in the step: 5e-7 of the energy and 3e-6 m in steps of 1 ms"
BENT = "links of 10 MN/m give in by some micrometres, and swing"


def followed(times: Floats) -> Floats:
    """Return q, r, q' and r' at times, s, (4, t), from the equations of motion."""
    from scipy.integrate import solve_ivp  # slow to load

    def rates(_: float, y: Floats) -> Floats:
        _, r, spin, speed = y
        matrix = np.array([[INERTIA + BEAD * (BESIDE**2 + r**2), -BEAD * BESIDE], [-BESIDE, 1.0]])
        right = np.array([-2.0 * BEAD * r * speed * spin, r * spin**2])
        return np.array([spin, speed, *np.linalg.solve(matrix, right)])

    start = [0.0, AWAY, SPIN, 0.0]
    answer = solve_ivp(rates, (0.0, times[-1]), start, rtol=1e-11, atol=1e-12, t_eval=times)
    return np.asarray(answer.y)


@dataclass(frozen=True, kw_only=True)
class Slide:
    """A rod and its bead."""

    name: str
    mirror: float = 1.0
    """-1: everything is mirrored."""
    first: str = "rod"
    """The block with which the link turns."""
    stiffness: float | str = "rigid"


CASES = (
    Slide(name="rigid"),
    Slide(name="mirrored", mirror=-1.0),
    Slide(name="turning with the bead", first="bead"),
    Slide(name="elastic", stiffness=SOFT),
)


def scene(case: Slide = CASES[0]) -> Model:
    """Return rod and bead."""
    builder = new_model(
        "Bead on a rod", young=YOUNG, density=DENSITY, poisson=0.0, friction_angle=20.0
    )
    mirror, spin = case.mirror, case.mirror * SPIN
    rod = _box(mirror, (-0.5 * LENGTH, -0.5 * HEIGHT), (LENGTH, HEIGHT))
    bead = _box(mirror, (AWAY - 0.5 * SIDE, 0.5 * HEIGHT), (SIDE, SIDE))
    builder.block(name="rod", vertices=rod, velocity=(0.0, 0.0, spin))
    speed = (-spin * BESIDE, spin * mirror * AWAY, spin)
    builder.block(name="bead", vertices=bead, velocity=speed)
    builder.link(name="pin", at=(0.0, 0.0), block="rod", x="rigid", y="rigid")
    builder.link(
        name="slide",
        at=(mirror * AWAY, 0.5 * HEIGHT),
        blocks=(case.first, "rod" if case.first == "bead" else "bead"),
        direction=(mirror, 0.0),
        y=case.stiffness,
        rotation=case.stiffness,
        contacts=False,
    )
    builder.measured_point("bead", (mirror * AWAY, BESIDE), block="bead")
    builder.measured_point("rod", (0.0, 0.0), block="rod")
    return builder.build()


def _box(
    mirror: float, corner: tuple[float, float], size: tuple[float, float]
) -> list[tuple[float, float]]:
    """Return a rectangle, mirrored by a ``mirror`` of -1."""
    (x, y), (w, h) = corner, size
    corners = [(mirror * a, b) for a, b in ((x, y), (x + w, y), (x + w, y + h), (x, y + h))]
    return corners if mirror > 0.0 else corners[::-1]


def compare(trial: Trial, case: Slide, run: Run) -> None:
    """Compare energy, angular momentum and place."""
    angle, away, spin, speed = followed(np.array([0.0, END]))[:, -1]
    kinetic = 0.5 * INERTIA * spin**2
    kinetic += 0.5 * BEAD * ((speed - BESIDE * spin) ** 2 + (away * spin) ** 2)
    energy = run.state.ledger
    stored = energy.kinetic + energy.links + energy.fixed_points + energy.elastic
    velocity, centre = run.state.velocity, run.history("bead")
    at = np.array([case.mirror * AWAY, BESIDE]) + centre.displacement[-1]
    along = np.array([case.mirror * np.cos(angle), np.sin(angle)])
    across = np.array([-case.mirror * np.sin(angle), np.cos(angle)])
    place = away * along + BESIDE * across
    rod = DENSITY * LENGTH * HEIGHT * (LENGTH**2 + HEIGHT**2) / 12.0
    u, v, turn = velocity[1, :3]
    momentum = rod * velocity[0, 2] + (INERTIA - rod) * turn + BEAD * (at[0] * v - at[1] * u)
    start = INERTIA * SPIN + BEAD * (AWAY**2 + BESIDE**2) * SPIN
    near, reason = (2e-4, BENT) if case.stiffness == SOFT else (5e-6, CONVERGES)
    name, off = case.name, float(np.hypot(*(at - place)))
    momentum *= case.mirror
    trial.relative(f"energy, {name}", "J/m", stored, kinetic, 1e-6, CONVERGES)
    trial.relative(f"angular momentum, {name}", "N m s/m", momentum, start, 1e-6, CONVERGES)
    trial.absolute(f"place of the bead, {name}", "m", off, 0.0, near, reason)


@problem(set_up=scene, variants=(CONVEX, MIDPOINT, OPEN_CLOSE))
def slider(trial: Trial) -> None:
    """A bead on a rod that turns.

    A rod of 4 x 0.1 m turns freely at 2 rad/s about its middle; a bead of 0.2 x 0.2 m slides
    outwards on it, held across and in rotation; also mirrored, with the link turning with the bead,
    and on links that give in.

    Exact: T and L stay; r'' - h q'' = r q'2.
    Source: mechanics of rigid bodies.
    Not run with: modified: without contacts it solves the equations of open-close, in one pass.
    """
    runs = [
        trial.variant.run(scene(case), step=STEP, end=END, p=1e9, max_displacement=0.1)
        for case in CASES
    ]
    for case, run in zip(CASES, runs, strict=True):
        compare(trial, case, run)
    centre = runs[0].history("bead")
    at = np.array([AWAY, BESIDE]) + centre.displacement
    distance = np.sqrt((at**2).sum(axis=1) - BESIDE**2)
    times = np.linspace(0.0, END, 50)
    chart = trial.chart("the bead along the rod", "time, s", "distance, m")
    chart.exact("r(t)", times, followed(times)[1])
    chart.computed(centre.time[::50], distance[::50])
