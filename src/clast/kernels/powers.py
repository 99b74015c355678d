"""Numbers by the power of two that they are just below: a histogram over all that a number can be.

It is made in one pass, whatever the numbers are, and tells as well as a sorted list would how much
the largest of them have together.
"""

from __future__ import annotations

import math

import numpy as np

from clast.kernels.compiled import kernel

LOWEST, HIGHEST = -1073, 1024
"""Powers of the smallest and of the largest number in double precision."""


@kernel()
def by_power(numbers):
    """Return the power of each of ``numbers`` (n,) >= 0, and what belongs to each power.

    That is the sum of its numbers and how many there are, both (HIGHEST - LOWEST + 1,), from LOWEST
    on.  Zero has the power LOWEST - 1 and is not counted.  All must be finite.
    """
    power = np.empty(len(numbers), np.int64)
    together, count = np.zeros(HIGHEST - LOWEST + 1), np.zeros(HIGHEST - LOWEST + 1, np.int64)
    for i in range(len(numbers)):
        power[i] = LOWEST - 1
        if numbers[i] > 0.0:
            _, power[i] = math.frexp(numbers[i])
            together[power[i] - LOWEST] += numbers[i]
            count[power[i] - LOWEST] += 1
    return power, together, count
