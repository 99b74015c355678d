"""The start of a worker: imports nothing, for numba and BLAS count threads when they are loaded."""

from __future__ import annotations

import os
import signal
from contextlib import suppress

THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that say how many threads a library takes."""


def start_worker() -> None:
    """Have a worker use one thread, before anything is imported, and not hear the interrupt key."""
    for name in THREADS:
        os.environ[name] = "1"
    with suppress(ValueError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
