"""The server of `clast edit --view`: who is let in, and what a window is told."""

import http.client
import json
import threading

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.checking import check
from clast.editor.page import view_text
from clast.editor.section import lines_of, section_of
from clast.editor.view import ViewServer

SLOPE = TEMPLATES["slope"]


@pytest.fixture
def served(tmp_path):
    server = ViewServer(("127.0.0.1", 0), tmp_path / "slope.toml")
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def ask(server, path, method="GET", **headers):
    """Return the answer; ``headers`` replace those of a window."""
    usual = {"Host": f"127.0.0.1:{server.port}", "Authorization": f"Bearer {server.token}"}
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    connection.putrequest(method, path, skip_host=True)
    for name, value in {**usual, **headers}.items():
        if value is not None:
            connection.putheader(name, value.replace("{port}", str(server.port)))
    connection.endheaders()
    return connection.getresponse()


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Authorization": None}, 401),
        ({"Authorization": "Bearer 0123456789abcdefghijklmnopqrstuv"}, 401),
        ({"Host": None}, 403),
        ({"Host": "evil.example:{port}"}, 403),
        ({"Host": "127.0.0.1:1"}, 403),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "https://127.0.0.1:{port}"}, 403),
        ({"Origin": "null"}, 403),
    ],
)
def test_who_is_not_let_in(served, headers, status):
    served.show(check(SLOPE, "slope.toml"))
    answer = ask(served, "/news", **headers)
    assert answer.status == status
    assert b"sandstone" not in answer.read()


def test_the_page_itself_tells_nothing_and_no_other_is_there(served):
    served.show(check(SLOPE, "slope.toml"))
    answer = ask(served, "/", Authorization=None)
    text = answer.read().decode()
    assert answer.status == 200 and "connect-src 'self'" in text
    assert "sandstone" not in text and served.token not in text
    for path in ("/slope.toml", "/../slope.toml", "/news/", "/case"):
        assert ask(served, path).status == 404
    assert ask(served, "/news", method="POST").status == 501


def test_a_window_is_told_each_section_once(served):
    served.show(check(SLOPE, "slope.toml"))
    answer = ask(served, "/news")

    def event():
        kind, data, _ = (answer.readline().decode().strip() for _ in range(3))
        return kind.removeprefix("event: "), json.loads(data.removeprefix("data: "))

    kind, first = event()
    assert (kind, first["blocks"], first["faults"]) == ("section", 23, [])
    served.show(check(SLOPE.replace("friction_angle = ", "friction_angle = 1"), "slope.toml"))
    kind, second = event()
    assert (kind, second["scene"]) == ("section", None)
    assert second["faults"][0]["place"][0] == "joint"
    assert served.pages == 1


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
    assert "<title>&lt;img&gt;.toml - clast</title>" in view_text("<img>.toml")
