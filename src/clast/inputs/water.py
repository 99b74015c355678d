"""[[water]]: water that presses on outer faces and in joints."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, StrictStr, Tag, model_validator

from clast.errors import CaseError, ModelError
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Coordinate, Inputs, Loop, Point, Table
from clast.inputs.declaring.validation_messages import PLAIN, TABLE, Fault, kind_of, refusal
from clast.model import ranges

LIGHTEST = 100.0
"""Densities below are not kg/m3."""
UNITS = ((0.1, 3.0, "t/m3 or g/cm3", 1000.0), (3.0, 30.0, "kN/m3", 1000.0 / 9.81))
"""Ranges of density in other units, and the factors that convert them."""
SHARE = "give a share of the full head from 0 to 1, or the name of an amplitude of such shares"


class LineFile(Table):
    """A phreatic line in a file beside the case file."""

    file: StrictStr
    """Table with the columns x, y and a row for each point (.csv), beside the case file."""


def _kind_of_share(value: Any) -> str:
    """Return the tag of a share: a number, or the name of an amplitude."""
    return TABLE if isinstance(value, str) else PLAIN


class Water(Table):
    """Water that presses on all edges below its surface, and follows the blocks."""

    name: StrictStr | None = None
    """Name by which stages refer to it."""
    level: Coordinate | None = None
    """Height y of a horizontal surface, m; or give a line."""
    line: (
        Annotated[
            Annotated[Loop, Tag(PLAIN)] | Annotated[LineFile, Tag(TABLE)],
            Discriminator(kind_of),
        ]
        | None
    ) = None
    """Points [x, y] of a phreatic line, m, or {file = "line.csv"}; it is horizontal beyond its
    ends.
    """
    acts_on: Literal["faces", "joints", "both"] = "both"
    """Surfaces it presses on: "faces": edges that no other block covers; "joints": both faces where
    blocks lie along each other; "both"."""
    density: Annotated[Number, within(ranges.DENSITY)] = 1000.0
    """Density, kg/m3."""
    joints: list[StrictStr] | None = None
    """Joints that it enters, by name; all if absent."""
    amplitude: Annotated[
        Annotated[Number, Tag(PLAIN)] | Annotated[StrictStr, Tag(TABLE)],
        Discriminator(_kind_of_share),
    ] = 1.0
    """Share of the full head, 0 to 1; or the [amplitude.NAME] of such shares: water that rises."""
    drained_at: list[Point] = Field([])
    """Points [x, y] of joints where there is no pressure, m; along the joints it falls towards
    them."""
    wetted: Literal["open-and-closed", "closed"] = "open-and-closed"
    """Whether a joint that opens keeps its pressure, or loses it ("closed")."""

    @model_validator(mode="after")
    def _has_one_surface(self) -> Self:
        if (self.level is None) == (self.line is None):
            what = "has neither level nor line" if self.level is None else "has both level and line"
            remedy = "give the level y of a horizontal surface, or the points of a phreatic line"
            raise refusal(Fault(what=what, remedy=remedy))
        return self

    @model_validator(mode="after")
    def _has_a_density(self) -> Self:
        remedy = "give it in kg/m3: 1000 for water, 1025 for the sea"
        for low, high, unit, factor in UNITS:
            if low <= self.density < high:
                what = f"{self.density:g} looks like {unit}, but densities are in kg/m3"
                remedy = f"write {self.density * factor:.4g}; the weight follows from gravity"
                raise refusal(Fault(place=("density",), what=what, remedy=remedy))
        if not self.density > 0.0:
            what = f"{self.density:g} is not a valid density"
            raise refusal(Fault(place=("density",), what=what, remedy=remedy))
        if self.density < LIGHTEST:
            what = f"{self.density:g} kg/m3 is not the density of a liquid"
            raise refusal(Fault(place=("density",), what=what, remedy=remedy))
        return self

    @model_validator(mode="after")
    def _suits_what_it_acts_on(self) -> Self:
        if not isinstance(self.amplitude, str) and not 0.0 <= self.amplitude <= 1.0:
            what = f"{self.amplitude:g} is not a valid share"
            raise refusal(Fault(place=("amplitude",), what=what, remedy=SHARE))
        if self.acts_on == "faces" and (self.joints is not None or self.drained_at):
            what = "names joints or drains, but the water acts on outer faces only"
            remedy = 'give acts_on = "joints" or "both", or remove joints and drained_at'
            raise refusal(Fault(what=what, remedy=remedy))
        return self

    def add_to(self, builder: Inputs, key: str, folder: Path) -> None:
        """Add the water, with the line of a file."""
        whole = self
        if isinstance(self.line, LineFile):
            whole = self.model_copy(update={"line": _points(folder / self.line.file)})
        builder.add(whole, key)


def _points(path: Path) -> list[tuple[float, float]]:
    """Return the points of a phreatic line in a file, m."""
    from clast.rockmass.drawings.csv_lines import table_of

    try:
        table = table_of(path)
        for column in ("x", "y"):
            if column not in table.columns:
                raise CaseError(
                    f"has no column {column}",
                    where=f"{table.file}: its heading",
                    remedy="a phreatic line has the heading x,y and a row for each point",
                )
        return [(row.number("x"), row.number("y")) for row in table.rows]
    except CaseError as error:
        place = f"[[water]], line: {error.where}"
        raise ModelError(error.what, where=place, remedy=error.remedy) from None
