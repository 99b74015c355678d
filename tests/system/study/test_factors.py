"""Factors of safety and collapse loads against formulas and limit analysis."""

from __future__ import annotations

import importlib
import json
import math
import tomllib
from pathlib import Path

import pytest

import clast
from clast.errors import CaseError
from clast.inputs.declaring.text import to_toml
from clast.study.collapsing import reduction, trial
from clast.verification.problems.masonry import arch_push
from clast.verification.problems.slopes import toppling, wet_slope

PIT = """
schema = 1
time = {step = 5e-3, end = 2.0, dynamic_ratio = 0.0}
rock.granite = {young = 2e10, poisson = 0.25, density = 2650.0}
joint = {default = {friction_angle = 32.0}, fault = {friction_angle = 32.0, cohesion = 2e4}}
domain.profile = [[0, 0], [20, 0], [30, 20], [50, 20]]
domain.depth = 8.0
domain.fixed_sides = ["left", "right", "bottom"]
trace = [{points = [[19, BELOW], [50, ABOVE]], joint = "fault"}]
"""


@pytest.mark.parametrize("clear", [True, False])
def test_blocks_that_stand_only_after_moving_are_told_of(clear):
    """The plane comes out in the corner of the floor, which holds the toe, or 1 m above it."""
    up = float(clear)
    text = PIT.replace("BELOW", str(up - 0.7)).replace("ABOVE", str(up + 21.0066))
    case = clast.Case.from_text(text, "pit")
    found = clast.factor_of_safety(case, tolerance=0.005)
    model, tan = case.model(), math.tan(math.radians(32.0))
    weight, dip = 9.8 * 2650.0 * float(model.area[~model.fixed].sum()), math.atan2(21.7066, 31.0)
    (wedge,) = (model.polygon(k) for k in range(2) if not model.fixed[k])
    length = math.dist(wedge[wedge[:, 1].argmin()], wedge[wedge[:, 0].argmax()])
    exact = (2e4 * length + weight * math.cos(dip) * tan) / (weight * math.sin(dip))
    if clear:
        assert found.low <= 1.005 * exact and found.high >= 0.995 * exact
        assert not found.warnings
    else:
        assert found.low > 1.5 * exact
        (said,) = found.warnings
        assert "only after moving" in said and "Limit equilibrium" in said


def written(path: Path, builder: clast.ModelBuilder, **keys: object) -> Path:
    path.write_text(builder.to_toml(**keys))  # type: ignore[arg-type]
    return path


def wet(
    path: Path,
    slope: wet_slope.Slope,
    water: float,
    monkeypatch: pytest.MonkeyPatch,
    seismic: float = 0.0,
) -> Path:
    """Write the case of a slope of Hoek and Bray with water in its crack, or pushed."""
    monkeypatch.setattr(wet_slope, "InputBuilder", clast.ModelBuilder)
    builder = wet_slope.dry_slope(slope, seismic=seismic)
    if water > 0.0:
        level = float(slope.foot[1]) + water
        builder.water(level, acts_on="joints", drained_at=[(0.0, 0.0)])
    return written(path, builder, end=2.0)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 1.0])
def test_hoek_and_brays_slope_at_four_water_levels(share, tmp_path, monkeypatch):
    slope = wet_slope.critical_slope()
    case = wet(tmp_path / "s1.toml", slope, share * slope.depth, monkeypatch)
    found = clast.factor_of_safety(case, joints=["plane"], tolerance=0.005)
    exact = slope.exact_factor(share * slope.depth)
    assert found.is_settled and not found.undecided
    assert found.value == pytest.approx(exact, rel=0.01)
    assert all("slab" in one.blocks for one in found.trials if one.verdict == "fails")


def test_hoek_and_brays_slope_in_an_earthquake(tmp_path, monkeypatch):
    """The strength is reduced under a push of 0.08 g, and a push is found that reduces it to 1."""
    slope = wet_slope.critical_slope()
    case = wet(tmp_path / "s1.toml", slope, 0.0, monkeypatch, wet_slope.SEISMIC)
    found = clast.factor_of_safety(case, joints=["plane"], tolerance=0.005)
    assert found.is_settled and not found.undecided
    assert found.value == pytest.approx(slope.exact_factor(0.0, wet_slope.SEISMIC), rel=0.01)
    water = 0.5 * slope.depth
    case = wet(tmp_path / "wet.toml", slope, water, monkeypatch)
    pushed = clast.collapse_load(case, "pga left", tolerance=0.01)
    assert slope.exact_factor(water, pushed.high) < 1.0 + 1e-4
    assert slope.exact_factor(water, pushed.low) == pytest.approx(1.0, rel=0.003)
    shaken = ["seismic_coefficient=[-0.08, 0.0]"]
    with pytest.raises(CaseError, match="already has a seismic coefficient"):
        clast.collapse_load(clast.Case.from_toml(case, shaken), "pga left")


