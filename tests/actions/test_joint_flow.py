"""Pressures of water that flows in joints, as forces on blocks."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.actions.flow import JointWater, pressed_channels, pressed_faces, water_at
from clast.actions.water import pressed_by, sums_on_blocks
from clast.block import polygon
from clast.model.model import Floats, Model
from scenes import wet_rock

SETS = ((33.0, 1.1), (100.0, 0.9))
HEADS = """
[flow]
[[flow_boundary]]
name = "left"
where = {{side = "left"}}
head = {0}
[[flow_boundary]]
name = "right"
where = {{side = "right"}}
head = {1}
"""


def forces(model: Model, pressed: object) -> Floats:
    centroid = polygon.moments(model.vertices, model.block_start)[1]
    block, force = sums_on_blocks([pressed], centroid)
    whole = np.zeros((model.block_count, 6))
    whole[block] = force
    return whole


@pytest.mark.parametrize(
    "flow",
    [
        HEADS.format(7.3, 7.3),
        HEADS.format(7.3, 7.3).replace("[flow]", "[flow]\nlongest = 0.25"),
        '[flow]\nstate = "hydrostatic"\nlevel = 7.3\n',
    ],
    ids=["found", "in pieces", "given"],
)
def test_water_at_rest_presses_as_water_under_a_level(flow):
    wet = wet_rock.cut(10.0, *SETS, more=flow)
    level = wet_rock.cut(10.0, *SETS, more='[[water]]\nlevel = 7.3\nacts_on = "joints"\n')
    water = water_at(wet, 0.0)
    assert np.abs(water.solved.flow).max() < 1e-12 * (water.conductance * 7.3e4).max()
    known = forces(level, pressed_by(level.water[0], level, level.vertices, 0.0))
    found = forces(wet, pressed_channels(water, wet, wet.vertices))
    assert np.abs(found - known).max() < 1e-9 * np.abs(known).max()


def test_heads_press_on_the_faces_below_them():
    wet = wet_rock.cut(10.0, *SETS, more=HEADS.format(7.3, 4.0))
    found = forces(wet, pressed_faces(water_at(wet, 0.0), wet, wet.vertices, 0.0)).sum(axis=0)
    assert found[0] == pytest.approx(0.5 * 9810.0 * (7.3**2 - 4.0**2), rel=1e-12)
    assert found[1] == pytest.approx(0.0, abs=1e-6)


def test_water_flows_from_the_higher_to_the_lower_head_and_none_is_lost():
    wet = wet_rock.cut(10.0, *SETS, more=HEADS.format(7.3, 4.0))
    water = water_at(wet, 0.0)
    part = water.conditions.part
    given = [water.solved.given[part == k].sum() for k in (0, 1)]
    seeps = water.solved.outflow
    assert given[0] > 0.0 > given[1]
    assert sum(given) == pytest.approx(seeps.sum(), abs=1e-12 * given[0])
    assert abs(water.solved.unaccounted) < 1e-12 * water.solved.throughput
    assert water.solved.pressure.min() >= 0.0
    heads = water.solved.pressure / 9810.0 + water.network.at[:, 1] + wet.origin[1]
    assert heads[water.solved.pressure > 0.0].max() <= 7.3 * (1.0 + 1e-9)


def test_a_column_under_flow_stands_as_high_as_its_pressure_says():
    """An upright joint with water running into it from a level one: its wet part by hand."""
    corners = {"a": [(0, -1), (3, -1), (3, 0), (0, 0)], "b": [(0, 0), (1, 0), (1, 5), (0, 5)]}
    corners["c"] = [(1, 0), (3, 0), (3, 5), (1, 5)]
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, aperture=2e-4)
    for name, one in corners.items():
        builder.block(name=name, vertices=one)
    builder.flow = {}
    builder.flow_boundary("left", edges=[[(0, -1), (0, 5)]], head=3.0)
    builder.flow_boundary("right", edges=[[(3, -1), (3, 5)]], head=1.0)
    model = builder.build()
    water = water_at(model, 0.0)
    pressed = pressed_channels(water, model, model.vertices)
    upright = np.flatnonzero((pressed.block == 1) | (pressed.other == 1))
    (column,) = [k for k in upright if np.ptp(pressed.ends[k, :, 0]) < 1e-9]
    # the level joint falls evenly from 3 to 1 m over 3 m: at 1 m the column stands, no flow
    top = pressed.ends[column, :, 1].max() + model.origin[1]
    assert top == pytest.approx(3.0 - 2.0 / 3.0, rel=1e-9)
    assert pressed.pressure[column].max() == pytest.approx(9810.0 * top, rel=1e-9)


def test_a_column_that_water_runs_into_is_higher_by_what_the_flow_takes():
    """Rain of half the capacity above 2 m of head: p = (rho g - q/(C dy)) h in the column."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, aperture=2e-4)
    builder.block(vertices=[(0, 0), (2, 0), (2, 5), (0, 5)])
    builder.block(vertices=[(2, 0), (4, 0), (4, 5), (2, 5)])
    builder.flow = {}
    capacity = 9810.0 * 2e-4**3 / 12e-3
    builder.flow_boundary("rain", side="top", rain=0.5 * capacity / 4.0)
    builder.flow_boundary("head", side="bottom", head=2.0)
    model = builder.build()
    water = water_at(model, 0.0)
    pressed = pressed_channels(water, model, model.vertices)
    assert np.abs(water.solved.flow) == pytest.approx(0.5 * capacity, rel=1e-9)
    assert np.ptp(pressed.ends[0, :, 1]) == pytest.approx(2.0 / (1.0 - 0.5), rel=1e-9)
    assert pressed.pressure.max() == pytest.approx(9810.0 * 2.0, rel=1e-9)


def test_a_case_without_a_flow_has_no_such_action():
    dry = wet_rock.cut(4.0, *SETS)
    assert dry.flow is None
    run = clast.simulate(dry, end=2e-2, step=1e-2)
    assert not any(isinstance(one, JointWater) for one in run.state.actions)
