"""A stack of blocks of which the upper ones are excavated: the remaining ones grow."""

from dataclasses import replace

import numpy as np

from clast.run.excavation import excavated
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, LAGGED, OPEN_CLOSE

GRAVITY, YOUNG, DENSITY = 9.8, 10e9, 2500.0
HEIGHT, WIDTH, BLOCKS, LEFT = 2.0, 1.0, 5, 2
"""Height and width of a block, m, how many there are and how many stay."""
STIFFNESS = 1e9
"""Normal stiffness p, N/m per m."""
CONTACTS = (2, 4)
"""Contacts of the joint below each block that stays."""
RELAX, RELAX_TIME = 0.3, 0.5
"""Share of the weight that ends at once, and the time in which the rest does, s."""
STEP, SETTLING, DURATION = 2e-3, 1.0, 2.0
SHOWN = 25
"""Every so many steps have a point in the figure."""
TOLERANCE = 1e-3
REASON = "the blocks are compressed by 2e-5 already when the load is taken off: second order"


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


@problem(set_up=stack, variants=(LAGGED, OPEN_CLOSE, CONVEX, CONVEX_MULTIPLIERS))
def excavated_stack(trial: Trial) -> None:
    """Excavated stack of blocks.

    Five blocks of 1 m x 2 m rest on each other and on a wider floor; E = 10 GPa, nu = 0, rho = 2500
    kg/m3, g = 9.8 m/s2, p = 1 GPa, h = 2 ms, static (dynamic_ratio = 0). After 1 s the upper three
    are excavated: three tenths of their load ends at once, the rest within 0.5 s.

    Exact: a block grows by W h/(b E), a joint of n contacts opens by W/(n p), W what was taken.
    Source: statics.
    """
    model = stack()
    method = trial.variant.method(model, p=STIFFNESS, max_displacement=0.01, dynamic_ratio=0.0)
    kept: list[RunState] = []
    settled = Schedule(step=STEP, end=SETTLING, every=SETTLING)
    simulate(model, method, settled, keep=kept.append)
    blocks = model.blocks_called(["overburden"])
    left, state = excavated(model, method, kept[-1].state, blocks, RELAX, RELAX_TIME)
    rest = Schedule(step=STEP, end=DURATION, every=DURATION)
    run = simulate(left, method, rest, begin=replace(kept[-1], state=state))
    history = [run.history(f"{name} {k + 1}") for k in range(LEFT) for name in ("foot", "head")]
    rise = [float(one.displacement[-1, 1] - one.displacement[0, 1]) for one in history]
    exact = exact_moves()
    for k in range(LEFT):
        growth, wanted = (moves[2 * k + 1] - moves[2 * k] for moves in (rise, exact))
        trial.relative(f"growth of block {k + 1}", "m", growth, wanted, TOLERANCE, REASON)
        below = (moves[2 * k] - (moves[2 * k - 1] if k else 0.0) for moves in (rise, exact))
        if trial.variant.contact_law["name"] == "penalty":
            opening, wanted = below
            name = f"opening of joint {k + 1}, {CONTACTS[k]} contacts"
            trial.relative(name, "m", opening, wanted, TOLERANCE, REASON)
    foot, head = (one.displacement[:, 1] for one in history[:2])
    time, growth_1 = history[0].time, head - foot
    share = np.clip(1.0 - (1.0 - RELAX) * (1.0 - (time - SETTLING) / RELAX_TIME), RELAX, 1.0)
    share[0] = 0.0
    chart = trial.chart("growth of the lowest block after the excavation", "time, s", "growth, µm")
    chart.exact("share of the weight released", time, 1e6 * (exact[1] - exact[0]) * share)
    chart.computed(time[::SHOWN], 1e6 * (growth_1 - growth_1[0])[::SHOWN])
