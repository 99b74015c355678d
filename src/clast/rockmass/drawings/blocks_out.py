"""Blocks out as CSV and NPZ, and NPZ in again."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from clast.errors import CaseError, shortened
from clast.model.arrays import Floats, following
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of
from clast.rockmass.drawings.drawing import DEFAULT_JOINT
from clast.rockmass.drawings.drawing_files import checked_file, replaced

HEADING = ("block", "vertex", "x", "y", "joint", "rock")
ARRAYS = {
    "vertices": ("fiu", "does not hold numbers", "save it as numbers"),
    "block_start": ("iu", "does not hold numbers", "save it as numbers"),
    "rock": ("U", "is not a list of texts", "save names as texts"),
    "edge_joint": ("U", "is not a list of texts", "save names as texts"),
    "name": ("U", "is not a list of texts", "save names as texts"),
}
"""Arrays of an archive -> the kinds of dtype that it may have, the fault of others, its remedy."""
NAMES = "name"
"""Array of an archive with the names of blocks, where they have any."""


def write_blocks_csv(
    path: str | Path,
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
) -> None:
    """Write blocks to a CSV file: a row for each vertex with block, vertex, x, y, joint, rock.

    Blocks count from 0, vertices from 0 in each block, coordinates are m with every digit; the
    joint is that of the edge to the next vertex.  Raises CaseError as ``write_blocks_dxf`` does.
    """
    blocks = blocks_of(vertices, block_start, rock, edge_joint)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(HEADING)
    corner = zip(blocks.vertices.tolist(), blocks.edge_joint, strict=True)
    for block, (count, name) in enumerate(
        zip(np.diff(blocks.block_start), blocks.rock, strict=True)
    ):
        for k, ((x, y), joint) in enumerate(islice(corner, int(count))):
            table.writerow((block, k, repr(x), repr(y), joint, name))
    with replaced(Path(path)) as file:
        file.write(text.getvalue().encode("utf-8"))


def write_blocks_npz(
    path: str | Path,
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
    name: Sequence[str] = (),
) -> None:
    """Write blocks to an archive of arrays: vertices, block_start, rock, edge_joint, and name.

    Raises CaseError as ``write_blocks_dxf`` does.
    """
    blocks = blocks_of(vertices, block_start, rock, edge_joint, name=name)
    names: dict[str, Any] = {NAMES: np.array(blocks.name, dtype=np.str_)} if blocks.name else {}
    with replaced(Path(path)) as file:
        np.savez_compressed(
            file,
            vertices=blocks.vertices,
            block_start=blocks.block_start,
            rock=np.array(blocks.rock, dtype=np.str_),
            edge_joint=np.array(blocks.edge_joint, dtype=np.str_),
            **names,
        )


def _check_size(path: Path) -> None:
    """Raise CaseError where an archive's arrays are larger than its blocks could need.

    No more is expanded of each than the archive says, whatever the array itself says.
    """
    with ZipFile(path) as archive:
        parts = [one for one in archive.infolist() if one.filename.removesuffix(".npy") in ARRAYS]
        size = sum(one.file_size for one in parts)
        # Most bytes that the arrays of an archive may have when they are expanded
        if size > 1_000_000_000 or len(parts) > len(ARRAYS):
            what = f"has arrays of {size:.3g} bytes, more than blocks should need"
            remedy = "divide it, or write it again with write_blocks_npz"
            raise CaseError(what, where=str(path), remedy=remedy)
        for one in parts:
            with archive.open(one) as file:
                headers = np.lib.format
                first = headers.read_magic(file) == (1, 0)
                read = headers.read_array_header_1_0 if first else headers.read_array_header_2_0
                shape, _, kind = read(file)
            if kind.hasobject or math.prod(shape) * kind.itemsize > one.file_size:
                what = f"the array {one.filename.removesuffix('.npy')} does not match its header"
                remedy = "write it again with write_blocks_npz"
                raise CaseError(what, where=str(path), remedy=remedy)


def read_blocks_npz(path: str | Path) -> Blocks:
    """Return the blocks of an archive that ``write_blocks_npz`` wrote.

    Raises CaseError where it is none, or damaged, or its arrays do not belong together.
    """
    file = str(path)
    try:
        _check_size(checked_file(Path(path)))
        with np.load(path, allow_pickle=False) as archive:
            missing = [name for name in ARRAYS if name not in (NAMES, *archive.files)]
            if missing:
                remedy = f"it has {shortened(', '.join(archive.files), 100) or 'none'}"
                raise CaseError(f"has no array {', '.join(missing)}", where=file, remedy=remedy)
            arrays = {name: archive[name] for name in ARRAYS if name in archive.files}
    except CaseError:
        raise
    except Exception as error:  # damaged archives end in errors of zlib, struct and others
        what = f"is not an archive of blocks, or a damaged one: {shortened(str(error), 100)}"
        raise CaseError(what, where=file, remedy="write it again with write_blocks_npz") from None
    for name in reversed(arrays):
        kinds, what, remedy = ARRAYS[name]
        if arrays[name].dtype.kind not in kinds or (kinds == "U" and arrays[name].ndim != 1):
            raise CaseError(f"the array {name} {what}", where=file, remedy=remedy)
    rock, joints = arrays["rock"].tolist(), arrays["edge_joint"].tolist()
    names = arrays[NAMES].tolist() if NAMES in arrays else ()
    return blocks_of(arrays["vertices"], arrays["block_start"], rock, joints, file, names)


FORBIDDEN = set('<>/\\":;?*|=`,')
"""Characters that names of DXF layers do not have."""
SECTION = "  0\nSECTION\n  2\nENTITIES\n"
COMMON = "  5\n{handle}\n330\n{owner}\n100\nAcDbEntity\n"
"""The beginning of every entity: its handle, its owner, the class it is of."""
COLOURS = (7, 1, 3, 5, 2, 6, 4, 30, 94, 200)
"""AutoCAD colours of the layers, one after the other."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Extras:
    """Lines on a layer of their own, beside the blocks."""

    layer: str
    """Name of the layer."""
    about: str
    """The description of the layer."""
    lines: Floats
    """Ends of the lines, m, shape (n, 2, 2)."""


