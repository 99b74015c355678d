"""The content of a DXF file, as points: the file opened, its block references exploded, its units.

Read by ezdxf (extra ``dxf``).
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError, shortened
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing import LeftOut
from clast.rockmass.drawings.drawing_files import checked_file

NESTED_BLOCKS_MAX = 20
ENTITIES_MAX = 500_000
"""Most entities of a drawing, those of block references counted each time."""
SAGITTA = 1e-4
"""Sagitta as a share of the drawing's diagonal where none is given."""
CHORDS_MAX = 100_000
"""Most chords of one curve."""

UNITS = {
    1: ("inches", 0.0254),
    2: ("feet", 0.3048),
    3: ("miles", 1609.344),
    4: ("millimetres", 1e-3),
    5: ("centimetres", 1e-2),
    6: ("metres", 1.0),
    7: ("kilometres", 1e3),
    10: ("yards", 0.9144),
    13: ("microns", 1e-6),
    14: ("decimetres", 0.1),
    15: ("decametres", 10.0),
    16: ("hectometres", 100.0),
    21: ("US survey feet", 1200.0 / 3937.0),
    24: ("US survey miles", 5280.0 * 1200.0 / 3937.0),
}
"""$INSUNITS -> name and metres."""
SYMBOLS = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "km": 1e3, "in": 0.0254, "ft": 0.3048}
"""Values of ``unit=``, beside a number of metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """One line, curve or point of a drawing."""

    kind: str
    """Type of the entity: LINE, ARC, POINT, MTEXT, ..."""
    layer: str
    place: str
    """Type and handle, for messages."""
    points: Floats
    """Its points in units of the file, shape (n, 3); one for POINT and MTEXT."""
    closed: bool
    """True where an edge leads from its last point to its first."""
    colour: int
    """AutoCAD colour index, that of the layer where the entity has none."""
    text: str
    """The text of an MTEXT."""

    def left_out(self, what: str, reason: str) -> LeftOut:
        """Return it as something that is not taken over."""
        return LeftOut(what=what, place=f"{self.place} on layer {self.layer}", reason=reason)


@dataclass(frozen=True, kw_only=True, eq=False)
class DxfContent:
    """The pieces of a DXF file on the layers that were wanted."""

    pieces: tuple[Piece, ...]
    layers: tuple[str, ...]
    """Names of the layers with entities, sorted."""
    unit: float
    """Metres in a unit of the file."""
    unit_source: str
    notes: tuple[str, ...]
    left_out: tuple[LeftOut, ...]
    """Entities on the requested layers that cannot be drawn."""
    elsewhere: tuple[LeftOut, ...]
    """Entities on other layers and in paper space."""

    def flat(self, piece: Piece) -> Floats:
        """Return the points of a piece, m, shape (n, 2)."""
        return piece.points[:, :2] * self.unit


def dxf_content(
    path: Path,
    wanted: Callable[[str], bool],
    unit: str | float | None = None,
    sagitta: float | None = None,
) -> DxfContent:
    """Return the content of a DXF file in model space on layers that are ``wanted``.

    ``unit`` is a symbol (m, cm, mm, km, in, ft) or the metres in a unit of the file, in place of
    $INSUNITS; ``sagitta`` is in metres, SAGITTA of the diagonal if absent.  Raises CaseError for a
    file that is not a DXF file, for entities that make no sense, and where ezdxf is not installed.
    """
    document, notes = _document(path)
    metres, source = unit_of(document.header.get("$INSUNITS", 0), unit, str(path))
    if "unitless" in source:
        notes.append(source)
    left: list[LeftOut] = []
    entities: list[tuple[Any, str, str]] = []
    others: dict[tuple[str, str], list[str]] = {}
    layers: set[str] = set()
    for entity, layer, place in _exploded(document, path, left):
        layers.add(layer)
        kind = entity.dxftype()
        if not wanted(layer):
            others.setdefault((layer, kind), []).append(place)
        elif kind in DRAWN:
            entities.append((entity, layer, place))
        else:
            reason = f"a {kind} is not a line, curve or point"
            left.append(LeftOut(what=f"on layer {layer}", place=place, reason=reason))
    pieces, flattened = _pieces(entities, document, path, metres, sagitta)
    known = {layer.dxf.name.lower(): layer for layer in document.layers}
    for name in filter(wanted, sorted(layers)):
        shown = known.get(name.lower())
        if shown is not None and (shown.is_off() or shown.is_frozen()):
            notes.append(f"layer {name} is switched off or frozen, and was read all the same")
    return DxfContent(
        pieces=tuple(pieces),
        layers=tuple(sorted(layers)),
        unit=metres,
        unit_source=source,
        notes=(*notes, *flattened),
        left_out=tuple(left),
        elsewhere=tuple(_elsewhere(document, others)),
    )


def unit_of(code: Any, given: str | float | None, file: str) -> tuple[float, str]:
    """Return the metres in a unit of the file, and where that comes from."""
    if isinstance(given, str):
        if given not in SYMBOLS:
            remedy = f"give one of {', '.join(SYMBOLS)}, or the metres in a unit of the file"
            raise CaseError(
                f"'{shortened(given)}' is not a valid unit", where="unit", remedy=remedy
            )
        return SYMBOLS[given], f"unit = {given}, as given"
    if given is not None:
        if not (isinstance(given, int | float) and 0.0 < given < math.inf):
            raise CaseError(
                f"{given!r} is not a valid length", where="unit", remedy="give metres, above 0"
            )
        return float(given), f"unit = {given:g} m, as given"
    if code in (0, None):
        return 1.0, "the file is unitless ($INSUNITS 0): its coordinates were taken as metres"
    if code not in UNITS:
        what = f"$INSUNITS is {shortened(str(code))}, not a unit for drawings of rock"
        raise CaseError(what, where=file, remedy=f"give unit=, one of {', '.join(SYMBOLS)}")
    name, metres = UNITS[code]
    return metres, f"$INSUNITS {code}: {name}"


def _document(path: Path) -> tuple[Any, list[str]]:
    """Return the document of a DXF file, repaired where it could be, and the repairs."""
    with checked_file(path).open("rb") as file:
        beginning = file.read(100_000)  # bytes, which hold the first section
    if b"SECTION" not in beginning:
        what = "is a DWG file" if beginning.startswith(b"AC10") else "is not a DXF file"
        raise CaseError(what, where=str(path), remedy="save it again as DXF (R2000 or later)")
    try:
        from ezdxf import recover
    except ImportError:
        what = "DXF files are read by ezdxf, which is not installed"
        remedy = 'install it: pip install "clast[dxf]"'
        raise CaseError(what, where=str(path), remedy=remedy) from None
    with _quiet():
        try:
            document, auditor = recover.readfile(path)
        except Exception as error:  # damaged files end in errors of many kinds
            what = f"is not a DXF file that can be read: {shortened(str(error), 150)}"
            remedy = "save it again as DXF (R2000 or later); a DWG file is another format"
            raise CaseError(what, where=str(path), remedy=remedy) from error
    faults = [*auditor.errors, *auditor.fixes]
    notes = []
    if faults:
        first = "; ".join(shortened(str(fault.message), 80) for fault in faults[:3])
        notes.append(f"{len(faults)} faults of the file itself were repaired: {first}")
    return document, notes


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep ezdxf's log from the terminal: its faults are in the notes."""
    logger = logging.getLogger("ezdxf")
    silent = logging.Filter("none but this")
    logger.addFilter(silent)
    try:
        yield
    finally:
        logger.removeFilter(silent)


