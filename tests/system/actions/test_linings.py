"""Linings in whole runs: installed in stages, sections that yield, restarts, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import ModelBuilder
from clast.errors import CaseError, ModelError
from clast.results import Run
from scenes.restarts import differences, pressed_at

CONCRETE: dict[str, Any] = {
    "thickness": 0.1,
    "segment": 0.1,
    "young": 20e9,
    "density": 2400.0,
    "tension": 2e6,
    "compression": 20e6,
}
STATIC: dict[str, Any] = {"step": 0.05, "end": 0.5, "dynamic_ratio": 0.0, "max_displacement": 0.1}


def beam(turned: float = 0.0, mirrored: bool = False, **keys: Any) -> ModelBuilder:
    """Return a lining of 2 m between two fixed blocks, clamped to both, loaded off its middle."""
    angle = np.radians(turned)

    def at(x: float, y: float) -> tuple[float, float]:
        y = -y if mirrored else y
        return (
            float(np.cos(angle) * x - np.sin(angle) * y),
            float(np.sin(angle) * x + np.cos(angle) * y),
        )

    builder = ModelBuilder(title="beam", gravity=(0.0, 0.0))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    for name, x in (("left", -1.0), ("right", 2.0 if keys.get("end") != "free" else 3.0)):
        corners = [at(x, -0.5), at(x + 1.0, -0.5), at(x + 1.0, 0.5), at(x, 0.5)]
        builder.block(name=name, vertices=corners[::-1] if mirrored else corners, fixed=True)
    given = {**CONCRETE, "start": "clamped", "end": "clamped", **keys}
    builder.lining("beam", polyline=[at(0.0, 0.0), at(2.0, 0.0)], side="middle", **given)
    builder.point_load(at(0.45, 0.0), (at(0.0, -1.0)[0] * 3e3, at(0.0, -1.0)[1] * 3e3), "beam/5")
    return builder


def forces(run: Run) -> np.ndarray[Any, Any]:
    """Return N, Q and M along the beam at the end, (k, 3)."""
    lining = run.lining("beam")
    return np.stack([lining.normal_force[-1], lining.shear_force[-1], lining.moment[-1]], axis=1)


def test_a_turned_or_mirrored_lining_bears_the_same():
    usual = forces(clast.simulate(beam().build(), **STATIC))
    # clamped at both ends: P a b^2/L^2 and P b a^2/L^2, within the rule over 20 segments
    ends = 3e3 * 0.45 * 1.55 / 4.0 * np.array([1.55, 0.45])
    assert usual[[0, -1], 2] == pytest.approx(ends, rel=0.02)
    turned = forces(clast.simulate(beam(61.0).build(), **STATIC))
    assert turned[:, 1:] == pytest.approx(usual[:, 1:], rel=1e-6, abs=1e-3)
    mirrored = forces(clast.simulate(beam(0.0, True).build(), **STATIC))
    assert mirrored[:, 2] == pytest.approx(-usual[:, 2], rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
def test_which_end_a_lining_begins_at_does_not_matter(process: str):
    """The direction of a joint turned with its first segment: Q was off by N phi, 1.2 % here."""
    found = []
    for backwards in (False, True):
        builder = ModelBuilder(title="column", gravity=(0.0, 0.0))
        builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
        corners = [(-1.0, -0.5), (0.0, -0.5), (0.0, 0.5), (-1.0, 0.5)]
        builder.block(name="foot", vertices=corners, fixed=True)
        line, ends = [(0.0, 0.0), (2.0, 0.0)], {"start": "clamped", "end": "free"}
        if backwards:
            line, ends = line[::-1], {"start": "free", "end": "clamped"}
        given = {**CONCRETE, "tension": None, "compression": None, **ends}
        builder.lining("mast", polyline=line, side="middle", **given)
        tip = "mast/1" if backwards else "mast/20"
        builder.point_load((1.99, 0.0), (-1e5, -3e3), tip)
        run = clast.simulate(builder.build(), **{**STATIC, "end": 2.0, "process": process})
        mast = run.lining("mast")
        of_end = np.stack([mast.normal_force[-1], mast.shear_force[-1], mast.moment[-1]])
        found.append(of_end[:, ::-1] * [[1.0], [1.0], [-1.0]] if backwards else of_end)
    assert abs(found[0][1]).max() > 1e3
    assert found[1] == pytest.approx(found[0], rel=1e-5, abs=1e-2)


def test_the_stiffness_is_that_of_a_shell_in_plane_strain():
    sunk = []
    for plane in (clast.PlaneStress(), clast.PlaneStrain()):
        builder = beam(tension=None, compression=None)
        builder.plane = plane
        builder.measured_point("A", (0.45, 0.0), "beam/5")
        sunk.append(clast.simulate(builder.build(), **STATIC).history("A").displacement[-1, 1])
    # bending by E/(1 - nu^2), shear by G
    assert sunk[1] / sunk[0] == pytest.approx(0.96, abs=0.004)


def test_a_section_yields_on_its_curve_and_goes_to_the_ledger(tmp_path: Path):
    builder = beam(end="free")
    builder.point_load((2.0, 0.0), (-5e5, 0.0), "beam/20")
    builder.motion(name="push", block="beam/20", y=-0.1, ease=0.05)
    run = clast.simulate(builder.build(), **{**STATIC, "step": 0.01})
    lining = run.lining("beam")
    pressed = 5e5
    zone = (2e6 * 0.1 + pressed) / 22e6
    assert lining.normal_force[-1, 0] == pytest.approx(-pressed, rel=2e-3)
    assert lining.moment[-1, 0] == pytest.approx(0.5 * 22e6 * zone * (0.1 - zone), rel=0.01)
    # in steps that turn by chords it gives way a little, and goes on from below the curve
    assert lining.utilisation.max() == pytest.approx(1.0, abs=1e-5)
    assert lining.state[[0, -1], 0].tolist() == [1, 3]
    kinds = [one.kind for one in run.events]
    assert kinds.index("cracked") < kinds.index("yielded")
    ledger = run.state.ledger
    assert ledger.yielding > 0.0
    assert abs(ledger.unaccounted) < 1e-9 * (abs(ledger.motions) + abs(ledger.loads))
    picture = clast.plot_interaction(run, tmp_path / "points.svg", "beam").read_text("utf-8")
    assert "largest utilisation: 100 %" in picture
    assert "M (kN m/m)" in picture and "N (kN/m)" in picture


@pytest.mark.parametrize("process", ["open-close", "modified"])
@pytest.mark.parametrize(
    ("turned", "mirrored", "push"), [(0.0, False, {"y": -0.1}), (90.0, True, {"x": -0.1})]
)
def test_a_section_yields_in_other_processes_and_nothing_is_thrown(
    process: str, turned: float, mirrored: bool, push: dict[str, float]
):
    """Held by one bound and solved beyond the other, two joints threw a segment between them."""
    builder = beam(turned, mirrored, end="free")
    builder.motion(name="push", block="beam/20", ease=0.05, **push)
    run = clast.simulate(builder.build(), **{**STATIC, "step": 0.01, "process": process})
    lining = run.lining("beam")
    zone = (2e6 * 0.1 - lining.normal_force[-1, 0]) / 22e6
    bears = 0.5 * 22e6 * zone * (0.1 - zone)
    assert abs(lining.moment[-1, 0]) == pytest.approx(bears, rel=0.01)
    # the end goes at 0.1 m/s, and nothing much faster
    assert np.abs(run.state.velocity[:, :2]).max() < 0.3
    ledger = run.state.ledger
    assert ledger.yielding < abs(ledger.motions)
    assert abs(ledger.unaccounted) < 1e-9 * abs(ledger.motions)


def test_a_lining_that_is_bent_and_pulled_stays_within_its_curve():
    """Where N and M do not agree after some solves the step is cut: none is kept beyond."""
    builder = beam(end="free")
    builder.motion(name="push", block="beam/20", x=0.0, y=-0.1, ease=0.05)
    run = clast.simulate(builder.build(), **{**STATIC, "step": 0.01})
    lining = run.lining("beam")
    assert lining.normal_force.max() > 1.5e5
    assert lining.utilisation.max() < 2.0
    assert lining.utilisation[-1].max() < 1.05


def test_an_elastic_lining_has_no_interaction_curve(tmp_path: Path):
    run = clast.simulate(beam(tension=None, compression=None).build(), **STATIC)
    with pytest.raises(CaseError, match="has no strengths"):
        clast.plot_interaction(run, tmp_path / "points.svg", "beam")
    with pytest.raises(CaseError, match="there is no lining 'arch'"):
        clast.plot_interaction(run, tmp_path / "points.svg", "arch")


LONGER = {**CONCRETE, "segment": 0.25}


def tunnel(stage: str = "line") -> ModelBuilder:
    """Return a hole in four blocks under pressure in situ, with a core and a lining for it."""
    builder = ModelBuilder(
        title="tunnel", gravity=(0.0, 0.0), in_situ={"stress": [-1e6, -2e6, 0.0]}
    )
    builder.add_rock("stone", young=2e9, poisson=0.2, density=2500.0)
    joint = {"normal_stiffness": 1e10, "shear_stiffness": 1e10}
    builder.add_joint("default", friction_angle=35.0, **joint)
    builder.add_joint("bond", friction_angle=35.0, cohesion=1e6, tensile_strength=1e6, **joint)
    ring = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
    builder.block(name="core", vertices=ring)
    far = [(3.0, -3.0), (3.0, 3.0), (-3.0, 3.0), (-3.0, -3.0)]
    for k in range(4):
        j = (k + 1) % 4
        builder.block(name=f"rock {k}", vertices=[ring[k], far[k], far[j], ring[j]])
        out = [(1.5 * x, 1.5 * y) for x, y in (far[k], far[j])]
        builder.block(name=f"far {k}", vertices=[far[k], *out, far[j]], fixed=True)
    builder.opening("hole", ["core"])
    builder.lining("shell", opening="hole", joint="bond", stage=stage, **LONGER)
    return builder


STAGES = (
    clast.Stage(name="dig", until="time", time=0.2, excavate=("hole",), relax=0.5, relax_time=2.0),
    clast.Stage(name="line", until="time", time=2.4),
)
STEPS: dict[str, Any] = {"step": 0.1, "dynamic_ratio": 0.0, "max_displacement": 0.05}


@pytest.mark.parametrize("law", ["penalty", "augmented-lagrangian"])
def test_a_lining_comes_without_stress_and_bears_what_is_released(law: str):
    run = clast.simulate(tunnel().build(), end=2.6, stages=STAGES, contact_law=law, **STEPS)
    shell = run.lining("shell")
    there = np.flatnonzero(shell.state[:, 0] == 1)
    assert shell.time[there[0]] == pytest.approx(0.2, abs=0.11)
    before = shell.normal_force[: there[0]]
    assert not before.any()
    first = np.abs(shell.normal_force[there[0] + 1]).max()
    assert first < 0.15 * np.abs(shell.normal_force[-1]).max()
    assert (shell.normal_force[-1] < 0.0).all()
    installed = [one.text for one in run.events if one.kind == "installed"]
    assert installed == ["lining 'shell' is installed"]
    ledger = run.state.ledger
    assert abs(ledger.unaccounted) < 1e-6 * ledger.elastic
    # left and right, and top and bottom, are alike
    n = shell.normal_force[-1]
    assert n == pytest.approx(np.roll(n, len(n) // 2), rel=1e-3)


def test_a_lining_that_comes_later_is_no_overburden():
    builder = tunnel()
    builder.gravity = (0.0, -9.8)
    builder.in_situ = clast.Overburden(k0=0.5, datum=100.0)
    stress = builder.build().in_situ
    assert stress is not None
    rock = builder.build().rocks[0]
    vertical = rock.density * float(builder.build().gravity[1])
    assert stress.gradient == pytest.approx((0.5 * vertical, vertical, 0.0), rel=1e-14)


def test_a_run_with_a_lining_goes_on_to_the_bit(tmp_path: Path):
    text = tunnel().to_toml(end=2.6, stages=STAGES, **STEPS)
    case = clast.Case.from_toml(text, ["output.checkpoint_every=1e6", "output.every=0.5"])
    for stop in (1, 9):
        whole, part = tmp_path / f"whole {stop}.vtkhdf", tmp_path / f"part {stop}.vtkhdf"
        case.run(output=whole)
        stopped = case.run(output=part, progress=pressed_at(stop))
        assert clast.resume(stopped.checkpoint).report.finished
        assert differences(whole, part) == []
        kept = clast.read(part).lining("shell")
        assert kept.moment == pytest.approx(clast.read(whole).lining("shell").moment, abs=0.0)


@pytest.mark.parametrize("turned", [0.0, 27.0])
def test_a_lining_there_from_the_start_bears_its_share_of_the_stress_in_situ(turned: float):
    angle = np.radians(turned)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    builder = ModelBuilder(
        title="tunnel", gravity=(0.0, 0.0), in_situ={"stress": [-2e6, -2e6, 0.0]}
    )
    builder.add_rock("stone", young=2e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=35.0)
    builder.add_joint("bond", friction_angle=35.0, cohesion=1e6, tensile_strength=1e6)
    around = [(1, -1), (1, 1), (-1, 1), (-1, -1)]
    ring, far, out = (k * np.array(around, float) @ turn.T for k in (1.0, 3.0, 4.5))
    for k in range(4):
        j = (k + 1) % 4
        builder.block(name=f"rock {k}", vertices=[ring[k], far[k], far[j], ring[j]])
        builder.block(name=f"far {k}", vertices=[far[k], out[k], out[j], far[j]], fixed=True)
    line = [tuple(one) for one in ring[[0, 1, 2, 3, 0]]]
    builder.lining("shell", polyline=line, side="left", joint="bond", **LONGER)
    run = clast.simulate(builder.build(), end=0.3, **STEPS)
    shell = run.lining("shell")
    assert (shell.normal_force[-1] < 0.0).all() and shell.normal_force[-1].min() < -1e5
    # nothing moves that is in balance
    assert np.abs(run.state.vertices - run.model.vertices).max() < 1e-6
    assert shell.normal_force[-1] == pytest.approx(shell.normal_force[0], rel=1e-3)
    # all four sides are alike
    n = shell.normal_force[-1]
    assert n == pytest.approx(np.roll(n, len(n) // 4), rel=1e-3)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "crossing": ({"polyline": [(0.0, -2.0), (0.0, 2.0)], "stage": "line"}, "crosses lining"),
    "itself": (
        {"polyline": [(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (5.0, 6.0), (5.0, 3.5)]},
        "crosses itself",
    ),
    "name": ({"opening": "hole", "stage": "line", "name": "shell"}, "two linings with that name"),
    "part": (
        {"opening": "hole", "stage": "line", "part": [(9.0, 9.0), (1.0, 1.0)]},
        "from the outline",
    ),
    "alone": ({"polyline": [(8.0, 8.0), (8.2, 8.0)]}, "a single segment without supports"),
}


@pytest.mark.parametrize("kind", sorted(REFUSED))
def test_linings_that_cannot_be_placed_are_refused(kind: str):
    keys, what = REFUSED[kind]
    builder = tunnel()
    builder.lining(**{"name": "other", **LONGER, **keys})
    with pytest.raises(CaseError, match=what):
        builder.build()


def test_a_lining_before_its_excavation_is_refused():
    model = tunnel("dig").build()
    late = (clast.Stage(name="wait", until="time", time=0.2), *STAGES)
    clast.simulate(model, end=0.1, stages=late[:2], **STEPS)
    with pytest.raises(CaseError, match="not been excavated by stage 'wait'"):
        clast.simulate(tunnel("wait").build(), end=0.1, stages=late, **STEPS)


@pytest.mark.parametrize("away", [0.0, 0.02])
def test_a_lining_to_be_bonded_where_there_is_no_rock_is_warned_of(away: float):
    builder = ModelBuilder(title="wall", gravity=(0.0, 0.0))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint("bond", friction_angle=35.0, cohesion=1e6, tensile_strength=1e6)
    builder.block(name="wall", vertices=[(0, -1), (2, -1), (2, 0), (0, 0)], fixed=True)
    line = [(2.0, away), (0.0, away)]
    builder.lining("plate", polyline=line[::-1], side="left", joint="bond", **CONCRETE)
    said = [
        one for one in clast.simulate(builder.build(), **STATIC).report.warnings if "Lining" in one
    ]
    if away:
        assert len(said) == 1
        assert "no rock beside 20 of its 20 segments ('plate/1', 'plate/2'" in said[0]
    else:
        assert said == []


@pytest.mark.parametrize("process", ["convex", "modified", "open-close"])
def test_a_lining_of_a_later_stage_changes_nothing_before(process: str):
    """Contacts are as stiff as the ground makes them, not as the stiffer lining would."""
    sunk = []
    for young in (None, 2e9, 2e11):
        builder = ModelBuilder(title="pad")
        builder.add_rock("soil", young=1e9, poisson=0.0, density=2500.0)
        builder.add_joint("default", friction_angle=35.0)
        builder.block(name="base", vertices=[(0, -1), (2, -1), (2, 0), (0, 0)], fixed=True)
        builder.block(name="pad", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
        builder.measured_point("top", (1.0, 1.0), "pad")
        if young is not None:
            line = [(2.0, 1.0), (0.0, 1.0)]
            given = {**CONCRETE, "young": young, "segment": 0.4, "stage": "sprayed"}
            builder.lining("plate", polyline=line, side="right", **given)
        stages = [clast.Stage(name=name, dynamic_ratio=0.0) for name in ("settled", "sprayed")]
        given = {"step": 1e-3, "end": 0.2, "process": process, "stages": stages}
        run = clast.simulate(builder.build(), **given)
        rows = run.history("top")
        sunk.append(rows.displacement[rows.time <= run.stages[0].end][-1, 1])
    assert sunk[0] < 0.0
    assert sunk[1:] == pytest.approx(sunk[:1] * 2, rel=1e-6)


@pytest.mark.parametrize("gap", [0.0, 1e-3])
def test_a_sprayed_lining_is_bonded_where_it_is_flush_and_not_at_its_end(gap: float):
    """On a wall that hangs over a floor: the foot of the lining is that far above the floor."""
    builder = ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0, cohesion=2e5, tensile_strength=2e5)
    builder.add_joint("bond", friction_angle=30.0, cohesion=5e5, tensile_strength=5e5)
    builder.block(name="floor", vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    wall = [(-1.0, gap), (0.0, gap), (0.0, 2.0), (-1.0, 2.0)]
    builder.block(name="wall", vertices=wall, fixed=True)
    builder.block(name="stone", vertices=[(1.5, 0), (2.5, 0), (2.5, 1), (1.5, 1)])
    line = [(0.0, 2.0), (0.0, gap)]
    keys = {**CONCRETE, "segment": 0.5, "joint": "bond", "stage": "spray"}
    builder.lining("shotcrete", polyline=line, side="left", **keys)
    stages = tuple(clast.Stage(name=name, dynamic_ratio=0.0) for name in ("rest", "spray"))
    run = builder.case(stages=stages, step=1e-2, end=1.0, critdis=0.004).run(progress=False)
    assert [one.outcome for one in run.report.stages] == ["equilibrium"] * 2
    model, memory = run.model, run.final.memory
    own = model.vertex_block[memory.vertex]
    names = np.array(model.block_name)
    sprayed = np.char.startswith(names, "shotcrete/")
    for of, bonded in (("wall", True), ("floor", gap == 0.0)):
        at = names == of
        pair = (sprayed[own] & at[memory.block]) | (at[own] & sprayed[memory.block])
        assert (
            (memory.bonded[pair].all() and pair.any()) if bonded else not memory.bonded[pair].any()
        )


@pytest.mark.parametrize(("key", "value"), [("young", 20.0), ("compression", 20.0)])
def test_other_units_than_those_of_the_rock_are_refused(key: str, value: float):
    with pytest.raises(ModelError, match=f"{key}: 20 looks like another unit"):
        beam(**{**({"tension": 1.0} if key == "compression" else {}), key: value}).build()
