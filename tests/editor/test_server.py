"""The window of a case file over HTTP: who is let in, and what a request does to the file."""

import http.client
import json
import socket
import zlib

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.checking import check
from clast.case.templates import TEMPLATES
from clast.editor.page import editor_text
from clast.editor.server import BYTES_MAX, EditHandler
from scenes.edited import edited_file, until

WHERE = ["joint", "bedding", "friction_angle"]


@pytest.fixture
def served(tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(TEMPLATES["slope"], "utf-8", newline="")
    with edited_file(path) as server:
        yield server


def ask(server, path, body=None, **headers):
    """Return status and text of an answer; ``headers`` replace those of the window."""
    usual = {"Host": f"127.0.0.1:{server.port}", "Authorization": f"Bearer {server.token}"}
    given = {name: value for name, value in {**usual, **headers}.items() if value is not None}
    content = None if body is None else json.dumps(body).encode()
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    connection.putrequest("GET" if body is None else "POST", path, skip_host=True)
    for name, value in given.items():
        connection.putheader(name, value)
    if content is not None:
        connection.putheader("Content-Length", str(len(content)))
    connection.endheaders(content)
    answer = connection.getresponse()
    found = answer.status, answer.read().decode()
    connection.close()
    return found


def done(server, path, **body):
    status, text = ask(server, path, {"version": server.document.version, **body})
    assert status == 200, text
    return json.loads(text)


def friction(server, toml):
    return done(server, "/edit", edits=[{"do": "set", "place": WHERE, "toml": toml}])


WRONG = [
    ({"Authorization": None}, 401),
    ({"Authorization": "Bearer 0123456789abcdefghijklmnopqrstuv"}, 401),
    ({"Host": "evil.example"}, 403),
    ({"Host": "127.0.0.1.evil.example"}, 403),
    ({"Origin": "http://evil.example"}, 403),
    ({"Origin": "null"}, 403),
]
READ = ["/case", "/news", "/section", "/underlays"]
READ += ["/ran", "/scene", "/page", "/events?from=0", "/under?a.png"]
WRITE = ["/edit", "/text", "/undo", "/save", "/write", "/begin", "/underlays"]
WRITE += ["/start", "/stop", "/look", "/do"]


@pytest.mark.parametrize(("headers", "status"), WRONG)
@pytest.mark.parametrize(
    ("path", "body"),
    [
        *((path, None) for path in READ),
        *((path, {"version": 0, "text": "x = 1"}) for path in WRITE),
    ],
)
def test_pages_of_others_neither_read_nor_write(served, path, body, headers, status):
    before = served.document.text
    assert ask(served, path, body, **headers)[0] == status
    assert served.document.text == before
    assert served.runs.shown is None


def test_bodies_of_answers_do_not_wait_for_the_receipt_of_their_heads(served, monkeypatch):
    found, setup = [], EditHandler.setup

    def looked(handler):
        setup(handler)
        found.append(handler.connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))

    monkeypatch.setattr(EditHandler, "setup", looked)
    assert ask(served, "/case")[0] == 200
    assert found
    assert all(found)


def test_no_other_file_is_read(served):
    for path in ("/slope.toml", "/../slope.toml", "/etc/passwd", "/case/../../etc/passwd"):
        assert ask(served, path)[0] == 404
        assert ask(served, path, {"version": 0})[0] == 404


@pytest.mark.parametrize("file", ["/etc/passwd", "../slope.toml", "slope.toml", ""])
def test_underlays_are_files_of_the_case_that_are_pictures(served, tmp_path, file):
    body = {"underlays": [{"file": file}]}
    for name in (file, f"{file}.png"):
        assert [*json.loads(ask(served, f"/under?{name}")[1])] == ["trouble"]
    answer = json.loads(ask(served, "/underlays", body)[1])
    assert ("refused" in answer) == (file != "slope.toml")
    assert (tmp_path / "slope.edit.json").exists() == (file == "slope.toml")
    assert ask(served, "/underlays", {"underlays": [{"file": "a", "opacity": 2}]})[0] == 400


@pytest.mark.parametrize(
    "body",
    [
        [],
        {},
        {"version": "0"},
        {"version": 0, "edits": [{"do": "run", "place": ["title"]}]},
        {"version": 0, "edits": [{"do": "set", "place": [{}], "toml": "1"}]},
        {"version": 0, "file": "/etc/passwd"},
    ],
    ids=str,
)
def test_what_no_window_asks_for_is_refused(served, body):
    assert ask(served, "/edit", body)[0] == 400
    assert served.document.version == 0


