"""Every refusal of a broad table of broken inputs, word by word, by case file and by script.

`every_refusal.txt` has place, fault and remedy of each, and the digests of cases that are written.
Where a change is meant, write it anew and read the difference:

    python tests/system/case/test_every_refusal.py
"""

import hashlib
import tomllib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import clast
from clast.case import templates
from clast.errors import CaseError
from scenes.broken_inputs import (
    BASE,
    ROCK_MASS,
    SETTINGS,
    WRONG,
    broken,
    changed,
    keys_in,
    made_of,
    places_of,
)

HERE = Path(__file__).parent
KEPT = HERE / "every_refusal.txt"


def scene() -> clast.ModelBuilder:
    builder = clast.ModelBuilder(plane=clast.PlaneStrain())
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, -1), (4, -1), (4, 0), (0, 0)], name="base", rock="stone")
    builder.block(vertices=[(0, 0), (1, 0), (1, 2), (0, 2)], name="wall", rock="stone")
    builder.add_amplitude("ramp", [0.0, 1.0], [0.5, 1.0])
    builder.add_bolt_kind("bar", stiffness=1e7, yield_force=1e5, pretension=1e3)
    return builder


CONTENT = tomllib.loads(BASE)


def first(key: str, **changes: Any) -> dict[str, Any]:
    """Return the keys of the first table of a kind as a script gives them, at no stage."""
    table = {**CONTENT[key][0], **changes}
    return {name: value for name, value in table.items() if name not in ("stage", "until")}


BEAM = {"name": "plate", "polyline": [(2.0, 0.0), (3.5, 0.0)], "side": "left", "closed": False}
BEAM |= {"thickness": 0.1, "segment": 0.25, "young": 2e10, "poisson": 0.2, "density": 2400.0}
BEAM |= {"tension": 2e6, "compression": 2e7, "joint": None, "start": "free", "end": "free"}
DASHPOTS = {"side": "bottom", "normal": 1.0, "tangential": 1.0, "static": "hold", "begins": 0.0}
PATTERN = {"opening": [(0.3, -0.5), (0.7, -0.5), (0.5, -0.3)], "kind": "bar", "length": 0.6}
PATTERN |= {"spacing": 0.5, "angles": (60, 120), "name": "ring", "anchorage": "ends"}
CORNERS = [(5, 0), (6, 0), (6, 1)]
CALLS: dict[str, dict[str, Any]] = {
    "add_rock": {"name": "r", **CONTENT["rock"]["stone"]},
    "add_joint": {"name": "default", **CONTENT["joint"]["default"]},
    "block": {**CONTENT["block"][1], "name": "c", "vertices": CORNERS, "rock": "stone"}
    | {"edge_joint": ["", "", ""]},
    "add_amplitude": {"name": "t", **CONTENT["amplitude"]["ramp"]},
    "fixed_point": first("fixed_point"),
    "point_load": first("point_load", name="p"),
    "line_load": first("line_load", name="p"),
    "pressure": first("pressure", name="p"),
    "measured_point": first("measured_point"),
    "measured_convergence": first("measured_convergence"),
    "measured_contact": first("measured_contact"),
    "measured_reaction": first("measured_reaction"),
    "link": first("link"),
    "moment": first("moment"),
    "lining": BEAM,
    "motion": first("motion"),
    "add_bolt_kind": {"name": "k", **CONTENT["bolt_kind"]["bar"]},
    "bolt": first("bolt"),
    "bolt_pattern": PATTERN,
    "water": first("water"),
    "viscous_boundary": DASHPOTS,
    "opening": first("opening"),
}


STAGE: dict[str, Any] = {
    "name": "rest",
    "until": "time",
    "time": 0.01,
    "damping": "adaptive",
    "dynamic_ratio": 0.0,
    "force_ratio": 1e-4,
    "speed": 1e-6,
    "hold": 20,
    "reset_displacement": True,
    "step": 1e-3,
    "every": 1e-3,
    "excavate": ["wall"],
    "relax": 0.5,
    "relax_time": 0.001,
    "install": [],
    "joints": {"default": {"cohesion": 1.0}},
    "bonds": "hold",
    "loads": ["ramp"],
    "ground_motion": False,
}
STRESS: dict[str, Any] = {
    "stress": (-1e3, -1e3, 0.0),
    "gradient": (0.0, 0.0, 0.0),
    "datum": 0.0,
    "in_contacts": 1.0,
    "held": (1.0, 0.0),
    "sides": ("left",),
}
WEIGHT: dict[str, Any] = {"k0": 0.5, "datum": 10.0, **{key: STRESS[key] for key in [*STRESS][3:]}}
RECORD: dict[str, Any] = {"time": [0.0, 1.0], "acceleration": [[0.0, 0.0], [1.0, 0.0]]}
KEYS: dict[str, Any] = {
    "step": 1e-3,
    "end": 0.01,
    "max_displacement": 0.01,
    "dynamic_ratio": 1.0,
    "smallest_step": 1e-6,
    "process": "modified",
    "contact_law": {"name": "penalty", "normal_stiffness": 1e9},
    "corner_rule": "shi",
    "rotation": "exact",
    "integrator": "midpoint",
    "solver": "pcg",
    "critdis": 0.005,
    "fixed_point_stiffness": 1e11,
    "damping": {"mass": 1.0},
    "every": 1e-3,
    "contacts": True,
    "checkpoint_every": 10.0,
}


