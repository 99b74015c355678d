"""Drawings and pictures under the section while a case is edited.

Their list stands in ``CASE.edit.json`` beside the case, never in it: a run does not know of them.
Files are those in the folder of the case and below it.
"""

from __future__ import annotations

from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from clast.case.checking import Stamp, stamp_of
from clast.errors import CaseError, shortened
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing_files import checked_file, replaced
from clast.rockmass.drawings.drawn_loops import CLOSURE, DrawnLine, loops_of, ring
from clast.rockmass.drawings.dxf import role_of
from clast.rockmass.drawings.dxf_entities import DxfContent, dxf_content
from clast.rockmass.drawings.features import READERS as FEATURES
from clast.rockmass.readers import read_drawing

PICTURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
"""First bytes of a picture -> its kind."""
PICTURE_ENDINGS = (".png", ".jpg", ".jpeg")
DRAWING_ENDINGS = (".dxf", ".csv", *FEATURES)
PICTURE_BYTES_MAX, POINTS_MAX = 50_000_000, 200_000
"""Larger pictures, and drawings of more points, are refused."""
LISTED_MAX, LOOKED_MAX, DEEP_MAX = 200, 5000, 3
"""Files that are offered and looked at, and folders, that of the case and those in it, at most."""

ENDING = ".edit.json"
"""Of the file beside a case that has the list."""
Pair = tuple[float, float]


