"""Joints on springs that water opens and closes: consolidation, a closed joint, jacking, suction.

All are blocks on a fixed base, the joint between them full of water from a stage on in which the
blocks settle; blocks and water are solved in one potential, ``coupling = "full"``.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import erfc
from typing import Any

import numpy as np

from clast.actions.coupled_flow import CoupledWater
from clast.model.stages import Stage
from clast.verification.problems import Floats, InputBuilder, Run, Trial, box, problem
from clast.verification.variants import CONVEX, Variant

VISCOSITY, BULK = 1e-3, 2e9
WEIGHT = 2600.0 * 9.81
"""Weight of the rock, N/m3."""
SETTLED = 1e6
"""Time after which blocks have settled and their water has drained, s."""
LONG, HIGH = 10.0, 5.0
"""Length and height of a single block, m."""
LOAD = HIGH * WEIGHT
"""Normal stress below it, Pa."""
APERTURE = 4e-4
"""Aperture of its joint without stress, m."""
LEFT_OUT = "modified and open-close: they do not minimise a potential"
TIGHT = {"impermeable": True}


def columns(
    places: Any, height: float, *, longest: float | None = None, bulk: float = BULK, **given: Any
) -> InputBuilder:
    """Begin a model of columns between ``places`` (n + 1,), m, on a base, and water below them.

    ``given``: "stiffness" of joints, Pa/m, "aperture" of the joint below, m, without stress, and
    boundaries "left" and "right" of the water.
    """
    builder = InputBuilder(title="A joint and its water", gravity=(0.0, -9.81))
    stiffness = given.get("stiffness", 1e10)
    springs = {"normal_stiffness": stiffness, "shear_stiffness": stiffness}
    for name in ("base", "upper"):
        builder.add_rock(name, young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=0.0, **springs)
    builder.add_joint(
        "bed",
        between_rocks=[("base", "upper")],
        friction_angle=30.0,
        aperture=given.get("aperture", 2e-4),
        residual_aperture=1e-6,
        maximum_aperture=1e-2,
        **springs,
    )
    right = float(places[-1])
    builder.block(name="base", rock="base", vertices=box(0.0, -2.0, right, 0.0), fixed=True)
    for number, (first, last) in enumerate(pairwise(map(float, places))):
        corners = box(first, 0.0, last, height)
        builder.block(name=f"column {number}", rock="upper", vertices=corners)
    builder.flow = {
        "state": "transient",
        "coupling": "full",
        "initial": "hydrostatic",
        "level": 0.0,
        "bulk_modulus": bulk,
        "longest": longest,
        "viscosity": VISCOSITY,
    }
    for side in ("left", "right"):
        builder.flow_boundary(side, side=side, **given.get(side, TIGHT))
    return builder


def stage(name: str, time: float, steps: int, **given: Any) -> Stage:
    """Return a static stage of so much time, s, in so many steps."""
    given = {"dynamic_ratio": 0.0, **given}
    return Stage(name=name, until="time", time=time, step=time / steps, **given)


def run_of(
    builder: InputBuilder, stages: Sequence[Stage], settled: float = SETTLED, of: Variant = CONVEX
) -> Run:
    """Return the run of stages after the blocks have settled for a time, s."""
    every = (stage("settle", settled, 10), *stages)
    end = sum(one.time or 0.0 for one in every)
    numbers: dict[str, Any] = {"p": 1e10, "max_displacement": 0.02}
    return of.run(builder.build(), step=end, end=end, stages=every, **numbers)


def water_of(run: Run) -> CoupledWater:
    """Return the water at the end of a run."""
    (water,) = [one for one in run.state.actions if isinstance(one, CoupledWater)]
    return water


def along_joint(water: CoupledWater) -> tuple[Floats, Floats]:
    """Return places, m, from the left, and pressures of the nodes, Pa, (m,) each."""
    order = np.argsort(water.network.at[:, 0])
    x = water.network.at[order, 0]
    return x - x[0], water.solved.pressure[order]


HEAD, COLUMNS = 100.0, 16
"""Rise of pressure, Pa, and number of columns, 1 m each, 10 m high."""
SPRINGS, WIDTH = 1e10, 1e-4
"""Stiffness of their joint, Pa/m, and its aperture under their weight, m."""
SPREAD = WIDTH**3 / (12.0 * VISCOSITY) / (1.0 / SPRINGS + WIDTH / BULK)
"""D, m2/s: the joint gives way, and the water a little."""
RISEN = (COLUMNS / 6.0) ** 2 / SPREAD
"""Time of the comparison, s."""


def row_of_columns(places: Any = None) -> InputBuilder:
    """Begin the model of columns, of those between ``places``, m, if there are others."""
    places = np.arange(COLUMNS + 1.0) if places is None else places
    aperture, none = WIDTH + 10.0 * WEIGHT / SPRINGS, {"pressure": 0.0}
    return columns(places, 10.0, aperture=aperture, left=none)


def exact_rise(x: Floats) -> Floats:
    """Return p0 erfc(x/2 sqrt(D t)), Pa, at distances, m."""
    return HEAD * np.array([erfc(one / np.sqrt(4.0 * SPREAD * RISEN)) for one in x])


@problem(set_up=lambda: row_of_columns().build(), variants=(CONVEX,))
def flow_consolidation(trial: Trial) -> None:
    """Pressure that runs along a joint on springs.

    Sixteen columns of 10 m stand side by side on a joint of 0.1 mm and 10 GPa/m. The pressure at
    its left end rises by 100 Pa: the joint opens as the water comes, 50 times slower than water
    alone would let it. Compared is the largest error along the joint after 20 steps.

    Exact: p = p0 erfc(x/2 sqrt(D t)), 1/D = (12 mu/a^3) (1/k_n + a/K).
    Source: consolidation (Terzaghi 1925) with the storage of joint and water.
    Not run with: modified and open-close: they do not minimise a potential.
    """
    rise = stage("rise", RISEN, 20, flow_boundary={"left": {"pressure": HEAD}})
    water = water_of(run_of(row_of_columns(), [rise], of=trial.variant))
    x, pressure = along_joint(water)
    missed = float(np.abs(pressure - exact_rise(x)).max() / HEAD)
    reason = "20 steps, first order in time; columns 1 m wide"
    trial.absolute("largest error over p0", "-", missed, 0.0, 0.01, reason)
    left = abs(water.solved.unaccounted) / water.solved.throughput
    trial.absolute("unaccounted water by its flow", "-", left, 0.0, 1e-12, "rounding")
    fine = np.linspace(0.0, COLUMNS, 97)
    chart = trial.chart("pressure along the joint", "distance, m", "pressure, Pa")
    chart.exact("erfc", fine, exact_rise(fine))
    chart.computed(x, pressure)


STIFFNESSES = (1e9, 1e11, 1e12, 1e13)
"""Of the joint below a single block, Pa/m."""


def exact_pressure(stiffness: float) -> float:
    """Return the pressure under the block, Pa, on a joint that keeps its water.

    Of the equilibrium of spring and water, with a0 of water without pressure in the joint.
    """
    pressure = LOAD
    for _ in range(100):
        aperture = APERTURE / (1.0 + pressure / BULK)
        pressure = LOAD / (1.0 + stiffness * aperture / BULK)
    return pressure


@problem(
    set_up=lambda: columns([0.0, LONG], HIGH, aperture=APERTURE).build(),
    variants=(CONVEX,),
    cases=(STIFFNESSES,),
    few=(STIFFNESSES[1:3],),
)
def flow_undrained(trial: Trial, stiffnesses: tuple[float, ...] = STIFFNESSES) -> None:
    """A load on a joint that keeps its water.

    A block of 10 m x 5 m comes down on a joint of 0.4 mm whose ends are shut. Water and springs
    share its weight; then an end is opened, the water drains and the springs carry all of it.

    Exact: p = sigma tau/(1 + tau), tau = K/(a k_n); then p = 0, a = a0 - sigma/k_n.
    Source: Skempton's pressure of undrained loading, for a joint.
    Not run with: modified and open-close: they do not minimise a potential.
    """
    found = []
    reason = "the block strains, and its face with it"
    drain = stage("drain", 1e5, 10, flow_boundary={"left": {"pressure": 0.0}})
    for stiffness in stiffnesses:
        builder = columns([0.0, LONG], HIGH, stiffness=stiffness, aperture=APERTURE, longest=1.0)
        closed = water_of(run_of(builder, [], 2.0, trial.variant))
        drained = water_of(run_of(builder, [drain], 2.0, trial.variant))
        x, pressure = along_joint(closed)
        found.append(float(np.trapezoid(pressure, x) / LONG))
        named = f"k_n = {stiffness:g} Pa/m"
        quantity, exact = f"pressure over the stress, {named}", exact_pressure(stiffness) / LOAD
        trial.relative(quantity, "-", found[-1] / LOAD, exact, 1e-6, reason)
        left = float(np.abs(drained.solved.pressure).max() / LOAD)
        trial.absolute(f"pressure left by draining, {named}", "-", left, 0.0, 1e-3, "10 steps")
        closure = (APERTURE - float(drained.opening.mean())) * stiffness / LOAD
        trial.relative(f"closure by that of springs, {named}", "-", closure, 1.0, 1e-3, "10 steps")
    fine = np.geomspace(1e9, 1e14, 61)
    chart = trial.chart("load carried by water", "k_n, Pa/m", "pressure / stress", log="x")
    chart.exact("τ/(1 + τ)", fine, [exact_pressure(one) / LOAD for one in fine])
    chart.computed(stiffnesses, np.array(found) / LOAD)


VOLUMES, SHARES = (5e-5, 1e-3, 1e-2), (0.5, 0.9, 0.99)
"""Water put in, m2, and pressures as shares of the weight of the block by its length."""


def jacked(volume: float = VOLUMES[1]) -> InputBuilder:
    """Begin a model of a block on a closed joint, into which water is put, m2, within 50 s."""
    builder = columns([0.0, LONG], HIGH, longest=1.0)
    builder.well("well", (0.5 * LONG, 0.0), rate=volume / 50.0, stage="jack")
    return builder


@problem(set_up=lambda: jacked().build(), variants=(CONVEX,))
def flow_jacking(trial: Trial) -> None:
    """A block that is jacked up by water.

    A block of 10 m x 5 m on a joint of 0.2 mm: water is put into the joint, whose ends are shut, or
    stands in it under a pressure below the weight. By volume, the block rides on its water and
    rises as it comes; by pressure, contacts carry the rest.

    Exact: mean p = W/L, a - a0 = V/L less what is pressed together; N = W - p L.
    Source: equilibrium of the block; mass of the water.
    Not run with: modified and open-close: they do not minimise a potential.
    """
    reason = "the block strains, and its face with it"
    opened = []
    for volume in VOLUMES:
        water = water_of(run_of(jacked(volume), [stage("jack", 50.0, 5)], 2.0, trial.variant))
        x, pressure = along_joint(water)
        mean = float(np.trapezoid(pressure, x) / LONG) / LOAD
        named = f"{volume:g} m2 of water"
        trial.relative(f"mean pressure over W/L, {named}", "-", mean, 1.0, 2e-5, reason)
        # water that was there is pressed together by the weight
        held = LONG * 2e-4 * LOAD / BULK
        opened.append(float(water.opening.mean()) - 2e-4)
        rise = (LONG * opened[-1] + held) / volume
        trial.relative(f"opening over V/L, {named}", "-", rise, 1.0, 3e-6, reason)
    for share in SHARES:
        none = {"pressure": 0.0}
        builder = columns([0.0, LONG], HIGH, longest=1.0, left=none, right=none)
        rise_to = {"pressure": share * LOAD}
        lift = stage("lift", 1e4, 10, flow_boundary={"left": rise_to, "right": rise_to})
        run = run_of(builder, [lift], of=trial.variant)
        carried = float(run.state.memory.normal_force.sum()) / (LONG * LOAD)
        quantity = f"force in contacts over W, p L = {share:g} W"
        trial.absolute(quantity, "-", carried, 1.0 - share, 1e-5, reason)
    fine = np.geomspace(VOLUMES[0], VOLUMES[-1], 21)
    chart = trial.chart("opening by water put in", "volume, m2", "opening, m", log="xy")
    chart.exact("V/L", fine, fine / LONG)
    chart.computed(VOLUMES, opened)


LIFT, SOURCE = 1e-4, 1e4
"""By how much the block is lifted within 0.1 s, m, and pressure at its end after that, Pa."""


def lifted() -> InputBuilder:
    """Begin a model of a block on a shut joint with stiff water that is lifted."""
    builder = columns([0.0, LONG], HIGH, longest=1.0, bulk=2e13)
    builder.add_amplitude("lift", time=[0.0, 0.1, 1.0], value=[0.0, LIFT, LIFT])
    builder.motion(block="column 0", y={"displacement": "lift"}, rotation=0.0, stage="lift")
    return builder


@problem(set_up=lambda: lifted().build(), variants=(CONVEX,))
def flow_suction(trial: Trial) -> None:
    """A joint that opens faster than water follows.

    A block of 10 m x 5 m on a joint with shut ends is lifted by 0.1 mm without turning: there is no
    suction, and a void is left. Then water comes from the left under 10 kPa: as far as it has come
    it fills the void and presses, and has the rest of its way before it.

    Exact: p = 0 and e = opening; then V = sqrt(a^3 p e t/(6 mu)) with the void e by length.
    Source: mass of the water; infiltration with a front (Green & Ampt 1911).
    Not run with: modified and open-close: they do not minimise a potential.
    """
    lift = stage("lift", 0.1, 5)
    fill = stage("fill", 200.0, 20, flow_boundary={"left": {"pressure": SOURCE}})
    dry = water_of(run_of(lifted(), [lift], 2.0, trial.variant))
    run = run_of(lifted(), [lift, fill], 2.0, trial.variant)
    pressure = float(dry.solved.pressure.max())
    trial.absolute("pressure where it is lifted", "Pa", pressure, 0.0, 1e-9, "rounding")
    reason = "water that was pressed by the weight, of 2e-8 of the opening"
    aperture = float(dry.opening.mean())
    void, opened = float(dry.void.sum()), LONG * (aperture - 2e-4)
    trial.relative("void over opening", "-", void / opened, 1.0, 1e-7, reason)
    share, reason = opened / (LONG * LIFT), "the block is longer where nothing presses on it"
    trial.relative("opening over the lift", "-", share, 1.0, 0.04, reason)
    total = run.table("flow", "all joints")
    # while blocks come to equilibrium time waits: the last row of an instant has its flow
    last = np.append(np.diff(total.time) > 0.0, True)
    time, rate, content = (one[last] for one in (total.time, total["into_rock"], total["content"]))
    began = int(np.argmax(time >= 2.1 - 1e-9))
    time, gained = time[began:] - time[began], content[began:] - content[began]
    exact = np.sqrt(aperture**3 * SOURCE * (opened / LONG) * time / (6.0 * VISCOSITY))
    reason = "pieces of 1 m fill one by one"
    trial.relative("water after 200 s", "m2", float(gained[-1]), float(exact[-1]), 0.01, reason)
    came, reason = float(np.diff(time) @ rate[began + 1 :]), "as void over opening"
    trial.relative("water that came by that gained", "-", came / gained[-1], 1.0, 1e-5, reason)
    least = float(water_of(run).solved.pressure.min())
    trial.absolute("least pressure as it fills", "Pa", least, 0.0, 1e-9, "rounding")
    chart = trial.chart("water that fills the joint", "time, s", "volume, m2")
    fine = np.linspace(0.0, time[-1], 101)
    chart.exact("front", fine, exact[-1] * np.sqrt(fine / time[-1]))
    chart.computed(time, gained)
