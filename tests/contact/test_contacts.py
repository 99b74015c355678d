"""What is done contact by contact, against numpy: in parts, by threads, without strength."""

import numpy as np
import pytest

from clast.compute.parallel import CONTACTS
from clast.contact.coulomb import nothing_found
from clast.contact.laws import answer_of_springs
from clast.minimise import interior_kernels as interior
from clast.minimise import line_search

COUNTS = [1, 5, CONTACTS.part + 3, CONTACTS.many + CONTACTS.part + 7]
P, K = 2e9, 5e8
NORMAL, CLEARANCE, ABOVE, BELOW, LOWER, UPPER = range(6)


def some(count, seed=0):
    """Return gap, slip, forces at zero and strength: a third without any."""
    rng = np.random.default_rng(seed)
    gap, slip = rng.normal(size=(2, count)) * 1e-5
    at_zero = rng.choice([0.0, 1e4], count), rng.normal(size=count) * 1e4
    strength = rng.choice([0.0, 1.0, 1.0], count) * rng.uniform(1e2, 1e5, count)
    return (gap, slip), (P, K, *at_zero, strength)


def conditions(gaps, springs, state):
    """Return errors, stiffnesses and products as the module's text has them."""
    p, k, normal_at_zero, shear_at_zero, strength = springs
    n, w, above, below, low, up = state
    errors = (n - normal_at_zero) / p + gaps[0] - w, (0.5 * (above - below) - shear_at_zero) / k
    on = strength > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        ks = np.where(on, 1.0 / (1.0 / k + low / above + up / below), 0.0)
    products = n * w + above * low + below * up
    return (errors[0], errors[1] + gaps[1] - low + up), (1.0 / (1.0 / p + w / n), ks), products


def near(found, wanted, share=1e-12, *, beside=0.0):
    """Assert that numbers are the same but for rounding, their own or that of a number beside."""
    size = np.abs(wanted).max(initial=beside)
    assert np.abs(np.asarray(found) - wanted).max(initial=0.0) <= share * size


@pytest.mark.parametrize("count", COUNTS)
def test_an_iterate_is_centred_and_linearised(count):
    gaps, springs = some(count)
    state, errors, stiffnesses, products = interior.centred(gaps, 1e3, springs)
    strength = springs[-1]
    mu = 1e6 / (4.0 * P)
    near(state[NORMAL] * state[CLEARANCE], np.full(count, mu))
    near(P * gaps[0] + state[NORMAL] - P * state[CLEARANCE], springs[2], 1e-12, beside=1e5)
    on = strength > 0.0
    near(state[ABOVE] + state[BELOW], 2.0 * strength)
    near(state[ABOVE] * state[LOWER], mu * on)
    near(state[BELOW] * state[UPPER], mu * on)
    assert (state[:2] > 0.0).all()
    assert (state[2:, on] > 0.0).all()
    assert not state[2:, ~on].any()
    wanted = conditions(gaps, springs, state)
    near(errors[0], wanted[0][0], beside=1e-5)
    for found, other in zip((errors[1], *stiffnesses), (wanted[0][1], *wanted[1]), strict=True):
        near(found, other, beside=1e-5)
    assert products == pytest.approx(wanted[2].sum(), rel=1e-12)


@pytest.mark.parametrize("count", COUNTS)
def test_a_way_meets_the_conditions_to_first_order(count):
    """N w and the others become what is aimed at, less the bend; gap and slip errors vanish."""
    gaps, springs = some(count, 1)
    state, errors, stiffnesses, products = interior.centred(gaps, 1e3, springs)
    strength, on = springs[-1], springs[-1] > 0.0
    changes = tuple(np.random.default_rng(2).normal(size=(2, count)) * 1e-6)
    before, target = None, 0.0
    for _ in range(2):
        about = state, target, before, errors, stiffnesses
        way, limit, growth, bend = interior.way_of(*about, changes, P)
        assert way.dtype == np.float32
        n, w, t, low, up = way.astype(float)
        bent = np.zeros((3, count))
        if before is not None:
            o = before.astype(float)
            bent = np.array([o[0] * o[1], o[2] * o[3], -o[2] * o[4]])
        first = state[NORMAL] * w + state[CLEARANCE] * n + bent[0]
        near(first, target - state[NORMAL] * state[CLEARANCE], 1e-5, beside=np.abs(bent).max())
        first = state[ABOVE] * low + state[LOWER] * t + bent[1] + state[ABOVE] * state[LOWER]
        second = state[BELOW] * up - state[UPPER] * t + bent[2] + state[BELOW] * state[UPPER]
        size = np.abs(state[ABOVE] * low).max(initial=1e-300)
        assert np.abs((first - target)[on]).max(initial=0.0) <= 1e-5 * size
        assert np.abs((second - target)[on]).max(initial=0.0) <= 1e-5 * size
        near(n / P + changes[0] - w, -errors[0], 1e-5, beside=1e-5)
        assert np.abs((t / K + changes[1] - low + up + errors[1])[on]).max(initial=0.0) <= 1e-9
        assert not way[2:, ~on].any()
        whole = np.array([n, w, t, -t, low, up])
        with np.errstate(divide="ignore", invalid="ignore"):
            until = np.where(whole < 0.0, -state / whole, np.inf)
        assert limit == pytest.approx(until.min(), rel=1e-6)
        new, moved, *linear, after = interior.advanced(
            state, gaps, way, changes, 0.5 * min(1.0, limit), springs
        )
        share = 0.5 * min(1.0, limit)
        near(moved, state + share * whole)
        for found, old, change in zip(new, gaps, changes, strict=True):
            near(found, old + share * change)
        wanted = conditions(new, springs, moved)
        for found, other in zip((*linear[0], *linear[1]), (*wanted[0], *wanted[1]), strict=True):
            near(found, other, beside=1e-5)
        assert after == pytest.approx(wanted[2].sum(), rel=1e-12)
        assert after == pytest.approx(products + share * (growth + share * bend), rel=1e-5)
        forces = interior.aimed(*about, 0.1 * strength)
        if count > 1:  # forces on blocks that stay, plus what the motions change of them
            near(forces[0] - stiffnesses[0] * changes[0] + 0.1 * strength, state[0] + n, 1e-5)
            old = 0.5 * (state[ABOVE] - state[BELOW])
            near(forces[1] - stiffnesses[1] * changes[1], old + t, 1e-5)
        before, target = way, 1e-4


