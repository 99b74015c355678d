"""Opening and slip of contacts in frames: as the blocks have moved, in memory and in files."""

import numpy as np
import pytest

import clast
from clast.pictures.joint_values import JOINT_FIELDS
from clast.results import read_results


def pushed(tmp_path, name="a.vtkhdf", joint=None, **keys):
    """Return the run of a brick that slides to the left on a table, recorded in a file."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", **{"friction_angle": 20.0, **(joint or {})})
    builder.block(name="table", vertices=[(-4, -1), (4, -1), (4, 0), (-4, 0)], fixed=True)
    builder.block(
        name="brick", vertices=[(0, 0), (1, 0), (1, 0.5), (0, 0.5)], velocity=(-2.0, 0.0, 0.0)
    )
    builder.measured_point("foot", (0.0, 0.0), block="brick")
    model = builder.build()
    schedule = {"step": 2e-3, "end": 0.04, "every": 0.01, "output": tmp_path / name, **keys}
    return clast.simulate(model, **schedule)


def test_slip_is_that_of_the_blocks(tmp_path):
    run = pushed(tmp_path)
    file = read_results(tmp_path / "a.vtkhdf")
    history = run.history("foot")
    for frame, time in enumerate(run.times):
        moved = history.displacement[np.abs(history.time - time).argmin(), 0]
        for results in (run, file):
            contacts = results.contacts(frame)
            # to the left as seen from the table; the other corner strains away from this one
            assert contacts.slip[contacts.vertex == 4] == pytest.approx(-moved, abs=1e-9)
            assert contacts.slip == pytest.approx(-moved, abs=1e-6)
    assert -moved > 0.05
    depth = run.contacts(-1).opening
    assert (depth < 0.0).all()
    assert depth.sum() == pytest.approx(-run.contacts(-1).normal_force.sum() / 5e9, rel=1e-6)
    assert np.array_equal(run.contacts(-1).slip, file.contacts(-1).slip)


def test_slip_does_not_depend_on_steps_that_are_cut(tmp_path):
    whole = pushed(tmp_path)
    cut = pushed(tmp_path, "b.vtkhdf", max_displacement=1.5e-3)
    assert cut.report.steps > 1.5 * whole.report.steps
    assert cut.contacts(-1).slip == pytest.approx(whole.contacts(-1).slip, rel=2e-3)


@pytest.mark.parametrize(
    ("keys", "lost"),
    [
        ({}, 0.0),
        ({"residual_friction_angle": 10.0, "slip_weakening": 0.2}, None),
        ({"residual_friction_angle": 10.0, "slip_weakening": 0.01}, 1.0),
        ({"residual_friction_angle": 10.0}, 1.0),
        ({"cohesion": 1e3, "residual_cohesion": 0.0}, 1.0),
    ],
    ids=["plain", "weakening", "weakened", "at once", "brittle"],
)
def test_strength_is_lost_with_the_slide(tmp_path, keys, lost):
    run = pushed(tmp_path, joint=keys)
    contacts = run.contacts(-1)
    slid = -run.history("foot").displacement[-1, 0]
    share = slid / keys["slip_weakening"] if lost is None else lost
    assert contacts.worn == pytest.approx(share, rel=2e-3)
    assert np.array_equal(read_results(tmp_path / "a.vtkhdf").contacts(-1).worn, contacts.worn)
    (value,) = np.unique(np.round(JOINT_FIELDS["worn"].values(run, -1).value, 6))
    assert value == pytest.approx(100.0 * share, rel=2e-3)


@pytest.mark.parametrize("law", ["penalty", "augmented-lagrangian"])
@pytest.mark.parametrize("process", ["convex", "modified", "open-close"])
def test_what_slides_carries_its_strength(tmp_path, process, law):
    """|T| = N tan(phi) + c L where it slides; below that N tan(alpha) on a plane of alpha."""
    method = {"process": process, "contact_law": {"name": law, "normal_stiffness": 5e8}}
    for joint, cohesion in (({}, 0.0), ({"cohesion": 100.0}, 100.0)):
        run = pushed(tmp_path, joint=joint, **method)
        contacts = run.contacts(-1)
        slides = contacts.mode == 1
        assert slides.any()
        size = np.abs(contacts.shear_force)
        assert size[slides] == pytest.approx(contacts.strength[slides], rel=1e-9)
        assert (size <= contacts.strength * (1.0 + 1e-9)).all()
        # the brick is 1 m long; the modified process bounds friction by the N of the solve before
        whole = contacts.normal_force.sum() * np.tan(np.radians(20.0)) + cohesion
        lagged = process == "modified" and law == "augmented-lagrangian"
        assert contacts.strength.sum() == pytest.approx(whole, rel=0.06 if lagged else 1e-3)
    file = read_results(tmp_path / "a.vtkhdf").contacts(-1)
    assert np.array_equal(file.strength, contacts.strength)


def test_what_rests_uses_a_share_of_its_strength():
    """A block on a plane of 20 degrees: (W sin(alpha))/(W cos(alpha) tan(phi) + c L)."""
    alpha, phi, cohesion = np.radians(20.0), np.radians(30.0), 2e3
    builder = clast.ModelBuilder(gravity=(-9.8 * np.sin(alpha), -9.8 * np.cos(alpha)))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0, cohesion=cohesion)
    builder.block(name="plane", vertices=[(-4, -1), (4, -1), (4, 0), (-4, 0)], fixed=True)
    builder.block(name="block", vertices=[(0, 0), (1, 0), (1, 0.2), (0, 0.2)])
    run = clast.simulate(builder.build(), step=2e-3, end=0.5, dynamic_ratio=0.0)
    contacts, weight = run.contacts(-1), 2500.0 * 9.8 * 0.2
    strength = weight * np.cos(alpha) * np.tan(phi) + cohesion
    assert contacts.strength.sum() == pytest.approx(strength, rel=1e-6)
    (face,) = JOINT_FIELDS["utilisation"].values(run, -1).value
    assert face == pytest.approx(100.0 * weight * np.sin(alpha) / strength, rel=1e-4)