class Underlay(BaseModel):
    """One file under the section, and how it is shown."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    file: str
    """Its name from the folder of the case."""
    opacity: float = Field(0.6, ge=0.0, le=1.0)
    shown: bool = True
    locked: bool = False
    """Whether clicks neither place it nor take lines of it."""
    hidden: list[str] = []
    """Layers that are not shown."""
    pixels: tuple[Pair, Pair] | None = None
    """Two points of a picture, from its upper left corner."""
    points: tuple[Pair, Pair] | None = None
    """Their places in the section, m."""


class Underlays(BaseModel):
    """Content of ``CASE.edit.json``."""

    model_config = ConfigDict(extra="forbid")

    underlays: list[Underlay] = Field([], max_length=20)


def underlays_of(case: Path) -> tuple[Underlays, str]:
    """Return the underlays of a case, none where their file is broken, and what is wrong then."""
    path = case.with_suffix(ENDING)
    if not path.exists():
        return Underlays(), ""
    try:
        return Underlays.model_validate_json(checked_file(path).read_bytes()), ""
    except (ValidationError, CaseError, OSError):
        return Underlays(), f"{path.name} is left unread: it is not a list of underlays"


def stamps_under(case: Path) -> list[Stamp]:
    """Return the stamps of the list of underlays and of their files."""
    names = (case.parent / one.file for one in underlays_of(case)[0].underlays)
    return [stamp_of(one) for one in (case.with_suffix(ENDING), *names)]


def shown_under(case: Path) -> dict[str, Any]:
    """Return the underlays of a case, stamps of their files, and the files that may be, as JSON."""
    kept, trouble = underlays_of(case)
    more = {"files": files_beside(case), "trouble": trouble, "under": stamps_under(case)}
    return {**kept.model_dump(), **more}


def keep(case: Path, underlays: Underlays) -> None:
    """Write the underlays of a case, whole; raises CaseError for files elsewhere."""
    for one in underlays.underlays:
        beside(case, one.file)
    with replaced(case.with_suffix(ENDING)) as file:
        file.write(underlays.model_dump_json(indent=1).encode("utf-8"))


def beside(case: Path, name: str) -> Path:
    """Return a file in the folder of a case or below it; raises CaseError for any other."""
    folder = case.resolve().parent
    try:
        path = (folder / name).resolve()
    except (OSError, RuntimeError, ValueError):  # loops of links, a NUL in the name
        path = Path(name)
    if not name or not path.is_relative_to(folder):
        what, remedy = "is not in the folder of the case", f"copy it to {folder}"
        raise CaseError(what, where=shortened(name, 100) or "the file", remedy=remedy)
    return checked_file(path)


def files_beside(case: Path) -> list[str]:
    """Return the names of drawings and pictures in the folder of a case and below, sorted.

    Links that lead elsewhere are left out.
    """
    folder = case.resolve().parent
    endings = (*DRAWING_ENDINGS, *PICTURE_ENDINGS)
    patterns = ("[!._]*/" * depth + "*" for depth in range(DEEP_MAX))
    looked = islice(chain.from_iterable(map(folder.glob, patterns)), LOOKED_MAX)
    known = (one for one in looked if one.name.lower().endswith(endings) and one.is_file())
    own = (one for one in known if one.resolve().is_relative_to(folder))
    names = (one.relative_to(folder).as_posix() for one in own if not one.match(f"*{ENDING}"))
    return sorted(islice(names, LISTED_MAX))


def picture(case: Path, name: str) -> tuple[str, bytes]:
    """Return kind and content of a PNG or JPEG; raises CaseError for anything else."""
    path = beside(case, name)
    if path.stat().st_size > PICTURE_BYTES_MAX:
        what = f"has more than {PICTURE_BYTES_MAX // 1_000_000} MB"
        raise CaseError(what, where=name, remedy="save it with fewer pixels")
    content = path.read_bytes()
    kind = next((kind for head, kind in PICTURES.items() if content.startswith(head)), None)
    if kind is None:
        raise CaseError("is not a picture", where=name, remedy="save it as PNG or JPEG")
    return kind, content


def drawn(case: Path, name: str) -> dict[str, Any]:
    """Return the lines of a drawing as `clast import` reads them, for JSON.

    ``lines`` and ``outlines`` (closed, counter-clockwise) have the name of their ``layer``, what
    that says after its line (``name``) and ``points``, m; ``notes`` are those of the reader.
    """
    path = beside(case, name)
    if path.suffix.casefold() == ".dxf":
        content = dxf_content(path, lambda _: True)
        # a closed line ends where it begins
        lines = [
            _line(np.vstack([(at := content.flat(one)), at[: one.closed]]), one.layer)
            for one in content.pieces
            if len(one.points) and not one.text
        ]
        outlines, notes = _outlines(content, name), [content.unit_source, *content.notes]
    else:
        drawing = read_drawing(path)
        rim, notes = drawing.boundary, list(drawing.notes)
        lines = [_line(one.points, f"JOINTS_{one.joint}") for one in drawing.traces]
        outlines = [] if rim is None else [_line(rim, "BOUNDARY")]
        lines += [] if rim is None else [_line(np.vstack([rim, rim[:1]]), "BOUNDARY")]
    many = [one["points"] for one in chain(lines, outlines)]
    if sum(map(len, many)) > POINTS_MAX:
        what = f"has more than {POINTS_MAX} points"
        raise CaseError(what, where=name, remedy="save the lines that are needed alone")
    if not all(np.isfinite(points).all() for points in many):
        raise CaseError("has coordinates that are not finite", where=name, remedy="draw it anew")
    return {"lines": lines, "outlines": outlines, "notes": [*dict.fromkeys(notes)]}


def _line(points: Floats, layer: str) -> dict[str, Any]:
    # what a change of units leaves in the last digits is nobody's measurement
    return {"layer": layer, "name": role_of(layer)[1], "points": np.round(points, 9).tolist()}


def _outlines(content: DxfContent, name: str) -> list[dict[str, Any]]:
    """Return the closed outlines of each layer, those of several lines that meet end to end too."""
    corners = np.vstack([np.zeros((0, 2)), *map(content.flat, content.pieces)])
    near = CLOSURE * float(np.hypot(*np.ptp(corners, axis=0))) if len(corners) else 0.0
    found = []
    for layer in content.layers:
        lines = [
            DrawnLine(points=content.flat(one), closed=one.closed, place=one.place)
            for one in content.pieces
            if one.layer == layer and len(one.points) > 1
        ]
        for some in (lines, [one for one in lines if one.closed]):
            try:
                loops = [ring(one, "the outline", name)[0] for one in loops_of(some, near, name)]
            except CaseError:
                continue  # of lines that do not close those that do by themselves are left
            found += [_line(points, layer) for points in loops]
            break
    return found
