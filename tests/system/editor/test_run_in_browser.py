"""Runs of a case from its window as a person makes them: run, look, pause, end, compare."""

import os
import re
import signal

import pytest

from clast.case.templates import TEMPLATES
from clast.results import read_results
from scenes.browsers import CHROMIUM, until
from scenes.command_line import good

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
LONG = TEMPLATES["incline"].replace("end = 1.0", "end = 1000.0")
SHOWN = "clastEditor.runs.shown"


def over(page):
    until(page, f"{SHOWN}?.over === true")


def test_a_case_is_run_looked_at_and_changed_since(window):
    page, file, _ = window(TEMPLATES["incline"])
    until(page, "/perhaps \\d+ s,/.test(document.getElementById('saved').textContent)")
    page.click("#run")
    over(page)
    assert page.text_content("#ran") == "run 1: the run reached its end"
    until(page, "/some \\d+ s,/.test(document.getElementById('saved').textContent)")
    assert re.search(r"some \d+ steps, some \d+ s, ", page.text_content("#saved"))
    run = page.frame_locator("#page iframe")
    run.locator("text=the run is over").wait_for()
    assert page.is_hidden("#section")
    kept = file.parent / "case.runs" / "1"
    assert (kept / "case.toml").read_text("utf-8") == TEMPLATES["incline"]
    results = read_results(kept / "case.vtkhdf")
    assert results.report.finished and results.times[-1] == 1.0
    assert page.is_hidden("#since")
    page.select_option("#looking", "0")
    assert page.is_visible("#section")
    page.click("#toml summary")
    changed = TEMPLATES["incline"].replace("end = 1.0", "end = 0.5")
    page.fill("#text", changed)
    until(page, "document.getElementById('ran').textContent.endsWith('has changed since')")
    page.click("#since summary")
    told = page.text_content("#since pre")
    assert "here:  end = 0.5" in told and "run:  end = 1.0" in told
    page.click("#run")
    until(page, f"{SHOWN}?.number === 2 && {SHOWN}.over")
    assert read_results(file.parent / "case.runs/2/case.vtkhdf").times[-1] == 0.5
    page.select_option("#looking", "1")
    until(page, f"{SHOWN}?.number === 1")
    page.click("#back")
    until(page, "clastEditor.state.text.includes('end = 1.0')")
    page.click("#undo")
    until(page, "clastEditor.state.text.includes('end = 0.5')")


def test_a_run_is_paused_goes_on_and_ends_with_what_it_has(window):
    page, file, _ = window(LONG)
    page.click("#run")
    page.click("#pause", timeout=60_000)
    until(page, f"{SHOWN}.where.paused")
    steps = page.evaluate(f"{SHOWN}.where.steps")
    page.wait_for_timeout(500)
    assert page.evaluate(f"{SHOWN}.where.steps") == steps > 0
    assert page.text_content("#ran").startswith("run 1: paused, t ")
    page.click("text=Go on >> nth=0")
    until(page, f"{SHOWN}.where.steps > {steps}")
    assert page.is_disabled("#run")
    page.click("#end")
    over(page)
    assert "run 1: ended from its page at t = " in page.text_content("#ran")
    page.click("#messages summary")
    assert "case.checkpoint.h5 continues it" in page.text_content("#messages pre")
    assert (file.parent / "case.runs/1/case.checkpoint.h5").exists()


def test_a_run_that_is_killed_or_refused_says_so(window):
    page, _, server = window(LONG)
    page.click("#run")
    until(page, f"{SHOWN}?.where.steps > 0 && {SHOWN}.frames > 0")
    os.kill(server.runs.shown.process.pid, signal.SIGKILL)
    over(page)
    told = page.text_content("#ran")
    assert told == "run 1: was killed by SIGKILL: it ended without a report"
    page.frame_locator("#page iframe").locator("text=the run was killed").first.wait_for()
    page.select_option("#looking", "0")
    page.click("#toml summary")
    page.fill("#text", LONG.replace("at = [1,9]", "at = [1,99]"))
    until(page, "clastEditor.state.faults.length === 1")
    page.click("#run")
    until(page, f"{SHOWN}.number === 2 && {SHOWN}.over")
    assert page.text_content("#ran") == "run 2: was refused"
    assert page.is_visible("#section")
    assert "measured point 'A'" in page.text_content("#messages pre")
    assert page.is_visible("#messages pre")


