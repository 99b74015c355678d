"""A bolt in a roof, installed before or after the pillar below is taken out.

A beam of weight W, all of it elastic and without friction, rests on two ledges, four contacts of
stiffness p in all, and on a pillar of height H and width B between them; a bolt of stiffness s
hangs its centroid on fixed rock above.  With K = 4 p of the ledges, 1/P = 2/(2 p) + H/(B E) of the
pillar, and c = h/(4 b E), by which beam (b x h) and centroid sink beside its foot under the load of
its foot,

    foot = (W - F + P v)/(K + P),   F/s = foot + c (W - F)

for a bolt that is there from the start; v is the settlement of the pillar by its own weight.  A
bolt that is installed when all has settled carries nothing.  Is the pillar then taken out, which
carried N, the bolt and the ledges share that: two springs in parallel,

    F = (N/K)/(1/s + 1/K + c),

whether bolt or pillar comes first, provided that nothing has settled in between; after it the bolt
carries nothing again.
"""

from collections.abc import Sequence

from clast.model.stages import TIME, Stage
from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY, YOUNG, DENSITY = 9.8, 10e9, 2500.0
WIDTH, HEIGHT = 4.0, 1.0
"""Width and height of the beam, m."""
PILLAR = (1.0, 0.5)
"""Width and height of the pillar, m."""
CONTACT, BOLT = 1e9, 1e9
"""Normal stiffness p of a contact and stiffness s of the bolt, N/m per m."""
STEP, DURATION = 2e-3, 0.4
"""Length of a step and of a stage, s."""
RELAX_TIME = 0.2
"""Time within which the forces of the pillar end, s."""
REASON = "the blocks are compressed by 1e-5, which shifts contacts and changes lengths"

WEIGHT = WIDTH * HEIGHT * DENSITY * GRAVITY
LEDGES = 4.0 * CONTACT
OF_PILLAR = 1.0 / (1.0 / CONTACT + PILLAR[1] / (PILLAR[0] * YOUNG))
OF_BEAM = HEIGHT / (4.0 * WIDTH * YOUNG)

ORDERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "settle, bolt": ((), ("bar",)),
    "bolt at the start": (("bar",),),
    "settle, bolt, dig": ((), ("bar",), ("pillar",)),
    "settle, bolt and dig at once": ((), ("bar", "pillar")),
    "settle, dig, bolt": ((), ("pillar",), ("bar",)),
    "bolt at the start, dig": (("bar",), ("pillar",)),
    "dig and bolt at the start": (("bar", "pillar"),),
}
"""Changes at the start of each stage: the bolt installed, the pillar excavated."""


def roof() -> Model:
    """Return a beam on two ledges and a pillar, and the rock above, on which its bolt hangs."""
    builder = new_model("Bolted roof", gravity=GRAVITY, young=YOUNG, density=DENSITY, poisson=0.0)
    builder.add_joint(friction_angle=0.0)
    foot, half = -PILLAR[1], 0.5 * PILLAR[0]
    middle = 0.5 * WIDTH

    def block(name: str, left: float, low: float, right: float, high: float, fixed: bool) -> None:
        builder.block(name=name, vertices=box(left, low, right, high), fixed=fixed)

    block("floor", 0.0, foot - 1.0, WIDTH, foot, True)
    block("left ledge", -1.0, foot, 0.5, 0.0, True)
    block("right ledge", WIDTH - 0.5, foot, WIDTH + 1.0, 0.0, True)
    block("above", 0.0, HEIGHT + 1.0, WIDTH, HEIGHT + 2.0, True)
    block("beam", 0.0, 0.0, WIDTH, HEIGHT, False)
    block("pillar", middle - half, foot, middle + half, 0.0, False)
    builder.add_bolt_kind("bar", stiffness=BOLT)
    builder.bolt((middle, 0.5 * HEIGHT), (middle, HEIGHT + 1.5), kind="bar", name="bolt")
    return builder.build()


def exact_force(order: str) -> float:
    """Return the force of the bolt at the end, N/m."""
    if order in ("settle, bolt", "settle, dig, bolt"):
        return 0.0
    if order in ("bolt at the start, dig", "dig and bolt at the start"):
        return WEIGHT * (1.0 / LEDGES + OF_BEAM) / (1.0 / BOLT + 1.0 / LEDGES + OF_BEAM)
    together = LEDGES + OF_PILLAR
    width, height = PILLAR
    weight = width * height * DENSITY * GRAVITY
    held = OF_PILLAR * (weight / (2.0 * CONTACT) + 0.5 * weight * height / (width * YOUNG))
    if order == "bolt at the start":
        sunk = (WEIGHT + held) / together + OF_BEAM * WEIGHT
        return sunk / (1.0 / BOLT + 1.0 / together + OF_BEAM)
    load = WEIGHT - LEDGES * (WEIGHT + held) / together
    return (load / LEDGES) / (1.0 / BOLT + 1.0 / LEDGES + OF_BEAM)


def stages_of(order: str) -> tuple[Stage, ...]:
    """Return the stages of an order."""
    return tuple(
        Stage(
            name=f"stage {number}",
            until=TIME,
            time=DURATION,
            install=tuple(name for name in named if name == "bar"),
            excavate=tuple(name for name in named if name == "pillar"),
            relax=0.0 if "pillar" in named else 1.0,
            relax_time=RELAX_TIME if "pillar" in named else 0.0,
        )
        for number, named in enumerate(ORDERS[order], start=1)
    )


@problem(set_up=roof, variants=EACH_PROCESS)
def bolted_stages(trial: Trial, orders: Sequence[str] = tuple(ORDERS)) -> None:
    """A bolt installed before or after an excavation.

    A beam of 4 m x 1 m rests on two ledges and on a pillar of 1 m x 0.5 m; no friction, E = 10 GPa,
    nu = 0, rho = 2500 kg/m3, g = 9.8 m/s2, p = 1 GPa, a bolt of s = 1 GPa from its centroid to
    fixed rock above, h = 2 ms, static (dynamic_ratio = 0). In stages of 0.4 s the bolt is installed
    and the pillar excavated, in different orders; the forces of the pillar end within 0.2 s.

    Exact: F = 0 where all has settled before; else the share of springs in parallel, (N/K)/(1/s +
    1/K + c), N being the load of the pillar, K = 4 p, c = h/(4 b E).
    Source: statics.
    """
    chart = trial.chart("force of the bolt", "time, s", "force, kN/m")
    for order in orders:
        history = trial.variant.static(
            roof(),
            step=STEP,
            end=DURATION,
            stages=stages_of(order),
            p=CONTACT,
            max_displacement=0.01,
        ).bolt_history("bolt")
        time, force = history.time, history.force
        exact = exact_force(order)
        if exact == 0.0:
            why = "it is as long as when it was installed"
            trial.absolute(order, "N/m", float(force[-1]), 0.0, 1e-9 * WEIGHT, why)
        else:
            trial.relative(order, "N/m", float(force[-1]), exact, 1e-5, REASON)
        if order.startswith("settle") and order != "settle, bolt":
            # the force of the bolt while those of the pillar end
            digs = next(number for number, named in enumerate(ORDERS[order]) if "pillar" in named)
            start, end = digs * DURATION, len(ORDERS[order]) * DURATION
            instants, last = [0.0, start, start + RELAX_TIME, end], 1e-3 * exact
            chart.exact(order, instants, [0.0, 0.0, last, last])
            label = f"{order}: {trial.variant.name}"
            chart.computed(time[::20], 1e-3 * force[::20], label=label)
