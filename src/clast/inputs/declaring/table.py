"""What all tables of the case file have in common: the kinds of numbers, and what a table can do.

A group of tables is a file here and a line in ``clast.case.case_file.Case``: the name of the
table in the file.  What it says of the system of blocks it adds to the builder by itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.choices import Number, within
from clast.model import ranges

Positive = Annotated[Number, Field(gt=0.0)]
Interval = Annotated[Positive, within(ranges.INTERVAL)]
Length = Annotated[Positive, within(ranges.LENGTH)]
Strength = Annotated[Number, Field(ge=0.0), within(ranges.STRESS)]
Coordinate = Annotated[Number, within(ranges.COORDINATE)]
Point = tuple[Coordinate, Coordinate]
Force = Annotated[Number, within(ranges.FORCE)]
Speed = Annotated[Number, within(ranges.SPEED)]
Motion = tuple[Speed, Speed, Speed]
Acceleration = Annotated[Number, within(ranges.ACCELERATION)]
Instant = Annotated[Number, within(ranges.TIME)]
Stress = Annotated[Number, within(ranges.STRESS)]
Stresses = tuple[Stress, Stress, Stress]
Loop = list[Point]


class Table(BaseModel):
    """A table of the case file: unknown keys and numbers that are none are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add to the system of blocks what the table says of it; ``key`` is the table's own name.

        ``folder`` is where the case file is.  Tables that say nothing of the system add nothing.
        """

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say what seems unsound and only the case file knows."""
        return iter(())
