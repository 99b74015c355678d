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
    ({"x": 1.0}, "names nothing that moves"),
    ({"block": "box", "blocks": ["box"], "x": 1.0}, "names block and blocks"),
    ({"block": "box", "fixed_point": [3, 0], "x": 1.0}, "names block and fixed_point"),
    ({"blocks": [], "x": 1.0}, "is empty"),
    ({"blocks": ["box", "box"], "x": 1.0}, "names block 'box' twice"),
    ({"block": "bux", "x": 1.0}, "there is no block 'bux'"),
    ({"block": "box"}, "does not say how the block moves"),
    ({"block": "held", "x": 1.0}, "block 'held' is held by a fixed point, too"),
    ({"fixed_point": [3.5, 0], "x": 1.0}, "there is no fixed point at"),
    ({"fixed_point": [3, 0], "rotation": 1.0}, "a fixed point has no rotation"),
    ({"fixed_point": [3, 0], "x": 1.0, "about": [0, 0]}, "a fixed point has no about"),
    ({"fixed_point": [3, 0], "force": [0, -1], "limit_speed": 1}, "a fixed point has no force"),
    ({"block": "box", "x": 1.0, "about": [0, 0]}, "about is the centre of a rotation"),
    ({"blocks": ["box", "lid"], "rotation": 5.0}, "need a common centre of rotation"),
    ({"block": "box", "force": [0, -1e3], "stress": [0, -1e6], "limit_speed": 1}, "has both force"),
    ({"block": "box", "force": [0, -1e3]}, "limit_speed is missing"),
    ({"block": "box", "x": 1.0, "limit_speed": 1.0}, "limit_speed is for a servo"),
    ({"block": "box", "x": 1.0, "amplitude": "way"}, "amplitude is for a servo"),
    ({**SERVO, "stress": [0, 0]}, "applies no force"),
    ({**SERVO, "y": 0.0}, "y is given both a motion and a force"),
    ({**SERVO, "block": "floor"}, "block 'floor' is fixed, so no force"),
    ({**SERVO, "block": None, "blocks": ["box", "lid"]}, "its blocks differ in width"),
    ({**SERVO, "amplitude": "weigh"}, "there is no amplitude 'weigh'"),
    ({**SERVO, "limit_speed": -1.0}, "must be above 0"),
    ({"block": "box", "x": {"displacement": "weg"}}, "there is no amplitude 'weg'"),
    ({"block": "box", "x": {"displacement": "late"}}, "is 0.02 where the motion begins"),
    ({"block": "box", "x": {}}, "follows nothing"),
    ({"block": "box", "x": {"displacement": "way", "velocity": "way"}}, "follows both"),
    ({"block": "box", "x": 1.0, "ease": -0.1}, "must be"),
    ({"block": "box", "x": 1.0, "stage": "third"}, "there is no stage 'third'"),
    ({"block": "box", "x": 1.0, "until": "third"}, "there is no stage 'third'"),
    ({"block": "box", "x": float("nan")}, "must be a finite number"),
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
    ({**HINGE, "blocks": None}, "names no block"),
    ({**HINGE, "block": "box"}, "has both block and blocks"),
    ({**HINGE, "blocks": ["box", "lit"]}, "there is no block 'lit'"),
    ({**HINGE, "blocks": ["floor", "wall"]}, "links two fixed blocks"),
    ({**HINGE, "blocks": None, "block": "floor"}, "links a fixed block to the ground"),
    ({**HINGE, "x": None, "y": None}, "restrains nothing"),
    ({**HINGE, "direction": [0, 0]}, "has no direction"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "yield_force": 10}, "yield_force is that of"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "gap": 0.1}, "gap is that of x or y"),
    ({**HINGE, "x": None, "y": None, "rotation": 1e3, "rupture": 0.1}, "rupture is that of x or y"),
    ({**HINGE, "yield_moment": 10}, "yield_moment is that of rotation"),
    ({**HINGE, "rupture_rotation": 5}, "rupture_rotation is that of rotation"),
    ({**HINGE, "x": "stiff"}, "rigid"),
    ({**HINGE, "x": -1e6}, "must be above 0"),
    ({**HINGE, "yield_force": 0.0}, "must be above 0"),
    ({**HINGE, "damping": -1.0}, "must be 0 or more"),
    ({**HINGE, "rotation": "rigid", "rupture_rotation": 400}, "must be 360 or less"),
    ({**HINGE, "stage": "third"}, "there is no stage 'third'"),
]
MOMENTS: list[tuple[dict[str, Any], str]] = [
    ({"block": "bax", "moment": 1e3}, "there is no block 'bax'"),
    ({"block": "box"}, "moment: is missing"),
    ({"block": "box", "moment": 1e3, "amplitude": "wej"}, "there is no amplitude 'wej'"),
]
REACTIONS: list[tuple[dict[str, Any], str]] = [
    ({"name": "r"}, "names nothing"),
    ({"name": "r", "block": "floor", "fixed_point": [3, 0]}, "names block and fixed_point"),
    ({"name": "r", "block": "box"}, "block 'box' is neither fixed nor moved"),
    ({"name": "r", "blocks": []}, "names no block"),
    ({"name": "r", "fixed_point": [9, 9]}, "there is no fixed point at"),
    ({"name": "fixed blocks", "block": "floor"}, "'fixed blocks'"),
]
JOINTS: list[tuple[dict[str, Any], str]] = [
    ({"friction_angle": 30, "residual_friction_angle": 35}, "residual_friction_angle"),
    ({"friction_angle": 30, "cohesion": 1e5, "residual_cohesion": 2e5}, "residual_cohesion"),
    ({"friction_angle": 30, "kinetic_friction_angle": 33}, "kinetic_friction_angle"),
    ({"friction_angle": 30, "dilation_angle": 35}, "dilation_angle"),
    ({"friction_angle": 30, "critical_speed": 0.1}, "critical_speed"),
    ({"friction_angle": 30, "dilation_until": 0.1}, "dilation_until"),
    ({"friction_angle": 30, "slip_weakening": 0.01}, "slip_weakening"),
    ({"friction_angle": 0.61}, "radians"),
    ({"friction_angle": 30, "jrc": 8}, 'belongs to a joint with law = "barton-bandis"'),
    ({"law": "barton-bandis", "jrc": 8.0, "jcs": 50e6}, "residual_friction_angle"),
    ({**ROUGH, "jrc": 25.0}, "must be 20 or less"),
    ({**ROUGH, "jcs": 50.0}, "looks like MPa"),
    ({**ROUGH, "friction_angle": 35.0}, 'does not belong to law = "barton-bandis"'),
    ({**ROUGH, "sample_length": 100.0}, "looks like millimetres"),
    ({**ROUGH, "initial_aperture": 0.2}, "looks like millimetres"),
    ({**ROUGH, "field_length": 0.05}, "is less than the length of the sample"),
    ({**ROUGH, "residual_friction_angle": 75.0}, "leave no room for roughness"),
    ({**ROUGH, "law": "barton"}, "barton-bandis"),
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


def test_there_are_sixty_of_them_and_the_case_itself_is_right():
    assert len(CASES) >= 60
    case_with({}).examine()
