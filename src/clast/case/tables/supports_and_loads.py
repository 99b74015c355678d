"""[[fixed_point]], [[point_load]] and [[line_load]]: what holds blocks and what pushes them."""

from __future__ import annotations

from pathlib import Path

from pydantic import StrictStr

from clast.case.tables.table import Force, Point, Table
from clast.model.builder import ModelBuilder


class FixedPointTable(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the fixed point."""
        builder.fixed_point(**dict(self))


class PointLoadTable(Table):
    """A constant force at a point that moves with its block."""

    at: Point
    """Coordinates [x, y], m."""
    force: tuple[Force, Force]
    """Force [x, y], N per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the load."""
        builder.point_load(**dict(self))


class LineLoadTable(Table):
    """A constant traction along a line that moves with its block, usually along an edge."""

    start: Point
    """First end [x, y], m."""
    end: Point
    """Second end [x, y], m."""
    traction: tuple[Force, Force]
    """Force per length [x, y], N/m per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the load."""
        builder.line_load(**dict(self))
