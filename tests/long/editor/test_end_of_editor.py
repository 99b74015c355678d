"""An editor that is ended or killed while a case runs: the run ends too, with what it has."""

import signal

import pytest

from clast.case.templates import TEMPLATES
from clast.results import read_results
from scenes.edited import asked, started, until

LONG = TEMPLATES["incline"].replace("end = 1.0", "end = 1000.0")


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT], ids=str)
def test_a_run_ends_with_its_editor_and_keeps_what_it_has(tmp_path, how):
    path = tmp_path / "case.toml"
    path.write_text(LONG, "utf-8")
    with started(path) as (editor, address):
        assert asked(address, "/start", {"version": 0})[0] == 200
        until(lambda: '"time"' in asked(address, "/scene")[2])
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
