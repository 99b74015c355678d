"""Dams of blocks with a free surface inside: discharge on level and turned grids, and pressures."""

import numpy as np

from clast.actions.flow import water_at
from clast.rockmass import JointSet, cut
from clast.verification.fixtures import CUT, cut_rock, into_rock, rectangle
from clast.verification.problems import Floats, Model, Trial, problem

LENGTH, HEIGHT, UPPER, LOWER = 20.0, 10.0, 8.0, 2.0
"""Length and height of the dam, and both levels, m."""
APERTURE, VISCOSITY, WEIGHT = 2e-4, 1e-3, 9810.0
GRIDS = ((8, 10), (20, 20))
"""Joints along and across."""
HIGH, WIDE, FULL, TAIL = 24.0, 16.0, 24.0, 4.0
"""Height and width of a higher dam, and its levels, m."""
FINENESS = (12, 24, 48, 96)
"""Joints in the height of the higher dam."""
TURNED = 30.0
"""Angle of its joints, degrees."""


def cut_dam(
    size: tuple[float, float],
    levels: tuple[float, float],
    spacings: tuple[float, float],
    angle: float = 0.0,
) -> Model:
    """Return a dam between two levels, on a tight base, cut by two sets of joints, m, degrees."""
    along, across = spacings
    sets = [
        JointSet(name="level", angle=angle, spacing=along, origin=(0.0, 0.5 * along)),
        JointSet(name="upright", angle=angle + 90.0, spacing=across, origin=(0.5 * across, 0.0)),
    ]
    domain = rectangle(*size, smallest_block=0.0, smallest_edge=0.0)
    builder = cut_rock("Dam", cut(domain, sets), aperture=APERTURE)
    builder.flow = {"viscosity": VISCOSITY}
    builder.flow_boundary("upstream", side="left", head=levels[0], seepage_above=False)
    builder.flow_boundary("downstream", side="right", head=levels[1])
    return builder.build()


def dam(grid: tuple[int, int] = (20, 20)) -> Model:
    """Return the dam, cut by level and upright joints."""
    spacings = HEIGHT / grid[1], LENGTH / grid[0]
    return cut_dam((LENGTH, HEIGHT), (UPPER, LOWER), spacings)


def high_dam(joints: int = 24, angle: float = TURNED) -> Model:
    """Return the higher dam with so many joints in its height, at an angle, degrees."""
    return cut_dam((WIDE, HIGH), (FULL, TAIL), (HIGH / joints, HIGH / joints), angle)


def discharge(levels: tuple[float, float], length: float, spacing: float) -> float:
    """Return K (h1^2 - h2^2)/2L, m2/s, with K = rho g a^3/(12 mu s) of joints ``spacing`` apart."""
    conductivity = WEIGHT * APERTURE**3 / (12.0 * VISCOSITY * spacing)
    return conductivity * (levels[0] ** 2 - levels[1] ** 2) / (2.0 * length)


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
        flow = into_rock(dam(grid))["upstream"]
        quantity = f"discharge, {grid[0]} x {grid[1]} joints"
        exact = discharge((UPPER, LOWER), LENGTH, HEIGHT / grid[1])
        trial.relative(quantity, "m2/s", flow, exact, 1e-6, "corners of cut blocks are rounded")
    water = water_at(dam(GRIDS[-1]), 0.0)
    x, y = water.network.at.T
    low = np.abs(y - y.min()) < 0.5 * HEIGHT / GRIDS[-1][1]
    order = np.argsort(x[low])
    head = water.solved.pressure[low][order] / WEIGHT + y[low][order]
    fine = np.linspace(0.0, LENGTH, 81)
    chart = trial.chart("head along the base", "distance from upstream, m", "head, m")
    surface = np.sqrt(UPPER**2 - (UPPER**2 - LOWER**2) * fine / LENGTH)
    chart.exact("Dupuit's parabola, which has no seepage face", fine, surface)
    chart.computed(x[low][order], head)


