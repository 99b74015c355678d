"""A well in rock with joints at right angles: a Lugeon test, and pumping that takes time."""

import numpy as np

from clast.actions.flow import water_at
from clast.rockmass import JointSet, cut
from clast.rockmass.domain import Domain
from clast.verification.fixtures import CUT, box, cut_rock, into_rock
from clast.verification.problems import Floats, InputBuilder, Model, Trial, problem
from clast.verification.variants import CONVEX

APERTURE, VISCOSITY, BULK = 2e-4, 1e-3, 2e9
EULER = 0.5772156649015329
TEST = 1e6
"""Pressure of a Lugeon test, Pa."""
HALF, FINE = 10.0, 0.5
"""Half the side of the rock that is tested, and the distance of its joints, m."""
FAR, SPACINGS, STEPS = 20.0, (1.0, 0.5), 40
"""Half the side of the rock that is pumped, and the distances of its joints, m; steps."""
RATE = 1e-5
"""What is pumped, m2/s."""
ROUNDED = "sums of what is stored are those of differences"
DIFFUSIVITY = APERTURE**2 * BULK / (24.0 * VISCOSITY)
"""D of a grid of joints, m2/s: half of that of a joint, for half of its water is in each set."""
DURATION = 0.03 * FAR**2 / DIFFUSIVITY
"""Time of the comparison, s."""


def conducts(spacing: float) -> float:
    """Return a^3/(12 mu s), the mean flux by the fall of pressure by length, m3 s/kg."""
    return APERTURE**3 / (12.0 * VISCOSITY * spacing)


def rock(half: float, spacing: float) -> InputBuilder:
    """Return a square of rock, cut by level and upright joints that meet in its middle."""
    middle = (0.0, 0.0)
    sets = [
        JointSet(name=f"set {k}", angle=90.0 * k, spacing=spacing, origin=middle) for k in (0, 1)
    ]
    sides = half - 0.5 * spacing
    domain = Domain(boundary=box(-sides, -sides, sides, sides))
    return cut_rock("Well", cut(domain, sets), aperture=APERTURE, gravity=0.0)


def tested() -> Model:
    """Return the rock of the Lugeon test, with Thiem's pressures on its outline."""
    builder = rock(HALF, FINE)
    builder.flow = {"viscosity": VISCOSITY}
    ends = builder.build().flow
    assert ends is not None and ends.network is not None
    for at in ends.network.at[ends.network.outer]:
        line = [at - 1e-4, at + 1e-4]
        pressure = float(exact_pressure(np.hypot(*at)))
        builder.flow_boundary(edges=[line], pressure=pressure)
    builder.well("test", (0.0, 0.0), pressure=TEST)
    return builder.build()


RADIUS = FINE * np.exp(-EULER) / (2.0 * np.sqrt(2.0))
"""Radius at which the pressure of a crossing is that of a homogeneous rock, 0.198 s, m."""


def exact_pressure(distance: Floats) -> Floats:
    """Return Thiem's pressure at distances, m, from a well, Pa: 0 at HALF."""
    return np.asarray(TEST * np.log(HALF / distance) / np.log(HALF / RADIUS))


@problem(set_up=tested, variants=(CUT,), quick=(CUT,))
def flow_lugeon(trial: Trial) -> None:
    """Water test in a borehole.

    At a crossing of two sets of joints 0.5 m apart water is pressed into the rock by 1 MPa, as in a
    Lugeon test. On the outline of a square of 20 m are the pressures of Thiem. Compared are the
    flow, and pressures from 2 m off.

    Exact: Q = 2 pi k p/ln(R/r), k = a^3/(12 mu s), r = s exp(-0.5772)/(2 sqrt 2).
    Source: Thiem (1906); the radius of a crossing of a square grid, by Peaceman (1978).
    Not run with: modified and open-close and convex: nothing moves.
    """
    model = tested()
    exact = 2.0 * np.pi * conducts(FINE) * TEST / float(np.log(HALF / RADIUS))
    reason = "joints 0.5 m apart; of second order in their distance"
    flow = into_rock(model)["test"]
    trial.relative("flow into the rock", "m2/s", flow, exact, 2e-3, reason)
    water = water_at(model, 0.0)
    off = np.hypot(*(water.network.at + model.origin).T)
    some = off >= 2.0
    missed = np.abs(water.solved.pressure - exact_pressure(np.maximum(off, RADIUS)))[some].max()
    trial.absolute("largest error of pressures over p", "-", missed / TEST, 0.0, 5e-3, reason)
    fine = np.geomspace(RADIUS, HALF, 61)
    chart = trial.chart("pressure about the borehole", "distance, m", "pressure, MPa", log="x")
    chart.exact("Thiem", fine, 1e-6 * exact_pressure(fine))
    level = np.abs(water.network.at[:, 1] + model.origin[1]) < 1e-6
    chart.computed(off[level & some], 1e-6 * water.solved.pressure[level & some])


