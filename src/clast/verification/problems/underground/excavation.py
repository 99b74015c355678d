"""Blocks are taken out: a stack grows whose upper ones go, a block falls whose prop goes slowly."""

from dataclasses import replace

import numpy as np

from clast.run.excavation import excavated
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import CONVEX_MULTIPLIERS, EACH_PROCESS

GRAVITY, YOUNG, DENSITY = 9.8, 10e9, 2500.0
HEIGHT, WIDTH, BLOCKS, LEFT = 2.0, 1.0, 5, 2
"""Height and width of a block of the stack, m, how many there are and how many stay."""
STIFFNESS = 1e9
"""Normal stiffness p, N/m per m."""
CONTACTS = (2, 4)
"""Contacts of the joint below each block that stays."""
RELAX, RELAX_TIME = 0.3, 0.5
"""Share r of the load that ends at once, and the time T in which the rest does, s."""
SETTLING = 1.0
"""Time before the excavation, s."""
REASON = "the blocks are compressed by 2e-5 already when the load is taken off: second order"


def dug(
    trial: Trial, model: Model, name: str, times: tuple[float, float, float], **numbers: float
) -> Run:
    """Return the run after a model has settled, static, and named blocks were excavated.

    ``times`` are the step, the end of settling and that of the run, s; ``numbers`` as of method().
    """
    step, settling, end = times
    still = trial.variant.method(model, **{**numbers, "dynamic_ratio": 0.0})
    settled: list[RunState] = []
    simulate(model, still, Schedule(step=step, end=settling, every=settling), keep=settled.append)
    state = settled[-1].state
    state = replace(state, velocity=np.zeros_like(state.velocity))
    method = trial.variant.method(model, **numbers)
    blocks = model.blocks_called([name])
    left, state = excavated(model, method, state, blocks, RELAX, RELAX_TIME)
    begin = replace(settled[-1], state=state)
    return simulate(left, method, Schedule(step=step, end=end, every=end), begin=begin)


def stack() -> Model:
    """Return five blocks on a wider floor; the upper three are an opening."""
    builder = new_model(
        "Excavated stack", gravity=GRAVITY, young=YOUNG, density=DENSITY, poisson=0.0
    )
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=box(-1, -1, 2, 0), fixed=True)
    for k in range(BLOCKS):
        low, high = k * HEIGHT, (k + 1) * HEIGHT
        builder.block(name=str(k + 1), vertices=box(0, low, WIDTH, high))
    builder.opening("overburden", [str(k + 1) for k in range(LEFT, BLOCKS)])
    for k in range(LEFT):
        for name, y in (("foot", k * HEIGHT), ("head", (k + 1) * HEIGHT)):
            builder.measured_point(f"{name} {k + 1}", (0.5 * WIDTH, y), block=str(k + 1))
    return builder.build()


def exact_moves() -> list[float]:
    """Return how far foot and head of each block that stays rise, from below, m."""
    weight = (BLOCKS - LEFT) * HEIGHT * WIDTH * DENSITY * GRAVITY
    moves = [0.0]
    for contacts in CONTACTS:
        moves.append(moves[-1] + weight / (contacts * STIFFNESS))
        moves.append(moves[-1] + weight * HEIGHT / (WIDTH * YOUNG))
    return moves[1:]


@problem(set_up=stack, variants=(*EACH_PROCESS, CONVEX_MULTIPLIERS))
def excavated_stack(trial: Trial) -> None:
    """Excavated stack of blocks.

    Five blocks of 1 m x 2 m rest on each other and on a wider floor; E = 10 GPa, nu = 0, rho = 2500
    kg/m3, g = 9.8 m/s2, p = 1 GPa, h = 2 ms, static (dynamic_ratio = 0). After 1 s the upper three
    are excavated: three tenths of their load ends at once, the rest within 0.5 s.

    Exact: a block grows by W h/(b E), a joint of n contacts opens by W/(n p), W what was taken.
    Source: statics.
    """
    times, numbers = (2e-3, SETTLING, 2.0), {"p": STIFFNESS, "max_displacement": 0.01}
    run = dug(trial, stack(), "overburden", times, **numbers, dynamic_ratio=0.0)
    history = [run.history(f"{name} {k + 1}") for k in range(LEFT) for name in ("foot", "head")]
    rise = [float(one.displacement[-1, 1] - one.displacement[0, 1]) for one in history]
    exact = exact_moves()
    for k in range(LEFT):
        growth, wanted = (moves[2 * k + 1] - moves[2 * k] for moves in (rise, exact))
        trial.relative(f"growth of block {k + 1}", "m", growth, wanted, 1e-3, REASON)
        below = (moves[2 * k] - (moves[2 * k - 1] if k else 0.0) for moves in (rise, exact))
        if trial.variant.contact_law["name"] == "penalty":
            opening, wanted = below
            name = f"opening of joint {k + 1}, {CONTACTS[k]} contacts"
            trial.relative(name, "m", opening, wanted, 1e-3, REASON)
    foot, head = (one.displacement[:, 1] for one in history[:2])
    time, growth_1 = history[0].time, head - foot
    share = np.clip(1.0 - (1.0 - RELAX) * (1.0 - (time - SETTLING) / RELAX_TIME), RELAX, 1.0)
    share[0] = 0.0
    chart = trial.chart("growth of the lowest block after the excavation", "time, s", "growth, µm")
    chart.exact("share of the weight released", time, 1e6 * (exact[1] - exact[0]) * share)
    chart.computed(time[::25], 1e6 * (growth_1 - growth_1[0])[::25])


def propped() -> Model:
    """Return a block on a prop of its width, over a fixed floor far below."""
    builder = new_model("Prop taken out", gravity=GRAVITY, young=5e10, density=2500.0, poisson=0.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=box(-1, -1, 2, 0), fixed=True)
    builder.block(name="prop", vertices=box(0, 0, 1, 4))
    builder.block(name="block", vertices=box(0, 4, 1, 5))
    builder.measured_point("block", (0.5, 4.5), block="block")
    return builder.build()


@problem(set_up=propped, variants=EACH_PROCESS)
def relaxed_support(trial: Trial) -> None:
    """Prop that is taken out slowly.

    A block of 1 m x 1 m settles on a prop, static; then the prop is excavated: three tenths of its
    load ends at once, the rest within 0.5 s. p = 1 GPa, h = 1 ms.

    Exact: s = g (r t^2/2 + (1 - r) t^3/(6 T)).
    Source: kinematics.
    """
    settling = 0.5
    times = 1e-3, settling, settling + RELAX_TIME
    run = dug(trial, propped(), "prop", times, p=1e9, max_displacement=0.05)
    history = run.history("block")
    time = history.time - settling
    fallen = history.displacement[0, 1] - history.displacement[:, 1]
    late = (1.0 - RELAX) * time**3 / (6.0 * RELAX_TIME)
    exact = np.asarray(GRAVITY * (0.5 * RELAX * time**2 + late))
    half = len(time) // 2
    why = "forces of a step are those at its end: first order in h"
    trial.relative("fall at T/2", "m", float(fallen[half]), float(exact[half]), 5e-3, why)
    trial.relative("fall at T", "m", float(fallen[-1]), float(exact[-1]), 5e-3, why)
    chart = trial.chart("fall of the block", "time after the excavation, s", "fall, m")
    chart.exact("formula", time, exact)
    chart.exact("without relaxation", time, 0.5 * GRAVITY * time**2)
    chart.computed(time[::25], fallen[::25])
