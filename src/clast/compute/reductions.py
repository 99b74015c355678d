"""Sums and reductions of a few numbers, and the sizes of the parts of loops.

Loops over contacts do little with each: slices of arrays that begin at 0, divisions that raise
nothing (error_model="numpy") and values chosen without branches let several contacts share each
instruction.

numpy takes 2 us for the largest of eight numbers, a kernel 0.4 us.  Sums are numpy's, which adds up
many numbers in parts:  ``sum`` calls ``np.add.reduce`` after two more calls.
"""

from __future__ import annotations

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, CONTACTS

PART, MANY = CONTACTS.part, CONTACTS.many
"""Contacts that are summed up by themselves, and from which threads share them."""
CHUNK, SHARED = BLOCKS.part, BLOCKS.many
"""Blocks that are summed up by themselves, and from which threads share them."""


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
    smallest = start
    for k in range(len(values)):
        if not values[k] >= smallest:
            smallest = values[k]
            if smallest != smallest:
                break
    return smallest


@kernel()
def largest_size(values):
    """Return the largest size of numbers (k,), 0 where there are none; nan where one is nan."""
    largest = 0.0
    for k in range(len(values)):
        if not abs(values[k]) <= largest:
            largest = abs(values[k])
            if largest != largest:
                break
    return largest
