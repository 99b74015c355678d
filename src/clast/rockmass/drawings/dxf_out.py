"""Blocks out as DXF: a closed LWPOLYLINE for each block on the layer of its rock, in metres."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError, shortened
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of
from clast.rockmass.drawings.drawing import DEFAULT_JOINT, Floats
from clast.rockmass.drawings.drawing_files import replaced

FORBIDDEN = set('<>/\\":;?*|=`,')
"""Characters that names of DXF layers do not have."""
LONGEST_NAME = 255
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
    layers = {name: name for name in dict.fromkeys(blocks.rock)}
    joints = {name: _joint_layer(name) for name in dict.fromkeys(blocks.edge_joint) if name}
    more = [] if extras is None else [extras]
    named = [*layers.values(), *joints.values(), *(one.layer for one in more)]
    _check_layers(named)
    for number, layer in enumerate(named):
        if not document.layers.has_entry(layer):
            document.layers.add(layer, color=COLOURS[number % len(COLOURS)])
    entities = [
        _polygon(blocks.polygon(block).tolist(), layers[name])
        for block, name in enumerate(blocks.rock)
    ]
    entities += [_line(start, end, joints[name]) for start, end, name in _joint_lines(blocks)]
    for one in more:
        document.layers.get(one.layer).description = one.about
        entities += [_line(start, end, one.layer) for start, end in one.lines.tolist()]
    text = _with_entities(document, entities)
    with replaced(Path(path)) as file:
        file.write(document.encode(text))


def _document(path: str | Path) -> Any:
    """Return an empty document in metres."""
    try:
        from ezdxf.filemanagement import new
    except ImportError:
        raise CaseError(
            "DXF files are written by ezdxf, which is not installed",
            where=str(path),
            remedy='install it: pip install "clast[dxf]", or write .csv or .npz',
        ) from None
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


def _joint_layer(name: str) -> str:
    """Return the layer of a joint's lines, which read_dxf reads again under the same name."""
    return "JOINTS" if name == DEFAULT_JOINT else f"JOINTS_{name}"


def _check_layers(names: Sequence[str]) -> None:
    """Refuse names that layers cannot have, and those that differ only in capitals."""
    seen: dict[str, str] = {}
    for name in names:
        bad = sorted(FORBIDDEN & set(name)) or [c for c in name if not c.isprintable()]
        if bad or not name.strip() or len(name) > LONGEST_NAME:
            listed = ", ".join(repr(one) for one in bad[:5])
            raise CaseError(
                f"'{shortened(name)}' cannot be used as the name of a DXF layer"
                + (f": it has {listed}" if bad else ""),
                remedy="rename the rock or the joint, or write .csv or .npz",
            )
        other = seen.get(name.casefold())
        seen[name.casefold()] = name
        if other is not None:
            raise CaseError(
                f"'{shortened(other)}' and '{shortened(name)}' would be the same layer",
                remedy="rename the rock or the joint: layer names ignore case",
            )


def _joint_lines(blocks: Blocks) -> list[tuple[list[float], list[float], str]]:
    """Return start, end and joint of the edges that have one, those of two blocks once."""
    following = np.arange(1, len(blocks.vertices) + 1)
    following[blocks.block_start[1:] - 1] = blocks.block_start[:-1]
    seen: set[tuple[tuple[float, ...], tuple[float, ...], str]] = set()
    lines = []
    at = blocks.vertices.tolist()
    for k, name in enumerate(blocks.edge_joint):
        first, second = tuple(at[k]), tuple(at[following[k]])
        key = (min(first, second), max(first, second), name)
        if name and key not in seen:
            seen.add(key)
            lines.append((at[k], at[following[k]], name))
    return lines