def _exploded(document: Any, path: Path, left: list[LeftOut]) -> Iterator[tuple[Any, str, str]]:
    """Yield entity, layer and place of all in model space, block references exploded."""
    _check_copies(document, path)
    count = 0
    waiting = [(entity, "", "", 0) for entity in reversed(list(document.modelspace()))]
    while waiting:
        entity, above, within, depth = waiting.pop()
        kind, layer = _plain(entity.dxftype()), _layer(entity)
        # What is on layer 0 of a block lies on the layer of the reference to the block.
        layer = above if above and layer == "0" else layer
        source = entity.source_of_copy if entity.dxf.handle is None else entity
        handle = source.dxf.handle if source is not None else None
        place = f"{kind} {handle}" if handle else kind
        place = f"{place} in {within}" if within else place
        if kind != "INSERT":
            count += 1
            if count > ENTITIES_MAX:
                what = f"draws more than {ENTITIES_MAX} entities, block references exploded"
                remedy = "remove everything but outlines, joints, bolts and supports"
                raise CaseError(what, where=f"{path}: {place}", remedy=remedy)
            yield entity, layer, place
        elif depth >= NESTED_BLOCKS_MAX:
            reason = f"it is nested deeper than {NESTED_BLOCKS_MAX} blocks"
            left.append(LeftOut(what="block reference", place=place, reason=reason))
        else:
            inner = _inside(entity, path, place)
            waiting += [(one, layer, place, depth + 1) for one in reversed(inner)]


