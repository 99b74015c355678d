"""Contact memory: found again by vertex and block, moved along to the next edge, never doubled."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from clast.contact.contacts import ContactResponse
from clast.contact.joints.wear import at_rest
from clast.contact.memory import first_rows, memory_order, recall, renew
from scenes.corners import memory_of
from scenes.systems import at_start, box, contacts_of, march, method, system

KEY = st.tuples(st.integers(0, 3), st.integers(0, 2))
ROW = st.tuples(KEY, st.integers(0, 4))


def rows_of(rows):
    """Return the memory of {((vertex, block), edge)}, sorted as the state keeps it."""
    table = np.array([[*key, edge] for key, edge in sorted(rows)], np.int64).reshape(-1, 3)
    return memory_of(*table.T, np.zeros(len(table)), shear_force=np.arange(len(table)) + 1.0)


@given(rows=st.lists(st.tuples(*[st.integers(0, 3)] * 4), unique=True, max_size=20))
def test_the_memory_has_vertices_before_points_of_faces(rows):
    vertex, block, edge, point = np.array(rows, np.int64).reshape(-1, 4).T.copy()
    corners, inside = np.flatnonzero(point == 0).tolist(), np.flatnonzero(point).tolist()
    corners.sort(key=lambda row: (vertex[row], block[row], edge[row]))
    inside.sort(key=lambda row: (vertex[row], edge[row], point[row]))
    assert memory_order(vertex, block, edge, point).tolist() == corners + inside


@given(remembered=st.sets(ROW, max_size=14), found=st.sets(ROW, max_size=14), data=st.data())
def test_rows_are_found_by_edge_first_then_by_key(remembered, found, data):
    memory = rows_of(remembered)
    keys = data.draw(st.permutations(sorted({key for key, _ in found})))
    # the contacts of one vertex and block stand together, in any order
    contacts = [one for key in keys for one in sorted(found) if one[0] == key]
    table = np.array([[*key, edge] for key, edge in contacts], np.int64).reshape(-1, 3)
    columns = [np.ascontiguousarray(column) for column in table.T]
    count = 1 + max([vertex for (vertex, *_), _ in [*remembered, *found]], default=-1)
    rows = recall(tuple(columns), (first_rows(memory.vertex, count), memory.block, memory.edge))
    known = rows[rows >= 0]
    assert len(set(known)) == len(known)  # no row is given twice
    remembered_rows = sorted(remembered)
    for (key, edge), row in zip(contacts, rows, strict=True):
        if row >= 0:
            assert remembered_rows[row][0] == key
        if (key, edge) in remembered:
            assert remembered_rows[row] == (key, edge)
    for key in keys:
        mine = [row for one, row in zip(contacts, rows, strict=True) if one[0] == key]
        held = sum(one[0] == key for one in remembered)
        assert sum(row >= 0 for row in mine) == min(len(mine), held)


def response_for(contacts, gap, shear_force, mode):
    count = len(contacts)
    zero = np.zeros(count)
    return ContactResponse(
        normal_force=np.maximum(0.0, -1e8 * gap),
        shear_force=shear_force,
        normal_stiffness=zero,
        shear_stiffness=zero,
        coupling=zero,
        mode=mode,
        bonded=np.ones(count, np.bool_),
        energy=zero,
        dissipation=zero,
    )


def test_renewed_memory_is_sorted_and_forgets_what_has_opened():
    contacts = contacts_of(system([box(0, 0), box(0.5, 1), box(-0.5, 1), box(0, 2)]))
    count = len(contacts)
    rng = np.random.default_rng(2)
    gap = rng.uniform(-0.01, 0.01, count)
    mode = np.where(gap < 0.0, 2, 0)
    answer = response_for(contacts, gap, np.arange(count) + 1.0, mode)
    memory = renew(contacts, answer, gap, 1e-3 * gap, 0.005, at_rest(contacts))
    keys = list(zip(memory.vertex, memory.block, memory.edge, strict=True))
    assert keys == sorted(keys)
    assert len(set(keys)) == count
    known = first_rows(memory.vertex, 16), memory.block, memory.edge
    row = recall((contacts.vertex, contacts.edge_block, contacts.edge), known)
    assert np.array_equal(np.sort(row), np.arange(count))
    assert np.array_equal(memory.gap[row], gap)
    assert np.array_equal(memory.shear_force[row], np.where(gap < 0.0, np.arange(count) + 1.0, 0.0))
    assert np.array_equal(memory.bonded[row], gap <= 0.005)
    # bonded at the start: slip adds up from the first step on
    assert np.array_equal(memory.slip[row], 1e-3 * gap)


def test_detection_hands_the_memory_to_the_same_contacts_whatever_their_order():
    model = system([box(0, 0, 3), box(0.5, 1), box(1.6, 1)], fixed=[0], friction_angle=30.0)
    contacts = contacts_of(model)
    gap = -1e-6 * (1.0 + np.arange(len(contacts)))
    force = 10.0 * (1.0 + np.arange(len(contacts)))
    response = response_for(contacts, gap, force, np.full(len(contacts), 1))
    state = replace(
        at_start(model),
        memory=renew(contacts, response, gap, 0.0 * gap, 0.005, at_rest(contacts)),
        time=1.0,
    )
    again = contacts_of(model, state)
    assert again.known.all()
    assert np.array_equal(again.shear_force, force)
    assert np.array_equal(again.normal_force, response.normal_force)
    assert np.array_equal(again.mode, response.mode)


def test_memory_moves_along_as_a_block_slides_over_a_flat_corner():
    """A brick slides over a seam in its base's top: the friction force never starts anew."""
    base = np.array([[0, 0], [4, 0], [4, 1], [2, 1], [0, 1]], float)
    model = system(
        [base, box(0.9, 1.0)], fixed=[0], velocity={1: (1.0, 0.0, 0.0)}, friction_angle=20.0
    )
    rough = method(max_displacement=0.02)
    results = march(model, rough, 2e-3, 0.25)
    crossed = set()
    for before, after in pairwise(results[50:]):
        one, two = before.state.memory, after.contacts
        pressed = {key for key, n in zip(keys_of(one), one.normal_force, strict=True) if n > 0.0}
        for vertex, edge, known, force in zip(
            two.vertex, two.edge, two.known, two.normal_force, strict=True
        ):
            if (vertex, 0) in pressed:
                assert known
                assert force > 0.0
                crossed.add((int(vertex), int(edge)))
    right_corner = {edge for vertex, edge in crossed if vertex == 5 + 1}
    assert right_corner == {2, 3}


def keys_of(memory):
    return zip(memory.vertex.tolist(), memory.block.tolist(), strict=True)
