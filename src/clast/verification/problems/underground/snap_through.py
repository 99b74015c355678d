"""A cracked roof beam that arches, sags and snaps through.

A beam bridges a span between abutments and is cracked in the middle.  By symmetry one of its
stiff halves, of length s, depth t and weight W, is looked at: it touches the wall of the abutment
with its lower outer corner and the plane of symmetry with its upper inner one, z higher, and lies
on a nose of the abutment, c from the wall.  As it sags by t - z its diagonal D lies flatter, and
the two corners are e = sqrt(D2 - z2) apart; it has turned by a.  The nose pushes at right angles
to its lower edge, and so with W tan a to the middle.  With the thrust H at the wall,

    e - s = (H + (H + W tan a))/p,
    (H + W tan a) z = W (e/2 - (c + H/p)/cos2 a)

by the springs p of both contacts and by the moments about the corner at the wall.  The thrust that
keeps the beam up grows as z shrinks, that of the springs first grows, then fades: below a certain p
nothing balances the weight.
"""

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Model, StaticRun, Trial, limit, problem
from clast.verification.variants import EACH_PROCESS, Variant

GRAVITY, DENSITY = 9.8, 2600.0
HALF, DEPTH, NOSE = 5.0, 0.5, 0.1
"""Length s of a half, its depth t and the width c of a nose, m."""
WEIGHT = DENSITY * GRAVITY * HALF * DEPTH
STIFFNESSES = (1e9, 1e8)
"""p at which sag and thrust are compared, N/m per m."""
STEP = 2e-2
STIFF = "the rock is not rigid: E = 1e13 Pa"
RESOLUTION = "bisected to 1 %; a beam near its limit sinks slowly"


def needed(rise: float, nose: float = NOSE) -> tuple[float, float]:
    """Return the stiffness p with which a half rests at a rise z, m, N/m per m, and H, N/m."""
    diagonal = float(np.hypot(HALF, DEPTH))
    apart = float(np.sqrt(diagonal**2 - rise**2))
    turned = float(np.arctan2(DEPTH, HALF) - np.arcsin(rise / diagonal))
    inwards, closing = WEIGHT * float(np.tan(turned)) * (nose > 0.0), apart - HALF

    def excess(thrust: float) -> float:
        sunk = closing * thrust / (2.0 * thrust + inwards)
        lever = 0.5 * apart - (nose + sunk * (nose > 0.0)) / np.cos(turned) ** 2
        return float((thrust + inwards) * rise - WEIGHT * lever)

    thrust = float(brentq(excess, 1e-3 * WEIGHT, WEIGHT * HALF / rise, xtol=1e-6))
    return (2.0 * thrust + inwards) / closing, thrust


def snapping(nose: float = NOSE) -> tuple[float, float]:
    """Return the p below which no rise is in balance, N/m per m, and the rise there, m."""
    optimum = minimize_scalar(
        lambda rise: np.log(needed(rise, nose)[0]),
        bounds=(0.1 * DEPTH, 0.999 * DEPTH),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return needed(optimum.x, nose)[0], float(optimum.x)


def exact_rest(stiffness: float, nose: float = NOSE) -> tuple[float, float]:
    """Return sag t - z, m, and thrust H, N/m, of the beam at rest."""
    lowest = snapping(nose)[1]
    rise = float(
        brentq(lambda z: needed(z, nose)[0] - stiffness, lowest, DEPTH * (1.0 - 1e-6), xtol=1e-14)
    )
    return DEPTH - rise, needed(rise, nose)[1]


def beam() -> Model:
    """Return the fixed abutment with its nose, the plane of symmetry and a half between them."""
    low, high = -2.0, DEPTH + 1.0
    builder = new_model("Snap-through", gravity=GRAVITY, young=1e13, density=DENSITY, poisson=0.0)
    abutment = [(HALF - NOSE, low), (HALF + 1.0, low), (HALF + 1.0, high), (HALF, high)]
    abutment += [(HALF, -NOSE), (HALF - NOSE, 0.0)]
    builder.block(name="abutment", vertices=abutment, fixed=True)
    plane = box(-1.0, low, 0.0, high)
    builder.block(name="plane of symmetry", vertices=plane, fixed=True)
    builder.block(name="half", vertices=box(0.0, 0.0, HALF, DEPTH))
    builder.measured_point("middle", (0.0, DEPTH), block="half")
    builder.measured_point("end", (HALF, 0.0), block="half")
    return builder.build()


def rest(stiffness: float, variant: Variant) -> tuple[float, float]:
    """Return sag, m, and thrust at the wall, N/m, at the end of a run."""
    model = beam()
    run = variant.static(model, step=STEP, end=400 * STEP, p=stiffness, max_displacement=0.02)
    middle, outer = (run.history(name).displacement[-1, 1] for name in ("middle", "end"))
    memory = run.state.memory
    wall, half = (model.block_name.index(name) for name in ("abutment", "half"))
    here = (memory.block == wall) & (model.vertex_block[memory.vertex] == half)
    return float(outer - middle), float(memory.normal_force[here].sum())


def compare_rest(trial: Trial) -> None:
    """Compare sag and thrust of beams at rest."""
    rests = []
    for stiffness in STIFFNESSES:
        rests.append(rest(stiffness, trial.variant))
        exact, at = exact_rest(stiffness), f"at p = {stiffness:.0e} N/m per m"
        trial.relative(f"sag {at}", "m", rests[-1][0], exact[0], 2e-3, STIFF)
        trial.relative(f"thrust {at}", "N/m", rests[-1][1], exact[1], 1e-3, STIFF)
    lowest = snapping()[0]
    rises = np.linspace(DEPTH - 0.999 * exact_rest(2e9)[0], 0.1, 200)
    chart = trial.chart("stiffness that balances a sag", "sag, m", "p, N/m per m", log="y")
    chart.exact("rigid half on springs", DEPTH - rises, [needed(rise)[0] for rise in rises])
    chart.exact("snap-through", (0.0, 0.4), (lowest, lowest))
    chart.computed([sag for sag, _ in rests], STIFFNESSES)


@problem(set_up=beam, variants=EACH_PROCESS, briefly=compare_rest)
def snap_through(trial: Trial) -> None:
    """Snap-through of a cracked roof beam.

    A beam 10 m long and 0.5 m deep, cracked in the middle, bridges the span between abutments under
    its weight, without friction; a half of it leans on the plane of symmetry. The stiffness p of
    the contacts at which the beam snaps through is bisected. E = 1e13 Pa, h = 20 ms, static
    (dynamic_ratio = 0).

    Exact: e - s = (2 H + W tan a)/p, (H + W tan a) z = W (e/2 - (c + H/p)/cos^2 a), e^2 + z^2 = s^2
    + t^2; snaps through below the least p of them.
    Source: equilibrium of a rigid half on springs, after the voussoir beam of Diederichs & Kaiser
    (1999).
    """
    compare_rest(trial)
    exact = snapping()[0]

    def stands(stiffness: float) -> bool:
        # the beam sags by 0.21 m before it snaps through: one that moves further has failed
        static = StaticRun(p=stiffness, step=STEP, steps=1500, max_displacement=0.3)
        return static.stands(beam(), trial.variant)

    softest = limit(stands, 0.92 * exact, 1.08 * exact, 4)
    trial.relative("p at snap-through", "N/m per m", softest, exact, 0.02, RESOLUTION)
