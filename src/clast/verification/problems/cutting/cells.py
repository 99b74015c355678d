"""Cells about random points: Voronoi's tessellation of a Poisson process."""

import numpy as np

from clast.rockmass import JointSet, Voronoi, cut
from clast.verification.fixtures import CUT, areas, drawing_of, rectangle
from clast.verification.problems import Floats, Model, Trial, problem

SIDE = 10.0
"""Side of the square, m."""
CORNERS = 6.0
"""Corners of a cell on average."""
VARIATION = float(np.sqrt(1.280176 - 1.0))
"""Deviation of the areas over their mean."""
COUNTS = (320, 640, 1250, 2500, 5000)
"""Numbers of cells; the last is compared."""
FEW = (320, 1250)
"""Where time is short."""
SHARE = 0.03
"""Tolerance with 5,000 cells."""


def cells(count: int, seed: int = 3) -> tuple[float, float, float]:
    """Return mean area, m2, mean number of corners and variation of areas of so many cells.

    The mean area is that of all cells, the others those of cells that do not touch the rim.
    """
    network = [JointSet(name="cells", model=Voronoi(count=count))]
    rock_mass = cut(rectangle(SIDE, SIDE, smallest_block=0.0), network, seed=seed)
    low = np.minimum.reduceat(rock_mass.vertices, rock_mass.block_start[:-1], axis=0)
    high = np.maximum.reduceat(rock_mass.vertices, rock_mass.block_start[:-1], axis=0)
    inner = ((low > 1e-6) & (high < SIDE - 1e-6)).all(axis=1)
    sizes = areas(rock_mass)
    corners = np.diff(rock_mass.block_start)[inner]
    variation = sizes[inner].std() / sizes[inner].mean()
    return float(sizes.mean()), float(corners.mean()), float(variation)


def allowed(count: Floats | int) -> Floats:
    """Return the tolerance of so many cells, as a share."""
    return np.asarray(SHARE * np.sqrt(COUNTS[-1] / np.asarray(count)))


def _drawing() -> Model:
    network = [JointSet(name="cells", model=Voronoi(count=250))]
    return drawing_of(cut(rectangle(SIDE, SIDE), network, seed=3), "Voronoi cells")


@problem(set_up=_drawing, variants=(CUT,), quick=(CUT,), few=(FEW,))
def voronoi_cells(trial: Trial, counts: tuple[int, ...] = COUNTS) -> None:
    """Cells about random points.

    A square of 10 m x 10 m is cut into Voronoi cells about up to 5,000 random points (250 in the
    picture); small cells are kept.

    Exact: mean area A/n; six corners; coefficient of variation of the areas sqrt(0.280) = 0.529.
    Source: Euler's formula; Gilbert (1962), Ann. Math. Statist. 33, for the variance.
    """
    computed = [cells(count) for count in counts]
    area, corners, variation = computed[-1]
    count = counts[-1]
    tolerance = float(allowed(count))
    reason = f"scatter of {count} cells: about twice the standard error of the variation"
    of = f"of {count} cells"
    trial.relative(f"mean area {of}", "m2", area, SIDE**2 / count, 1e-12, "none is lost or merged")
    trial.relative(f"mean number of corners {of}", "", corners, CORNERS, tolerance, reason)
    quantity = f"coefficient of variation of the areas {of}"
    trial.relative(quantity, "", variation, VARIATION, tolerance, reason)
    fine = np.geomspace(0.8 * counts[0], 1.25 * counts[-1], 40)
    chart = trial.chart("variation of the areas", "number of cells", "deviation over mean", log="x")
    chart.exact("Poisson-Voronoi cells, 0.529", fine, np.full(len(fine), VARIATION))
    chart.exact("upper end of the tolerance", fine, VARIATION * (1.0 + allowed(fine)))
    chart.exact("lower end of the tolerance", fine, VARIATION * (1.0 - allowed(fine)))
    chart.computed(counts, [one[2] for one in computed])
