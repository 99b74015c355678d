"""Edges shorter than critdis are faces like others: kerbs hold, circles of many chords roll."""

from dataclasses import replace

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from clast.run.method_warnings import method_warnings
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.variants import CONVEX, OPEN_CLOSE

DENSITY, GRAVITY = 2500.0, 9.8
SHARE = 0.005
"""critdis by default, in units of the smallest block's size."""


def builder(friction_angle):
    """Return the builder of a scene."""
    scene = InputBuilder(title="Short edges", gravity=(0.0, -GRAVITY))
    scene.add_rock("rock", young=50e9, poisson=0.0, density=DENSITY)
    scene.add_joint(friction_angle=friction_angle)
    return scene


@pytest.mark.parametrize("variant", [CONVEX, OPEN_CLOSE], ids=lambda one: one.name)
@pytest.mark.parametrize("in_pieces", [False, True])
@pytest.mark.parametrize("height", [0.1, 0.8, 1.2, 3.0])
def test_a_kerb_of_any_height_holds_a_smooth_block(height, in_pieces, variant):
    """``height`` is in units of critdis; the block is pushed with a tenth of its weight."""
    high, push = SHARE * height, 0.1 * DENSITY * GRAVITY
    scene = builder(0.0)
    if in_pieces:
        ground = [(-2, -1), (3, -1), (3, 0), (-2, 0)]
        scene.block(name="kerb", vertices=[(1, 0), (2, 0), (2, high), (1, high)], fixed=True)
    else:
        ground = [(-2, -1), (3, -1), (3, high), (1, high), (1, 0), (-2, 0)]
    scene.block(name="ground", vertices=ground, fixed=True)
    scene.block(name="block", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    scene.point_load((0.0, 0.02), (push, 0.0), block="block")
    model = scene.build()
    method = variant.method(model, p=1e9, max_displacement=2.0 * SHARE, dynamic_ratio=0.0)
    run = simulate(model, method, Schedule(step=2e-3, end=0.5, every=0.5))
    moved = (run.state.vertices - model.vertices)[-4:, 0]
    assert np.abs(moved).max() < 1e-4 * high + 3e-6
    levels = run.state.vertices[run.state.memory.vertex, 1]
    sideways = run.state.memory.normal_force.sum() - DENSITY * GRAVITY
    assert sideways == pytest.approx(push, rel=2e-3), levels


@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e2])
@pytest.mark.parametrize("chords", [600, 1200])
def test_a_circle_of_short_chords_rolls(chords, scale):
    """Edges of 1.2 and 0.6 critdis; what a round disc covers in the same time, g by the scale."""
    tilt, radius, end = np.radians(20.0), 0.5 * scale, 0.4
    down, out = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
    scene = builder(45.0)
    plane = scale * np.array([-2.0 * down - out, 6.0 * down - out, 6.0 * down, -2.0 * down])
    scene.block(name="plane", vertices=plane, fixed=True)
    middle = radius * np.cos(np.pi / chords) * out
    turned = 2.0 * np.pi * (np.arange(chords) + 0.5) / chords - 0.5 * np.pi - tilt
    rim = middle + radius * np.stack([np.cos(turned), np.sin(turned)], axis=1)
    scene.block(name="disc", vertices=rim)
    scene.measured_point("middle", middle, block="disc")
    model = replace(scene.build(), gravity=np.array([0.0, -GRAVITY * scale]))
    critdis = SHARE * float(np.sqrt(model.area[1]))
    method = CONVEX.method(model, p=1e9 * scale**2, max_displacement=2.0 * critdis)
    run = simulate(model, method, Schedule(step=1e-3, end=end, every=end))
    way = float(np.hypot(*run.history("middle").displacement[-1]))
    rolled = 0.5 * GRAVITY * scale * np.sin(tilt) / 1.5 * end**2
    assert way == pytest.approx(rolled, rel=3e-3)


@pytest.mark.parametrize(("critdis", "warned"), [(1e-3, False), (3e-3, True)])
def test_a_critdis_that_reaches_through_slabs_is_warned_of(critdis, warned):
    """Three slabs of 4 mm: on 2 mm they rest, with 3 mm they are thrown by 18 mm."""
    scene = builder(30.0)
    scene.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    for k in range(3):
        low, high = 0.004 * k, 0.004 * (k + 1)
        scene.block(name=f"slab {k}", vertices=[(0, low), (0.5, low), (0.5, high), (0, high)])
    model = scene.build()
    method = CONVEX.method(model, p=1e9, max_displacement=2.0 * critdis)
    found = method_warnings(model, method, Schedule(step=1e-3, end=1.0, every=1.0))
    assert any("block 'slab 0' is only 0.00397 m thick" in one for one in found) == warned