def _check_copies(document: Any, path: Path) -> None:
    """Refuse block references that draw too much, counted before anything is drawn.

    References may be nested, and each may be an array: their copies multiply.
    """
    known: dict[tuple[str, int], int] = {}

    def drawn(entities: Any, depth: int) -> int:
        return sum(1 if one.dxftype() != "INSERT" else copies(one, depth) for one in entities)

    def copies(insert: Any, depth: int) -> int:
        name = str(insert.dxf.get("name", ""))
        if depth >= NESTED_BLOCKS_MAX:
            return 1
        if name not in document.blocks:
            return int(insert.mcount)
        if (name, depth) not in known:
            known[name, depth] = 1 + drawn(document.blocks.get(name), depth + 1)
        return int(insert.mcount) * known[name, depth]

    for insert in document.modelspace():
        if insert.dxftype() != "INSERT":
            continue
        place = f"INSERT {insert.dxf.handle}"
        with _guarded(path, place):
            count = copies(insert, 0)
            if count > ENTITIES_MAX:
                times = f"{count:.3g}" if count < 1e300 else "more than 1e300"
                raise CaseError(
                    f"draws more than {ENTITIES_MAX} entities: its block, and the blocks in it, "
                    f"{times} times in all",
                    where=f"{path}: {place}",
                    remedy="check the rows and columns of block references, nested ones included",
                )


def _layer(entity: Any) -> str:
    """Return the layer of an entity, also of a type that ezdxf does not know."""
    if entity.dxf.is_supported("layer"):
        return _plain(str(entity.dxf.get("layer", "0")))
    return _plain(str(entity.graphic_properties().get("layer", "0")))


def _inside(insert: Any, path: Path, place: str) -> list[Any]:
    """Return the entities of a block reference, or further references where it is an array."""
    with _guarded(path, place):
        if insert.mcount > 1:
            return list(insert.multi_insert())
        return list(insert.virtual_entities())


@contextmanager
def _guarded(path: Path, place: str) -> Iterator[None]:
    """Name the entity in which ezdxf fails over damaged values."""
    try:
        with _quiet():
            yield
    except CaseError:
        raise
    except Exception as error:  # errors of many kinds, according to what is damaged
        what = f"cannot be drawn: {type(error).__name__} {shortened(str(error), 100)}".rstrip()
        raise CaseError(what, where=f"{path}: {place}", remedy="redraw it, or remove it") from error


def _elsewhere(document: Any, others: dict[tuple[str, str], list[str]]) -> Iterator[LeftOut]:
    """Yield the entities on other layers, by layer and type, and in paper space."""
    for (layer, kind), places in others.items():
        more = f" and {len(places) - 5} more" if len(places) > 5 else ""
        place = f"layer {layer}: {', '.join(places[:5])}{more}"
        what = f"{len(places)} {kind}"
        yield LeftOut(what=what, place=place, reason="the layer is not read")
    for layout in document.layouts:
        if not layout.is_modelspace and len(layout) > 1:  # an empty layout has one viewport
            what, place = f"{len(layout)} entities", f"layout {layout.name}"
            yield LeftOut(what=what, place=place, reason="only model space is read")


