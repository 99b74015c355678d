"""Flow in joints through whole cases: moved, mirrored, turned, renumbered, in one long step."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.actions.flow import JointWater, water_at
from scenes import wet_rock
from scenes.wet_rock import polygons_of

SETS = ((33.0, 1.1), (100.0, 0.9))
SIZE, HIGH, LOW = 10.0, 7.3, 4.0
CORNERS = np.array([[0.0, 0.0], [SIZE, 0.0], [SIZE, SIZE], [0.0, SIZE]])


def built(polygons, *, at=(0.0, 0.0), turned=0.0, mirrored=False, head=True, **flow) -> clast.Model:
    """Return blocks moved, turned by degrees or mirrored, between two heads or pressures."""
    c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    turn = np.array([[c, s], [-s, c]])
    if mirrored:
        turn = np.diag([-1.0, 1.0])
    builder = clast.ModelBuilder(gravity=(0.0, -9.81 if head else 0.0))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, aperture=2e-4)
    for one in polygons:
        outline = (one @ turn + at)[:: -1 if mirrored else 1]
        builder.block(vertices=outline.tolist())
    builder.flow = flow
    for name, side, level in (("upper", (3, 0), HIGH), ("lower", (1, 2), LOW)):
        line = [(CORNERS[list(side)] @ turn + at).tolist()]
        given = {"head": level + at[1]} if head else {"pressure": 9810.0 * level}
        builder.flow_boundary(name, edges=line, **given)
    return builder.build()


def inflow(water: JointWater) -> float:
    return float(water.exchange[0, 0])


@pytest.fixture(scope="module")
def polygons():
    rock = wet_rock.cut(SIZE, *SETS)
    return polygons_of(rock)


@pytest.mark.parametrize(
    ("same", "given"),
    [
        (1e-6, {"at": (5e6, 2e5)}),
        (1e-9, {"mirrored": True}),
    ],
    ids=["moved by 5,000 km", "mirrored"],
)
def test_flow_with_a_free_surface_is_the_same(polygons, same, given):
    first = water_at(built(polygons), 0.0)
    other = water_at(built(polygons, **given), 0.0)
    assert len(other.conductance) == len(first.conductance)
    assert inflow(other) == pytest.approx(inflow(first), rel=same)
    pressure = np.sort(first.solved.pressure), np.sort(other.solved.pressure)
    assert pressure[1] == pytest.approx(pressure[0], abs=same * 9810.0 * HIGH)


def test_renumbered_blocks_have_the_same_flow(polygons):
    order = np.random.default_rng(5).permutation(len(polygons))
    first = inflow(water_at(built(polygons), 0.0))
    other = inflow(water_at(built([polygons[k] for k in order]), 0.0))
    assert other == pytest.approx(first, rel=1e-12)


def test_confined_flow_turns_with_its_rock(polygons):
    first = water_at(built(polygons, head=False), 0.0)
    for angle in (30.0, 90.0, 217.0):
        other = water_at(built(polygons, head=False, turned=angle), 0.0)
        assert inflow(other) == pytest.approx(inflow(first), rel=1e-12)


@pytest.mark.parametrize("start", ["dry", "steady"])
def test_a_step_of_1e12_s_is_steady_flow(polygons, start):
    known = water_at(built(polygons), 0.0)
    model = built(polygons, state="transient", initial=start)
    found = water_at(model, 1e12, water_at(model, 0.0))
    assert inflow(found) == pytest.approx(inflow(known), rel=1e-9)
    assert found.solved.pressure == pytest.approx(known.solved.pressure, abs=1e-6 * 9810.0 * HIGH)
