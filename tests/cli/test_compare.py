"""The command ``clast compare``, and references and notes in the summaries of a run."""

from __future__ import annotations

import json
from pathlib import Path

from scenes.command_line import clast_command

SHORT = ["--set", "time.end=0.02"]
REFERENCE = ["--set", "reference.1.time=0.02"]
TWO = ["--process", "modified,convex", "--law", "penalty"]
STOPPING = ["--set", "time.max_displacement=1e-5", "--set", "time.smallest_step=9e-4"]


def test_compare_prints_a_table_and_writes_pages(incline):
    done = clast_command("compare", incline, *TWO, *SHORT)
    assert done.exit_code == 0, done.output
    for word in ("modified", "convex", "not reached", "reached its end", "closed form"):
        assert word in done.stdout
    folder = Path("build/compare-incline")
    assert {path.suffix for path in folder.iterdir()} == {".html", ".json", ".png"}


def test_compare_for_a_program(incline):
    done = clast_command("compare", incline, *TWO, *SHORT, *REFERENCE, "-o", "out", "--json")
    content = json.loads(done.stdout)
    assert [row["process"] for row in content["rows"]] == ["modified", "convex"]
    assert content["rows"][0]["deviations"][0]["relative"] > 0.0
    assert all(Path(path).exists() for path in content["files"])


def test_a_stopped_run_is_no_error(incline):
    done = clast_command("compare", incline, *TWO, *SHORT, *STOPPING, "--quiet")
    assert (done.exit_code, done.stdout) == (0, ""), done.output
    page = Path("build/compare-incline/comparison.html").read_text(encoding="utf-8")
    assert page.count("<td>stopped at t = ") == 2


def test_unknown_names_are_refused_before_anything_is_written(incline):
    done = clast_command("compare", incline, "--process", "modfied")
    assert done.exit_code == 2
    assert "did you mean 'modified'?" in done.stderr
    assert not Path("build").exists()


def test_run_prints_the_error_against_the_reference(incline):
    printed = clast_command("run", incline, *SHORT, *REFERENCE).stdout
    assert "error of A at t = 0.02 s: " in printed
    content = json.loads(clast_command("run", incline, *SHORT, "--json").stdout)
    assert content["references"][0]["computed"] is None


def test_what_clast_chose_is_said(incline):
    automatic = [*SHORT, "--set", "method.contact_law=penalty", "--set", "method.process=convex"]
    for command in ("run", "check"):
        printed = clast_command(command, incline, *automatic).stdout
        assert "chosen by clast" in printed
        assert "normal_stiffness = 5e+10" in printed
    content = json.loads(clast_command("check", incline, *automatic, "--json").stdout)
    assert "E of the stiffest rock" in content["notes"][0]
    printed = clast_command("run", incline, *automatic, "--verbose").stdout
    assert "steps of the line search" in printed
