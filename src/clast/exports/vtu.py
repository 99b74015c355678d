"""Frames as VTK's XML meshes: one .vtu each, plain text, and a .pvd that lists them by time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from clast.exports.targets import check_ending, check_free, frames_in, numbered
from clast.results import Recording
from clast.rockmass.drawings.drawing_files import replaced

KINDS = {"f": "Float64", "i": "Int64", "u": "UInt8"}
"""numpy's letter for a kind of number -> VTK's name for the type that it is written as."""
PLANE = ("displacement", "velocity")
"""Vectors, which VTK wants with a third component."""
HEAD = '<?xml version="1.0"?>\n<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian">\n'


def write_vtu(
    results: Recording, path: Path | str, frames: Sequence[int] | None = None
) -> list[Path]:
    """Write frames to VTK's XML files of polygons and return their paths; all frames if absent.

    Points: displacement, m, and the number of the joint of the edge that begins there (-1: none of
    its own).  Cells: number of block and rock, fixed, displacement, velocity, rotation, stress (xx,
    yy, xy) and its principal values, SI, and gone (1 where it has been excavated), as in the result
    file.  One frame goes to ``path`` out.vtu; several to out-0000.vtu and so on, listed with their
    times in ``path`` out.pvd, which is the first of the paths returned.  Raises CaseError for files
    that exist already or cannot be written.
    """
    path = Path(path)
    chosen = frames_in(results, frames)
    if len(chosen) == 1:
        check_ending(path, ".vtu", "a mesh of one frame")
        check_free([path])
        _write_frame(results, chosen[0], path)
        return [path]
    check_ending(path, ".pvd", "the list of the meshes of several frames")
    files = numbered(path, chosen, ".vtu")
    check_free([path, *files])
    for frame, file in zip(chosen, files, strict=True):
        _write_frame(results, frame, file)
    entries = "".join(
        f'<DataSet timestep="{float(results.times[frame])!r}" part="0" '
        f"file={quoteattr(file.name)}/>\n"
        for frame, file in zip(chosen, files, strict=True)
    )
    text = f"{HEAD.format(kind='Collection')}<Collection>\n{entries}</Collection>\n</VTKFile>\n"
    with replaced(path) as file_out:
        file_out.write(text.encode("utf-8"))
    return [path, *files]


def _write_frame(results: Recording, frame: int, path: Path) -> None:
    with replaced(path) as file:
        file.writelines(text.encode("ascii") for text in _mesh(results, frame))


def _mesh(results: Recording, frame: int) -> Iterator[str]:
    """Give the text of the file of a frame, array by array."""
    vertices, start = results.vertices(frame), results.block_start
    count = len(start) - 1
    yield HEAD.format(kind="UnstructuredGrid") + "<UnstructuredGrid>\n<FieldData>\n"
    yield _array("TimeValue", results.times[frame : frame + 1], ' NumberOfTuples="1"')
    yield f'</FieldData>\n<Piece NumberOfPoints="{len(vertices)}" NumberOfCells="{count}">\n'
    yield "<Points>\n" + _array("Points", _with_z(vertices)) + "</Points>\n<Cells>\n"
    yield _array("connectivity", np.arange(len(vertices)))
    yield _array("offsets", start[1:])
    # 7 is VTK's polygon
    yield _array("types", np.full(count, 7, np.uint8))
    yield "</Cells>\n<PointData>\n"
    yield _array("displacement", _with_z(vertices - results.vertices(0)))
    yield _array("edge_joint", results.edge_joint)
    yield "</PointData>\n<CellData>\n"
    for name in results.field_names:
        values = results.field(name, frame)
        yield _array(name, _with_z(values) if name in PLANE else values)
    yield "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"


def _array(name: str, values: NDArray[Any], more: str = "") -> str:
    """Return an array (n,) or (n, k) as text with every digit, a row a line."""
    parts = "" if values.ndim == 1 else f' NumberOfComponents="{values.shape[1]}"'
    rows = values.reshape(len(values), -1).tolist()
    lines = "\n".join(" ".join(map(repr, row)) for row in rows)
    head = f'<DataArray type="{KINDS[values.dtype.kind]}" Name="{name}"{parts}{more}'
    return f'{head} format="ascii">\n{lines}\n</DataArray>\n'


def _with_z(plane: NDArray[Any]) -> NDArray[Any]:
    """Return vectors (k, 2) as VTK wants them: (k, 3) with z = 0."""
    return np.column_stack([plane, np.zeros(len(plane))])
