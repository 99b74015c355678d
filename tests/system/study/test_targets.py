"""Targets: the value of a parameter with which a factor or a measure reaches a limit."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import clast
from clast.study.folder import StudyFolder
from clast.study.targeting.target_report import write_target
from scenes.anchored import JACKED, WEIGHT, anchored, exact
from scenes.command_line import clast_command, good

FORCE = "bolt_kind.anchor.pretension"
COHESION = "joint.plane.cohesion"
F = "factor_of_safety() >= 1.3"


def needed(factor: float, dip=35.0, friction=40.0, angle=20.0) -> float:
    """Return the anchor force T of F = (W cos a + T sin b) tan phi/(W sin a - T cos b), N/m."""
    a, phi, b = (math.radians(one) for one in (dip, friction, angle))
    lacks = WEIGHT * (factor * math.sin(a) - math.cos(a) * math.tan(phi))
    return lacks / (factor * math.cos(b) + math.sin(b) * math.tan(phi))


@pytest.mark.parametrize(
    "view", [{}, {"side": -1.0}, {"dip": 50.0, "friction": 55.0, "angle": 40.0}]
)
def test_the_force_of_an_anchor_for_a_factor_of_safety(tmp_path, view):
    case = anchored(tmp_path / "c.toml", {"stiffness": 1e7, "pretension": 1e5}, **JACKED, **view)
    given = {key: value for key, value in view.items() if key != "side"}
    found = clast.target(case, {FORCE: (10e3, 200e3)}, F)
    assert found.is_settled and found.unit.startswith("N")
    # the bracket, and what a verdict of a trial lies off: 0.1 % of F
    slope = (exact(35.0, 40.0, 20.0, 2e5) - exact(35.0, 40.0, 20.0, 0.0)) / 2e5
    width = 190e3 * 0.002 + 1.3e-3 / slope
    assert abs(found.value - needed(1.3, **given)) < width
    yes, no = found.ends
    assert found.value == yes.value > no.value and len(found.runs) == 11


def test_ends_factors_and_ways_to_say_it_do_not_matter(tmp_path):
    case = anchored(tmp_path / "c.toml", {"stiffness": 1e7, "pretension": 1e5}, **JACKED)
    found = clast.target(case, {FORCE: (10e3, 202e3)}, F, tolerance=0.01)
    back = clast.target(case, {FORCE: (202e3, 10e3)}, "1.3 <= factor_of_safety()", tolerance=0.01)
    times = {f"T: {FORCE}": "times(between(0.1, 2.02))"}
    share = clast.target(case, times, F, tolerance=0.01)
    # in full, each run has its factor, the lower end of its bracket of 1 %
    full = clast.target(
        case, {FORCE: (10e3, 202e3)}, "factor_of_safety() + 0 >= 1.3", tolerance=0.1
    )
    assert found.value == back.value == pytest.approx(1e5 * share.value)
    low, high = sorted(one.value for one in full.ends)
    assert low - 20e3 <= found.value <= high
    factors = {one.value: one.measures["factor_of_safety() + 0"] for one in full.runs}
    for force, factor in factors.items():
        assert factor == pytest.approx(exact(35.0, 40.0, 20.0, force), rel=0.012)


def test_a_force_that_no_jack_can_have_does_not_end_the_search(tmp_path):
    """Without pretension there is no jack: from there on the search goes inwards."""
    case = anchored(tmp_path / "c.toml", {"stiffness": 1e7, "pretension": 1e5}, **JACKED)
    found = clast.target(case, {FORCE: (0, 100e3)}, F, tolerance=0.02)
    assert found.is_settled and abs(found.value - needed(1.3)) < 3e3
    assert found.runs[0].reached is None and "jack" in found.runs[0].reason


def test_forces_of_supports_are_those_of_the_answer(tmp_path):
    """A jack holds its force: what the anchor carries at the answer is the answer."""
    case = anchored(tmp_path / "c.toml", {"stiffness": 1e7, "pretension": 1e5}, **JACKED)
    for reach in (F, "factor_of_safety() < 1.3", "bolt_force(A) >= 60e3"):
        there = tmp_path / str(len(reach))
        found = clast.target(case, {FORCE: (10e3, 200e3)}, reach, tolerance=0.1, folder=there)
        (anchor,) = found.supported.supports
        assert (anchor.support, anchor.what) == ("bolt", "axial")
        assert anchor.force == pytest.approx(found.supported.value, rel=1e-3)
        # a factor below 1.3 is reached where the trial with 1.3 fails: the other end stands
        assert found.supported is found.ends["<" in reach]
        rows = (there / "supports.csv").read_text().splitlines()
        assert rows[0].startswith("support,name,what,force") and len(rows) == 2
        content = found.as_dict()
        assert content["supports"][0]["force"] == anchor.force
        assert content["supports_of"] == found.supported.number
        again = clast.target(case, {FORCE: (10e3, 200e3)}, reach, tolerance=0.1, folder=there)
        assert again.supported == found.supported
        assert "Anchors, linings and links in run" in write_target(
            StudyFolder.opened(there), found
        ).read_text("utf-8")


def test_settings_of_factors_are_public(slab):
    how = clast.FactorSettings(by="gravity", tolerance=0.02)
    study = clast.Study(
        slab.file,
        vary={COHESION: [1e4, 2e4]},
        measure={"F": "factor_of_safety()"},
        factor=how,
    )
    assert study.described().how_of_factor == how


def test_a_measure_meets_its_limit(slab):
    """The plane carries W sin a, which goes with the density."""
    found = clast.target(
        slab.file, {"rock.rock.density": (1500, 2600)}, "shear_force(plane) <= 4e5"
    )
    limit = 2600.0 * 4e5 / (900e3 * math.sin(math.radians(38.0)))
    yes, no = found.ends
    assert yes.value <= limit * (1.0 + 1e-6) and no.value >= limit * (1.0 - 1e-6)
    assert no.value - yes.value <= 0.002 * 1100.0 * (1.0 + 1e-9)
    assert yes.measures["shear_force(plane)"] == pytest.approx(4e5, rel=0.002)


def test_a_place_is_sought_on_a_line(tmp_path):
    """A table tips over its foot where P x = W b/2, x from the edge of the foot."""
    builder = clast.ModelBuilder(title="A table", gravity=(0.0, -10.0))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=40.0)
    builder.block(name="floor", vertices=[(-4, -1), (4, -1), (4, 0), (-4, 0)], fixed=True)
    table = [(-0.5, 0), (0.5, 0), (0.5, 1), (3, 1), (3, 1.2), (-3, 1.2), (-3, 1), (-0.5, 1)]
    builder.block(name="table", vertices=table)
    builder.point_load((0.0, 1.2), (0.0, -40e3), block="table")
    stages = [clast.Stage(name="rest", dynamic_ratio=0.0)]
    file = tmp_path / "table.toml"
    file.write_text(builder.to_toml(step=0.005, end=2.0, max_displacement=1e-3, stages=stages))
    area = 1.0 + 6.0 * 0.2
    x = 0.5 + 2500.0 * 10.0 * area * 0.5 / 40e3
    for ends in ([[0.0, 1.2], [2.9, 1.2]], [[0.0, 1.2], [-2.9, 1.2]]):
        found = clast.target(file, {"point_load.1.at": clast.Between(*ends)}, "not fails()")
        assert found.is_settled and found.value[1] == 1.2
        assert abs(found.value[0]) == pytest.approx(x, abs=0.006 + 0.005)
    swept = clast.Study(
        file, vary={"point_load.1.at": [[0.0, 1.2], [2.9, 1.2]]}, measure={"u": "farthest()"},
        fail="fails()",
    )  # fmt: skip
    table = swept.run(tmp_path / "sweep", array=(1, 1))
    assert table["fails"] == [False, True] and table["point_load.1.at"][1] == [2.9, 1.2]


def test_a_search_that_was_broken_off_goes_on(slab, tmp_path):
    made: list[int] = []

    def stop(run: object) -> None:
        made.append(run.number)  # type: ignore[attr-defined]
        if len(made) == 4:
            raise KeyboardInterrupt

    given = {COHESION: (5e3, 60e3)}
    with pytest.raises(KeyboardInterrupt):
        clast.target(slab.file, given, F, folder=tmp_path / "out", watch=stop)
    first = tmp_path / "out/runs/0000/00000002/result.json"
    before = first.stat().st_mtime_ns
    found = clast.target(slab.file, given, F, folder=tmp_path / "out")
    assert first.stat().st_mtime_ns == before
    whole = clast.target(slab.file, given, F)
    assert [one.value for one in found.runs] == [one.value for one in whole.runs]
    assert found.value == whole.value
    limit = (1.3 * WEIGHT_OF_SLAB * SIN - WEIGHT_OF_SLAB * COS * TAN) / 12.0
    assert found.value == pytest.approx(
        limit, abs=0.002 * 55e3 + 1e-3 * WEIGHT_OF_SLAB * SIN / 12.0
    )
    # one that was damaged is made again
    first.write_text("{}")
    assert clast.target(slab.file, given, F, folder=tmp_path / "out").value == whole.value


WEIGHT_OF_SLAB = 900e3
SIN, COS = (one(math.radians(38.0)) for one in (math.sin, math.cos))
TAN = math.tan(math.radians(34.0))


def test_whether_blocks_stand_with_a_factor_is_a_measure(slab, tmp_path):
    """One trial: the slab has 1.1882."""
    study = clast.Study(
        slab.file,
        vary={COHESION: [15e3, 60e3]},
        measure={"a": "stands(1.17)", "b": "stands(1.21)"},
        fail="not stands(1.3)",
    )
    table = study.run(tmp_path / "out", array=(1, 1))
    assert table["a"] == [True, True] and table["b"] == [False, True]
    assert table["fails"] == [True, False]


def test_the_command_prints_table_answer_and_report(slab, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["study", "target", "slab.toml", "--vary", f"{COHESION}=between(5e3, 60e3)", "--reach"]
    out = good(*words, F, "--measure", "u=displacement(A)", "--tolerance", "0.05", "-o", "out")
    assert "not reached" in out and "u = " in out and f"{COHESION} = " in out
    report = Path("out/report.html").read_text(encoding="utf-8")
    assert report.count("<iframe") == 2 and "data:image/png" in report
    assert len(Path("out/results.csv").read_text().splitlines()) == 8
    good("check", "out/answer.toml")
    found = json.loads(good("study", "resume", "out", "--json"))
    assert found["settled"] and f"{found['value']:.6g}" in out
    refused = clast_command("study", "collect", "out")
    assert refused.exit_code == 2 and "resume" in refused.output
    done = clast_command(*words, "factor_of_safety() >= 9", "-o", "no")
    assert done.exit_code == 1 and "at neither end" in done.output
    assert Path("no/report.html").exists()


@pytest.mark.parametrize(
    ("vary", "reach", "what"),
    [
        ({COHESION: (0, 1e4)}, "factor_of_safety() = 1.3", "write >= or <="),
        ({COHESION: (0, 1e4)}, "factor_of_safety() == 1.3", "write >= or <="),
        ({COHESION: (0, 1e4)}, "factor_of_safety()", "is a number, not a target"),
        ({COHESION: (0, 1e4)}, "factor_of_safty() >= 1.3", "did you mean"),
        ({COHESION: (0, 1e4)}, "displacement(B) < 1", "no point or block 'B'"),
        ({COHESION: (0, 1e4)}, "stands(0)", "no factor '0'"),
        ({COHESION: "uniform(0, 1)"}, F, "between"),
        ({COHESION: [0, 1]}, F, "between"),
        ({COHESION: (1, 1)}, F, "two different ends"),
        ({COHESION: ("a", 1)}, F, "needs two numbers"),
        ({COHESION: clast.Between((0, 1), 3)}, F, "needs two numbers"),
        ({COHESION: (0, 1), "joint.plane.friction_angle": (0, 1)}, F, "one parameter"),
        ({}, F, "no parameter varies"),
        ({"joint.plan.cohesion": (0, 1)}, F, "plan"),
        ({"joint.plane.cohsion": (0, 1)}, F, "cohsion"),
    ],
)
def test_what_is_no_target_is_refused(slab, vary, reach, what):
    with pytest.raises(clast.CaseError) as refused:
        clast.target(slab.file, vary, reach)
    assert what in str(refused.value)


def test_a_wrong_tolerance_is_refused(slab):
    for tolerance in (0.0, 1.0, math.nan, "a"):
        with pytest.raises(clast.CaseError, match="tolerance"):
            clast.target(slab.file, {COHESION: (0, 1e5)}, F, tolerance=tolerance)


def test_a_range_is_no_distribution(slab):
    study = clast.Study(slab.file, vary={COHESION: "between(0, 1)"}, measure={"u": "end()"})
    with pytest.raises(clast.CaseError, match="no distribution"):
        study.described()
