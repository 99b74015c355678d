"""Contributions to the equations: inertia, elasticity, stress, weight, loads, fixed points."""

from dataclasses import replace

import numpy as np
import pytest

from clast.block.displacement import movements
from clast.block.rotation import Sine
from clast.inputs.builder import InputBuilder
from clast.linear.block_matrix import row_pointers
from clast.linear.solvers import Direct, solve
from clast.linear.system import BlockSystem
from clast.model.model import PlaneStrain, PlaneStress
from clast.step import start as terms
from clast.step.integration import Scheme, end_velocity
from scenes.systems import GRAVITY, at_start, box, march, method, star, system, turned

YOUNG, POISSON, DENSITY = 2e7, 0.3, 2000.0


def builder(plane=None, gravity=(0.0, 0.0)):
    made = InputBuilder(plane=plane or PlaneStress(), gravity=gravity)
    made.add_rock("rock", young=YOUNG, poisson=POISSON, density=DENSITY)
    return made


def still(model):
    return np.zeros((model.block_count, 6))


def base_of(model, how=None, state=None, velocity=None, theta=0.5, step=1e-3):
    """Return the base system of a step."""
    how, state = how or method(), state or at_start(model)
    velocity = still(model) if velocity is None else velocity
    context = terms.begin(model, how, state, step, None)
    return terms.diagonal_terms(context, step * velocity, Scheme(theta=theta, step=step))


# --- time ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("theta", "mass"), [(0.5, 2.0), (1.0, 1.0)])
def test_schemes_are_constant_acceleration_and_backward_euler(theta, mass):
    h = 0.01
    scheme = Scheme(theta=theta, step=h)
    assert scheme.inertia == pytest.approx(mass / h**2)
    d, v = np.full((1, 6), 0.3), np.full((1, 6), 5.0)
    wanted = 2.0 * d / h - v if theta == 0.5 else d / h
    assert end_velocity(scheme, d, h * v, v) == pytest.approx(wanted)


def test_free_block_solves_newtons_law():
    """K d = F without contacts: M (v+ - v) = h F for any theta."""
    model = system([star(np.random.default_rng(0), 6)])
    how, h, theta = method(), 0.02, 0.7
    velocity = np.array([[1.0, -2.0, 0.5, 0.0, 0.0, 0.0]])
    base = base_of(model, how, velocity=velocity, theta=theta, step=h)
    none = np.zeros((0, 6, 6))
    one = BlockSystem(
        diagonal=base.diagonal,
        pairs=np.zeros((0, 2), np.int64),
        rows=row_pointers(1, np.zeros((0, 2), np.int64)),
        upper=none,
        fixed=np.zeros(1, np.bool_),
        force=base.force,
        centroid=base.centroid,
    )
    scheme = Scheme(theta=theta, step=h)
    after = end_velocity(scheme, solve(Direct(), one), h * velocity, velocity)
    assert after[0] == pytest.approx([1.0, -2.0 - h * GRAVITY, 0.5, 0.0, 0.0, 0.0], abs=1e-12)


# --- elasticity ----------------------------------------------------------------------------


def test_elasticity_matrices():
    """Hooke's law in three dimensions, with sigma_zz = 0 and eps_zz = 0."""
    e, nu = YOUNG, POISSON
    compliance = np.array([[1, -nu, -nu], [-nu, 1, -nu], [-nu, -nu, 1]]) / e
    shear = e / (2.0 * (1.0 + nu))
    stress = PlaneStress().elasticity(e, nu)
    assert stress[:2, :2] == pytest.approx(np.linalg.inv(compliance[:2, :2]))
    strain = PlaneStrain().elasticity(e, nu)
    assert strain[:2, :2] == pytest.approx(np.linalg.inv(compliance)[:2, :2])
    for matrix in (stress, strain):
        assert matrix[2] == pytest.approx([0.0, 0.0, shear])


@pytest.mark.parametrize("plane", [PlaneStress(), PlaneStrain()])
def test_patch(plane):
    """Uniform tractions on all faces strain a block uniformly, to the stress of the tractions.

    They pull: under pressure from fixed directions a free block is in unstable equilibrium.
    """
    made = builder(plane)
    corners = turned(box(0, 0, 2.0, 1.0), 0.4)
    made.block(vertices=corners)
    sxx, syy, sxy = 200.0, 100.0, 50.0
    for k in range(4):
        start, end = corners[k], corners[(k + 1) % 4]
        along = (end - start) / np.hypot(*(end - start))
        nx, ny = along[1], -along[0]
        made.line_load(start, end, (sxx * nx + sxy * ny, sxy * nx + syy * ny))
    model = made.build()
    # statically: no velocity is carried over, so that every step comes closer to rest
    last = march(model, method(dynamic_ratio=0.0, max_displacement=1.0), 1.0, 30.0)[-1].state
    assert last.stress[0] == pytest.approx([sxx, syy, sxy], rel=2e-3)
    assert abs(last.rotation[0]) < 1e-4  # ten times the strain


