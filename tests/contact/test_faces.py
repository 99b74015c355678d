"""Faces of joints with stiffness or bond: closed forms of the bending of a section.

A beam stands out of a wall, which is one block or several, and is loaded by forces along its axis:
N and M = N e about the middle of its height b.  Joint stiffness k, tensile strength sigma_t.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import clast
from clast.contact.joints.faces import PLACES
from scenes.systems import REACH, box, contacts_of, turned

K, YOUNG = 1e10, 1e15
"""Joint stiffness, Pa/m, and modulus of blocks that give way to nothing, Pa."""
HEIGHT = 0.5
PROCESSES = ["modified", "open-close", "convex"]


def beam(
    parts=1,
    *,
    force=0.0,
    moment=0.0,
    steps=200,
    step=2e-3,
    angle=0.0,
    last=False,
    young=YOUNG,
    method=None,
    **joint,
):
    """Return the run of a beam on a wall in ``parts``; ``force`` presses, ``moment`` turns it."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=young, poisson=0.0, density=2500.0)
    builder.add_joint("default", **{"friction_angle": 40.0, **joint})

    def place(corners):
        return turned(np.asarray(corners, float), np.radians(angle))

    levels = np.linspace(0.0, HEIGHT, parts + 1)
    wall = [box(-1.0, low, 1.0, high - low) for low, high in pairwise(levels)]
    if last:
        builder.block(name="beam", vertices=place(box(0, 0, 0.5, HEIGHT)))
    for corners in wall:
        builder.block(vertices=place(corners), fixed=True)
    if not last:
        builder.block(name="beam", vertices=place(box(0, 0, 0.5, HEIGHT)))
    ends = place([(0.5, 0.0), (0.5, HEIGHT)])
    pair = np.array([0.5 * force + moment / HEIGHT, 0.5 * force - moment / HEIGHT])
    along = place([(1.0, 0.0)])[0]
    for end, size in zip(ends, pair, strict=True):
        builder.point_load(tuple(end), tuple(-size * along), block="beam")
    builder.measured_point("tip", tuple(place([(0.5, 0.5 * HEIGHT)])[0]), block="beam")
    case = builder.case(
        step=step,
        end=steps * step,
        dynamic_ratio=0.0,
        max_displacement=0.02,
        **(method or {}),
    )
    return case.run(progress=False)


def bent(parts=1, **how):
    """Return the rotation of the beam, rad, and its closure at mid-height, m."""
    tip = beam(parts, **how).history("tip")
    return abs(float(tip.rotation[-1])), float(np.hypot(*tip.displacement[-1]))


STIFF = {"normal_stiffness": K, "shear_stiffness": K}


@pytest.mark.slow
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("parts", [1, 3])
@pytest.mark.one_in(3)
def test_a_joint_turns_by_twelve_times_the_moment(process, parts):
    """theta = 12 M/(k b^3), closure N/(k b)."""
    force, moment = 2e5, 2e3
    # one pass bears k b h^2/m of 6 at most
    how = {"step": 2e-4, "steps": 600} if process == "modified" else {}
    method = {"process": process}
    turn, closure = bent(parts, force=force, moment=moment, method=method, **how, **STIFF)
    assert turn == pytest.approx(12.0 * moment / (K * HEIGHT**3), rel=2e-3)
    assert closure == pytest.approx(force / (K * HEIGHT), rel=3e-2)


@pytest.mark.slow
@pytest.mark.parametrize("parts", [1, 2, 10])
@pytest.mark.parametrize("share", [0.2, 0.25, 1 / 3, 0.4, 0.42, 0.45])
@pytest.mark.one_in(3)
def test_a_face_that_has_opened_in_part_turns_as_its_rest_does(share, parts):
    """Beyond the kern the face bears on 3 (b/2 - e): theta = 2 N/(k a^2)."""
    force = 2e5
    turn, _ = bent(parts, force=force, moment=share * HEIGHT * force, **STIFF)
    # the forces move sideways with the beam, which is as long as it is high
    length = 3.0 * (0.5 - share - turn) * HEIGHT
    assert turn == pytest.approx(2.0 * force / (K * length**2), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize(("share", "opens"), [(0.99, False), (1.01, True)])
def test_a_face_opens_at_the_kern(parts, share, opens):
    force = 2e5
    run = beam(parts, force=force, moment=share * HEIGHT * force / 6.0, **STIFF)
    assert (run.state.memory.gap.max() > 0.0) == opens


@pytest.mark.parametrize("angle", [0.0, 70.0])
@pytest.mark.parametrize("plane_first", [False, True])
@pytest.mark.parametrize("tilt", [2.9, 3.1, 10.0, 29.0])
def test_a_tip_that_goes_in_presses_as_what_is_inside(tilt, plane_first, angle):
    """A wedge g deep presses with k g^2/(2 tan(tilt)) across the plane, numbered as it may be."""
    deep = 0.15 * np.sin(np.radians(tilt))
    tipped = turned(box(0, 0), np.radians(tilt)) - [0.0, deep]
    outlines = [turned(one, np.radians(angle)) for one in (tipped, box(-2, -1, 6.0))]
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=YOUNG, poisson=0.0, density=2500.0)
    builder.add_joint("default", friction_angle=40.0, **STIFF)
    builder.blocks(vertices=outlines[::-1] if plane_first else outlines)
    contacts = contacts_of(builder.build(), reach=replace(REACH, depth=0.1))
    forces = contacts.normal_stiffness * np.maximum(0.0, -contacts.gap)
    assert forces.sum() == pytest.approx(K * deep**2 / (2.0 * np.tan(np.radians(tilt))), rel=0.1)
    across = turned(np.array([[0.0, 1.0]]), np.radians(angle))[0]
    turn = 0.0 if tilt > 3.0 else np.radians(tilt)
    pressed = contacts.normal[forces > 0.0]
    assert np.abs(np.abs(pressed @ across) - 1.0).max() <= 1.0 - np.cos(turn) + 1e-12


