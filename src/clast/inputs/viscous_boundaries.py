"""[[viscous_boundary]]: outer edges through which waves leave the model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, StrictStr, model_validator

from clast.case.tables.acting.in_situ import Side
from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.choices import Number, within
from clast.inputs.declaring.faults import Fault, refusal
from clast.inputs.declaring.table import Instant, Loop, Point, Table
from clast.inputs.declaring.writing import as_plain, table_of
from clast.inputs.placing.viscous_boundaries import ViscousBoundary
from clast.model import ranges

Multiple = Annotated[Number, Field(ge=0.0), within(ranges.FACTOR)]


class WhereTable(Table):
    """Where a viscous boundary is: one of these."""

    side: Side | None = None
    """Side of the box around all blocks: all edges on it."""
    edges: list[tuple[Point, Point]] | None = None
    """Straight lines [[p, q], ...] along outer edges: all edges on them."""
    polygon: Loop | None = None
    """Polygon: all outer edges with their middle in it."""

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        if len(self.model_fields_set) != 1:
            given = " and ".join(sorted(self.model_fields_set)) or "nothing"
            remedy = 'give one of side = "bottom", edges = [[p, q], ...] and polygon = [...]'
            raise refusal(Fault(what=f"says where by {given}", remedy=remedy))
        return self


class ViscousBoundaryTable(Table):
    """Dashpots on outer edges, in the place of the rock beyond: waves leave, few come back.

    On an edge act -normal rho c_p v_n and -tangential rho c_s v_t, with rho, c_p and c_s of the
    block behind it.
    """

    where: WhereTable
    """Which edges: {side = "bottom"}, {edges = [[p, q], ...]} or {polygon = [...]}."""
    normal: Multiple = 1.0
    """Multiple of rho c_p; 0: free along the normal."""
    tangential: Multiple = 1.0
    """Multiple of rho c_s; 0: free along the edge."""
    static: Literal["hold", "none"] = "hold"
    """What springs bear when the dashpots begin stays as a traction, "hold", or goes, "none"."""
    begins: Annotated[Instant, Field(ge=0.0)] = 0.0
    """Time, s, from which the dashpots act; springs as stiff as those of fixed points hold the
    edges before it, in the directions that have dashpots."""
    stage: StrictStr | None = None
    """Stage with which the dashpots begin, in the place of begins."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the boundary."""
        own = {name: value for name, value in self if name != "where"}
        builder.viscous_boundary(**dict(self.where), **own)


def viscous_keys(given: ViscousBoundary) -> dict[str, object]:
    """Return the table of a boundary of a script."""
    where = {
        key: as_plain(getattr(given, key))
        for key in ("side", "edges", "polygon")
        if getattr(given, key) is not None
    }
    names = ("normal", "tangential", "static", "begins", "stage")
    return {
        "where": where,
        **table_of(ViscousBoundaryTable, {key: getattr(given, key) for key in names}),
    }
