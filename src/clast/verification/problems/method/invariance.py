"""Nothing depends on where a case lies, how it is turned, numbered or measured."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.model.ground_motion import Accelerogram, MovingBase
from clast.model.stages import TIME, Stage
from clast.verification.fixtures import box
from clast.verification.problems import Floats, InputBuilder, KnownFailure, Model, Trial, problem
from clast.verification.problems.friction import decelerating_block
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, WITH_EULER, Variant

ROUND_OFF = "round-off of 300 steps"


@dataclass(frozen=True, kw_only=True)
class View:
    """How a case is written down."""

    name: str
    """The change."""
    shift: tuple[float, float] = (0.0, 0.0)
    """Where its origin lies, m."""
    turn: float = 0.0
    """Angle by which it is turned, degrees."""
    mirror: float = 1.0
    """-1 where it is seen in a mirror, which comes before the turn."""
    first_corner: int = 0
    """Corner of each block that is named first."""
    order: tuple[int, int] = (0, 1)
    """Order in which slope and block are named."""
    length: float = 1.0
    """Units of length in a metre, L."""
    mass: float = 1.0
    """Units of mass in a kilogram, c."""

    @property
    def rotation(self) -> Floats:
        """Matrix of turn and mirror (2, 2)."""
        cosine, sine = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
        return np.array([[cosine, -sine], [sine, cosine]]) @ np.diag([self.mirror, 1.0])

    def places(self, points: Floats) -> Floats:
        """Return points (k, 2) as they are written down."""
        return self.length * (points @ self.rotation.T + np.array(self.shift))

    def vectors(self, vectors: Floats) -> Floats:
        """Return vectors (k, 2), such as velocities, as they are written down."""
        return self.length * (vectors @ self.rotation.T)

    def back(self, vectors: Floats) -> Floats:
        """Return vectors (k, 2) as they are in the original."""
        return vectors @ self.rotation / self.length


ORIGINAL = View(name="as it is")
VIEWS = (
    View(name="moved by 1,000 km", shift=(1e6, -5e5)),
    View(name="turned by 37 degrees", turn=37.0),
    View(name="numbered otherwise", first_corner=2, order=(1, 0)),
    View(name="in mm and t", length=1e3, mass=1e-3),
)
TOLERANCES = dict.fromkeys((view.name for view in VIEWS[1:]), (1e-10, ROUND_OFF))
TOLERANCES[VIEWS[0].name] = (1e-8, "coordinates near 1e6 m resolve 1e-10 m")


def written_down(view: View) -> Model:
    """Return the decelerating block as seen by a view."""
    original = decelerating_block.slope_with_block()
    rock = original.rocks[0]
    builder = InputBuilder(title=view.name, gravity=view.vectors(original.gravity[None])[0])
    builder.add_rock(
        rock.name,
        young=rock.young * view.mass,
        poisson=rock.poisson,
        density=rock.density * view.mass / view.length**2,
    )
    builder.add_joint("default", friction_angle=decelerating_block.FRICTION_ANGLE)
    for block in view.order:
        corners = view.places(original.polygon(block))
        u, v = view.vectors(original.velocity[block : block + 1, :2])[0]
        builder.block(
            name=original.block_name[block],
            vertices=np.roll(corners, -view.first_corner, axis=0),
            fixed=bool(original.fixed[block]),
            velocity=(u, v, 0.0),
        )
    builder.measured_point("centroid", view.places(original.measured_points.at)[0], block="block")
    return builder.build()


def motion(view: View, variant: Variant) -> tuple[Floats, Floats]:
    """Return time, s, and displacement of the block in the original's axes and units, m (t, 2)."""
    numbers: dict[str, Any] = {"p": 1e8 * view.mass, "max_displacement": 0.01 * view.length}
    history = variant.run(written_down(view), step=1e-3, end=0.3, **numbers).history("centroid")
    return history.time, view.back(history.displacement)


@problem(
    set_up=lambda: written_down(VIEWS[1]),
    variants=WITH_EULER,
    few=(VIEWS[1:3],),
    known_failures=tuple(
        KnownFailure(
            variant,
            "change of the displacement when moved",
            "coordinates rounded to 1e-10 m decide whether the contact is found in the "
            "first step or the second, which is worth one step of lagged friction",
        )
        for variant in (LAGGED, EULER, OPEN_CLOSE)
    ),
)
def invariance(trial: Trial, views: tuple[View, ...] = VIEWS) -> None:
    """The same case seen otherwise.

    The decelerating block (0.3 s of it) is moved by 1,000 km, turned by 37 degrees with its
    gravity, numbered otherwise, and written down in mm and t. The picture has it turned.

    Exact: the displacement is the same.
    Source: mechanics has no preferred place, direction, numbering or unit.
    """
    time, original = motion(ORIGINAL, trial.variant)
    size = float(np.hypot(*original[-1]))
    chart = trial.chart("displacement of the block", "time, s", "displacement, m")
    chart.exact("as it is", time, np.hypot(*original.T))
    for view in views:
        _, seen = motion(view, trial.variant)
        tolerance, reason = TOLERANCES[view.name]
        difference = float(np.hypot(*(seen[-1] - original[-1]))) / size
        quantity = f"change of the displacement when {view.name}"
        trial.absolute(quantity, "", difference, 0.0, tolerance, reason)
        chart.computed(time[::30], np.hypot(*seen[::30].T), label=view.name)


