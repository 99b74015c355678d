"""[[fixed_point]], [[point_load]], [[line_load]], [[pressure]]: what holds and pushes blocks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import Discriminator, StrictStr, Tag

from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.choices import Number, within
from clast.inputs.declaring.faults import PLAIN, TABLE
from clast.inputs.declaring.table import Force, Instant, Point, Stress, Table
from clast.model import ranges


class FixedPointTable(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the fixed point."""
        builder.fixed_point(**dict(self))


class FactorTable(Table):
    """A factor of loads over time, linear between its instants and constant outside them.

    Loads name it in ``factor``; each step has the load times the value at its end.
    """

    time: list[Instant]
    """Instants, s, rising."""
    value: list[Annotated[Number, within(ranges.FACTOR)]]
    """Values at the instants, -."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the factor."""
        builder.add_table(key, self.time, self.value)


class PointLoadTable(Table):
    """A force at a point that moves with its block."""

    at: Point
    """Coordinates [x, y], m."""
    force: tuple[Force, Force]
    """Force [x, y], N per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""
    factor: StrictStr | None = None
    """Table by whose value the load is multiplied; none: it is constant."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the load."""
        builder.point_load(**dict(self))


class LineLoadTable(Table):
    """A traction along a line that moves with its block, usually along an edge."""

    start: Point
    """First end [x, y], m."""
    end: Point
    """Second end [x, y], m."""
    traction: tuple[Force, Force]
    """Force per length [x, y], N/m per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""
    factor: StrictStr | None = None
    """Table by whose value the load is multiplied; none: it is constant."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the load."""
        builder.line_load(**dict(self))


def _kind_of_value(value: Any) -> str:
    """Return the tag of a pressure: one number, or one for each end."""
    return TABLE if isinstance(value, list | tuple) else PLAIN


class PressureTable(Table):
    """A pressure on the edges along a straight line, normal to them as they turn.

    It acts on the parts of edges that lie on the line at the start of the run, from outside the
    blocks, and goes with them.
    """

    start: Point
    """First end of the line [x, y], m."""
    end: Point
    """Second end of the line [x, y], m."""
    value: Annotated[
        Annotated[Stress, Tag(PLAIN)] | Annotated[tuple[Stress, Stress], Tag(TABLE)],
        Discriminator(_kind_of_value),
    ]
    """Pressure, Pa, positive into the blocks: one number, or [at start, at end], linear between."""
    block: StrictStr | None = None
    """Block; needed only where edges of two blocks lie on the line."""
    factor: StrictStr | None = None
    """Table by whose value the pressure is multiplied; none: it is constant."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the pressure."""
        builder.pressure(**dict(self))
