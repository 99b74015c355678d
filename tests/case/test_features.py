"""Traces, outlines and profiles of GeoJSON, WKT, GeoPackage and shapefile."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely

from clast.case.case_file import Case
from clast.errors import ModelError
from clast.rockmass.readers import read_drawing

EAST = np.array([612_000.0, 5_180_000.0])
OUTLINE = shapely.Polygon([(0, 0), (10, 0), (10, 8), (0, 8)])
LINES = {
    "bedding": shapely.LineString([(0, 2, 5), (10, 3, 5)]),
    "fault": shapely.MultiLineString([[(3, 0), (5, 8)], [(7, 0), (8, 8)]]),
}
HEAD = """schema = 1
time = {step = 1e-3, end = 1e-2}
rock.a = {young = 1e9, poisson = 0.2, density = 2e3}
joint.default = {friction_angle = 30}
joint.fault = {friction_angle = 20}
joint.bedding = {friction_angle = 25}
"""


def geojson(path, shapes, shift) -> None:
    features = [
        {
            "type": "Feature",
            "properties": {"Joint": name, "set": f"{name}s", "kind": name, "certain": True},
            "geometry": json.loads(shapely.to_geojson(moved(one, shift))),
        }
        for name, one in shapes.items()
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))


def moved(shape, shift):
    return shapely.transform(shape, lambda at: at + shift)


def wkt(path, shapes, shift) -> None:
    path.write_text("# a comment\n" + "\n".join(moved(one, shift).wkt for one in shapes.values()))


def layers(path, shapes, shift) -> None:
    raw = pytest.importorskip("pyogrio.raw")
    names = np.array(list(shapes), object)
    raw.write(
        path,
        shapely.to_wkb(np.array([moved(shapely.force_2d(one), shift) for one in shapes.values()])),
        [names, np.array([f"{name}s" for name in shapes], object), names],
        ["joint", "set", "kind"],
        geometry_type="Polygon" if "rim" in shapes else "MultiLineString",
        promote_to_multi="rim" not in shapes,
        crs="EPSG:32632",
    )


WRITERS = {".geojson": geojson, ".json": geojson, ".wkt": wkt, ".gpkg": layers, ".shp": layers}


def cut(folder, domain: str, traces: str):
    (folder / "a.toml").write_text(f"{HEAD}domain = {{{domain}}}\n{traces}", encoding="utf-8")
    case = Case.from_toml(folder / "a.toml")
    return case.cut(), case


@pytest.mark.parametrize("shift", [np.zeros(2), EAST])
@pytest.mark.parametrize("ending", WRITERS)
def test_what_is_drawn_is_cut_as_in_the_case(tmp_path, ending, shift):
    WRITERS[ending](tmp_path / f"rim{ending}", {"rim": OUTLINE}, shift)
    WRITERS[ending](tmp_path / f"lines{ending}", LINES, shift)
    found, case = cut(
        tmp_path, f'boundary = {{file = "rim{ending}"}}', f'trace = [{{file = "lines{ending}"}}]'
    )
    corners = (shapely.get_coordinates(OUTLINE)[:-1] + shift).tolist()
    parts = [
        {"joint": name, "points": (shapely.get_coordinates(part) + shift).tolist()}
        for name, one in LINES.items()
        for part in shapely.get_parts(one)
    ]
    named = ending != ".wkt"
    tables = "".join(
        f"[[trace]]\npoints = {one['points']}\n" + f"joint = '{one['joint']}'\n" * named
        for one in parts
    )
    same, _ = cut(tmp_path, f"boundary = {corners}", tables)
    np.testing.assert_array_equal(found.cut.vertices, same.cut.vertices)
    assert found.edge_joints == same.edge_joints
    assert found.cut.block_count == 6
    assert any("local origin" in one for one in found.notes) == bool(shift.any())
    if not named:
        return
    # the run computes about a local origin, and knows where that is
    model = case.model()
    assert np.abs(model.vertices).max() < 100.0 and (model.origin != 0.0).any() == shift.any()
    assert {one.name for one in found.cut.report.sets} >= {"beddings", "faults"}
    rim, drawn = (read_drawing(tmp_path / f"{name}{ending}") for name in ("rim", "lines"))
    assert sorted(rim.boundary.tolist()) == sorted(corners) and len(drawn.traces) == 3


@pytest.mark.parametrize("ending", [".geojson", ".gpkg", ".shp"])
def test_attributes_choose(tmp_path, ending):
    WRITERS[ending](tmp_path / f"lines{ending}", LINES, np.zeros(2))
    corners = shapely.get_coordinates(OUTLINE)[:-1].tolist()
    domain, file = f"boundary = {corners}", f'file = "lines{ending}"'
    found, _ = cut(tmp_path, domain, f'trace = [{{{file}, select = {{Kind = "fault"}}}}]')
    assert found.cut.block_count == 3
    assert "fault" in found.edge_joints and "bedding" not in found.edge_joints
    for select, said in (
        ('{kind = "folt"}', "(?s)no feature has kind = 'folt'.*did you mean 'fault'"),
        ('{king = "fault"}', "(?s)no attribute 'king'.*did you mean 'kind'"),
    ):
        with pytest.raises(ModelError, match=said):
            cut(tmp_path, domain, f"trace = [{{{file}, select = {select}}}]")


def test_a_profile_of_features(tmp_path):
    ground = [[0, 0], [20, 0], [32, 18], [40, 18]]
    (tmp_path / "p.wkt").write_text(
        "LINESTRING (20 0, 0 0)\nLINESTRING Z (20 0 1, 32 18 1, 40 18 1)"
    )
    line = "trace = [{points = [[-1, -2], [41, -3]]}]"
    found, _ = cut(tmp_path, 'profile = {file = "p.wkt"}, depth = 5.0', line)
    same, _ = cut(tmp_path, f"profile = {ground}, depth = 5.0", line)
    np.testing.assert_array_equal(found.cut.vertices, same.cut.vertices)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.wkt", "LINESTRING (0 0, 1 1)\nLINE (0 0)", "line 2: is not well-known text"),
        ("a.wkt", "POINT (0 0)", "has no lines"),
        ("a.wkt", "\n", "has no features"),
        ("a.wkt", "LINESTRING (0 0, nan 1)", "not a finite number"),
        ("a.geojson", "{", "is not GeoJSON"),
        ("a.geojson", "[1]", "is not GeoJSON"),
        ("a.geojson", '{"type": "FeatureCollection", "features": 3}', "is not GeoJSON"),
        ("a.geojson", '{"type": "Feature", "geometry": {"type": "Line"}}', "feature 1: has no geo"),
        ("a.geojson", '{"type": "LineString", "coordinates": [[1e999, 0], [1, 1]]}', "feature 1: "),
        ("a.svg", "", "give a drawing"),
    ],
)
def test_features_that_are_none(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(ModelError, match=said):
        cut(tmp_path, "boundary = [[0, 0], [1, 0], [1, 1]]", f'trace = [{{file = "{name}"}}]')


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ('file = "a.wkt", layer = "A"', "a WKT file has no layer"),
        ('file = "a.wkt", select = {a = "b"}', "a WKT file has no select"),
        ('file = "a.geojson", unit = "mm"', "a GEOJSON file has no unit"),
        ('file = "a.dxf", layer = "A", select = {a = "b"}', "a DXF file has no select"),
        ('file = "a.wkt"', "has 2 parts .LineString, LineString., not one polygon"),
    ],
)
def test_outlines_that_are_none(tmp_path, source, said):
    (tmp_path / "a.wkt").write_text("LINESTRING (0 0, 1 1)\nLINESTRING (0 0, 1 3)")
    with pytest.raises(ModelError, match=said):
        cut(tmp_path, f"boundary = {{{source}}}", "")
