"""What stages, bolts, water, dashpots and records cannot mean: exit code 2 and one message."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from scenes.command_line import clast_command, good
from scenes.records import at2_text
from scenes.refusals import refusal, some_of

CASE = """
schema = 1
[time]
step = 1e-3
end = 0.05
[rock.rock]
young = 5e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 30.0
[joint.bedding]
friction_angle = 35.0
between = [["low", "high"]]
[[block]]
name = "floor"
vertices = [[-2, -1], [3, -1], [3, 0], [-2, 0]]
fixed = true
[[block]]
name = "low"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[block]]
name = "high"
vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]
[[block]]
name = "beside"
vertices = [[1, 0], [2, 0], [2, 1], [1, 1]]
[[opening]]
name = "heading"
blocks = ["beside"]
[amplitude.rise]
time = [0, 1]
value = [0, 1]
[[pressure]]
name = "pool"
start = [0, 2]
end = [1, 2]
value = 1e3
amplitude = "rise"
"""
BOLT = """
[bolt_kind.cable]
stiffness = 2e7
yield_force = 1.2e5
[[bolt]]
name = "B"
start = [0.5, 1.8]
end = [0.5, -0.5]
kind = "cable"
"""
ASIDE = BOLT.replace("[0.5, 1.8]", "[0.5, 0.5]").replace("[0.5, -0.5]", "[1.5, 0.5]")
SHAKES = '[ground_motion]\nacts = "body-force"\ntime = [0, 0.1, 0.2]\nacceleration = [0, 1, 0]\n'


def changed(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1, old
    return text.replace(old, new)


def of(old: str, new: str) -> str:
    return changed(CASE, old, new)


def bolt(old: str, new: str) -> str:
    return CASE + changed(BOLT, old, new)


def kind(keys: str) -> str:
    return bolt("yield_force = 1.2e5", keys)


def stage(*tables: str, more: str = "") -> str:
    """Return the case with stages called first, second, ..."""
    names = ("first", "second", "third")
    each = zip(names, tables, strict=False)
    return CASE + more + "".join(f'[[stage]]\nname = "{name}"\n{keys}\n' for name, keys in each)


def water(keys: str, surface: str = "level = 0.5") -> str:
    return f'{CASE}[[water]]\nname = "lake"\n{surface}\n{keys}\n'


def edge(where: str, keys: str = "") -> str:
    return f"{CASE}[[viscous_boundary]]\nwhere = {where}\n{keys}\n"


def shaken(keys: str, acts: str = "body-force") -> str:
    return f'{CASE}[ground_motion]\nacts = "{acts}"\n{keys}\n'


def stressed(keys: str) -> str:
    return f"{CASE}[in_situ]\n{keys}\n"


DIG = 'excavate = ["heading"]\n'

BROKEN: dict[str, tuple[str, tuple[str, ...]]] = {
    # bolts
    "bolt into a void": (bolt("[0.5, -0.5]", "[5, 5]"), ("bolt 1 'B', end", "outside", "move it")),
    "no such key": (bolt("start", "strat"), ("[[bolt]] 1 'B' strat", "did you mean 'start'?")),
    "bolt called NUL": (bolt('"B"', r'"a\u0000b"'), ("bolt 1 'a\\x00b'", "printed", "short name")),
    "grouted without free": (CASE + BOLT + 'anchorage = "grouted"\n', ("'B'", "free_length =")),
    # openings
    "opening called NUL": (of('"heading"', r'"\u0000"'), ("opening '\\x00'", "cannot be printed")),
    "opening with a shape": (
        of('blocks = ["beside"]', 'blocks = ["beside"]\nshape = "box"'),
        ("[[opening]] 1 'heading' shape", "an opening of blocks has no such key", "take it out"),
    ),
    "a shape without a domain": (
        CASE + '[[opening]]\nname = "b"\nshape = "circle"\ncenter = [0, 0]\nradius = 1\n',
        ("[[opening]] 2 'b'", "no [domain] to cut", "give [domain]"),
    ),
    # stages
    "excavated twice": (stage(DIG, DIG), ("stage 'second', excavate", "'first'", "name it once")),
    "excavated as a block": (
        stage(DIG, 'excavate = ["beside"]'),
        ("stage 'second', excavate", "block 'beside'", "in stage 'first'", "with its opening"),
    ),
    "all excavated": (
        stage('excavate = ["heading", "low", "high", "floor"]'),
        ("stage 'first', excavate", "no block would be left", "some of the blocks"),
    ),
    "excavate nothing known": (
        stage('excavate = ["headng"]'),
        ("stage 'first', excavate", "no opening or block 'headng'", "'heading'?"),
    ),
    "relax too long": (
        stage(DIG + "relax = 0.3\nrelax_time = 9\ntime = 5"),
        ("stage 'first', relax_time", "longer than the stage, 5 s", "raise time"),
    ),
    "endless steps": (
        stage("time = 1e12\nstep = 1e-9"),
        ("stage 'first', time", "1e+21 steps of 1e-09 s", "raise its step"),
    ),
    "step above time": (stage("step = 1\ntime = 0.1"), ("stage 'first', step", "lower step")),
    "an escape code": (stage("").replace('"first"', r'"\u001b[1m"'), ("stage 1", "be printed")),
    "install unknown": (
        stage('install = ["cabel"]', more=BOLT),
        ("stage 'first', install", "no bolt, kind of bolt or well 'cabel'", "'cable'?"),
    ),
    "installed twice": (
        stage('install = ["cable"]', 'install = ["B"]', more=BOLT),
        ("stage 'second', install", "bolt 'B'", "in stage 'first'", "let one stage"),
    ),
    "installed in a void": (
        stage(DIG, 'install = ["B"]', more=ASIDE),
        ("stage 'second', install", "bolt 'B'", "block 'beside'", "in stage 'first'", "stay"),
    ),
    "loads unknown": (stage('loads = ["pol"]'), ("stage 'first', loads", "'pol'", "'pool'?")),
    "loads twice": (stage('loads = ["pool", "pool"]'), ("stage 'first', loads", "name it once")),
    "idle motion": (
        stage("", more=SHAKES),
        ("ground_motion", "is used in no stage", "add ground_m"),
    ),
    # loads over time
    # water
    "density of a vacuum": (
        water("density = 0"),
        ("[[water]] 1 'lake' density", "0 is no", "1000 for water"),
    ),
    "weight in kN/m3": (
        water("density = 9.81"),
        ("[[water]] 1 'lake' density", "kN/m3", "1000"),
    ),
    # dashpots
    "a side of corners": (
        f"{CASE}[[block]]\nname = 'top'\nvertices = [[0, 4], [1, 3], [2, 4], [1, 5]]\n"
        '[[viscous_boundary]]\nwhere = {side = "top"}\n',
        ("viscous boundary 1, where", "only corners", "name the edges"),
    ),
    "no edge for a wave": (
        shaken("time = [0, 1]\nacceleration = [0, 1]", "incoming"),
        ("ground_motion", "no viscous boundaries", "[[viscous_boundary]]"),
    ),
    # records
    "record without unit": (shaken('file = "r.csv"\ndirection = [1, 0]'), ("unit", "give unit =")),
    "record cut short": (
        shaken('file = "short.at2"'),
        ("short.at2", "NPTS is", ("get the original file")),
    ),
    "record goes back": (
        shaken('file = "back.csv"'),
        ("back.csv: line 4", "not rise", "order the"),
    ),
    "record of nan": (
        shaken('file = "nan.csv"'),
        ("nan.csv: line 3", "not a line of an acc", "give"),
    ),
    # stress and damping
    "no stress": (stressed(""), ("[in_situ]", "neither stress nor vertical", "give stress")),
}


def records(folder: Path) -> None:
    """Write records, most of which are none."""
    (folder / "r.csv").write_text("t,ax\n0,0\n0.01,1\n0.02,0\n")
    (folder / "back.csv").write_text("t,ax\n0,0\n0.02,1\n0.01,0\n")
    (folder / "nan.csv").write_text("t,ax\n0,0\n0.01,nan\n0.02,0\n")
    (folder / "short.at2").write_text("\n".join(at2_text().splitlines()[:-1]))


def is_one_message(message: str, words: tuple[str, ...]) -> None:
    assert message.startswith("error: ") and message.count("error: ") == 1, message
    assert "\n  " in message, "every message offers a remedy"
    assert "Traceback" not in message and "pydantic" not in message
    assert not re.search(r"[\x00-\x09\x0b-\x1f]", message) and len(message) < 2000
    for word in words:
        assert word in message, message


@pytest.mark.parametrize("name", BROKEN)
def test_what_cannot_be_meant_is_refused_in_words(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    text, words = BROKEN[name]
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(text, encoding="utf-8")
    records(tmp_path)
    before = sorted(tmp_path.iterdir())
    is_one_message(refusal(Path("case.toml")), ("case.toml: ", *words))
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("name", some_of(BROKEN, 5))
def test_the_commands_say_so_and_write_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    text, words = BROKEN[name]
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(text, encoding="utf-8")
    records(tmp_path)
    before = sorted(tmp_path.iterdir())
    for command in (("check",), ("run", "-o", "case.vtkhdf")):
        result = clast_command(command[0], "case.toml", *command[1:])
        assert result.exit_code == 2 and result.stdout == "", result.output
        is_one_message(result.stderr, ("case.toml: ", *words))
        assert sorted(tmp_path.iterdir()) == before


def test_stages_that_are_too_short_are_warned_of(tmp_path: Path):
    case = tmp_path / "case.toml"
    case.write_text(stage("hold = 100", "every = 1e-6"), encoding="utf-8")
    said = " ".join(clast_command("check", case).stderr.split())
    assert "stage 'first' has 50 steps, and equilibrium has to hold for 100" in said
    assert "stage 'second': every is 1e-06 s, less than a step of 0.001 s" in said


# going on ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run in three stages that is over, with files that look like checkpoints."""
    folder = tmp_path_factory.mktemp("ended")
    stages = [f"time = 0.003\n{keys}" for keys in ("", DIG, 'install = ["B"]')]
    text = stage(*stages, more=BOLT) + "[output]\ncheckpoint_every = 100\n"
    (folder / "case.toml").write_text(text, encoding="utf-8")
    good("run", folder / "case.toml", "-o", folder / "case.vtkhdf")
    whole = (folder / "case.checkpoint.h5").read_bytes()
    (folder / "empty.checkpoint.h5").write_bytes(b"")
    (folder / "cut.checkpoint.h5").write_bytes(whole[: len(whole) // 2])
    (folder / "foreign.checkpoint.h5").write_bytes(b"These are not bytes of ours.\n" * 99)
    (folder / "folder.checkpoint.h5").mkdir()
    shutil.copy(folder / "case.vtkhdf", folder / "results.checkpoint.h5")
    return folder


LAST = "case.checkpoint.h5"
SET = (LAST, "--set")
NOT_RESUMED: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "empty": (("empty.checkpoint.h5",), ("is not a clast checkpoint", "name a file that ends in")),
    "cut off": (("cut.checkpoint.h5",), ("is damaged", "resume from another")),
    "foreign": (("foreign.checkpoint.h5",), ("is not a clast checkpoint", "name a file")),
    "a folder": (("folder.checkpoint.h5",), ("is a directory", "name a file")),
    "results": (("results.checkpoint.h5",), ("is a result file", "beside it")),
    "a case": (("case.toml",), ("is not a clast checkpoint", "name a file")),
    "nobody": (("no.checkpoint.h5",), ("there is no such file", "name a checkpoint")),
    "stage unknown": ((LAST, "--stage", "secnd"), ("--stage", "'secnd'", "'second'?")),
    "no stage before": ((LAST, "--stage", "first"), ("--stage", "none before it", "clast run")),
    "stage without a name": ((LAST, "--stage", ""), ("--stage", "not the name", "leave it out")),
    "stage called NUL": ((LAST, "--stage", "a\0"), ("--stage", "no stage 'a", "first, second")),
    "other rock": ((*SET, "rock.rock.young=1e9"), ("--set", "would change", "time.end")),
    "other bolts": ((*SET, "bolt=[]"), ("--set", "'bolt'", "checkpoint_every")),
    "other stages": ((*SET, "stage.2.time=1"), ("--set", "'stage.2.time'", "--stage NAME")),
    "sets nothing": ((*SET, "nonsense"), ("--set", "sets no value", "table.key=value")),
    "an end before": ((*SET, "time.end=1e-3"), ("--set time.end", "is over", "a later end")),
    "never": ((*SET, "output.checkpoint_every=nan"), ("checkpoint_every", "finite")),
}


@pytest.mark.parametrize("name", NOT_RESUMED)
def test_what_cannot_go_on_is_refused_in_words(
    name: str, ended: Path, monkeypatch: pytest.MonkeyPatch
):
    arguments, words = NOT_RESUMED[name]
    monkeypatch.chdir(ended)
    before = {path: path.stat().st_mtime_ns for path in ended.iterdir()}
    result = clast_command("resume", *arguments)
    assert result.exit_code == 2, result.output
    is_one_message(result.stderr, words)
    assert {path: path.stat().st_mtime_ns for path in ended.iterdir()} == before


def test_a_stage_whose_start_was_not_kept_is_not_run_again(
    ended: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    for name in (LAST, "case.vtkhdf", "case.toml"):
        shutil.copy(ended / name, name)
    result = clast_command("resume", LAST, "--stage", "second")
    assert result.exit_code == 2
    is_one_message(result.stderr, ("case.first.checkpoint.h5", "end of stage 'first'", "again"))
