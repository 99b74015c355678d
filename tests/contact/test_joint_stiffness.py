"""Joints with a stiffness per area: the springs of their contacts, and what blocks do on them."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.contact.joints.faces import END
from clast.contact.laws import Penalty, normal_stiffness_of
from scenes.systems import box, contacts_of, turned

NORMAL, SHEAR = 4e9, 1e9
"""Stiffness of the joint, Pa/m."""
YOUNG = 1e14
"""So stiff that only the joint gives way, Pa."""
LAW = 3e7
"""Normal stiffness of the contact law, N/m per m: unlike that of every contact of the joint."""
LAWS = {
    "penalty": {"name": "penalty", "normal_stiffness": LAW},
    "augmented Lagrangian": {"name": "augmented-lagrangian", "normal_stiffness": LAW},
    "carried multipliers": {
        "name": "augmented-lagrangian",
        "normal_stiffness": LAW,
        "multipliers": "carried",
    },
}
PROCESSES = ["modified", "open-close", "convex"]


def builder_of(young: float = YOUNG, **joint: float) -> clast.ModelBuilder:
    """Return a builder without gravity whose joint has the stiffnesses above."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=young, poisson=0.0, density=2500.0)
    builder.add_joint("default", **{"friction_angle": 30.0, **joint})
    return builder


def springs(outlines, **joint) -> tuple[np.ndarray, np.ndarray]:
    """Return the stiffnesses of all contacts of some blocks, N/m per m."""
    builder = builder_of(**(joint or {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR}))
    builder.blocks(vertices=outlines)
    contacts = contacts_of(builder.build())
    return contacts.normal_stiffness, contacts.shear_stiffness


FACES = {
    "corners coincide": (box(0, 0), box(0, 1), 1.0),
    "offset": (box(0, 0), box(0.3, 1), 0.7),
    "short on long": (box(0, 0, 3.0), box(1, 1), 1.0),
    "one end in common": (box(0, 0, 3.0), box(2, 1), 1.0),
    "upright": (box(0, 0, 1.0, 2.0), box(1, 0.5), 1.0),
}


@pytest.mark.parametrize("angle", [0.0, 0.7, 3.0])
@pytest.mark.parametrize("faces", FACES)
def test_springs_of_a_face_add_up_to_stiffness_by_length(faces, angle):
    one, other, length = FACES[faces]
    normal, shear = springs([turned(one, angle), turned(other, angle)])
    assert normal.sum() == pytest.approx(NORMAL * length, rel=1e-12)
    assert shear.sum() == pytest.approx(SHEAR * length, rel=1e-12)


def test_joints_without_a_stiffness_leave_it_to_the_law():
    normal, shear = springs([box(0, 0), box(0, 1)], friction_angle=30.0)
    assert np.isnan(normal).all()
    assert np.isnan(shear).all()


def test_each_contact_has_the_springs_of_its_own_joint():
    builder = builder_of(normal_stiffness=NORMAL)
    builder.add_joint("soft", normal_stiffness=1e7, between=[("below", "left")])
    builder.block(name="below", vertices=box(0, 0, 4.0))
    builder.block(name="left", vertices=box(0.5, 1.0))
    builder.block(name="right", vertices=box(2.5, 1.0))
    contacts = contacts_of(builder.build())
    on_left = (contacts.vertex_block == 1) | (contacts.edge_block == 1)
    assert contacts.normal_stiffness[on_left].sum() == pytest.approx(1e7, rel=1e-12)
    assert contacts.normal_stiffness[~on_left].sum() == pytest.approx(NORMAL, rel=1e-12)
    assert np.isnan(contacts.shear_stiffness).all()
    assert (normal_stiffness_of(contacts, Penalty(LAW)) == contacts.normal_stiffness).all()


@pytest.mark.parametrize("height", [0.3, 1.0, 2.0])
def test_springs_change_little_where_a_block_tilts(height):
    """A corner on which a block has tilted keeps the springs that it had, times cos^3."""
    found = []
    for tilt in np.radians([0.0, 2.9, 3.1, 10.0, 30.0, 60.0, 80.0, 90.0]):
        above = np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 1.0 + height], [1.0, 1.0 + height]])
        pivot = above[1]
        c, s = np.cos(-tilt), np.sin(-tilt)
        above = (above - pivot) @ np.array([[c, s], [-s, c]]) + pivot
        builder = builder_of(normal_stiffness=1.0)
        builder.blocks(vertices=[box(0, 0, 8.0), above])
        contacts = contacts_of(builder.build())
        at_pivot = np.abs(contacts.foot - (pivot - builder.build().origin)).max(axis=1) < 1e-9
        assert at_pivot.sum() == 1
        found.append(contacts.normal_stiffness[at_pivot][0])
        # a corner is the end of a face, and stands for that share of it (decision 82)
        own = (np.cos(tilt) ** 3 + height * np.sin(tilt) ** 3) * END
        assert found[-1] == pytest.approx(own, rel=3e-3 * (1.0 + height))
    assert found[0] == pytest.approx(END, rel=1e-12)
    assert found[-1] == pytest.approx(height * END, rel=1e-12)


