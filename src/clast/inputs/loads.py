"""[[fixed_point]], [[point_load]], [[line_load]], [[pressure]]: supports and loads of blocks."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Discriminator, StrictStr, Tag, model_validator

from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Force, Instant, Point, Stress, Table
from clast.inputs.declaring.validation_messages import PLAIN, TABLE, Fault, refusal
from clast.model import ranges
from clast.model.factors import Factor


class FixedPoint(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class Amplitude(Table):
    """A factor of loads over time, linear between its instants and constant outside them.

    Loads name it in ``amplitude``; each step has the load times the value at its end.
    """

    NAMED: ClassVar[bool] = True

    time: list[Instant]
    """Times, s, increasing."""
    value: list[Annotated[Number, within(ranges.FACTOR)]]
    """Values at the instants, -."""

    @model_validator(mode="after")
    def _is_a_function_of_time(self) -> Self:
        count, place = len(self.time), ("time",)
        if len(self.value) != count:
            what = f"has {len(self.value)} values for {count} instants"
            remedy = "give one value for each instant"
            raise refusal(Fault(place=("value",), what=what, remedy=remedy))
        if count < 2:
            remedy = "give at least 2; a load that is constant needs no amplitude"
            raise refusal(Fault(place=place, what=f"has {count} instants", remedy=remedy))
        for k, (before, after) in enumerate(pairwise(self.time), 1):
            if after <= before:
                what = f"instant {k + 1}, {after:g} s, is not after instant {k}, {before:g} s"
                remedy = "order the instants by time, each once (for a jump, 1e-9 s apart)"
                raise refusal(Fault(place=place, what=what, remedy=remedy))
        return self

    def factor(self, name: str) -> Factor:
        """Return it as a factor of the model."""
        time, value = (np.array(one, np.float64) for one in (self.time, self.value))
        return Factor(name=name, time=time, value=value)


class PointLoad(Table):
    """A force at a point that moves with its block."""

    at: Point
    """Coordinates [x, y], m."""
    force: tuple[Force, Force]
    """Force [x, y], N per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which the load is multiplied; constant if absent."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""


class LineLoad(Table):
    """A traction along a line that moves with its block, usually along an edge."""

    start: Point
    """First end [x, y], m."""
    end: Point
    """Second end [x, y], m."""
    traction: tuple[Force, Force]
    """Force per length [x, y], N/m per metre of thickness."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which the load is multiplied; constant if absent."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        check_length(self.start, self.end)
        return self


def _kind_of_value(value: Any) -> str:
    """Return the tag of a pressure: one number, or one for each end."""
    return TABLE if isinstance(value, list | tuple) else PLAIN


class Pressure(Table):
    """A pressure on the edges along a straight line; it stays normal to them as they turn.

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
    amplitude: StrictStr | None = None
    """Amplitude over time by which the pressure is multiplied; constant if absent."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        check_length(self.start, self.end)
        return self


def check_length(start: Point, end: Point) -> None:
    """Refuse a line whose ends are one point."""
    if start == end:
        raise refusal(Fault(what="has no length", remedy="give two different ends"))