@pytest.mark.parametrize(
    ("settings", "how"),
    [
        ([], {"start": 0.4, "growth": 3.0}),
        (["time.step=0.05"], {"start": 2.5, "growth": 1.1}),
        (["time.step=0.001", "time.max_displacement=0.002"], {"start": 0.93, "growth": 1.5}),
    ],
)
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_wet_slope_whatever_the_search_and_the_step(share, settings, how, tmp_path, monkeypatch):
    slope = wet_slope.critical_slope()
    case = clast.Case.from_toml(
        wet(tmp_path / "s1.toml", slope, share * slope.depth, monkeypatch), settings
    )
    found = clast.factor_of_safety(case, joints=["plane"], tolerance=0.005, **how)
    assert found.is_settled and not found.undecided
    assert found.value == pytest.approx(slope.exact_factor(share * slope.depth), rel=0.01)


@pytest.mark.parametrize("how", [{}, {"start": 0.4, "growth": 3.0}])
def test_sixteen_columns_topple_where_their_recursion_says(how, tmp_path):
    builder = clast.ModelBuilder()
    toppling.build(builder, math.degrees(math.atan(0.9)))
    # in steps of 0.3 m, the default of a run, columns leap past an equilibrium 1 mm away
    case = written(tmp_path / "s5.toml", builder, end=2.0)
    found = clast.factor_of_safety(case, tolerance=0.005, **how)
    exact = 0.9 / math.tan(math.radians(toppling.limit_angle()))
    assert exact == pytest.approx(1.1459, abs=3e-4)
    assert found.is_settled and not found.undecided
    assert found.value == pytest.approx(exact, rel=0.005)


def test_a_stage_of_the_case_that_fails_is_warned_of(slab, tmp_path):
    """Without a prop it slides before there is a strength to reduce; with one it stands."""
    content = tomllib.loads(slab.file.read_text())
    first = {"name": "bare", "dynamic_ratio": 0.0, "time": 0.1, "until": "equilibrium"}
    weak = {**first, "joint": {"plane": {"friction_angle": 20.0, "cohesion": 0.0}}}
    strong = {**first, "name": "grouted", "joint": {"plane": {"friction_angle": 45.0}}}
    found = {}
    for name, stages in {"slid": [weak, strong], "held": [strong]}.items():
        file = tmp_path / f"{name}.toml"
        file.write_text(to_toml({**content, "stage": stages}))
        found[name] = clast.factor_of_safety(file, tolerance=0.1, folder=tmp_path / name)
    assert found["held"].warnings == ()
    (said,) = found["slid"].warnings
    assert "stage 'bare' of the case ends without equilibrium" in said
    assert clast.factor_of_safety(
        tmp_path / "slid.toml", tolerance=0.1, folder=tmp_path / "slid"
    ).warnings == (said,)


def test_a_slope_that_fails_as_it_is(tmp_path, monkeypatch):
    slope = wet_slope.steep_slope()
    water = slope.depth - 2.0
    case = wet(tmp_path / "s2.toml", slope, water, monkeypatch)
    found = clast.factor_of_safety(case, tolerance=0.005)
    assert found.value == pytest.approx(slope.exact_factor(water), rel=0.01)


@pytest.mark.parametrize(
    ("settings", "changes"),
    [
        ([], {"start": 0.4, "growth": 3.0}),
        ([], {"start": 2.5, "growth": 1.1}),
        (["time.max_displacement=0.002"], {}),
    ],
)
def test_a_slab_whatever_the_search_and_the_step(slab, settings, changes):
    case = clast.Case.from_toml(slab.file, settings)
    found = clast.factor_of_safety(case, tolerance=0.004, **changes)
    assert found.low <= slab.factor() <= found.high * 1.001
    assert found.value == pytest.approx(slab.factor(), rel=0.005)


@pytest.mark.parametrize("process", ["modified", "open-close"])
@pytest.mark.one_in(2)
def test_a_slab_whatever_the_process(slab, process):
    case = clast.Case.from_toml(slab.file, [f"method.process={process}"])
    found = clast.factor_of_safety(case, tolerance=0.02)
    assert found.is_settled and not found.undecided
    assert found.low <= slab.factor() <= found.high * 1.001


def test_a_push_and_a_load_at_collapse(slab, tmp_path):
    """k (cos a + sin a tan phi) W = P = c L + W cos a tan phi - W sin a."""
    load = slab.spare()
    push = load / slab.pushed()
    assert clast.collapse_load(slab.file, "pga left", tolerance=0.005).value == pytest.approx(
        push, rel=0.01
    )
    content = tomllib.loads(slab.file.read_text())
    corners = content["block"][1]["vertices"]
    middle = [0.5 * (a + b) for a, b in zip(corners[1], corners[2], strict=True)]
    along = [b - a for a, b in zip(corners[0], corners[1], strict=True)]
    size = sum(one * one for one in along) ** 0.5
    force = [-1e4 * one / size for one in along]
    content["point_load"] = [{"at": middle, "force": force, "block": "slab", "name": "jack"}]
    loaded = tmp_path / "loaded.toml"
    loaded.write_text(to_toml(content))
    found = clast.collapse_load(loaded, "load jack", tolerance=0.005)
    assert 1e4 * found.value == pytest.approx(load, rel=0.01)


