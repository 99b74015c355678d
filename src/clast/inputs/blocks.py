"""[geometry], [[block]], [[block_file]], [repair]: the blocks, and how they are put together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
from pydantic import Field, StrictBool, StrictInt, StrictStr, model_validator

from clast import spelling
from clast.errors import FAULTS_LISTED_MAX, Fault, ModelError, shortened
from clast.inputs.declaring.builder_methods import record_of
from clast.inputs.declaring.table import Length, Loop, Motion, Point, Stresses, Table
from clast.inputs.declaring.text import asked_by
from clast.inputs.declaring.validation_messages import refusals
from clast.model.model import Bools, Floats

if TYPE_CHECKING:
    from clast.rockmass.drawings.block_arrays import Blocks


class Corners(Table):
    """Where a block is, by coordinates."""

    vertices: Loop
    """Coordinates [x, y] of its vertices, counter-clockwise, m."""


class Numbers(Table):
    """Where a block is, by numbers of vertices."""

    loop: list[StrictInt]
    """Numbers of its vertices, from 1, counter-clockwise."""


class Properties(Table):
    """Properties of a block, wherever it is."""

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
    """Joint of the edge from each vertex to the next, one name per vertex; "" for none."""


class BlockTable(Properties, Corners):
    """A block by its coordinates."""

    def add_to(self, builder: Any, key: str, folder: Path) -> str:
        """Add the block and return its name."""
        name: str = builder.add_block(self)
        return name


class LoopTable(Properties, Numbers):
    """A block as a loop of numbered vertices."""

    def block(self, vertices: Floats) -> BlockTable:
        """Return the block, with the coordinates of its vertices, m, of all (nv, 2)."""
        corners = vertices[np.array(self.loop, np.int64) - 1]
        # what the loop and the vertices can be is judged already
        values: dict[str, Any] = {"vertices": corners.tolist()}
        return BlockTable.model_construct(**values, **self.model_dump(exclude={"loop"}))


class GeometryTable(Table):
    """Blocks by numbered vertices."""

    vertices: list[Point]
    """Coordinates [x, y] of all vertices, m; the first is number 1."""
    blocks: list[LoopTable]
    """Blocks as counter-clockwise loops of vertex numbers; clockwise ones are reversed."""

    @model_validator(mode="after")
    def _vertices_exist(self) -> Self:
        count = len(self.vertices)
        faults = [
            Fault(
                f"there is no vertex {vertex}",
                f"vertices are numbered from 1 to {count}",
                ("blocks", number, "loop", position),
            )
            for number, block in enumerate(self.blocks)
            for position, vertex in enumerate(block.loop)
            if not 1 <= vertex <= count
        ]
        if faults:
            raise refusals(faults)
        return self

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say which vertices belong to no block."""
        used = {vertex for block in self.blocks for vertex in block.loop}
        idle = [k for k in range(1, len(self.vertices) + 1) if k not in used]
        if idle:
            shown = ", ".join(map(str, idle[:FAULTS_LISTED_MAX])) + (
                ", ..." if len(idle) > FAULTS_LISTED_MAX else ""
            )
            yield (
                f"[geometry] {len(idle)} of {len(self.vertices)} vertices belong to no block: "
                f"{shown}. Check for a missing loop."
            )

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Add the blocks."""
        vertices = np.array(self.vertices, np.float64).reshape(-1, 2)
        for block in self.blocks:
            block.block(vertices).add_to(builder, key, folder)


class BlockFileTable(Table):
    """Blocks of a file beside the case file."""

    file: StrictStr
    """Archive (.npz), table (.csv with block, x, y, and joint and rock if wanted), drawing (.dxf:
    one closed line per block), or a block file of Shi's programs.
    """
    layer: StrictStr | None = None
    """Layer of a DXF drawing with the blocks; if absent, all but JOINTS, which name the rocks."""
    unit: StrictStr | None = None
    """Unit of a DXF drawing: m, cm, mm, km, in or ft; that of its header if absent."""
    rock: StrictStr | None = None
    """Rock of all of them; the rocks named in the file if absent."""
    fixed: list[Annotated[StrictInt, Field(ge=1)]] = Field([])
    """Numbers in the file, from 1, of blocks that cannot move at all."""
    fixed_layers: list[StrictStr] = Field([])
    """Layers of a DXF drawing whose blocks cannot move at all."""

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Add the blocks, with joints that hold where edges are welded."""
        from clast.rockmass import CONSTRUCTION, WELDED
        from clast.rockmass.drawings.dxf import DxfReading
        from clast.rockmass.readers import BlockReading, read_blocks

        with asked_by("block_file"):
            reading = BlockReading(dxf=DxfReading(unit=self.unit), layer=self.layer)
            blocks = read_blocks(folder / self.file, reading)
        beyond = [number for number in self.fixed if number > blocks.count]
        if beyond:
            what = f"there is no block {beyond[0]}"
            remedy = f"the file has {blocks.count} blocks, numbered from 1"
            raise ModelError(what, where=f"block_file '{self.file}', fixed", remedy=remedy)
        held = np.isin(np.arange(1, blocks.count + 1), self.fixed)
        held |= on_layers(blocks, self.fixed_layers, f"block_file '{self.file}', fixed_layers")
        for name in sorted(set(blocks.edge_joint)):
            if name == WELDED or name.startswith(CONSTRUCTION):
                builder.add_weld(name)
        builder.notes += [f"{self.file}: {note}" for note in blocks.notes]
        builder.notes += [
            f"{self.file}: left out: {one}" for one in blocks.left_out[:FAULTS_LISTED_MAX]
        ]
        builder.blocks(
            vertices=blocks.vertices,
            start=blocks.block_start,
            names=_free_names(blocks.name, builder.block_names(), Path(self.file).stem),
            rock=list(blocks.rock) if self.rock is None else self.rock,
            fixed=held,
            edge_joint=blocks.edge_joint,
        )


