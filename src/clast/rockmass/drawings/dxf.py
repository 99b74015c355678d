"""DXF drawings in: outlines, joints, bolts and supports by the layers they lie on.

The layers, in capitals or not:

| layer | content |
| --- | --- |
| BOUNDARY | the outline of the domain: one closed line, or lines that close end to end |
| JOINTS, JOINTS_name | joints, of the strength [joint.default] or [joint.name] |
| OPENINGS, OPENINGS_name | closed outlines of openings |
| REGIONS_rock | closed outlines of areas of that rock |
| BOLTS, BOLTS_kind | straight lines from head to end |
| FIXED | points, and lines along which every block is held at one point |

``read_dda_dxf`` reads the convention of DDA for Windows instead, which knows no layers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing import (
    DEFAULT_JOINT,
    Drawing,
    DrawnOutline,
    LeftOut,
    Polyline,
    Segment,
    Spot,
)
from clast.rockmass.drawings.drawn_loops import (
    CLOSURE,
    DrawnLine,
    cutting,
    lengthened,
    loops_of,
    outline_of_lines,
    point,
    ring,
    without_repeats,
)
from clast.rockmass.drawings.dxf_entities import DxfContent, Piece, dxf_content

ROLES = ("boundary", "joints", "openings", "regions", "bolts", "fixed")
"""First words of the layers that are read."""
NAMED = ("joints", "openings", "regions", "bolts")
"""Those that may be followed by _name."""


@dataclass(frozen=True, kw_only=True)
class DxfReading:
    """How a DXF file is read."""

    unit: str | float | None = None
    """m, cm, mm, km, in, ft, or the metres in a unit of the file; its $INSUNITS if absent."""
    sagitta: float | None = None
    """Largest distance of a chord from its curve, m; 1e-4 of the drawing's diagonal if absent."""
    tolerance: float | None = None
    """Largest gap between ends that meet, m; 1e-5 of the drawing's diagonal if absent."""

    def __post_init__(self) -> None:
        for key in ("sagitta", "tolerance"):
            value = getattr(self, key)
            if value is not None and not (isinstance(value, int | float) and 0.0 < value < np.inf):
                raise CaseError(
                    f"{value!r} is not a valid distance", where=key, remedy="give m, above 0"
                )


class MissingLayer(CaseError):
    """A DXF file without the layer that is asked for; ``layers`` are those it has."""

    def __init__(self, content: DxfContent, path: Path, layer: str, remedy: str) -> None:
        self.layers = content.layers
        listed = ", ".join(content.layers[:20]) if content.layers else "none: nothing is drawn"
        super().__init__(
            f"nothing is drawn on a layer {layer}",
            where=str(path),
            remedy=f"{remedy}; the layers are: {listed}",
        )


def role_of(layer: str) -> tuple[str, str]:
    """Return the role of a layer and the name after it; the role is empty where it is not read."""
    head, line, name = layer.strip().partition("_")
    role = head.casefold()
    if role not in ROLES or (line and role not in NAMED):
        return "", ""
    return role, name.strip()


def read_dxf(path: str | Path, reading: DxfReading | None = None) -> Drawing:
    """Return the drawing of a DXF file, from the layers of clast.

    Raises CaseError where the layer BOUNDARY is missing (with the layers there are), for outlines
    that are not closed (with the size and the place of the gap) or cross themselves, and for
    drawings that are not plane.
    """
    path, reading = Path(path), reading or DxfReading()
    content = dxf_content(path, lambda name: bool(role_of(name)[0]), reading.unit, reading.sagitta)
    if not any(role_of(layer)[0] == "boundary" for layer in content.layers):
        raise MissingLayer(
            content,
            path,
            "BOUNDARY",
            "rename the layer of the outline to BOUNDARY, or clast import --as blocks",
        )
    collected = _Collected(path, content, reading)
    for piece in content.pieces:
        role, name = role_of(piece.layer)
        TAKE[role](collected, piece, name)
    return collected.drawing()


