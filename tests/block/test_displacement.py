"""The first-order displacement function: basis, mass matrix, placing, and the rotation rules."""

import numpy as np
import pytest

from clast.block import polygon
from clast.block.displacement import (
    basis,
    displacements,
    displacements_of,
    moved_to,
    movements,
    plus_transposed,
    powers_at,
    weighted_squares,
)
from clast.block.equations import turned as turned_tensor
from clast.block.inertia import frames_of
from clast.block.rotation import Exact, Linear, Sine
from clast.compute.jit import kernel
from clast.compute.vec6 import plus_scaled, put_row, row, zeros
from scenes.quadrature import integral
from scenes.systems import box, convex, flat, star, turned

RULES = {"exact": Exact(), "sine": Sine(), "linear": Linear()}


def points(count=20, seed=0):
    return np.random.default_rng(seed).uniform(-2.0, 2.0, (count, 2))


def place(rule, at, d):
    """Return points at offsets (k, 2) of a block each after its displacement d (k, 6)."""
    return at + movements(rule, at, d, np.arange(len(at)))


def unknowns(count, **values):
    """Return d (count, 6) with some of u, v, r, ex, ey, gxy set."""
    d = np.zeros((count, 6))
    for name, value in values.items():
        d[:, ("u", "v", "r", "ex", "ey", "gxy").index(name)] = value
    return d


# --- basis and mass ------------------------------------------------------------------------


@pytest.mark.parametrize("rule", RULES)
def test_basis_is_the_derivative_of_place_at_rest(rule):
    """Central differences leave an error of the second order in the step."""
    at, step = points(), 1e-5
    t = basis(at)
    for k in range(6):
        d = np.zeros((len(at), 6))
        d[:, k] = step
        slope = (place(RULES[rule], at, d) - place(RULES[rule], at, -d)) / (2.0 * step)
        assert slope == pytest.approx(t[:, :, k], abs=1e-9)


@pytest.mark.parametrize("count", [20, 5000])
def test_displacements_are_the_basis_times_the_unknowns(count):
    """Threads share the larger number of points."""
    at, rng = points(count), np.random.default_rng(1)
    d, block = rng.normal(size=(7, 6)), rng.integers(0, 7, count)
    wanted = np.einsum("kxi,ki->kx", basis(at), d[block])
    assert displacements(at, d, block) == pytest.approx(wanted, abs=1e-14)


@kernel()
def with_transposed(lines, x, y, two, result):
    k = row(lines, 0), row(lines, 1), row(lines, 2), row(lines, 3), row(lines, 4), row(lines, 5)
    k0, k1, k2, k3, k4, k5 = plus_transposed(k, x, y, row(two, 0), row(two, 1))
    put_row(result, 0, k0)
    put_row(result, 1, k1)
    put_row(result, 2, k2)
    put_row(result, 3, k3)
    put_row(result, 4, k4)
    put_row(result, 5, k5)


def test_two_lines_are_added_by_the_transposed_basis():
    rng = np.random.default_rng(3)
    lines, two, at = rng.normal(size=(6, 6)), rng.normal(size=(2, 6)), np.array([[0.7, -1.3]])
    result = np.empty((6, 6))
    with_transposed(lines, *at[0], two, result)
    assert result == pytest.approx(lines + basis(at)[0].T @ two, abs=1e-14)


@kernel()
def with_squares(at, matrices, result):
    xx, xy, yy = zeros(), zeros(), zeros()
    for k in range(len(at)):
        powers = powers_at(at[k, 0], at[k, 1])
        xx = plus_scaled(xx, matrices[k, 0, 0], powers)
        xy = plus_scaled(xy, matrices[k, 0, 1], powers)
        yy = plus_scaled(yy, matrices[k, 1, 1], powers)
    lines = weighted_squares(xx, xy, yy)
    put_row(result, 0, lines[0])
    put_row(result, 1, lines[1])
    put_row(result, 2, lines[2])
    put_row(result, 3, lines[3])
    put_row(result, 4, lines[4])
    put_row(result, 5, lines[5])


@pytest.mark.parametrize("count", [1, 7])
def test_squares_of_the_basis_are_weighted_by_symmetric_matrices(count):
    """Those of a contact have components along both axes and across, those of a mass do not."""
    at = points(count)
    half = np.random.default_rng(2).normal(size=(count, 2, 2))
    matrices, result = half @ half.transpose(0, 2, 1), np.zeros((6, 6))
    with_squares(at, matrices, result)
    t = basis(at)
    assert result == pytest.approx(np.einsum("kxi,kxy,kyj->ij", t, matrices, t), abs=1e-13)


@pytest.mark.parametrize("rule", RULES)
def test_places_are_reached_from_where_points_are(rule):
    """What a step uses, to the last digit: offsets from the centroids are taken on the way."""
    rng = np.random.default_rng(4)
    at, centroid, d = points(), rng.normal(size=(3, 2)), 0.1 * rng.normal(size=(3, 6))
    block = rng.integers(0, 3, len(at))
    offset = at - centroid[block]
    reached = moved_to(at, block, centroid, d, RULES[rule].gradient(d))
    assert np.array_equal(reached, at + movements(RULES[rule], offset, d, block))
    assert np.array_equal(displacements_of(at, block, centroid, d), displacements(offset, d, block))


@pytest.mark.parametrize("rule", RULES)
def test_no_displacement_leaves_every_bit(rule):
    at = points()
    assert np.array_equal(place(RULES[rule], at, np.zeros((len(at), 6))), at)


