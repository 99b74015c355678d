"""Block LDL^T of matrices whose blocks are definite with either sign, against dense solves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clast.linear import quasi_definite
from clast.linear.pattern import exact_pattern
from scenes.block_matrices import PATTERNS, dense, random_system


def mixed(name: str, seed: int):
    """Return a system with some blocks negative, and the signs of all."""
    rng = np.random.default_rng(seed)
    count, pairs = PATTERNS[name]
    one = random_system(rng, count, pairs)
    signs = rng.choice([-1.0, 1.0], count)
    same = signs[pairs[:, 0]] == signs[pairs[:, 1]]
    # between blocks of either sign a matrix may have anything
    sign = np.where(same, signs[pairs[:, 0]], 1.0)
    diagonal = one.diagonal * signs[:, None, None]
    return replace(one, diagonal=diagonal, upper=one.upper * sign[:, None, None]), signs


@pytest.mark.parametrize("name", PATTERNS)
@pytest.mark.parametrize("seed", range(3))
def test_the_solution_is_that_of_the_whole_matrix(name, seed):
    one, signs = mixed(name, seed)
    factor, bad = quasi_definite.factor(exact_pattern(one), one.diagonal, one.upper, signs)
    assert bad == -1
    known = np.linalg.solve(dense(one), one.force.ravel()).reshape(-1, 6)
    found = quasi_definite.solve(factor, one.force)
    assert found == pytest.approx(known, abs=1e-6 * np.abs(known).max())


def test_a_block_of_the_other_sign_is_told():
    one, signs = mixed("grid" if "grid" in PATTERNS else next(iter(PATTERNS)), 1)
    wrong = signs.copy()
    wrong[0] = -wrong[0]
    _, bad = quasi_definite.factor(exact_pattern(one), one.diagonal, one.upper, wrong)
    assert bad >= 0