def lines_of_layer(
    path: str | Path, layer: str, reading: DxfReading | None = None
) -> tuple[tuple[Polyline, ...], tuple[str, ...]]:
    """Return the lines of one layer, case-blind, m, as joints, and the notes on changes.

    Raises CaseError where there is no such layer, and for entities that are not lines.
    """
    collected = _one_layer(Path(path), layer, reading or DxfReading())
    for piece in collected.content.pieces:
        collected.trace(piece, role_of(piece.layer)[1])
    _refuse_left_out(collected)
    return tuple(collected.traces), tuple(collected.notes)


def outline_of_layer(
    path: str | Path, layer: str, reading: DxfReading | None = None
) -> tuple[Floats, tuple[str, ...]]:
    """Return the one closed outline of a layer, case-blind, m, (n, 2), and the notes on changes.

    It runs counter-clockwise.  Raises CaseError where there is no such layer, or where it has not
    one outline.
    """
    collected = _one_layer(Path(path), layer, reading or DxfReading())
    for piece in collected.content.pieces:
        collected.outlined(piece, layer, "")
    _refuse_left_out(collected)
    rings = [one for group in collected.outlines().values() for one in group]
    if len(rings) != 1:
        what = f"the layer {layer} has {len(rings)} outlines, not one"
        raise CaseError(what, where=str(path), remedy="put each on its own layer")
    return rings[0].points, tuple(collected.notes)


def read_dda_dxf(path: str | Path, reading: DxfReading | None = None) -> Drawing:
    """Return the drawing of a DXF file of DDA for Windows.

    LINE, LWPOLYLINE, ARC and CIRCLE are joints of the type colour + 1, named type-N; the domain is
    the area that they enclose.  MTEXT F, L, M and H are fixed, load, measured and hole points;
    everything else goes to ``left_out``.
    """
    path, reading = Path(path), reading or DxfReading()
    content = dxf_content(path, lambda _: True, reading.unit, reading.sagitta)
    collected = _Collected(path, content, reading)
    for piece in content.pieces:
        if piece.kind in ("LINE", "LWPOLYLINE", "ARC", "CIRCLE"):
            collected.trace(piece, f"type-{piece.colour + 1}")
        elif piece.kind == "MTEXT" and piece.text.strip().upper() in collected.spots:
            collected.spot(piece, piece.text.strip().upper())
        else:
            what = f"{piece.kind} {piece.text!r}" if piece.text else piece.kind
            reason = "the convention of DDA for Windows has no use for it"
            collected.left_out.append(piece.left_out(what, reason))
    lines = [trace.points for trace in collected.traces]
    outline = outline_of_lines(lines)
    if outline is None and collected.tolerance > 0.0:
        outline = outline_of_lines(lines, collected.tolerance)
        collected.notes.append(lengthened(collected.tolerance))
    if outline is None:
        what = "its lines enclose no area, or several that do not touch"
        remedy = "draw the outline of the domain as lines that meet or cross at its corners"
        raise CaseError(what, where=str(path), remedy=remedy)
    collected.traces, along = cutting(collected.traces, outline[0], [])
    collected.left_out += [
        LeftOut(
            what=f"{line.joint} from {point(line.points[0])} to {point(line.points[-1])}",
            place=line.place,
            reason="it lies along the outline of the domain, and so cuts nothing",
        )
        for line in along
    ]
    return collected.drawing(outline[0])


def _one_layer(path: Path, layer: str, reading: DxfReading) -> _Collected:
    """Return the entities of one layer, or say which layers there are."""
    asked = layer.strip().casefold()
    content = dxf_content(
        path, lambda name: name.strip().casefold() == asked, reading.unit, reading.sagitta
    )
    if not any(name.strip().casefold() == asked for name in content.layers):
        raise MissingLayer(content, path, layer, "name one of these layers")
    return _Collected(path, content, reading)


def _refuse_left_out(collected: _Collected) -> None:
    """Refuse a layer with something on it that is not taken over."""
    for one in collected.left_out:
        what = f"{one.what}: {one.reason}"
        remedy = "put it on another layer"
        raise CaseError(what, where=f"{collected.path}: {one.place}", remedy=remedy)


