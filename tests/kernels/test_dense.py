"""The inverse of the coarsest level, and small things that threads share, against numpy."""

import numpy as np
import pytest

from clast.kernels import assembly, dense, shares


def matrix_of(diagonal, pairs, upper):
    """Return the symmetric matrix in full."""
    count = len(diagonal)
    matrix = np.zeros((count, 6, count, 6))
    for i, block in enumerate(diagonal):
        matrix[i, :, i] = block
    for (i, j), block in zip(pairs, upper, strict=True):
        matrix[i, :, j], matrix[j, :, i] = block, block.T
    return matrix.reshape(6 * count, 6 * count)


def blocks(count, seed=0):
    """Return a positive definite matrix of blocks, every third pair coupled."""
    rng = np.random.default_rng(seed)
    every = [(i, j) for i in range(count) for j in range(i + 1, count)]
    pairs = np.array(every[::3], np.int64).reshape(-1, 2)
    diagonal = np.zeros((count, 6, 6)) + 10.0 * np.eye(6)
    upper = np.empty((len(pairs), 6, 6))
    for q, (i, j) in enumerate(pairs):
        left, right = rng.normal(size=(2, 6, 2))
        diagonal[i] += left @ left.T
        diagonal[j] += right @ right.T
        upper[q] = left @ right.T
    return diagonal, pairs, upper


@pytest.mark.parametrize("count", [1, 2, 20, 32])
def test_the_inverse_is_that_of_the_whole_matrix(count):
    given = blocks(count)
    inverse, definite = dense.invert_blocks(*given)
    assert definite
    assert np.array_equal(inverse, inverse.T)
    np.testing.assert_allclose(
        inverse @ matrix_of(*given), np.eye(6 * count), rtol=0.0, atol=1e-12 * count
    )
    for kind, columns, near in ((np.float64, 6, 1e-13), (np.float32, 8, 1e-6)):
        b, x = np.zeros((2, count, columns), kind)
        b[:, :6] = np.random.default_rng(1).normal(size=(count, 6))
        dense.multiply_dense(inverse, b, x)
        wanted = (inverse @ b[:, :6].ravel()).reshape(-1, 6)
        assert x[:, :6] == pytest.approx(wanted, abs=near * np.abs(wanted).max())
        assert not x[:, 6:].any()


def test_a_matrix_that_is_not_definite_has_no_inverse():
    diagonal, pairs, upper = blocks(5)
    diagonal[3] -= 100.0 * np.eye(6)
    assert not dense.invert_blocks(diagonal, pairs, upper)[1]


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
