"""The built-in laws: against a plain reference, their derivatives, their energy, their bonds."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clast.contact.contacts import LOCK, OPEN, SLIDE
from clast.contact.joints.bonds import without_bonds
from clast.contact.laws import AugmentedLagrangian, Penalty
from clast.errors import CaseError
from scenes.systems import box, contacts_of, system

P, KS = 1e8, 4e7
LAW = Penalty(normal_stiffness=P, shear_stiffness=KS)


def contacts(count, **values):
    """Return ``count`` contacts (their geometry does not matter) with some fields set."""
    one = contacts_of(system([box(0, 0), box(0, 1)]))
    some = {}
    for name in vars(one):
        values_of = getattr(one, name)
        some[name] = values_of if name == "pairs" else np.repeat(values_of[:1], count, axis=0)
    usual = {
        "friction": 0.6,
        "cohesion": 0.0,
        "residual_cohesion": np.nan,
        "tensile_strength": 0.0,
        "length": 0.5,
        "bonded": False,
        "shear_force": 0.0,
        "multiplier": 0.0,
        "friction_base": np.nan,
    }
    for name, value in (usual | values).items():
        some[name] = np.array(np.broadcast_to(value, count))
    return replace(one, **some)


@dataclass
class Answer:
    normal: float = 0.0
    shear: float = 0.0
    mode: int = OPEN
    intact: bool = True


def reference(one, c, gap, slip):
    """Return what the law says of contact c, from its words."""
    answer = Answer(intact=bool(one.bonded[c]))
    tension = one.tensile_strength[c] * one.length[c]
    strength = one.cohesion[c] * one.length[c]
    bond = tension > 0.0 or strength > 0.0
    # normal: a spring that may not pull more than the tensile strength
    answer.normal = max(one.multiplier[c] - P * gap, -tension)
    if answer.normal == -tension and tension > 0.0:
        answer.intact = False
    given_bound = not np.isnan(one.friction_base[c])
    if answer.normal == 0.0 and tension == 0.0 and not given_bound:
        return answer
    # shear: elastic up to Coulomb's bound, then on it
    pressing = one.friction_base[c] if given_bound else answer.normal
    joined = pressing > 0.0 or tension > 0.0
    bound = max(0.0, pressing * one.friction[c] + strength) if joined else 0.0
    trial = one.shear_force[c] - KS * slip
    answer.shear = min(max(trial, -bound), bound)
    answer.mode = LOCK if abs(trial) <= bound and bound > 0.0 else SLIDE
    if abs(trial) > bound and bond and joined and not np.isnan(one.residual_cohesion[c]):
        answer.intact = False
    if answer.normal == 0.0 and tension == 0.0:
        answer.mode = OPEN
    return answer


def random_contacts(seed, count=400):
    """Return contacts of all kinds, gaps and slips."""
    rng = np.random.default_rng(seed)
    bonded = rng.uniform(size=count) < 0.5
    some = contacts(
        count,
        friction=rng.choice([0.0, 0.3, 1.0], count),
        cohesion=np.where(bonded, rng.choice([0.0, 2e4, 2e5], count), 0.0),
        tensile_strength=np.where(bonded, rng.choice([0.0, 1e4, 1e5], count), 0.0),
        residual_cohesion=rng.choice([np.nan, 0.0, 1e4], count),
        length=rng.uniform(0.0, 1.0, count),
        bonded=bonded,
        shear_force=rng.choice([0.0, 1.0], count) * rng.normal(0.0, 3e4, count),
        multiplier=rng.choice([0.0, 0.0, 1e4], count),
        friction_base=rng.choice([np.nan, 0.0, 2e4], count),
    )
    gap = rng.normal(0.0, 5e-4, count)
    slip = rng.choice([0.0, 1.0], count) * rng.normal(0.0, 5e-4, count)
    return some, gap, slip


@pytest.mark.parametrize("law", [LAW, AugmentedLagrangian(P, KS)], ids=["penalty", "multiplier"])
@pytest.mark.parametrize("seed", range(5))
def test_law_equals_the_reference(law, seed):
    some, gap, slip = random_contacts(seed)
    found = law.respond(some, gap, slip)
    for c in range(len(gap)):
        wanted = reference(some, c, gap[c], slip[c])
        assert found.normal_force[c] == pytest.approx(wanted.normal, abs=1e-6)
        assert found.shear_force[c] == pytest.approx(wanted.shear, abs=1e-6)
        assert found.mode[c] == wanted.mode
        assert found.bonded[c] == wanted.intact


def test_stiffnesses_are_the_derivatives():
    """Central differences, wherever no kink lies within them."""
    some, gap, slip = random_contacts(11)
    here = LAW.respond(some, gap, slip)
    step = 1e-9

    def slopes(d_gap, d_slip):
        ahead = LAW.respond(some, gap + d_gap, slip + d_slip)
        back = LAW.respond(some, gap - d_gap, slip - d_slip)
        smooth = (ahead.mode == here.mode) & (back.mode == here.mode)
        smooth &= (ahead.normal_stiffness == here.normal_stiffness) & (
            back.normal_stiffness == here.normal_stiffness
        )
        size = 2.0 * (d_gap + d_slip)
        return (
            (ahead.normal_force - back.normal_force)[smooth] / size,
            (ahead.shear_force - back.shear_force)[smooth] / size,
            smooth,
        )

    normal, shear, smooth = slopes(step, 0.0)
    assert smooth.mean() > 0.95
    assert normal == pytest.approx(-here.normal_stiffness[smooth], abs=1e-3 * P)
    # where it slides T follows N by the coupling
    follows = -here.normal_stiffness * here.coupling
    assert shear == pytest.approx(follows[smooth], abs=1e-3 * P)
    normal, shear, smooth = slopes(0.0, step)
    assert normal == pytest.approx(np.zeros(smooth.sum()), abs=1e-3 * P)
    assert shear == pytest.approx(-here.shear_stiffness[smooth], abs=1e-3 * P)


@given(st.integers(0, 10**6))
def test_friction_stays_in_its_cone(seed):
    some, gap, slip = random_contacts(seed, 60)
    some = replace(some, friction_base=np.full(60, np.nan))
    found = LAW.respond(some, gap, slip)
    bound = found.normal_force * some.friction + some.cohesion * some.length
    assert np.all(np.abs(found.shear_force) <= np.maximum(0.0, bound) * (1.0 + 1e-12))
    assert np.all(found.normal_force >= -some.tensile_strength * some.length)
    assert np.all(found.dissipation >= 0.0)
    assert np.all(found.energy >= 0.0)
    sliding = (found.mode == SLIDE) & (found.shear_force != 0.0)
    trial = some.shear_force - KS * slip
    assert np.all(np.sign(found.shear_force[sliding]) == np.sign(trial[sliding]))


@pytest.mark.parametrize("law", [Penalty, AugmentedLagrangian])
@pytest.mark.parametrize("value", [0.0, -1e9, float("nan")])
@pytest.mark.parametrize("name", ["normal_stiffness", "shear_stiffness"])
def test_stiffnesses_are_above_zero(law, name, value):
    with pytest.raises(CaseError, match=f"{law.__name__}: {name} must be above 0, not"):
        law(**{name: value})


# --- energy --------------------------------------------------------------------------------


def test_energy_and_loss_are_the_work_of_shearing():
    """At constant pressure: work into the springs = what they hold + what was lost."""
    gap, steps = np.array([-1e-4]), 400
    slips = 1e-5 * np.sin(np.linspace(0.0, 9.0, steps)) + 2e-6
    one = contacts(1, friction=0.02)
    held, lost, work = LAW.respond(one, gap, np.zeros(1)).energy[0], 0.0, 0.0
    first = held
    for slip in slips:
        answer = LAW.respond(one, gap, np.array([slip]))
        # the spring's force between the old and the new one, averaged over its elastic part
        old, new = one.shear_force[0], answer.shear_force[0]
        elastic = (old - new) / KS
        work -= 0.5 * (old + new) * elastic + new * (slip - elastic)
        lost += answer.dissipation[0]
        held = answer.energy[0]
        one = replace(one, shear_force=answer.shear_force)
    assert lost > 0.0
    assert work == pytest.approx(held - first + lost, rel=1e-9)


# --- bonds ---------------------------------------------------------------------------------


@pytest.mark.parametrize("residual", [np.nan, 0.0, 5e4])
def test_cohesion_holds_up_to_its_strength_and_leaves_the_residual_one(residual):
    """Direct shear: slip starts at N tan(phi) + c L, goes on with c or with what slip leaves."""
    normal, cohesion, length, friction = 1e4, 2e5, 0.5, 0.6
    gap = np.array([-normal / P])
    one = contacts(1, cohesion=cohesion, residual_cohesion=residual, bonded=True, cohesive=True)
    peak, forces = normal * friction + cohesion * length, []
    for _ in range(400):
        answer = LAW.respond(one, gap, np.array([1e-5]))
        forces.append(-answer.shear_force[0])
        one = replace(without_bonds(one, answer), shear_force=answer.shear_force)
    plastic = np.isnan(residual)
    left = cohesion if plastic else residual
    assert max(forces) == pytest.approx(peak)
    assert forces[-1] == pytest.approx(normal * friction + left * length)
    assert one.bonded[0] == plastic
    assert one.cohesive[0]


@pytest.mark.parametrize("residual", [np.nan, 5e4])
def test_tension_beyond_the_strength_ends_all_cohesion(residual):
    one = contacts(
        1,
        cohesion=2e5,
        residual_cohesion=residual,
        tensile_strength=1e5,
        bonded=True,
        cohesive=True,
    )
    answer = LAW.respond(one, np.array([1.01 * 0.5e5 / P]), np.zeros(1))
    torn = without_bonds(one, answer)
    assert not torn.bonded[0] and not torn.cohesive[0]
    assert torn.cohesion[0] == torn.tensile_strength[0] == 0.0


def test_cohesion_counts_where_the_joint_is_pressed():
    """Cohesion without tensile strength: a point that bears nothing holds no shear either."""
    usual = {"cohesion": 1e5, "bonded": True, "shear_force": 1e4}
    for base, held in ((0.0, 0.0), (1e-9, 1e4), (np.nan, 1e4)):
        one = contacts(1, friction_base=base, **usual)
        answer = LAW.respond(one, np.array([-1e-12]), np.zeros(1))
        assert answer.shear_force[0] == pytest.approx(held)
        assert answer.bonded[0]
    one = contacts(1, tensile_strength=1.0, friction_base=0.0, **usual)
    assert LAW.respond(one, np.zeros(1), np.zeros(1)).shear_force[0] == pytest.approx(1e4)


def test_shear_stiffness_equals_the_normal_one_unless_given():
    one = contacts(1)
    answer = Penalty(normal_stiffness=3e7).respond(one, np.array([-1.0]), np.array([1e-6]))
    assert answer.shear_stiffness[0] == answer.normal_stiffness[0] == 3e7
