"""A dam of blocks with a free surface inside: Dupuit's discharge, whatever the grid."""

import numpy as np

from clast.actions.flow import water_at
from clast.rockmass import JointSet, cut
from clast.verification.fixtures import CUT, cut_rock, into_rock, rectangle
from clast.verification.problems import Model, Trial, problem

LENGTH, HEIGHT, UPPER, LOWER = 20.0, 10.0, 8.0, 2.0
"""Length and height of the dam, and both levels, m."""
APERTURE, VISCOSITY, GRAVITY = 2e-4, 1e-3, 9.81
GRIDS = ((8, 10), (20, 20))
"""Joints along and across."""


def dam(grid: tuple[int, int] = (20, 20)) -> Model:
    """Return a dam cut by level and upright joints, on a tight base, between two levels."""
    across, along = LENGTH / grid[0], HEIGHT / grid[1]
    sets = [
        JointSet(name="level", angle=0.0, spacing=along, origin=(0.0, 0.5 * along)),
        JointSet(name="upright", angle=90.0, spacing=across, origin=(0.5 * across, 0.0)),
    ]
    builder = cut_rock("Dam", cut(rectangle(LENGTH, HEIGHT), sets), aperture=APERTURE)
    builder.flow = {"viscosity": VISCOSITY}
    builder.flow_boundary("upstream", side="left", head=UPPER, seepage_above=False)
    builder.flow_boundary("downstream", side="right", head=LOWER)
    return builder.build()


def exact_discharge(grid: tuple[int, int]) -> float:
    """Return K (h1^2 - h2^2)/2L, m2/s, with K = rho g a^3/(12 mu s)."""
    conductivity = 1000.0 * GRAVITY * APERTURE**3 / (12.0 * VISCOSITY) * grid[1] / HEIGHT
    return conductivity * (UPPER**2 - LOWER**2) / (2.0 * LENGTH)


@problem(set_up=dam, variants=(CUT,), quick=(CUT,))
def flow_dam(trial: Trial) -> None:
    """Dam with a free surface.

    A dam of blocks, 20 m long, between levels of 8 m and 2 m, on a tight base. Water seeps out of
    its downstream face above the lower level. Level and upright joints, two grids.

    Exact: Q = K (h1^2 - h2^2)/2L, at every fineness of a level grid.
    Source: Dupuit's discharge, which is exact for a dam with a free surface (Charny 1951).
    Not run with: modified and open-close and convex: nothing moves.
    """
    for grid in GRIDS:
        discharge = into_rock(dam(grid))["upstream"]
        quantity = f"discharge, {grid[0]} x {grid[1]} joints"
        reason = "corners of cut blocks are rounded"
        trial.relative(quantity, "m2/s", discharge, exact_discharge(grid), 1e-6, reason)
    water = water_at(dam(GRIDS[-1]), 0.0)
    x, y = water.network.at.T
    low = np.abs(y - y.min()) < 0.5 * HEIGHT / GRIDS[-1][1]
    order = np.argsort(x[low])
    head = water.solved.pressure[low][order] / (1000.0 * GRAVITY) + y[low][order]
    fine = np.linspace(0.0, LENGTH, 81)
    chart = trial.chart("head along the base", "distance from upstream, m", "head, m")
    surface = np.sqrt(UPPER**2 - (UPPER**2 - LOWER**2) * fine / LENGTH)
    chart.exact("Dupuit's parabola, which has no seepage face", fine, surface)
    chart.computed(x[low][order], head)