@problem(set_up=high_dam, variants=(CUT,), quick=(CUT,), cases=(FINENESS,), few=(FINENESS[:2],))
def flow_dam_turned(trial: Trial, fineness: tuple[int, ...] = FINENESS) -> None:
    """Dam with a free surface, cut at an angle.

    A dam of blocks, 24 m high and 16 m wide, between levels of 24 m and 4 m, cut by two sets of
    joints at right angles, turned by 30 degrees, one finer than the other.

    Exact: Q = K (h1^2 - h2^2)/2L, for joints that are close together.
    Source: as flow-dam; two sets at right angles conduct alike in all directions (Snow 1969).
    Not run with: modified and open-close and convex: nothing moves.
    """
    reason = (
        "where the free surface crosses it a joint conducts below the surface alone: of first "
        "order in the distance of joints"
    )
    missed = []
    for joints in fineness:
        exact = discharge((FULL, TAIL), WIDE, HIGH / joints)
        flow = into_rock(high_dam(joints))["upstream"]
        quantity, tolerance = f"discharge, {joints} joints in its height", 0.9 / joints
        trial.relative(quantity, "m2/s", flow, exact, tolerance, reason)
        missed.append(1.0 - flow / exact)
    order = float(np.log2(missed[-2] / missed[-1]))
    trial.absolute("order in the distance of joints", "-", order, 1.0, 0.2, "coarse grids")
    fine = np.array([fineness[0], fineness[-1]])
    chart = trial.chart("missing discharge", "joints in the height", "share", log="xy")
    chart.exact("first order", fine, missed[-1] * fineness[-1] / fine)
    chart.computed(fineness, missed)


def obstacle(cells: int) -> tuple[Floats, Floats, Floats]:
    """Return x and y, m, and p/(rho g), m, of the higher dam on a grid of so many cells in height.

    w(x, y), the integral of p/(rho g) over the height above, is the smallest w >= 0 with
    lap w <= 1.  Where w is 0, the water ends: an active set, from no such place on.
    """
    from scipy.sparse import diags_array, eye_array, kron
    from scipy.sparse.linalg import spsolve

    size = HIGH / cells
    x, y = np.arange(0.0, WIDE + 0.5 * size, size), np.arange(0.0, HIGH + 0.5 * size, size)
    w = np.zeros((len(x), len(y)))
    w[0], w[-1] = 0.5 * np.maximum(FULL - y, 0.0) ** 2, 0.5 * np.maximum(TAIL - y, 0.0) ** 2
    w[:, 0] = np.interp(x, [0.0, WIDE], [w[0, 0], w[-1, 0]])
    second = [
        diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n - 2, n - 2)) for n in w.shape
    ]
    matrix = kron(second[0], eye_array(len(y) - 2)) + kron(eye_array(len(x) - 2), second[1])
    matrix = matrix.tocsr()
    around = w[:-2, 1:-1] + w[2:, 1:-1] + w[1:-1, :-2] + w[1:-1, 2:]
    right = around.ravel() - size**2
    inner, dry = np.zeros(len(right)), np.zeros(len(right), np.bool_)
    while True:
        wet = np.flatnonzero(~dry)
        inner[:] = 0.0
        inner[wet] = spsolve(matrix[wet][:, wet].tocsc(), right[wet])
        before, dry = dry, np.where(dry, matrix @ inner > right, inner < 0.0)
        if (dry == before).all():
            break
    w[1:-1, 1:-1] = inner.reshape(len(x) - 2, len(y) - 2)
    return x, y, -np.asarray(np.gradient(w, size, axis=1, edge_order=2))


@problem(set_up=lambda: high_dam(angle=0.0), variants=(CUT,), quick=(CUT,))
def flow_surface(trial: Trial) -> None:
    """Pressures in a dam with a free surface.

    The dam of flow-dam-turned, 24 m high, with 24 level and 16 upright joints; pressures at all
    crossings, against another solution on a grid that is five times finer.

    Exact: w >= 0, lap w <= 1, w (lap w - 1) = 0 with p = -rho g dw/dy.
    Source: Baiocchi's obstacle problem of a dam (Baiocchi 1972), by finite differences.
    Not run with: modified and open-close and convex: nothing moves.
    """
    from scipy.interpolate import RegularGridInterpolator

    model = high_dam(angle=0.0)
    water = water_at(model, 0.0)
    at = np.clip(water.network.at + model.origin, 0.0, [WIDE, HIGH])
    head = water.solved.pressure / WEIGHT
    x, y, exact = obstacle(120)
    known = RegularGridInterpolator((x, y), exact)
    missed = float(np.sqrt(np.mean((head - known(at)) ** 2)))
    reason = "joints 1 m apart; of second order in their distance"
    trial.absolute("error of pressures, rms", "m", missed, 0.0, 0.015, reason)
    chart = trial.chart("pressure along upright joints", "height y, m", "p/(ρ g), m")
    for place in (0.5, 8.5, 14.5):
        joint = np.flatnonzero(np.abs(at[:, 0] - place) < 1e-3)
        joint = joint[np.argsort(at[joint, 1])]
        fine = np.stack([np.full(97, place), np.linspace(0.0, HIGH, 97)], axis=1)
        chart.exact(f"x = {place:g} m", fine[:, 1], known(fine))
        chart.computed(at[joint, 1], head[joint], label=f"joint at x = {place:g} m")
