"""What is out of balance, against sums written link by link."""

import numpy as np
import pytest

from benchmarks.scenes import wall
from clast.compute.reductions import SHARED
from clast.contact.jacobian import rows_of
from scenes.potentials import caught


def wanted(potential, unknowns, normal, shear):
    """Return F - K d + sum of N n + T t (n, 6), 0 where fixed, and r.K^-1 r (n,)."""
    links, base = potential.springs, potential.base
    residual = base.force - np.einsum("nij,nj->ni", base.diagonal, unknowns)
    rows = rows_of(links.arms)
    for row, force in enumerate((normal, normal, shear, shear)):
        block = links.edge_block if row % 2 else links.vertex_block
        np.add.at(residual, block, force[:, None] * rows[:, row])
    residual[potential.fixed] = 0.0
    return residual, np.einsum("ni,nij,nj->n", residual, potential.inverse, residual)


@pytest.mark.parametrize(("courses", "columns"), [(4, 5), (20, 50)])
def test_balance_of_all_blocks_and_of_some_again(courses, columns):
    model = wall(courses, columns)
    assert (model.block_count > SHARED) == (courses > 4)
    one = caught(model, 5e9, 1e-3, 1e-3)[0]
    rng = np.random.default_rng(courses)
    point = one.at(1e-6 * rng.normal(size=(model.block_count, 6)) * ~model.fixed[:, None])
    forces = point.forces.normal_force, point.forces.shear_force
    residual, distances = wanted(one, point.unknowns, *forces)
    assert point.residual == pytest.approx(residual, rel=1e-9, abs=1e-9 * np.abs(residual).max())
    assert point.distances == pytest.approx(distances, rel=1e-7, abs=1e-9 * distances.max())

    for share in (0.1, 1.0):
        changed = np.flatnonzero(rng.random(model.block_count) < share)
        before = point.residual.copy(), point.distances.copy()
        point.residual[changed] = point.distances[changed] = np.nan
        one.balance_again(changed, point)
        assert np.array_equal(point.residual, before[0])
        assert np.array_equal(point.distances, before[1])
