"""[bolt_kind.NAME], [[bolt]], [[bolt_pattern]]: what bolts bear, and where they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, StrictBool, StrictStr

from clast import spelling
from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.choices import Number, within
from clast.inputs.declaring.faults import Fault
from clast.inputs.declaring.table import Length, Point, Positive, Table
from clast.inputs.declaring.writing import table_of
from clast.inputs.placing.bolt_patterns import PatternEntry
from clast.inputs.placing.bolts import BoltEntry
from clast.model import ranges
from clast.model.model import Model

BoltForce = Annotated[Number, Field(ge=0.0), within(ranges.FORCE)]
Degrees = Annotated[Number, Field(ge=-360.0, le=720.0)]


class BoltKindTable(Table):
    """What a kind of bolt bears; stiffness, or young, area and out_of_plane_spacing."""

    stiffness: Annotated[Positive, within(ranges.STIFFNESS)] | None = None
    """Force by elongation, N/m per m."""
    young: Annotated[Positive, within(ranges.MODULUS)] | None = None
    """Young's modulus of the bolt, Pa; with area and out_of_plane_spacing in place of stiffness."""
    area: Positive | None = None
    """Cross-section of one bolt, m2."""
    out_of_plane_spacing: Length | None = None
    """Distance between bolts along the thickness, m."""
    yield_force: Annotated[Positive, within(ranges.FORCE)] | None = None
    """Force at which it yields, N per metre of thickness; it is elastic if absent."""
    rupture_elongation: Length | None = None
    """Elongation, plastic one included, at which it breaks for good, m; never if absent."""
    rupture_strain: Annotated[Positive, within(ranges.FACTOR)] | None = None
    """The same as a share of its length, -."""
    pretension: BoltForce = 0.0
    """Force that it is installed with, N per metre of thickness."""
    compression: StrictBool = False
    """True for bars, which bear compression; cables bear none."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the kind, called ``key``."""
        builder.add_bolt_kind(key, **dict(self))


def _choices(table: BoltTable | BoltPatternTable) -> dict[str, Any]:
    """Return what the builder takes of these."""
    keys = ("anchorage", "free_length", "pretension_is", "stage")
    return {key: getattr(table, key) for key in keys}


class BoltTable(Table):
    """A bolt between two points, which move with their blocks."""

    name: StrictStr | None = None
    """Name; its number if absent."""
    start: Point
    """Head [x, y], in a block or on its face, m."""
    end: Point
    """Other end [x, y], in another block, m."""
    blocks: tuple[StrictStr, StrictStr] | None = None
    """Blocks of both ends, the head first; needed only where blocks touch."""
    kind: StrictStr
    """Kind: [bolt_kind.NAME]."""
    anchorage: Literal["ends", "grouted"] = "ends"
    """ends: one spring between head and toe; grouted: one for every joint that it crosses."""
    free_length: Length | None = None
    """Length on each side of a joint along which a grouted bolt is free, m."""
    pretension_is: Literal["initial", "jacked"] = "initial"
    """initial: changes with movement from the start; jacked: a jack holds it until a later stage
    begins, without stages to the end."""
    stage: StrictStr | None = None
    """Stage that installs it; it is there from the start if absent."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the bolt."""
        builder.bolt(
            self.start,
            self.end,
            kind=self.kind,
            blocks=self.blocks,
            name=self.name,
            **_choices(self),
        )


class BoltPatternTable(Table):
    """Bolts round an opening, radial from its centroid."""

    name: StrictStr | None = None
    """Name of the pattern, from which its bolts have theirs; that of the opening if absent."""
    opening: StrictStr
    """Name of an [[opening]]."""
    length: Length
    """Length of each bolt, m."""
    spacing: Length
    """Distance of the heads along the wall, m."""
    from_: Degrees = Field(0.0, alias="from")
    """First direction, degrees, counter-clockwise from +x."""
    to: Degrees = 360.0
    """Last direction, degrees; what the spacing leaves is left at both ends alike."""
    kind: StrictStr
    """Kind: [bolt_kind.NAME]."""
    anchorage: Literal["ends", "grouted"] = "ends"
    """ends: one spring between head and toe; grouted: one for every joint that it crosses."""
    free_length: Length | None = None
    """Length on each side of a joint along which a grouted bolt is free, m."""
    pretension_is: Literal["initial", "jacked"] = "initial"
    """initial: changes with movement from the start; jacked: a jack holds it until a later stage
    begins, without stages to the end."""
    stage: StrictStr | None = None
    """Stage that installs it; it is there from the start if absent."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the bolts."""
        builder.bolt_pattern(
            self.opening,
            kind=self.kind,
            length=self.length,
            spacing=self.spacing,
            angles=(self.from_, self.to),
            name=self.name,
            **_choices(self),
        )


def stage_faults(table: str, named: Sequence[str | None], stages: Sequence[str]) -> Iterator[Fault]:
    """Give the stages that bolts of a table name and the case does not have."""
    for number, stage in enumerate(named):
        if stage is not None and stage not in stages:
            yield Fault(
                place=(table, number, "stage"),
                what=f"there is no stage '{stage}'",
                remedy=spelling.advice(stage, stages, kind="stage"),
            )


def bolt_tables(
    bolts: Sequence[BoltEntry],
    patterns: Sequence[PatternEntry] = (),
    model: Model | None = None,
) -> list[dict[str, Any]]:
    """Return the tables of bolts, and one for each bolt that patterns have become in a model."""
    found = [
        {
            "kind": one.kind,
            "name": one.name,
            "start": one.start,
            "end": one.end,
            "blocks": one.blocks,
            **one.choices,
        }
        for one in bolts
    ]
    if model is not None:
        choices = {entry.group: entry.choices for entry in patterns}
        all_bolts = model.bolts
        at = all_bolts.at + model.origin
        for k in range(len(bolts), len(all_bolts)):
            own = np.flatnonzero(all_bolts.bolt == k)[[0, -1]]
            chosen = choices[all_bolts.group[k]]
            blocks = [model.block_name[b] for b in all_bolts.block[own]]
            found.append(
                {
                    "kind": all_bolts.kind[k],
                    "name": all_bolts.name[k],
                    "start": at[own[0]],
                    "end": at[own[1]],
                    "blocks": None if chosen.get("anchorage") == "grouted" else blocks,
                    **chosen,
                }
            )
    return [table_of(BoltTable, one) for one in found]
