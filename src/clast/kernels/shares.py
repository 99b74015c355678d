"""How threads share contacts and pairs."""

from __future__ import annotations

from clast.kernels.compiled import kernel

PART = 1024
"""Contacts that a thread takes at a time, and that are summed up by themselves."""
MANY = 3000
"""Contacts from which threads share them; below, starting them costs more than they give."""


@kernel()
def parts(count):
    """Return the number of parts of contacts."""
    return (count + PART - 1) // PART


@kernel()
def bounds(part, count):
    """Return the first contact of a part and the one after its last."""
    return part * PART, min((part + 1) * PART, count)


@kernel()
def alike(one, other):
    """Return whether two arrays (m,) hold the same numbers, up to the first that differs."""
    if len(one) != len(other):
        return False
    for c in range(len(one)):
        if one[c] != other[c]:
            return False
    return True
