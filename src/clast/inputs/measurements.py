"""[[measured_point]] and [[reference]]: what is recorded, and what is known elsewhere of it."""

from __future__ import annotations

from pathlib import Path

from pydantic import StrictStr, field_validator

from clast.errors import shortened
from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.faults import Fault, refusal
from clast.inputs.declaring.table import Point, Positive, Table


class MeasuredPointTable(Table):
    """A point whose displacement, velocity and rotation are recorded every step."""

    name: StrictStr
    """Name."""
    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""

    @field_validator("name")
    @classmethod
    def _has_no_slash(cls, name: str) -> str:
        if "/" in name:
            what = f"'{shortened(name)}' has a /, but names places in the result file"
            raise refusal(Fault(what=what, remedy="give it a name without /"))
        return name

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the measured point."""
        builder.measured_point(**dict(self))


class ReferenceTable(Table):
    """A displacement that is known from elsewhere, to compare a run with."""

    point: StrictStr
    """Measured point that it is known for."""
    displacement: Point
    """Displacement [u, v] since the start, or since a stage has reset it, m."""
    time: Positive | None = None
    """When, s; the end of the run if absent."""
    source: StrictStr = ""
    """Where it comes from, e.g. "closed form: g t2/2"."""
