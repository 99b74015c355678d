"""The triad of the STREAM benchmark: the memory bandwidth of a loop that does nothing else."""

from __future__ import annotations

from clast.compute.jit import kernel
from clast.compute.parallel import prange


@kernel()
def triad(a, b, c, scale):
    """Write b + scale c into a, each of shape (n,); 24 bytes are moved for each element."""
    for i in range(len(a)):
        a[i] = b[i] + scale * c[i]


@kernel(parallel=True)
def triad_by_threads(a, b, c, scale):
    """Do the same with all threads."""
    for i in prange(len(a)):
        a[i] = b[i] + scale * c[i]
