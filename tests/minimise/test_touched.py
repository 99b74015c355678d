"""Blocks that nothing touches go by themselves; the others come to the same as with them."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.laws import AugmentedLagrangian
from clast.minimise import touched
from clast.step import convex
from clast.studies.bench.scenes import heap
from scenes.sliding import sliding
from scenes.systems import box, by_convex, march

END = 0.3
"""End of short runs, s: the lowest squares of a heap have landed."""


def falling():
    """Return blocks of which most fall, some land and slide, and some rest."""
    ground = box(-1.0, -1.0, 40.0, 1.0)
    resting = [box(2.0 * k, 0.0) for k in range(6)]
    flying = [box(1.5 * k, 5.0 + (k % 3)) for k in range(60)]
    return sliding([ground, *resting, *flying])


def test_a_part_has_all_contacts_and_no_block_without(monkeypatch):
    parted, wholes = 0, []
    usual = touched.touched_part

    def watched(potential):
        wholes.append(potential)
        return usual(potential)

    monkeypatch.setattr(convex, "touched_part", watched)
    march(heap(120, 12), replace(by_convex(5e9), max_displacement=0.1), 2.5e-3, 0.3)
    for one in wholes:
        part = usual(one)
        known = np.zeros(len(one.fixed), bool)
        known[one.contacts.pairs.ravel()] = True
        share = np.count_nonzero(known & ~one.fixed) / np.count_nonzero(~one.fixed)
        if part is None:
            assert share == 0.0 or share > touched.MOST
            continue
        parted += 1
        assert share <= touched.MOST
        assert np.array_equal(part.contacts, np.arange(len(one.contacts)))
        assert np.array_equal(part.blocks, np.flatnonzero(known))
        assert np.array_equal(part.potential.fixed, one.fixed[part.blocks])
        back = touched.as_numbered(part.potential.contacts, one.contacts)
        for name, value in vars(one.contacts).items():
            assert np.array_equal(getattr(back, name), value, equal_nan=True), name
    assert parted > 3


@pytest.mark.parametrize("multipliers", [False, True])
@pytest.mark.parametrize("build", [falling, lambda: heap(120, 12)], ids=["falling", "heap"])
def test_the_same_as_with_all_blocks(monkeypatch, build, multipliers):
    how = replace(by_convex(5e8), max_displacement=0.1)
    if multipliers:
        how = replace(how, contact_law=AugmentedLagrangian(normal_stiffness=5e8))
    parted = []
    usual = touched.touched_part

    def watched(potential):
        parted.append(usual(potential) is not None)
        return usual(potential)

    monkeypatch.setattr(convex, "touched_part", watched)
    ours = march(build(), how, 2.5e-3, END)
    monkeypatch.setattr(convex, "touched_part", lambda _: None)
    wanted = march(build(), how, 2.5e-3, END)
    assert any(parted)
    assert len(ours) == len(wanted)
    for one, other in zip(ours, wanted, strict=True):
        assert one.state.vertices == pytest.approx(other.state.vertices, abs=2e-8)
        assert one.contacts.vertex.tolist() == other.contacts.vertex.tolist()
        assert one.contacts.edge_block.tolist() == other.contacts.edge_block.tolist()


def test_blocks_in_flight_fall_exactly():
    """To the bit as by themselves: no iteration has touched them."""
    last = march(falling(), by_convex(5e8), 2.5e-3, 0.05)[-1]
    alone = sliding([box(-1.0, -1.0, 40.0, 1.0), *[box(1.5 * k, 5.0 + (k % 3)) for k in range(60)]])
    other = march(alone, by_convex(5e8), 2.5e-3, 0.05)[-1]
    assert np.array_equal(last.state.vertices[-240:], other.state.vertices[-240:])
