"""Statics and ways of arches on three hinges, as the problem arch-falls compares with."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from clast.verification.problems.masonry.arch_falls import ARCHES, Half
from clast.verification.problems.masonry.arch_push import DENSITY, GRAVITY, limit_thrust


@pytest.mark.parametrize("arch", ARCHES, ids=lambda arch: arch.name)
def test_the_thrust_at_rest_is_the_least_of_linear_programming(arch):
    half = Half.of(arch)
    thrust = DENSITY * GRAVITY * half.thrust(half.ends, half.centroid)
    assert thrust == pytest.approx(limit_thrust(arch, 1.0), rel=1e-9)


@pytest.mark.parametrize("arch", ARCHES, ids=lambda arch: arch.name)
def test_the_thrust_grows_until_the_line_touches_one_more_edge(arch):
    half = Half.of(arch)
    limit = half.limit()
    assert half.room(0.999 * limit) > 0.0 > half.room(1.001 * limit)
    thrusts = [half.thrust(*half.placed(share * limit)) for share in (0.0, 0.3, 0.6, 0.9)]
    assert (np.diff(thrusts) > 0.0).all()


@pytest.mark.parametrize("arch", ARCHES, ids=lambda arch: arch.name)
def test_parts_between_hinges_stay_rigid_and_their_weight_is_work_of_the_thrust(arch):
    half, step = Half.of(arch), 1e-5
    spread = 0.5 * half.limit()
    ends, centroid = half.placed(spread)
    low, crown = ends[0, half.hinge], ends[1, -1]
    before = half.ends[1, -1] - half.ends[0, half.hinge]
    assert np.hypot(*(crown - low)) == pytest.approx(np.hypot(*before), rel=1e-12)
    assert crown[0] == pytest.approx(0.0, abs=1e-12)
    down = [half.weight @ half.placed(spread + way)[1][:, 1] for way in (-step, step)]
    # each half moves by ds/2 against the thrust
    gained = (down[0] - down[1]) / (2.0 * step)
    assert gained == pytest.approx(0.5 * half.thrust(ends, centroid), rel=1e-6)


def test_size_does_not_matter():
    arch = ARCHES[0]
    large = replace(arch, radius=10.0 * arch.radius)
    assert Half.of(large).limit() == pytest.approx(10.0 * Half.of(arch).limit(), rel=1e-6)
    assert Half.of(large).hinges == Half.of(arch).hinges


def test_the_hinges_are_those_of_least_potential_energy():
    """Rigid voussoirs that turn about their corners, a little: a linear programme of angles."""
    arch = ARCHES[0]
    inner, outer = arch.joints()
    count = len(inner)
    half = Half.of(arch)
    weight = np.concatenate([half.weight, half.weight[::-1]])
    x = np.concatenate([half.centroid[:, 0], -half.centroid[::-1, 0]])
    pivots = np.concatenate([inner, outer])
    sense = np.repeat([1.0, -1.0], count)
    above = np.arange(len(x)) >= np.tile(np.arange(count), 2)[:, None]
    rise = sense * (above * weight * (x - pivots[:, :1])).sum(axis=1)
    # the far end moves to the left by 1, neither up nor round
    ends = np.stack([-sense * (0.0 - pivots[:, 1]), sense * (0.0 - pivots[:, 0]), sense])
    found = linprog(rise, A_eq=ends, b_eq=(-1.0, 0.0, 0.0), bounds=[(0.0, None)] * (2 * count))
    assert found.success
    side, joint = np.divmod(np.flatnonzero(found.x > 1e-6), count)
    hinges = {(("inner", "outer")[s], int(k)) for s, k in zip(side, joint, strict=True)}
    assert hinges == half.hinges