@dataclass(eq=False)
class _Collected:
    """Parts of a file found until now, in metres."""

    path: Path
    content: DxfContent
    reading: DxfReading
    traces: list[Polyline] = field(default_factory=list)
    lines: dict[tuple[str, str], list[DrawnLine]] = field(default_factory=dict)
    """Role and name -> lines of outlines."""
    bolts: list[Segment] = field(default_factory=list)
    fixed_lines: list[Segment] = field(default_factory=list)
    spots: dict[str, list[Spot]] = field(default_factory=lambda: {k: [] for k in "FLMH"})
    left_out: list[LeftOut] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.notes += self.content.notes
        self.left_out += self.content.left_out
        self.notes += _dropped_height(self.content, self.path)
        corners = np.vstack([np.zeros((0, 2)), *map(self.content.flat, self.content.pieces)])
        size = float(np.hypot(*np.ptp(corners, axis=0))) if len(corners) else 0.0
        given = self.reading.tolerance
        self.tolerance = CLOSURE * size if given is None else given

    def leave(self, piece: Piece, reason: str) -> None:
        """Leave a piece out, with the reason."""
        self.left_out.append(piece.left_out(piece.kind, reason))

    def trace(self, piece: Piece, name: str) -> None:
        """Take a piece as a joint; a closed one returns to its first point."""
        points = self.content.flat(piece)
        if piece.closed and len(points):
            points = np.vstack([points, points[:1]])
        points = without_repeats(points, 0.0)
        if len(points) < 2:
            self.leave(piece, "a joint is a line of some length")
            return
        self.traces.append(Polyline(points=points, joint=name or DEFAULT_JOINT, place=piece.place))

    def outlined(self, piece: Piece, role: str, name: str) -> None:
        """Take a piece as an outline, or as a part of one."""
        if len(piece.points) < 2:
            self.leave(piece, "an outline is drawn by lines")
            return
        line = DrawnLine(points=self.content.flat(piece), closed=piece.closed, place=piece.place)
        self.lines.setdefault((role, name), []).append(line)

    def region(self, piece: Piece, name: str) -> None:
        """Take a piece as the outline of a region, whose layer must name a rock."""
        if name:
            self.outlined(piece, "regions", name)
        else:
            self.leave(piece, "the layer does not name the rock: REGIONS_rock")

    def bolt(self, piece: Piece, name: str) -> None:
        """Take a straight line as a bolt."""
        points = self.content.flat(piece)
        if len(points) != 2 or piece.closed or not np.ptp(points, axis=0).any():
            self.leave(piece, "a bolt is a straight line from its head to its end")
            return
        self.bolts.append(Segment(name=name or "bolt", ends=points, place=piece.place))

    def held(self, piece: Piece, _: str) -> None:
        """Take a point as a fixed one, a line as one along which blocks are held."""
        points = self.content.flat(piece)
        if piece.kind == "POINT":
            self.spot(piece, "F")
            return
        if piece.kind not in ("LINE", "LWPOLYLINE", "POLYLINE"):
            self.leave(piece, "draw fixed points as POINT, and lines of them as LINE")
            return
        if piece.closed:
            points = np.vstack([points, points[:1]])
        for k in range(len(points) - 1):
            if (points[k] != points[k + 1]).any():
                ends = points[k : k + 2]
                self.fixed_lines.append(Segment(name="", ends=ends, place=piece.place))

    def spot(self, piece: Piece, letter: str) -> None:
        """Take the place of a piece as a point: F fixed, L load, M measured, H hole."""
        spots = self.spots[letter]
        at = self.content.flat(piece)[0]
        spots.append(Spot(name=f"{letter}{len(spots) + 1}", at=at, place=piece.place))

    def outlines(self) -> dict[tuple[str, str], list[DrawnOutline]]:
        """Return the closed outlines by role and name, counter-clockwise."""
        outlines: dict[tuple[str, str], list[DrawnOutline]] = {}
        for (role, name), lines in self.lines.items():
            for loop in loops_of(lines, self.tolerance, str(self.path)):
                points, notes = ring(loop, "the outline", str(self.path))
                self.notes += notes
                one = DrawnOutline(name=name, points=points, place=loop.place)
                outlines.setdefault((role, name), []).append(one)
        return outlines

    def drawing(self, boundary: Floats | None = None) -> Drawing:
        """Return all that was collected; the boundary is that of its layer if not given."""
        outlines = self.outlines()
        if boundary is None:
            rims = outlines.pop(("boundary", ""), [])
            if len(rims) != 1:
                corners = "; ".join(f"{one.place} at {point(one.points[0])}" for one in rims[:3])
                raise CaseError(
                    f"the layer BOUNDARY has {len(rims)} outlines, not one"
                    + f": {corners}" * bool(rims),
                    where=str(self.path),
                    remedy="put outlines of openings on OPENINGS, and keep one domain",
                )
            boundary = rims[0].points

        def of_role(role: str) -> list[DrawnOutline]:
            return [one for key, group in outlines.items() if key[0] == role for one in group]

        return Drawing(
            file=str(self.path),
            boundary=boundary,
            traces=tuple(self.traces),
            openings=tuple(_numbered(of_role("openings"))),
            regions=tuple(of_role("regions")),
            bolts=tuple(self.bolts),
            fixed_points=tuple(self.spots["F"]),
            fixed_lines=tuple(self.fixed_lines),
            load_points=tuple(self.spots["L"]),
            measured_points=tuple(self.spots["M"]),
            hole_points=tuple(self.spots["H"]),
            unit=self.content.unit,
            unit_source=self.content.unit_source,
            notes=tuple(self.notes),
            left_out=(*self.left_out, *self.content.elsewhere),
        )


