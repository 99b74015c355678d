"""Works, energies and own terms of blocks, against the same sums written with numpy."""

import numpy as np
import pytest

from clast.block import equations as block_terms
from clast.block import equations as tensors
from clast.compute.reductions import SHARED
from clast.step import energy_balance as works
from clast.step.energy_balance import CHUNK, PART


def definite(rng, count, size):
    root = rng.normal(size=(count, size, size))
    return np.ascontiguousarray(root @ root.transpose(0, 2, 1) + np.eye(size))


def form(matrix, vector):
    return float(np.einsum("ni,nij,nj->", vector, matrix, vector))


@pytest.mark.parametrize("count", [1, CHUNK, 3 * CHUNK + 5])
def test_works_of_blocks(count):
    rng = np.random.default_rng(count)
    d, entering, leaving = rng.normal(size=(3, count, 6))
    mass_matrix, compliance = definite(rng, count, 6), definite(rng, count, 3)
    area = rng.uniform(0.5, 1.0, count)
    before, acting, after = rng.normal(size=(3, count, 3))
    step = 0.01
    found = works.energies_of_blocks(
        (d, entering, leaving),
        (mass_matrix, step),
        (before, acting, after),
        (area, compliance),
    )
    acceleration = (leaving - entering) / step
    weighed = area[:, None, None] * compliance
    wanted = [
        0.5 * form(mass_matrix, entering),
        0.5 * form(mass_matrix, leaving),
        float(np.einsum("ni,nij,nj->", d, mass_matrix, acceleration)),
        0.5 * form(weighed, before),
        0.5 * form(weighed, after),
        -float(np.sum(area[:, None] * acting * d[:, 3:])),
    ]
    assert found == pytest.approx(wanted, rel=1e-12, abs=1e-10)


@pytest.mark.parametrize("count", [0, 3, 2 * PART + 1])
def test_works_of_contacts(count):
    normal, shear, start, end, slip, energy, loss = np.random.default_rng(1).normal(size=(7, count))
    found = works.energies_of_contacts((normal, shear), (start, end), slip, (energy, loss))
    work = float(np.sum(normal * (end - start) + shear * slip))
    assert found == pytest.approx([work, energy.sum(), loss.sum()], rel=1e-12, abs=1e-10)


@pytest.mark.parametrize("count", [7, SHARED + 5])
def test_terms_of_blocks(count):
    rng = np.random.default_rng(2)
    mass_matrix, elasticity = definite(rng, count, 6), definite(rng, count, 3)
    area, mass = rng.uniform(1.0, 2.0, (2, count))
    drift, stress, factor = rng.normal(size=(count, 6)), rng.normal(size=(count, 3)), 1.7
    acceleration = np.array([0.5, -9.0])
    matrix, force, momentum = block_terms.terms(
        (mass_matrix, factor, drift),
        (area, elasticity),
        stress,
        mass,
        acceleration,
    )
    stiffness = factor * mass_matrix
    stiffness[:, 3:, 3:] += area[:, None, None] * elasticity
    moved = factor * np.einsum("nij,nj->ni", mass_matrix, drift)
    loads = np.zeros((count, 6))
    loads[:, :2] = mass[:, None] * acceleration
    loads[:, 3:] = -area[:, None] * stress
    assert matrix == pytest.approx(stiffness, rel=1e-13)
    assert momentum == pytest.approx(moved, rel=1e-12)
    assert force == pytest.approx(moved + loads, rel=1e-12)


def test_stress_follows_the_strain():
    rng, count = np.random.default_rng(3), 5
    elasticity, stress = definite(rng, count, 3), rng.normal(size=(count, 3))
    unknowns = rng.normal(size=(count, 6))
    wanted = stress + np.einsum("nij,nj->ni", elasticity, unknowns[:, 3:])
    assert tensors.strained(stress, elasticity, unknowns) == pytest.approx(wanted, rel=1e-12)


def test_turning_some_columns_leaves_the_others():
    velocity = np.random.default_rng(4).normal(size=(6, 6))
    found = tensors.turned(velocity, 3, np.full(6, 0.3), 2.0)
    assert np.array_equal(found[:, :3], velocity[:, :3])
    alone = tensors.turned(np.ascontiguousarray(velocity[:, 3:]), 0, np.full(6, 0.3), 2.0)
    assert np.array_equal(found[:, 3:], alone)
