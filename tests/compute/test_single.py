"""Six numbers in single precision do what six numbers do, and so do products made of them."""

import mmap

import numba
import numpy as np
import pytest

from clast.compute import vec6 as six
from clast.compute import vec6_single as single
from clast.linear import block_matrix as block_rows
from clast.linear.pattern import without_fill
from clast.linear.pcg import multiply, vector


@numba.njit
def all_of_them(x, blocks):
    """Return what each operation gives, a line each."""
    result = np.ones((24, 8), np.float32)
    u, v, k = single.row(x, 0), single.row(x, 1), single.lines(blocks, 1)
    single.put_row(result, 0, six.plus(u, v))
    single.put_row(result, 1, six.minus(u, v))
    even, odd = single.add_lines((u, single.zeros()), single.spread(v), k)
    single.put_row(result, 2, six.plus(even, odd))
    single.put_row(result, 3, single.zeros())
    single.put_row(result, 4, six.minus(v, u))
    single.put_row(result, 5, single.totals(single.add_products(single.zero_lines(), k, u)))
    for a, value in enumerate(single.spread(v)):
        single.put_row(result, 6 + a, value)
    for a, value in enumerate(k):
        single.put_row(result, 12 + a, value)
    return result, six.total(six.plus_product(six.zeros(), single.double(u), single.double(v)))


def test_operations():
    rng = np.random.default_rng(1)
    x = padded(rng.normal(size=(2, 6)))
    blocks = rng.normal(size=(2, 6, 6)).astype(np.float32)
    found, product = all_of_them(x, blocks)
    u, v = x[:, :6]
    wanted = [
        u + v,
        u - v,
        u + blocks[1].T @ v,
        np.zeros(6),
        v - u,
        blocks[1] @ u,
        *[np.full(6, v[k]) for k in range(6)],
        *blocks[1],
    ]
    assert found[:18, :6] == pytest.approx(np.array(wanted), rel=1e-5, abs=1e-6)
    assert not found[:18, 6:].any()
    assert product == pytest.approx(u.astype(float) @ v.astype(float), rel=1e-12)


@numba.njit
def last_line(blocks, q, out):
    single.put_row(out, 0, single.lines(blocks, q)[5])


def test_nothing_is_read_behind_a_block():
    """The last block ends where the memory does."""
    page = mmap.PAGESIZE
    room = mmap.mmap(-1, page)
    blocks = np.frombuffer(room, np.float32)[-36:].reshape(1, 6, 6)
    blocks[...] = np.arange(36.0).reshape(6, 6)
    out = np.empty((1, 8), np.float32)
    last_line(blocks, 0, out)
    assert list(out[0]) == [30.0, 31.0, 32.0, 33.0, 34.0, 35.0, 0.0, 0.0]


def random_pairs(rng, count, number):
    """Return sorted pairs of different blocks."""
    drawn = np.sort(rng.integers(0, count, (number, 2)), axis=1)
    return np.unique(drawn[drawn[:, 0] < drawn[:, 1]], axis=0)


def padded(x):
    """Return a vector (n, 6) as kernels in single precision take it."""
    found = vector(len(x))
    found[:, :6] = x
    return found


@pytest.mark.parametrize("count", [1, 2, 300, 3000])
def test_products_are_those_in_double_precision(count):
    """Of pairs between any rows; 3,000 rows are in several stretches, which most pairs cross."""
    rng = np.random.default_rng(count)
    pairs = random_pairs(rng, count, 3 * count)
    diagonal = rng.normal(size=(count, 6, 6)).astype(np.float32)
    diagonal += diagonal.transpose(0, 2, 1)
    upper = rng.normal(size=(len(pairs), 6, 6)).astype(np.float32)
    rows = block_rows.row_pointers(count, pairs)
    x = rng.normal(size=(count, 6))
    wanted = block_rows.multiply(diagonal.astype(float), upper.astype(float), pairs, rows, x)
    begin, every = np.array([0, count, count]), np.ones(len(pairs), np.bool_)
    pattern = without_fill(np.arange(count), begin, pairs, rows, every)
    found = padded(np.full_like(x, np.nan))
    of_single = multiply((diagonal, upper), pattern, padded(x), found)
    assert np.abs(found[:, :6] - wanted).max() <= 2e-6 * np.abs(wanted).max()
    assert not found[:, 6:].any()
    assert of_single == pytest.approx(np.sum(x * wanted), abs=1e-5 * np.abs(x * wanted).sum())


@numba.njit
def fetched(blocks):
    """Ask for what lies far behind and before the blocks."""
    for q in (0, len(blocks) - 1):
        for ahead in (1, -1, 10**6, -(10**6)):
            single.fetch(blocks, q, ahead)
    return True


def test_what_is_not_there_may_be_asked_for():
    assert fetched(np.zeros((3, 6, 6), np.float32))