def said(attempt: Callable[[], object]) -> str:
    """Return place, fault and remedy of a refusal, one line."""
    try:
        attempt()
    except CaseError as error:
        return " | ".join([error.where, error.what, error.remedy]).replace("\n", " // ")
    except Exception as error:  # a traceback: none of these should be left
        return f"{type(error).__name__}: {error}".replace("\n", " // ")
    return "is taken"


def refusals() -> Iterator[str]:
    """Give all refusals, and what is written of all cases."""
    for source, text in {"file": BASE, "rock mass": ROCK_MASS}.items():
        content = tomllib.loads(text)
        for path in keys_in(content):
            for name, value in WRONG.items():
                case = changed(content, list(path), value)
                place = ".".join(str(one + 1 if isinstance(one, int) else one) for one in path)
                yield f"{source}, {place} = {name}: {said(partial(made_of, case))}"
    for name, settings in SETTINGS.items():
        yield f"file, {name}: {said(partial(broken, settings))}"
    for method, keys in CALLS.items():
        yield from wrongly(method, partial(called, method), keys)
    for thing, (attempt, keys) in OBJECTS.items():
        yield from wrongly(thing, attempt, keys)


def wrongly(
    thing: str, attempt: Callable[[dict[str, Any]], object], keys: dict[str, Any]
) -> Iterator[str]:
    """Give the refusals of what a script makes by keys, each of them wrong, absent and unknown."""
    for key in keys:
        for name, value in WRONG.items():
            given = {**keys, key: value}
            yield f"script, {thing} {key} = {name}: {said(partial(attempt, given))}"
    for key in keys:
        given = {one: value for one, value in keys.items() if one != key}
        yield f"script, {thing} without {key}: {said(partial(attempt, given))}"
    yield f"script, {thing} nonsense: {said(partial(attempt, {**keys, 'nonsense': 1}))}"


def called(method: str, keys: dict[str, Any]) -> None:
    builder = scene()
    getattr(builder, method)(**keys)
    builder.build()


def staged(keys: dict[str, Any]) -> None:
    case = scene().case(stages=[clast.Stage(**keys)], step=1e-3)
    case.examine()


def stressed(keys: dict[str, Any]) -> None:
    builder = scene()
    builder.in_situ = clast.InSituStress(**keys)
    builder.build()


def weighed(keys: dict[str, Any]) -> None:
    builder = scene()
    builder.in_situ = clast.Overburden(**keys)
    builder.build()


def shaken(keys: dict[str, Any]) -> None:
    builder = scene()
    arrays = {key: np.array(value) for key, value in keys.items()}
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(**arrays))
    builder.build()


def chosen(keys: dict[str, Any]) -> None:
    case = scene().case(**keys)
    case.method()
    case.schedule()


OBJECTS: dict[str, tuple[Callable[[dict[str, Any]], None], dict[str, Any]]] = {
    "Stage": (staged, STAGE),
    "InSituStress": (stressed, STRESS),
    "Overburden": (weighed, WEIGHT),
    "Accelerogram": (shaken, RECORD),
    "keys": (chosen, KEYS),
}
"""What a script makes beside calls of the builder, with all its keys."""


def written() -> Iterator[str]:
    """Give digests of what cases and scripts are written as."""
    for name, text in sorted(templates.TEMPLATES.items()):
        yield f"written, template {name}: {digest(clast.Case.from_text(text, 'x'))}"
    yield f"written, all tables: {digest(clast.Case.from_text(BASE, 'x'))}"
    yield f"written, rock mass: {digest(clast.Case.from_text(ROCK_MASS, 'x'))}"
    builder = scene()
    builder.measured_point(**CONTENT["measured_point"][1])
    for method, keys in CALLS.items():
        getattr(builder, method)(**keys)
    builder.in_situ = clast.Overburden(**WEIGHT)
    record = (np.array(value) for value in RECORD.values())
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(*record))
    text = builder.to_toml(stages=[clast.Stage(**STAGE)], **KEYS)
    yield from ("written, script: " + line for line in text.splitlines())


def digest(case: clast.Case) -> str:
    return hashlib.sha256(case.to_toml().encode()).hexdigest()


def test_refusals_are_word_by_word_what_they_were():
    before = KEPT.read_text(encoding="utf-8").splitlines()
    now = [*refusals(), *written()]
    assert now == before


NOWHERE = {"reaction of a total", "reactions of a name", "edge of no joint"}
"""Faults of reactions, and of blocks that are given by arrays: no table has them."""


def is_there(place: tuple[Any, ...], content: Any) -> bool:
    """Return whether a place leads to a table or a value, or to a key that is missing."""
    for part in place[:-1]:
        try:
            content = content[part]
        except (KeyError, IndexError, TypeError):
            return False
    return bool(place)


def test_every_refusal_has_a_place_that_the_file_has():
    without, count = set(), 0
    for text in (BASE, ROCK_MASS):
        content = tomllib.loads(text)
        for path in keys_in(content):
            for value in WRONG.values():
                case = changed(content, list(path), value)
                for place in places_of(partial(made_of, case)):
                    count += 1
                    assert is_there(place, case), (path, value, place)
    for name, settings in SETTINGS.items():
        for place in places_of(partial(broken, settings)):
            count += 1
            without |= {name} if not place else set()
    assert without == NOWHERE
    assert count > 2000


if __name__ == "__main__":
    KEPT.write_text("\n".join([*refusals(), *written()]) + "\n", encoding="utf-8")
