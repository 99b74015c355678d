"""numpy's reductions of a few numbers, in a fifth of their time.

numpy takes 2 us for the largest of eight numbers, a kernel 0.4 us.  Sums are numpy's, which adds up
many numbers in parts:  ``sum`` calls ``np.add.reduce`` after two more calls.
"""

from __future__ import annotations

from clast.compute.jit import kernel


@kernel()
def is_any(values):
    """Return whether any of truth values (k,) is true."""
    for k in range(len(values)):
        if values[k]:
            return True
    return False


@kernel()
def least(values, start):
    """Return the least of numbers (k,), and of ``start``; nan where one is nan."""
    found = start
    for k in range(len(values)):
        if not values[k] >= found:
            found = values[k]
            if found != found:
                break
    return found


@kernel()
def largest_size(values):
    """Return the largest size of numbers (k,), 0 where there are none; nan where one is nan."""
    found = 0.0
    for k in range(len(values)):
        if not abs(values[k]) <= found:
            found = abs(values[k])
            if found != found:
                break
    return found
