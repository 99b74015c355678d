"""What foreign words do to the terminal: nothing, and they do not fill it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from clast.case.templates import INCLINE
from clast.results import read_results
from clast.spelling import visible, without_long_words
from scenes.command_line import clast_command

EVIL = "\x1b[31mred\x1b]0;title\x07\x9b2J\x7f\u202egnp"
SHOWN = "\\u001b[31mred\\u001b]0;title\\u0007\\u009b2J\\u007f\\u202egnp"
RAW = ("\x1b", "\x07", "\x9b", "\x7f", "\u202e")
LONG = "x" * 10_000


@pytest.fixture
def evil(tmp_path: Path) -> Path:
    """The result file of a case whose names are commands to a terminal."""
    import clast

    case = clast.Case.from_toml(INCLINE, ["time.end=0.002"])
    builder_case = case.model_copy(update={"title": EVIL})
    return builder_case.run(output=tmp_path / "evil.vtkhdf").output


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_title_is_shown_and_not_obeyed(evil: Path, options: list[str]):
    done = clast_command("info", evil, *options)
    assert done.exit_code == 0, done.output
    # rich leaves out the bell by itself
    shown = SHOWN.replace("\\u0007", "" if not options else "\\u0007")
    assert shown in done.stdout
    assert not any(sign in done.stdout for sign in RAW)
    if options:
        assert json.loads(done.stdout)["title"] == EVIL
    assert read_results(evil).title == EVIL


@pytest.mark.parametrize(
    "arguments",
    [["run", EVIL], ["info", EVIL], ["new", "x", "--template", EVIL], [EVIL], ["run", f"--{EVIL}"]],
    ids=["a case", "a file", "a template", "a command", "an option"],
)
def test_errors_do_not_obey_either(arguments: list[str], tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = clast_command(*arguments)
    assert done.exit_code == 2
    assert "red" in done.output
    assert not any(sign in done.output for sign in RAW)


@pytest.mark.parametrize(
    "arguments",
    [
        *(["run", "a.toml", "--set", LONG], ["run", "a.toml", "--set", f"{LONG}=1"]),
        *(["run", "a.toml", "-o", LONG], ["run", LONG], ["run", "a.toml", f"--{LONG}"]),
        *(["info", LONG], ["plot", LONG], [LONG], ["new", "a", "--template", LONG]),
        *(["compare", "a.toml", "--law", LONG], ["verify", LONG]),
        ["run", "a.toml", "--set", f"time.end='{'x ' * 5000}'"],
    ],
    ids=lambda arguments: " ".join(argument[:9] for argument in arguments),
)
def test_nobody_is_told_ten_thousand_letters(arguments: list[str], tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(INCLINE, encoding="utf-8")
    done = clast_command(*arguments)
    assert done.exit_code == 2
    assert 20 < len(done.output) < 3000
    assert "Traceback" not in done.output


@pytest.mark.parametrize(
    "arguments",
    [["compare", "a.toml", "-o"], ["verify", "patch", "--quick", "--report"]],
    ids=["compare", "verify"],
)
@pytest.mark.parametrize("place", ["a.toml", "a.toml/inside"])
def test_a_file_where_a_folder_is_needed(arguments, place, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(INCLINE, encoding="utf-8")
    done = clast_command(*arguments, place)
    assert done.exit_code == 2
    assert done.stderr.startswith(f"error: {place}: ")
    assert "name a folder" in done.stderr
    assert Path("a.toml").read_text(encoding="utf-8") == INCLINE


def test_ordinary_words_stay_as_they_are():
    text = "Böschung „Süd“, 45°\n\tσ = 3 MPa — /a/long/path/" + "name" * 50
    assert visible(text) == text
    assert without_long_words(text) == text
    assert (
        without_long_words("a" * 1000 + " is not a word")
        == "a" * 120 + "..." + "a" * 60 + " is not a word"
    )
