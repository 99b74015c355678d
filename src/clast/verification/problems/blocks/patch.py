"""Patch test: a uniform stress from all sides gives the exact affine displacement."""

import numpy as np

from clast.verification.fixtures import new_model
from clast.verification.problems import (
    Floats,
    Model,
    Plane,
    PlaneStrain,
    PlaneStress,
    Trial,
    problem,
)
from clast.verification.variants import CONVEX, EULER, LAGGED, MULTIPLIERS, OPEN_CLOSE, Variant

YOUNG, POISSON = 5e9, 0.25
STRESS = np.array([3e3, -5e3, 2e3])
"""Stress (xx, yy, xy) applied, Pa."""
CORNERS = np.array([(0.0, 0.0), (2.0, 0.3), (2.4, 1.6), (1.1, 2.2), (-0.3, 1.2)])
PLANES: tuple[Plane, ...] = (PlaneStress(), PlaneStrain())
STRAINED = "the traction acts on the strained outline: of the size of the strain, 1e-6"


def loaded_block(plane: Plane = PLANES[0]) -> Model:
    """Return a free pentagon with the traction of a uniform stress on every edge."""
    builder = new_model("Patch test", plane=plane, young=YOUNG, density=2700.0, poisson=POISSON)
    builder.block(name="block", vertices=CORNERS)
    tensor = np.array([[STRESS[0], STRESS[2]], [STRESS[2], STRESS[1]]])
    for k, (start, end) in enumerate(zip(CORNERS, np.roll(CORNERS, -1, axis=0), strict=True)):
        along = (end - start) / np.hypot(*(end - start))
        builder.line_load(start, end, tensor @ (along[1], -along[0]))
        builder.measured_point(f"corner {k}", start)
    return builder.build()


def strain(plane: Plane) -> Floats:
    """Return the strain (xx, yy, engineering xy) under the stress, from Hooke's law in space."""
    xx, yy, xy = STRESS
    zz = POISSON * (xx + yy) if plane.name == "strain" else 0.0
    return np.array(
        [
            (xx - POISSON * (yy + zz)) / YOUNG,
            (yy - POISSON * (xx + zz)) / YOUNG,
            2.0 * (1.0 + POISSON) * xy / YOUNG,
        ]
    )


def loaded(plane: Plane, variant: Variant) -> tuple[Floats, Floats]:
    """Return stress (3,), Pa, and displacement of the corners, m (k, 2)."""
    run = variant.static(loaded_block(plane), step=1e-2, end=1.0, p=1e9, max_displacement=0.05)
    moved = np.array([run.history(f"corner {k}").displacement[-1] for k in range(len(CORNERS))])
    return run.state.stress[0], without_rigid_motion(moved)


def without_rigid_motion(moved: Floats) -> Floats:
    """Return displacements (k, 2) of the corners less the rigid motion that a free block has."""
    x, y = (CORNERS - CORNERS.mean(axis=0)).T
    u, v = (moved - moved.mean(axis=0)).T
    turn = np.sum(x * v - y * u) / np.sum(x**2 + y**2)
    return np.stack([u + turn * y, v - turn * x], axis=1)


@problem(
    set_up=loaded_block, variants=(LAGGED, EULER, CONVEX, OPEN_CLOSE, MULTIPLIERS), quick=(LAGGED,)
)
def patch(trial: Trial) -> None:
    """Patch test.

    Tractions of a uniform stress (3, -5, 2) kPa act on all edges of a free pentagon; E = 5 GPa, nu
    = 0.25, static (dynamic_ratio = 0).

    Exact: stress = applied stress, displacement = strain . (x - xc), strain by Hooke's law with
    sigma_zz = 0 or eps_zz = 0.
    Source: Hooke's law.
    """
    pairs = []
    for plane in PLANES:
        stress, moved = loaded(plane, trial.variant)
        exx, eyy, gxy = strain(plane)
        exact = without_rigid_motion(CORNERS @ np.array([[exx, 0.5 * gxy], [0.5 * gxy, eyy]]))
        case = f"plane {plane.name}"
        for name, value, applied in zip(("xx", "yy", "xy"), stress, STRESS, strict=True):
            trial.relative(f"stress {name}, {case}", "Pa", value, applied, 1e-5, STRAINED)
        worst = np.unravel_index(np.abs(moved - exact).argmax(), exact.shape)
        quantity = f"displacement of the worst corner, {case}"
        trial.relative(quantity, "m", moved[worst], exact[worst], 1e-5, STRAINED)
        pairs.append(1e6 * np.stack([exact.ravel(), moved.ravel()]))
    corners = np.concatenate(pairs, axis=1)
    limit = 1.1 * np.abs(corners[0]).max()
    chart = trial.chart("displacement of the corners", "affine field, µm", "computed, µm")
    chart.exact("equal", (-limit, limit), (-limit, limit))
    chart.computed(*corners)
