"""The contact Jacobian against T written out in NumPy: rows, motions, forces and stiffness."""

import numpy as np
import pytest

from clast.contact.corner_rules import Bisector
from clast.contact.detection import detect
from clast.linear import assembly
from clast.linear.system import contact_motions, graph_of, with_contact_forces
from scenes.systems import REACH, at_start, centroids, heap, system, turned, voussoirs, wall

SYSTEMS = {
    "wall": wall(4, 4),
    "heap": heap(12, 4),
    "large wall": wall(30, 35),
    "arch": system([turned(one, 0.3) for one in voussoirs(9)], fixed=[0, 8]),
}
"""The large one has so many blocks and contacts that threads share them."""


@pytest.fixture(params=SYSTEMS)
def found(request):
    """Return model and contacts, of moving blocks so that some are still open."""
    model = SYSTEMS[request.param]
    state = at_start(model)
    drift = np.random.default_rng(1).normal(0.0, 2e-3, (model.block_count, 6))
    contacts = detect(model, Bisector(), state, centroids(model, state), REACH, drift)
    assert len(contacts) > 0 or request.param == "heap"
    return model, contacts


def t_at(offset):
    """Return T (k, 2, 6) at offsets (k, 2), as Shi (1988) writes it."""
    x, y = offset.T
    one, none = np.ones_like(x), np.zeros_like(x)
    lines = [one, none, -y, x, none, y / 2.0], [none, one, x, none, y, x / 2.0]
    return np.stack([np.stack(line, axis=1) for line in lines], axis=1)


def jacobian(contacts):
    """Return n_i, n_j, t_i and t_j (m, 4, 6) of the contacts."""
    normal = contacts.arms[:, :2]
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    i, j = t_at(contacts.arms[:, 2:4]), -t_at(contacts.arms[:, 4:])
    parts = [np.einsum("mxk,mx->mk", t, e) for e in (normal, tangent) for t in (i, j)]
    return np.stack(parts, axis=1)


def test_rows_are_t_times_normal_and_tangent(found):
    _, contacts = found
    assert contacts.arms.shape == (len(contacts), 6)
    np.testing.assert_allclose(contacts.rows, jacobian(contacts), rtol=1e-13, atol=1e-15)


def test_offsets_are_those_of_vertex_and_foot_from_the_centroids(found):
    model, contacts = found
    state = at_start(model)
    centroid = centroids(model, state)
    vertex = state.vertices[contacts.vertex] - centroid[contacts.vertex_block]
    np.testing.assert_allclose(contacts.arms[:, 2:4], vertex, atol=1e-14)
    foot = contacts.foot - centroid[contacts.edge_block]
    np.testing.assert_allclose(contacts.arms[:, 4:], foot, atol=1e-14)


def test_motions_and_forces(found):
    model, contacts = found
    rng, rows = np.random.default_rng(2), jacobian(contacts)
    i, j = contacts.vertex_block, contacts.edge_block
    d = rng.normal(size=(model.block_count, 6))
    opening, slip = contact_motions(contacts, d)
    for motion, k in ((opening, 0), (slip, 2)):
        wanted = np.sum(rows[:, k] * d[i] + rows[:, k + 1] * d[j], axis=1)
        np.testing.assert_allclose(motion, wanted, rtol=0.0, atol=1e-13)
    normal, shear = rng.normal(size=(2, len(contacts)))
    wanted = d.copy()
    np.add.at(wanted, i, normal[:, None] * rows[:, 0] + shear[:, None] * rows[:, 2])
    np.add.at(wanted, j, normal[:, None] * rows[:, 1] + shear[:, None] * rows[:, 3])
    wanted[model.fixed] = 0.0
    graph = graph_of(contacts, model.block_count)
    force = with_contact_forces(d, contacts, graph, model.fixed, normal, shear)
    np.testing.assert_allclose(force, wanted, rtol=0.0, atol=1e-12)


def test_stiffness_of_links(found):
    """K_ii and K_ij of contacts with arbitrary stiffnesses, some of them 0."""
    model, contacts = found
    rng, rows, count = np.random.default_rng(3), jacobian(contacts), model.block_count
    kn, ks = rng.normal(size=(2, len(contacts))) * (rng.random(len(contacts)) < 0.8)
    base = rng.normal(size=(count, 6, 6))
    graph = graph_of(contacts, count)
    springs = contacts.vertex_block, contacts.arms, kn, ks
    own, upper = assembly.assemble(base, model.fixed, contacts.pairs, graph, springs)
    wanted_own, wanted_upper = base.copy(), np.zeros_like(upper)
    ends = contacts.vertex_block, contacts.edge_block
    for a in range(2):
        for b in range(2):
            part = np.einsum("m,mi,mj->mij", kn, rows[:, a], rows[:, b])
            part += np.einsum("m,mi,mj->mij", ks, rows[:, 2 + a], rows[:, 2 + b])
            if a == b:
                np.add.at(wanted_own, ends[a], part)
            else:
                first = ends[a] < ends[b]
                np.add.at(wanted_upper, contacts.pair[first], part[first])
    free = ~model.fixed
    np.testing.assert_allclose(own[free], wanted_own[free], rtol=0.0, atol=1e-13)
    between = free[contacts.pairs].all(axis=1)
    np.testing.assert_allclose(upper[between], wanted_upper[between], rtol=0.0, atol=1e-13)
    assert not upper[~between].any()
