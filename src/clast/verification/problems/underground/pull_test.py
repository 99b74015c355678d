"""Pull-out of a grouted bolt: load against displacement, yield and rupture.

A block is pulled off a wall by the load F, across a joint that a grouted bolt of stiffness s, yield
force F_y and rupture at the elongation u_r crosses.  A test frame, an elastic bar of stiffness K
beside it, takes the load that the bolt does not, so that there is an equilibrium at every
displacement.  A bolt with a pretension T_0 keeps the joint shut up to F = T_0; at a displacement u
it then carries

    B = T_0 + s u up to F_y, then F_y, then 0 from u = u_r - T_0/s on,      F = B + K u.

At rupture the frame alone is left: u jumps from (F - F_y)/K to F/K.
"""

import numpy as np

from clast.verification.problems import Floats, Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

BOLT, YIELD, RUPTURE = 1e8, 2e5, 8e-3
"""Stiffness at a joint s, N/m per m, yield force F_y, N/m, and elongation at rupture u_r, m."""
FRAME = 5e7
"""Stiffness K of the test frame, N/m per m."""
PRETENSIONS = (0.0, 8e4)
"""Pretensions T_0 of the bolt, N/m."""
FURTHER = 1.25
"""Load at the end over that at rupture."""
STEP, STEPS = 0.02, 250
REASON = "the load grows by 0.5 % of its end a step, which open-close follows a step late"
BETWEEN = f"the load grows by {100 * FURTHER / STEPS:.2g} % a step"


def load_at_rupture(pretension: float) -> float:
    """Return the load F at which the bolt breaks, N/m."""
    return YIELD + FRAME * (RUPTURE - pretension / BOLT)


def exact_moved(load: float, pretension: float) -> float:
    """Return the displacement u, m, under a load, N/m."""
    if load > load_at_rupture(pretension):
        return load / FRAME
    elastic = max(0.0, load - pretension) / (BOLT + FRAME)
    return max(elastic, (load - YIELD) / FRAME)


def pulled(pretension: float = 0.0) -> Model:
    """Return the wall, the block, the grouted bolt and the frame, under a load that grows."""
    builder = new_model(
        "Pull test of a grouted bolt", young=5e13, density=2500.0, poisson=0.0, friction_angle=30.0
    )
    builder.block(name="wall", vertices=box(-2, 0, 0, 1), fixed=True)
    builder.block(name="block", vertices=box(0, 0, 1, 1))
    builder.add_bolt_kind(
        "bar", stiffness=BOLT, yield_force=YIELD, rupture_elongation=RUPTURE, pretension=pretension
    )
    middle = (0.75, 0.5), (-1.5, 0.5)
    builder.bolt(*middle, kind="bar", name="bar", anchorage="grouted", free_length=0.1)
    builder.add_bolt_kind("frame", stiffness=0.5 * FRAME, compression=True)
    for y in (0.25, 0.75):
        builder.bolt((0.75, y), (-1.5, y), kind="frame", name=f"frame at {y:g}")
    grows = builder.add_amplitude("grows", (0.0, STEP * STEPS), (0.0, 1.0))
    most = FURTHER * load_at_rupture(pretension)
    builder.point_load((1.0, 0.5), (most, 0.0), block="block", amplitude=grows)
    builder.measured_point("head", (1.0, 0.5), block="block")
    return builder.build()


def curve_of(pretension: float, variant: Variant) -> tuple[Floats, Floats]:
    """Return load, N/m, and displacement, m, (k,) each.

    Time waits in convex static steps until a load is in balance, whose last step counts.
    """
    model = pulled(pretension)
    end = STEP * STEPS
    history = variant.static(model, step=STEP, end=end, p=1e10, max_displacement=0.05).history(
        "head"
    )
    last = np.append(np.diff(history.time) > 0.0, True)
    load = FURTHER * load_at_rupture(pretension) * history.time[last] / end
    return load, history.displacement[last, 0]


@problem(set_up=pulled, variants=(OPEN_CLOSE, CONVEX, PASSES))
def pull_test(trial: Trial, pretensions: tuple[float, ...] = PRETENSIONS) -> None:
    """Pull-out and rupture of a grouted bolt.

    A grouted bolt (100 MN/m, yield at 200 kN/m, rupture at 8 mm), with and without pretension, is
    pulled beside a test frame of 50 MN/m; no gravity, h = 20 ms, static (dynamic_ratio = 0). One
    pass of modified would tolerate springs this stiff on a block this light in steps of 1 ms.

    Exact: F = min(T_0 + s u, F_y) + K u up to u = u_r - T_0/s, then K u.
    Source: springs in parallel.
    """
    chart = trial.chart("load and displacement", "displacement, mm", "load, kN/m")
    for pretension in pretensions:
        load, moved = curve_of(pretension, trial.variant)
        which = f"T_0 = {1e-3 * pretension:g} kN/m"
        shown = which.replace("T_0", "T₀")
        breaks = load_at_rupture(pretension)
        yields = YIELD + FRAME * (YIELD - pretension) / BOLT
        places = (0.5 * (pretension + yields), 0.5 * (yields + breaks), load[-1])
        for wanted, what in zip(places, ("elastic", "yields", "broken"), strict=True):
            at = int(np.searchsorted(load, wanted))
            exact = exact_moved(load[at], pretension)
            quantity = f"displacement, bolt {what}, {which}"
            trial.relative(quantity, "m", moved[at], exact, 5e-3, REASON)
        jump = int(np.argmax(np.diff(moved)))
        quantity = f"load at rupture, {which}"
        trial.relative(quantity, "N/m", load[jump], breaks, 0.01, BETWEEN)
        exact_path = np.array([exact_moved(one, pretension) for one in load])
        chart.exact(f"formula, {shown}", 1e3 * exact_path, 1e-3 * load)
        chart.computed(1e3 * moved[::10], 1e-3 * load[::10], label=f"{trial.variant.name}, {shown}")