def _pieces(
    entities: list[tuple[Any, str, str]],
    document: Any,
    path: Path,
    unit: float,
    given: float | None,
) -> tuple[list[Piece], list[str]]:
    """Return entities as pieces, and a note on the sagitta, m, that curves were flattened with."""
    rough = [_drawn(entity, path, place, math.inf)[0] for entity, _, place in entities]
    corners = np.vstack([points for points in rough if len(points)] or [np.zeros((1, 3))])
    size = float(np.hypot(*np.ptp(corners[:, :2], axis=0)))
    sagitta = (SAGITTA * size or 1.0) if given is None else given / unit  # 0 where all are points
    if not 0.0 < sagitta < math.inf:
        raise CaseError(
            f"{given!r} is not a valid distance", where="sagitta", remedy="give metres, above 0"
        )
    pieces, curved = [], False
    for entity, layer, place in entities:
        points, closed, is_curved = _drawn(entity, path, place, sagitta)
        curved = curved or is_curved
        text, colour, layers = "", int(entity.dxf.get("color", 256)), document.layers
        if colour == 256:  # that of the layer
            colour = abs(int(layers.get(layer).color)) if layers.has_entry(layer) else 7
        if entity.dxftype() == "MTEXT":
            with _guarded(path, place):
                text = _plain(str(entity.plain_text()))
        pieces.append(
            Piece(
                kind=entity.dxftype(),
                layer=layer,
                place=place,
                points=points,
                closed=closed,
                colour=colour,
                text=text,
            )
        )
    note = f"curves were flattened to chords within {sagitta * unit:.3g} m of them (the sagitta)"
    return pieces, [note] if curved else []


def _drawn(entity: Any, path: Path, place: str, sagitta: float) -> Drawn:
    """Return the points of an entity; refuse those that are not finite."""
    with _guarded(path, place):
        points, closed, curved = DRAWN[entity.dxftype()](entity, sagitta)
    if not np.isfinite(points).all() or np.abs(points).max(initial=0.0) > 1e12:
        what = "has a coordinate that is not a finite number, or far too large a one"
        raise CaseError(what, where=f"{path}: {place}", remedy="redraw it, or remove it")
    return points, closed, curved


def _plain(text: str) -> str:
    """Return a text with question marks for bytes that are none in the file's encoding."""
    return text.encode("utf-8", "replace").decode("utf-8")


Drawn = tuple[Floats, bool, bool]
"""Points (n, 3), whether they are closed, whether they follow a curve."""


def _straight(*points: Any) -> Drawn:
    return np.array([tuple(one) for one in points]), False, False


def _arc(entity: Any, sagitta: float) -> Drawn:
    """Return an arc, or a circle without the last point, which is its first."""
    centre, radius = entity.dxf.center, float(entity.dxf.radius)
    closed, angles = entity.dxftype() == "CIRCLE", (0.0, 2.0 * math.pi)
    if not closed:
        start = math.radians(entity.dxf.start_angle)
        span = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
        angles = (start, start + (span or 2.0 * math.pi))
    points = arc(np.array([centre.x, centre.y]), radius, angles, sagitta)
    return _in_world(entity, points[:-1] if closed else points, centre.z), closed, True


def _curve(entity: Any, sagitta: float) -> Drawn:
    """Return an ellipse or a spline by ezdxf's own subdivision."""
    distance = min(sagitta, 1e12)
    points = [tuple(p) for p in islice(entity.flattening(distance), CHORDS_MAX + 1)]
    if len(points) > CHORDS_MAX:
        raise ValueError(f"more than {CHORDS_MAX} chords: give a larger sagitta")
    return np.array(points), bool(getattr(entity, "closed", False)), True


def _lwpolyline(entity: Any, sagitta: float) -> Drawn:
    corners = np.array(list(entity.get_points("xyb")), float).reshape(-1, 3)
    elevation = float(entity.dxf.get("elevation", 0.0))
    points = bulged(corners, bool(entity.closed), sagitta)
    curved = bool(np.any(corners[:, 2]))
    return _in_world(entity, points, elevation), bool(entity.closed), curved