def test_a_study_is_made_from_the_form_by_clicking_its_parameter(window):
    text = TEMPLATES["incline"].replace("dynamic_ratio = 1.0", "dynamic_ratio = 0.0")
    text = text.replace("friction_angle = 20.0", "friction_angle = 50.0")
    page, file, _ = window(
        text.replace("end = 1.0", "end = 0.2").replace("time = 1.0", "time = 0.2")
    )
    page.click("#study summary")
    page.click("#study-start")
    until(page, f"{SHOWN}?.table?.rows.length > 1")
    over(page)
    low, high = 1.1875, 1.191
    factors = page.evaluate(
        f"{SHOWN}.table.rows.filter((row) => row[1] === 'stands').map((row) => row[0])"
    )
    assert low <= max(factors) <= high  # tan 50 / tan 45 = 1.1918
    assert "study 1: factor of safety 1.1" in page.text_content("#ran")
    report = page.frame_locator("#page iframe")
    report.locator("text=factor of safety").first.wait_for()
    assert page.locator(".study circle").count() == page.evaluate(f"{SHOWN}.table.rows.length")
    page.select_option("#study select", "sweep")
    page.click('nav [data-table=\'["joint","default"]\']')
    page.click("text=choose a parameter by clicking it")
    page.click('[data-key="Joint.friction_angle"] input')
    page.click("text=add a measure")
    asked = page.evaluate("clastEditor.runs.form.options")
    assert asked["vary"] == ["joint.default.friction_angle = [40, 50, 60]"]
    assert asked["measure"] == ["u1 = displacement(A)"]
    page.click("#study-start")
    until(page, f"{SHOWN}?.number === 2 && {SHOWN}.over")
    table = page.evaluate(f"{SHOWN}.table")
    assert table["heads"][:4] == ["run", "status", "joint.default.friction_angle", "u1"]
    assert [row[2] for row in table["rows"]] == [40, 50, 60]
    assert table["rows"][0][3] > 0.05 > 1e-3 > table["rows"][1][3] > table["rows"][2][3]
    assert (file.parent / "case.runs/2/study/results.csv").exists()


def test_a_monte_carlo_from_the_form_is_that_of_the_command_line(window, tmp_path):
    page, file, _ = window(TEMPLATES["incline"].replace("end = 1.0", "end = 0.02"))
    page.click("#study summary")
    page.select_option("#study select", "montecarlo")
    page.click('nav [data-table=\'["joint","default"]\']')
    page.click("text=choose a parameter by clicking it")
    page.click('[data-key="Joint.friction_angle"] input')
    page.click("text=add a measure")
    page.get_by_label("fails where").fill("u1 > 0.0006")
    page.get_by_label("runs", exact=True).fill("6")
    page.click("#study-start")
    until(page, f"{SHOWN}?.table?.rows.length > 0")
    over(page)
    assert len(page.evaluate(f"{SHOWN}.table.rows")) == 6
    vary, measure = "joint.default.friction_angle=normal(20, 2)", "u1=displacement(A)"
    options = ["--vary", vary, "--measure", measure, "--fail=u1 > 0.0006", "--runs=6"]
    good("study", "montecarlo", file, "-o", tmp_path / "own", *options)
    ours, own = file.parent / "case.runs/1/study", tmp_path / "own"
    assert (ours / "results.csv").read_bytes() == (own / "results.csv").read_bytes()
