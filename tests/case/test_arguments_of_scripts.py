"""Arguments of scripts: types and sentences in help and stub, and the things that calls take."""

import inspect
import sys
from pathlib import Path

import pytest
import script_stub

import clast
from clast.errors import CaseError, ModelError

RIGHT = """
import numpy as np
import clast

builder = clast.ModelBuilder(title="A stack", plane="strain")
builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
builder.block(name="slab", vertices=[(-1, -1), (3, -1), (3, 0)], fixed=True)
builder.block(vertices=np.zeros((4, 2)))
builder.point_load(at=(1, 2.5), force=(-5e3, 0), block="slab")
builder.in_situ = {"vertical": "overburden", "k0": 0.5}
builder.viscous_boundary(side="bottom")
builder.bolt_pattern("heading", kind="b", length=3.0, spacing=1.0, angles=(0, 180))
stages = [clast.Stage(name="a", excavate=["x"], damping="adaptive")]
run = clast.simulate(builder, end=0.2, process="modified", stages=stages)
print(run.report, clast.simulate("case.toml", contact_law={"name": "penalty"}))
print(clast.factor_of_safety(builder).value, clast.collapse_load(builder.build(), "pga").value)
"""
WRONG = """
import clast

builder = clast.ModelBuilder(titel="A stack")
builder.plane = "strian"
builder.add_rock("granite", young="50e9", poisson=0.2, density=2700.0)
builder.add_joint(friktion=30.0)
builder.point_load((1, 2.5))
builder.point_load((1, 2.5, 3), force=(0, 0))
builder.opening("a", blocks="b")
builder.gravty = (0, 0)
clast.simulate(builder, ende=0.2)
clast.simulate(builder, process="modfied")
clast.Stage(name="a", until="equilibrum")
clast.factor_of_safety(1)
"""


def stack() -> clast.ModelBuilder:
    """Return two blocks, one of them falling."""
    builder = clast.ModelBuilder(title="Stack", plane="strain")
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="ground", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="a", vertices=[(0, 0.01), (1, 0.01), (1, 1), (0, 1)])
    return builder


def test_the_stub_is_up_to_date():
    assert script_stub.STUB.read_text("utf-8") == script_stub.stub()


@pytest.mark.slow  # mypy reads the package
def test_a_type_checker_finds_every_wrong_argument_and_no_other(tmp_path: Path):
    from mypy import api

    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(WRONG)
    files = [str(tmp_path / name) for name in ("right.py", "wrong.py")]
    own = ["--strict", "--config-file=", "--python-executable", sys.executable]
    deepest = sys.getrecursionlimit()
    said, _, _ = api.run([*own, "--cache-dir", str(tmp_path / "cache"), *files])
    sys.setrecursionlimit(deepest)  # mypy raises it, and what is nested too deeply would be read
    faults = [line for line in said.splitlines() if ": error:" in line]
    rows = {int(line.split("wrong.py:")[1].split(":")[0]) for line in faults}
    assert rows == set(range(4, len(WRONG.splitlines()) + 1)), said


def test_help_shows_every_argument_with_type_and_sentence():
    for name in ("bolt", "point_load", "add_joint", "lining", "viscous_boundary", "bolt_pattern"):
        method = getattr(clast.ModelBuilder, name)
        text = inspect.getdoc(method) or ""
        for key, one in inspect.signature(method).parameters.items():
            if key != "self":
                assert f"\n    {key}: " in text, (name, key)
                assert one.annotation is not one.empty, (name, key)
    for taker in (clast.simulate, clast.ModelBuilder.case, clast.Stage):
        assert "until" in (text := inspect.getdoc(taker) or "") or "max_displacement: " in text
    force = inspect.signature(stack().point_load).parameters["force"]
    assert force.annotation == "tuple[float, float]"


def test_a_builder_shows_the_names_that_users_call():
    shown = [name for name in dir(clast.ModelBuilder) if not name.startswith("_")]
    assert {"block", "build", "plane", "to_toml", "water"} <= set(shown)
    assert not {"add", "all", "named", "count", "has", "add_block", "actions_from"} & set(shown)
    assert {*shown} <= {*dir(stack())}