def test_initial_stress_is_released_by_straining():
    made = builder()
    made.block(vertices=box(0, 0), initial_stress=(1e4, -2e4, 3e3))
    model = made.build()
    force = base_of(model).force[0]
    assert force == pytest.approx([0.0, 0.0, 0.0, -1e4, 2e4, -3e3])
    last = march(model, method(dynamic_ratio=0.0, max_displacement=1.0), 1.0, 30.0)[-1].state
    assert np.abs(last.stress).max() < 1.0


# --- loads ---------------------------------------------------------------------------------


def test_weight_acts_at_the_centroid():
    outline = star(np.random.default_rng(4), 7)
    model = system([outline])
    force = base_of(model).force[0]
    assert force == pytest.approx([0.0, -model.mass[0] * GRAVITY, 0.0, 0.0, 0.0, 0.0])
    assert model.mass[0] == pytest.approx(2500.0 * model.area[0])


def test_point_load_does_the_work_of_its_point():
    """Generalised force times d = force times displacement of the point, for any d."""
    made = builder()
    made.block(vertices=box(0, 0, 2.0, 1.0))
    made.point_load((1.5, 0.75), (3e3, -4e3))
    model = made.build()
    force = base_of(model).force[0]
    rng = np.random.default_rng(0)
    for unknowns in 1e-7 * rng.normal(size=(5, 6)):
        offset = np.array([[0.5, 0.25]])
        moved = movements(Sine(), offset, unknowns[None], np.zeros(1, np.int64))
        assert force @ unknowns == pytest.approx(moved[0] @ [3e3, -4e3], rel=1e-5)


def test_line_load_is_the_sum_of_many_point_loads():
    one, many, pieces = builder(), builder(), 2000
    outline = star(np.random.default_rng(2), 6)
    start, end, traction = outline[0], outline[1], np.array([2e3, 5e3])
    one.block(vertices=outline)
    many.block(vertices=outline)
    one.line_load(start, end, traction)
    length = np.hypot(*(end - start))
    for share in (np.arange(pieces) + 0.5) / pieces:
        many.point_load(start + share * (end - start), traction * length / pieces, block="1")
    assert base_of(one.build()).force == pytest.approx(base_of(many.build()).force, rel=1e-9)


def test_loads_move_with_their_block():
    made = builder()
    made.block(vertices=box(0, 0, 2.0, 1.0))
    made.point_load((2.0, 0.5), (0.0, 1e3))
    model = made.build()
    state, middle = at_start(model), np.array([1.0, 0.5])
    turned_by = replace(
        state,
        vertices=turned(state.vertices - middle, np.pi / 2, middle),
        points=turned(state.points - middle, np.pi / 2, middle),
    )
    before, after = base_of(model).force[0], base_of(model, state=turned_by).force[0]
    assert before[2] == pytest.approx(1e3)  # the arm of 1 m
    assert after[2] == pytest.approx(0.0, abs=1e-9)  # now above the centroid
    assert after[:2] == pytest.approx(before[:2])


# --- fixed points --------------------------------------------------------------------------


def test_fixed_point_pulls_back_to_where_it_was():
    made = builder()
    made.block(vertices=box(0, 0, 2.0, 1.0))
    made.fixed_point((0.0, 0.0))
    model = made.build()
    how = method(fixed_point_stiffness=1e6)
    state = at_start(model)
    shifted = replace(state, points=state.points + np.array([1e-3, 2e-3]))
    pull = base_of(model, how, shifted).force[0] - base_of(model, how).force[0]
    assert pull[:2] == pytest.approx([-1e3, -2e3])
    assert pull[2] == pytest.approx(-1.0 * -2e3 + 0.5 * -1e3)  # arm (-1, -0.5)
    stiffness = (
        base_of(model, how).diagonal - base_of(model, method(fixed_point_stiffness=0.0)).diagonal
    )
    assert stiffness[0, :2, :2] == pytest.approx(1e6 * np.eye(2))


def test_block_on_two_fixed_points_stays():
    made = builder(gravity=(0.0, -GRAVITY))
    made.block(vertices=box(0, 0, 2.0, 1.0))
    made.fixed_point((0.0, 0.0))
    made.fixed_point((2.0, 0.0))
    model = made.build()
    last = march(model, method(fixed_point_stiffness=1e10), 1e-2, 1.0)[-1].state
    assert np.abs(last.points - model.fixed_points.at).max() < 1e-4
    assert abs(last.rotation[0]) < 1e-12
