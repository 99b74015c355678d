"""The choices of `clast verify`."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from clast.cli.commands import app


def verify(*arguments):
    return CliRunner().invoke(app, ["verify", *arguments])


def test_processes_and_laws_narrow_the_table():
    done = verify("patch", "--process", "convex", "--law", "penalty", "--json")
    assert done.exit_code == 0
    rows = json.loads(done.stdout)["rows"]
    assert {row["variant"] for row in rows} == {"convex"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--process", "convx"], "did you mean 'convex'?"),
        (["--law", "penality"], "did you mean 'penalty'?"),
        (["spin", "--process", "convex"], "this selection contains no runs"),
    ],
)
def test_choices_that_make_no_sense(arguments, said):
    done = verify(*arguments)
    assert done.exit_code == 2
    assert said in done.stderr
