"""Forces of anchors, linings and links beside their strengths, of runs and of factors."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import pytest

import clast
from clast.case.api import ModelBuilder
from clast.study.collapsing.search import trial_of
from clast.study.collapsing.support_forces import support_forces
from scenes.anchored import JACKED, ONE_BOLT, WEIGHT, anchored
from scenes.command_line import good

STATIC = {"step": 0.05, "end": 1.0, "dynamic_ratio": 0.0}


def test_a_factor_lists_the_anchors_of_its_last_trial_that_stands(tmp_path, monkeypatch):
    """A jack pulls by 1e5 N/m, a bolt that yields gives all it has: 9e5 N over 3 m."""
    monkeypatch.chdir(tmp_path)
    kind = {**ONE_BOLT, "pretension": 3e5, "yield_force": 9e5}
    for side in (1.0, -1.0):
        anchored(Path("c.toml"), kind, **JACKED, side=side)
        (force,) = clast.factor_of_safety("c.toml", tolerance=0.1).supports
        assert (force.support, force.name, force.what) == ("bolt", "A", "axial")
        assert force.force == pytest.approx(1e5) and force.strength == pytest.approx(3e5)
        assert force.used == pytest.approx(1 / 3) and force.state == "intact"
    out = good("study", "fos", "c.toml", "--tolerance", "0.1", "-o", "fos")
    assert "which stands" in out and "33.3" in out
    report = Path("fos/report.html").read_text(encoding="utf-8")
    assert "Anchors, linings and links" in report and "33.3" in report
    with Path("fos/supports.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert float(row["force"]) == force.force and float(row["strength"]) == force.strength
    (again,) = json.loads(good("study", "resume", "fos", "--json"))["supports"]
    assert again == vars(force)


def test_an_anchor_that_yields_is_said_to(tmp_path):
    kind = {**ONE_BOLT, "pretension": 3e5, "yield_force": 3.6e5}
    found = clast.factor_of_safety(anchored(tmp_path / "c.toml", kind), tolerance=0.01)
    (force,) = found.supports
    assert force.used == pytest.approx(1.0, abs=0.1) and force.strength == pytest.approx(1.2e5)
    # along the plane: what friction with F does not hold hangs on it
    a, b = math.radians(35.0), math.radians(20.0)
    tan = math.tan(math.radians(40.0)) / found.low
    hangs = WEIGHT * (math.sin(a) - math.cos(a) * tan) / (math.cos(b) + math.sin(b) * tan)
    assert force.force == pytest.approx(hangs, rel=0.01)


def test_links_have_the_force_of_each_component():
    builder = ModelBuilder(title="hung", gravity=(0.0, -10.0))
    builder.add_rock("stone", young=1e11, poisson=0.2, density=2500.0)
    builder.block(name="cube", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    way = (math.cos(math.radians(30.0)), math.sin(math.radians(30.0)))
    builder.link(
        (0.5, 0.5), block="cube", direction=way, x=1e6, y=1e6, rotation=1e6, yield_force=5e4,
        name="hang",
    )  # fmt: skip
    forces = {one.what: one for one in support_forces(clast.simulate(builder.build(), **STATIC))}
    assert forces["along"].force == pytest.approx(2.5e4 * way[1], rel=1e-4)
    assert forces["across"].force == pytest.approx(2.5e4 * way[0], rel=1e-4)
    assert forces["across"].used == pytest.approx(0.5 * way[0], rel=1e-4)
    assert forces["rotation"].strength is None and forces["rotation"].used is None


@pytest.mark.parametrize("mirrored", [1.0, -1.0])
def test_a_lining_has_its_worst_joint(mirrored):
    """A clamped beam with a load at a of its length: P a b^2/L^2 at the nearer end."""
    builder = ModelBuilder(title="beam", gravity=(0.0, 0.0))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    for name, x in (("left", -1.0), ("right", 2.0)):
        corners = [(x, -0.5), (x + 1.0, -0.5), (x + 1.0, 0.5), (x, 0.5)]
        builder.block(name=name, vertices=corners, fixed=True)
    builder.lining(
        "beam", polyline=[(0.0, 0.0), (2.0, 0.0)], side="middle", thickness=0.1, segment=0.1,
        young=20e9, density=2400.0, tension=2e6, compression=20e6, start="clamped", end="clamped",
    )  # fmt: skip
    builder.point_load((0.45, 0.0), (0.0, -3e3 * mirrored), "beam/5")
    normal, moment = support_forces(clast.simulate(builder.build(), **STATIC))
    assert (normal.what, moment.what) == ("N", "M") and normal.state == "intact"
    assert moment.force == pytest.approx(mirrored * 3e3 * 0.45 * 1.55**2 / 4.0, rel=0.02)
    zone = 2e6 * 0.1 / 22e6
    holds = 0.5 * 22e6 * zone * (0.1 - zone)
    assert moment.strength == pytest.approx(holds, rel=0.01)
    assert moment.used == pytest.approx(abs(moment.force) / holds, rel=0.01)


def test_what_is_no_force_of_a_support_is_no_trial():
    plain = {"factor": 1.0, "verdict": "stands", "displacement": 0.0, "mover": ""}
    assert trial_of(plain) is not None and trial_of(plain).supports == ()
    one = {"support": "bolt", "name": "A", "what": "axial", "force": 1.0, "strength": None,
           "used": None, "state": "intact"}  # fmt: skip
    assert trial_of({**plain, "supports": [one]}).supports[0].name == "A"
    for wrong in ([{**one, "force": "x"}], [{**one, "name": 3}], [{}], [1], 3, "abc"):
        assert trial_of({**plain, "supports": wrong}) is None
