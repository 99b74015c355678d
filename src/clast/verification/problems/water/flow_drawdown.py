"""A slope whose lake falls: water that is left in its joints, and the same in finer steps."""

import numpy as np

from clast.results import Run
from clast.rockmass import JointSet, cut
from clast.rockmass.domain import Domain
from clast.verification.fixtures import cut_rock
from clast.verification.problems import Model, Trial, problem
from clast.verification.variants import CONVEX, Variant

OUTLINE = [(0.0, 0.0), (40.0, 0.0), (40.0, 6.0), (30.0, 6.0), (16.0, 20.0), (0.0, 20.0)]
"""The slope, m."""
BEHIND, FULL, EMPTY = 16.0, 14.0, 7.0
"""Level far inside the slope, and levels of the lake, m."""
FALLS, DURATION = 200.0, 400.0
"""Time in which the lake falls, and that of the run, s."""
STEPS = (20, 40, 80, 640)
"""Steps of runs, the last of which the others are compared with."""


def slope() -> Model:
    """Return the slope, cut by two sets of joints, before a lake that falls."""
    sets = [
        JointSet(name="bedding", angle=20.0, spacing=1.7, origin=(0.3, 0.4)),
        JointSet(name="cross", angle=105.0, spacing=1.9, origin=(0.2, 0.1)),
    ]
    builder = cut_rock("Lake that falls", cut(Domain(boundary=OUTLINE), sets), aperture=2e-4)
    builder.flow = {"state": "transient"}
    builder.add_amplitude("lake", time=[0.0, FALLS], value=[FULL, EMPTY])
    faces = [OUTLINE[1:3], OUTLINE[2:4], OUTLINE[3:5]]
    builder.flow_boundary("inside", side="left", head=BEHIND, seepage_above=False)
    builder.flow_boundary("lake", edges=faces, amplitude="lake")
    return builder.build()


def run_of(variant: Variant, steps: int) -> Run:
    """Return the run in so many steps."""
    step = DURATION / steps
    return variant.run(slope(), step=step, end=DURATION, p=1e9, max_displacement=0.1)


@problem(set_up=slope, variants=(CONVEX,), cases=(STEPS,), few=((*STEPS[:2], 160),))
def flow_drawdown(trial: Trial, steps: tuple[int, ...] = STEPS) -> None:
    """Lake that falls before a slope.

    A slope of 20 m before a lake that falls from 14 m to 7 m within 200 s; joints take longer to
    drain, and water seeps out above the lake. Compared are pressures after 400 s in few steps and
    in many, and the ledger of mass.

    Exact: dV/dt = inflow - outflow.
    Source: conservation of mass; the same in fine steps.
    Not run with: modified and open-close: nothing moves.
    """
    known = run_of(trial.variant, steps[-1])
    exact = known.flow().pressure
    chart = trial.chart("water in the joints", "time, s", "volume, m2")
    total = known.table("flow", "all joints")
    chart.exact(f"{steps[-1]} steps", total.time, total["content"])
    missed = []
    for number in steps[:-1]:
        run = run_of(trial.variant, number)
        missed.append(float(np.abs(run.flow().pressure - exact).max() / exact.max()))
        quantity, reason = f"largest error of pressures, {number} steps", "first order in time"
        trial.absolute(quantity, "-", missed[-1], 0.0, 0.01 / number, reason)
        total = run.table("flow", "all joints")
        gained = np.diff(total.time) * (total["into_rock"] - total["out_of_rock"])[1:]
        off = np.abs(np.diff(total["content"]) - gained).max() / total["content"].max()
        quantity, reason = f"unaccounted water of a step by all, {number} steps", "rounding"
        trial.absolute(quantity, "-", float(off), 0.0, 1e-12, reason)
        least = min(float(run.flow().pressure.min()), 0.0)
        trial.absolute(f"least pressure, {number} steps", "Pa", least, 0.0, 0.0, "the law")
        some = slice(None, None, number // 20)
        chart.computed(total.time[some], total["content"][some], label=f"{number} steps")