def pumped(spacing: float = SPACINGS[0]) -> Model:
    """Return the rock from which water is pumped, with no pressure at first and on its outline."""
    builder = rock(FAR, spacing)
    given = {"state": "transient", "initial": "dry", "viscosity": VISCOSITY, "bulk_modulus": BULK}
    builder.flow = given
    for side in ("left", "right", "bottom", "top"):
        builder.flow_boundary(side, side=side, pressure=0.0)
    builder.well("pump", (0.0, 0.0), rate=-RATE)
    return builder.build()


def exact_fall(distance: Floats, spacing: float) -> Floats:
    """Return Theis' fall of pressure at distances, m, at the time of the comparison, Pa."""
    from scipy.special import exp1

    size = RATE / (4.0 * np.pi * conducts(spacing))
    return np.asarray(size * exp1(distance**2 / (4.0 * DIFFUSIVITY * DURATION)))


@problem(set_up=pumped, variants=(CONVEX,), cases=(SPACINGS,), few=(SPACINGS[:1],))
def flow_theis(trial: Trial, spacings: tuple[float, ...] = SPACINGS) -> None:
    """Pumping from a well.

    From a crossing of two sets of joints, 1 m and 0.5 m apart, 0.01 litres a second are pumped, in
    40 steps. Joints are full, and water is compressed; the outline of the square of 40 m is too far
    off to matter. Compared is the fall of pressure from 3 m off, by the largest of them.

    Exact: p = Q/(4 pi k) E1(r^2/4 D t), k = a^3/(12 mu s), D = a^2 K/(24 mu).
    Source: Theis (1935).
    Not run with: modified and open-close: nothing moves.
    """
    fine = np.geomspace(0.5, 12.0, 61)
    chart = trial.chart("fall of pressure about the well", "distance, m", "p/p(3 m)", log="x")
    size = float(exact_fall(np.array(3.0), 1.0))
    chart.exact("Theis", fine, exact_fall(fine, 1.0) / size)
    for spacing in spacings:
        model, step = pumped(spacing), DURATION / STEPS
        run = trial.variant.run(model, step=step, end=DURATION, p=1e9, max_displacement=0.1)
        flow = run.flow()
        off, fall = np.hypot(*flow.start.T), -flow.pressure[:, 0]
        some = np.flatnonzero((off >= 3.0) & (off < 12.0))
        exact = exact_fall(off[some], spacing)
        missed = float(np.abs(fall[some] - exact).max() / exact.max())
        quantity = f"largest error by the largest fall, {spacing:g} m apart"
        reason = "first order in time, second in the distance of joints"
        trial.absolute(quantity, "-", missed, 0.0, 0.01 + 0.02 * spacing, reason)
        unaccounted = np.abs(run.table("flow", "all joints")["unaccounted"]).max()
        quantity = f"unaccounted water by what is pumped, {spacing:g} m apart"
        trial.absolute(quantity, "-", float(unaccounted / RATE), 0.0, 1e-12, ROUNDED)
        level = some[np.abs(flow.start[some, 1]) < 1e-6]
        shown = fall[level] / (size * spacing)
        label = f"joints {spacing:g} m apart"
        chart.computed(np.abs(flow.start[level, 0]), shown, label=label)