GRAVITY, YOUNG, DENSITY = 9.81, 5e9, 2500.0
CONTACT, BOLT, PUSH = 1e9, 2e7, 2e4
"""Stiffness of contacts, N/m per m, and of the bolt, N/m per m; the load, N/m."""
STATIC, SHAKEN = 0.3, 0.2
"""Time of each static stage, and that of the last one, s."""
BLOCKS = {
    "floor": (-1.0, -1.0, 6.0, 0.0),
    "left": (0.0, 0.0, 1.0, 2.0),
    "right": (4.0, 0.0, 5.0, 2.0),
    "prop": (2.3, 0.0, 2.7, 2.0),
    "beam": (0.0, 2.0, 5.0, 3.0),
    "west": (0.0, 3.0, 2.2, 4.0),
    "east": (2.2, 3.0, 5.0, 4.0),
}
"""Left, low, right and upper side of each block, m."""
STAGES = (
    Stage(name="weight", until=TIME, time=STATIC, dynamic_ratio=0.0),
    Stage(
        name="dig",
        until=TIME,
        time=STATIC,
        dynamic_ratio=0.0,
        excavate=("prop",),
        install=("bolts",),
        relax=0.4,
        relax_time=0.1,
    ),
    Stage(name="load", until=TIME, time=STATIC, dynamic_ratio=0.0, loads=("push",)),
    Stage(name="shake", until=TIME, time=SHAKEN, ground_motion=True, dynamic_ratio=1.0),
)
VIEWS_OF_STAGES = (*VIEWS[:2], View(name="mirrored", mirror=-1.0), *VIEWS[2:])


def written_down_of_stages(view: View) -> Model:
    """Return the case as seen by a view."""
    force = view.mass * view.length
    down = view.vectors(np.array([[0.0, -GRAVITY]]))[0]
    builder = InputBuilder(title=view.name, gravity=down)
    builder.add_rock(
        "rock", young=YOUNG * view.mass, poisson=0.2, density=DENSITY * view.mass / view.length**2
    )
    builder.add_joint("default", friction_angle=35.0)
    for name in list(BLOCKS)[:: 1 if view.order == (0, 1) else -1]:
        corners = view.places(np.array(box(*BLOCKS[name])))
        if view.mirror < 0.0:
            corners = corners[::-1]
        builder.block(name=name, vertices=np.roll(corners, -view.first_corner, axis=0))
    for at in view.places(np.array([(-1.0, -1.0), (6.0, -1.0)])):
        builder.fixed_point(at, block="floor")
    builder.add_bolt_kind("bar", stiffness=BOLT * view.mass, pretension=1e3 * force)
    head, end = view.places(np.array([(3.6, 2.5), (3.6, 3.5)]))
    builder.bolt(head, end, kind="bar", name="bolts")
    builder.add_amplitude("grows", time=[0.0, 0.2], value=[0.0, 1.0])
    side = view.places(np.array([(5.0, 3.5)]))[0]
    push = view.vectors(np.array([[-PUSH, 0.0]]))[0] * view.mass
    builder.point_load(side, push, block="east", name="push", amplitude="grows")
    time = np.linspace(0.0, SHAKEN, 41)
    shaking = np.stack([2.0 * np.sin(2.0 * np.pi * time / SHAKEN), np.zeros(len(time))], axis=1)
    builder.ground_motion = MovingBase(Accelerogram(time, view.vectors(shaking)))
    builder.measured_point("east", view.places(np.array([(3.6, 3.5)]))[0], block="east")
    return builder.build()


def staged(view: View, variant: Variant) -> tuple[Floats, Floats, float]:
    """Return time, s, displacement of the eastern block, m (t, 2), and force of the bolt, N/m.

    They are in the original's axes and units.
    """
    run = variant.run(
        written_down_of_stages(view),
        step=2e-3,
        end=STATIC,
        stages=STAGES,
        p=CONTACT * view.mass,
        max_displacement=0.01 * view.length,
    )
    history, bolt = run.history("east"), run.bolt_history("bolts")
    force = float(bolt.force[-1]) / (view.mass * view.length)
    return history.time, view.back(history.displacement), force


@problem(
    set_up=lambda: written_down_of_stages(ORIGINAL), variants=(CONVEX,), few=(VIEWS_OF_STAGES[1:3],)
)
def staged_views(trial: Trial, views: tuple[View, ...] = VIEWS_OF_STAGES) -> None:
    """A staged case seen otherwise.

    A beam on two walls and a prop, with two blocks on it: the weight comes on, the prop is taken
    out while a bolt is installed, a push grows (all static), the ground shakes. It is moved by
    1,000 km, turned by 37 degrees, mirrored, numbered otherwise, and written in mm and t. p = 1
    GPa, h = 2 ms.

    Exact: displacement and bolt force are the same.
    Source: mechanics has no preferred place, direction, hand, numbering or unit.
    Not run with: modified and open-close: round-off decides which contacts at their limit stick in
    their few solves; turned by 37 degrees, displacements differ by 1e-4 of themselves.
    """
    time, first, force = staged(ORIGINAL, trial.variant)
    chart = trial.chart("displacement of the eastern block", "time, s", "displacement, mm")
    chart.exact("as it is", time, 1e3 * np.hypot(*first.T))
    for view in views:
        time, seen, other_force = staged(view, trial.variant)
        apart = float(np.hypot(*(seen[-1] - first[-1]))) / float(np.hypot(*first[-1]))
        changes = (("displacement", apart), ("bolt force", abs(other_force / force - 1.0)))
        for quantity, change in changes:
            text = f"change of the {quantity} when {view.name}"
            trial.absolute(text, "", change, 0.0, 1e-8, "round-off of 550 steps")
        chart.computed(time[::25], 1e3 * np.hypot(*seen[::25].T), label=view.name)
