"""Runs of a case that is edited: what they run on, how they end, and that nothing of them stays."""

import json
import os
import signal
import time

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.running import Runs, StudyAsked
from clast.errors import CaseError
from scenes.edited import asked, edited_file, until

LONG = TEMPLATES["incline"].replace("end = 1.0", "end = 1000.0")


@pytest.fixture
def runs(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEMPLATES["incline"], "utf-8")
    found = Runs(path, lambda: None)
    yield found
    found.close()


def test_one_runs_at_a_time_and_an_earlier_one_is_shown_again(runs):
    runs.start(LONG)
    for again in (lambda: runs.start(LONG), lambda: runs.show(1)):
        with pytest.raises(CaseError, match="run 1: is going on"):
            again()
    until(lambda: runs.shown.feed.frames)
    runs.order("end")
    until(lambda: runs.shown.is_over)
    runs.close()
    assert runs.shown.outcome.startswith("ended from its page at t = ")
    runs.start(TEMPLATES["incline"])
    until(lambda: runs.shown.is_over)
    runs.close()
    runs.show(1)
    assert runs.shown.text == LONG
    assert runs.shown.outcome.startswith("ended from its page at t = ")
    assert runs.numbers == [1, 2]
    with pytest.raises(CaseError, match="is not there"):
        runs.show(7)


def test_a_run_that_hangs_is_killed_by_the_second_request(runs):
    runs.start(LONG)
    until(lambda: runs.shown.feed.frames)
    os.kill(runs.shown.process.pid, signal.SIGSTOP)
    runs.order("end")
    time.sleep(0.3)
    assert not runs.shown.is_over and runs.as_dict()["shown"]["ending"]
    runs.order("end")
    until(lambda: runs.shown.is_over)
    assert runs.shown.outcome == "was killed by SIGKILL: it ended without a report"


@pytest.mark.parametrize("above", [0, 2])
def test_files_that_a_case_names_are_kept_with_it(tmp_path, above):
    """Those above its folder too: the copy that ran says what ran when they have changed."""
    folder = tmp_path.joinpath("a", "b", "c")
    folder.mkdir(parents=True)
    name = "../" * above + "records/motion.csv"
    record = folder / name
    record.parent.mkdir()
    record.write_text("0, 0\n0.5, 2\n1, 0\n", "utf-8")
    text = TEMPLATES["incline"] + f'[ground_motion]\nacts = "body-force"\nfile = "{name}"\n'
    runs = Runs(folder / "case.toml", lambda: None)
    runs.start(text)
    until(lambda: runs.shown.is_over)
    runs.close()
    assert runs.shown.outcome == "the run reached its end"
    (kept,) = runs.folder.rglob("motion.csv")
    assert kept.read_bytes() == record.read_bytes()
    assert runs.shown.text == text


def test_the_page_of_the_run_is_shown_by_the_editor_alone(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEMPLATES["incline"], "utf-8")
    with edited_file(path) as server:
        status, headers, text = asked(server.address, "/run?1")
        assert status == 200 and headers["X-Frame-Options"] == "SAMEORIGIN"
        assert server.token not in text
        assert "frame-src 'self'" in asked(server.address, "/")[2]
        assert asked(server.address, "/scene")[2] == "null"
        version = server.document.version
        assert asked(server.address, "/start", {"version": version})[0] == 200
        until(lambda: server.runs.shown.is_over and server.feed.is_over)
        scene = json.loads(asked(server.address, "/scene")[2])
        assert scene["next"] == 101 and scene["status"]["over"]
        events = asked(server.address, "/events?from=100")[2]  # ends by itself: the run is over
        assert events.count("event: frames") == 1 and events.endswith("}\n\n")
        assert json.loads(asked(server.address, "/ran")[2])["text"] == TEMPLATES["incline"]
        assert asked(server.address, "/do", {"do": "pause"})[0] == 200
        late = asked(server.address, "/start", {"version": version + 1})[2]
        assert json.loads(late)["late"] and server.runs.numbers == [1]


def test_rocks_fall_where_the_case_is_for_them_and_their_page_is_shown(tmp_path):
    """The address of the page ends with a secret: a frame cannot send the token."""
    path = tmp_path / "case.toml"
    path.write_text(TEMPLATES["rockfall"].replace("rocks = 200", "rocks = 20"), "utf-8")
    with edited_file(path) as server:
        assert asked(server.address, "/start", {"version": server.document.version})[0] == 200
        until(lambda: server.runs.as_dict()["shown"]["report"])
        shown = server.runs.as_dict()["shown"]
        assert (shown["kind"], shown["outcome"]) == ("rockfall", "20 paths")
        secret = server.runs.as_dict()["secret"]
        status, headers, text = asked(server.address, f"/report?{secret}")
        assert status == 200 and headers["X-Frame-Options"] == "SAMEORIGIN"
        assert text == (path.parent / "case.runs/1/study/paths.html").read_text("utf-8")
        assert "connect-src 'none'" in text
        for wrong in ("", server.token, secret[:-1]):
            assert asked(server.address, f"/report?{wrong}")[0] == 404


@pytest.mark.parametrize(
    "study",
    [
        {"kind": "resume"},
        {"kind": "fos", "file": "x"},
        {"kind": "fos", "options": {"by": 1}},
        "fos",
    ],
    ids=str,
)
def test_studies_that_no_form_asks_for_are_refused(tmp_path, study):
    path = tmp_path / "case.toml"
    path.write_text(TEMPLATES["incline"], "utf-8")
    with edited_file(path) as server:
        assert asked(server.address, "/start", {"version": 0, "study": study})[0] == 400
        assert server.runs.shown is None


def test_options_of_a_study_are_values_and_no_other_options():
    given = {"vary": ["-o /tmp = [1]", "a.b = [1, 2]"], "output": ["/tmp/x"], "fail": [" "]}
    words = StudyAsked(kind="sweep", options=given).words()
    assert words == ["study", "sweep", "--vary=-o /tmp = [1]", "--vary=a.b = [1, 2]"]
