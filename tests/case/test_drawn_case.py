"""The case file of a drawing: valid TOML, every table a case, nothing made up, nothing lost."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.drawn_case import TO_BE_GIVEN, case_text, cut_of
from clast.errors import CaseError
from clast.rockmass.drawings.drawing import Drawing, DrawnOutline, Polyline, Spot
from clast.rockmass.readers import Reading, read_drawing
from scenes import legacy_files


@pytest.fixture
def shi(tmp_path: Path) -> Drawing:
    (tmp_path / "slope.geo").write_text(legacy_files.GEOMETRY)
    (tmp_path / "slope.ana").write_text(legacy_files.ANALYSIS)
    reading = Reading(mass_unit=1000.0)
    return read_drawing(tmp_path / "slope.geo", tmp_path / "slope.ana", reading)


@pytest.fixture
def dda(tmp_path: Path) -> Drawing:
    (tmp_path / "slope.xml").write_text(legacy_files.XML)
    return read_drawing(tmp_path / "slope.xml", reading=Reading(mass_unit=1000.0))


def unbroken(text: str) -> str:
    """Return the words of a text: where its comments break depends on the name of the file."""
    return " ".join(text.replace("#", " ").split())


def without_cutting(content: dict[str, Any]) -> dict[str, Any]:
    """Return what is left for a case of one block, the outline of the domain."""
    tables = {key: value for key, value in content.items() if key not in ("trace", "opening")}
    domain = tables.pop("domain")
    block = {"vertices": domain["boundary"], "rock": domain["rock"], "name": "all"}
    return {**tables, "block": [block]}


@pytest.mark.parametrize("kind", ["shi", "dda"])
def test_a_legacy_file_makes_a_whole_case(kind, request):
    """All tables but those of cutting are checked by the case file's own models."""
    content = tomllib.loads(case_text(request.getfixturevalue(kind)))
    assert TO_BE_GIVEN not in str(content)
    content["joint"]["default"] = content["joint"].pop("type-3")  # for want of edges with joints
    content["joint"]["type-2"]["between_rocks"] = [["rock-1", "rock-1"]]
    case = Case.validated(without_cutting(content), "slope.toml")
    model = case.model()
    assert {rock.name: rock.density for rock in model.rocks}["rock-1"] == 2700.0
    assert len(model.fixed_points.at) == 1 and model.measured_points.name == ("M1",)
    assert model.gravity.tolist() == [0.0, -9.8]
    assert (case.time.step, case.time.end, case.time.max_displacement) == (0.001, 0.1, 0.05)
    assert case.time.dynamic_ratio == 1.0
    assert case.joint["type-2"].cohesion == 5000.0
    assert content["rock"]["rock-1"]["initial_stress"] == [-1e4, -1e5, 1e3]
    assert [trace["joint"] for trace in content["trace"]] == ["type-2", "type-3"]


def test_what_only_the_xml_says(dda):
    text = case_text(dda)
    content = tomllib.loads(text)
    assert content["plane"] == "strain" and content["output"]["every"] == 0.01
    assert content["point_load"] == [{"at": [10.0, 9.0], "force": [0.0, -5000.0]}]
    assert "t fx fy 0 0 0; 1 0 -7000" in unbroken(text)
    assert "linear rotation" in unbroken(text)


@pytest.mark.parametrize(
    "words",
    [
        "columns 8 to 10 of block material 2: 0 1 0",
        "fixed line (0, 0) to (20, 0)",
        "line of rock-2 (0, 0) to (1, 1)",
        "hole point (15, 7)",
        "load point (10, 9): no force is given",
        "joint type-1, 20 0 0: no trace has it",
        "velocity (1.0, 0.0, 0.5) of rock-2",
        "joint of type-2 at (5, 5) m: it has no length",
        "# smallest_edge = 0.00625",
        "# stiffness = 500000.0",
        "# start = [2.0, 2.0]",
        "the unit of mass is 1000 kg",
    ],
)
def test_what_is_not_taken_over_stands_in_comments(shi, words):
    text = case_text(shi)
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert words.replace("#", "").strip() in " ".join(line[1:].strip() for line in comments)


