"""The process that cuts and checks: windows are answered meanwhile, and its end is told."""

import json
import signal
import statistics
import time
from contextlib import ExitStack

import pytest

from clast.case.checking import check
from clast.case.templates import TEMPLATES
from clast.editor import worker
from clast.editor.section import section_of
from clast.editor.server import Asked
from scenes.edited import edited_file, rock_text, until

SLOPE = TEMPLATES["slope"]
SPACING = ("joint_set", 0, "spacing")


@pytest.fixture
def served(tmp_path):
    """Return a function that opens a text; its window is closed at the end."""
    with ExitStack() as windows:

        def open_text(text):
            path = tmp_path / "case.toml"
            path.write_text(text, "utf-8", newline="")
            return windows.enter_context(edited_file(path))

        yield open_text


def checked(server):
    until(lambda: server.state()["checked"])
    return server.state()


def change(server, toml, way="/edit"):
    edits = [] if way != "/edit" else [{"do": "set", "place": SPACING, "toml": toml}]
    asked = {"version": server.document.version, "edits": edits}
    server.do(way, Asked.model_validate_json(json.dumps(asked)))


def test_the_newest_text_wins_and_at_most_one_waits(served):
    server = served(rock_text(66.0, 48.0))
    checked(server)
    before = server.worker.sections
    for number in range(40):
        change(server, f"1.{40 + number}")
        time.sleep(0.002)
    until(lambda: server.worker.text == server.document.text and not server.worker.is_busy)
    expected = check(server.document.text, str(server.document.path))
    state = checked(server)
    assert {key: state[key] for key in expected.as_dict()} == expected.as_dict()
    scene = json.loads(json.dumps(section_of(expected)["scene"]))
    assert json.loads(server.worker.section)["scene"] == scene
    assert 0 < server.worker.sections - before < 10


def test_windows_are_answered_while_thousands_of_blocks_are_cut(served):
    server = served(rock_text(140.0, 110.0))
    assert checked(server)["blocks"] > 5000
    took, busy = [], 0
    for number in range(60):
        busy += server.worker.is_busy
        begun = time.process_time()
        change(server, f"1.5{number:02d}")
        server.news()
        took.append(time.process_time() - begun)
        time.sleep(0.15 if number % 20 == 0 else 0.01)
    assert busy > 20
    assert statistics.quantiles(took, n=20)[-1] < 0.03
    until(lambda: server.worker.text == server.document.text)


def test_a_cut_is_stopped_and_made_when_it_is_asked_for(served, tmp_path):
    server = served(rock_text(500.0, 400.0))
    until(lambda: server.state()["is_cutting"])
    change(server, "", "/stop-cut")
    until(lambda: not server.state()["is_cutting"])
    assert server.state()["off"] == "the cut was stopped"
    change(server, "40")
    until(lambda: not server.document.unsaved)
    assert "spacing = 40" in (tmp_path / "case.toml").read_text("utf-8")
    time.sleep(0.3)
    assert not server.state()["checked"]
    change(server, "", "/cut")
    state = checked(server)
    assert state["blocks"] > 1000
    assert state["off"] == ""
    change(server, "100")
    assert 0 < checked(server)["blocks"] < state["blocks"]


def test_a_process_that_dies_is_told_and_the_text_is_safe(served):
    server = served(SLOPE)
    checked(server)
    before = server.worker.section
    server.worker._process.send_signal(signal.SIGSTOP)
    change(server, "2.5")
    until(lambda: server.worker.is_busy)
    server.worker._process.kill()
    until(lambda: server.state()["off"])
    assert "has ended (-9)" in server.state()["off"]
    assert "spacing = 2.5" in server.document.text
    assert server.worker.section == before
    change(server, "", "/cut")
    assert checked(server)["blocks"] > 23
    assert server.state()["off"] == ""


def test_many_blocks_are_cut_when_it_is_asked_for(served, monkeypatch):
    monkeypatch.setattr(worker, "LIVE_MOST", 100)
    server = served(rock_text(22.0, 16.0))
    state = checked(server)
    assert state["off"] == f"{state['blocks']} blocks are not cut at every change"
    sections = server.worker.sections
    change(server, "2.0")
    time.sleep(0.3)
    assert not server.state()["checked"]
    assert server.worker.sections == sections
    change(server, "", "/cut")
    assert 100 < checked(server)["blocks"] < state["blocks"]
    change(server, "6.0")
    change(server, "", "/cut")
    assert checked(server)["off"] == ""


@pytest.mark.slow
def test_twenty_thousand_blocks_hang_nothing(served):
    server = served(rock_text(280.0, 220.0))
    assert checked(server)["blocks"] > 20_000
    begun = time.process_time()
    for number in range(20):
        change(server, f"1.5{number:02d}")
        server.news()
    assert time.process_time() - begun < 1.0
    assert not server.worker.is_busy
    assert "blocks are not cut" in server.state()["off"]
