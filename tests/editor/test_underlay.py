"""Drawings and pictures under the section: what is read, from where, and how the list is kept."""

import json
import math

import ezdxf
import numpy as np
import pytest

from clast.case.case_file import Case
from clast.editor.document import Document
from clast.editor.starting import started, templates
from clast.editor.underlay import (
    Underlay,
    Underlays,
    beside,
    drawn,
    files_beside,
    keep,
    picture,
    underlays_of,
)
from clast.errors import CaseError
from clast.rockmass.readers import read_drawing

PNG = b"\x89PNG\r\n\x1a\n and what follows"
RIM = [(0, 0), (20_000, 0), (20_000, 10_000), (0, 10_000)]


@pytest.fixture
def case(tmp_path):
    """Return the path of a case beside a drawing in millimetres and a picture."""
    folder = tmp_path / "site"
    folder.mkdir()
    document = ezdxf.new("R2010", units=4)
    sheet = document.modelspace()
    for one, other in zip(RIM, RIM[1:] + RIM[:1], strict=True):
        sheet.add_line(one, other, dxfattribs={"layer": "BOUNDARY"})
    sheet.add_line((0, 2_000), (20_000, 2_500), dxfattribs={"layer": "JOINTS_bedding"})
    tunnel = [(8_000, 3_000, 0), (12_000, 3_000, 0), (12_000, 5_000, 1), (8_000, 5_000, 0)]
    there = {"layer": "OPENINGS_heading"}
    sheet.add_lwpolyline(tunnel, format="xyb", close=True, dxfattribs=there)
    sheet.add_lwpolyline([(0, 7_000), (20_000, 4_000)], dxfattribs={"layer": "Wasser"})
    document.saveas(folder / "site.dxf")
    (folder / "scan.png").write_bytes(PNG)
    return folder / "site.toml"


def test_lines_are_those_that_import_reads(case):
    found, drawing = drawn(case, "site.dxf"), read_drawing(case.parent / "site.dxf")
    outlines = {one["layer"]: one for one in found["outlines"]}
    np.testing.assert_allclose(outlines["BOUNDARY"]["points"], drawing.boundary, atol=1e-9)
    opening = drawing.openings[0]
    assert outlines["OPENINGS_heading"]["name"] == opening.name == "heading"
    expected = opening.points
    # the same curve, flattened in a drawing with another layer read: chords may differ
    assert len(outlines["OPENINGS_heading"]["points"]) == len(expected)
    np.testing.assert_allclose(outlines["OPENINGS_heading"]["points"], expected, atol=1e-9)
    lines = {one["layer"]: one for one in found["lines"] if one["layer"] != "BOUNDARY"}
    trace = drawing.traces[0]
    np.testing.assert_allclose(lines["JOINTS_bedding"]["points"], trace.points)
    assert lines["JOINTS_bedding"]["name"] == trace.joint
    assert lines["Wasser"]["points"] == [[0.0, 7.0], [20.0, 4.0]]
    closed = lines["OPENINGS_heading"]["points"]
    assert closed[0] == closed[-1]
    assert any("millimetres" in note for note in found["notes"])


def test_lines_of_a_map_and_of_a_table_are_read(case):
    shapes = {"type": "LineString", "coordinates": [[0, 1], [4, 2]]}
    feature = {"type": "Feature", "properties": {"joint": "fault"}, "geometry": shapes}
    (case.parent / "map.geojson").write_text(json.dumps(feature))
    (line,) = drawn(case, "map.geojson")["lines"]
    assert line == {"layer": "JOINTS_fault", "name": "fault", "points": [[0, 1], [4, 2]]}
    (case.parent / "rim.csv").write_text("x,y\n0,0\n4,0\n4,3\n")
    found = drawn(case, "rim.csv")
    assert found["outlines"][0]["points"] == [[0, 0], [4, 0], [4, 3]]
    assert found["lines"][0]["points"] == [[0, 0], [4, 0], [4, 3], [0, 0]]


def test_outlines_stay_where_other_lines_of_the_layer_are_open(case, tmp_path):
    document = ezdxf.new("R2010", units=6)
    sheet = document.modelspace()
    sheet.add_lwpolyline([(0, 0), (4, 0), (4, 3)], close=True)
    sheet.add_line((0, 1), (9, 1))
    document.saveas(case.parent / "one.dxf")
    found = drawn(case, "one.dxf")
    assert [one["points"] for one in found["outlines"]] == [[[0, 0], [4, 0], [4, 3]]]
    assert len(found["lines"]) == 2


