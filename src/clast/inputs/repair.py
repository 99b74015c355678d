"""[repair]: blocks that were drawn a little apart or into each other, put together."""

from __future__ import annotations

from pathlib import Path

from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.table import Length, Table


class RepairTable(Table):
    """All blocks, whichever table brings them, put together where they are meant to touch."""

    tolerance: Length
    """Largest distance by which corners and edges that belong together were drawn apart, m:
    vertices within it become one, or go onto the edge of another block; none moves further."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Have the builder put its blocks together."""
        from clast.rockmass.repair.mender import Mender

        builder.mending = Mender(tolerance=self.tolerance)
