"""Cohesion acts on the plane: of faces in pieces, of faces that slide on, and until they open."""

import dataclasses
import itertools

import numpy as np
import pytest

import clast
from clast.errors import ModelError
from clast.inputs.builder import InputBuilder
from clast.model.joints import Joint
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problems.slopes.cohesive_slab import slab
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE

LENGTH, HEIGHT, DENSITY, GRAVITY = 3.0, 0.3, 2500.0, 10.0
DIP, FRICTION, COHESION = np.radians(45.0), 0.5, 1e3
SPEED = GRAVITY * (np.sin(DIP) - FRICTION * np.cos(DIP)) - COHESION / (DENSITY * HEIGHT)
"""Acceleration of the slab with all of its cohesion at work, m/s2."""


def sliding(plane, blocks, *, turn=0.0, **joint):
    """Return a slab in ``blocks`` pieces upon a plane in ``plane`` pieces, which goes on below."""
    up = np.array([np.cos(DIP + turn), np.sin(DIP + turn)])
    out = np.array([-up[1], up[0]])
    gravity = -GRAVITY * np.array([-np.sin(turn), np.cos(turn)])
    builder = InputBuilder(gravity=tuple(gravity))
    builder.add_rock("rock", young=1e9, poisson=0.0, density=DENSITY)
    numbers = {"friction_angle": float(np.degrees(np.arctan(FRICTION))), "cohesion": COHESION}
    builder.add_joint(**numbers | joint)
    parts = (-4.0, LENGTH + 0.5, -1.0, 0.0, plane), (0.0, LENGTH, 0.0, HEIGHT, blocks)
    for low, high, bottom, top, count in parts:
        at = np.linspace(low, high, count + 1)
        for a, b in itertools.pairwise(at):
            corners = [a * up + bottom * out, b * up + bottom * out]
            corners += [b * up + top * out, a * up + top * out]
            builder.block(vertices=corners, fixed=top == 0.0)
            last = corners
    builder.measured_point("slab", 0.25 * sum(last), block=str(plane + blocks))
    return builder.build()


def run_of(model, variant=CONVEX, end=0.8, step=2e-3):
    method = variant.method(model, p=1e9, max_displacement=0.05)
    return simulate(model, method, Schedule(step=step, end=end, every=end))


@pytest.mark.slow
@pytest.mark.parametrize(("plane", "blocks"), [(1, 1), (7, 1), (5, 2)])
def test_a_slab_slides_against_its_cohesion_however_it_is_cut(plane, blocks):
    """Past seams and onto parts of the plane that it did not lie on: 1.3 m with all of c A."""
    run = run_of(sliding(plane, blocks))
    way = np.hypot(*run.history("slab").displacement[-1])
    assert way == pytest.approx(0.5 * SPEED * 0.8**2, rel=5e-3)
    assert run.state.memory.bonded.any()


@pytest.mark.slow
def test_a_slab_that_is_turned_slides_as_far():
    ways = [
        np.hypot(*run_of(sliding(4, 1, turn=turn)).history("slab").displacement[-1])
        for turn in (0.0, 2.0)
    ]
    assert ways[1] == pytest.approx(ways[0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("residual", [0.0, 400.0])
def test_a_brittle_joint_keeps_what_slip_leaves(residual):
    run = run_of(sliding(3, 1, residual_cohesion=residual))
    way = np.hypot(*run.history("slab").displacement[-1])
    speed = SPEED + (COHESION - residual) / (DENSITY * HEIGHT)
    assert way == pytest.approx(0.5 * speed * 0.8**2, rel=5e-3)
    assert not run.state.memory.bonded.any()


@pytest.mark.parametrize("variant", [LAGGED, OPEN_CLOSE, CONVEX], ids=lambda one: one.name)
@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_a_slab_holds_up_to_its_factor_of_safety(variant, factor):
    """Hoek & Bray, plane in 5 and slab in 2 pieces; the whole of it in clast verify."""
    model = slab((5, 2), 1.3 * factor)
    method = variant.method(model, p=2e9, max_displacement=0.02, dynamic_ratio=0.0)
    run = simulate(model, method, Schedule(step=2e-3, end=0.3, every=0.3))
    moved = run.history("slab 1").displacement
    a_step = np.hypot(*(moved[-1] - moved[-11])) / 10.0
    assert (a_step < 0.5e-3 * 9.8 * 2e-3**2) == (factor < 1.0)


def test_a_block_that_is_lifted_off_has_no_cohesion_afterwards():
    builder = InputBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=1e9, poisson=0.0, density=DENSITY)
    builder.add_joint(friction_angle=20.0, cohesion=1e5)
    builder.block(vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], velocity=(0.0, 1.0, 0.0))
    run = run_of(builder.build(), end=0.4)
    assert len(run.state.memory)
    assert not run.state.memory.bonded.any() and not run.state.memory.cohesive.any()


def test_more_is_not_left_than_there_was():
    builder = InputBuilder()
    builder.add_rock("rock", young=1e9, poisson=0.0, density=DENSITY)
    # said where the joint is given (decision 92)
    with pytest.raises(ModelError, match="residual_cohesion"):
        builder.add_joint(cohesion=1e3, residual_cohesion=2e3)


def test_a_case_file_says_what_slip_leaves(tmp_path):
    assert dataclasses.asdict(Joint())["residual_cohesion"] is None
    text = """
    schema = 1
    [time]
    step = 1e-3
    end = 1e-3
    [rock.r]
    young = 1e9
    poisson = 0.2
    density = 2500.0
    [joint.default]
    cohesion = 2e4
    residual_cohesion = 1e3
    [[block]]
    vertices = [[0, 0], [1, 0], [1, 1]]
    [[stage]]
    name = "weaker"
    joint = {default = {cohesion = 1e4, residual_cohesion = 0.0}}
    """
    path = tmp_path / "case.toml"
    path.write_text(text)
    case = clast.Case.from_toml(path)
    assert case.model().joint_table.joints[0].residual_cohesion == 1e3
    assert case.stage[0].joint["default"].residual_cohesion == 0.0
