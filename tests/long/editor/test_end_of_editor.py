"""An editor that is ended or killed while a case runs: the run ends too, with what it has."""

import http.client
import json
import signal
import subprocess
import sys
import time

import pytest

from clast.case.templates import TEMPLATES
from clast.results import read_results

LONG = TEMPLATES["incline"].replace("end = 1.0", "end = 1000.0")


def until(condition):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def asked(address, path, body=None):
    """Return status and text of an answer of the editor at an address."""
    place, _, token = address.removeprefix("http://").partition("/#token=")
    connection = http.client.HTTPConnection(place, timeout=20)
    content = None if body is None else json.dumps(body)
    headers = {"Authorization": f"Bearer {token}"}
    connection.request("GET" if body is None else "POST", path, content, headers)
    answer = connection.getresponse()
    found = answer.status, answer.read().decode()
    connection.close()
    return found


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT], ids=str)
def test_a_run_ends_with_its_editor_and_keeps_what_it_has(tmp_path, how):
    path = tmp_path / "case.toml"
    path.write_text(LONG, "utf-8")
    command = [sys.executable, "-m", "clast", "edit", str(path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as editor:
        line = next(line for line in editor.stderr if "edit: " in line)
        address = line.split("edit: ")[1].strip()
        assert asked(address, "/start", {"version": 0})[0] == 200
        until(lambda: '"time"' in asked(address, "/scene")[1])
        editor.send_signal(how)
        editor.stderr.read()  # the run has not this pipe
        editor.wait()
    checkpoint = tmp_path / "case.runs/1/case.checkpoint.h5"
    if how != signal.SIGINT:
        until(checkpoint.exists)
    assert checkpoint.exists()
    until(lambda: read_results(checkpoint.with_name("case.vtkhdf")).report is not None)
    report = read_results(checkpoint.with_name("case.vtkhdf")).report
    assert report.outcome.startswith("ended from its page at t = ")
