"""Pressures on edges: resultants, what they do to free blocks, and their work."""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import clast
from clast.actions.in_situ import tractions
from clast.actions.loads import pressure_forces
from clast.model.model import Floats
from scenes.ledgers import assert_closed

WAYS = [
    (process, law)
    for process in ("modified", "open-close", "convex")
    for law in ("penalty", "augmented-lagrangian")
]
DENSITY = 2500.0


def free(corners: Sequence[tuple[float, float]], velocity=(0.0, 0.0, 0.0)) -> clast.ModelBuilder:
    """A block without weight or neighbours."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e10, poisson=0.2, density=DENSITY)
    builder.block(vertices=corners, velocity=velocity)
    return builder


def turned_square(angle: float) -> list[tuple[float, float]]:
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) @ turn.T
    return [tuple(corner) for corner in corners]


def run_of(builder: clast.ModelBuilder, way: tuple[str, str], **keys: float) -> clast.Run:
    return clast.simulate(builder, process=way[0], contact_law=way[1], **keys)


def by_quadrature(ends: Floats, pressure: Floats) -> Floats:
    """Return int T^T p n ds of one line by three Gauss points, T written out."""
    points, weights = np.polynomial.legendre.leggauss(3)
    line = ends[1] - ends[0]
    length = np.hypot(*line)
    inwards = np.array([-line[1], line[0]]) / length
    found = np.zeros(6)
    for point, weight in zip(0.5 * (points + 1.0), 0.5 * weights, strict=True):
        x, y = ends[0] + point * line
        t = np.array([[1, 0, -y, x, 0, 0.5 * y], [0, 1, x, 0, y, 0.5 * x]])
        p = pressure[0] + point * (pressure[1] - pressure[0])
        found += weight * length * p * (t.T @ inwards)
    return found


def test_generalised_forces_are_exact():
    rng = np.random.default_rng(3)
    ends, pressure = rng.normal(size=(200, 2, 2)), rng.normal(size=(200, 2))
    exact = np.array([by_quadrature(*one) for one in zip(ends, pressure, strict=True)])
    np.testing.assert_allclose(pressure_forces(ends, pressure), exact, rtol=0.0, atol=2e-15 * 20)


def test_resultant_and_moment_of_a_triangle_of_pressure():
    """On a face of height H to the left: p H/2 to the right, H/3 above the foot."""
    height, p = 3.0, 7e4
    ends = np.array([[[-1.0, 0.5 * height], [-1.0, -0.5 * height]]])  # downwards on the left
    fx, fy, moment, *_ = pressure_forces(ends, np.array([[0.0, p]]))[0]
    assert fx == pytest.approx(0.5 * p * height, rel=1e-12)
    assert fy == pytest.approx(0.0, abs=1e-12 * p)
    arm = height / 3.0 - 0.5 * height  # of the resultant above the centroid
    assert moment == pytest.approx(-arm * fx, rel=1e-12)


@pytest.mark.parametrize("way", WAYS)
def test_a_block_is_accelerated_by_f_over_m(way: tuple[str, str]):
    builder = free([(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.pressure((0, 0), (0, 1), 5e4)
    run = run_of(builder, way, end=0.2, step=2e-3)
    speed = 5e4 / (DENSITY * 2.0) * 0.2
    # the face is longer by the strain, 5e4 Pa/1e10 Pa
    assert run.final.velocity[0, 0] == pytest.approx(speed, rel=1e-5)
    assert np.abs(run.final.velocity[0, 1:3]).max() < 1e-9 * speed
    assert run.report.ledger.loads == pytest.approx(5e4 * 0.5 * speed * 0.2, rel=1e-4)
    assert_closed(run)


@pytest.mark.parametrize("way", WAYS)
def test_uniform_pressure_on_all_faces_only_compresses(way: tuple[str, str]):
    corners = np.array([(0.0, 0.0), (2.0, 0.3), (2.4, 1.6), (1.1, 2.2), (-0.3, 1.2)])
    builder = free([tuple(corner) for corner in corners])
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        builder.pressure(end, start, 3e5)  # whichever way the line goes
    run = run_of(builder, way, end=1.0, step=1e-2, dynamic_ratio=0.0)
    # stress is per area at the start (decision 3), pressure acts on the outline as it is
    shrunk = area_and_centroid(run.final.vertices)[0] / area_and_centroid(corners)[0]
    exact = np.array([-3e5, -3e5, 0.0]) * shrunk
    np.testing.assert_allclose(run.final.stress[0], exact, atol=1e-9 * 3e5)
    assert shrunk == pytest.approx(1.0, abs=1e-4)
    strain = exact[0] * (1.0 - 0.2) / 1e10  # plane stress
    moved = run.final.vertices - run.model.vertices
    affine = strain * (corners - area_and_centroid(corners)[1])
    # strains of steps add up, each of the outline as it then is: of the strain squared
    np.testing.assert_allclose(moved, affine, atol=3.0 * strain**2)
    rigid = area_and_centroid(run.final.vertices)[1] - area_and_centroid(corners)[1]
    assert np.abs(rigid).max() < 1e-9
    assert abs(run.final.rotation[0]) < 1e-9
    assert_closed(run)


def area_and_centroid(corners: Floats) -> tuple[float, Floats]:
    """Return area and centroid of a polygon by its triangles."""
    first, second = corners[1:-1] - corners[0], corners[2:] - corners[0]
    double = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    moment = (double[:, None] * (first + second)).sum(axis=0) / 3.0
    return 0.5 * double.sum(), corners[0] + moment / double.sum()


SPIN, PUSH, END = 2.0, np.array([9e3, 3e3]), 1.0


def turning(steps: int, way: tuple[str, str]) -> clast.Run:
    """A square that turns, with a linear pressure on the face that is its bottom at the start."""
    builder = free(turned_square(0.3), velocity=(0.0, 0.0, SPIN))
    bottom = turned_square(0.3)[:2]
    builder.pressure(*bottom, PUSH.tolist())
    return run_of(builder, way, end=END, step=END / steps, rotation="exact")


def integrated() -> Floats:
    """Return centroid, angle and their rates at the end of the same rigid square, by scipy."""
    mass, inertia = DENSITY, DENSITY / 6.0
    force, moment = PUSH.mean(), np.diff(PUSH)[0] / 12.0  # of the face of 1 m, upwards at 0

    def rates(_: float, y: Floats) -> Floats:
        angle = 0.3 + y[2]
        push = force * np.array([-np.sin(angle), np.cos(angle)]) / mass
        return np.array([*y[3:], *push, moment / inertia])

    start = [0.0, 0.0, 0.0, 0.0, 0.0, SPIN]
    return solve_ivp(rates, (0.0, END), start, rtol=1e-11, atol=1e-13).y[:, -1]


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
def test_a_turning_block_keeps_the_pressure_normal(way: tuple[str, str]):
    exact = integrated()
    errors = []
    for steps in (100, 200):
        run = turning(steps, way)
        at = run.final.vertices.mean(axis=0) - run.model.vertices.mean(axis=0)
        found = np.array([*at, run.final.rotation[0], *run.final.velocity[0, :3]])
        errors.append(np.abs(found - exact))
        assert_closed(run)
    way_of_it, speed = np.hypot(*exact[:2]), np.hypot(*exact[3:5])
    # the edge lies as it does halfway through the step: of second order, 4e-5 at 100 steps
    assert errors[0][:2].max() < 1e-4 * way_of_it
    assert errors[0][3:5].max() < 1e-4 * speed
    # the moment does not depend on how the block lies, so that the angle is exact
    assert errors[0][[2, 5]].max() < 1e-6 * exact[2]
    for k in (0, 1, 3, 4):
        assert errors[1][k] == pytest.approx(0.25 * errors[0][k], rel=0.1)


def test_a_pressure_on_a_part_of_an_edge_stays_there():
    """On a third of a face it turns the block: angular acceleration M/I about the centroid."""
    builder = free([(0, 0), (3, 0), (3, 3), (0, 3)])
    builder.pressure((0, 0), (1, 0), 1e3)
    run = run_of(builder, WAYS[0], end=0.1, step=1e-3)
    inertia = DENSITY * 9.0 * (9.0 + 9.0) / 12.0
    assert run.final.velocity[0, 2] == pytest.approx(-1e3 / inertia * 0.1, rel=1e-4)
    assert run.final.velocity[0, 1] == pytest.approx(1e3 / (DENSITY * 9.0) * 0.1, rel=1e-4)


def test_several_blocks_along_a_line_have_their_parts_of_it():
    """The pressure is linear along the line from 0 at its start, over edges of both directions."""
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=1e10, poisson=0.2, density=DENSITY)
    builder.block(name="a", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="b", vertices=[(1, 0), (4, 0), (4, 1), (2, 1), (1, 1)])
    builder.pressure((0.5, 1), (3, 1), [0.0, 5.0])
    model = builder.build()
    loads = model.pressures
    assert [model.block_name[block] for block in loads.block] == ["a", "b", "b"]
    first = model.vertices[loads.edge]
    last = model.vertices[[3, 7, 8]]
    ends = first[:, None] + loads.share[:, :, None] * (last - first)[:, None]
    np.testing.assert_allclose(ends[:, :, 1], 1.0)
    np.testing.assert_allclose(loads.pressure, 2.0 * (ends[:, :, 0] - 0.5), atol=1e-12)
    assert np.ptp(ends[:, :, 0], axis=1).sum() == pytest.approx(2.5)
    assert model.notes == ()


def test_a_line_that_leaves_the_edges_is_noted():
    builder = free([(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.pressure((0, 0), (0, 4), 1e3)
    (note,) = builder.build().notes
    assert "pressure 1 is 4 m long" in note
    assert "only 1 m" in note


def test_tractions_in_situ_are_stress_times_normal():
    """Those of Cauchy: sigma n."""
    random = np.random.default_rng(3)
    stress = random.normal(size=(20, 3))
    angle = random.uniform(0.0, 2.0 * np.pi, 20)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    exact = [
        np.array([[xx, xy], [xy, yy]]) @ n for (xx, yy, xy), n in zip(stress, normal, strict=True)
    ]
    np.testing.assert_allclose(tractions(stress, normal), exact, rtol=1e-14)