def _polyline(entity: Any, sagitta: float) -> Drawn:
    if not (entity.is_2d_polyline or entity.is_3d_polyline):
        raise ValueError("it is a mesh, not a line")
    # Control points of a fitted spline are not points of the line (flag 16).
    vertices = [vertex for vertex in entity.vertices if not vertex.dxf.flags & 16]
    at = np.array([tuple(vertex.dxf.location) for vertex in vertices]).reshape(-1, 3)
    if entity.is_3d_polyline:
        return at, bool(entity.is_closed), False
    bulges = np.array([vertex.dxf.get("bulge", 0.0) for vertex in vertices])
    corners = np.column_stack([at[:, :2], bulges])
    points = bulged(corners, bool(entity.is_closed), sagitta)
    elevation = float(entity.dxf.get("elevation", (0.0, 0.0, 0.0))[2])
    return _in_world(entity, points, elevation), bool(entity.is_closed), bool(bulges.any())


def _face(entity: Any, _: float) -> Drawn:
    """Return a SOLID, a TRACE or a 3DFACE: a filled area of three or four corners."""
    return np.array([tuple(one) for one in entity.wcs_vertices()]).reshape(-1, 3), True, False


DRAWN: dict[str, Callable[[Any, float], Drawn]] = {
    "LINE": lambda entity, _: _straight(entity.dxf.start, entity.dxf.end),
    "POINT": lambda entity, _: _straight(entity.dxf.location),
    "MTEXT": lambda entity, _: _straight(entity.dxf.insert),
    "CIRCLE": _arc,
    "ARC": _arc,
    "ELLIPSE": _curve,
    "SPLINE": _curve,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "SOLID": _face,
    "TRACE": _face,
    "3DFACE": _face,
}
"""How the points of each type of entity are found."""


def _in_world(entity: Any, points: Floats, elevation: float) -> Floats:
    """Return points (n, 2) of an entity's own plane in world coordinates, shape (n, 3)."""
    flat = np.column_stack([points, np.full(len(points), elevation)])
    system = entity.ocs()
    if not system.transform:
        return flat
    return np.array([tuple(p) for p in system.points_to_wcs(flat.tolist())]).reshape(-1, 3)


def arc(centre: Floats, radius: float, angles: tuple[float, float], sagitta: float) -> Floats:
    """Return points of an arc from its first angle to its second, rad, ends included, (n, 2).

    The chords turn by at most an eighth of a circle, and stay within the sagitta of the arc.
    """
    span = angles[1] - angles[0]
    if not (radius > 0.0 and math.isfinite(radius) and math.isfinite(span)):
        raise ValueError(f"an arc of radius {radius:g}")
    share = min(max(1.0 - sagitta / radius, -1.0), 1.0)
    widest = min(2.0 * math.acos(share), math.pi / 4.0)
    if abs(span) > widest * CHORDS_MAX:
        raise ValueError(f"more than {CHORDS_MAX} chords: give a larger sagitta")
    count = max(math.ceil(abs(span) / widest - 1e-9), 1)
    turned = np.linspace(angles[0], angles[1], count + 1)
    return centre + radius * np.column_stack([np.cos(turned), np.sin(turned)])


def bulged(corners: Floats, closed: bool, sagitta: float) -> Floats:
    """Return the points of a polyline of corners (x, y, bulge), shape (n, 3), as (m, 2).

    A bulge b makes the edge after its corner an arc of the angle 4 arctan b, counter-clockwise if
    positive; its radius is c (1 + b2) / (4 |b|) for the chord c.
    """
    at, bulge = corners[:, :2], corners[:, 2]
    parts = []
    for k in range(len(at)):
        last = k + 1 == len(at)
        parts.append(at[k : k + 1])
        if bulge[k] == 0.0 or (last and not closed):
            continue
        first, second = at[k], at[0] if last else at[k + 1]
        chord = second - first
        if not chord.any():
            continue
        b = float(bulge[k])
        centre = 0.5 * (first + second) + (1.0 - b * b) / (4.0 * b) * np.array(
            [-chord[1], chord[0]]
        )
        start = math.atan2(first[1] - centre[1], first[0] - centre[0])
        angles = (start, start + 4.0 * math.atan(b))
        radius = float(np.hypot(*chord)) * (1.0 + b * b) / (4.0 * abs(b))
        parts.append(arc(centre, radius, angles, sagitta)[1:-1])
    return np.vstack(parts) if parts else np.zeros((0, 2))