def on_layers(blocks: Blocks, layers: Sequence[str], where: str) -> Bools:
    """Return True for blocks on some layers, case-blind, shape (nb,); refuse layers of none."""
    own = [layer.casefold() for layer in blocks.layer]
    if layers and not own:
        remedy = "name the blocks by their numbers: fixed = [1, 2]"
        raise ModelError("the file has no layers", where=where, remedy=remedy)
    for layer in layers:
        if layer.strip().casefold() not in own:
            what = f"no block is on a layer '{shortened(layer)}'"
            remedy = spelling.advice(layer, dict.fromkeys(blocks.layer), kind="layer")
            raise ModelError(what, where=where, remedy=remedy)
    asked = {layer.strip().casefold() for layer in layers}
    return np.array([layer in asked for layer in own] or [False] * blocks.count, np.bool_)


def _free_names(names: Sequence[str], taken: Sequence[str], file: str) -> list[str] | None:
    """Return the names of blocks, with that of their file before them where one is taken."""
    if not names:
        return None
    return [f"{file}-{one}" for one in names] if set(names) & set(taken) else list(names)


class RepairTable(Table):
    """Repair of blocks, from whichever table, that were drawn slightly apart."""

    tolerance: Length
    """Largest gap or overlap of corners and edges that should coincide, m: vertices within it are
    merged, or moved onto the edge of another block; none moves further.
    """

    @classmethod
    def keys_of(cls, value: Any) -> dict[str, Any] | None:
        """Return the keys that make the repair of a script."""
        from clast.rockmass.repair import BlockRepair

        return {"tolerance": value.tolerance} if type(value) is BlockRepair else None

    @classmethod
    def judge(cls, value: Any, key: str) -> None:
        """Refuse an object that cannot repair blocks, and an invalid tolerance."""
        keys = cls.keys_of(value)
        if keys is not None:
            record_of(cls, keys, (key,))
        elif not callable(value) or isinstance(value, type):
            what = f"{shortened(repr(value))} does not describe a repair"
            remedy = "give the keys of [repair], or clast.rockmass.BlockRepair(tolerance=1e-3)"
            raise ModelError(what, where=key, remedy=remedy)

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Have the builder put its blocks together."""
        from clast.rockmass.repair import BlockRepair

        builder.repair = BlockRepair(tolerance=self.tolerance)