def by_numpy(gap, slip, springs):
    """Return N, T and their stiffnesses."""
    multiplier, shear_force, p, k, tension, strength = springs
    n, t = multiplier - p * gap, shear_force - k * slip
    bears, sticks = n >= -tension, (np.abs(t) <= strength) & (strength > 0.0)
    normal, shear = np.where(bears, n, -tension), np.clip(t, -strength, strength)
    return normal, shear, np.where(bears, p, 0.0), np.where(sticks, k, 0.0)


@pytest.mark.parametrize("regions", [1, 3, 400])
@pytest.mark.parametrize("count", COUNTS)
def test_every_region_goes_to_the_least_potential_of_its_own(count, regions):
    rng = np.random.default_rng(3)
    (gap, slip), (p, k, multiplier, shear_force, strength) = some(count, 3)
    d_gap, d_slip = rng.normal(size=(2, count)) * 1e-5
    tension = rng.choice([0.0, 1e3], count)
    springs = multiplier, shear_force, p, k, tension, strength
    region = np.sort(rng.integers(0, regions, count))
    region[: count // 7] = 0  # not all contacts of a region follow each other
    curvature = np.full(regions, 1e-2)
    normal, shear, _, _ = by_numpy(gap, slip, springs)
    work = np.bincount(region, normal * d_gap + shear * d_slip, regions)
    start = -rng.uniform(1e-3, 1e-1, regions)
    line = gap, d_gap, slip, d_slip
    lengths, evaluations = line_search.lengths_along(
        region, line, springs, start + work, curvature, start
    )
    assert 0 < evaluations < 40
    at = lengths[region]
    normal, shear, kn, ks = by_numpy(gap + at * d_gap, slip + at * d_slip, springs)
    work_there = np.bincount(region, normal * d_gap + shear * d_slip, regions)
    slope = start + work + lengths * curvature - work_there
    assert np.abs(slope).max() <= 1e-8 * np.abs(start).max()
    found = line_search.answers(region, lengths, line, springs)
    wanted = gap + at * d_gap, slip + at * d_slip, normal, shear, kn, ks
    for one, other in zip(found, wanted, strict=True):
        near(one, other)


def answer(gap, slip, p, k, joint, memory):
    """Return what one contact answers, case by case."""
    friction, cohesion, tensile_strength, length = joint
    bonded, shear_force, multiplier, base = memory
    trial, tension, given = multiplier - p * gap, tensile_strength * length, not np.isnan(base)
    bears = trial > -tension or (given and trial == -tension)
    if not bears and tension == 0.0 and not given:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0, bonded, 0.0, 0.0
    n, kn = (trial, p) if bears else (-tension, 0.0)
    intact = bonded and (bears or tension == 0.0)
    energy = 0.5 * (n - multiplier) ** 2 / p
    strength = cohesion * length
    bound = max(0.0, (base if given else n) * friction + strength)
    pull = shear_force - k * slip
    t, ks, coupling, mode, loss = 0.0, 0.0, 0.0, 1, 0.0
    if abs(pull) > bound:
        intact = intact and strength == 0.0 and tension == 0.0
        t, loss = np.sign(pull) * bound, bound * (abs(pull) - bound) / k
        coupling = 0.0 if given or bound == 0.0 else np.sign(pull) * friction
    elif bound > 0.0:
        t, ks, mode = pull, k, 2
    mode = 0 if n == 0.0 and tension == 0.0 else mode
    return n, t, kn, ks, coupling, mode, intact, energy + 0.5 * t**2 / k, loss


@pytest.mark.parametrize("count", COUNTS)
def test_contacts_answer_case_by_case(count):
    rng = np.random.default_rng(4)
    gap, slip = rng.choice([0.0, 1.0, 1.0], (2, count)) * rng.normal(size=(2, count)) * 1e-5
    joints = tuple(rng.choice([0.0, size], count) for size in (0.5, 1e4, 5e3, 2.0))
    memory = (
        rng.random(count) < 0.5,
        rng.choice([0.0, 1e3], count) * rng.normal(size=count),
        rng.choice([0.0, 1e4], count),
        rng.choice([np.nan, 0.0, 1e4], count),
    )
    found = nothing_found(count)
    answer_of_springs(count, gap, slip, (P, K), joints, memory, found)
    wanted = [
        answer(gap[c], slip[c], P, K, [one[c] for one in joints], [one[c] for one in memory])
        for c in range(count)
    ]
    for one, other in zip(found, zip(*wanted, strict=True), strict=True):
        near(one.astype(float), np.array(other, float), 1e-14)
