"""What contacts are in the equations: by offsets alone, against the rows that a basis gives."""

from dataclasses import dataclass, field, fields

import numpy as np
import pytest

from clast.block.displacement import FirstOrder
from clast.contact.corner_rules import Bisector
from clast.contact.detection import detect
from clast.linear import assembly
from clast.linear.system import contact_motions, graph_of, with_contact_forces
from systems import (
    REACH,
    at_start,
    by_convex,
    centroids,
    heap,
    march,
    system,
    turned,
    voussoirs,
    wall,
)


@dataclass(frozen=True)
class ByBasis:
    """The first-order function with nothing but what a displacement function must have."""

    function: FirstOrder = field(default_factory=FirstOrder)

    def basis(self, offset):
        return self.function.basis(offset)

    def mass_matrix(self, mass, moments):
        """By integrating T^T T: the basis is linear in x and y."""
        unit = self.basis(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
        one, x, y = unit[0], unit[1] - unit[0], unit[2] - unit[0]
        sxx, syy, sxy = (moments[:, k, None, None] for k in range(3))
        cross = x.T @ y
        return mass[:, None, None] * (one.T @ one) + (
            sxx * (x.T @ x) + syy * (y.T @ y) + sxy * (cross + cross.T)
        )

    def place(self, offset, displacement):
        return self.function.place(offset, displacement)

    def turn(self, displacement):
        return self.function.turn(displacement)


SYSTEMS = {
    "wall": wall(4, 4),
    "heap": heap(12, 4),
    "arch": system([turned(one, 0.3) for one in voussoirs(9)], fixed=[0, 8]),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_both_paths_find_the_same_contacts(name):
    model = SYSTEMS[name]
    state = at_start(model)
    drift = np.random.default_rng(1).normal(0.0, 2e-3, (model.block_count, 6))
    one, other = (
        detect(model, Bisector(), function, state, centroids(model, state), REACH, drift)
        for function in (FirstOrder(), ByBasis())
    )
    assert len(one) > 0 or name == "heap"
    assert one.levers.shape == (len(one), 6)
    assert other.levers.shape == (len(one), 4, 6)
    np.testing.assert_allclose(one.rows, other.rows, rtol=1e-13, atol=1e-15)
    for column in fields(one):
        if column.name == "levers":
            continue
        here, there = getattr(one, column.name), getattr(other, column.name)
        assert here.dtype == there.dtype
        np.testing.assert_allclose(here, there, rtol=1e-13, atol=1e-15, err_msg=column.name)


@pytest.mark.parametrize("name", SYSTEMS)
def test_both_paths_make_the_same_equations(name):
    """Matrix, motions and forces of contacts with arbitrary stiffnesses, some of them 0."""
    model = SYSTEMS[name]
    state = at_start(model)
    rng = np.random.default_rng(2)
    drift = rng.normal(0.0, 2e-3, (model.block_count, 6))
    found = []
    for function in (FirstOrder(), ByBasis()):
        rng = np.random.default_rng(3)
        contacts = detect(model, Bisector(), function, state, centroids(model, state), REACH, drift)
        graph = graph_of(contacts, model.block_count)
        base = np.zeros((model.block_count, 6, 6))
        kn, ks, normal, shear = rng.normal(size=(4, len(contacts))) * (
            rng.random(len(contacts)) < 0.8
        )
        own, upper = np.empty_like(base), np.empty((len(contacts.pairs), 6, 6))
        springs = graph, contacts.vertex_block, contacts.levers, kn, ks
        coupled, _, _ = assembly.assemble(base, model.fixed, contacts.pairs, *springs, own)
        assembly.assemble_couplings(coupled, *springs, upper)
        motions = contact_motions(contacts, drift)
        forces = with_contact_forces(drift, contacts, graph, model.fixed, normal, shear)
        found.append((own, upper, *motions, forces))
    for here, there in zip(*found, strict=True):
        scale = np.abs(here).max(initial=1.0)
        np.testing.assert_allclose(here, there, rtol=0.0, atol=1e-14 * scale)


@pytest.mark.parametrize("name", SYSTEMS)
def test_both_paths_go_the_same_way(name):
    """Twenty steps of 5 ms: round-off is all that differs."""
    model = SYSTEMS[name]
    ways = [
        march(model, by_convex(1e8, displacement=function), 5e-3, 0.1)[-1].state.vertices
        for function in (FirstOrder(), ByBasis())
    ]
    assert ways[0] == pytest.approx(ways[1], abs=1e-9)


def test_mass_matrices_agree():
    mass, moments = np.array([3.0, 0.7]), np.array([[2.0, 1.5, 0.4], [0.1, 0.3, -0.05]])
    wanted = ByBasis().mass_matrix(mass, moments)
    assert FirstOrder().mass_matrix(mass, moments) == pytest.approx(wanted, rel=1e-14)
