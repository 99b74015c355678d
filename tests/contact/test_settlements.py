"""Surfaces are flush but for how far blocks were pressed down: the bound of that, and its end.

To add it up from block to block takes long where a fixed body has many contacts, so it is left out
where it cannot matter: at blocks that cannot move, and for surfaces farther away than any block has
been pressed down.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast.block.equations import strains
from clast.contact import flush_faces
from clast.contact.broad_phase import VerletList, near_pairs
from clast.contact.candidates import SearchDistance, find_candidates
from clast.run.schedule import Schedule
from clast.run.simulate import simulate

REACH = SearchDistance(front=0.02, depth=0.02, critdis=0.02)


@pytest.fixture(scope="module", params=["wall", "slope"])
def settled(request: Any) -> dict[str, Any]:
    """Return what candidates are found from, of blocks that have settled for some steps."""
    model = SCENES[request.param].build(40)
    method = method_for(model, BenchSettings(share=0.05))
    state = simulate(model, method, Schedule(step=5e-3, end=0.03, every=0.03)).state
    at = state.vertices, model.block_start
    return {
        "at": (*at, near_pairs(VerletList(), *at, model.fixed, 0.04), state.memory),
        "of_blocks": (strains(model.compliance, state.stress), model.fixed),
    }


def found(settled: dict[str, Any], fixed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return vertex and edge of the candidates of blocks of which some are ``fixed``."""
    strain, _ = settled["of_blocks"]
    one = find_candidates(*settled["at"], REACH, of_blocks=(strain, fixed))
    return one.vertex, one.edge


def test_the_blocks_are_pressed_into_each_other(settled):
    assert (settled["at"][3].gap < -1e-6).sum() > 20


def test_no_block_is_pressed_down_by_more_than_the_bound(settled, monkeypatch):
    """Without the bound the same edges are entrances."""
    fixed = settled["of_blocks"][1]
    bounded = found(settled, fixed)
    bound = flush_faces.largest_settlements
    most: list[np.ndarray] = []

    def none(*given: Any) -> np.ndarray:
        most.append(bound(*given))
        return np.where(given[2], 0.0, np.inf)

    monkeypatch.setattr(flush_faces, "largest_settlements", none)
    boundless = found(settled, fixed)
    assert (most[0][~fixed] > 0.0).all() and (most[0][fixed] == 0.0).all()
    assert all(np.array_equal(one, two) for one, two in zip(bounded, boundless, strict=True))


def test_that_the_ground_cannot_be_pressed_down_makes_no_difference(settled):
    fixed = settled["of_blocks"][1]
    one, two = found(settled, fixed), found(settled, np.zeros_like(fixed))
    assert all(np.array_equal(*both) for both in zip(one, two, strict=True))


def test_the_bound_is_that_of_all_blocks_below_one_another():
    box = np.array([[0.0, 0.0, 3.0, 1.0], [0.0, -1.0, 3.0, 0.0]])
    strain = np.array([[0.0, -1e-5, 0.0], [0.0, 0.0, 0.0]])
    most = flush_faces.largest_settlements(
        np.array([1e-3, -2e-4]), strain, np.array([False, True]), box
    )
    deepest = 2e-4 + 1e-5  # a penetration, and the shortening of one metre
    assert most[0] >= flush_faces.BLOCKS_BELOW_MAX * deepest
    assert most[0] <= 5.0 * flush_faces.BLOCKS_BELOW_MAX * deepest
    assert most[1] == 0.0
