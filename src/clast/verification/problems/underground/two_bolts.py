"""Bolts hold a block, one of which yields: loaded, unloaded, and the residual stretch."""

import numpy as np

from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES

YIELDING, ELASTIC = 2e7, 1e7
"""Stiffness of both weak bolts together, a, and of the strong one, b, N/m per m."""
YIELD = 1e5
"""Force at which both weak bolts together yield, N/m."""
STAGES = (0.9e5, 2.2e5, 0.0)
"""Loads on the block, N/m, one after the other: each comes within 1 s and stays for 1 s."""
LOADS = (0.0, *(load for load in STAGES for _ in range(2)))
INSTANTS = tuple(float(k) for k in range(len(LOADS)))
STEP = 0.1
REASON = "blocks give by 1e-4 of what bolts do"


def hung_block() -> Model:
    """Return a block on three vertical bolts under a fixed one, pulled down by a load."""
    builder = new_model(
        "Two kinds of bolts", young=5e10, density=2500.0, poisson=0.0, friction_angle=30.0
    )
    builder.block(name="roof", vertices=box(0, 2, 2, 3), fixed=True)
    builder.block(name="block", vertices=box(0, 0, 2, 1))
    builder.add_bolt_kind(
        "weak", stiffness=0.5 * YIELDING, yield_force=0.5 * YIELD, compression=True
    )
    builder.add_bolt_kind("strong", stiffness=ELASTIC, compression=True)
    for x, kind in ((0.5, "weak"), (1.0, "strong"), (1.5, "weak")):
        builder.bolt((x, 2.0), (x, 1.0), kind=kind, name=f"{kind} at {x:g}")
    table = builder.add_amplitude("load", list(INSTANTS), [load / max(LOADS) for load in LOADS])
    builder.point_load((1.0, 0.5), (0.0, -max(LOADS)), block="block", amplitude=table)
    builder.measured_point("head", (1.0, 1.0), block="block")
    return builder.build()


def exact_stretch(load: float, most: float) -> float:
    """Return the stretch under a load, N/m, when the largest before, ``most``, is on or over."""
    first = YIELD / YIELDING
    if most <= first * (YIELDING + ELASTIC):
        return load / (YIELDING + ELASTIC)
    if load == most:
        return (load - YIELD) / ELASTIC
    flowed = (most - YIELD) / ELASTIC - first
    return (load + YIELDING * flowed) / (YIELDING + ELASTIC)


@problem(set_up=hung_block, variants=(OPEN_CLOSE, CONVEX, PASSES))
def two_bolts(trial: Trial) -> None:
    """Bolts side by side, of which some yield.

    A block hangs from a fixed one by two bolts of 10 MN/m that yield at 50 kN/m each and one of 10
    MN/m that does not; it is loaded with 90 and 220 kN/m and unloaded; no gravity, E = 50 GPa,
    static (dynamic_ratio = 0), h = 0.1 s.

    Exact: u = F/(a + b), (F - F_y)/b beyond yield, a (u_largest - F_y/a)/(a + b) unloaded.
    Source: springs in parallel.
    """
    run = trial.variant.static(
        hung_block(), step=STEP, end=INSTANTS[-1], p=1e9, max_displacement=0.05
    )
    history = run.history("head")
    stretch = -history.displacement[:, 1]
    largest = np.maximum.accumulate(STAGES).tolist()
    for number, (load, most) in enumerate(zip(STAGES, largest, strict=True)):
        at = int(np.searchsorted(history.time, 2.0 * (number + 1) - 0.5 * STEP))
        exact = exact_stretch(load, most)
        name = f"stretch under {1e-3 * load:g} kN/m"
        name += " again" if load == 0.0 else ""
        trial.relative(name, "m", float(stretch[at]), exact, 1e-3, REASON)
    left = float(run.bolt_history("strong at 1").force[-1])
    exact = ELASTIC * exact_stretch(0.0, max(LOADS))
    trial.relative("force that stays", "N/m", left, exact, 1e-3, REASON)
    loads = np.interp(history.time, INSTANTS, LOADS)
    corners = [0.0, YIELD / YIELDING * (YIELDING + ELASTIC), max(LOADS)]
    path = [exact_stretch(load, load) for load in corners] + [exact_stretch(0.0, max(LOADS))]
    chart = trial.chart("load and stretch", "stretch, mm", "load, kN/m")
    chart.exact("formula", 1e3 * np.array(path), 1e-3 * np.array([*corners, 0.0]))
    chart.computed(1e3 * stretch[::3], 1e-3 * loads[::3])
