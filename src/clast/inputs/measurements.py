"""[[measured_point]] and [[reference]]: points to record, and values known from elsewhere."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Self

from pydantic import StrictStr, model_validator

from clast import spelling
from clast.errors import shortened
from clast.inputs.declaring.table import Point, Positive, Table
from clast.inputs.declaring.validation_messages import Fault, refusal


class MeasuredPoint(Table):
    """A point whose displacement, velocity and rotation are recorded every step."""

    name: StrictStr
    """Name."""
    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class MeasuredContact(Table):
    """Forces, opening and slip of contacts, recorded every step: at a place, or of a joint."""

    name: StrictStr
    """Name."""
    at: Point | None = None
    """Place [x, y], m: the contact nearest to it at each step."""
    joint: StrictStr | None = None
    """Joint: the mean of its contacts, each by its length, with extremes."""

    @model_validator(mode="after")
    def _is_somewhere(self) -> Self:
        if (self.at is None) == (self.joint is None):
            what = "neither" if self.at is None else "both"
            raise refusal(
                Fault(
                    place=("at",),
                    what=f"{what} of at and joint is given",
                    remedy="give one of them: a place [x, y] in m, or the name of a joint",
                )
            )
        return self


class MeasuredReaction(Table):
    """The total reaction of some supports, recorded every step."""

    name: StrictStr
    """Name."""
    block: StrictStr | None = None
    """Block, fixed or moved."""
    blocks: list[StrictStr] | None = None
    """Blocks, fixed or moved."""
    fixed_point: Point | None = None
    """Coordinates [x, y] of a [[fixed_point]], m."""
    about: Point | None = None
    """Reference point [x, y] of its moment, m; the centre of the supports if absent."""

    @model_validator(mode="after")
    def _names_something(self) -> Self:
        keys = ("block", "blocks", "fixed_point")
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            said = " and ".join(given) or "nothing"
            remedy = 'give one of block = "1", blocks = ["1", "2"] and fixed_point = [x, y]'
            raise refusal(Fault(what=f"names {said}", remedy=remedy))
        return self


class Reference(Table):
    """A known displacement, to compare a run with."""

    point: StrictStr
    """Measured point."""
    displacement: Point
    """Displacement [u, v] since the start, or since a stage has reset it, m."""
    time: Positive | None = None
    """When, s; the end of the run if absent."""
    source: StrictStr = ""
    """Where it comes from, e.g. "closed form: g t2/2"."""


def point_faults(
    points: Sequence[MeasuredPoint], references: Sequence[Reference]
) -> Iterator[Fault]:
    """Yield faults of points in a case file: names with a slash, references to none."""
    for number, point in enumerate(points):
        if "/" in point.name:  # scripts may: only a file's names are typed in again
            yield Fault(
                place=("measured_point", number, "name"),
                what=f"'{shortened(point.name)}' has a /, but names places in the result file",
                remedy="give it a name without /",
            )
    names = [point.name for point in points]
    for number, reference in enumerate(references):
        if reference.point not in names:
            yield Fault(
                place=("reference", number, "point"),
                what=f"there is no measured point '{reference.point}'",
                remedy=spelling.advice(reference.point, names, kind="measured point"),
            )
