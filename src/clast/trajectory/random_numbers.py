"""Random numbers by a counter: those of a path depend on its seed alone.

SplitMix64 (Steele, Lea and Flood 2014, Fast splittable pseudorandom number generators).
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
FIRST, SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
BITS = (np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11))


@kernel()
def mixed(z):
    """Return 64 bits that depend on each of 64 bits."""
    z = (z ^ (z >> BITS[0])) * FIRST
    z = (z ^ (z >> BITS[1])) * SECOND
    return z ^ (z >> BITS[2])


@kernel()
def stream(seed, kind, number):
    """Return the counter (1,) of the numbers that belong to a seed and two whole numbers."""
    made = mixed(mixed(mixed(np.uint64(seed)) + np.uint64(kind)) + np.uint64(number))
    return np.array([made])


@kernel()
def uniform(counter):
    """Return the next number in [0, 1) of a counter of 64 bits, which moves on."""
    counter[0] += GOLDEN
    return np.float64(mixed(counter[0]) >> BITS[3]) * 2.0**-53


@kernel()
def normal(counter):
    """Return the next standard normal number (Box and Muller 1958)."""
    radius = np.sqrt(-2.0 * np.log(1.0 - uniform(counter)))
    return radius * np.cos(2.0 * np.pi * uniform(counter))


@kernel()
def drawn(deck, counter):
    """Return a value of a deck (n,), each as likely as another."""
    return deck[int(uniform(counter) * len(deck))]