def write_blocks_dxf(
    path: str | Path,
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
    extras: Extras | None = None,
) -> None:
    """Write blocks to a DXF file, and their joints as lines on layers JOINTS_name if given.

    ``vertices`` (nv, 2), m, of the blocks that begin at ``block_start`` (nb + 1,), their rocks
    (nb,) and the joints (nv,) of the edges from each vertex to the next, empty where there is none.
    Lines that two blocks share are drawn once; ``extras`` are lines beside them.  Raises CaseError
    where the arrays do not belong together, a name cannot be that of a layer, or nothing can be
    written at ``path``.
    """
    blocks = blocks_of(vertices, block_start, rock, edge_joint)
    document = _document(path)
    rocks = dict.fromkeys(blocks.rock)
    # The layer of a joint, which read_dxf reads again under the same name.
    joints = {
        name: "JOINTS" if name == DEFAULT_JOINT else f"JOINTS_{name}"
        for name in dict.fromkeys(blocks.edge_joint)
        if name
    }
    layers = [*rocks, *joints.values(), *([extras.layer] if extras else [])]
    _check_layers(layers)
    for number, layer in enumerate(layers):
        if not document.layers.has_entry(layer):
            document.layers.add(layer, color=COLOURS[number % len(COLOURS)])
    entities = [
        _polygon(blocks.polygon(block).tolist(), name) for block, name in enumerate(blocks.rock)
    ]
    entities += [_line(start, end, joints[name]) for start, end, name in _joint_lines(blocks)]
    if extras:
        document.layers.get(extras.layer).description = extras.about
        entities += [_line(start, end, extras.layer) for start, end in extras.lines.tolist()]
    text = _with_entities(document, entities)
    with replaced(Path(path)) as file:
        file.write(document.encode(text))


def _document(path: str | Path) -> Any:
    try:
        from ezdxf.filemanagement import new
    except ImportError:
        what = "DXF files are written by ezdxf, which is not installed"
        remedy = 'install it: pip install "clast[dxf]", or write .csv or .npz'
        raise CaseError(what, where=str(path), remedy=remedy) from None
    return new("R2010", units=6)


def _with_entities(document: Any, entities: Sequence[str]) -> str:
    """Return the text of a DXF file with entities in its model space.

    ezdxf writes all around them; objects of its own for each would cost a hundred times as much.
    """
    handles = document.entitydb.handles
    first = int(str(handles), 16)
    handles.reset(f"{first + len(entities):X}")
    frame = io.StringIO()
    document.write(frame)
    before, section, after = frame.getvalue().partition(SECTION)
    owner = document.modelspace().layout_key
    numbered = (
        entity.format(handle=f"{number:X}", owner=owner)
        for number, entity in enumerate(entities, first)
    )
    return "".join([before, section, *numbered, after])


def _polygon(points: list[list[float]], layer: str) -> str:
    """Return a closed LWPOLYLINE, all but its handle and its owner."""
    corners = "".join(f" 10\n{x!r}\n 20\n{y!r}\n" for x, y in points)
    head = f"100\nAcDbPolyline\n 90\n{len(points)}\n 70\n1\n"
    return f"  0\nLWPOLYLINE\n{COMMON}  8\n{_braced(layer)}\n{head}{corners}"


def _line(start: list[float], end: list[float], layer: str) -> str:
    """Return a LINE, all but its handle and its owner."""
    places = f" 10\n{start[0]!r}\n 20\n{start[1]!r}\n 30\n0.0\n"
    places += f" 11\n{end[0]!r}\n 21\n{end[1]!r}\n 31\n0.0\n"
    return f"  0\nLINE\n{COMMON}  8\n{_braced(layer)}\n100\nAcDbLine\n{places}"


def _braced(text: str) -> str:
    """Return a text that str.format leaves as it is."""
    return text.replace("{", "{{").replace("}", "}}")


def _check_layers(names: Sequence[str]) -> None:
    """Refuse names that layers cannot have, and those that differ only in capitals."""
    seen: dict[str, str] = {}
    for name in names:
        bad = sorted(FORBIDDEN & set(name)) or [c for c in name if not c.isprintable()]
        if bad or not name.strip() or len(name) > 255:
            listed = ", ".join(repr(one) for one in bad[:5])
            raise CaseError(
                f"'{shortened(name)}' cannot be used as the name of a DXF layer"
                + (f": it has {listed}" if bad else ""),
                remedy="rename the rock or the joint, or write .csv or .npz",
            )
        other = seen.get(name.casefold())
        seen[name.casefold()] = name
        if other is not None:
            what = f"'{shortened(other)}' and '{shortened(name)}' would be the same layer"
            raise CaseError(what, remedy="rename the rock or the joint: layer names ignore case")


def _joint_lines(blocks: Blocks) -> Iterable[tuple[list[float], list[float], str]]:
    """Return start, end and joint of the edges that have one, those of two blocks once."""
    at = blocks.vertices.tolist()
    lines: dict[Any, tuple[list[float], list[float], str]] = {}
    for one, k, name in zip(at, following(blocks.block_start), blocks.edge_joint, strict=True):
        if name:
            key = (*sorted((tuple(one), tuple(at[k]))), name)
            lines.setdefault(key, (one, at[k], name))
    return lines.values()
