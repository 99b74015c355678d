"""[[viscous_boundary]]: outer edges through which waves leave the model."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, StrictStr, model_validator

from clast.errors import shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Instant, Loop, Point, Table
from clast.inputs.declaring.validation_messages import Fault, refusal
from clast.inputs.in_situ import Side
from clast.model import ranges

Multiple = Annotated[Number, Field(ge=0.0), within(ranges.FACTOR)]


class Where(Table):
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
            raise refusal(Fault(what=f"places it by {given}", remedy=remedy))
        return self


class ViscousBoundary(Table):
    """Dashpots on outer edges in place of the rock beyond, which absorb waves.

    On an edge act -normal rho c_p v_n and -tangential rho c_s v_t, with rho, c_p and c_s of the
    block behind it.
    """

    where: Where
    """Which edges: {side = "bottom"}, {edges = [[p, q], ...]} or {polygon = [...]}."""
    normal: Multiple = 1.0
    """Multiple of rho c_p; 0: free along the normal."""
    tangential: Multiple = 1.0
    """Multiple of rho c_s; 0: free along the edge."""
    static: Literal["hold", "none"] = "hold"
    """Forces of the springs when the dashpots begin: kept as a traction, "hold", or removed,
    "none"."""
    begins: Annotated[Instant, Field(ge=0.0)] = 0.0
    """Time, s, from which the dashpots act; springs as stiff as those of fixed points hold the
    edges before it, in the directions that have dashpots."""
    stage: StrictStr | None = None
    """Stage with which the dashpots begin, in the place of begins."""

    @model_validator(mode="after")
    def _begins_once(self) -> Self:
        if self.stage == "":
            what, remedy = (
                "'' is not the name of a stage",
                'give the name of a [[stage]], e.g. "quake"',
            )
            raise refusal(Fault(place=("stage",), what=what, remedy=remedy))
        if self.stage is not None and self.begins:
            named = shortened(self.stage)
            what = f"begins both at {self.begins:g} s and with the stage '{named}'"
            raise refusal(Fault(what=what, remedy="give begins or stage"))
        if self.normal == self.tangential == 0.0:
            what = "normal and tangential are both 0, which is a free edge"
            remedy = "leave the boundary out, or give normal = 1 and tangential = 1"
            raise refusal(Fault(what=what, remedy=remedy))
        return self


def with_where(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a boundary of a script, which says where by keys of their own."""
    given = {key: value for key, value in keys.items() if key not in Where.model_fields}
    where = {key: keys[key] for key in Where.model_fields if keys.get(key) is not None}
    return {"where": where, **given}
