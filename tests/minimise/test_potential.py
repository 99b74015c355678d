"""The potential, its gradient and its Hessian against finite differences; what it refers to."""

from dataclasses import replace

import numpy as np
import pytest

from clast.compute.parallel import BLOCKS, CONTACTS
from clast.minimise.line_search import blocks_along, island_sums, slopes
from clast.minimise.potential import MOMENTUM_SHARE
from scenes.block_matrices import dense
from scenes.potentials import at_rest, caught, some_of, strengthened
from scenes.systems import box, heap, system, wall


def check_derivatives(potential, unknowns, rng, size):
    """Assert that gradient and Hessian are the differences of energy and gradient.

    Along a random way of ``size``; kinks within it are left out by taking the way so short.
    """
    free = ~potential.fixed[:, None]
    way = rng.normal(size=unknowns.shape) * free * size
    before, after = unknowns - way, unknowns + way
    gained = potential.energy(after) - potential.energy(before)
    slope = 2.0 * np.vdot(potential.gradient(unknowns), way)
    scale = np.abs(potential.gradient(unknowns) * way).sum() + np.abs(gained)
    assert gained == pytest.approx(slope, abs=2e-5 * scale)
    turned = potential.gradient(after) - potential.gradient(before)
    matrix = dense(potential.hessian(potential.at(unknowns)))
    wanted = 2.0 * (matrix @ way.ravel()).reshape(-1, 6) * free
    assert turned == pytest.approx(wanted, abs=1e-6 * np.abs(wanted).max())


BRANCHES = {
    "open": (1e-4, 0.0),
    "stick": (-1e-4, 2e-6),
    "slide": (-1e-4, 3e-4),
    "slide back": (-1e-4, -3e-4),
    "bond pulled": (1e-6, 2e-6),
    "bond torn": (5e-4, 0.0),
}


@pytest.mark.parametrize("branch", BRANCHES)
def test_one_contact(branch):
    """A block above a fixed one, with tension, shear and cohesion as the branch asks for."""
    model = system([box(-1.0, -1.0, 3.0), box(0.0, 0.0)], fixed=[0], friction_angle=30.0)
    (one, *_) = caught(model, 5e9, 1e-3, 1e-3)
    count = len(one.springs)
    low = -2e4 if branch.startswith("bond") else 0.0
    normal = replace(one.springs.normal, low=np.full(count, low))
    bound = np.full(count, 1e5)
    shear = replace(one.springs.shear, at_zero=np.full(count, 5e3), low=-bound, high=bound)
    one = replace(one, springs=replace(one.springs, normal=normal, shear=shear))
    gap, slip = BRANCHES[branch]
    unknowns = np.zeros((2, 6))
    unknowns[1, 1] = gap - one.springs.gap.mean()
    unknowns[1, 0] = -slip
    point = one.at(unknowns)
    bears, sticks = point.forces.normal_stiffness > 0.0, point.forces.shear_stiffness > 0.0
    assert bears.all() if branch not in ("open", "bond torn") else not bears.any()
    assert not sticks.any() if branch.startswith("slide") else sticks.all()
    check_derivatives(one, unknowns, np.random.default_rng(0), 1e-9)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("build", [lambda: wall(4, 4), lambda: heap(20, 5)], ids=["wall", "heap"])
def test_random_systems(build, seed):
    """With springs of all kinds (potentials.strengthened), at random displacements."""
    rng = np.random.default_rng(seed)
    for usual in some_of(caught(build(), 5e9, 5e-3, 0.1))[-3:]:
        one = strengthened(usual, seed)
        unknowns = 1e-6 * rng.normal(size=(len(one.fixed), 6)) * ~one.fixed[:, None]
        check_derivatives(one, unknowns, rng, 1e-13)


class Answering:
    """Springs that are known by what they bear alone."""

    def __init__(self, springs):
        self.at, self.energy = springs.at, springs.energy


def test_a_law_of_any_kind_has_one_length_for_all_islands_and_the_same_derivatives():
    for one in some_of(caught(heap(20, 5), 5e8, 5e-3, 0.3)):
        other = replace(one, law=Answering(one.springs))
        here, there = at_rest(one), at_rest(other)
        assert np.array_equal(here.residual, there.residual)
        way = np.einsum("nij,nj->ni", one.inverse, here.residual)
        line, _ = other.line_search(there, way)
        assert len(set(line.lengths)) == 1
        length = line.lengths[0]
        moved = other.moved(there, line)
        assert abs(np.vdot(other.gradient(moved.unknowns), way)) <= 1e-7 * abs(
            np.vdot(here.residual, way)
        )
        assert other.energy(length * way) <= other.energy(0.9 * length * way)
        assert other.energy(length * way) <= other.energy(1.1 * length * way)


def test_what_tolerances_refer_to():
    for one in some_of(caught(heap(20, 5), 5e8, 5e-3, 0.3)):
        free = ~one.fixed

        def half(force, one=one, free=free):
            held = np.einsum("nij,nj->ni", one.inverse, force)
            return 0.5 * np.sum((held * force)[free])

        base = one.base
        wanted = half(base.force - base.momentum) + MOMENTUM_SHARE * half(base.momentum)
        assert one.reference_energy() == pytest.approx(wanted, rel=1e-12)
        wanted = np.hypot(*base.force[free, :2].T).sum()
        assert one.sum_of_forces() == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("islands", [1, 5, 500])
@pytest.mark.parametrize("blocks", [30, BLOCKS.many - 1, 5 * BLOCKS.many + 17])
def test_sums_over_islands(islands, blocks):
    rng = np.random.default_rng(blocks + islands)
    links = 3 * blocks if blocks < BLOCKS.many else CONTACTS.many + 5
    of_blocks, of_links = rng.integers(0, islands, blocks), rng.integers(0, islands, links)
    if blocks % 2:
        of_blocks.sort()  # runs as long as can be
        of_links.sort()
    a, b = rng.normal(size=(2, blocks, 6))
    matrices = rng.normal(size=(blocks, 6, 6))
    matrices += matrices.transpose(0, 2, 1)
    normal, shear, opening, slip = rng.normal(size=(4, links))
    bend, start, smooth = slopes(
        of_blocks, of_links, islands, matrices, a, b, (normal, shear), (opening, slip)
    )
    scale = 1e-12 * links
    forms = np.einsum("ni,nij,nj->n", b, matrices, b)
    assert bend == pytest.approx(np.bincount(of_blocks, forms, islands), abs=100 * scale)
    wanted = -np.bincount(of_blocks, (a * b).sum(axis=1), islands)
    assert start == pytest.approx(wanted, abs=scale)
    works = np.bincount(of_links, normal * opening + shear * slip, islands)
    assert smooth == pytest.approx(wanted + works, abs=scale)
    assert island_sums(normal, of_links, islands) == pytest.approx(
        np.bincount(of_links, normal, islands), abs=scale
    )
    length = rng.normal(size=islands)
    assert blocks_along(a, b, length, of_blocks) == pytest.approx(
        a + length[of_blocks][:, None] * b, rel=1e-14, abs=1e-14
    )
