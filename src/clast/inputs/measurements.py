"""[[measured_point]] and [[reference]]: what is recorded, and what is known elsewhere of it."""

from __future__ import annotations

from pydantic import StrictStr, field_validator

from clast.errors import shortened
from clast.inputs.declaring.faults import Fault, refusal
from clast.inputs.declaring.table import Point, Positive, Table


class MeasuredPoint(Table):
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


class Reference(Table):
    """A displacement that is known from elsewhere, to compare a run with."""

    point: StrictStr
    """Measured point that it is known for."""
    displacement: Point
    """Displacement [u, v] since the start, or since a stage has reset it, m."""
    time: Positive | None = None
    """When, s; the end of the run if absent."""
    source: StrictStr = ""
    """Where it comes from, e.g. "closed form: g t2/2"."""