@pytest.mark.parametrize("turned", [0.0, 90.0])
def test_a_unit_load_goes_on_until_it_tells(slab, tmp_path, turned):
    """1 N down the plane has spare() as its factor; 1 N into the plane has none."""
    content = tomllib.loads(slab.file.read_text())
    corners = content["block"][1]["vertices"]
    middle = [sum(xy) / 4.0 for xy in zip(*corners, strict=True)]
    angle = math.radians(38.0 + 180.0 + turned)
    force = [math.cos(angle), math.sin(angle)]
    content["point_load"] = [{"at": middle, "force": force, "block": "slab", "name": "jack"}]
    loaded = tmp_path / "loaded.toml"
    loaded.write_text(to_toml(content))
    found = clast.collapse_load(loaded, "load jack", tolerance=0.005)
    if not turned:
        assert found.value == pytest.approx(slab.spare(), rel=0.01)
        assert len(found.trials) < 30
    else:
        assert math.isnan(found.value)
        weight = found.sentence.split("the load is ")[1]
        assert 1e3 / 16.0 < float(weight.split()[0]) <= 1e3


def test_an_arch_under_push(tmp_path):
    arch = arch_push.OPPENHEIM
    builder = clast.ModelBuilder(title="Arch", gravity=(0.0, -9.8))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2400.0)
    builder.add_joint("default", friction_angle=arch.friction_angle)
    arch_push.add_arch(builder, arch)
    case = written(tmp_path / "arch.toml", builder, end=4.0, step=0.02)
    exact = arch_push.exact_factor(arch)
    for by in ("pga", "pga left"):
        found = clast.collapse_load(case, by, tolerance=0.01)
        assert found.value == pytest.approx(exact, rel=0.015)


def test_a_study_goes_on_with_the_trials_that_are_there(slab, tmp_path, monkeypatch):
    module = importlib.import_module("clast.study.collapsing.collapse")
    whole = clast.factor_of_safety(slab.file, folder=tmp_path / "whole")
    made = []

    def interrupted(number: int, one: trial.Trial) -> None:
        made.append(number)
        if number == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        clast.factor_of_safety(slab.file, folder=tmp_path / "part", watch=interrupted)
    counted = []
    real = module.run_trial
    monkeypatch.setattr(module, "run_trial", lambda *given: counted.append(1) or real(*given))
    found = clast.factor_of_safety(slab.file, folder=tmp_path / "part")
    assert found.trials == whole.trials
    assert len(counted) == len(whole.trials) - 4
    tables = [(tmp_path / name / "trials.csv").read_bytes() for name in ("whole", "part")]
    assert tables[0] == tables[1]
    result = json.loads((tmp_path / "part/runs/0000/00000002/result.json").read_text())
    assert result["trial"]["verdict"] == "fails"


def test_what_cannot_be_looked_for_is_refused(slab):
    for given, what in [
        ({"joints": ["plan"]}, "no joint 'plan'"),
        ({"joints": "plane"}, "not names of joints"),
        ({"tolerance": 0.0}, "not a valid tolerance"),
        ({"start": -1.0}, "not a valid start"),
        ({"growth": 1.0}, "not a valid growth"),
        ({"refine": -3}, "not a valid number of trials"),
    ]:
        with pytest.raises(CaseError, match=what):
            clast.factor_of_safety(slab.file, **given)
    for by, what in [
        ("strenght", "cannot be applied"),
        ("load", "cannot be applied"),
        ("load jack", "no load 'jack'"),
        ("pga up", "cannot be applied"),
    ]:
        with pytest.raises(CaseError, match=what):
            clast.collapse_load(slab.file, by)
    with pytest.raises(CaseError, match="is neither a case nor a model"):
        clast.factor_of_safety(3)


@pytest.mark.slow
def test_undecided_is_only_what_a_longer_trial_leaves_undecided(slab, monkeypatch):
    """Short trials of the modified process, which has not come to its end near the limit."""
    by = reduction.ScaledStrength()
    settings = ["method.process=modified", "time.end=0.05"]
    start = trial.settle_standing(clast.Case.from_toml(slab.file, settings), by)
    found = {}
    for steps in (30, 60):
        monkeypatch.setattr(reduction, "STATIC_STEPS_MIN", steps)
        start.trials.clear()
        for share in (-0.1, -0.01, -1e-3, 1e-3, 0.01, 0.1):
            one = trial.run_trial(start, by, float(slab.factor()) * (1.0 + share))
            truth = trial.STANDS if share < 0.0 else trial.FAILED
            assert one.verdict in (truth, trial.UNDECIDED), (steps, share)
            found[steps, share] = one
    longer = [one for one in found.values() if one.longer]
    assert {one.verdict for one in longer} == {trial.STANDS, trial.FAILED, trial.UNDECIDED}
    assert all(one.longer for one in found.values() if one.verdict == trial.UNDECIDED)
