"""Goodman and Bray's toppling slope held by a horizontal bolt in its toe column."""

import numpy as np

from clast.verification.problems import InputBuilder, Model, Trial, limit, problem
from clast.verification.problems.slopes import toppling
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

FRICTION = 0.65
"""tan phi of all joints."""
AT_ONCE = "the weight comes at once and finds the joints without shear force; bisected to 2.5 %"


def exact_force() -> float:
    """Return the force of the bolt that just holds the toe, N/m: 2013 kN/m in the original."""
    push, dip = toppling.push_at_toe(FRICTION), toppling.DIP
    return float(push * (1.0 - FRICTION**2) / (FRICTION * np.sin(dip) + np.cos(dip)))


def bolted(force: float | None = None) -> Model:
    """Return the slope with its bolt."""
    builder = InputBuilder()
    toppling.build(builder, float(np.degrees(np.arctan(FRICTION))))
    column = toppling.place(0.5 * toppling.WIDTH, toppling.RISE + 0.5 * toppling.height(1))
    builder.add_bolt_kind("cable", stiffness=2e7, pretension=force or exact_force())
    anchor = (column[0] + 20.0, column[1])
    builder.bolt(column, anchor, kind="cable", pretension_is="jacked")
    return builder.build()


def holds(force: float, variant: Variant) -> bool:
    """Return whether the toe stays."""
    run = variant.run(
        bolted(force),
        step=toppling.STEP,
        end=toppling.DURATION,
        p=1e9,
        max_displacement=0.05,
        dynamic_ratio=toppling.DAMPED,
    )
    return toppling.toe_movement(run) <= toppling.MOVING


@problem(set_up=bolted, variants=(OPEN_CLOSE, CONVEX, PASSES), quick=())
def bolted_toppling(trial: Trial) -> None:
    """Goodman and Bray's toppling slope with a bolt in its toe.

    The slope of the problem toppling with tan phi = 0.65 and a horizontal bolt in its toe column,
    whose force a jack holds; it is bisected until the toe moves.

    Exact: T = P (1 - tan2 phi)/(tan phi sin a + cos a) = 2012.8 kN/m.
    Source: limit equilibrium of Goodman & Bray (1976), solved here.
    """
    exact = exact_force()
    least = limit(lambda force: holds(force, trial.variant), 0.8 * exact, 1.2 * exact, 4)
    trial.relative("least force of the bolt", "N/m", least, exact, 0.05, AT_ONCE)
