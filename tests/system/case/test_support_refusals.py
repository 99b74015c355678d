"""What users do wrong with motions, reactions, links and worn joints: each is refused by name."""

from __future__ import annotations

import json
import tomllib
from typing import Any

import pytest

import clast
from clast.errors import CaseError, ModelError

BASE = tomllib.loads(
    """
schema = 1
[time]
step = 1e-3
end = 1.0
[rock.stone]
young = 5e9
poisson = 0.2
density = 2500
[joint.default]
friction_angle = 30
[[block]]
name = "floor"
vertices = [[-1, -1], [5, -1], [5, 0], [-1, 0]]
fixed = true
[[block]]
name = "wall"
vertices = [[6, -1], [7, -1], [7, 0], [6, 0]]
fixed = true
[[block]]
name = "box"
vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]
[[block]]
name = "lid"
vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]
[[block]]
name = "held"
vertices = [[3, 0], [4, 0], [4, 1], [3, 1]]
[[fixed_point]]
at = [3, 0]
block = "held"
[[fixed_point]]
at = [4, 0]
block = "held"
[amplitude.way]
time = [0, 1]
value = [0, 0.01]
[amplitude.late]
time = [0, 1]
value = [0.02, 0.03]
[[stage]]
name = "first"
[[stage]]
name = "second"
"""
)
"""A case in which all is right."""
HINGE = {"at": [1, 1], "blocks": ["box", "lid"], "x": "rigid", "y": "rigid"}
SERVO = {"block": "box", "stress": [0, -1e6], "limit_speed": 0.1}
ROUGH = {"law": "barton-bandis", "jrc": 8.0, "jcs": 50e6, "residual_friction_angle": 27.0}
MOTIONS: list[tuple[dict[str, Any], str]] = [
    ({"block": "box", "fixed_point": [3, 0], "x": 1.0}, "names block and fixed_point"),
    ({"blocks": ["box", "box"], "x": 1.0}, "names block 'box' twice"),
    ({"block": "bux", "x": 1.0}, "there is no block 'bux'"),
    ({"block": "held", "x": 1.0}, "block 'held' is held by a fixed point, too"),
    ({"fixed_point": [3, 0], "x": 1.0, "about": [0, 0]}, "a fixed point has no about"),
    ({"fixed_point": [3, 0], "force": [0, -1], "limit_speed": 1}, "a fixed point has no force"),
    ({"block": "box", "x": 1.0, "amplitude": "way"}, "amplitude is for a servo"),
    ({**SERVO, "y": 0.0}, "y is given both a motion and a force"),
    ({**SERVO, "block": "floor"}, "block 'floor' is fixed, so no force"),
    ({**SERVO, "block": None, "blocks": ["box", "lid"]}, "its blocks differ in width"),
    ({**SERVO, "amplitude": "weigh"}, "there is no amplitude 'weigh'"),
    ({"block": "box", "x": {"displacement": "weg"}}, "there is no amplitude 'weg'"),
    ({"block": "box", "x": {"displacement": "late"}}, "is 0.02 where the motion begins"),
    ({"block": "box", "x": 1.0, "stage": "third"}, "there is no stage 'third'"),
    ({"block": "box", "x": 1.0, "until": "third"}, "there is no stage 'third'"),
]
TWICE: list[tuple[dict[str, Any], str]] = [
    ({"name": "a", "block": "box", "x": 2.0}, "there are two motions 'a'"),
    ({"name": "b", "block": "box", "x": -1.0}, "x of block 'box' is moved by motion 'a', too"),
    ({"name": "b", "blocks": ["lid", "box"], "x": 1.0}, "x of block 'box' is moved by"),
    ({"name": "b", "block": "box", "force": [1, 0], "limit_speed": 1}, "x of block 'box' is moved"),
]
"""Second motions, beside one of "box" in x."""
LINKS: list[tuple[dict[str, Any], str]] = [
    ({**HINGE, "blocks": ["box", "box"]}, "links block 'box' with itself"),
    ({**HINGE, "blocks": ["box", "lit"]}, "there is no block 'lit'"),
    ({**HINGE, "blocks": ["floor", "wall"]}, "links two fixed blocks"),
    ({**HINGE, "blocks": None, "block": "floor"}, "links a fixed block to the ground"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "yield_force": 10}, "yield_force is that of"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "gap": 0.1}, "gap is that of x or y"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "rupture": 0.1}, "rupture is that of x or y"),
    ({**HINGE, "rupture_rotation": 5}, "rupture_rotation is that of rotation"),
    ({**HINGE, "stage": "third"}, "there is no stage 'third'"),
]
MOMENTS: list[tuple[dict[str, Any], str]] = [
    ({"block": "bax", "moment": 1e3}, "there is no block 'bax'"),
    ({"block": "box"}, "moment: is missing"),
    ({"block": "box", "moment": 1e3, "amplitude": "wej"}, "there is no amplitude 'wej'"),
]
REACTIONS: list[tuple[dict[str, Any], str]] = [
    ({"name": "r", "block": "floor", "fixed_point": [3, 0]}, "names block and fixed_point"),
    ({"name": "r", "block": "box"}, "block 'box' is neither fixed nor moved"),
    ({"name": "fixed blocks", "block": "floor"}, "'fixed blocks'"),
]
JOINTS: list[tuple[dict[str, Any], str]] = [
    ({"friction_angle": 30, "slip_weakening": 0.01}, "slip_weakening"),
]


def text_of(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {text_of(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    return json.dumps(value).replace("NaN", "nan")


def case_with(changes: dict[str, Any]) -> clast.Case:
    """Return the case with other tables."""
    content = {**BASE, **changes}
    lines = [f"{key} = {text_of(value)}" for key, value in content.items()]
    return clast.Case.from_text("\n".join(lines), "case.toml")


def refused(changes: dict[str, Any]) -> str:
    """Return the message with which the case with other tables is refused."""
    with pytest.raises((CaseError, ModelError)) as caught:
        case_with(changes).examine()
    return str(caught.value)


def without_none(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


CASES = [
    *(({"motion": [one]}, said) for one, said in MOTIONS),
    *(({"motion": [{"name": "a", "block": "box", "x": 1.0}, one]}, said) for one, said in TWICE),
    *(({"link": [one]}, said) for one, said in LINKS),
    *(({"moment": [one]}, said) for one, said in MOMENTS),
    *(({"measured_reaction": [one]}, said) for one, said in REACTIONS),
    *(({"joint": {"default": one}}, said) for one, said in JOINTS),
]


@pytest.mark.parametrize(("changes", "said"), CASES, ids=[said for _, said in CASES])
def test_it_is_refused_with_its_place_and_a_remedy(changes: dict[str, Any], said: str):
    tables = {
        key: [without_none(one) for one in value] if isinstance(value, list) else value
        for key, value in changes.items()
    }
    message = refused(tables)
    assert said in message
    # place, fault and, on a line of its own, the remedy
    assert message.count("\n") >= 1
    assert next(iter(changes)).split("_")[-1] in message


def test_there_are_thirty_of_them_and_the_case_itself_is_right():
    assert len(CASES) >= 30
    case_with({}).examine()
