"""Water at rest under a level: no flow, and the same forces as [[water]] has."""

import numpy as np

from clast.actions.flow import pressed_channels, water_at
from clast.actions.water import Pressed, pressed_by, sums_on_blocks
from clast.block import polygon
from clast.rockmass import JointSet, cut
from clast.verification.fixtures import CUT, cut_rock, rectangle
from clast.verification.problems import Floats, InputBuilder, Model, Trial, problem

LEVEL, SIDE, GRAVITY, APERTURE = 7.3, 10.0, 9.81, 2e-4


def rock() -> InputBuilder:
    """Return rock cut at odd angles."""
    sets = [
        JointSet(name="a", angle=33.0, spacing=1.1, origin=(0.3, 0.4)),
        JointSet(name="b", angle=100.0, spacing=0.9, origin=(0.2, 0.1)),
    ]
    domain = rectangle(SIDE, SIDE)
    return cut_rock("Water at rest", cut(domain, sets), aperture=APERTURE)


def flowing() -> Model:
    """Return the rock between two heads of one height."""
    builder = rock()
    builder.flow = {}
    for side in ("left", "right"):
        builder.flow_boundary(side, side=side, head=LEVEL)
    return builder.build()


def under_level() -> Model:
    """Return the rock with water under a level in its joints."""
    builder = rock()
    builder.water(LEVEL, acts_on="joints")
    return builder.build()


def forces(model: Model, pressed: Pressed) -> Floats:
    """Return the generalised forces of pressures on the blocks, shape (n, 6)."""
    centroid = polygon.moments(model.vertices, model.block_start)[1]
    block, force = sums_on_blocks([pressed], centroid)
    every = np.zeros((model.block_count, 6))
    every[block] = force
    return every


@problem(set_up=flowing, variants=(CUT,), quick=(CUT,))
def flow_rest(trial: Trial) -> None:
    """Water at rest in joints.

    A square of 10 m, cut at 33 and 100 degrees, between two heads of 7.3 m: from dry joints, the
    flow is found, and its forces on blocks are compared with those of water under a level. Sizes
    are by the largest force, and by what the head would drive through the best channel.

    Exact: q = 0; p = rho g (7.3 m - y).
    Source: hydrostatics; [[water]] with the same level.
    Not run with: modified and open-close and convex: nothing moves.
    """
    model, level = flowing(), under_level()
    water = water_at(model, 0.0)
    known = forces(level, pressed_by(level.water[0], level, level.vertices, 0.0))
    found = forces(model, pressed_channels(water, model, model.vertices))
    driven = float(water.conductance.max()) * 1000.0 * GRAVITY * LEVEL
    largest = float(np.abs(water.solved.flow).max()) / driven
    missed = float(np.abs(found - known).max() / np.abs(known).max())
    trial.absolute("largest flow", "-", largest, 0.0, 1e-12, "rounding of pressures")
    trial.absolute("error of forces", "-", missed, 0.0, 1e-9, "rounding of pressures")
    height = water.network.at[:, 1] + model.origin[1]
    fine = np.array([0.0, LEVEL, SIDE])
    chart = trial.chart("pressure at nodes", "height y, m", "pressure, Pa")
    chart.exact("ρ g (7.3 m - y)", fine, 1000.0 * GRAVITY * np.maximum(LEVEL - fine, 0.0))
    chart.computed(height, water.solved.pressure)