def test_a_text_may_not_be_of_any_length(served):
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=20)
    connection.putrequest("POST", "/text")
    connection.putheader("Content-Length", str(BYTES_MAX + 1))
    connection.endheaders()
    assert connection.getresponse().status == 413


def test_the_page_has_the_name_of_the_file_and_runs_its_own_scripts(served):
    status, text = ask(served, "/", Authorization=None)
    assert status == 200
    assert text == editor_text("slope.toml")
    assert "connect-src 'self'" in text
    assert "<b>.toml" not in editor_text("<b>.toml")
    assert served.token not in text


def test_the_page_is_small():
    """As it lies in the wheel: compressed, with all libraries and the drawing of pages."""
    assert len(zlib.compress(editor_text("a.toml").encode(), 6)) < 100_000


def test_a_fault_has_its_place_and_line(served, tmp_path):
    state = friction(served, "95.0")
    assert state["refused_as_case"]
    (fault,) = state["faults"]
    assert fault["place"] == WHERE
    assert fault["what"] == "must be below 90, not 95.0"
    line = state["text"].split("\n")[fault["line"] - 1]
    assert line.startswith("friction_angle = 95.0 ")
    assert state["unsaved"]
    assert friction(served, "36.50")["faults"] == []
    until(lambda: not served.document.unsaved)
    expected = TEMPLATES["slope"].replace("friction_angle = 38.0 ", "friction_angle = 36.50 ")
    assert (tmp_path / "slope.toml").read_text("utf-8") == expected
    until(
        lambda: (
            json.loads(ask(served, "/case")[1])["literals"][
                json.dumps(WHERE, separators=(",", ":"))
            ]
            == "36.50"
        )
    )
    assert done(served, "/undo")["text"].count("95.0") == 1
    assert done(served, "/undo")["text"] == TEMPLATES["slope"]
    until(lambda: (tmp_path / "slope.toml").read_text("utf-8") == TEMPLATES["slope"])
    assert done(served, "/redo")["text"].count("95.0") == 1


def test_a_late_request_changes_nothing_and_is_told(served):
    friction(served, "36.5")
    status, text = ask(served, "/undo", {"version": 0})
    assert status == 200
    assert json.loads(text)["late"]
    assert "36.5" in served.document.text


def test_a_text_that_is_no_toml_is_kept_in_the_window(served, tmp_path):
    state = done(served, "/text", text="[time\n")
    assert state["content"] is None
    assert state["faults"][0]["line"] == 1
    refused = friction(served, "30")
    assert "is not TOML" in refused["refused"]
    done(served, "/save")
    assert (tmp_path / "slope.toml").read_text("utf-8") == TEMPLATES["slope"]
    done(served, "/write")
    assert (tmp_path / "slope.toml").read_text("utf-8") == "[time\n"


def test_what_others_write_comes_as_news(served, tmp_path):
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=20)
    connection.request("GET", "/news", headers={"Authorization": f"Bearer {served.token}"})
    news = connection.getresponse()

    def heard():
        while news.readline() != b"event: case\n":  # others are of runs
            pass
        data = json.loads(news.readline().removeprefix(b"data: "))
        news.readline()
        return data

    assert heard()["version"] == 0
    (tmp_path / "slope.toml").write_text(TEMPLATES["wall"], "utf-8")
    until(lambda: heard()["text"] == TEMPLATES["wall"])
    connection.close()


def test_numbers_without_end_and_dates_are_shown(served):
    state = done(served, "/text", text="a = inf\nb = nan\nc = 1979-05-27\nd = [1e9]\n")
    assert state["content"] == {"a": "inf", "b": "nan", "c": "1979-05-27", "d": [1e9]}
    assert state["literals"]['["d",0]'] == "1e9"


def test_both_hands_are_told_of_a_conflict(served, tmp_path):
    friction(served, "95.0")
    (tmp_path / "slope.toml").write_text(TEMPLATES["wall"], "utf-8")
    until(lambda: served.document.conflict is not None)
    assert done(served, "/keep-theirs")["text"] == TEMPLATES["wall"]


