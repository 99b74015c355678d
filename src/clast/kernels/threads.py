"""How many threads may take part in a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numba

from clast.kernels.block_rows import SHARED


@contextmanager
def threads_worth(blocks: int) -> Iterator[None]:
    """Let one thread work alone, as long as this lasts, where there are too few ``blocks``.

    Nothing that takes long is shared then, but calling the others for what is costs time.
    """
    asked = numba.get_num_threads()
    if blocks < SHARED:
        numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(asked)
