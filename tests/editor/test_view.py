"""`clast edit --view`, whose windows look on, and the section that they are shown."""

import json

import pytest

from clast.case.checking import check
from clast.case.templates import TEMPLATES
from clast.editor.page import editor_text
from clast.editor.section import lines_of, section_of
from clast.editor.server import ViewServer
from scenes.edited import asked, edited_file, rock_text, until

SLOPE = TEMPLATES["slope"]


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(SLOPE, "utf-8", newline="")
    return path


def told(server, way, body=None):
    """Return the answer to a request of a window, JSON."""
    return json.loads(asked(server.address, way, body, Window="w")[2])


@pytest.mark.parametrize("way", ["/edit", "/text", "/write", "/start", "/take-over", "/undo"])
def test_nothing_is_changed_by_a_window_that_looks_on(path, way):
    change = {"do": "set", "place": ["title"], "toml": "'other'"}
    with edited_file(path, ViewServer) as server:
        server.looks("w", 1)
        body = {"version": 0, "text": "title = 'other'", "edits": [change]}
        refused = told(server, way, body)["refused"]
    assert "edited in another window" in refused or "is only shown here" in refused
    assert path.read_text("utf-8") == SLOPE
    assert [one.name for one in path.parent.iterdir()] == ["slope.toml"]


def test_a_value_that_is_set_is_shown_and_not_written(path):
    text = SLOPE.replace("friction_angle = 38.0", "friction_angle = 95.0")
    assert text != SLOPE
    path.write_text(text, "utf-8", newline="")
    values = ("title='S'", "joint.bedding.friction_angle=38")
    with edited_file(path, ViewServer, settings=values) as server:
        until(lambda: server.state()["checked"])
        assert server.state()["faults"] == []
        shown = told(server, "/section")
    assert (shown["title"], shown["blocks"]) == ("S", 23)
    assert path.read_text("utf-8") == text


def test_a_file_that_the_case_names_is_looked_at_too(path, tmp_path):
    traces = tmp_path / "traces.csv"
    traces.write_text("x1,y1,x2,y2\n0,1,8,1\n", "utf-8")
    path.write_text(f'{rock_text(8, 4)}[[trace]]\nfile = "traces.csv"\n', "utf-8")
    with edited_file(path, ViewServer) as server:
        until(lambda: server.state()["checked"])
        before = told(server, "/section")["blocks"]
        traces.write_text("x1,y1,x2,y2\n0,1,8,1\n0,2,8,2.1\n", "utf-8")
        until(lambda: server.state()["checked"] and server.state()["blocks"] != before)
        assert told(server, "/section")["blocks"] > before


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_a_section_has_the_blocks_and_the_lines_of_every_template(name):
    found = section_of(check(TEMPLATES[name], "x.toml"))
    json.dumps(found, allow_nan=False)
    if found["scene"] is None:
        assert name == "rockfall"
    else:
        assert len(found["scene"]["blocks"]) == found["blocks"]
    assert found["lines"] and found["title"]


def test_lines_have_the_geometry_of_their_keys():
    content = {
        "domain": {"boundary": [[0, 0], [2, 0], [2, 1]]},
        "trace": [{"points": [[0, 0.5], [2, 0.5]]}, {"file": "a.csv"}],
        "measured_point": [{"name": "A", "at": [1, 1]}],
        "gravity": [0.0, -9.8],
        "reference": [{"point": "A", "displacement": [0.1, 0.2]}],
    }
    assert [(one["place"], one["geometry"], len(one["points"])) for one in lines_of(content)] == [
        (["domain", "boundary"], "polygon", 3),
        (["trace", 0, "points"], "polyline", 2),
        (["measured_point", 0, "at"], "point", 1),
    ]


def test_a_name_of_a_file_is_text_in_the_page():
    assert "<title>&lt;img&gt;.toml - clast</title>" in editor_text("<img>.toml")
