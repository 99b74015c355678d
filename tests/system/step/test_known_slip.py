"""A shear test whose slip is known: drawn along a floor with a bend, in cut steps, resumed."""

import numpy as np
import pytest

import clast
from clast.results import read_results
from scenes.restarts import pressed_at

SPEED, STEP, PRESSING, HALF = 0.5, 2e-3, 0.02, 0.1
"""Speed of the tip, m/s; step, time of pressing and of each half of the way, s."""
BEND = np.radians(4.0)
STIFF = {"name": "penalty", "normal_stiffness": 1e8}


def drawn(turn=0.0, mirrored=False):
    """Return the model of a stiff tip that is pressed to a floor and drawn at SPEED.

    It passes the bend of the floor where a step ends.  Turned by radians, and mirrored before.
    """
    depth = 1e-6
    flip = np.array([-1.0 if mirrored else 1.0, 1.0])
    cosine, sine = np.cos(turn), np.sin(turn)

    def placed(points):
        points = np.array(points, float) * flip
        points = points[::-1] if mirrored and points.ndim > 1 else points
        return points @ np.array([[cosine, sine], [-sine, cosine]])

    builder = clast.ModelBuilder(title="A tip that is drawn", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=2e12, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=20.0)
    far = 3.0 * np.array([np.cos(BEND), -np.sin(BEND)])
    floor = [(-3, -2), (3, -2), far, (0, 0), (-3, 0)]
    builder.block(name="floor", vertices=placed(floor), fixed=True)
    # a hair beyond the bisector: at this depth it lies so far before the corner
    first = np.array([-depth * np.tan(0.5 * BEND) - SPEED * HALF + 1e-11, 0.0])
    tip = first + np.array([(0.0, 0.0), (0.05, 0.2), (-0.05, 0.2)])
    builder.block(name="tip", vertices=placed(tip))
    times = np.array([0.0, PRESSING, PRESSING + HALF, PRESSING + 2 * HALF])
    way = SPEED * HALF
    course = np.array(
        [
            (0, 0),
            (0, -depth),
            (way, -depth),
            (way * (1 + np.cos(BEND)), -depth - way * np.sin(BEND)),
        ]
    )
    for name, values in zip("xy", placed(course * flip * flip).T, strict=True):
        builder.add_amplitude(name, times, values[::-1] if mirrored else values)
    builder.motion(block="tip", x={"displacement": "x"}, y={"displacement": "y"}, rotation=0.0)
    return builder.build()


def known(time, step):
    """Return the slip at a time, m; the step that passes the bend counts along the old edge."""
    passed = time > PRESSING + HALF + 0.5 * step
    return SPEED * max(0.0, time - PRESSING) - passed * SPEED * step * (1.0 - np.cos(BEND))


@pytest.mark.parametrize(("turn", "mirrored"), [(0.0, False), (2.0, False), (0.5, True)])
@pytest.mark.parametrize("cut", [False, True])
def test_slip_is_the_way_through_a_bend_and_cut_steps(turn, mirrored, cut):
    # a limit that half a step meets: every step is halved
    limit = 0.5001 * SPEED * STEP if cut else 1e-2
    run = clast.simulate(
        drawn(turn, mirrored),
        step=STEP,
        end=PRESSING + 2 * HALF,
        every=0.02,
        max_displacement=limit,
        contact_law=STIFF,
    )
    step = 0.5 * STEP if cut else STEP
    assert run.report.steps == pytest.approx((2 if cut else 1) * 100 + 10, abs=1)
    edges = set()
    for frame, time in enumerate(run.times[1:], 1):
        contacts = run.contacts(frame)
        assert len(contacts) == 1
        edges |= set(contacts.edge.tolist())
        sign = 1.0 if mirrored else -1.0
        assert sign * contacts.slip[0] == pytest.approx(known(time, step), abs=1e-9)
        assert contacts.opening[0] == pytest.approx(-1e-6, abs=1e-9)
    assert len(edges) == 2


def test_slip_goes_on_after_a_resume(tmp_path):
    """A run that is resumed before the bend ends with the slip of one that was not, to the bit."""
    keys = {"step": STEP, "every": 0.02, "contact_law": STIFF, "max_displacement": 1e-2}
    end = PRESSING + 2 * HALF
    model = drawn()
    whole = clast.simulate(model, end=end, output=tmp_path / "whole.vtkhdf", **keys)
    part = clast.simulate(
        model, end=end, output=tmp_path / "part.vtkhdf", progress=pressed_at(50), **keys
    )
    assert not part.report.finished and part.checkpoint is not None
    resumed = clast.resume(part.checkpoint, model=model)
    assert resumed.report.finished
    for frame in range(len(whole.times)):
        for run in (resumed, read_results(tmp_path / "part.vtkhdf")):
            assert (run.contacts(frame).slip == whole.contacts(frame).slip).all()
    assert -whole.contacts(-1).slip[0] == pytest.approx(known(end, STEP), abs=1e-9)