def test_weights_that_no_one_gravity_gives_are_named(tmp_path):
    (tmp_path / "g.dat").write_text(legacy_files.GEOMETRY)
    (tmp_path / "a.dat").write_text(legacy_files.ANALYSIS.replace("24.50", "30"))
    text = case_text(read_drawing(tmp_path / "g.dat", tmp_path / "a.dat"))
    assert "weight 30 N/m3 of rock-2: a case has one gravity, 9.8 m/s2" in unbroken(text)


def test_a_drawing_asks_for_what_it_cannot_know(tmp_path):
    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    corners = [(0, 0), (20100, 0), (20000, 10000), (0, 10000)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "BOUNDARY"})
    bed = [(0, 0), (9000, 0), (9000, 3000.3)]
    space.add_lwpolyline(bed, close=True, dxfattribs={"layer": "REGIONS_shale"})
    space.add_circle((9000, 6000), 1000, dxfattribs={"layer": "OPENINGS_heading"})
    space.add_line((0, 3000), (20000, 4000), dxfattribs={"layer": "JOINTS_bedding"})
    space.add_line((0, 0), (0, 3000), dxfattribs={"layer": "BOLTS_swellex"})
    document.saveas(tmp_path / "site.dxf")
    content = tomllib.loads(case_text(read_drawing(tmp_path / "site.dxf")))
    assert content["domain"]["boundary"] == [[0, 0], [20.1, 0], [20, 10], [0, 10]]
    assert content["region"][0]["polygon"] == [[0, 0], [9, 0], [9, 3.0003]]
    assert content["region"][0]["rock"] == "shale"
    assert content["opening"][0]["name"] == "heading" and content["opening"][0]["excavated"]
    assert content["trace"] == [{"points": [[0, 3], [20, 4]], "joint": "bedding"}]
    assert set(content["rock"]) == {"rock", "shale"} and set(content["joint"]) == {
        "default",
        "bedding",
    }
    with pytest.raises(CaseError, match="must be a number, not 'to be given'"):
        Case.validated(without_cutting({k: v for k, v in content.items() if k != "region"}), "x")


def test_no_name_breaks_the_text():
    nasty = 'a"b\\c\n[rock.x]\x00\x7f\u202e'
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)])
    drawing = Drawing(
        file=f"{nasty}.dxf",
        boundary=square,
        boundary_rock=nasty,
        traces=(Polyline(points=square, joint=nasty, place=nasty),),
        openings=(DrawnOutline(name=nasty, points=square),),
        measured_points=(Spot(name=nasty, at=square[0]),),
        hole_points=(Spot(name=nasty, at=square[0], place=nasty),),
        notes=(nasty, "word " * 200),
    )
    text = case_text(drawing)
    content = tomllib.loads(text)
    assert list(content["rock"]) == list(content["joint"])[1:] == [nasty]
    assert content["opening"][0]["name"] == content["measured_point"][0]["name"] == nasty
    assert max(map(len, (line for line in text.splitlines() if line[:1] == "#"))) <= 98
    assert text.isprintable() or set(c for c in text if not c.isprintable()) <= {"\n", "\u202e"}


def test_a_table_of_traces_has_no_domain_and_says_so(tmp_path):
    (tmp_path / "t.csv").write_text("x1,y1,x2,y2,set\n0,0,1,1,J1\n")
    text = case_text(read_drawing(tmp_path / "t.csv"))
    assert "[domain] needs a boundary" in unbroken(text)
    expected = {"points": [[0, 0], [1, 1]], "joint": "default", "set": "J1"}
    assert tomllib.loads(text)["trace"] == [expected]


def test_a_trace_keeps_its_set():
    """So that a cross-jointed set which is added to the case can end at it."""
    square = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])
    line = np.array([(0.0, 2.0), (4.0, 2.0)])
    drawing = Drawing(
        file="site.dxf",
        boundary=square,
        traces=(
            Polyline(points=line, joint="bed", joint_set="J1"),
            Polyline(points=line + np.array([0.0, 1.0]), joint="bed"),
        ),
    )
    text = case_text(drawing)
    assert [one.get("set") for one in tomllib.loads(text)["trace"]] == ["J1", None]
    assert [one.name for one in cut_of(drawing).cut.report.sets] == ["J1", "traces"]


def test_a_survey_is_named(tmp_path):
    (tmp_path / "t.csv").write_text("dip,dip_direction\n30,120\n40,130\n")
    text = case_text(read_drawing(tmp_path / "t.csv"))
    assert "2 orientations in space" in unbroken(text)
