"""The case file of finished blocks: put together where they nearly touch, kept beside the case.

    found = put_together(read_blocks("wall.dxf"))
    text = blocks_text(found, "wall.npz")

As of a drawing, quantities that the blocks lack (moduli, strengths, times) stand as "to be given".
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.case.comments import TO_BE_GIVEN, comment, listed
from clast.errors import ModelError
from clast.inputs.declaring.text import to_toml
from clast.model.arrays import following
from clast.model.checks import BlockOutlines, check_polygons
from clast.model.surroundings import Repair
from clast.rockmass import CONSTRUCTION, WELDED, repaired
from clast.rockmass.drawings.block_arrays import Blocks
from clast.rockmass.repair import repairs_of

SHARE = 1e-2
"""Tolerance as a share of the median edge where none is given."""
MOST = 1.5e-3
"""Largest such tolerance, m: corners rounded to millimetres lie sqrt(2) of them apart at most."""


@dataclass(frozen=True, kw_only=True)
class DrawnBlocks:
    """Blocks of a file that touch where they are meant to."""

    file: str
    """The file."""
    blocks: Blocks
    """The blocks, counter-clockwise, with notes and omissions."""
    tolerance: float
    """Distance within which they were put together, m."""
    repairs: tuple[Repair, ...]
    """The repairs, each with its first places."""
    largest_movement: float
    """How far a vertex moved at most, m."""

    def as_dict(self) -> dict[str, Any]:
        """Return the imported parts and all changes, for JSON."""
        rocks = self.blocks.rock
        return {
            "file": self.file,
            "blocks": self.blocks.count,
            "rocks": {name: rocks.count(name) for name in dict.fromkeys(rocks)},
            "joints": joints_of(self.blocks),
            "tolerance": self.tolerance,
            "largest_movement": self.largest_movement,
            "repairs": [dataclasses.asdict(one) for one in self.repairs],
            "notes": list(self.blocks.notes),
            "left_out": [str(one) for one in self.blocks.left_out],
        }


def put_together(blocks: Blocks, file: str | Path, tolerance: float | None = None) -> DrawnBlocks:
    """Return the blocks of a file put together within a tolerance, m.

    It is SHARE of the median edge if absent, MOST at most.  Raises ModelError for blocks that are
    no polygons, and where putting them together would spoil one.
    """
    start = blocks.block_start
    edges = np.hypot(*(blocks.vertices[following(start)] - blocks.vertices).T)
    if tolerance is None:
        tolerance = min(SHARE * float(np.median(edges)), MOST)
    try:
        found = repaired(blocks.vertices, start, tolerance)
        names = tuple(map(str, range(1, blocks.count + 1)))
        origin = np.floor(found.vertices.min(axis=0))
        outlines = BlockOutlines(names, found.start, found.vertices - origin, origin)
        check_polygons(outlines, outlines.polygons())
    except ModelError as error:
        where = f"{file}: {error.where}".replace("repair, tolerance", "--tolerance")
        raise ModelError(error.what, where=where, remedy=error.remedy) from None
    joints = tuple(blocks.edge_joint[k] for k in found.edge.tolist())
    return DrawnBlocks(
        file=str(file),
        blocks=dataclasses.replace(
            blocks, vertices=found.vertices, block_start=found.start, edge_joint=joints
        ),
        tolerance=tolerance,
        repairs=repairs_of(found.report),
        largest_movement=found.report.largest_movement,
    )


def joints_of(blocks: Blocks) -> list[str]:
    """Return the names of the joints of edges, sorted, without welds."""
    names = {name for name in blocks.edge_joint if name and name != WELDED}
    return sorted(name for name in names if not name.startswith(CONSTRUCTION))


def blocks_text(drawn: DrawnBlocks, block_file: str) -> str:
    """Return the text of a case file (TOML) whose blocks stand in another file beside it."""
    unknown = dict.fromkeys(("young", "poisson", "density"), TO_BE_GIVEN)
    joints = {name: {"friction_angle": TO_BE_GIVEN} for name in joints_of(drawn.blocks)}
    head = [
        *comment(f"From {drawn.file}. Lengths are metres."),
        *comment(f'Keys with "{TO_BE_GIVEN}" need a number before the case can run.'),
        *listed(f"Put together within {drawn.tolerance:g} m:", map(str, drawn.repairs)),
        *listed("Taken otherwise than given:", drawn.blocks.notes),
        *listed("Not taken over:", map(str, drawn.blocks.left_out)),
    ]
    title = spelling.visible(Path(drawn.file).stem[:200])
    parts = [
        "\n".join(head),
        to_toml({"schema": 1, "title": title}),
        to_toml({"time": {"step": TO_BE_GIVEN, "end": TO_BE_GIVEN}}),
        to_toml({"rock": {name: unknown for name in dict.fromkeys(drawn.blocks.rock)}}),
        to_toml({"joint": joints}) if joints else "",
        to_toml({"block_file": [{"file": block_file}]}),
    ]
    return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"
