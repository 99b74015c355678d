"""[geometry] and [[block]]: the blocks, by numbered vertices and by coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np
from pydantic import StrictBool, StrictInt, StrictStr, model_validator

from clast.case.faults import SHOWN, Fault, refusal
from clast.case.tables.table import Loop, Motion, Stresses, Table
from clast.model.builder import ModelBuilder


class LoopTable(Table):
    """A block as a loop of numbered vertices."""

    loop: list[StrictInt]
    """Numbers of its vertices, from 1, counter-clockwise."""
    name: StrictStr | None = None
    """Name; the block's number if absent."""
    rock: StrictStr | None = None
    """Rock; may be left out where there is only one."""
    fixed: StrictBool = False
    """True for a block that cannot move at all."""
    velocity: Motion = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Stresses | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""
    edge_joint: list[StrictStr] | None = None
    """Joint of the edge from each vertex to the next, one name a vertex; "" for none of its own."""


class GeometryTable(Table):
    """Blocks by numbered vertices."""

    vertices: Loop
    """Coordinates [x, y] of all vertices, m; the first is number 1."""
    blocks: list[LoopTable]
    """Blocks as counter-clockwise loops of vertex numbers; others are turned round."""

    @model_validator(mode="after")
    def _vertices_exist(self) -> Self:
        count = len(self.vertices)
        faults = [
            Fault(
                place=("blocks", number, "loop", position),
                what=f"there is no vertex {vertex}",
                remedy=f"vertices are numbered from 1 to {count}",
            )
            for number, block in enumerate(self.blocks)
            for position, vertex in enumerate(block.loop)
            if not 1 <= vertex <= count
        ]
        if faults:
            raise refusal(*faults)
        return self

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say which vertices belong to no block."""
        used = {vertex for block in self.blocks for vertex in block.loop}
        idle = [k for k in range(1, len(self.vertices) + 1) if k not in used]
        if idle:
            shown = ", ".join(map(str, idle[:SHOWN])) + (", ..." if len(idle) > SHOWN else "")
            yield (
                f"[geometry] {len(idle)} of {len(self.vertices)} vertices belong to no block: "
                f"{shown}. Is a loop missing?"
            )

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the blocks."""
        vertices = np.array(self.vertices, np.float64).reshape(-1, 2)
        for block in self.blocks:
            values = {name: value for name, value in block if name != "loop"}
            loop = np.array(block.loop, np.int64)
            builder.block(vertices=vertices[loop - 1], **values)


class BlockTable(Table):
    """A block by its coordinates."""

    vertices: Loop
    """Coordinates [x, y] of its vertices, counter-clockwise, m."""
    name: StrictStr | None = None
    """Name; the block's number if absent."""
    rock: StrictStr | None = None
    """Rock; may be left out where there is only one."""
    fixed: StrictBool = False
    """True for a block that cannot move at all."""
    velocity: Motion = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise."""
    initial_stress: Stresses | None = None
    """Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent."""
    edge_joint: list[StrictStr] | None = None
    """Joint of the edge from each vertex to the next, one name a vertex; "" for none of its own."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the block."""
        builder.block(**dict(self))
