"""Six numbers at once do what six numbers do."""

import numba
import numpy as np
import pytest

from clast.compute import vec6 as six
from clast.compute.mat6 import lines, lines_times
from clast.linear import block_matrix as block_rows


@numba.njit
def all_of_them(x, blocks, factor):
    """Return what each operation gives, a line each."""
    result = np.empty((9, 6))
    u, v, w = six.row(x, 0), six.row(x, 1), six.line(blocks, 1, 2)
    six.put_row(result, 0, six.plus(u, v))
    six.put_row(result, 1, six.plus_scaled(u, factor, v))
    six.put_row(result, 2, six.plus_product(u, v, w))
    six.put_row(result, 3, six.zeros())
    six.put_row(result, 4, lines_times(lines(blocks, 1), u))
    result[5] = six.total(u) * six.inner(u, v)
    six.put_row(result, 6, six.six(1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    for k in range(6):
        six.put_row(result, 7, six.with_number(six.row(result, 7), k, x[2, k]))
    six.put_line(blocks, 0, 5, w)
    result[8] = blocks[0, 5]
    return result


def test_operations():
    rng = np.random.default_rng(1)
    x, blocks = rng.normal(size=(3, 6)), rng.normal(size=(2, 6, 6))
    u, v, w = x[0], x[1], blocks[1, 2].copy()
    found = all_of_them(x, blocks, 3.5)
    wanted = [
        u + v,
        u + 3.5 * v,
        u + v * w,
        np.zeros(6),
        blocks[1] @ u,
        np.full(6, u.sum() * (u @ v)),
        np.arange(1.0, 7.0),
        x[2],
        w,
    ]
    assert found == pytest.approx(np.array(wanted), rel=1e-14, abs=1e-14)


@numba.njit
def shifted(x, out):
    """Copy rows of a part of an array, by way of its rows."""
    for i in range(len(x)):
        six.put_row(out, i, six.row(x, i))


def test_parts_of_arrays():
    x = np.arange(60.0).reshape(10, 6)
    out = np.zeros((5, 6))
    shifted(x[::2], out)
    assert np.array_equal(out, x[::2])


def test_products_with_blocks():
    rng = np.random.default_rng(2)
    pairs = np.array([(0, 1), (0, 3), (1, 2), (2, 3)])
    diagonal, upper = rng.normal(size=(4, 6, 6)), rng.normal(size=(4, 6, 6))
    diagonal += diagonal.transpose(0, 2, 1)
    x = rng.normal(size=(4, 6))
    matrix = np.zeros((24, 24))
    for i in range(4):
        matrix[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = diagonal[i]
    for (i, j), block in zip(pairs, upper, strict=True):
        matrix[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] = block
        matrix[6 * j : 6 * j + 6, 6 * i : 6 * i + 6] = block.T
    rows = block_rows.row_pointers(4, pairs)
    y = block_rows.multiply(diagonal, upper, pairs, rows, x)
    assert y.ravel() == pytest.approx(matrix @ x.ravel(), rel=1e-12, abs=1e-12)
    assert block_rows.dot(x, y) == pytest.approx(x.ravel() @ matrix @ x.ravel(), rel=1e-12)


def test_inverses():
    rng = np.random.default_rng(3)
    roots = rng.normal(size=(50, 6, 6)) * 10.0 ** rng.uniform(-4.0, 4.0, size=(50, 1, 6))
    blocks = roots.transpose(0, 2, 1) @ roots
    inverse, bad = block_rows.inverse_blocks(blocks)
    assert bad == -1
    scale = np.sqrt(np.einsum("nii->ni", blocks))
    unit = np.einsum("nij,njk->nik", inverse, blocks) * scale[:, :, None] / scale[:, None, :]
    assert unit == pytest.approx(np.broadcast_to(np.eye(6), unit.shape), abs=1e-4)
    blocks[7] *= -1.0
    assert block_rows.inverse_blocks(blocks)[1] == 7
