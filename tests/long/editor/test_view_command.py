"""`clast edit --view` and `clast check --watch` as they are started and ended."""

import http.client
import json
import signal
import subprocess
import sys
from urllib.parse import urlsplit

import pytest

from clast.case.templates import TEMPLATES


def test_the_view_shows_a_case_with_a_value_and_ends(tmp_path):
    file = tmp_path / "slope.toml"
    file.write_text(TEMPLATES["slope"], "utf-8")
    command = [sys.executable, "-m", "clast", "edit", "--view", "slope.toml", "--set", "title='S'"]
    running = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    try:
        line = next(one for one in running.stderr if "http://" in one)
        assert line.startswith("view: ")
        address = urlsplit(line[line.index("http://") :].strip())
        token = address.fragment.removeprefix("token=")
        connection = http.client.HTTPConnection(address.netloc, timeout=120)
        found = None
        while found is None:
            connection.request("GET", "/section", headers={"Authorization": f"Bearer {token}"})
            found = json.loads(connection.getresponse().read())
        assert (found["title"], found["blocks"]) == ("S", 23)
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 0
    finally:
        running.kill()
        running.wait()
    assert file.read_text("utf-8") == TEMPLATES["slope"]


@pytest.mark.parametrize(
    "more", [["edit", "--view", "none.toml"], ["edit", "c.toml", "--set", "a=1"]]
)
def test_requests_that_cannot_be_met_are_refused(tmp_path, more):
    (tmp_path / "c.toml").write_text(TEMPLATES["incline"], "utf-8")
    command = [sys.executable, "-m", "clast", *more]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 2
    assert "Traceback" not in ended.stderr and ended.stderr.startswith("error: ")


def test_a_watch_ends_with_the_key(tmp_path):
    file = tmp_path / "c.toml"
    file.write_text(TEMPLATES["incline"], "utf-8")
    command = [sys.executable, "-m", "clast", "check", "--watch", "c.toml"]
    running = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    try:
        assert "2 blocks: nothing to object to" in running.stdout.readline()
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 0
    finally:
        running.kill()
        running.wait()
