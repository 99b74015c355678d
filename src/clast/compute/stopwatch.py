"""Wall time of the stages of a step; that of compilation is not counted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from clast.compute.compilation import working_time


class Stages:
    """Adds up wall time by stage; used as ``with stages("contacts"): ...``."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Add the wall time of the block to the stage ``name``."""
        start = working_time()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + working_time() - start