@pytest.mark.parametrize("seed", range(8))
def test_mass_matrix_is_the_integral_of_the_basis(seed):
    rng = np.random.default_rng(seed)
    outlines = [convex(rng, 5), star(rng, 8), box(1.0, 2.0, 3.0, 0.5)]
    flats = flat(outlines)
    density, area = 2700.0, polygon.moments(flats.vertices, flats.start)[0]
    _, centroid, mass = frames_of(flats.vertices, flats.start, density * area)
    for k, one in enumerate(outlines):

        def products(at, middle=centroid[k]):
            t = basis(at - middle)
            return np.einsum("pxi,pxj->pij", t, t).reshape(len(at), 36)

        wanted = density * integral(one, products).reshape(6, 6)
        assert mass[k] == pytest.approx(wanted, rel=1e-9, abs=1e-9 * density)
        assert np.array_equal(mass[k], mass[k].T)
        assert np.linalg.eigvalsh(mass[k]).min() > 0.0


# --- rotation ------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [1e-6, 0.01, 0.3, -0.5])
@pytest.mark.parametrize("rule", ["exact", "sine"])
def test_exact_and_sine_turn_rigidly(rule, angle):
    at = points()
    unknown = angle if rule == "exact" else np.sin(angle)
    placed = place(RULES[rule], at, unknowns(len(at), r=unknown, u=0.3, v=-0.2))
    assert placed == pytest.approx(turned(at, angle, (0.3, -0.2)), abs=1e-14)
    assert RULES[rule].angle(np.array([unknown])) == pytest.approx([angle], abs=1e-15)


def test_rules_agree_to_first_order():
    """Halving the angle quarters the distance between any two of them."""
    at = points()

    def spread(angle):
        placed = [place(rule, at, unknowns(20, r=angle)) for rule in RULES.values()]
        return max(np.abs(one - placed[0]).max() for one in placed)

    assert spread(1e-3) / spread(5e-4) == pytest.approx(4.0, rel=1e-3)


def test_strain_alone_is_the_same_under_all_rules():
    at, strain = points(), {"ex": 1e-3, "ey": -2e-3, "gxy": 5e-4}
    x, y = at.T
    wanted = at + np.stack([1e-3 * x + 2.5e-4 * y, 2.5e-4 * x - 2e-3 * y], axis=1)
    for rule in RULES.values():
        assert place(rule, at, unknowns(20, **strain)) == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize(
    ("rule", "drift"), [("linear", 1.0001**1000 - 1.0), ("exact", 0.0), ("sine", 0.0)]
)
def test_area_of_a_spinning_block(rule, drift):
    """0.01 rad a step, 1000 steps: linear rotation grows the area by 1 + r^2 a step, 10.5 %."""
    outline = star(np.random.default_rng(1), 6)
    start = np.array([0, len(outline)])
    unknown = np.sin(0.01) if rule == "sine" else 0.01
    step = unknowns(len(outline), r=unknown)
    first, centroid, _ = polygon.moments(outline, start)
    moving = outline
    for _ in range(1000):
        middle = polygon.moments(moving, start)[1][0]
        moving = middle + place(RULES[rule], moving - middle, step)
    area, last, _ = polygon.moments(moving, start)
    assert area[0] / first[0] - 1.0 == pytest.approx(drift, abs=1e-10)
    assert last == pytest.approx(centroid, abs=1e-11)
    print(f"{rule}: area drift {area[0] / first[0] - 1.0:.3g}")
    if rule != "linear":
        assert moving - centroid == pytest.approx(turned(outline - centroid, 10.0), abs=1e-11)


def test_exact_rule_strains_before_it_turns():
    """The area changes by det(I + strain), whatever the rotation."""
    outline = star(np.random.default_rng(2), 7)
    start = np.array([0, len(outline)])
    area, centroid, _ = polygon.moments(outline, start)
    d = unknowns(len(outline), r=0.4, ex=0.02, ey=-0.01, gxy=0.03, u=3.0)
    moved = place(Exact(), outline - centroid, d)
    determinant = (1.0 + 0.02) * (1.0 - 0.01) - 0.015**2
    assert polygon.moments(moved, start)[0] == pytest.approx(determinant * area, rel=1e-13)


def test_sine_beyond_one_is_no_rotation():
    assert np.isnan(Sine().angle(np.array([1.5]))).all()
    assert np.isnan(Sine().gradient(unknowns(1, r=1.5))).any()


# --- tensors -------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.1, -0.7, 2.0])
def test_stress_turns_as_a_matrix(angle):
    stress = np.random.default_rng(0).normal(size=(10, 3))
    found = turned_tensor(stress, 0, np.full(10, angle), 1.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for one, other in zip(stress, found, strict=True):
        matrix = np.array([[one[0], one[2]], [one[2], one[1]]])
        wanted = turn @ matrix @ turn.T
        assert other == pytest.approx([wanted[0, 0], wanted[1, 1], wanted[0, 1]])


def test_invariants_of_stress_and_work_of_strain_survive_rotation():
    rng = np.random.default_rng(5)
    stress, strain = rng.normal(size=(2, 50, 3))
    angle = rng.uniform(-3.0, 3.0, 50)
    new_stress, new_strain = (
        turned_tensor(stress, 0, angle, 1.0),
        turned_tensor(strain, 0, angle, 2.0),
    )

    def trace_and_determinant(tensor):
        xx, yy, xy = tensor.T
        return np.stack([xx + yy, xx * yy - xy**2])

    assert trace_and_determinant(new_stress) == pytest.approx(trace_and_determinant(stress))
    # with engineering shear sigma . eps is a scalar product
    assert np.sum(new_stress * new_strain, axis=1) == pytest.approx(np.sum(stress * strain, axis=1))
    assert turned_tensor(new_stress, 0, -angle, 1.0) == pytest.approx(stress)
