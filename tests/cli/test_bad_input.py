"""Bad input ends with exit code 2 and one message that names place and remedy; nothing is written.

Those that go through the command have an existing result file as its output, which must stay as it
is.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from clast.case import templates
from clast.cli.commands import app
from scenes.command_line import without_compilation
from scenes.refusals import refusal, some_of

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
INCLINE = templates.INCLINE.replace('process = "convex"', 'process = {name="modified", passes=1}')
CONTROL = {chr(code) for code in range(32)} - {"\n"}
OLD_RESULT = HDF5_SIGNATURE + b"an older result"


def refused(folder: Path, text: str) -> str:
    """Run a bad case; return the message after checking what every refusal has in common."""
    case, output = folder / "case.toml", folder / "out.vtkhdf"
    case.write_text(text, encoding="utf-8")
    output.write_bytes(OLD_RESULT)
    result = CliRunner().invoke(app, ["run", str(case), "-o", str(output)])
    assert result.exit_code == 2, result.output
    assert output.read_bytes() == OLD_RESULT
    assert sorted(path.name for path in folder.iterdir()) == ["case.toml", "out.vtkhdf"]
    assert result.stdout == ""
    return is_a_refusal(result.stderr, folder)


def is_a_refusal(message: str, folder: Path) -> str:
    """Return a message after checking what every refusal has in common."""
    assert message.startswith("error: ")
    assert str(folder) in message or "/dev/" in message
    assert len(message) < 4000, "what is echoed of the input is shortened"
    assert not set(message) & CONTROL
    assert "\n  " in message, "every message offers a remedy"
    assert "Traceback" not in message
    assert "pydantic" not in message
    return message


def changed(old: str, new: str) -> str:
    assert old in INCLINE
    return INCLINE.replace(old, new)


SLIDER = "vertices = [[0,0],[10,0],[0,10],[1,9],[4,6],[4,9]]"

RECORD = '[ground_motion]\nacts = "body-force"\nfile = "{}"\n'

TEXTS = {
    "unknown key": (
        changed("young =", "youngs ="),
        ["[rock.granite] youngs", "no such key", "did you mean 'young'?"],
    ),
    "missing table": (changed("[time]", "[times]"), ["time", "did you mean 'time'?"]),
    "missing vertex": (
        changed("loop=[4,5,6]", "loop=[4,5,7]"),
        ["[geometry] blocks 2, loop 3", "no vertex 7", "from 1 to 6"],
    ),
    "vertex number 0": (changed("[4,5,6]", "[0,5,6]"), ["blocks 2, loop 1", "no vertex 0"]),
    "self-crossing loop": (
        INCLINE + '[[block]]\nvertices=[[20,0],[21,1],[21,0],[20,1]]\nrock="granite"\n',
        ["block 3", "edge 1-2 meets edge 3-4", "(20.5, 0.5)"],
    ),
    "zero area": (
        changed(SLIDER, SLIDER.replace("[4,9]]", "[7,3]]")),
        ["block 2 'slider'", "no area"],
    ),
    "duplicate vertices": (
        changed("[4,5,6]", "[4,5,6,6]"),
        ["block 2 'slider', vertex 3 at (4, 9)", "same point as vertex 4", "remove one"],
    ),
    "overlapping blocks": (
        changed(SLIDER, SLIDER.replace("[1,9]", "[1,8]")).replace("at = [1,9]", "at = [1,8]"),
        ["block 1 'incline'", "overlaps block 2 'slider'", "depth", "near"],
    ),
    "inf": (changed("gravity = [0.0, -9.8]", "gravity = [0.0, -inf]"), ["gravity 2", "finite"]),
    "three coordinates": (changed("[4,9]]", "[4,9,0]]"), ["vertices 6", "3 items instead of 2"]),
    "measured point outside every block": (
        changed('at = [1,9]\nblock = "slider"', "at = [9,9]"),
        ["measured point 'A' at (9, 9)", "outside every block", "nearest", "move it"],
    ),
    "measured point on a common boundary": (
        changed('at = [1,9]\nblock = "slider"', "at = [1,9]"),
        ["measured point 'A' at (1, 9)", "common boundary", 'block = "incline"'],
    ),
    "tolerance of nothing": (
        changed('name="modified", passes=1', 'name="convex", tolerance=1e-300'),
        ["[method] process.tolerance", "too small to be intended"],
    ),
    "blocks of no size": (
        changed(SLIDER, "vertices = [[0,0],[1e-149,0],[0,1e-149],[1,9],[4,6],[4,9]]"),
        ["block 1 'incline'", "is only 1.41e-149 m wide"],
    ),
    "number of a thousand digits": (changed("50e9", "9" * 5000), ["line 13", "1000 digits"]),
    "number of many digits": (changed("50e9", "9" * 400), ["young", "too large a number"]),
    "hexadecimal number of many digits": (changed("50e9", "0x" + "f" * 9000), ["too large a num"]),
    "brackets within brackets": (INCLINE + "x = " + "[" * 5000, ["nested too deeply"]),
    "tables within tables": ("x = " + "{a = " * 5000, ["nested too deeply"]),
    "NUL in a title": (changed("Block on", "Block\\u0000on"), ["title", "NUL"]),
    "title as long as a book": (changed("Block on", "B" * 70_000), ["title", "70", "1000"]),
    "NUL in a block's name": (changed('"incline"', '"in\\u0000cline"'), ["block 1", "printed"]),
    "escape code in a block's name": (changed('"incline"', '"\\u001b[31m"'), ["block 1 ", "x1b"]),
    "name of ten thousand letters": (
        changed('name="incline"', f'name="{"x" * 10_000}"'),
        ["block 1 'xxx", "...", "200 characters"],
    ),
    "measured point with a NUL": (INCLINE.replace('= "A"', '= "A\\u0000"'), ["measured point 1"]),
    "date for a number": (changed("50e9", "2020-01-01"), ["young", "must be a number, not datet"]),
    "key of many letters": (INCLINE + "x" * 9000 + " = 3\n", ["[output] xxx", "no such key"]),
    "line of many letters": (INCLINE + "'" + "x" * 9000 + "\n", ["is not TOML"]),
    "directory for a record": (INCLINE + RECORD.format("."), ["is a directory", "text file"]),
    "NUL in the name of a record": (
        INCLINE + RECORD.format("a\\u0000b"),
        [("not a valid file name")],
    ),
    "endless record": (INCLINE + RECORD.format("/dev/zero"), ["/dev/zero", "not a regular file"]),
    "no TOML": (changed("[rock.granite]", "[rock.granite"), ["line 12", "is not TOML"]),
    "cut off": (INCLINE + "[[block]]\nvertices = [", ["is not TOML"]),
    "key twice": (changed("end = 1.0", "end = 1.0\nend = 2.0"), ["line 9", "is not TOML"]),
    "empty file": ("", ["time", "is missing", "rock"]),
}


@pytest.mark.parametrize("name", TEXTS)
def test_bad_case(name, tmp_path):
    text, phrases = TEXTS[name]
    case = tmp_path / "case.toml"
    case.write_text(text, encoding="utf-8")
    message = is_a_refusal(refusal(case), tmp_path)
    for phrase in phrases:
        assert phrase in message


@pytest.mark.parametrize("name", some_of(TEXTS, 5))
def test_bad_case_of_a_command(name, tmp_path):
    text, phrases = TEXTS[name]
    message = refused(tmp_path, text)
    for phrase in phrases:
        assert phrase in message


def test_several_faults_are_said_at_once(tmp_path):
    text = changed("young = 50e9", "youngs = 50e9").replace("step = 1e-3", "step = 0")
    message = refused(tmp_path, text)
    assert "3 things to put right" in message
    assert "[time] step" in message
    assert "[rock.granite] young: is missing" in message


@pytest.mark.parametrize(
    ("setting", "phrase"),
    [
        ("=3", "sets no value"),
        ("time..step=1", "no such key"),
        ("geometry.blocks.0.fixed=true", "entries 1 to 2, not '0'"),
        ("geometry.blocks.²=true", "entries 1 to 2, not '²'"),
        ("geometry.blocks." + "9" * 5000 + "=1", "entries 1 to 2, not '999"),
        ("title=" + "[" * 5000, "nested too deeply"),
        ("rock.granite.young=" + "9" * 5000, "too many digits"),
        ("x" * 10_000 + "=1", "no such key"),
        ("x" * 10_000, "sets no value"),
        ("time.end=" + "x" * 10_000, "must be a number, not 'xxx"),
        ("method.process={name='convex'", "there is no process"),
        ("time=\x1b[31m", "must be a table"),
    ],
)
def test_settings_that_cannot_be(tmp_path, setting, phrase):
    case = tmp_path / "case.toml"
    case.write_text(INCLINE, encoding="utf-8")
    message = refusal(case, settings=(setting,))
    assert phrase in message
    assert "\n  " in message
    assert len(message) < 1500
    assert not set(message) & CONTROL


def run_with(case: Path, output: Path) -> str:
    result = CliRunner().invoke(app, ["run", str(case), "-o", str(output)])
    assert result.exit_code == 2
    message = without_compilation(result.stderr)
    assert message.startswith("error: ")
    assert "\n  " in message
    return message


@pytest.fixture
def incline(tmp_path) -> Path:
    case = tmp_path / "incline.toml"
    case.write_text(INCLINE, encoding="utf-8")
    return case


def test_a_byte_order_mark_is_read_over(tmp_path):
    case = tmp_path / "case.toml"
    case.write_bytes(b"\xef\xbb\xbf" + INCLINE.encode())
    assert CliRunner().invoke(app, ["check", str(case)]).exit_code == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_pipes_and_devices_are_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    case = tmp_path / "case.toml"
    case.write_text(INCLINE + RECORD.format("pipe"), encoding="utf-8")
    for path in (case, tmp_path / "pipe", Path("/dev/zero")):
        message = run_with(path, tmp_path / "out.vtkhdf")
        assert "is a pipe, a socket or a device, not a regular file" in message


def test_a_file_of_terabytes_is_not_read(tmp_path):
    case = tmp_path / "case.toml"
    with case.open("wb") as file:
        file.truncate(10**12)
    assert "has 1e+12 bytes" in run_with(case, tmp_path / "out.vtkhdf")


RECORDS = {
    "decimal commas": ("0;0,1\n1;0,2\n", ["line 1: '0;0,1'", "write decimals with a point"]),
    "decimal commas and tabs": ("0\t0,1\n1\t0,2\n", ["line 1", "write decimals with a point"]),
    "a slip in the first row": ("t,a\n0.O,0\n1,1\n", ["line 2: '0.O,0'"]),
    "not a number": ("0,0\n1,nan\n", ["line 2: '1,nan'"]),
    "infinite": ("0,0\n1,1e999\n", ["line 2: '1,1e999'"]),
    "immense": ("0,0\n1,1e300\n2,0\n", ["values of up to 1e+300 are far too large"]),
    "endless word": ("0,0\n1," + "x" * 10_000, ["line 2", "not a line of an accelerogram"]),
    "five columns": ("PEER\n.1 .2 .3 .4 .5\n", ["line 2"]),
    "nothing": ("", ["holds no numbers"]),
    "one instant": ("0,0\n", ["at least 2 instants"]),
    "no text": ("\x00\x01,\x02\n", ["holds no numbers"]),
}


@pytest.mark.parametrize("name", RECORDS)
def test_bad_records(name, tmp_path):
    content, phrases = RECORDS[name]
    (tmp_path / "record.csv").write_text(content, encoding="utf-8")
    case = tmp_path / "case.toml"
    case.write_text(INCLINE + RECORD.format("record.csv"), encoding="utf-8")
    message = refusal(case)
    assert len(message) < 1000 and "\n  " in message
    for phrase in phrases:
        assert phrase in message


@pytest.mark.parametrize(
    ("name", "phrase"),
    [
        ("", "not a valid case name"),
        (".", "not a valid case name"),
        ("..", "not a valid case name"),
        ("/", "not a valid case name"),
        (" ", "not a valid case name"),
        (".toml", "not a valid case name"),
        ("a/", "not a valid case name"),
        ("a\nb", "not a valid case name"),
        ("a/b/c", "the folder a/b does not exist"),
        ("x" * 300, "too long a name"),
        ("old", "already exists"),
    ],
)
def test_names_of_no_new_case(name, phrase, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("old.toml").write_text("", encoding="utf-8")
    result = CliRunner().invoke(app, ["new", name])
    assert result.exit_code == 2
    assert phrase in result.stderr
    assert "\n  " in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["old.toml"]


def test_case_that_is_no_text(tmp_path):
    case = tmp_path / "case.toml"
    case.write_bytes(HDF5_SIGNATURE)
    assert "is not a text file" in run_with(case, tmp_path / "out.vtkhdf")


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="everything is readable to root"
)
def test_unreadable_file(tmp_path, incline):
    incline.chmod(0)
    assert "cannot be read" in run_with(incline, tmp_path / "out.vtkhdf")


def test_unreadable_file_for_whoever_reads_it(tmp_path, incline, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_text", refuse)
    message = run_with(incline, tmp_path / "out.vtkhdf")
    assert "cannot be read: Permission denied" in message


def test_directory_for_output(tmp_path, incline):
    message = run_with(incline, tmp_path)
    assert "is a directory" in message
    assert "-o" in message


def test_output_in_a_directory_that_is_not(tmp_path, incline):
    assert "does not exist" in run_with(incline, tmp_path / "nowhere" / "out.vtkhdf")


def test_output_over_something_else(tmp_path, incline):
    message = run_with(incline, incline)
    assert "is not a clast result file" in message
    assert incline.read_text(encoding="utf-8") == INCLINE


@pytest.mark.parametrize("command", ["info", "plot"])
def test_results_that_are_none(command, tmp_path, incline):
    for path in (incline, tmp_path, tmp_path / "nothing.vtkhdf"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 2, path
        assert str(path) in result.stderr


def test_missing_file(tmp_path, incline):
    message = run_with(tmp_path / "inclne.toml", tmp_path / "out.vtkhdf")
    assert "there is no such file" in message
    assert str(incline) in message


def test_directory_for_a_case(tmp_path):
    assert "is a directory" in run_with(tmp_path, tmp_path / "out.vtkhdf")
