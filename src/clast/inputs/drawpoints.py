"""[[drawpoint]]: lines past which blocks leave while the run goes on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import StrictStr

from clast.errors import ModelError, shortened
from clast.inputs.declaring.table import Ends, Positive, Table
from clast.model.drawpoints import Drawpoint
from clast.model.model import Floats
from clast.model.ranges import check_names


class DrawpointTable(Table):
    """A line past which blocks are taken out while the run goes on."""

    name: StrictStr
    """Name."""
    line: Ends
    """Its ends [[x, y], [x, y]], m: blocks leave once their centroid has come from its left side to
    its right, seen from the first point to the second."""
    rate: Positive | None = None
    """Mass taken out per second and metre of depth at most, kg/(s m); whatever comes if absent."""
    stage: StrictStr | None = None
    """Stage from which on it draws; the start of the run if absent."""


def drawpoints_in(tables: Sequence[DrawpointTable], origin: Floats) -> tuple[Drawpoint, ...]:
    """Return the drawpoints of a model about its ``origin`` (2,), m.  Raises ModelError."""
    check_names("drawpoint", [one.name for one in tables])
    for one in tables:
        if one.line[0] == one.line[1]:
            raise ModelError(
                "begins and ends at the same point",
                where=f"drawpoint '{shortened(one.name)}', line",
                remedy="give its two ends, the blocks coming from its left",
            )
    return tuple(
        Drawpoint(
            name=one.name,
            line=np.array(one.line) - origin,
            rate=np.inf if one.rate is None else one.rate,
            stage=one.stage or "",
        )
        for one in tables
    )
