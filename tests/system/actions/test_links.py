"""Links in whole runs: hinges, springs that yield and break, play, dashpots, restarts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import ModelBuilder
from clast.errors import ModelError
from scenes.restarts import differences, pressed_at
from scenes.systems import turned


def scene(gravity: tuple[float, float] = (0.0, -9.8)) -> ModelBuilder:
    """Return a fixed block and a cube of 2500 kg beside it, which touch nothing."""
    builder = ModelBuilder(title="links", gravity=gravity)
    builder.add_rock("stone", young=1e11, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=0.0)
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


def test_a_run_with_links_goes_on_to_the_bit(tmp_path: Path):
    text = pendulum().to_toml(step=2e-3, end=0.3, every=0.05, max_displacement=0.05)
    case = clast.Case.from_toml(text, ["output.checkpoint_every=1e6"])
    whole, part = tmp_path / "whole.vtkhdf", tmp_path / "part.vtkhdf"
    case.run(output=whole)
    stopped = case.run(output=part, progress=pressed_at(70))
    assert clast.resume(stopped.checkpoint).report.finished
    assert differences(whole, part) == []
    assert clast.read_results(whole).link_name == ("link 1", "link 2")


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
