"""Trains, fill, convergences, drawpoints and releases that cannot be: one message with a remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenes.refusals import refusal

CASE = """
schema = 1
time = {step = 1e-3, end = 0.01}
rock.stone = {young = 5e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[[block]]
name = "floor"
vertices = [[-2, -1], [6, -1], [6, 0], [-2, 0]]
fixed = true
[[block]]
name = "left"
vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]
[[block]]
name = "right"
vertices = [[2, 0], [4, 0], [4, 1], [2, 1]]
[[measured_point]]
name = "A"
at = [0, 1]
[[measured_point]]
name = "B"
at = [4, 1]
"""
TRAIN = """
[[load_train]]
name = "lorry"
path = [[0, 1.5], [4, 1.5]]
position = 2.0
axles = [0.0, 1.0]
loads = [1e3, 1e3]
"""
FILL = '[[fill]]\nname = "earth"\nsurface = [[0, 2], [4, 2]]\ndensity = 1900.0\n'
DIG = '[[stage]]\nname = "dig"\nexcavate = ["right"]\nrelease = 0.6\n[[stage]]\nname = "later"\n'


def train(old: str, new: str) -> str:
    assert TRAIN.count(old) == 1
    return CASE + TRAIN.replace(old, new)


def fill(surface: str) -> str:
    return CASE + FILL.replace("[[0, 2], [4, 2]]", surface)


def pair(keys: str) -> str:
    return f"{CASE}[[measured_convergence]]\n{keys}\n"


def mouth(keys: str) -> str:
    return f'{CASE}[[drawpoint]]\nname = "chute"\n{keys}\n'


def later(keys: str) -> str:
    return f"{CASE}{DIG}{keys}\n"


LINE = "line = [[0, -0.5], [1, -0.5]]\n"
LORRY, PAIR = "[[load_train]] 1 'lorry' ", "[[measured_convergence]] 1 'c' of"
BROKEN: dict[str, tuple[str, tuple[str, ...]]] = {
    "one point": (train("[4, 1.5]]", "]"), (LORRY + "path", "has 1 point(s)", "at least 2")),
    "turns back": (
        train("[4, 1.5]]", "[4, 1.5], [1, 1.5]]"),
        (LORRY + "path", "turns back", "from point 2 to point 3", "let it run from left to right"),
    ),
    "path inside": (train("[4, 1.5]]", "[4, 0]]"), ("load train 'lorry', axle 1", "inside block")),
    "axle before the front": (
        train("axles = [0.0, 1.0]", "axles = [0.0, -1.0]"),
        (LORRY + "axles 2", "0 or more, not -1.0", "behind the front"),
    ),
    "a load short": (train("[1e3, 1e3]", "[1e3]"), (LORRY + "loads", "1 load(s) for 2 axle(s)")),
    "lifts": (train("[1e3, 1e3]", "[1e3, -1e3]"), (LORRY + "loads 2", "0 or more, not -1000.0")),
    "no front": (train("2.0", "nan"), (LORRY + "position", "must be a finite number, not nan")),
    "two faults": (
        train("2.0", '"x"').replace("[1e3, 1e3]", "[-1]"),
        ("2 things to put right", LORRY + "position", LORRY + "loads 1"),
    ),
    "stage of no train": (
        CASE + TRAIN + '[[stage]]\nname = "s"\nloads = ["lory"]\n',
        ("stage 's', loads", "'lory'", "did you mean 'lorry'?"),
    ),
    "fill on nothing": (fill("[[10, 2], [14, 2]]"), ("fill 'earth'", "rests on no block")),
    "fill on its side": (
        "gravity = [9.81, 0.0]" + fill("[[0, 2], [4, 2]]"),
        ("fill 'earth'", "gravity does not act downwards", "draw it as blocks"),
    ),
    "a cliff of fill": (fill("[[0, 2], [0, 4]]"), ("[[fill]] 1 'earth' surface", "vertically")),
    "no such point": (pair('name = "c"\nof = ["A", "C"]'), (PAIR, "no measured point 'C'", "A, B")),
    "one end": (pair('name = "c"\nof = ["A"]'), (PAIR, "number 2 is missing")),
    "no distance": (pair('name = "c"\nof = ["A", "A"]'), ("'c', of", "at one place", "lie apart")),
    "line of one place": (
        mouth("line = [[0, 0], [0, 0]]"),
        ("drawpoint 'chute', line", "begins and ends at the same point", "its two ends"),
    ),
    "no rate": (mouth(LINE + "rate = 0"), ("[[drawpoint]] 1 'chute' rate", "must be above 0")),
    "no such stage": (mouth(LINE + 'stage = "x"'), ("'chute', stage", "no stage 'x'", "[[stage]]")),
    "nothing moves": (
        mouth(LINE).replace("end = 0.01", "end = 0.01, dynamic_ratio = 0.0"),
        ("drawpoint 'chute'", "all steps are static", "dynamic_ratio = 1.0"),
    ),
    "a number for nothing": (
        later("release = 1.0"),
        ("[[stage]] 2 'later' release", "it excavates nothing", "release = {heading = 1.0}"),
    ),
    "less than before": (
        later("release = {right = 0.3}"),
        ("stage 'later', release, right", "0.3 is not more than the 0.6", "grows up to 1"),
    ),
    "released unexcavated": (
        later("release = {left = 1.0}"),
        ("stage 'later', release, left", "has not been excavated", "excavate it in this stage"),
    ),
    "percent": (later("release = {right = 60}"), ("release.right", "1 or less, not 60", "0 to 1")),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_cannot_be_is_refused_in_words(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    text, words = BROKEN[name]
    Path("case.toml").write_text(text, encoding="utf-8")
    message = refusal(Path("case.toml"))
    assert message.startswith("error: case.toml: ") and "\n  " in message, message
    assert "Traceback" not in message and "pydantic" not in message
    for word in words:
        assert word in message, message