TAKE: dict[str, Callable[[_Collected, Piece, str], None]] = {
    "boundary": lambda collected, piece, name: collected.outlined(piece, "boundary", name),
    "joints": _Collected.trace,
    "openings": lambda collected, piece, name: collected.outlined(piece, "openings", name),
    "regions": _Collected.region,
    "bolts": _Collected.bolt,
    "fixed": _Collected.held,
}
"""The handling of an entity on the layers of each role."""


def _numbered(openings: list[DrawnOutline]) -> Iterator[DrawnOutline]:
    """Yield openings with different names: those without one, and twins, get a number."""
    names = numbered([one.name for one in openings], "opening")
    for one, name in zip(openings, names, strict=True):
        yield DrawnOutline(name=name, points=one.points, place=one.place)


def numbered(names: Sequence[str], instead: str) -> Iterator[str]:
    """Yield different names: empty ones are called otherwise, those and twins get a number."""
    times = Counter(names)
    used = {name for name, count in times.items() if name and count == 1}
    last: dict[str, int] = {}
    for given in names:
        name, number = given, last.get(given, 0)
        while not name or (times[given] > 1 and (name == given or name in used)):
            number += 1
            name = f"{given or instead}-{number}"
        last[given] = number
        used.add(name)
        yield name


def _dropped_height(content: DxfContent, path: Path) -> list[str]:
    """Return that a constant height was dropped, or refuse a drawing in space."""
    pieces = [piece for piece in content.pieces if len(piece.points)]
    if not pieces:
        return []
    low = min(pieces, key=lambda piece: float(piece.points[:, 2].min()))
    high = max(pieces, key=lambda piece: float(piece.points[:, 2].max()))
    bottom, top = float(low.points[:, 2].min()), float(high.points[:, 2].max())
    points = np.vstack([piece.points for piece in pieces])
    if top - bottom > 1e-6 * float(np.hypot(*np.ptp(points[:, :2], axis=0))):
        raise CaseError(
            f"the drawing is not planar: z ranges from {bottom:.6g} ({low.place}) to {top:.6g} "
            f"({high.place})",
            where=str(path),
            remedy="draw the section in the plane of x and y",
        )
    if top == bottom == 0.0:
        return []
    return [f"all is drawn at z = {top * content.unit:.6g} m, which was dropped"]