def test_a_builder_counts_its_parts():
    builder = stack()
    builder.fixed_point((0, -1))
    text = "ModelBuilder('Stack': 1 rock, 1 joint, 2 blocks, 1 fixed point; plane strain)"
    assert repr(builder) == text
    assert "0 blocks" in repr(clast.ModelBuilder())


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("plane", "strian", "'strian' is no plane assumption"),
        ("gravty", (0, 0), "no attribute 'gravty'.*'gravity'"),
        ("water", {"level": 2}, r"'water' is a method.*builder.water\("),
    ],
)
def test_attributes_are_taken_or_refused_in_words(name: str, value: object, text: str):
    with pytest.raises(ModelError, match=f"(?s){text}"):
        setattr(stack(), name, value)


def test_file_case_builder_and_model_give_the_same_run(tmp_path: Path):
    builder = stack()
    (tmp_path / "stack.toml").write_text(builder.to_toml(end=0.1, step=1e-3))
    case = clast.load(tmp_path / "stack.toml")
    given = [str(tmp_path / "stack.toml"), case, builder, builder.build(), case.model()]
    ends = [clast.simulate(one, end=0.02, step=1e-3).final.vertices for one in given]
    assert all((end == ends[0]).all() for end in ends)
    assert clast.simulate(case, end=0.02, method=case.method()).final.time == pytest.approx(0.02)


def test_studies_take_what_simulate_takes(tmp_path: Path):
    builder = stack()
    model = builder.build()
    builder.block(name="later", vertices=[(5, 5), (6, 5), (6, 6)])
    study = clast.Study(model, vary={"rock.rock.density": [1000.0, 2000.0]})
    assert len(study.case.block) == 2  # as it was when the model was made
    assert len(clast.Study(builder, vary={"rock.rock.density": [1e3]}).case.block) == 3
    assert clast.factor_of_safety.__doc__ and "refine: " in clast.factor_of_safety.__doc__


@pytest.mark.parametrize("taker", [clast.simulate, clast.factor_of_safety])
def test_other_things_are_refused_in_words(taker):
    with pytest.raises(CaseError, match=r"(?s)3 is neither.*builder\.build"):
        taker(3)


def test_a_model_that_a_script_has_changed_stands_for_no_case():
    from dataclasses import replace

    model = replace(stack().build(), title="Another")
    with pytest.raises(CaseError, match="no case is known"):
        clast.factor_of_safety(model)


def test_a_case_with_other_values_keeps_the_rest():
    case = stack().case(end=0.1, step=1e-3, process="modified")
    other = case.with_(
        time={"end": 0.2}, joint={"default": {"cohesion": 1e3}}, method={"solver": "pcg"}
    )
    assert (other.time.end, other.time.step) == (0.2, 1e-3)
    joint = other.joint["default"]
    assert (joint.cohesion, joint.friction_angle) == (1e3, 30.0)
    assert other.method_.chosen("process").name == "modified"
    assert (other.plane, case.with_(plane="stress").plane) == ("strain", "stress")
    assert case.time.end == 0.1
    assert case.with_().to_toml() == case.to_toml()
    # a choice is replaced with its numbers
    loose = case.with_(damping={"name": "rayleigh", "mass": 2.0}).with_(damping="kinetic")
    assert "mass" not in loose.to_toml()


@pytest.mark.parametrize(
    ("tables", "text"),
    [
        ({"time": {"ende": 2}}, r"(?s)time.*ende.*end"),
        ({"tme": {"end": 2}}, r"(?s)tme.*time"),
        ({"time": 3}, "time"),
    ],
)
def test_wrong_values_of_a_case_are_refused_in_words(tables, text):
    with pytest.raises(CaseError, match=text) as refused:
        stack().case(end=0.1).with_(**tables)
    assert "pydantic" not in str(refused.value)


def test_references_go_where_the_system_changes():
    text = stack().to_toml(end=0.1, step=1e-3)
    text += "[[measured_point]]\nname = 'A'\nat = [0, 1]\nblock = 'a'\n"
    text += "[[reference]]\npoint = 'A'\ndisplacement = [0.0, -0.01]\n"
    case = clast.Case.from_toml(text)
    assert len(case.reference) == len(case.with_(time={"end": 0.2}).reference) == 1
    assert case.with_(gravity=(0.0, -5.0)).reference == []
