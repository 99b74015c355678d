"""Springs put into some rows of a table: kernels, for numpy takes three times as long."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel()
def _put(values, rows, others):
    found = np.empty_like(values)
    for c in range(len(values)):
        found[c] = values[c]
    for k in range(len(rows)):
        found[rows[k]] = others[k]
    return found


@kernel()
def put_rows(springs, rows, others):
    """Return the four arrays (m,) of springs with those (k,) of ``others`` in ``rows`` (k,).

    Force at zero, stiffness, least and largest force.
    """
    return (
        _put(springs[0], rows, others[0]),
        _put(springs[1], rows, others[1]),
        _put(springs[2], rows, others[2]),
        _put(springs[3], rows, others[3]),
    )
