"""What the kernels of a step cost on a wall of 1,000 bricks.

    pytest tests/benchmarks --benchmark-enable --benchmark-autosave
    pytest tests/benchmarks --benchmark-enable --benchmark-compare

Otherwise each runs once, as a test: nothing here asserts a time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from benchmarks.memory import system_of_step
from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast.block import polygon
from clast.contact import broad_phase
from clast.contact.broad_phase import VerletList, near_pairs
from clast.contact.candidates import SearchDistance, find_candidates
from clast.contact.contacts import Contacts
from clast.linear import block_matrix as block_rows
from clast.linear import pcg
from clast.linear.block_matrix import coupled_pairs
from clast.linear.coarse_space import aggregates_of
from clast.linear.pattern import Patterns
from clast.linear.solvers import SHIFT, TRIED, Attempt
from clast.linear.system import BlockSystem, graph_of, symmetric_system
from clast.minimise.strategy import SmallIslands
from clast.model.model import Ints, Model
from clast.model.state import State
from clast.step.method import Method
from clast.step.start import begin, diagonal_terms
from scenes.potentials import at_rest, caught, tolerance_of, work
from scenes.systems import at_start

STEP = 1e-3


@dataclass(frozen=True)
class Standing:
    """A wall that has settled on its contacts, and the contacts that it had just before."""

    model: Model
    method: Method
    state: State
    contacts: Contacts
    system: BlockSystem
    near: VerletList

    @property
    def reach(self) -> SearchDistance:
        limit = self.method.critdis + 2.0 * self.method.max_displacement
        return SearchDistance(front=limit, depth=limit, critdis=self.method.critdis)

    @property
    def pairs(self) -> Ints:
        around = self.reach.front + self.reach.critdis
        model = self.model
        return near_pairs(self.near, self.state.vertices, model.block_start, model.fixed, around)


@pytest.fixture(scope="module")
def wall() -> Standing:
    model = SCENES["wall"].build(1000)
    method = method_for(model, BenchSettings(step=STEP))
    first = method.process.step(model, method, at_start(model), STEP)
    result = method.process.step(model, method, first.state, STEP)
    system = system_of_step(model, method, result.state, STEP)
    assert system is not None
    return Standing(model, method, result.state, result.contacts, system, VerletList())


def test_broad_phase(benchmark, wall):
    box = polygon.boxes(wall.state.vertices, wall.model.block_start)
    broad_phase.widen(box, np.full(len(box), wall.reach.front))
    pairs = benchmark(broad_phase.overlapping_pairs, box, wall.model.fixed)
    assert len(pairs) > 2 * wall.model.block_count


def test_near_pairs_that_are_known(benchmark, wall):
    pairs = benchmark(lambda: wall.pairs)
    assert len(pairs) > 2 * wall.model.block_count


def test_narrow_phase(benchmark, wall):
    model, state, pairs = wall.model, wall.state, wall.pairs
    found = benchmark(
        find_candidates, state.vertices, model.block_start, pairs, state.memory, wall.reach
    )
    assert len(found.vertex) >= len(wall.contacts)


def test_law(benchmark, wall):
    gap, slip = wall.contacts.gap, np.zeros(len(wall.contacts))
    response = benchmark(wall.method.contact_law.respond, wall.contacts, gap, slip)
    assert (response.normal_force > 0.0).any()


def test_assembly(benchmark, wall):
    model, method = wall.model, wall.method
    contacts = replace(wall.contacts, friction_base=wall.contacts.normal_force)
    context = begin(model, method, wall.state, STEP, None)
    base = diagonal_terms(context, context.drift, context.scheme)
    response = method.contact_law.respond(contacts, contacts.gap, np.zeros(len(contacts)))
    graph = graph_of(contacts, model.block_count)
    system = benchmark(symmetric_system, base, contacts, response, base.force, model.fixed, graph)
    assert len(system.pairs) == len(contacts.pairs)


def test_matrix_product(benchmark, wall):
    system = wall.system
    matrix = system.diagonal, system.upper, system.pairs, system.rows
    y = benchmark(block_rows.multiply, *matrix, np.ones_like(system.force))
    assert np.isfinite(y).all()


def test_aggregates(benchmark, wall):
    found = benchmark(aggregates_of, wall.system)
    assert len(found[2][0]) > 2


WITH_COARSE = Attempt(coarse=True, shift=SHIFT, iterations=400, trial=TRIED)
"""How a stiff system is iterated."""


def test_coarse_system(benchmark, wall):
    ready = benchmark(WITH_COARSE.ready, wall.system, coupled_pairs(wall.system.upper), Patterns())
    assert len(ready[2][1]) > 2


def test_iteration(benchmark, wall):
    ready = WITH_COARSE.ready(wall.system, coupled_pairs(wall.system.upper), Patterns())
    d, iterations, size, left = benchmark(pcg.solve, ready, wall.system.force, 0.0, 1e-5, 400, 8)
    assert left <= 1e-5 * size
    assert iterations < 100
    assert np.isfinite(d).all()


def test_small_islands(benchmark):
    """Towers that are put upon each other, each minimised by itself."""
    model = SCENES["stack"].build(1000)
    potential = caught(model, model.stiffest, STEP, STEP)[0]
    start, tolerance = at_rest(potential), tolerance_of(potential)
    _, left = benchmark(SmallIslands().minimise, potential, start, tolerance, work())
    assert left.sum() <= tolerance < potential.distance(start)
