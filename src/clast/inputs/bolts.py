"""[bolt_kind.NAME], [[bolt]], [[bolt_pattern]]: stiffness, strength and position of bolts.

Forces are tension positive, and N per metre of thickness; those of a kind with an
``out_of_plane_spacing`` are N, of one bolt, as all of its numbers are.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, Extends, RefersTo
from clast.inputs.declaring.table import OR_TEXT, Length, Loop, Point, Positive, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.loads import check_length
from clast.model import ranges
from clast.model.model import Floats

BoltForce = Annotated[Number, Field(ge=0.0), within(ranges.FORCE)]
Degrees = Annotated[Number, Field(ge=-360.0, le=720.0)]
AXIAL = ("young", "area", "out_of_plane_spacing")
"""The properties from which a stiffness is computed."""


class BoltKind(Table):
    """Stiffness and strength of bolts: stiffness, or young, area and out_of_plane_spacing.

    With stiffness its numbers are per metre of thickness, with out_of_plane_spacing of one bolt.
    """

    NAMED: ClassVar[bool] = True

    stiffness: Annotated[Positive, within(ranges.STIFFNESS)] | None = None
    """Force per elongation, N/m per m."""
    young: Annotated[Positive, within(ranges.MODULUS)] | None = None
    """Young's modulus of one bolt, Pa; with area and out_of_plane_spacing in place of stiffness."""
    area: Positive | None = None
    """Cross-section of one bolt, m2."""
    out_of_plane_spacing: Length | None = None
    """Distance between bolts along the thickness, m; with it all other numbers are of one bolt."""
    yield_force: Annotated[Positive, within(ranges.FORCE)] | None = None
    """Force at which it yields, N per metre of thickness; N of one bolt with out_of_plane_spacing.
    It is elastic if absent."""
    rupture_elongation: Length | None = None
    """Elongation, plastic part included, at which it breaks, m; never if absent."""
    rupture_strain: Annotated[Positive, within(ranges.FACTOR)] | None = None
    """The same as a share of its length, -."""
    pretension: BoltForce = 0.0
    """Force at installation, N per metre of thickness; N of one bolt with out_of_plane_spacing."""
    compression: StrictBool = False
    """True for bars, which carry compression; cables carry none."""

    INSTEAD: ClassVar = (("stiffness", "young"), ("rupture_elongation", "rupture_strain"))
    WHEN: ClassVar = {"young": {ANY: AXIAL[1:]}}
    BASIC: ClassVar = (*AXIAL, "yield_force", "pretension")

    @model_validator(mode="after")
    def _has_one_stiffness(self) -> Self:
        given = [key for key in AXIAL if getattr(self, key) is not None]
        lacking = [key for key in AXIAL if key not in given]
        if self.stiffness is not None and given:
            what = f"stiffness and {', '.join(given)} are both given"
            remedy = f"give stiffness, N/m per m of thickness, or {', '.join(AXIAL)}"
            raise refusal(what, remedy)
        if self.stiffness is None and lacking:
            half = f"{' and '.join(given)} without {' and '.join(lacking)}"
            remedy = (
                "give stiffness, N/m per m of thickness, or all of young (Pa), area (m2 of one "
                "bolt) and out_of_plane_spacing (m between bolts along the thickness)"
            )
            raise refusal(half if given else "has no stiffness", remedy)
        return self

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        if self.yield_force is not None and self.pretension > self.yield_force:
            unit = "N/m" if self.out_of_plane_spacing is None else "N"
            what = (
                f"a pretension of {self.pretension:g} {unit} is above yield_force, "
                f"{self.yield_force:g} {unit}"
            )
            remedy = "lower it: a bolt cannot be tensioned beyond its yield force"
            raise refusal(what, remedy, "pretension")
        if self.rupture_elongation is not None and self.rupture_strain is not None:
            what = "rupture_elongation and rupture_strain are both given"
            raise refusal(what, "give one of them: m, or a share of the length")
        return self

    def per_metre(self, force: float) -> float:
        """Return a force of the table per metre of thickness, N/m."""
        return force / (self.out_of_plane_spacing or 1.0)

    def stiffness_of(self, length: Floats) -> Floats:
        """Return the stiffness of springs of lengths (m,), m, in N/m per m: E A/(L a), (m,)."""
        if self.stiffness is not None:
            return np.full(len(length), self.stiffness)
        return np.asarray(self.per_metre((self.young or 0.0) * (self.area or 0.0)) / length)

    def rupture_of(self, length: Floats) -> Floats:
        """Return the elongation at which springs of lengths (m,) break, m, inf: never, (m,)."""
        limit = np.full(len(length), np.inf)
        if self.rupture_elongation is not None:
            limit = np.minimum(limit, self.rupture_elongation)
        if self.rupture_strain is not None:
            limit = np.minimum(limit, self.rupture_strain * length)
        return limit