BONDS = {
    "law": {"cohesion": 1e9, "tensile_strength": 1e6},
    "joint": {"cohesion": 1e9, "tensile_strength": 1e6, **STIFF},
}


def is_whole(run):
    """Return whether all that was bonded at the start is."""
    memory = run.state.memory
    return bool(memory.bonded.all()) and len(memory) > 8


@pytest.mark.slow
@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize("springs", BONDS)
@pytest.mark.parametrize(("share", "holds"), [(0.99, True), (1.01, False)])
@pytest.mark.one_in(3)
def test_a_bonded_beam_breaks_as_beam_theory_says(parts, springs, share, holds):
    """M = sigma_t b^2/6, on one edge and on four."""
    moment = share * 1e6 * HEIGHT**2 / 6.0
    run = beam(parts, moment=moment, young=1e10, **BONDS[springs])
    assert is_whole(run) == holds
    assert (float(np.abs(run.history("tip").rotation[-1])) < 1e-3) == holds


@pytest.mark.slow
@pytest.mark.parametrize("parts", [1, 3])
@pytest.mark.parametrize(("share", "holds"), [(0.99, True), (1.01, False)])
def test_a_bonded_beam_is_pulled_off_at_its_strength(parts, share, holds):
    run = beam(parts, force=-share * 1e6 * HEIGHT, young=1e10, **BONDS["law"])
    assert is_whole(run) == holds
    assert run.state.memory.bonded.any() == holds


@pytest.mark.slow
def test_nothing_hangs_on_directions_or_on_the_order_of_blocks():
    how = {"force": 2e5, "moment": 2.5e4, "steps": 60, **STIFF}
    one, _ = bent(2, **how)
    for other in ({"angle": 27.0}, {"last": True}, {"angle": 200.0, "last": True}):
        assert bent(2, **how, **other)[0] == pytest.approx(one, rel=1e-6)
    assert bent(2, **how | {"moment": -2.5e4})[0] == pytest.approx(one, rel=1e-6)


# --- where the points are --------------------------------------------------------------------


def faces_of(outlines, **joint):
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", **joint)
    builder.blocks(vertices=outlines)
    return contacts_of(builder.build())


@pytest.mark.parametrize("joint", [{"cohesion": 1e5}, {"tensile_strength": 1e5}, STIFF])
@pytest.mark.parametrize("shift", [-0.4, 0.0, 0.3, 0.95])
@pytest.mark.parametrize("angle", [0.0, 33.0])
def test_shares_of_a_face_have_its_length_and_second_moment(joint, shift, angle):
    """Whatever part of two edges lies on each other, and on either side."""
    blocks = [box(0, 0, 1.0), box(shift, 1, 1.0)]
    for pair in (blocks, blocks[::-1]):
        contacts = faces_of([turned(one, np.radians(angle)) for one in pair], **joint)
        length = 1.0 - abs(shift)
        x = contacts.foot @ np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        middle = contacts.length @ x / length
        assert contacts.length.sum() == pytest.approx(length, rel=1e-12)
        second = contacts.length @ (x - middle) ** 2
        assert second == pytest.approx(length**3 / 12.0, rel=1e-9)
        assert np.count_nonzero(contacts.point) == len(PLACES)


def test_joints_without_stiffness_or_bond_and_welds_keep_their_corners():
    blocks = [box(0, 0, 1.0), box(0.2, 1, 1.0)]
    assert not faces_of(blocks, friction_angle=30.0).point.any()
    assert not faces_of(blocks, cohesion=1e18, tensile_strength=1e18).point.any()
    assert (faces_of(blocks, friction_angle=30.0).spring_share == 1.0).all()


def test_a_wall_is_as_stiff_as_its_corners_were_where_the_law_has_the_springs():
    """A face as long as the smallest block has the springs of two corners."""
    contacts = faces_of([box(0, 0, 1.0), box(0, 1, 1.0)], tensile_strength=1e5)
    assert contacts.spring_share.sum() == pytest.approx(2.0, rel=1e-12)


# --- what a run does with them ---------------------------------------------------------------
