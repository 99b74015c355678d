"""What is done contact by contact, against numpy: in parts, by threads, without strength."""

import numpy as np
import pytest

from clast.compute.parallel import CONTACTS
from clast.contact.coulomb import nothing_found
from clast.contact.laws import answer_of_springs

COUNTS = [1, 5, CONTACTS.part + 3, CONTACTS.many + CONTACTS.part + 7]
P, K = 2e9, 5e8


def some(count, seed=0):
    """Return gap, slip, forces at zero and strength: a third without any."""
    rng = np.random.default_rng(seed)
    gap, slip = rng.normal(size=(2, count)) * 1e-5
    at_zero = rng.choice([0.0, 1e4], count), rng.normal(size=count) * 1e4
    strength = rng.choice([0.0, 1.0, 1.0], count) * rng.uniform(1e2, 1e5, count)
    return (gap, slip), (P, K, *at_zero, strength)


def near(found, wanted, share=1e-12, *, beside=0.0):
    """Assert that numbers are the same but for rounding, their own or that of a number beside."""
    size = np.abs(wanted).max(initial=beside)
    assert np.abs(np.asarray(found) - wanted).max(initial=0.0) <= share * size


def answer(gap, slip, p, k, joint, memory):
    """Return what one contact answers, case by case."""
    friction, cohesion, tensile_strength, length, residual = joint
    bonded, shear_force, multiplier, rest, base = memory
    trial, tension, given = (
        rest + multiplier - p * gap,
        tensile_strength * length,
        not np.isnan(base),
    )
    bears = trial > -tension or (given and trial == -tension)
    if not bears and tension == 0.0 and not given:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0, bonded, 0.0, 0.0
    n, kn = (trial, p) if bears else (-tension, 0.0)
    intact = bonded and (bears or tension == 0.0)
    energy = 0.5 * (n - multiplier) ** 2 / p
    strength = cohesion * length
    presses = base if given else n
    # what is not pressed has no cohesion, unless it bears tension (decision 81)
    joined = presses > 0.0 or tension != 0.0
    bound = max(0.0, presses * friction + strength) if joined else 0.0
    pull = shear_force - k * slip
    t, ks, coupling, mode, loss = 0.0, 0.0, 0.0, 1, 0.0
    if abs(pull) > bound:
        breaks = joined and (strength != 0.0 or tension != 0.0)
        intact = intact and (np.isnan(residual) or not breaks)
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
    joints = *joints, rng.choice([np.nan, 0.0, 1e3], count)
    memory = (
        rng.random(count) < 0.5,
        rng.choice([0.0, 1e3], count) * rng.normal(size=count),
        rng.choice([0.0, 1e4], count),
        rng.choice([0.0, 0.0, 2e4, -3e3], count),
        rng.choice([np.nan, 0.0, 1e4], count),
    )
    of_joints = rng.choice([np.nan, 3e8, 5e9], (2, count))
    share = rng.uniform(0.1, 1.0, count)
    p, k = np.where(np.isnan(of_joints), share * [[P], [K]], of_joints)
    found = nothing_found(count)
    answer_of_springs(count, gap, slip, (P, K, *of_joints, share), joints, memory, found)
    wanted = [
        answer(gap[c], slip[c], p[c], k[c], [one[c] for one in joints], [one[c] for one in memory])
        for c in range(count)
    ]
    for one, other in zip(found, zip(*wanted, strict=True), strict=True):
        near(one.astype(float), np.array(other, float), 1e-14)
