"""Links in whole runs: hinges, springs that yield and break, play, dashpots, restarts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import ModelBuilder
from clast.errors import ModelError
from clast.model.ground_motion import Accelerogram
from scenes.systems import turned


def nothing(gravity: tuple[float, float]) -> ModelBuilder:
    """Return a builder with a rock of 2500 kg/m3 and without blocks."""
    builder = ModelBuilder(title="links", gravity=gravity)
    builder.add_rock("stone", young=1e11, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=0.0)
    return builder


def scene(gravity: tuple[float, float] = (0.0, -9.8)) -> ModelBuilder:
    """Return a fixed block and a cube of 2500 kg beside it, which touch nothing."""
    builder = nothing(gravity)
    builder.block(name="base", vertices=[(5, 0), (6, 0), (6, 1), (5, 1)], fixed=True)
    builder.block(name="cube", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return builder


STATIC: dict[str, Any] = {"step": 0.05, "end": 2.0, "dynamic_ratio": 0.0}
WEIGHT = 2500.0 * 9.8


@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize("process", ["convex", "open-close"])
def test_a_block_hangs_on_a_spring(process: str, angle: float):
    builder = scene()
    way = (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
    builder.link((0.5, 0.5), block="cube", direction=way, x=1e6, y=1e6, rotation=1e6, name="hang")
    run = clast.simulate(builder.build(), process=process, **STATIC)
    moved = run.block("cube").displacement[-1]
    assert moved == pytest.approx([0.0, -WEIGHT / 1e6], abs=1e-7)
    borne = WEIGHT * np.array([way[1], way[0]])
    assert run.link("hang").force[-1] == pytest.approx(borne, rel=1e-4)
    assert run.reaction("fixed blocks").force[-1] == pytest.approx([0.0, WEIGHT], rel=1e-4, abs=1.0)


BLOCKS = {"piston": (5.0, 5.0), "floor": (-5.0, -1.0), "cube": (0.0, 0.0)}
"""Lower left corners of blocks of 1 x 1 m; all but the cube are fixed."""
GROUNDS: dict[str, dict[str, Any]] = {
    "other order": {"order": ("cube", "floor", "piston")},
    "no fixed block": {"order": ("cube",)},
    "a fixed block moves": {"moves": "piston"},
    "the only fixed block moves": {"order": ("piston", "cube"), "moves": "piston"},
    "a fixed block is excavated": {"digs": "piston"},
    "the only fixed block is excavated": {"order": ("piston", "cube"), "digs": "piston"},
}


def hung(
    ratio: float, order: tuple[str, ...] = tuple(BLOCKS), moves: str = "", digs: str = ""
) -> Any:
    """Return the run of a cube on springs to the ground, beside blocks that have no part in it."""
    builder = nothing((0.0, -10.0))
    for name in order:
        (x, y), fixed = BLOCKS[name], name != "cube"
        corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        builder.block(name=name, vertices=corners, fixed=fixed)
    builder.link((0.2, 0.7), block="cube", x=1e6, y=2e6, rotation=3e6, name="hang")
    if moves:
        builder.motion(block=moves, x=0.1, y=0.05, rotation=20.0)
    builder.measured_point("middle", (0.5, 0.5), block="cube")
    parts: dict[str, Any] = {"end": 0.4, "dynamic_ratio": ratio}
    if digs:
        each = {"time": 0.2, "until": "time", "dynamic_ratio": ratio}
        stages = [clast.Stage(name="a", **each), clast.Stage(name="b", excavate=(digs,), **each)]
        parts = {"stages": stages}
    return clast.simulate(builder.build(), step=0.01, max_displacement=0.5, **parts)


@pytest.mark.parametrize("ratio", [0.0, 1.0])
@pytest.mark.parametrize("other", GROUNDS)
@pytest.mark.one_in(3)
def test_the_ground_is_no_block(other: str, ratio: float):
    usual, same = hung(ratio), hung(ratio, **GROUNDS[other])
    before, after = usual.history("middle"), same.history("middle")
    assert after.displacement[-1] == pytest.approx(before.displacement[-1], abs=1e-9)
    assert after.rotation[-1] == pytest.approx(before.rotation[-1], abs=1e-9)
    forces = [run.reaction("fixed blocks").force[-1] for run in (usual, same)]
    assert forces[1] == pytest.approx(forces[0], abs=1e-6 * 2e4)
    assert abs(same.state.ledger.unaccounted) < 1e-6


def test_a_lining_is_clamped_to_a_ground_that_is_no_block():
    def bent(fixed: tuple[float, ...], moves: bool = False) -> float:
        builder = nothing((0.0, -9.8))
        for k, x in enumerate(fixed):
            corners = [(x, 3), (x + 1, 3), (x + 1, 4), (x, 4)]
            builder.block(name=f"{k}", vertices=corners, fixed=True)
        if not fixed:
            builder.block(name="pinned", vertices=[(5, 3), (6, 3), (6, 4), (5, 4)])
            builder.fixed_point((5.0, 3.0))
            builder.fixed_point((6.0, 3.0))
        concrete = {"thickness": 0.1, "segment": 0.1, "young": 2e10, "density": 2400.0}
        line = {"polyline": [(0.0, 0.0), (1.0, 0.0)], "side": "middle", "start": "clamped"}
        builder.lining("beam", **line, **concrete)
        if moves:
            builder.motion(block="0", x=0.05)
        run = clast.simulate(builder.build(), step=0.05, end=0.5, dynamic_ratio=0.0)
        return float(run.block("beam/10").displacement[-1][1])

    # w L^4/8 E I of a cantilever, at the middle of its last segment
    assert bent(()) == pytest.approx(-2400 * 0.1 * 9.8 / (8.0 * 2e10 * 1e-3 / 12.0), rel=0.15)
    assert bent((5.0,), moves=True) == pytest.approx(bent(()), rel=1e-6)
    assert bent((-9.0, 5.0), moves=True) == pytest.approx(bent(()), rel=1e-6)


def test_a_roller_on_the_ground_stays_as_it_is():
    builder = scene((0.0, 0.0))
    way = np.array([np.cos(0.3), np.sin(0.3)])
    builder.link((0.2, 0.3), block="cube", direction=tuple(way), x="rigid", name="roller")
    builder.motion(block="cube", y=0.4, rotation=60.0)
    builder.measured_point("axle", (0.2, 0.3), block="cube")
    run = clast.simulate(builder.build(), step=0.01, end=1.0, max_displacement=1.0)
    moved = run.history("axle").displacement
    assert abs(moved[-1] @ np.array([-way[1], way[0]])) > 0.2
    # the first step does not know yet how fast the block turns
    assert np.abs(moved[2:] @ way).max() < 1e-7


@pytest.mark.parametrize("integrator", ["constant-acceleration", "midpoint"])
def test_the_ground_moves_with_the_base(integrator: str):
    builder = scene((0.0, 0.0))
    for axis in ("x", "y"):
        stiffness: dict[str, Any] = {axis: 2e5}
        builder.link((0.5, 0.5), block="cube", **stiffness, damping=2e3, name=axis)
    time = np.linspace(0.0, 1.0, 101)
    shaken = np.stack([2.0 * np.sin(6.0 * time), np.cos(4.0 * time)], axis=1)
    record = Accelerogram(time, shaken)
    ends = []
    for motion in (clast.MovingBase(record), clast.InertialForce(record)):
        builder.ground_motion = motion
        keys: dict[str, Any] = {"step": 2e-3, "end": 1.0, "max_displacement": 1.0}
        run = clast.simulate(builder.build(), integrator=integrator, **keys)
        ends.append(run.block("cube").displacement[-1])
        assert abs(run.state.ledger.unaccounted) < 1e-9 * abs(run.state.ledger.loads)
    # the same motion seen from where the ground began and from the ground
    assert ends[0] - record.displacement(1.0) == pytest.approx(ends[1], abs=2e-5)


@pytest.mark.parametrize("first", ["beam", "bead"])
def test_a_bead_that_has_moved_bends_the_beam_where_it_is(first: str):
    builder = nothing((0.0, -10.0))
    builder.block(name="beam", vertices=[(0, 0), (4, 0), (4, 0.1), (0, 0.1)])
    builder.block(name="bead", vertices=[(0.9, 0.1), (1.1, 0.1), (1.1, 0.3), (0.9, 0.3)])
    builder.link((0.0, 0.05), block="beam", x="rigid", y="rigid", rotation=1e9, name="clamp")
    pair = ("beam", "bead") if first == "beam" else ("bead", "beam")
    builder.link((1.0, 0.1), blocks=pair, x=1e3, y="rigid", rotation="rigid", contacts=False)
    builder.point_load((1.0, 0.2), (1.5e3, 0.0), "bead")
    keys: dict[str, Any] = {**STATIC, "end": 40.0, "max_displacement": 0.5}
    run = clast.simulate(builder.build(), **keys)
    way = run.block("bead").displacement[-1][0]
    assert way == pytest.approx(1.5, rel=1e-3)
    weights = 2500.0 * 10.0 * np.array([0.4, 0.04])
    # the load, 0.15 m above the pin, and its reaction there
    moment = weights @ [2.0, 1.0 + way] + 1.5e3 * 0.15
    assert run.link("clamp").moment[-1] == pytest.approx(moment, rel=1e-3)


def test_a_yielding_slider_keeps_angular_momentum():
    builder = nothing((0.0, 0.0))
    rod = [(-2, -0.05), (2, -0.05), (2, 0.05), (-2, 0.05)]
    builder.block(name="rod", vertices=rod, velocity=(0.0, 0.0, 2.0))
    bead = [(0.9, 0.05), (1.1, 0.05), (1.1, 0.25), (0.9, 0.25)]
    builder.block(name="bead", vertices=bead, velocity=(-0.3, 2.0, 2.0))
    keys: dict[str, Any] = {"y": 1e6, "rotation": "rigid", "yield_force": 200.0}
    builder.link((1.0, 0.05), blocks=("rod", "bead"), x=100.0, contacts=False, **keys)
    run = clast.simulate(builder.build(), step=1e-3, end=0.4, max_displacement=1.0)
    assert run.state.ledger.yielding > 1.0

    def momentum(number: int) -> float:
        velocity = run.state.velocity if number else np.array([[0, 0, 2.0], [-0.3, 2.0, 2.0]])
        corners = run.vertices(-1 if number else 0)
        total = 0.0
        for k, (mass, inertia) in enumerate(((1000.0, 16.01 / 12), (100.0, 0.08 / 12))):
            x, y = corners[4 * k : 4 * k + 4].mean(axis=0)
            u, v, spin = velocity[k, :3]
            total += mass * (x * v - y * u + inertia * spin)
        return total

    assert momentum(1) == pytest.approx(momentum(0), rel=1e-5)


def test_a_moment_turns_a_block_against_a_spring():
    builder = scene((0.0, 0.0))
    builder.link((0.2, 0.3), block="cube", x="rigid", y="rigid", rotation=1e6, name="spring")
    builder.moment("cube", 2e4)
    run = clast.simulate(builder.build(), **STATIC)
    assert run.state.rotation[1] == pytest.approx(0.02, rel=1e-4)
    assert run.link("spring").moment[-1] == pytest.approx(-2e4, rel=1e-4)
    corner, turned = run.vertices()[4], np.radians(0.0) + 0.02
    arm = np.array([-0.2, -0.3])
    rotation = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    assert corner == pytest.approx(np.array([0.2, 0.3]) + rotation @ arm, abs=1e-5)


def test_a_spring_yields_and_breaks():
    builder = scene((0.0, 0.0))
    builder.link((0.5, 0.5), block="cube", x=1e6, yield_force=1e4, rupture=0.05, name="tie")
    builder.motion(name="pull", block="cube", x=0.1, y=0.0, rotation=0.0)
    run = clast.simulate(builder.build(), step=1e-2, end=1.0)
    tie, x = run.link("tie"), 0.1 * run.link("tie").time
    exact = np.where(x > 0.05 + 1e-9, 0.0, -np.minimum(1e6 * x, 1e4))
    assert np.abs(tie.force[:, 0] - exact)[np.abs(x - 0.05) > 1e-6].max() < 1e-3
    assert tie.state[[5, 30, -1]].tolist() == [1, 2, 3]
    ledger = run.state.ledger
    # all that has come in until it breaks: elastic up to 10 mm, plastic up to 50 mm
    assert ledger.yielding == pytest.approx(0.5 * 1e4 * 0.01 + 1e4 * 0.04)
    assert ledger.links == 0.0
    assert abs(ledger.unaccounted) < 1e-6
    assert [one.kind for one in run.events] == ["yielded", "broke"]


def test_play_and_dashpot():
    builder = scene((0.0, 0.0))
    builder.link((0.5, 0.5), block="cube", x=1e6, gap=0.01, damping=1e4, name="buffer")
    builder.motion(name="pull", block="cube", x=0.1, y=0.0, rotation=0.0)
    run = clast.simulate(builder.build(), step=1e-2, end=0.5)
    buffer = run.link("buffer")
    x = 0.1 * buffer.time[1:]
    exact = -1e6 * np.maximum(x - 0.01, 0.0) - 1e4 * 0.1
    assert np.abs(buffer.force[1:, 0] - exact).max() < 1e-3
    assert run.state.ledger.damping == pytest.approx(1e4 * 0.1 * 0.05, rel=1e-9)
    assert run.state.ledger.links == pytest.approx(0.5e6 * 0.04**2, rel=1e-9)
    assert abs(run.state.ledger.unaccounted) < 1e-6


def pendulum() -> ModelBuilder:
    builder = scene()
    builder.block(name="bob", vertices=[(1, 0.4), (2, 0.4), (2, 0.6), (1, 0.6)])
    builder.link((0.0, 0.5), blocks=("cube", "base"), x="rigid", y="rigid", contacts=False)
    rotation: dict[str, Any] = {"rotation": 1e4, "yield_moment": 2e3}
    builder.link(
        (1.0, 0.5), blocks=("cube", "bob"), x="rigid", y="rigid", contacts=False, **rotation
    )
    return builder


@pytest.mark.parametrize("integrator", ["constant-acceleration", "midpoint"])
def test_hinges_keep_points_together_and_energy(integrator: str):
    run = clast.simulate(
        pendulum().build(), step=2e-3, end=0.6, integrator=integrator, max_displacement=0.05
    )
    ledger, first = run.state.ledger, run.energy
    held = ledger.kinetic + ledger.gravity + ledger.links + ledger.yielding + ledger.elastic
    assert abs(held) < 5e-4 * ledger.kinetic  # of the order (w h)^3
    assert abs(ledger.unaccounted) < 1e-6 * ledger.kinetic
    assert float(np.asarray(first.yielding)[-1]) > 0.0
    hinge = run.vertices()[[4, 7]].mean(axis=0)
    assert np.abs(hinge - [0.0, 0.5]).max() < 1e-4


def test_linked_blocks_overlap_from_the_start():
    """Two bars cross at a hinge, as scissors do: they swing as if each were alone."""
    hinge = (0.0, 0.0)
    swings = []
    for crossing in (True, False):
        builder = ModelBuilder(gravity=(0.0, -9.8))
        builder.add_rock("steel", young=2e11, poisson=0.2, density=7800.0)
        builder.block(name="support", vertices=[(-9, 4), (-8, 4), (-8, 5), (-9, 5)], fixed=True)
        bars = {"one": 0.3, "other": -0.9} if crossing else {"one": 0.3}
        for name, angle in bars.items():
            corners = np.array([(-0.2, -0.05), (1.0, -0.05), (1.0, 0.05), (-0.2, 0.05)])
            builder.block(name=name, vertices=turned(corners, angle))
            pair = (name, "support")
            builder.link(hinge, blocks=pair, x="rigid", y="rigid", contacts=False)
            builder.measured_point(name, tuple(turned(np.array([(1.0, 0.0)]), angle)[0]), name)
        if crossing:
            builder.link(hinge, blocks=("other", "one"), rotation_damping=1e-6, contacts=False)
        run = clast.simulate(builder.build(), step=1e-3, end=0.2, max_displacement=0.05)
        assert run.report.overlaps == ()
        swings.append(run.history("one").displacement[-1])
    assert swings[0] == pytest.approx(swings[1], rel=1e-6)


def test_blocks_that_overlap_without_such_a_link_are_refused():
    builder = ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("steel", young=2e11, poisson=0.2, density=7800.0)
    builder.block(name="one", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], fixed=True)
    builder.block(name="other", vertices=[(0.5, 0.5), (2, 0.5), (2, 2), (0.5, 2)])
    builder.link((0.7, 0.7), blocks=("one", "other"), x="rigid")
    with pytest.raises(ModelError, match="overlaps block 2 'other'"):
        builder.build()
