"""What forces amount to, and blocks taken from others, whether threads share the work or not."""

import numpy as np
import pytest

from clast.compute.chunks import MANY, SHARED
from clast.contact.laws import limits_of_springs
from clast.linear import block_matrix as block_rows
from clast.minimise import reference_energy as yardsticks


@pytest.mark.parametrize("count", [1, 40, SHARED + 30])
def test_forces(count):
    rng = np.random.default_rng(count)
    force, momentum = rng.normal(size=(2, count, 6))
    matrix = rng.normal(size=(count, 6, 6))
    inverse = matrix @ matrix.transpose(0, 2, 1)
    fixed = rng.random(count) < 0.3
    found = yardsticks.of_forces(inverse, force, momentum, fixed)

    def half(one):
        one = np.where(fixed[:, None], 0.0, one)
        return 0.5 * np.einsum("ni,nij,nj->", one, inverse, one)

    largest = np.hypot(*force[~fixed, :2].T).sum()
    assert found == pytest.approx((half(force - momentum), half(momentum), largest), rel=1e-12)


@pytest.mark.parametrize("count", [0, 5, SHARED + 30])
def test_blocks_taken(count):
    rng = np.random.default_rng(count)
    blocks = rng.normal(size=(2 * SHARED, 6, 6))
    which = rng.integers(0, len(blocks), count)
    assert np.array_equal(block_rows.taken(blocks, which), blocks[which])


class Joints:
    """Contacts as far as the bounds of their forces go."""

    def __init__(self, count):
        rng = np.random.default_rng(count)
        self.friction, self.cohesion, self.tensile_strength, self.length = rng.random((4, count))
        self.friction_base = rng.normal(size=count)


@pytest.mark.parametrize("count", [1, MANY + 10])
def test_bounds_of_forces(count):
    joints = Joints(count)
    joints.friction_base[0] = np.nan
    limits = limits_of_springs(joints, 1e9, None)
    strength = joints.friction_base * joints.friction + joints.cohesion * joints.length
    assert np.array_equal(limits.strength, np.maximum(0.0, strength), equal_nan=True)
    assert np.array_equal(limits.tension, joints.tensile_strength * joints.length)
    assert limits.shear_stiffness == limits.normal_stiffness == 1e9