@pytest.mark.parametrize("far", [math.nan, math.inf])
def test_points_at_no_place_are_refused(case, far):
    document = ezdxf.new("R2010", units=6)
    document.modelspace().add_lwpolyline([(0, 0), (far, 0), (4, 3)])
    document.saveas(case.parent / "far.dxf")
    with pytest.raises(CaseError):
        drawn(case, "far.dxf")


def test_texts_are_no_lines(case):
    document = ezdxf.new("R2010", units=6)
    document.modelspace().add_mtext("Section A", dxfattribs={"insert": (1, 2)})
    document.modelspace().add_text("north")
    document.modelspace().add_point((3, 4))
    document.saveas(case.parent / "words.dxf")
    assert [one["points"] for one in drawn(case, "words.dxf")["lines"]] == [[[3, 4]]]


def test_too_many_points_are_refused(case, monkeypatch):
    monkeypatch.setattr("clast.editor.underlay.POINTS_MAX", 10)
    with pytest.raises(CaseError, match="has more than 10 points"):
        drawn(case, "site.dxf")


def test_no_file_elsewhere_is_read(case, tmp_path):
    (tmp_path / "secret.png").write_bytes(PNG)
    (case.parent / "link.png").symlink_to(tmp_path / "secret.png")
    (case.parent / "loop.png").symlink_to(case.parent / "loop.png")
    elsewhere = ["../secret.png", str(tmp_path / "secret.png"), "link.png", "", "a\0b"]
    for name in elsewhere:
        with pytest.raises(CaseError, match="is not in the folder of the case"):
            beside(case, name)
        with pytest.raises(CaseError):
            keep(case, Underlays(underlays=[Underlay(file=name)]))
        with pytest.raises(CaseError):
            picture(case, name)
    for name in ("loop.png", "none.dxf", "."):
        with pytest.raises(CaseError):
            drawn(case, name)
    assert underlays_of(case) == (Underlays(), "")


def test_a_picture_is_one_by_its_content(case):
    assert picture(case, "scan.png") == ("image/png", PNG)
    (case.parent / "text.png").write_text("<svg/>")
    with pytest.raises(CaseError, match="is not a picture"):
        picture(case, "text.png")


def test_the_list_is_kept_beside_the_case_and_a_broken_one_is_told(case):
    one = Underlay(file="scan.png", pixels=((0, 0), (9, 0)), points=((1, 2), (3, 2)), locked=True)
    keep(case, Underlays(underlays=[one]))
    assert underlays_of(case) == (Underlays(underlays=[one]), "")
    assert sorted(one.name for one in case.parent.iterdir()) == [
        "scan.png",
        "site.dxf",
        "site.edit.json",
    ]
    for broken in ("{", "[]", '{"underlays": [{"file": "x", "opacity": 7}]}', "\xff"):
        (case.parent / "site.edit.json").write_text(broken, "latin-1")
        found, trouble = underlays_of(case)
        assert found == Underlays()
        assert trouble.startswith("site.edit.json is left unread")
    (case.parent / "site.edit.json").unlink()
    (case.parent / "site.edit.json").mkdir()
    assert "is left unread" in underlays_of(case)[1]


def test_files_are_offered_from_the_folder_and_a_little_below(case):
    for folder in ("maps/old/older", ".git"):
        (case.parent / folder).mkdir(parents=True)
        (case.parent / folder / "a.dxf").write_text("")
    (case.parent / "maps" / "m.JPG").write_text("")
    (case.parent / "notes.txt").write_text("")
    (case.parent / "site.edit.json").write_text("{}")
    assert files_beside(case) == ["maps/m.JPG", "scan.png", "site.dxf"]


def test_a_new_case_begins_from_nothing_a_template_or_a_drawing(case):
    with pytest.raises(CaseError) as refused:
        Case.from_text(started(case, ""), "site.toml")
    assert {fault.what for fault in refused.value.faults} == {"must be a number, not 'to be given'"}
    assert len(refused.value.faults) == 4
    for one in templates():
        assert Case.from_text(started(case, one["name"]), "new.toml").title == one["title"]
    text = started(case, "site.dxf")
    assert "boundary = [[0.0, 0.0], [20.0, 0.0]" in text
    assert 'joint = "bedding"' in text
    with pytest.raises(CaseError, match="is not in the folder of the case"):
        started(case, "../other.dxf")


def test_a_file_that_is_not_there_is_written_when_it_is_a_case(case):
    document = Document(case)
    document.look()
    assert document.text == ""
    assert not document.unsaved
    document.replace(started(case, ""), 0)
    document.save()
    assert not case.exists()
    document.replace(started(case, "slope"), document.version)
    document.save()
    assert case.read_text("utf-8") == started(case, "slope")
    case.unlink()
    with pytest.raises(CaseError, match="there is no such file"):
        document.look()
