"""Small things that threads share, against numpy."""

import numpy as np
import pytest

from clast.compute import reductions as shares
from clast.linear import assembly


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 5, 1023])
def test_a_sum_leaves_nothing_out(count):
    values = np.random.default_rng(2).integers(-1000, 1000, count).astype(float)
    assert shares.sum_of(values) == values.sum()


def test_arrays_are_alike_to_the_last_number():
    one = np.arange(5.0)
    assert shares.alike(one, one.copy())
    assert shares.alike(one[:0], one[:0])
    assert not shares.alike(one, one[:4])
    assert not shares.alike(one, np.array([0.0, 1.0, 2.0, 3.0, 5.0]))


@pytest.mark.parametrize("count", [0, 3, 900, 3000])
def test_a_form_is_the_sum_over_the_blocks(count):
    rng = np.random.default_rng(3)
    d, symmetric = rng.normal(size=(count, 6)), rng.normal(size=(count, 6, 6))
    symmetric += symmetric.transpose(0, 2, 1)
    wanted = np.einsum("ia,iac,ic->", d, symmetric, d)
    assert assembly.form(symmetric, d) == pytest.approx(wanted, rel=1e-10, abs=1e-9)
