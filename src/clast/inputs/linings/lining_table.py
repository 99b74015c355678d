"""[[lining]]: shotcrete, rings, segments, arches of steel, plates on a face."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Length, Loop, Point, Positive, Strength, Table
from clast.inputs.declaring.validation_messages import Fault, refusal
from clast.model import ranges

End = Literal["free", "hinged", "clamped"]
WEAKEST = 1e-6
"""Strength, in units of the modulus, below which it looks like another unit."""


class Lining(Table):
    """A lining of stiff segments along an opening, an outer edge or a polyline.

    Between segments, at the middle of the thickness, are the springs of a beam.
    """

    name: StrictStr
    """Name; its segments are blocks called NAME/1, NAME/2, ..."""
    opening: StrictStr | None = None
    """Opening that it lines on the inside."""
    outer_edge: tuple[Point, Point] | None = None
    """Two points [x, y] on the outside of the blocks, which it follows from one to the other, m."""
    polyline: Loop | None = None
    """Points [x, y] that it follows, m; it is closed if the last equals the first."""
    part: tuple[Point, Point] | None = None
    """With opening: it begins at the first point and ends at the second, counter-clockwise, m."""
    side: Literal["left", "right", "middle"] | None = None
    """With polyline: its side, looking along it; if absent, that of the rock, else left."""
    closed: StrictBool | None = None
    """False: the last segment is not joined to the first; as the line if absent."""
    thickness: Length
    """Thickness, m."""
    segment: Length
    """Length of a segment, m; between corners it is rounded to a whole number of segments."""
    young: Annotated[Positive, within(ranges.STRESS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(ge=0.0, lt=0.5)] = 0.2
    """Poisson's ratio."""
    density: Annotated[Positive, within(ranges.DENSITY)] = 2400.0
    """Density, kg/m3."""
    tension: Strength | None = None
    """Tensile strength, Pa; with compression; it is elastic if both are absent."""
    compression: Annotated[Positive, within(ranges.STRESS)] | None = None
    """Compressive strength, Pa."""
    joint: StrictStr | None = None
    """Joint to the rock, [joint.NAME]: strength and stiffness of the bond."""
    start: End = "free"
    """Support of its first end by the ground, which is no block."""
    end: End = "free"
    """Support of its last end by the ground."""
    stage: StrictStr | None = None
    """Stage that installs it, free of stress, on the outline at that time; it exists from the start
    if absent.
    """

    @model_validator(mode="after")
    def _follows_one_line(self) -> Self:
        given = [key for key in ("opening", "outer_edge", "polyline") if getattr(self, key)]
        if len(given) != 1:
            what = f"follows {' and '.join(given)}" if given else "has no line to follow"
            remedy = 'give one of opening = "NAME", outer_edge = [[x, y], [x, y]] and polyline'
            raise refusal(Fault(what=what, remedy=remedy))
        belongs = {"part": "opening", "side": "polyline"}
        for key, line in belongs.items():
            if getattr(self, key) is not None and given != [line]:
                what, remedy = f"{key} is that of a lining along {_article(line)}", "leave it out"
                raise refusal(Fault(place=(key,), what=what, remedy=remedy))
        for key in ("outer_edge", "part"):
            points = getattr(self, key)
            if points is not None and points[0] == points[1]:
                what, remedy = "begins and ends at the same point", "give two distinct points"
                raise refusal(Fault(place=(key,), what=what, remedy=remedy))
        return self

    @model_validator(mode="after")
    def _is_open_or_closed(self) -> Self:
        points = self.polyline
        if points is not None:
            apart = np.hypot(*np.diff(np.array(points, float).reshape(-1, 2), axis=0).T)
            if len(points) < 2 or not apart.all():
                what = "has fewer than two points" if len(points) < 2 else "has a point twice"
                remedy = "give distinct points [x, y], m"
                raise refusal(Fault(place=("polyline",), what=what, remedy=remedy))
        if self.closed and not self.is_ring:
            what = "is closed, but its line is open"
            remedy = "repeat the first point at the end of polyline, or leave closed out"
            raise refusal(Fault(place=("closed",), what=what, remedy=remedy))
        ring = self.is_ring and self.closed is not False
        for key in ("start", "end"):
            if ring and getattr(self, key) != "free":
                what, remedy = "a closed lining has no ends", f"leave {key} out, or closed = false"
                raise refusal(Fault(place=(key,), what=what, remedy=remedy))
        return self

    @model_validator(mode="after")
    def _has_sensible_numbers(self) -> Self:
        if (self.tension is None) != (self.compression is None):
            key = "tension" if self.tension is None else "compression"
            what = f"{key} is missing: a section needs both strengths"
            remedy = "give it in Pa (tension = 0 for plain concrete), or neither: it is elastic"
            raise refusal(Fault(place=(key,), what=what, remedy=remedy))
        if self.thickness > self.segment:
            what = f"{self.thickness:g} m is more than the length of a segment, {self.segment:g} m"
            remedy = "give longer segments: a beam segment is longer than it is thick"
            raise refusal(Fault(place=("thickness",), what=what, remedy=remedy))
        strength = self.compression
        if strength is not None and strength < WEAKEST * self.young:
            what = f"{strength:g} looks like another unit than that of young, {self.young:g}"
            remedy = f"if these are MPa and Pa, write {strength * 1e6:g}"
            raise refusal(Fault(place=("compression",), what=what, remedy=remedy))
        if self.tension and self.compression and self.tension > self.compression:
            what = "is more than the compressive strength"
            remedy = "give a tension of about a tenth of compression, both in Pa"
            raise refusal(Fault(place=("tension",), what=what, remedy=remedy))
        return self

    @property
    def is_ring(self) -> bool:
        """Whether its line comes back to where it begins."""
        if self.polyline is not None:
            return len(self.polyline) > 3 and self.polyline[0] == self.polyline[-1]
        return self.opening is not None and self.part is None

    @property
    def joins_ends(self) -> bool:
        """Whether the last segment is joined to the first."""
        return self.is_ring and self.closed is not False


def _article(line: str) -> str:
    return "an opening" if line == "opening" else f"a {line}"
