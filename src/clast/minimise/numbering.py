"""Numbers by which blocks that touch are near each other in memory.

A model is numbered as it was made: a wall course by course, a rock mass as its joints cut it or a
drawing lists it, perhaps in no order at all.  Where touching blocks have numbers far apart every
product fetches them from all over the memory, and the incomplete factorisation, which eliminates
blocks in the order of their numbers, loses strength.  The minimisation then numbers them anew, row
by row along the shorter side of what they fill; nothing else sees these numbers.
"""

from __future__ import annotations

import numpy as np

from clast.minimise import connected as regions
from clast.model.model import Bools, Floats, Ints

FEW = 500
"""Blocks up to which any numbering will do."""
SCATTERED = 0.1
"""Mean difference of the numbers of touching blocks, as a share of all, that is too large; a third
where there is no order at all, and the inverse of the number of rows where there are rows."""


def order_of(centroid: Floats, pairs: Ints, fixed: Bools) -> Ints | None:
    """Return the blocks in a better order, shape (n,), or None where their own will do.

    ``centroid`` (n, 2), m, is where they are, ``pairs`` (q, 2) are those that touch; pairs with a
    ``fixed`` (n,) block do not count: a base may be one long block.
    """
    count = len(centroid)
    if count <= FEW or regions.spread(pairs, fixed) <= SCATTERED * count:
        return None
    return by_rows(centroid)


def by_rows(centroid: Floats) -> Ints:
    """Return blocks at ``centroid`` (n, 2), m, row by row along the shorter side, shape (n,)."""
    low = centroid.min(axis=0)
    extent = centroid.max(axis=0) - low
    along = int(np.argmin(extent))
    height = np.sqrt(extent.prod() / len(centroid))
    if height == 0.0:  # all in one line
        return np.argsort(centroid[:, 1 - along], kind="stable")
    row = np.floor((centroid[:, 1 - along] - low[1 - along]) / height)
    return np.lexsort((centroid[:, along], row))
