"""Checks in one warm process: what they say, when they are made anew, what they cost."""

import json
import os
import subprocess
import sys
import time

import pytest

from clast.case.case_file import Case
from clast.case.checking import check, checks
from clast.case.templates import TEMPLATES
from clast.errors import CaseError

SLOPE = TEMPLATES["slope"]
ROCK = """
title = "Cut"
time = {step = 1e-3, end = 0.01}
[rock.stone]
young = 1e9
poisson = 0.2
density = 2500.0
[domain]
boundary = [[0, 0], [22, 0], [22, 16], [0, 16]]
fixed_sides = ["bottom"]
[[joint_set]]
name = "beds"
angle = 5.0
spacing = 1.5
[[joint_set]]
name = "cross"
angle = 85.0
spacing = 1.9
"""


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_it_says_what_the_command_says(name):
    found = check(TEMPLATES[name], "x.toml")
    said = found.as_dict()
    assert said["faults"] == []
    case = Case.from_text(TEMPLATES[name], "x.toml")
    summary = case.examine() if case.has_blocks else None
    assert said["blocks"] == (summary.blocks if summary else None)
    assert [one["what"] for one in said["warnings"]] == list(summary.warnings if summary else ())


def test_a_fault_has_its_line_and_its_words():
    lines = ROCK.splitlines()
    text = ROCK.replace("poisson = 0.2", "poisson = 0.7").replace("spacing = 1.9", "spacing = true")
    one, other = check(text, "x.toml").as_dict()["faults"]
    assert (one["place"], one["where"]) == (["rock", "stone", "poisson"], "[rock.stone] poisson")
    assert (other["place"][:2], other["where"]) == (
        ["joint_set", 1],
        "[[joint_set]] 2 'cross' spacing",
    )
    assert [one["line"], other["line"]] == [lines.index("poisson = 0.2") + 1, len(lines)]
    with pytest.raises(CaseError, match="2 things to put right"):
        Case.from_text(text, "x.toml")


def test_a_text_that_is_no_toml_has_the_line_of_the_parser():
    found = check(ROCK + "end = = 3\n", "x.toml").as_dict()["faults"]
    assert [(one["line"], one["place"]) for one in found] == [(len(ROCK.splitlines()) + 1, [])]
    assert found[0]["where"].startswith("line ")


def test_blocks_are_cut_again_only_where_the_rock_mass_changed(tmp_path):
    first = check(ROCK, str(tmp_path / "x.toml"))
    same = check(ROCK.replace("Cut", "Same"), str(tmp_path / "x.toml"), before=first)
    assert same.case.cut() is first.case.cut()
    other = check(ROCK.replace("1.9", "2.4"), str(tmp_path / "x.toml"), before=same)
    assert other.case.cut() is not first.case.cut()
    assert other.model.block_count < first.model.block_count
    alone = check(ROCK.replace("1.9", "2.4"), str(tmp_path / "x.toml"))
    assert (other.model.vertices == alone.model.vertices).all()


def test_a_file_that_the_case_names_is_watched_too(tmp_path):
    path, lines = tmp_path / "x.toml", tmp_path / "lines.csv"
    path.write_text(ROCK + '[[trace]]\nfile = "lines.csv"\n')
    lines.write_text("x1,y1,x2,y2\n0,4.1,22,4.1\n")
    found = checks(path)
    first = next(found)
    assert next(found) is None
    lines.write_text("x1,y1,x2,y2\n0,4.1,22,4.1\n0,7.3,22,7.3\n")
    second = next(one for one in found if one is not None)
    assert second.model.block_count > first.model.block_count
    lines.unlink()
    third = next(one for one in found if one is not None)
    assert third.faults[0].place == ("trace", 0, "file")


def test_a_file_that_has_gone_is_told_and_comes_back(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text(ROCK)
    found = checks(path, ["title='Set'"])
    assert next(found).case.title == "Set"
    path.unlink()
    gone = next(one for one in found if one)
    assert gone.as_dict()["faults"][0]["what"].startswith("there is no such file")
    path.write_text(ROCK.replace("density = 2500.0", "density = 2600.0"))
    assert next(one for one in found if one).summary.blocks > 100


def test_a_check_of_131_blocks_takes_less_than_a_third_of_a_second():
    before = check(ROCK, "x.toml")
    took = []
    for k in range(5):
        start = time.process_time()
        before = check(ROCK.replace("1.9", f"1.9{k}"), "x.toml", before=before)
        before.as_dict()
        took.append(time.process_time() - start)
    assert 100 < before.summary.blocks < 250
    assert min(took) < 0.3


def test_the_command_prints_a_line_for_each_change(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text(ROCK)
    command = [sys.executable, "-m", "clast", "check", "--watch", "--json", str(path)]
    env = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=env) as process:
        try:
            first = json.loads(process.stdout.readline())
            path.write_text(ROCK.replace("young = 1e9", "young = 0"))
            second = json.loads(process.stdout.readline())
            path.write_text(ROCK)
            third = json.loads(process.stdout.readline())
        finally:
            process.terminate()
    assert first["faults"] == third["faults"] == []
    assert first["blocks"] == third["blocks"] > 100
    assert second["faults"][0]["place"] == ["rock", "stone", "young"]
    assert second["blocks"] is None
