"""Blocks that meet in a point and are bonded to each other round it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clast
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.variants import MIDPOINT, MIDPOINT_OPEN_CLOSE
from scenes.systems import box, contacts_of, turned

RIM = np.radians([0.0, 47.0, 90.0, 170.0, 200.0, 301.0])
"""Where triangles round a point meet, none of them behind another's edge."""


def fan(number: int, scale: float = 1.0, at: tuple[float, float] = (0.0, 0.0)) -> list[np.ndarray]:
    """Return ``number`` triangles round a point, each with a face on the next."""
    rim = scale * np.stack([np.cos(RIM), np.sin(RIM)], axis=1)
    return [
        np.array([[0.0, 0.0], rim[k], rim[(k + 1) % len(rim)]]) + np.asarray(at)
        for k in range(number)
    ]


def model_of(outlines, **joint):
    """Return a model of rock with these outlines, bonded."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e9, poisson=0.25, density=2500.0)
    strengths = {"friction_angle": 40.0, "cohesion": 1e9, "tensile_strength": 1e9}
    builder.add_joint("default", **{**strengths, **joint})
    builder.blocks(vertices=outlines)
    return builder.build()


def pairs_of(model, state=None):
    """Return the pairs of blocks that have contacts."""
    contacts = contacts_of(model, state)
    return {
        tuple(sorted(one)) for one in np.stack([contacts.vertex_block, contacts.edge_block], axis=1)
    }


@pytest.mark.parametrize("scale", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("angle", [0.0, 33.0])
def test_only_blocks_that_share_a_face_touch_round_a_point(scale, angle):
    outlines = [turned(one, np.radians(angle)) for one in fan(6, scale, (5.0, -3.0))]
    neighbours = {tuple(sorted((k, (k + 1) % 6))) for k in range(6)}
    assert pairs_of(model_of(outlines)) == neighbours
    dry = pairs_of(model_of(outlines, cohesion=0.0, tensile_strength=0.0))
    assert dry > neighbours


def test_where_the_ring_is_open_its_two_ends_are_held_by_the_rest_of_it():
    assert pairs_of(model_of(fan(5))) == {(k, k + 1) for k in range(4)}


def test_a_broken_bond_brings_the_contact_back():
    """Two triangles with one between them, whose bond to the second has gone."""
    model = model_of(fan(3))
    run = simulate(
        model,
        MIDPOINT.method(model, p=1e12, max_displacement=0.01),
        Schedule(step=1e-4, end=2e-4, every=1e-4),
    )
    memory = run.state.memory
    own, other = model.vertex_block[memory.vertex], memory.block
    between = np.sort(np.stack([own, other]), axis=0)
    assert {tuple(one) for one in between.T} == {(0, 1), (1, 2)}
    gone = (between == [[1], [2]]).all(axis=0)
    broken = replace(memory, bonded=memory.bonded & ~gone, cohesive=memory.cohesive & ~gone)
    assert (0, 2) not in pairs_of(model, run.state)
    assert (0, 2) in pairs_of(model, replace(run.state, memory=broken))


@pytest.mark.parametrize("variant", [MIDPOINT, MIDPOINT_OPEN_CLOSE], ids=lambda one: one.name)
def test_a_wave_keeps_its_energy_in_triangles(variant):
    """Triangles that strike each other in points took 87 % of it."""
    outlines = []
    for x in range(8):
        for y in range(2):
            square = box(x, y, 1.0, 1.0)
            outlines += [square[[0, 1, 2]], square[[0, 2, 3]]]
    model = model_of(outlines)
    velocity = np.zeros((len(outlines), 6))
    velocity[:, 0] = 0.05 * np.cos(
        np.pi / 4.0 * np.array([one.mean(axis=0)[0] for one in outlines])
    )
    method = variant.method(model, p=1e12, max_displacement=0.01)
    run = simulate(
        replace(model, velocity=velocity), method, Schedule(step=2e-4, end=0.02, every=0.02)
    )
    kept = sum(float(run.energy[name][-1]) for name in ("kinetic", "elastic", "contact"))
    assert kept == pytest.approx(float(run.energy["kinetic"][0]), rel=1e-5)
