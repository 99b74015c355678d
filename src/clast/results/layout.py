"""The layout of a result file: HDF5, with the blocks as VTKHDF so that ParaView opens it.

    /VTKHDF        temporal UnstructuredGrid, one polygon per block, one step per frame:
                   Points, PointData and CellData of all frames one after the other;
                   Connectivity, Offsets and Types once, used by every frame through Steps
    /frames        table, a row per frame: time, and how many rows of the tables below belong to
                   the frames until then
    /frame_stage   number of the stage of each frame, from 0; only where the run has stages, whose
                   names are in about of /model
    /contacts      table, a row per contact that carries a force, frame after frame
    /history/NAME  table, a row per instant (the start and every step) of a measured point
    /bolts         table, a row per instant: force, elongation and state of each rock bolt; only
                   where there are any, as are the bolt_* of /model
    /bolt_points   points that the bolts lie along, m, frame after frame
    /energy        table, a row per instant: time and the entries of the energy ledger
    /steps         table, a row per step: time, size, passes, contacts, penetration, travel
    /model         the case file's text, how it is simulated (about, JSON), versions, names and
                   numbers of the blocks, names of the joints and the joint of each edge; water
                   and what it wets
    /report        how the run went; only in a file that was finished

The attribute ``runs`` of the file says which runs have written it (``checkpoints.lineage``).

A frame counts once ``NSteps`` of /VTKHDF/Steps says so, which is written after its data have
reached the file; a process killed at any moment leaves all frames before readable.  Behind the
end of HDF5's part there are checksums of it (``clast.results.pages``), and after a kill there
may be a journal (``clast.results.journal``), which clast reads in place of what it changes.
Arrays and tables are compressed and have HDF5's own checksums for viewers.  In names of points that
name a dataset "%" and "/" stand as %25 and %2F.
Tables are HDF5 compound datasets: ``file["energy"]["kinetic"]``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.model.state import LEDGER_ENTRIES

FORMAT = 2
"""Version of the layout outside of /VTKHDF: 1 had no checksums."""

VTKHDF_VERSION = (2, 2)
"""The first version that blesses groups of one's own beside /VTKHDF."""

POLYGON = 7
"""VTK's number for a polygonal cell."""

POINT_ARRAYS: dict[str, tuple[int, ...]] = {
    "Points": (3,),
    "PointData/displacement": (3,),
}
"""Arrays with a row per vertex and frame: name -> shape of a row."""

CELL_ARRAYS: dict[str, tuple[int, ...]] = {
    "CellData/displacement": (3,),
    "CellData/velocity": (3,),
    "CellData/rotation": (),
    "CellData/stress": (3,),
    "CellData/sigma_1": (),
    "CellData/sigma_3": (),
    "CellData/max_shear": (),
    "CellData/gone": (),
}
"""Arrays with a row per block and frame: name -> shape of a row."""

CHUNK_ROWS = 512
"""Rows that small things share a chunk of the file with."""

MOVING = f"CellDataOffsets/{next(iter(CELL_ARRAYS)).removeprefix('CellData/')}"
"""Where the offsets of the blocks' arrays are stored; all arrays share them by hard links."""

OFFSETS = ("NumberOfParts", "PartOffsets", "CellOffsets", "PointOffsets", MOVING)
"""Datasets of offsets in /VTKHDF/Steps, written a chunk of frames at a time."""

SINCE = {"CellData/gone": "blocks could be excavated"}
"""Arrays that files of earlier versions do not have -> since when they are written."""

PLANE_VECTORS = ("displacement", "velocity")
"""Fields that VTK wants with a third component, which is zero."""

ABOUT = {
    "Points": "vertices, m",
    "PointData/displacement": "displacement of the vertex since the start or a reset, m",
    "CellData/displacement": "displacement of the centroid since the start or a reset, m",
    "CellData/velocity": "velocity of the centroid, m/s",
    "CellData/rotation": "rotation since the start or a reset, rad, counter-clockwise",
    "CellData/stress": "stress (xx, yy, xy), Pa, tension positive",
    "CellData/sigma_1": "largest principal stress in the plane, Pa, tension positive",
    "CellData/sigma_3": "smallest principal stress in the plane, Pa, tension positive",
    "CellData/max_shear": "largest shear stress in the plane, Pa",
    "CellData/gone": "1 where the block has been excavated, else 0",
    "CellData/block": "number of the block, from 0",
    "CellData/rock": "number of the rock, from 0",
    "CellData/fixed": "1 where the block cannot move",
}
"""Meaning and unit of each array, written beside it."""

FRAME_ROW = np.dtype([("time", "f8"), ("steps", "i8"), ("instants", "i8"), ("contacts", "i8")])
"""A frame: time, s, and the rows of /steps, of /energy and /history, of /contacts until then."""
FRAME_STAGE = "frame_stage"
"""Numbers of the stages of the frames."""

ENERGY_ROW = np.dtype([("time", "f8"), *((name, "f8") for name in LEDGER_ENTRIES)])
"""Time and every entry of the energy ledger."""

STEP_ROW = np.dtype(
    [
        ("time", "f8"),
        ("step", "f8"),
        ("passes", "i8"),
        ("contacts", "i8"),
        ("penetration", "f8"),
        ("travel", "f8"),
    ]
)
"""Time at the end of a step, its size, passes, contacts, penetration, largest vertex movement."""

POINT_ROW = np.dtype(
    [("time", "f8"), ("displacement", "f8", 2), ("velocity", "f8", 2), ("rotation", "f8")]
)
"""One measured point at one instant."""

BOLT_STATES = ("not installed", "intact", "yielded", "broken", "lost")
"""States of a bolt by their numbers; one is lost whose block is gone."""

BOLT_ROW = np.dtype([("time", "f8"), ("force", "f8"), ("elongation", "f8"), ("state", "i8")])
"""One bolt at one instant."""


def bolts_row(count: int) -> np.dtype[Any]:
    """Return the row that holds ``count`` bolts at one instant."""
    parts = [(name, BOLT_ROW[name], (count,)) for name in ("force", "elongation", "state")]
    return np.dtype([("time", "f8"), *parts])


FIRST_CONTACT_ROW = np.dtype(
    [
        ("position", "f8", 2),
        ("normal", "f8", 2),
        ("normal_force", "f8"),
        ("shear_force", "f8"),
        ("vertex", "i8"),
        ("edge", "i8"),
        ("mode", "i8"),
    ]
)
"""One contact of one frame, as the first versions wrote it: without its joint."""

CONTACT_ROW = np.dtype([*FIRST_CONTACT_ROW.descr, ("joint", "i8")])
"""One contact of one frame."""


SPECIAL = str.maketrans({sign: f"%{ord(sign):02X}" for sign in "%/"})
"""A slash would open a group; what stands for it must not be a name of its own."""


def history_path(name: str, layout: int = FORMAT) -> str:
    """Return where the history of a measured point is."""
    if layout == 1:
        return f"history/{name.replace('/', '∕')}"
    # HDF5 takes "." for the group itself, and "" for nothing; ".." is the group above for others
    dots = name.replace(".", "%2E") if set(name) <= {"."} else name.translate(SPECIAL)
    return f"history/{dots or '%'}"