def test_the_check_is_that_of_clast_check(served):
    """Its words, places and lines are the same, for what the case alone and the blocks show."""
    until(lambda: served.state()["checked"])
    state = served.state()
    expected = check(TEMPLATES["slope"], str(served.document.path)).as_dict()
    assert {key: state[key] for key in expected} == expected
    text = TEMPLATES["slope"].replace("at = [16.8, 23.8]", "at = [168, 23.8]")
    assert text != TEMPLATES["slope"]
    done(served, "/text", text=text)
    until(lambda: served.state()["faults"])
    state = served.state()
    assert state["faults"] == check(text, str(served.document.path)).as_dict()["faults"]
    assert not state["refused_as_case"]
    until(lambda: not served.document.unsaved)


def test_what_moves_shows_the_lines_that_will_cut(served):
    where, text = ["joint_set", 0, "spacing"], TEMPLATES["slope"]
    body = {"edits": [{"do": "set", "place": where, "toml": "2.5"}], "gesture": "slider 1"}
    lines = np.reshape(done(served, "/move", **body)["lines"], (-1, 2, 2))
    case = Case.from_text(text.replace("spacing = 3.5", "spacing = 2.5"), "slope.toml")
    np.testing.assert_allclose(lines, case.lines(), atol=1e-4)
    along = lines[:, 1] - lines[:, 0]
    beds = lines[np.isclose(along[:, 1], np.tan(np.radians(-35.0)) * along[:, 0], atol=1e-3)]
    normal = np.array([np.sin(np.radians(35.0)), np.cos(np.radians(35.0))])
    offsets = np.unique(np.round((beds[:, 0] - [25.5, 7.0]) @ normal / 2.5, 2))
    assert len(offsets) > 5
    np.testing.assert_allclose(np.diff(offsets), 1.0)
    np.testing.assert_allclose(offsets % 1.0, 0.0)
    body["edits"][0]["toml"] = "-1"
    assert done(served, "/move", **body)["lines"] == []


def test_ends_of_lines_stay_those_of_the_file(served, tmp_path):
    path, text = tmp_path / "slope.toml", TEMPLATES["slope"]
    path.write_bytes(text.replace("\n", "\r\n").encode())
    until(lambda: "\r\n" in served.document.text)
    done(served, "/text", text=text.replace("38.0", "36.0"))
    until(lambda: not served.document.unsaved)
    assert path.read_bytes() == text.replace("38.0", "36.0").replace("\n", "\r\n").encode()


def test_a_second_window_looks_on_and_takes_over(served):
    def post(window, way="/edit", toml='"one"'):
        edits = [{"do": "set", "place": ["title"], "toml": toml}] if way == "/edit" else []
        body = {"version": served.document.version, "edits": edits}
        return json.loads(ask(served, way, body, Window=window)[1])

    served.looks("first", 1)
    served.looks("second", 1)
    assert post("second")["refused"].startswith("slope.toml: is edited in another window")
    assert served.document.version == 0
    assert "refused" not in post("first")
    assert post("second", "/take-over")["leads"] == "second"
    assert "refused" in post("first")
    assert "refused" not in post("second", toml='"two"')
    served.looks("second", -1)  # it has gone: the first may again
    assert served.leads == ""
    assert "refused" not in post("first")


def test_only_the_window_that_edits_leads_the_run(served, monkeypatch):
    orders = []
    monkeypatch.setattr(served, "order", orders.append)
    served.looks("first", 1)
    served.looks("second", 1)
    for window, status in (("first", 200), ("second", 409), ("", 409)):
        assert ask(served, "/do", {"do": "pause"}, Window=window)[0] == status
    assert orders == ["pause"]


def test_files_under_the_section_are_followed(served, tmp_path):
    lines = tmp_path / "lines.csv"
    lines.write_text("x1,y1,x2,y2\n0,1,8,1\n", "utf-8")
    body = {"underlays": [{"file": "lines.csv"}]}

    def count():
        return len(json.loads(ask(served, "/under?lines.csv")[1])["lines"])

    before = json.loads(ask(served, "/underlays", body)[1])
    until(lambda: json.loads(served.news())["under"] == before["under"])
    assert count() == 1
    lines.write_text("x1,y1,x2,y2\n0,1,8,1\n0,2,8,2.1\n", "utf-8")
    until(lambda: json.loads(served.news())["under"] != before["under"])
    assert count() == 2
    lines.unlink()
    until(lambda: json.loads(served.news())["under"][1] is None)
    assert "there is no such file" in ask(served, "/under?lines.csv")[1]
    (tmp_path / "slope.edit.json").unlink()
    until(lambda: json.loads(served.news())["under"] == [None])
