"""Bolts against closed forms: stretch, yield, rupture, pretension, rotation, late installation."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import clast
from clast.actions.bolts import (
    Bolting,
    BoltStates,
    lengths,
    ruptured,
    stretched,
    taken_up,
)
from scenes.ledgers import assert_closed

STIFFNESS = 2e6  # N/m per m
MASS = 2500.0
PROCESSES = [("modified", 2e7), ("open-close", 2e7), ("convex", 1e9)]
LAWS = ["penalty", "augmented-lagrangian"]

every_process = pytest.mark.parametrize(("process", "stiffness"), PROCESSES)


def hung(gravity: float = -10.0, speed: float = 0.0, **kind: Any) -> clast.ModelBuilder:
    """A square below a beam, not touching it: bolt "b" of 1 m from its middle up to the beam."""
    builder = clast.ModelBuilder(gravity=(0.0, gravity))
    builder.add_rock("rock", young=1e12, poisson=0.2, density=MASS)
    builder.block(vertices=[(-2, 1), (2, 1), (2, 2), (-2, 2)], name="beam", fixed=True)
    box = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    builder.block(vertices=box, name="box", velocity=(0.0, -speed, 0.0))
    builder.add_bolt_kind("bar", **{"stiffness": STIFFNESS, **kind})
    return builder


def with_bolt(builder: clast.ModelBuilder, **choices: Any) -> clast.ModelBuilder:
    builder.bolt((0, 0), (0, 1), kind="bar", name="b", **choices)
    return builder


def states_of(run: clast.Run) -> BoltStates:
    (own,) = [one for one in run.final.actions if isinstance(one, BoltStates)]
    return own


def height(run: clast.Run) -> float:
    """How far the box has moved up, m."""
    return float(run.final.vertices[4:, 1].mean())


def law(name: str, stiffness: float) -> dict[str, Any]:
    return {"name": name, "normal_stiffness": stiffness}


@pytest.mark.parametrize("law_name", LAWS)
@every_process
def test_a_weight_hangs_on_it(process: str, stiffness: float, law_name: str):
    """At rest the box has sunk by W/s, and the bolt bears W."""
    run = clast.simulate(
        with_bolt(hung()),
        end=2.0,
        step=0.1,
        dynamic_ratio=0.0,
        process=process,
        contact_law=law(law_name, stiffness),
    )
    weight = 10.0 * MASS
    assert -height(run) == pytest.approx(weight / STIFFNESS, rel=1e-6)
    assert states_of(run).force[0] == pytest.approx(weight, rel=1e-6)
    assert run.report.ledger.bolts == pytest.approx(0.5 * weight**2 / STIFFNESS, rel=1e-6)
    assert_closed(run)


@pytest.mark.slow
@every_process
@pytest.mark.one_in(3)
def test_it_swings_and_the_energy_is_explained(process: str, stiffness: float):
    """A box that falls into its bolt sinks to 2 W/s and comes back: x = W/s (1 - cos w t)."""
    run = clast.simulate(
        with_bolt(hung()),
        end=0.1,
        step=1e-4,
        process=process,
        contact_law=law("penalty", stiffness),
    )
    rate = np.sqrt(STIFFNESS / MASS)
    time = 0.1
    sag = 10.0 * MASS / STIFFNESS * (1.0 - np.cos(rate * time))
    # forces as they are at the end of a step damp by w^2 h t/4
    assert -height(run) == pytest.approx(sag, abs=2.0 * rate**2 * 1e-4 * time / 4.0 * 0.0125)
    assert_closed(run)


@pytest.mark.slow
@every_process
@pytest.mark.one_in(3)
def test_it_breaks_for_good_and_the_box_flies_free(process: str, stiffness: float):
    """Thrown faster than its energy at rupture bears, it goes on with what is left of it."""
    rupture, speed = 0.01, 0.5
    builder = with_bolt(hung(gravity=0.0, speed=speed, rupture_elongation=rupture))
    run = clast.simulate(
        builder, end=0.05, step=2e-5, process=process, contact_law=law("penalty", stiffness)
    )
    own, energy = states_of(run), run.energy
    broken = energy["time"] >= own.broken_at[0]
    assert own.broken_at[0] < 0.03
    assert own.force[0] == 0.0 and run.report.ledger.bolts == 0.0
    assert run.report.ledger.yielding == pytest.approx(0.5 * STIFFNESS * rupture**2, rel=2e-3)
    kinetic = energy["kinetic"][broken]
    assert kinetic[-1] == pytest.approx(kinetic[0], rel=1e-6)
    left = 0.5 * MASS * speed**2 - 0.5 * STIFFNESS * rupture**2
    assert kinetic[-1] == pytest.approx(left, rel=5e-3)
    assert_closed(run)


@every_process
def test_initial_pretension_changes_with_movement(process: str, stiffness: float):
    """With T0 = W nothing moves; with another T0 the bolt bears W in the end, T0 no more."""
    weight = 10.0 * MASS
    for tension in (weight, 0.4 * weight):
        run = clast.simulate(
            with_bolt(hung(pretension=tension)),
            end=2.0,
            step=0.1,
            dynamic_ratio=0.0,
            process=process,
            contact_law=law("penalty", stiffness),
        )
        assert -height(run) == pytest.approx((weight - tension) / STIFFNESS, abs=1e-9)
        assert states_of(run).force[0] == pytest.approx(weight, rel=1e-6)
        assert_closed(run)


@pytest.mark.slow
@every_process
def test_a_jack_holds_the_force_until_it_is_locked(process: str, stiffness: float):
    """Under T0 > W the box rises with (T0 - W)/m; locked, the bolt goes on from T0."""
    weight = 10.0 * MASS
    tension, end, step = 1.2 * weight, 0.05, 1e-4
    builder = with_bolt(hung(pretension=tension), pretension_is="jacked")
    run = clast.simulate(
        builder, end=end, step=step, process=process, contact_law=law("penalty", stiffness)
    )
    assert height(run) == pytest.approx(0.5 * 2.0 * end**2, rel=1e-6)
    assert states_of(run).force[0] == tension
    done = tension * height(run) + 0.5 * tension**2 / STIFFNESS
    assert run.report.ledger.loads == pytest.approx(done, rel=1e-9)
    assert_closed(run)


@pytest.mark.slow
@every_process
@pytest.mark.one_in(3)
def test_turning_about_each_other(process: str, stiffness: float):
    """Two boxes on a bolt go round: its force is that of the centripetal acceleration m w^2 r."""
    rate, radius, stiff = 5.0, 1.0, 2e7
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e12, poisson=0.2, density=MASS)
    stretched = MASS * rate**2 * radius / stiff
    for side in (-1.0, 1.0):
        corners = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)]
        builder.block(
            vertices=[(side * radius + x, y) for x, y in corners],
            name="left" if side < 0 else "right",
            velocity=(0.0, side * rate * radius, rate),
        )
    mass = MASS * 0.36
    tension = mass * rate**2 * radius
    builder.add_bolt_kind("bar", stiffness=stiff, pretension=tension)
    builder.bolt((-radius, 0), (radius, 0), kind="bar")
    run = clast.simulate(
        builder,
        end=0.6,
        step=2e-4,
        max_displacement=0.02,
        process=process,
        contact_law=law("penalty", stiffness),
    )
    ends = run.final.vertices.reshape(2, 4, 2).mean(axis=1)
    way = ends[1] - ends[0]
    turned = np.arctan2(way[1], way[0])
    assert turned == pytest.approx(rate * 0.6, rel=2e-3)  # 172 degrees
    assert np.hypot(*way) == pytest.approx(2.0 * radius, abs=1e-3 * stretched + 1e-5)
    assert states_of(run).force[0] == pytest.approx(tension, rel=5e-3)
    assert np.abs(run.final.velocity[:, :2].sum(axis=0)).max() < 1e-6  # momentum
    assert_closed(run)


def settled(builder: clast.ModelBuilder, installed: bool) -> clast.Run:
    model = builder.build()
    model = replace(model, bolts=replace(model.bolts, installed=np.array([installed])))
    return clast.simulate(model, end=1.0, step=1e-2, dynamic_ratio=0.0)


@pytest.mark.slow
def test_installed_after_settling_it_carries_nothing():
    """Before the bolt is there the box comes to rest on a floor; then nothing moves any more."""
    builder = with_bolt(hung())
    builder.block(vertices=[(-2, -2), (2, -2), (2, -0.5), (-2, -0.5)], name="floor", fixed=True)
    model = builder.build()
    waiting = replace(model, bolts=replace(model.bolts, installed=np.array([False])))
    before = settled(builder, installed=False)
    own = states_of(before)
    assert np.isnan(own.rest).all() and own.force[0] == 0.0
    points = before.state.points[waiting.point_slices.bolts]
    length = lengths(model, points)
    begun = taken_up(model, own, length)
    assert stretched(model.bolts, begun, length, 0.0).force[0] == 0.0
    # installed before, it bears its share of the weight: as springs side by side do
    early = states_of(settled(builder, installed=True))
    assert early.force[0] > 0.0


def test_a_jacked_bolt_goes_on_from_its_force_when_locked():
    """Locked at any length it has T0 there, and s more by metre from then on."""
    model = with_bolt(hung(pretension=3e4), pretension_is="jacked").build()
    bolts, own = model.bolts, Bolting().begin(model)
    own = stretched(bolts, taken_up(model, own, np.array([1.0])), np.array([0.9]), 0.1)
    assert own.force[0] == 3e4 and not own.locked[0]
    model = replace(model, bolts=bolts.locked_by_now())
    own = taken_up(model, own, np.array([0.9]))
    assert own.locked[0]
    own = stretched(model.bolts, own, np.array([0.901]), 0.2)
    assert own.force[0] == pytest.approx(3e4 + 1e-3 * STIFFNESS)


@every_process
def test_a_grouted_bolt_resists_where_joints_open(process: str, stiffness: float):
    """Three boxes without friction in a row are pulled apart: each joint opens by F/s."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e12, poisson=0.2, density=MASS)
    for k in range(3):
        corners = [(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]
        builder.block(vertices=corners, name=f"{k}", fixed=k == 0)
    builder.add_bolt_kind("bar", young=2e11, area=5e-4, out_of_plane_spacing=2.0)
    builder.bolt((0.1, 0.5), (2.9, 0.5), kind="bar", anchorage="grouted", free_length=0.25)
    pull = 1e5
    builder.point_load((2.5, 0.5), (pull, 0.0))
    run = clast.simulate(
        builder,
        end=2.0,
        step=0.1,
        dynamic_ratio=0.0,
        process=process,
        contact_law=law("penalty", stiffness),
    )
    own = states_of(run)
    axial = 2e11 * 5e-4 / 2.0 / 0.5  # E A/(L a), free for 0.25 m on both sides
    np.testing.assert_allclose(own.force, pull, rtol=1e-6)
    moved = (run.final.vertices - run.model.vertices)[:, 0].reshape(3, 4).mean(axis=1)
    np.testing.assert_allclose(moved, [0.0, pull / axial, 2 * pull / axial], rtol=1e-4, atol=1e-12)
    assert_closed(run)


@every_process
def test_a_cable_bears_no_compression_a_bar_does(process: str, stiffness: float):
    """A box pushed up slackens a cable; a bar holds it at F/s."""
    for compression, force, way in ((False, 0.0, None), (True, -2e4, 2e4 / STIFFNESS)):
        builder = with_bolt(hung(gravity=0.0, compression=compression))
        builder.point_load((0, 0), (0.0, 2e4), block="box")
        run = clast.simulate(
            builder,
            end=0.02 if way is None else 2.0,
            step=1e-3 if way is None else 0.1,
            dynamic_ratio=float(way is None),
            process=process,
            contact_law=law("penalty", stiffness),
        )
        assert states_of(run).force[0] == pytest.approx(force, abs=1e-2)
        expected = 0.5 * 2e4 / MASS * 0.02**2 if way is None else way
        assert height(run) == pytest.approx(expected, rel=1e-4)  # the first step holds the cable
        assert_closed(run)


# --- the force by the length: elastic, yielding, unloading, broken

STRENGTH, PRETENSION = 3e4, 5e3


def bar(**kind: Any) -> Any:
    """Return the model of the box on a bar that yields."""
    given = {"yield_force": STRENGTH, "pretension": PRETENSION, **kind}
    return with_bolt(hung(**given)).build()


def forces(model: Any, *stretches: float) -> list[float]:
    """Return the forces, N/m, of the bolt at one stretch, m, after the other."""
    own = Bolting().begin(model)
    found = []
    for stretch in stretches:
        own = stretched(model.bolts, own, np.array([1.0 + stretch]), 0.0)
        own = ruptured(model.bolts, own, 0.0)
        found.append(float(own.force[0]))
    return found


def test_it_is_elastic_below_its_yield_force():
    expected = [PRETENSION + STIFFNESS * x for x in (0.0, 0.005, 0.01, 0.002)]
    assert forces(bar(), 0.0, 0.005, 0.01, 0.002) == pytest.approx(expected)


def test_it_yields_and_unloads_along_the_elastic_line():
    """Yields at 0.0125 m; stretched to 0.02 m it keeps 0.0075 m."""
    found = forces(bar(), 0.01, 0.02, 0.015, 0.02, 0.025, 0.02)
    lasting = 0.0075
    expected = [
        PRETENSION + STIFFNESS * 0.01,
        STRENGTH,
        PRETENSION + STIFFNESS * (0.015 - lasting),
        STRENGTH,
        STRENGTH,
        PRETENSION + STIFFNESS * (0.02 - lasting - 0.005),
    ]
    assert found == pytest.approx(expected)


def test_it_goes_slack_and_bears_again():
    assert forces(bar(), -0.01, 0.0) == pytest.approx([0.0, PRETENSION])


def test_broken_it_bears_nothing_for_good():
    assert forces(bar(rupture_elongation=0.03), 0.02, 0.05, 0.0)[1:] == [0.0, 0.0]