def squeezed(process, law, force=(0.0, -2e6), end=0.2):
    """Return the run of a block that is pushed on another one, at rest."""
    builder = builder_of(normal_stiffness=NORMAL, shear_stiffness=SHEAR)
    builder.block(name="below", vertices=box(-1, 0, 3.0), fixed=True)
    builder.block(name="above", vertices=box(0, 1))
    builder.point_load((0.5, 1.5), force, block="above")
    builder.measured_point("A", (0.5, 1.5), block="above")
    case = builder.case(
        step=1e-3,
        end=end,
        dynamic_ratio=0.0,
        max_displacement=0.05,
        process=process,
        contact_law=law,
    )
    return case.run(progress=False)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.one_in(3)
def test_a_joint_closes_by_stress_over_stiffness(process, law):
    """Whatever the process and the law: multipliers are not to take away what a joint gives."""
    closure = -squeezed(process, LAWS[law]).history("A").displacement[-1, 1]
    # the block itself, pushed at its middle, gives half of its lower half: F/(4 E)
    assert closure == pytest.approx(2e6 / NORMAL + 2e6 / (4.0 * YOUNG), rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("process", PROCESSES)
def test_a_joint_slips_by_shear_stress_over_stiffness(process):
    # so little that the side which the moment relieves does not slide yet
    run = squeezed(process, LAWS["penalty"], force=(1e5, -2e6))
    along, across = run.history("A").displacement[-1]
    # the push acts above the joint, which it turns the block on: half a block up
    angle = run.history("A").rotation[-1]
    lever = angle * 0.5
    assert across + 0.25 * angle**2 == pytest.approx(-2e6 / NORMAL, rel=1e-4)
    # the shear force is along the faces, one of which has turned: it bears a part of the weight
    assert 1e5 < SHEAR * (along + lever) < 1e5 + 2e6 * abs(angle)


@pytest.mark.slow
def test_forces_by_closure_are_stiffness_by_length_to_round_off():
    memory = squeezed("convex", LAWS["penalty"]).state.memory
    closure = -memory.gap[memory.normal_force > 0.0]
    assert np.ptp(closure) < 1e-12 * closure.mean()
    assert memory.normal_force.sum() / closure.mean() == pytest.approx(NORMAL, rel=1e-12)


def over_a_ledge(process: str, end: float):
    """Return the ledger of a block that slides off a ledge, tilts over its edge and falls by 2 m.

    It lands on a corner at 1.1 s, at 5 m/s.
    """
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=5.0, normal_stiffness=1e8, shear_stiffness=1e8)
    builder.block(name="ledge", vertices=box(0, 0, 2.0, 2.0), fixed=True)
    builder.block(name="floor", vertices=box(-2, -1, 12.0), fixed=True)
    builder.block(name="block", vertices=box(1.0, 2.0, 1.0, 0.5), velocity=(1.5, 0.0, 0.0))
    case = builder.case(
        step=5e-4,
        end=end,
        max_displacement=0.05,
        process=process,
        contact_law=LAWS["penalty"],
    )
    return case.run(progress=False).state.ledger


@pytest.mark.slow
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.one_in(3)
def test_the_ledger_stays_closed_where_lengths_of_contact_change(process):
    """The springs keep changing until the block falls freely; then it lands on a soft corner.

    That has 2.4 % of a face's springs; the others come in as the block turns flat (decision 94).
    """
    ledger = over_a_ledge(process, end=1.3)
    turned_over = -ledger.gravity
    assert turned_over > 10e3
    assert abs(ledger.unaccounted) < 1e-6 * turned_over
    # what comes and goes with the length of springs is little of what gravity gave
    left = ledger.stored + ledger.friction + ledger.impacts + ledger.numerical
    assert abs(left) < 2.0 * turned_over
    assert ledger.numerical > -0.01 * turned_over


def test_warnings_tell_of_units_and_of_half_a_stiffness():
    builder = builder_of(young=5e10, normal_stiffness=20.0)
    builder.blocks(vertices=[box(0, 0), box(0, 1)])
    case = builder.case(step=1e-3, end=1e-3)
    texts = "\n".join(case.examine().warnings)
    assert "normal_stiffness of joint 'default' is 20 Pa/m" in texts
    assert "Give shear_stiffness" in texts