class Anchorage(Table):
    """How bolts hold on to rock, and when they are installed."""

    kind: Annotated[StrictStr, RefersTo("bolt_kind")]
    """Kind: [bolt_kind.NAME]."""
    anchorage: Literal["ends", "grouted"] = "ends"
    """ends: one spring between head and toe; grouted: one for every joint that it crosses."""
    free_length: Length | None = None
    """Length on each side of a joint along which a grouted bolt is free, m."""
    pretension_is: Literal["initial", "jacked"] = "initial"
    """initial: changes with movement from the start; jacked: a jack holds it until a later stage
    begins, or to the end of the run.
    """
    stage: StrictStr | None = None
    """Stage that installs it; it exists from the start if absent."""

    WHEN: ClassVar = {"anchorage": {"grouted": ("free_length",)}}
    BASIC: ClassVar = ("anchorage", "free_length", "stage")

    @model_validator(mode="after")
    def _has_a_free_length(self) -> Self:
        if self.anchorage == "grouted" and self.free_length is None:
            remedy = (
                "give the free length on each side of a joint, m, e.g. a few diameters: "
                "free_length = 0.1"
            )
            raise refusal("free_length is missing", remedy)
        if self.anchorage == "ends" and self.free_length is not None:
            raise refusal(
                "a bolt anchored at its ends has no free_length: it is free over its whole length",
                'leave it out, or anchorage = "grouted"',
            )
        return self


class Bolt(Anchorage):
    """A bolt between two points, which move with their blocks."""

    name: StrictStr | None = None
    """Name; its number if absent."""
    start: Point
    """Head [x, y], in a block or on its face, m."""
    end: Point
    """Other end [x, y], in another block, m."""
    blocks: tuple[StrictStr, StrictStr] | None = None
    """Blocks of both ends, the head first; needed only where blocks touch."""

    @model_validator(mode="after")
    def _is_a_line(self) -> Self:
        check_length(self.start, self.end)
        if self.anchorage == "grouted" and self.blocks is not None:
            what = "a grouted bolt is bonded to every block along it"
            raise refusal(what, 'leave blocks out; they are for anchorage = "ends"', "blocks")
        return self


class BoltPattern(Anchorage):
    """Bolts round an opening, radial from its centroid."""

    name: StrictStr | None = None
    """Name of the pattern and its bolts; that of the opening if absent."""
    opening: Annotated[Loop | StrictStr, OR_TEXT]
    """Name of an [[opening]], or corners [x, y] of one, m."""
    length: Annotated[Length, Extends("length", "opening")]
    """Length of each bolt, m."""
    spacing: Annotated[Length, Extends("along", "opening")]
    """Distance of the heads along the wall, m."""
    from_: Annotated[Degrees, Extends("direction", "opening")] = Field(0.0, alias="from")
    """First direction, degrees, counter-clockwise from +x."""
    to: Annotated[Degrees, Extends("direction", "opening")] = 360.0
    """Last direction, degrees; both ends keep half of the remaining spacing."""

    @model_validator(mode="after")
    def _is_part_of_an_outline(self) -> Self:
        if not 0.0 < self.to - self.from_ <= 360.0:
            what = f"from {self.from_:g} to {self.to:g} degrees is not part of an outline"
            remedy = "give from below to, counter-clockwise from +x, at most 360 degrees apart"
            raise refusal(what, remedy)
        return self

    def label(self, number: int) -> str:
        """Return how a message calls it; its number is from 1."""
        return f"bolt pattern {number}"

    def group(self, number: int) -> str:
        """Return the name of the pattern: its own, that of its opening, or its number."""
        if self.name is not None:
            return self.name
        return self.opening if isinstance(self.opening, str) else self.label(number)


class Directions(Table):
    """Directions of a pattern in a script, where ``from`` is no name."""

    angles: tuple[Degrees, Degrees] = (0.0, 360.0)
    """First and last direction, degrees, counter-clockwise from +x."""


def with_directions(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a pattern of a script: ``angles`` are the first and the last direction."""
    if "angles" not in keys:
        return keys
    given = {key: value for key, value in keys.items() if key != "angles"}
    try:
        first, last = keys["angles"]
    except (TypeError, ValueError):
        return {**given, "from": keys["angles"]}  # which is refused as no number
    return {**given, "from": first, "to": last}
