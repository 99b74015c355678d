"""Lines and outlines of geographic information systems: GeoJSON, WKT, GeoPackage, shapefile.

| file | content |
| --- | --- |
| .geojson, .json | a GeoJSON geometry, feature, or collection of features |
| .wkt | one geometry a line, in well-known text |
| .gpkg, .shp | features of a layer, read by pyogrio (extra ``gis``) |

Attributes ``joint`` and ``set`` of a line name its joint and its set.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import CaseError, shortened
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing import DEFAULT_JOINT, Polyline
from clast.rockmass.drawings.drawing_files import checked_file, text_of
from clast.rockmass.drawings.drawn_loops import Loop, ring, without_repeats


@dataclass(frozen=True, kw_only=True, eq=False)
class Feature:
    """A geometry with its attributes."""

    shape: Any
    """shapely geometry, in units of the file."""
    attributes: Mapping[str, str]
    """Attributes by name, in small letters, as texts."""
    place: str
    """Where it stands in the file."""


def features_of(
    path: Path, layer: str | None = None, select: Mapping[str, str] | None = None
) -> list[Feature]:
    """Return the features of a file whose attributes are those of ``select``, case-blind.

    Raises CaseError for files that cannot be read, for attributes that no feature has, and where
    nothing is left.
    """
    features = list(READERS[path.suffix.casefold()](path, layer))
    for feature in features:
        at = shapely.get_coordinates(feature.shape)
        if not np.isfinite(at).all() or np.abs(at).max(initial=0.0) > 1e12:
            what = "has a coordinate that is not a finite number, or far too large a one"
            raise CaseError(what, where=f"{path}: {feature.place}", remedy="draw it anew")
    known = {name for one in features for name in one.attributes}
    for name, value in (select or {}).items():
        key = name.casefold()
        spelling.require_known(key, sorted(known), kind="attribute", where=f"{path}: select")
        values = sorted({one.attributes.get(key, "") for one in features})
        features = [one for one in features if one.attributes.get(key, "") == value]
        if not features:
            what = f"no feature has {shortened(name)} = '{shortened(value)}'"
            remedy = spelling.advice(value, values, kind="value")
            raise CaseError(what, where=f"{path}: select", remedy=remedy)
    if not features:
        raise CaseError("has no features", where=str(path), remedy="name another file or layer")
    return features


def feature_lines(
    path: Path, layer: str | None = None, select: Mapping[str, str] | None = None
) -> tuple[tuple[Polyline, ...], tuple[str, ...]]:
    """Return the lines of a file, m, with their joints and sets, and the notes on it."""
    lines, left = [], []
    for one in features_of(path, layer, select):
        for part in shapely.get_parts(one.shape):
            points = without_repeats(shapely.get_coordinates(part), 0.0)
            if part.geom_type not in ("LineString", "LinearRing") or len(points) < 2:
                left.append(f"{one.place}: left out: {part.geom_type}, not a line of some length")
                continue
            joint = one.attributes.get("joint") or DEFAULT_JOINT
            group = one.attributes.get("set", "")
            lines.append(Polyline(points=points, joint=joint, joint_set=group, place=one.place))
    if not lines:
        what, remedy = "has no lines", "give LineString or MultiLineString geometries"
        raise CaseError(what, where=str(path), remedy=remedy)
    return tuple(lines), (*left, *_about(np.concatenate([one.points for one in lines])))


def feature_outline(
    path: Path, layer: str | None = None, select: Mapping[str, str] | None = None
) -> tuple[Floats, tuple[str, ...]]:
    """Return the one polygon of a file, m, (n, 2), counter-clockwise, and the notes on it."""
    features = features_of(path, layer, select)
    parts = [(part, one) for one in features for part in shapely.get_parts(one.shape)]
    if len(parts) != 1 or parts[0][0].geom_type != "Polygon" or len(parts[0][0].interiors):
        kinds = ", ".join(part.geom_type for part, _ in parts[:5])
        what = f"has {len(parts)} parts ({kinds}), not one polygon without holes"
        remedy = "choose one by select, and give holes as [[opening]]"
        raise CaseError(what, where=str(path), remedy=remedy)
    corners = shapely.get_coordinates(parts[0][0].exterior)[:-1]
    place = parts[0][1].place
    points, notes = ring(Loop(points=corners, place=place), "the outline", str(path))
    return points, (*notes, *_about(points))


def _about(points: Floats) -> Iterator[str]:
    """Yield the note on coordinates, m, (n, 2), that are far from zero."""
    middle, size = points.mean(axis=0), float(np.hypot(*np.ptp(points, axis=0)))
    if np.abs(middle).max() > 10.0 * size:
        yield (
            f"coordinates are metres near ({middle[0]:.6g}, {middle[1]:.6g}); the run computes "
            "about a local origin there, and results have these coordinates again"
        )


def _geojson(path: Path, layer: str | None) -> Iterator[Feature]:
    remedy = "export it again as GeoJSON"
    try:
        content = json.loads(text_of(path))
    except (ValueError, RecursionError) as error:
        what = f"is not GeoJSON that can be read: {shortened(str(error), 100)}"
        raise CaseError(what, where=str(path), remedy=remedy) from None
    found = content.get("features", [content]) if isinstance(content, dict) else None
    if not isinstance(found, list):
        what = "is not GeoJSON: it has no list of features"
        raise CaseError(what, where=str(path), remedy=remedy)
    for number, one in enumerate(found, 1):
        place = f"feature {number}"
        try:
            geometry = one.get("geometry", one)
            if geometry is None:
                continue
            shape = shapely.force_2d(shapely.from_geojson(json.dumps(geometry)))
            yield Feature(shape=shape, attributes=_texts(one.get("properties")), place=place)
        except (AttributeError, RecursionError, shapely.errors.ShapelyError):
            what = "has no geometry that can be read, such as a LineString of two points [x, y]"
            raise CaseError(what, where=f"{path}: {place}", remedy=remedy) from None


def _wkt(path: Path, layer: str | None) -> Iterator[Feature]:
    for number, line in enumerate(text_of(path).split("\n"), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                with np.errstate(invalid="ignore"):  # nan is refused below, with its place
                    shape = shapely.force_2d(shapely.from_wkt(line.strip()))
            except shapely.errors.ShapelyError as error:
                what = f"is not well-known text: {shortened(_said(error), 100)}"
                remedy = "write one geometry a line, such as LINESTRING (0 0, 5 3)"
                raise CaseError(what, where=f"{path}: line {number}", remedy=remedy) from None
            yield Feature(shape=shape, attributes={}, place=f"line {number}")


def _said(error: Exception) -> str:
    """Return the message of a reader of geometries, without the name of its kind of error."""
    return str(error).partition(": ")[2] or str(error)


def _layers(path: Path, layer: str | None) -> Iterator[Feature]:
    checked_file(path)
    try:
        from pyogrio import raw
    except ImportError:
        what = "GeoPackages and shapefiles are read by pyogrio, which is not installed"
        remedy = 'install it: pip install "clast[gis]", or export GeoJSON'
        raise CaseError(what, where=str(path), remedy=remedy) from None
    try:
        meta, _, shapes, columns = raw.read(path, layer=layer, force_2d=True)
    except Exception as error:  # damaged files end in errors of many kinds
        what = f"cannot be read: {shortened(str(error), 150)}"
        raise CaseError(what, where=str(path), remedy="check the file and its layer") from None
    names = [str(name) for name in meta["fields"]]
    for number, shape in enumerate(shapes):
        if shape is not None:
            values = {name: column[number] for name, column in zip(names, columns, strict=True)}
            yield Feature(
                shape=shapely.from_wkb(shape),
                attributes=_texts(values),
                place=f"feature {number + 1}",
            )


def _texts(values: Mapping[str, Any] | None) -> dict[str, str]:
    """Return attributes as texts, by names in small letters."""
    return {
        str(name).casefold(): "" if value is None else str(value)
        for name, value in (values or {}).items()
    }


READERS: dict[str, Callable[[Path, str | None], Iterator[Feature]]] = {
    ".geojson": _geojson,
    ".json": _geojson,
    ".wkt": _wkt,
    ".gpkg": _layers,
    ".shp": _layers,
}
"""Ending of a file's name -> who reads its features."""
