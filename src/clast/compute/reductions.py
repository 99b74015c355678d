"""Sums and reductions of a few numbers, and the sizes of the parts of loops.

Loops over contacts do little with each: slices of arrays that begin at 0, divisions that raise
nothing (error_model="numpy") and values chosen without branches let several contacts share each
instruction.

numpy takes 2 us for the largest of eight numbers, a kernel 0.4 us.  Sums are numpy's, which adds up
many numbers in parts:  ``sum`` calls ``np.add.reduce`` after two more calls.
"""

from __future__ import annotations

from clast.compute.jit import kernel

PART = 1024
"""Contacts that a thread takes at a time, and that are summed up by themselves."""
MANY = 3000
"""Contacts from which threads share them; below, starting them costs more than they give."""


@kernel()
def in_part(two, first, last):
    """Return the parts of two arrays (m,) that belong to the contacts ``first`` to ``last`` - 1."""
    return two[0][first:last], two[1][first:last]


@kernel()
def sum_of(values):
    """Return the sum of numbers (m,), found as four sums at once."""
    s0 = s1 = s2 = s3 = 0.0
    rest = len(values) % 4
    for c in range(0, len(values) - rest, 4):
        s0 += values[c]
        s1 += values[c + 1]
        s2 += values[c + 2]
        s3 += values[c + 3]
    for c in range(len(values) - rest, len(values)):
        s0 += values[c]
    return (s0 + s1) + (s2 + s3)


@kernel()
def alike(one, other):
    """Return whether two arrays (m,) hold the same numbers, up to the first that differs."""
    if len(one) != len(other):
        return False
    for c in range(len(one)):
        if one[c] != other[c]:
            return False
    return True


CHUNK = 128
"""Rows that a thread takes at a time, and that are summed up by themselves."""


SHARED = 800
"""Rows from which threads share the work; below, starting them costs more than they give."""


@kernel()
def chunks(count):
    """Return the number of chunks of rows."""
    return (count + CHUNK - 1) // CHUNK


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
