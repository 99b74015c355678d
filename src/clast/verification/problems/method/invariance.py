"""Nothing depends on where a case lies, how it is turned, numbered or measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.problems import Floats, InputBuilder, KnownFailure, Model, Trial, problem
from clast.verification.problems.friction import decelerating_block
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, Variant

STEP, DURATION = 1e-3, 0.3
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
TOLERANCES = {
    "moved by 1,000 km": (1e-8, "coordinates near 1e6 m resolve 1e-10 m"),
    "turned by 37 degrees": (1e-10, ROUND_OFF),
    "numbered otherwise": (1e-10, ROUND_OFF),
    "in mm and t": (1e-10, ROUND_OFF),
}


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
    model = written_down(view)
    history = variant.run(
        model,
        step=STEP,
        end=DURATION,
        normal_stiffness=1e8 * view.mass,
        max_displacement=0.01 * view.length,
    ).history("centroid")
    return history.time, view.back(history.displacement)


@problem(
    set_up=lambda: written_down(VIEWS[1]),
    variants=(LAGGED, EULER, OPEN_CLOSE, CONVEX),
    quick=(CONVEX,),
    few=(VIEWS[1:3],),
    known_failures=tuple(
        KnownFailure(
            variant=variant,
            quantity="change of the displacement when moved",
            reason="coordinates rounded to 1e-10 m decide whether the contact is found in the "
            "first step or the second, which is worth one step of lagged friction",
        )
        for variant in (LAGGED, OPEN_CLOSE)
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
    curves = []
    for view in views:
        _, seen = motion(view, trial.variant)
        tolerance, reason = TOLERANCES[view.name]
        difference = float(np.hypot(*(seen[-1] - original[-1]))) / size
        quantity = f"change of the displacement when {view.name}"
        trial.absolute(quantity, "", difference, 0.0, tolerance, reason)
        curves.append(curve(view.name, time[::30], np.hypot(*seen[::30].T)))
    trial.chart(
        "displacement of the block",
        "time, s",
        "displacement, m",
        exact_curve("as it is", time, np.hypot(*original.T)),
        *curves,
    )
